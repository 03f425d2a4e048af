//! Tests rectangles against the farthest depths of tiles.

use super::lanes::{COUNT, Lanes, Pass};
use super::reduce::TILE;

/// Whether every tile from the first to the last is nearer than `depth`.
pub struct Query<'a> {
    pub farthest: &'a [f32],
    /// Floats from one row of tiles to the next.
    pub row: usize,
    pub first: [usize; 2],
    pub last: [usize; 2],
    pub depth: f32,
}

/// The first and last tile of `size` pixels that an interval of [-1, 1] touches. An interval that ends on a tile
/// boundary does not touch the tile beyond.
#[inline(always)]
pub fn tiles(min: f32, max: f32, size: u32) -> (usize, usize) {
    let pixel = |v: f32| (f64::from(v.clamp(-1.0, 1.0)) * 0.5 + 0.5) * f64::from(size);
    let first = (pixel(min) as usize).min(size as usize - 1);
    let end = pixel(max);
    let whole = end as usize;
    let last = if whole as f64 == end { whole.saturating_sub(1) } else { whole };
    (first / TILE, last.clamp(first, size as usize - 1) / TILE)
}

impl Pass for Query<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(self, s: L) -> bool {
        let depth = s.f(self.depth);
        // SAFETY: there are as many numbers as the most lanes.
        let lane = unsafe { s.load_i(COUNT.as_ptr().cast()) };
        // One branch per row of tiles: first over its whole vectors, then over the remaining tiles.
        let count = self.last[0] + 1 - self.first[0];
        let whole = count / L::N * L::N;
        let left = s.lt_i(lane, s.i((count - whole) as i32));
        for y in self.first[1]..=self.last[1] {
            let tiles = &self.farthest[y * self.row + self.first[0]..][..whole + L::N];
            let mut least = s.f(f32::INFINITY);
            for x in (0..whole).step_by(L::N) {
                // SAFETY: one vector more than these is within the slice.
                least = s.min(least, unsafe { s.load(tiles.as_ptr().add(x)) });
            }
            // SAFETY: this is that vector.
            let rest = unsafe { s.load(tiles.as_ptr().add(whole)) };
            least = s.min(least, s.select(left, rest, s.f(f32::INFINITY)));
            if s.bits(s.lt(depth, least)) != (1 << L::N) - 1 {
                return false;
            }
        }
        true
    }
}
