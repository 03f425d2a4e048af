//! Triangle setup: edge functions and depth planes, one triangle per lane.

use super::lanes::{COUNT, Lanes, MOST};
use super::list::TriangleList;
use super::screen::{Screen, pixels};

/// A distance beyond everything, for lanes that are outside no edge.
const FAR: f32 = 1e9;

/// The data needed to fill triangles, one triangle per lane. Edge functions are in units of grid steps times pixels,
/// and not negative inside.
#[derive(Default)]
#[repr(C, align(64))]
pub struct Batch {
    /// The first block, and the number of blocks across and down.
    pub block: [[i32; MOST]; 2],
    pub blocks: [[i32; MOST]; 2],
    /// Edge functions at the first block's first pixel, and their steps from pixel to pixel.
    pub edge: [[i32; MOST]; 3],
    pub edge_x: [[i32; MOST]; 3],
    pub edge_y: [[i32; MOST]; 3],
    /// Depth at the first block's first pixel, and its steps; and the depth of the nearest vertex.
    pub depth: [f32; MOST],
    pub depth_x: [f32; MOST],
    pub depth_y: [f32; MOST],
    pub nearest: [f32; MOST],
    /// Where a row of blocks crosses an edge, in blocks from the first, and the step to the next row.
    pub cross: [[f32; MOST]; 3],
    pub cross_step: [[f32; MOST]; 3],
    /// Offset from the first row's crossing to where a row of tiles begins or ends, or so large that nothing is
    /// bounded.
    pub not_left: [[f32; MOST]; 3],
    pub not_right: [[f32; MOST]; 3],
}

