//! Indices to survivors: most triangles end here, a vector of them (a packet) at a time.

use core::mem::MaybeUninit;

use super::chunk::Numbering;
use super::scratch::Scratch;
use crate::geometry::project::{bit_where, outcode};
use crate::geometry::{Camera, Corner, Coverage, Facing};
use crate::simd::{MAX_LANES, Simd};

/// Farther than this outside the screen, in 1/256 pixel, a snapped vertex is outside for certain.
const CLEARLY: f32 = 2.0;
/// Relative error of a doubled area in f32, with room: eight roundings.
const AREA_ERROR: f32 = 8.0 / (1 << 24) as f32;

/// A vector of triangles: their corners on the screen, in the order that set-up wants if they face the eye.
pub(super) struct Packet<S: Simd> {
    active: S::M,
    pub corners: [Corner<S>; 3],
}

/// What culling leaves of a packet.
pub(super) struct CullResult<S: Simd> {
    /// Some triangle faces the eye and overlaps the screen.
    pub in_view: bool,
    /// Regular triangles to set up.
    pub kept: S::M,
    /// Triangles to clip, a bit per lane.
    pub irregular: u32,
}

impl<S: Simd> Packet<S> {
    /// # Safety
    /// Triangles `position` to `position + count` exist and their vertices are in the scratch.
    #[inline(always)]
    pub unsafe fn new(
        s: S,
        indices: &[u32],
        position: usize,
        count: usize,
        numbering: Numbering,
        facing: Facing,
        scratch: &Scratch,
    ) -> Self {
        let mut padded = MaybeUninit::<[u32; 3 * MAX_LANES]>::uninit();
        let (vertices, packet) = match numbering {
            Numbering::From(base) => (scratch.vertex_zero(base), &indices[3 * position..3 * (position + count)]),
            Numbering::Local { first } => {
                // SAFETY: the corners of a chunk that is numbered so were written.
                let local = unsafe { scratch.local(3 * (position - first + count)) };
                (scratch.vertex_zero(0), &local[3 * (position - first)..])
            }
        };
        let indices = if count == S::LANES {
            packet.as_ptr()
        } else {
            // Lanes beyond the last do not count, but what they name has to be in the scratch.
            for k in 0..3 {
                let at = k * S::LANES;
                let n = packet.len().saturating_sub(at);
                // SAFETY: no more is read than is there; the array holds three vectors.
                unsafe {
                    let index = s.load_filled(packet.as_ptr().wrapping_add(at), n, packet[0]);
                    s.store_i(padded.as_mut_ptr().cast::<u32>().add(at), index);
                }
            }
            padded.as_ptr().cast()
        };
        let (second, third) = if facing.swap { (2, 1) } else { (1, 2) };
        // SAFETY: the caller's contract: numbers of projected vertices, three a lane.
        let corners = unsafe {
            [
                s.load_records(vertices, indices),
                s.load_records(vertices, indices.add(second)),
                s.load_records(vertices, indices.add(third)),
            ]
        };
        Self { active: s.first(count), corners }
    }

    #[inline(always)]
    pub fn cull<C: Coverage>(
        &self,
        s: S,
        (width, height): (u32, u32),
        camera: &Camera,
        facing: Facing,
    ) -> CullResult<S> {
        let [[x0, y0, _], [x1, y1, _], [x2, y2, _]] = self.corners;
        let is_number = |x: S::F| s.eq(x, x);
        let regular = s.and_m(is_number(x0), s.and_m(is_number(x1), is_number(x2)));
        let mut irregular = s.mask_bits(s.and_not_m(regular, self.active));
        if irregular != 0 {
            irregular &= !self.outside(s, C::COUNTS_UNPROJECTABLE && camera.near_is_raised, camera);
        }
        let mut kept = s.and_m(self.active, regular);

        let (min_x, max_x) = (s.min(x0, s.min(x1, x2)), s.max(x0, s.max(x1, x2)));
        let (min_y, max_y) = (s.min(y0, s.min(y1, y2)), s.max(y0, s.max(y1, y2)));
        let slack = s.f(C::SCREEN_SLACK);
        let end = |half: f32| s.add(s.f(2.0 * half), slack);
        let begin = s.sub(s.f(0.0), slack);
        kept = s.and_m(kept, s.and_m(s.lt(begin, max_x), s.lt(min_x, end(camera.half_width))));
        kept = s.and_m(kept, s.and_m(s.lt(begin, max_y), s.lt(min_y, end(camera.half_height))));

        if !facing.both {
            // Twice the area in f32: set-up decides what is unclear.
            let (dx1, dy1, dx2, dy2) = (s.sub(x1, x0), s.sub(y1, y0), s.sub(x2, x0), s.sub(y2, y0));
            let (p, q) = (s.mul(dx1, dy2), s.mul(dx2, dy1));
            let mut error = s.mul(s.add(s.abs(p), s.abs(q)), s.f(AREA_ERROR));
            if C::CORNER_SHIFT > 0.0 {
                let girth = s.add(s.add(s.abs(dx1), s.abs(dy1)), s.add(s.abs(dx2), s.abs(dy2)));
                error = s.add(error, s.mul(s.add(girth, s.f(8.0)), s.f(C::CORNER_SHIFT)));
            }
            kept = s.and_m(kept, s.lt(s.sub(q, error), p));
        }
        let in_view = s.mask_bits(kept) != 0;

        if C::NEEDS_CENTRE {
            let across = holds_centre(s, min_x, max_x, width);
            kept = s.and_m(kept, s.and_m(across, holds_centre(s, min_y, max_y, height)));
        }
        CullResult { in_view, kept, irregular }
    }

    /// Triangles with all corners outside one plane.
    #[inline(always)]
    fn outside(&self, s: S, keep_near: bool, camera: &Camera) -> u32 {
        let planes = outcode::ALL & if keep_near { !outcode::NEAR } else { !0 };
        let codes = s.and(self.code(s, camera, 0), s.and(self.code(s, camera, 1), self.code(s, camera, 2)));
        let shared = s.and(codes, s.i(planes as i32));
        !s.mask_bits(s.eq_i(shared, s.i(0)))
    }

    /// Outcodes of corner `k`: as marked, or else by its place on the screen.
    #[inline(always)]
    fn code(&self, s: S, camera: &Camera, k: usize) -> S::I {
        let (low_row, high_row) =
            if camera.rows_run_down() { (outcode::ABOVE, outcode::BELOW) } else { (outcode::BELOW, outcode::ABOVE) };
        let [x, y, _] = self.corners[k];
        let across = s.or(
            bit_where(s, s.lt(x, s.f(-CLEARLY)), outcode::LEFT),
            bit_where(s, s.lt(s.f(2.0 * camera.half_width + CLEARLY), x), outcode::RIGHT),
        );
        let down = s.or(
            bit_where(s, s.lt(y, s.f(-CLEARLY)), low_row),
            bit_where(s, s.lt(s.f(2.0 * camera.half_height + CLEARLY), y), high_row),
        );
        s.select_i(s.eq(x, x), s.or(across, down), s.bits(x))
    }
}

/// Does a pixel's centre, of `size` pixels, lie from `min` to before `max`?
#[inline(always)]
fn holds_centre<S: Simd>(s: S, min: S::F, max: S::F, size: u32) -> S::M {
    let first = s.sra::<8>(s.add_i(s.round(min), s.i(127)));
    let end = s.sra::<8>(s.add_i(s.round(max), s.i(127)));
    s.gt_i(s.min_i(end, s.i(size as i32)), s.max_i(first, s.i(0)))
}
