//! Filling triangles: edge functions, depth test and update, one block of pixels per step.

use super::lanes::{COUNT, Lanes, Pass};
use super::list::TriangleList;
use super::reduce::TILE;
use super::screen::Screen;
use super::setup::Batch;

/// All triangles of a list into a buffer of blocks.
pub struct Raster<'a> {
    pub screen: Screen,
    pub list: &'a TriangleList,
    pub depth: &'a mut [f32],
    /// Floats from one row of tiles to the next.
    pub stride: usize,
}

impl Pass for Raster<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, s: L) {
        // The tile of the screen's last pixel exists.
        let [x, y] = self.screen.size.map(|size| (size as usize - 1) / TILE);
        assert!((x + 1) * TILE * TILE <= self.stride && (y + 1) * self.stride <= self.depth.len());
        assert!((self.depth.as_ptr() as usize).is_multiple_of(64) && self.stride.is_multiple_of(16));
        let mut batch = Batch::default();
        for at in (0..self.list.len()).step_by(L::N) {
            let mut live = batch.set_up(s, &self.screen, self.list, at);
            while live != 0 {
                let t = live.trailing_zeros() as usize;
                live &= live - 1;
                // SAFETY: its blocks are on the screen, whose last tile is within the buffer.
                unsafe { fill(s, &batch, t & 15, self.depth.as_mut_ptr(), self.stride) };
            }
        }
    }
}

/// Fills triangle `t` of a batch.
///
/// # Safety
/// Its tiles are within the buffer, whose rows of tiles are `stride` floats apart.
#[inline(always)]
unsafe fn fill<L: Lanes>(s: L, batch: &Batch, t: usize, depth: *mut f32, stride: usize) {
    // SAFETY: there are as many numbers as the most lanes.
    let lane = unsafe { s.load_i(COUNT.as_ptr().cast()) };
    let lane_x = s.and_i(lane, s.i(7));
    let lane_y = s.shr(lane, 3);

    let within = [lane_x, lane_y];
    let (e0, x0, y0) = edge(s, batch, 0, t, within);
    let (e1, x1, y1) = edge(s, batch, 1, t, within);
    let (e2, x2, y2) = edge(s, batch, 2, t, within);
    let (depth_x, depth_y) = (s.f(batch.depth_x[t]), s.f(batch.depth_y[t]));
    let nearest = s.f(batch.nearest[t]);
    let z = s.mul_add(depth_x, s.to_f(lane_x), s.mul_add(depth_y, s.to_f(lane_y), s.f(batch.depth[t])));
    let z_x = s.mul(depth_x, s.f(8.0));
    let z_y = s.mul(depth_y, s.f((1 << L::LOG_HEIGHT) as f32));

    let [across, down] = [batch.blocks[0][t], batch.blocks[1][t]];
    let [left, top] = [batch.block[0][t], batch.block[1][t]].map(|at| at as usize);
    let column = depth.wrapping_add(left * TILE * TILE);
    let walk = Walk { edges: [e0, e1, e2], right: [x0, x1, x2], down: [y0, y1, y2], z, z_x, z_y, nearest };
    // SAFETY: the triangle's blocks.
    unsafe {
        match across {
            1 => return walk.rows::<1>(s, column, stride, top, down),
            2 => return walk.rows::<2>(s, column, stride, top, down),
            3 => return walk.rows::<3>(s, column, stride, top, down),
            4 => return walk.rows::<4>(s, column, stride, top, down),
            5 => return walk.rows::<5>(s, column, stride, top, down),
            6 => return walk.rows::<6>(s, column, stride, top, down),
            7 => return walk.rows::<7>(s, column, stride, top, down),
            8 => return walk.rows::<8>(s, column, stride, top, down),
            9 => return walk.rows::<9>(s, column, stride, top, down),
            10 => return walk.rows::<10>(s, column, stride, top, down),
            _ => {}
        }
    }

    let cross = [
        [batch.cross[0][t], batch.cross_step[0][t], batch.not_left[0][t], batch.not_right[0][t]],
        [batch.cross[1][t], batch.cross_step[1][t], batch.not_left[1][t], batch.not_right[1][t]],
        [batch.cross[2][t], batch.cross_step[2][t], batch.not_left[2][t], batch.not_right[2][t]],
    ];
    // SAFETY: the triangle's blocks.
    unsafe { walk.tiles(s, column, stride, top, [across, down], &cross) }
}

/// An edge function at the first block's pixels, and its steps from block to block. A function, because closures that
/// are called twice are not inlined.
#[inline(always)]
fn edge<L: Lanes>(s: L, batch: &Batch, k: usize, t: usize, [x, y]: [L::I; 2]) -> (L::I, L::I, L::I) {
    let (a, b) = (s.i(batch.edge_x[k][t]), s.i(batch.edge_y[k][t]));
    let at = s.add_i(s.i(batch.edge[k][t]), s.add_i(s.mul_i(a, x), s.mul_i(b, y)));
    (at, s.shl(a, 3), s.shl(b, L::LOG_HEIGHT))
}

/// Edge functions and depth in a triangle's first block, and their steps from block to block.
#[derive(Clone, Copy)]
struct Walk<L: Lanes> {
    edges: [L::I; 3],
    right: [L::I; 3],
    down: [L::I; 3],
    z: L::F,
    z_x: L::F,
    z_y: L::F,
    nearest: L::F,
}