impl Batch {
    /// Sets up the triangles of a list from `at` on; returns which lanes have blocks.
    #[inline(always)]
    pub fn set_up<L: Lanes>(&mut self, s: L, screen: &Screen, list: &TriangleList, at: usize) -> u32 {
        let ((x0, y0, z0), (x1, y1, z1), (x2, y2, z2)) =
            (corner(s, list, 0, at), corner(s, list, 1, at), corner(s, list, 2, at));
        let (bits, unit) = (screen.bits, (1 << screen.bits) as f32);
        let half = s.i((1 << bits) / 2);

        // From the first to the last pixel whose centre is inside the triangle's bounds.
        let (left, right) = pixels(s, bits, [x0, x1, x2], screen.size[0]);
        let (top, bottom) = pixels(s, bits, [y0, y1, y2], screen.size[1]);
        let (left, top) = (s.shr(left, 3), s.shr(top, L::LOG_HEIGHT));
        let across = s.add_i(s.sub_i(s.shr(right, 3), left), s.i(1));
        let down = s.add_i(s.sub_i(s.shr(bottom, L::LOG_HEIGHT), top), s.i(1));
        put_i(s, &mut self.block[0], left);
        put_i(s, &mut self.block[1], top);
        put_i(s, &mut self.blocks[0], across);
        put_i(s, &mut self.blocks[1], down);

        // The centre of the first block's first pixel, on the grid.
        let px = s.add_i(s.shl(left, 3 + bits), half);
        let py = s.add_i(s.shl(top, L::LOG_HEIGHT + bits), half);
        for (k, [(xa, ya), (xb, yb)]) in
            [[(x0, y0), (x1, y1)], [(x1, y1), (x2, y2)], [(x2, y2), (x0, y0)]].into_iter().enumerate()
        {
            let (a, b) = (s.sub_i(ya, yb), s.sub_i(xb, xa));
            let (dx, dy) = (s.sub_i(px, xa), s.sub_i(py, ya));
            // Centres on left and top edges are inside; subtracting one makes centres on the other edges outside.
            let left_or_top = s.or_m(s.lt_i(s.i(0), a), s.and_m(s.eq_i(a, s.i(0)), s.lt_i(s.i(0), b)));
            let bias = s.select_i(left_or_top, s.i(0), s.i(-1));
            // a * dx + b * dy + bias, divided by the grid steps per pixel and rounded down, which changes no sign at
            // any pixel. Computed in parts, so that nothing is lost: the high parts wrap around, but the sum fits.
            let fraction = s.i((1 << bits) - 1);
            let low = s.add_i(s.mul_i(a, s.and_i(dx, fraction)), s.mul_i(b, s.and_i(dy, fraction)));
            let high = s.add_i(s.mul_i(a, s.shr(dx, bits)), s.mul_i(b, s.shr(dy, bits)));
            let edge = s.add_i(high, s.shr(s.add_i(low, bias), bits));
            put_i(s, &mut self.edge[k], edge);
            put_i(s, &mut self.edge_x[k], a);
            put_i(s, &mut self.edge_y[k], b);

            // A block may have pixels inside if its best pixel is: if edge + best + a * width * x >= 0.
            let (width, height) = (8, 1 << L::LOG_HEIGHT);
            let best_x = s.mul_i(s.max_i(a, s.i(0)), s.i(width - 1));
            let best_y = s.mul_i(s.max_i(b, s.i(0)), s.i(height - 1));
            let best = s.to_f(s.add_i(edge, s.add_i(best_x, best_y)));
            let (a, b) = (s.to_f(a), s.to_f(b));
            let flat = s.and_m(s.le(a, s.f(0.0)), s.le(s.f(0.0), a));
            let inverse = s.div(s.f(-1.0 / width as f32), s.select(flat, s.f(1.0), a));
            put(s, &mut self.cross[k], s.mul(best, inverse));
            let step = s.mul(s.mul(b, s.f(height as f32)), inverse);
            put(s, &mut self.cross_step[k], step);
            // A row of tiles is crossed from its first row's crossing to its last row's.
            let rest = s.mul(step, s.f((L::ROWS - 1) as f32));
            let (least, most) = (s.min(rest, s.f(0.0)), s.max(rest, s.f(0.0)));
            put(s, &mut self.not_left[k], s.select(s.lt(s.f(0.0), a), least, s.f(-FAR)));
            put(s, &mut self.not_right[k], s.select(s.lt(a, s.f(0.0)), most, s.f(FAR)));
        }

        // The plane through the vertices.
        let (dx1, dy1, dz1) = (s.sub_i(x1, x0), s.sub_i(y1, y0), s.sub(z1, z0));
        let (dx2, dy2, dz2) = (s.sub_i(x2, x0), s.sub_i(y2, y0), s.sub(z2, z0));
        let per_area = s.div(s.f(1.0), s.cross(dx1, dy2, dy1, dx2));
        let (dx1, dy1, dx2, dy2) = (s.to_f(dx1), s.to_f(dy1), s.to_f(dx2), s.to_f(dy2));
        let slope_x = s.mul(s.sub(s.mul(dz1, dy2), s.mul(dz2, dy1)), per_area);
        let slope_y = s.mul(s.sub(s.mul(dz2, dx1), s.mul(dz1, dx2)), per_area);
        let (dx, dy) = (s.to_f(s.sub_i(px, x0)), s.to_f(s.sub_i(py, y0)));
        put(s, &mut self.depth, s.mul_add(slope_x, dx, s.mul_add(slope_y, dy, z0)));
        put(s, &mut self.depth_x, s.mul(slope_x, s.f(unit)));
        put(s, &mut self.depth_y, s.mul(slope_y, s.f(unit)));
        put(s, &mut self.nearest, s.max(z0, s.max(z1, z2)));

        // SAFETY: there are as many numbers as the most lanes.
        let lane = unsafe { s.load_i(COUNT.as_ptr().cast()) };
        let in_list = s.lt_i(lane, s.i((list.len() - at).min(L::N) as i32));
        s.bits(s.and_m(in_list, s.and_m(s.lt_i(s.i(0), across), s.lt_i(s.i(0), down))))
    }
}

/// The x, y and depth of a corner of the triangles from `at` on.
#[inline(always)]
fn corner<L: Lanes>(s: L, list: &TriangleList, k: usize, at: usize) -> (L::I, L::I, L::F) {
    let [x, y, z] = list.read_at(k, at);
    // SAFETY: a whole vector can be read for each triangle of the list.
    unsafe { (s.load_i(x), s.load_i(y), s.load(z.cast())) }
}

#[inline(always)]
fn put_i<L: Lanes>(s: L, to: &mut [i32; MOST], x: L::I) {
    // SAFETY: there is room for the most lanes.
    unsafe { s.store_i(to.as_mut_ptr(), x) }
}

#[inline(always)]
fn put<L: Lanes>(s: L, to: &mut [f32; MOST], x: L::F) {
    // SAFETY: there is room for the most lanes.
    unsafe { s.store(to.as_mut_ptr(), x) }
}
