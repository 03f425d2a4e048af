//! The farthest depth of each tile of 8x8 pixels.

use super::lanes::{Lanes, Pass};

/// A tile's width and height in pixels.
pub const TILE: usize = 8;

/// A buffer of blocks to the least depth of each tile.
pub struct Reduce<'a> {
    pub depth: &'a [f32],
    /// Floats from one row of blocks to the next.
    pub stride: usize,
    /// Tiles across and down.
    pub tiles: [usize; 2],
    pub farthest: &'a mut [f32],
    /// Floats from one row of tiles to the next.
    pub row: usize,
}

impl Pass for Reduce<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, s: L) {
        let (across, down) = (TILE >> L::LOG_WIDTH, TILE >> L::LOG_HEIGHT);
        let [columns, rows] = self.tiles;
        assert!(columns * across * L::N <= self.stride && columns <= self.row);
        let strips = self.depth.chunks_exact(down * self.stride).zip(self.farthest.chunks_mut(self.row));
        for (strip, farthest) in strips.take(rows) {
            for (x, farthest) in farthest[..columns].iter_mut().enumerate() {
                let first = strip.as_ptr().wrapping_add(x * across * L::N);
                let mut least = s.f(f32::INFINITY);
                for y in 0..down {
                    for k in 0..across {
                        // SAFETY: the strip holds `down` rows, each of which holds the blocks of all columns.
                        least = s.min(least, unsafe { s.load(first.wrapping_add(y * self.stride + k * L::N)) });
                    }
                }
                *farthest = s.least(least);
            }
        }
    }
}
