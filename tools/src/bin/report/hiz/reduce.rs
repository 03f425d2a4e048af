//! The farthest depth of each tile of 8x8 pixels.

use super::lanes::{Lanes, Pass};

/// A tile's width and height in pixels.
pub const TILE: usize = 8;

/// Reduces a buffer of tiles to the farthest (least) depth of each.
pub struct Reduce<'a> {
    pub depth: &'a [f32],
    /// Tiles across and down.
    pub tiles: [usize; 2],
    pub farthest: &'a mut [f32],
    /// Floats from one row of farthest depths to the next.
    pub row: usize,
}

impl Pass for Reduce<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, s: L) {
        let [columns, rows] = self.tiles;
        let strips = self.depth.chunks_exact(columns * TILE * TILE).zip(self.farthest.chunks_mut(self.row));
        for (strip, farthest) in strips.take(rows) {
            for (tile, farthest) in strip.chunks_exact(TILE * TILE).zip(farthest) {
                let mut least = s.f(f32::INFINITY);
                for r in 0..L::ROWS {
                    // SAFETY: a tile consists of this many vectors.
                    least = s.min(least, unsafe { s.load(tile.as_ptr().add(r * L::N)) });
                }
                *farthest = s.least(least);
            }
        }
    }
}
