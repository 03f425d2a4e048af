//! Projects vertices to the screen: transform, divide, snap to 1/256 pixel, mark those that need clipping.
//!
//! A vertex is regular if it is between the near plane and 2^40 and within the guard band around the screen. For exact
//! coverage that is some 250,000 pixels, since any snapped coordinates are handled exactly; for conservative coverage
//! it is 16,384 pixels, because the position of the true vertex must be bounded and f32 must therefore be finer than a
//! subpixel. The x of other vertices becomes a NaN that carries outcodes, so that a triangle outside one plane is still
//! rejected by the vector code.
//!
//! Depths 1/w between 2^-40 and 2^40 keep every later product of depths and coordinates out of the denormal range, so
//! the bits do not depend on whether the processor flushes denormals.

use super::camera::{Camera, FARTHEST_W};
use crate::simd::Simd;

/// Outcodes of a vertex, the low bits of a marked x.
pub(crate) mod outcode {
    pub const NEAR: u32 = 1;
    pub const LEFT: u32 = 2;
    pub const RIGHT: u32 = 4;
    pub const BELOW: u32 = 8;
    pub const ABOVE: u32 = 16;
    pub const ALL: u32 = 31;
    /// The other bits of a mark.
    pub const MARK: u32 = 0x7fc0_0000;
}

/// The rows of a matrix for x, y and w, each element broadcast to all lanes.
pub(crate) struct MatrixRows<S: Simd>([[S::F; 4]; 3]);

impl<S: Simd> MatrixRows<S> {
    #[inline(always)]
    pub fn new(s: S, m: &[f32; 16]) -> Self {
        let row = |r: usize| [s.f(m[r]), s.f(m[4 + r]), s.f(m[8 + r]), s.f(m[12 + r])];
        Self([row(0), row(1), row(3)])
    }

    /// (x, y, z, 1) to clip-space x, y, w.
    #[inline(always)]
    pub fn apply(&self, s: S, [x, y, z]: [S::F; 3]) -> [S::F; 3] {
        [dot(s, &self.0[0], x, y, z), dot(s, &self.0[1], x, y, z), dot(s, &self.0[2], x, y, z)]
    }
}

/// A row of a matrix times (x, y, z, 1). The only place that does this, so that every path rounds alike.
#[inline(always)]
pub(crate) fn dot<S: Simd>(s: S, row: &[S::F; 4], x: S::F, y: S::F, z: S::F) -> S::F {
    s.add(s.add(s.mul(x, row[0]), s.mul(y, row[1])), s.add(s.mul(z, row[2]), row[3]))
}

/// Vertices on the screen: x and y in 1/256 pixel, and 1/w; or marks.
pub(crate) enum Projected<S: Simd> {
    /// None is marked.
    Regular([S::F; 3]),
    /// At least one is.
    Marked([S::F; 3]),
}

/// Clip space (x, y, w) to the screen: x and y in 1/256 pixel, and 1/w; or marks.
#[inline(always)]
pub(crate) fn project<S: Simd>(s: S, camera: &Camera, clip: [S::F; 3]) -> [S::F; 3] {
    match project_or_mark(s, camera, clip) {
        Projected::Regular(v) | Projected::Marked(v) => v,
    }
}

/// As [`project`], and says whether any is marked.
#[inline(always)]
pub(crate) fn project_or_mark<S: Simd>(s: S, camera: &Camera, [x, y, w]: [S::F; 3]) -> Projected<S> {
    // Meshes behind the eye need no division.
    if s.all(s.lt(w, s.f(camera.near))) {
        return Projected::Marked([s.float_of_bits(marks(s, camera, [x, y, w])), s.f(0.0), s.f(0.0)]);
    }
    let z = s.div(s.f(1.0), w);
    let across = s.mul(s.mul(x, z), s.f(camera.half_width));
    let down = s.mul(s.mul(y, z), s.f(camera.row_scale));
    let in_range = s.and_m(s.le(s.f(camera.near), w), s.le(w, s.f(FARTHEST_W)));
    let in_band = s.and_m(s.le(s.abs(across), s.f(camera.guard_band)), s.le(s.abs(down), s.f(camera.guard_band)));
    let regular = s.and_m(in_range, in_band);
    let column = s.to_f(s.round(s.add(across, s.f(camera.half_width))));
    let row = s.to_f(s.round(s.add(down, s.f(camera.half_height))));
    if s.all(regular) {
        return Projected::Regular([column, row, z]);
    }
    let x = s.select(regular, column, s.float_of_bits(marks(s, camera, [x, y, w])));
    Projected::Marked([x, s.select(regular, row, s.f(0.0)), z])
}

/// What takes the place of x in vertices that need clipping.
#[inline(always)]
fn marks<S: Simd>(s: S, camera: &Camera, [x, y, w]: [S::F; 3]) -> S::I {
    let minus_w = s.sub(s.f(0.0), w);
    let mut marks = s.or(bit_where(s, s.lt(w, s.f(camera.near)), outcode::NEAR), s.i(outcode::MARK as i32));
    marks = s.or(marks, s.or(bit_where(s, s.lt(x, minus_w), outcode::LEFT), bit_where(s, s.lt(w, x), outcode::RIGHT)));
    marks = s.or(marks, s.or(bit_where(s, s.lt(y, minus_w), outcode::BELOW), bit_where(s, s.lt(w, y), outcode::ABOVE)));
    // Values that are not finite are outside no plane: clipping then counts them as dropped or as visible.
    let largest = s.max(s.max(s.abs(x), s.abs(y)), s.abs(w));
    let finite = s.and_m(s.le(largest, s.f(f32::MAX)), s.and_m(s.eq(x, x), s.eq(y, y)));
    s.select_i(finite, marks, s.i(outcode::MARK as i32))
}

