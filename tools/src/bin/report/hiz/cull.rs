//! Triangle culling: fetches the corners, drops triangles that are back-facing, off screen or without a pixel centre in
//! their bounds, and puts the rest into a list. One triangle per lane at a time; the few that have to be clipped are
//! processed one by one.

use masked_occlusion_culling::BackfaceWinding;

use super::clip;
use super::lanes::{Lanes, MOST, Pass, Words};
use super::list::TriangleList;
use super::screen::{Screen, pixels};
use super::vertices::{CLIP, PLANES};

/// Puts triangles of projected vertices into a list.
pub struct Cull<'a> {
    pub screen: Screen,
    pub winding: BackfaceWinding,
    pub clip: &'a [[f32; 4]],
    pub projected: &'a [Words],
    pub indices: &'a [u32],
    pub list: &'a mut TriangleList,
}

impl Pass for Cull<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self, s: L) {
        let largest = self.indices.iter().fold(0, |m, &i| m.max(i));
        assert!(self.indices.is_empty() || (largest as usize) < self.clip.len(), "no vertex {largest}");
        self.list.reserve(self.indices.len() / 3);
        let triangles = self.indices.len() / 3;
        let whole = triangles / L::N * L::N;
        for t in (0..whole).step_by(L::N) {
            self.some(s, &self.indices[3 * t..3 * (t + L::N)], L::N);
        }
        if whole < triangles {
            let mut rest = [0; 3 * MOST];
            let last = &self.indices[3 * whole..3 * triangles];
            rest[..last.len()].copy_from_slice(last);
            self.some(s, &rest, triangles - whole);
        }
    }
}

impl Cull<'_> {
    /// Processes the first `n` lanes of a vector of triangles.
    #[inline(always)]
    fn some<L: Lanes>(&mut self, s: L, indices: &[u32], n: usize) {
        assert!(indices.len() >= 3 * L::N);
        let (base, index) = (self.projected.as_ptr(), indices.as_ptr());
        // SAFETY: there are three indices for each lane, and all were compared with the number of vertices.
        let [[x0, y0, z0, m0], [x1, y1, z1, m1], [x2, y2, z2, m2]] = unsafe {
            [
                s.fetch::<3>(base, index),
                s.fetch::<3>(base, index.wrapping_add(1)),
                s.fetch::<3>(base, index.wrapping_add(2)),
            ]
        };
        let valid = (1 << n) - 1;
        let in_all = s.and_i(m0, s.and_i(m1, m2));
        let in_any = s.or_i(m0, s.or_i(m1, m2));
        let in_view = s.bits(s.eq_i(s.and_i(in_all, s.i(PLANES)), s.i(0))) & valid;
        let regular = s.bits(s.eq_i(s.and_i(in_any, s.i(CLIP)), s.i(0)));

        let area = s.cross(s.sub_i(x1, x0), s.sub_i(y2, y0), s.sub_i(y1, y0), s.sub_i(x2, x0));
        // Counter-clockwise triangles have negative area because rows run down.
        let (negative, positive) = (s.lt(area, s.f(0.0)), s.lt(s.f(0.0), area));
        let front = match self.winding {
            BackfaceWinding::Clockwise => s.bits(negative),
            BackfaceWinding::CounterClockwise => s.bits(positive),
            BackfaceWinding::None => s.bits(s.or_m(negative, positive)),
        };

        let (left, right) = pixels(s, self.screen.bits, [x0, x1, x2], self.screen.size[0]);
        let (top, bottom) = pixels(s, self.screen.bits, [y0, y1, y2], self.screen.size[1]);
        let empty = s.bits(s.or_m(s.lt_i(right, left), s.lt_i(bottom, top)));

        let keep = in_view & regular & front & !empty;
        if keep != 0 {
            // Areas are positive from here on.
            let order = |b, c| (s.select_i(negative, c, b), s.select_i(negative, b, c));
            let ((x1, x2), (y1, y2), (z1, z2)) = (order(x1, x2), order(y1, y2), order(z1, z2));
            let corners = [[x0, y0, z0], [x1, y1, z1], [x2, y2, z2]];
            for corner in 0..3 {
                let places = self.list.write_at(corner);
                for k in 0..3 {
                    // SAFETY: there is room for all triangles of the call and one more vector.
                    unsafe { s.compress(places[k], keep, corners[corner][k]) };
                }
            }
            // SAFETY: as above.
            unsafe { self.list.grow(keep.count_ones() as usize) };
        }
        let mut clipped = in_view & !regular;
        while clipped != 0 {
            let t = clipped.trailing_zeros() as usize;
            clipped &= clipped - 1;
            let corner = |k: usize| self.clip[indices[3 * t + k] as usize];
            clip::triangle(&self.screen, self.winding, [corner(0), corner(1), corner(2)], self.list);
            // The reserved room is needed for the remaining triangles.
            self.list.reserve(self.indices.len() / 3);
        }
    }
}
