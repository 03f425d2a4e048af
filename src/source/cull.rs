//! Culls packets, which are vectors of triangles given by their indices; most triangles end here.

use core::mem::MaybeUninit;

use super::chunk::Numbering;
use super::scratch::Scratch;
use crate::geometry::project::{bit_where, outcode};
use crate::geometry::{Camera, Corner, Coverage, Facing};
use crate::simd::{MAX_LANES, Simd};

/// A snapped vertex farther outside the screen than this, in 1/256 pixel, is certainly outside.
const CLEARLY: f32 = 2.0;
/// Relative error of a doubled area in f32, with slack: eight roundings.
const AREA_ERROR: f32 = 8.0 / (1 << 24) as f32;

/// A vector of triangles: their corners on the screen, in set-up's order if they are front-facing.
pub(super) struct Packet<S: Simd> {
    active: S::M,
    pub corners: [Corner<S>; 3],
}

/// The part of a packet that survives culling.
pub(super) struct CullResult<S: Simd> {
    /// Some triangle is front-facing and overlaps the screen.
    pub in_view: bool,
    /// Regular triangles to set up.
    pub kept: S::M,
    /// Triangles that need clipping, a bit per lane.
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
                // SAFETY: the corners of a chunk with local numbering were written.
                let local = unsafe { scratch.local(3 * (position - first + count)) };
                (scratch.vertex_zero(0), &local[3 * (position - first)..])
            }
        };
        let indices = if count == S::LANES {
            packet.as_ptr()
        } else {
            // Lanes after the last triangle do not count, but their indices must be in the scratch.
            for k in 0..3 {
                let at = k * S::LANES;
                let n = packet.len().saturating_sub(at);
                // SAFETY: no more is read than exists; the array holds three vectors.
                unsafe {
                    let index = s.load_filled(packet.as_ptr().wrapping_add(at), n, packet[0]);
                    s.store_i(padded.as_mut_ptr().cast::<u32>().add(at), index);
                }
            }
            padded.as_ptr().cast()
        };
        let (second, third) = if facing.swap { (2, 1) } else { (1, 2) };
        // SAFETY: the caller's contract: indices of projected vertices, three per lane.
        let corners = unsafe {
            [
                s.load_records(vertices, indices),
                s.load_records(vertices, indices.add(second)),
                s.load_records(vertices, indices.add(third)),
            ]
        };
        Self { active: s.first(count), corners }
    }

    /// The nearest corner of the triangle in a lane: x, y, 1/w.
    ///
    /// # Safety
    /// There is such a lane.
    #[inline(always)]
    pub unsafe fn nearest_corner(&self, s: S, lane: usize) -> [f32; 3] {
        let [a, b, c] = self.corners;
        let b_nearer = s.lt(a[2], b[2]);
        let c_nearer = s.lt(s.max(a[2], b[2]), c[2]);
        let mut corner = [0.0; 3];
        for k in 0..3 {
            let mut lanes = [0.0_f32; MAX_LANES];
            // SAFETY: the array holds a vector; the caller's contract.
            unsafe {
                s.store_f(lanes.as_mut_ptr(), s.select(c_nearer, c[k], s.select(b_nearer, b[k], a[k])));
                corner[k] = *lanes.get_unchecked(lane);
            }
        }
        corner
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
            // Twice the area in f32; uncertain cases are left to set-up.
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

    /// Triangles with all corners outside the same plane.
    #[inline(always)]
    fn outside(&self, s: S, keep_near: bool, camera: &Camera) -> u32 {
        let planes = outcode::ALL & if keep_near { !outcode::NEAR } else { !0 };
        let codes = s.and(self.code(s, camera, 0), s.and(self.code(s, camera, 1), self.code(s, camera, 2)));
        let shared = s.and(codes, s.i(planes as i32));
        !s.mask_bits(s.eq_i(shared, s.i(0)))
    }

    /// Outcodes of corner `k`: from its marks if it has any, else from its position on the screen.
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

/// Does the half-open range from `min` to `max` contain the centre of one of an axis's `size` pixels?
#[inline(always)]
fn holds_centre<S: Simd>(s: S, min: S::F, max: S::F, size: u32) -> S::M {
    let first = s.sra::<8>(s.add_i(s.round(min), s.i(127)));
    let end = s.sra::<8>(s.add_i(s.round(max), s.i(127)));
    s.gt_i(s.min_i(end, s.i(size as i32)), s.max_i(first, s.i(0)))
}

#[cfg(test)]
mod tests {
    use fastrand::Rng;

    use super::*;
    use crate::geometry::{Conservative, Exact};
    use crate::simd::{Job, Level, run};
    use crate::{BackfaceWinding, YAxis};

    const SIZE: (u32, u32) = (64, 48);
    /// Three corners for each of sixteen triangles.
    type Corners = [[[f32; 2]; 3]; MAX_LANES];

    struct Cull<'a, C>(&'a Corners, Facing, core::marker::PhantomData<C>);

    impl<C: Coverage> Job for Cull<'_, C> {
        /// Whether each triangle survives, and whether any is in view.
        type Output = ([bool; MAX_LANES], bool);

        #[inline(always)]
        fn run<S: Simd>(self, s: S) -> Self::Output {
            let camera = Camera::new(SIZE.0, SIZE.1, YAxis::Down, 0.0);
            let mut memory = Scratch::uninit();
            let scratch = Scratch::of(&mut memory);
            for (k, [x, y]) in self.0.as_flattened().iter().enumerate() {
                // SAFETY: the scratch has room for more vertices than this.
                unsafe { scratch.vertex(k).cast::<[f32; 4]>().write([*x, *y, 1.0, 0.0]) };
            }
            let indices: [u32; 3 * MAX_LANES] = core::array::from_fn(|k| k as u32);
            let (mut kept, mut in_view) = ([false; MAX_LANES], false);
            for first in (0..MAX_LANES).step_by(S::LANES) {
                // SAFETY: the triangles' vertices are in the scratch.
                let packet = unsafe { Packet::new(s, &indices, first, S::LANES, Numbering::From(0), self.1, scratch) };
                let culled = packet.cull::<C>(s, SIZE, &camera, self.1);
                assert_eq!(culled.irregular, 0);
                in_view |= culled.in_view;
                for lane in 0..S::LANES {
                    kept[first + lane] = s.mask_bits(culled.kept) >> lane & 1 == 1;
                }
            }
            (kept, in_view)
        }
    }

    fn area([[x0, y0], [x1, y1], [x2, y2]]: [[f32; 2]; 3]) -> i64 {
        let [x0, y0, x1, y1, x2, y2] = [x0, y0, x1, y1, x2, y2].map(|x| x as i64);
        (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    }

    /// Do the bounds contain the centre of a pixel on the screen?
    fn holds_a_centre(t: [[f32; 2]; 3]) -> bool {
        [SIZE.0, SIZE.1].into_iter().enumerate().all(|(axis, size)| {
            let v = t.map(|v| v[axis] as i64);
            let (min, max) = (*v.iter().min().unwrap(), *v.iter().max().unwrap());
            (0..i64::from(size)).any(|pixel| min <= 256 * pixel + 128 && 256 * pixel + 128 < max)
        })
    }

    #[test]
    fn what_is_culled_covers_no_pixel_and_little_else_is_kept() {
        let camera = Camera::new(SIZE.0, SIZE.1, YAxis::Down, 0.0);
        for winding in [BackfaceWinding::Clockwise, BackfaceWinding::CounterClockwise, BackfaceWinding::None] {
            let facing = Facing::new(winding, &camera);
            for level in Level::all() {
                let mut rng = Rng::with_seed(6);
                let (mut kept_ones, mut culled_ones) = (0, 0);
                for _ in 0..400 {
                    let size = 1 << rng.u32(4..14);
                    let corners: Corners = core::array::from_fn(|_| {
                        let (x, y) = (rng.i32(-2_000..18_000), rng.i32(-2_000..14_000));
                        core::array::from_fn(|_| [(x + rng.i32(0..size)) as f32, (y + rng.i32(0..size)) as f32])
                    });
                    let (exact, _) = run(level, Cull::<Exact>(&corners, facing, core::marker::PhantomData));
                    let (conservative, _) =
                        run(level, Cull::<Conservative>(&corners, facing, core::marker::PhantomData));
                    for (k, &t) in corners.iter().enumerate() {
                        let area = if facing.swap { -area(t) } else { area(t) };
                        let faces = facing.both || area > 0;
                        let expected = faces && holds_a_centre(t);
                        assert!(exact[k] || !expected, "{level:?} {winding:?} {t:?} is culled");
                        // In f32 only slivers are uncertain.
                        let clearly_away = !facing.both && area < -1_000;
                        assert!(
                            !exact[k] || (holds_a_centre(t) && !clearly_away),
                            "{level:?} {winding:?} {t:?} is kept"
                        );
                        let on_screen = |axis: usize, size: u32| {
                            t.iter().any(|v| v[axis] > 0.0) && t.iter().any(|v| v[axis] < 256.0 * size as f32)
                        };
                        let touches = faces && on_screen(0, SIZE.0) && on_screen(1, SIZE.1);
                        assert!(conservative[k] || !touches, "{level:?} {winding:?} {t:?} is culled from a query");
                        kept_ones += usize::from(exact[k]);
                        culled_ones += usize::from(!exact[k]);
                    }
                }
                assert!(kept_ones > 500 && culled_ones > 500, "{kept_ones} {culled_ones}");
            }
        }
    }
}
