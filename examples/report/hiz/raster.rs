//! Filling triangles: edge functions, depth test and update, a block of pixels a step.

use super::lanes::{COUNT, Lanes, Pass};
use super::list::TriangleList;
use super::screen::Screen;
use super::setup::Batch;

/// Narrower triangles are walked by the box around them.
const WIDE: i32 = 4;

/// All triangles of a list into a buffer of blocks.
pub struct Raster<'a> {
    pub screen: Screen,
    pub list: &'a TriangleList,
    pub depth: &'a mut [f32],
    /// Floats from one row of blocks to the next.
    pub stride: usize,
}

impl Pass for Raster<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, s: L) {
        // The blocks of the screen's last pixel are there.
        let (x, y) = ((self.screen.width - 1) >> L::LOG_WIDTH, (self.screen.height - 1) >> L::LOG_HEIGHT);
        assert!(x as usize * L::N < self.stride && (y as usize + 1) * self.stride <= self.depth.len());
        assert!((self.depth.as_ptr() as usize).is_multiple_of(4 * L::N) && self.stride.is_multiple_of(L::N));
        let mut batch = Batch::default();
        for at in (0..self.list.len()).step_by(L::N) {
            let mut live = batch.set_up(s, &self.screen, self.list, at);
            while live != 0 {
                let t = live.trailing_zeros() as usize;
                live &= live - 1;
                // SAFETY: its blocks are on the screen, whose last block lies within the buffer.
                unsafe { fill(s, &batch, t & 15, self.depth.as_mut_ptr(), self.stride) };
            }
        }
    }
}

/// Fills triangle `t` of a batch.
///
/// # Safety
/// Its blocks lie within the buffer, whose rows of blocks lie `stride` floats apart.
#[inline(always)]
unsafe fn fill<L: Lanes>(s: L, batch: &Batch, t: usize, depth: *mut f32, stride: usize) {
    // SAFETY: there are as many numbers as the most lanes.
    let lane = unsafe { s.load_i(COUNT.as_ptr().cast()) };
    let lane_x = s.and_i(lane, s.i((1 << L::LOG_WIDTH) - 1));
    let lane_y = s.shr(lane, L::LOG_WIDTH);

    let within = [lane_x, lane_y];
    let (mut e0, x0, y0) = edge(s, batch, 0, t, within);
    let (mut e1, x1, y1) = edge(s, batch, 1, t, within);
    let (mut e2, x2, y2) = edge(s, batch, 2, t, within);
    let (depth_x, depth_y) = (s.f(batch.depth_x[t]), s.f(batch.depth_y[t]));
    let nearest = s.f(batch.nearest[t]);
    let mut z = s.mul_add(depth_x, s.to_f(lane_x), s.mul_add(depth_y, s.to_f(lane_y), s.f(batch.depth[t])));
    let z_x = s.mul(depth_x, s.f((1 << L::LOG_WIDTH) as f32));
    let z_y = s.mul(depth_y, s.f((1 << L::LOG_HEIGHT) as f32));

    let [across, down] = [batch.blocks[0][t], batch.blocks[1][t]];
    let mut row = depth.wrapping_add(batch.block[1][t] as usize * stride + batch.block[0][t] as usize * L::N);
    if across < WIDE {
        for _ in 0..down {
            let (mut f0, mut f1, mut f2, mut zz) = (e0, e1, e2, z);
            for x in 0..across as usize {
                let outside = s.or_i(f0, s.or_i(f1, f2));
                // SAFETY: a block of the triangle's.
                unsafe { s.raise(row.wrapping_add(x * L::N), outside, s.min(zz, nearest)) };
                (f0, f1, f2, zz) = (s.add_i(f0, x0), s.add_i(f1, x1), s.add_i(f2, x2), s.add(zz, z_x));
            }
            (e0, e1, e2, z) = (s.add_i(e0, y0), s.add_i(e1, y1), s.add_i(e2, y2), s.add(z, z_y));
            row = row.wrapping_add(stride);
        }
        return;
    }

    let cross = |k: usize| [batch.cross[k][t], batch.cross_step[k][t], batch.not_left[k][t], batch.not_right[k][t]];
    let cross = [cross(0), cross(1), cross(2)];
    for r in 0..down {
        // Half a hundredth of a block more than rounding can take away.
        let (mut from, mut to) = (0.0_f32, (across - 1) as f32);
        for [at, step, not_left, not_right] in cross {
            let x = at + step * r as f32;
            let (left, right) = (x + not_left - 0.01, x + not_right + 0.01);
            from = if left > from { left } else { from };
            to = if right < to { right } else { to };
        }
        if from <= to {
            // The first block is the one that begins at or before the crossing: of the next, the best pixel is inside.
            let (first, last) = (from as i32, to as i32);
            let skip = s.i(first);
            let (mut f0, mut f1, mut f2) = (
                s.add_i(e0, s.mul_i(x0, skip)),
                s.add_i(e1, s.mul_i(x1, skip)),
                s.add_i(e2, s.mul_i(x2, skip)),
            );
            let mut column = s.f(first as f32);
            for x in first as usize..=last as usize {
                let outside = s.or_i(f0, s.or_i(f1, f2));
                let zz = s.min(s.mul_add(column, z_x, z), nearest);
                // SAFETY: a block of the triangle's: `from` and `to` are within.
                unsafe { s.raise(row.wrapping_add(x * L::N), outside, zz) };
                (f0, f1, f2) = (s.add_i(f0, x0), s.add_i(f1, x1), s.add_i(f2, x2));
                column = s.add(column, s.f(1.0));
            }
        }
        (e0, e1, e2, z) = (s.add_i(e0, y0), s.add_i(e1, y1), s.add_i(e2, y2), s.add(z, z_y));
        row = row.wrapping_add(stride);
    }
}

/// An edge function at the first block's pixels, and its steps from block to block. A function, as closures that are called
/// twice are not inlined.
#[inline(always)]
fn edge<L: Lanes>(s: L, batch: &Batch, k: usize, t: usize, [x, y]: [L::I; 2]) -> (L::I, L::I, L::I) {
    let (a, b) = (s.i(batch.edge_x[k][t]), s.i(batch.edge_y[k][t]));
    let at = s.add_i(s.i(batch.edge[k][t]), s.add_i(s.mul_i(a, x), s.mul_i(b, y)));
    (at, s.shl(a, L::LOG_WIDTH), s.shl(b, L::LOG_HEIGHT))
}