impl<L: Lanes> Walk<L> {
    /// Fills a box that is `ACROSS` blocks wide, row by row of blocks: a loop whose only branch depends on the height.
    ///
    /// # Safety
    /// The box is within the buffer, with its first column at `column`.
    #[inline(always)]
    unsafe fn rows<const ACROSS: usize>(self, s: L, column: *mut f32, stride: usize, top: usize, down: i32) {
        let Self { edges: [mut e0, mut e1, mut e2], right, down: [y0, y1, y2], mut z, z_x, z_y, nearest } = self;
        for y in top..top + down as usize {
            let row = column.wrapping_add(y / L::ROWS * stride + y % L::ROWS * L::N);
            let (mut f0, mut f1, mut f2, mut zz) = (e0, e1, e2, z);
            for x in 0..ACROSS {
                let outside = s.or_i(f0, s.or_i(f1, f2));
                // SAFETY: a block of the box.
                unsafe { s.raise(row.wrapping_add(x * TILE * TILE), outside, s.min(zz, nearest)) };
                (f0, f1, f2) = (s.add_i(f0, right[0]), s.add_i(f1, right[1]), s.add_i(f2, right[2]));
                zz = s.add(zz, z_x);
            }
            (e0, e1, e2, z) = (s.add_i(e0, y0), s.add_i(e1, y1), s.add_i(e2, y2), s.add(z, z_y));
        }
    }

    /// Fills a wide box, one row of tiles at a time, from the first to the last tile that may be inside all edges.
    /// Their number cannot be predicted, so it is computed once per row of tiles and not once per row of blocks.
    ///
    /// # Safety
    /// The box is within the buffer, with its first column at `column`.
    #[inline(always)]
    unsafe fn tiles(
        self,
        s: L,
        column: *mut f32,
        stride: usize,
        top: usize,
        [across, down]: [i32; 2],
        cross: &[[f32; 4]; 3],
    ) {
        let Self { edges: [e0, e1, e2], right, down: [y0, y1, y2], z, z_x, z_y, nearest } = self;
        let rest = s.i(L::ROWS as i32 - 1);
        let (l0, l1, l2) = (s.mul_i(y0, rest), s.mul_i(y1, rest), s.mul_i(y2, rest));
        let mut first_row = -((top % L::ROWS) as i32);
        let mut tiles = column.wrapping_add(top / L::ROWS * stride);
        while first_row < down {
            // A hundredth of a block is more than the rounding error.
            let (mut from, mut to) = (0.0_f32, (across - 1) as f32);
            for [at, step, not_left, not_right] in cross {
                let x = at + step * first_row as f32;
                let (left, right) = (x + not_left - 0.01, x + not_right + 0.01);
                from = if left > from { left } else { from };
                to = if right < to { right } else { to };
            }
            let (first, end) = (from as i32, if from <= to { to as i32 + 1 } else { from as i32 });
            let (skip, rows, row) = (s.i(first), s.i(first_row), s.f(first_row as f32));
            let mut f0 = s.add_i(s.add_i(e0, s.mul_i(y0, rows)), s.mul_i(right[0], skip));
            let mut f1 = s.add_i(s.add_i(e1, s.mul_i(y1, rows)), s.mul_i(right[1], skip));
            let mut f2 = s.add_i(s.add_i(e2, s.mul_i(y2, rows)), s.mul_i(right[2], skip));
            let z = s.mul_add(row, z_y, z);
            let mut column = s.f(first as f32);
            for x in first as usize..end as usize {
                let tile = tiles.wrapping_add(x * TILE * TILE);
                let mut zz = s.mul_add(column, z_x, z);
                // If the first and last rows are inside all edges, whole tiles need no edge functions. If a tile is
                // only a few vectors, the test costs as much as it saves.
                let last = s.or_i(s.add_i(f0, l0), s.or_i(s.add_i(f1, l1), s.add_i(f2, l2)));
                if L::ROWS < 8 || s.any_negative(s.or_i(last, s.or_i(f0, s.or_i(f1, f2)))) {
                    let (mut g0, mut g1, mut g2) = (f0, f1, f2);
                    for r in 0..L::ROWS {
                        let outside = s.or_i(g0, s.or_i(g1, g2));
                        // SAFETY: a block of a tile that the box touches.
                        unsafe { s.raise(tile.wrapping_add(r * L::N), outside, s.min(zz, nearest)) };
                        (g0, g1, g2, zz) = (s.add_i(g0, y0), s.add_i(g1, y1), s.add_i(g2, y2), s.add(zz, z_y));
                    }
                } else {
                    for r in 0..L::ROWS {
                        let block = tile.wrapping_add(r * L::N);
                        // SAFETY: a block of a tile that the box touches.
                        unsafe { s.store(block, s.max(s.load(block), s.min(zz, nearest))) };
                        zz = s.add(zz, z_y);
                    }
                }
                (f0, f1, f2) = (s.add_i(f0, right[0]), s.add_i(f1, right[1]), s.add_i(f2, right[2]));
                column = s.add(column, s.f(1.0));
            }
            first_row += L::ROWS as i32;
            tiles = tiles.wrapping_add(stride);
        }
    }
}