/// A bit in the lanes of a mask.
#[inline(always)]
pub(crate) fn bit_where<S: Simd>(s: S, m: S::M, bit: u32) -> S::I {
    s.select_i(m, s.i(bit as i32), s.i(0))
}

#[cfg(test)]
mod tests {
    use fastrand::Rng;

    use super::*;
    use crate::geometry::{Conservative, Coverage};
    use crate::simd::{Job, Level, MAX_LANES, run};
    use crate::{Implementation, YAxis};

    struct Project<'a>(&'a Camera, &'a [[f32; 3]; MAX_LANES]);

    impl Job for Project<'_> {
        type Output = [[f32; 3]; MAX_LANES];

        #[inline(always)]
        fn run<S: Simd>(self, s: S) -> Self::Output {
            let mut out = [[0.0; 3]; MAX_LANES];
            for first in (0..MAX_LANES).step_by(S::LANES) {
                let mut lanes = [[0.0_f32; MAX_LANES]; 3];
                for k in 0..3 {
                    for lane in 0..S::LANES {
                        lanes[k][lane] = self.1[first + lane][k];
                    }
                }
                // SAFETY: sixteen floats hold a vector.
                unsafe {
                    let v = project(s, self.0, [0, 1, 2].map(|k| s.load_f(lanes[k].as_ptr())));
                    for k in 0..3 {
                        s.store_f(lanes[k].as_mut_ptr(), v[k]);
                    }
                }
                for lane in 0..S::LANES {
                    out[first + lane] = [lanes[0][lane], lanes[1][lane], lanes[2][lane]];
                }
            }
            out
        }
    }

    fn vertex(rng: &mut Rng) -> [f32; 3] {
        let size = (rng.f32() * 20.0 - 4.0).exp2();
        let w = (rng.f32() * 40.0 - 12.0).exp2() * if rng.u8(..8) == 0 { -1.0 } else { 1.0 };
        [(rng.f32() - 0.5) * size * w, (rng.f32() - 0.5) * size * w, w]
    }

    /// Within the guard band of queries, a snapped vertex is at most 1.6 subpixels from its position in exact
    /// arithmetic.
    #[test]
    fn regular_vertices_are_where_double_precision_puts_them() {
        let mut rng = Rng::with_seed(3);
        for (width, height, y_axis) in [(1, 1, YAxis::Up), (1920, 1080, YAxis::Down), (16_384, 16_384, YAxis::Up)] {
            let camera = Camera::new(width, height, y_axis, 0.1).with_guard_band(Conservative::GUARD_BAND);
            let mut regular = 0;
            for _ in 0..2_000 {
                let vertices = core::array::from_fn(|_| vertex(&mut rng));
                let screen = run(Level::best(), Project(&camera, &vertices));
                for ([x, y, w], [column, row, z]) in vertices.into_iter().zip(screen) {
                    if column.is_nan() {
                        continue;
                    }
                    regular += 1;
                    let expected = |v: f32, scale: f32, half: f32| {
                        f64::from(v) / f64::from(w) * f64::from(scale) + f64::from(half)
                    };
                    assert!((f64::from(column) - expected(x, camera.half_width, camera.half_width)).abs() < 1.6);
                    assert!((f64::from(row) - expected(y, camera.row_scale, camera.half_height)).abs() < 1.6);
                    assert_eq!(z, 1.0 / w);
                    assert!(w >= 0.1 && column == column.round() && row == row.round());
                }
            }
            assert!(regular > 1_000);
        }
    }

    #[test]
    fn other_vertices_are_marked_with_the_planes_that_they_are_outside_of() {
        let camera = Camera::new(640, 400, YAxis::Down, 0.5);
        let mut vertices = [[0.0, 0.0, 1.0]; MAX_LANES];
        let cases = [
            ([0.0, 0.0, 0.25], outcode::NEAR),
            ([-1.0, 0.0, 0.25], outcode::NEAR | outcode::LEFT),
            ([1e6, 0.0, 1.0], outcode::RIGHT),
            ([0.0, -1e6, 1.0], outcode::BELOW),
            ([0.0, 1e6, 1.0], outcode::ABOVE),
            ([f32::NAN, 0.0, 1.0], 0),
            ([0.0, f32::INFINITY, 1.0], 0),
            ([0.0, 0.0, f32::NAN], 0),
        ];
        for (vertex, (case, _)) in vertices.iter_mut().zip(cases) {
            *vertex = case;
        }
        for level in Level::all() {
            let screen = run(level, Project(&camera, &vertices));
            for ([x, ..], (case, planes)) in screen.into_iter().zip(cases) {
                assert_eq!(x.to_bits(), outcode::MARK | planes, "{level:?} {case:?}");
            }
            assert_eq!(screen[cases.len()], [320.0 * 256.0, 200.0 * 256.0, 1.0]);
        }
        assert_eq!(run(Level::capped(Implementation::Scalar), Project(&camera, &vertices))[15][2], 1.0);
    }
}
