//! Whether all of a chunk's vertices lie outside the same side of the view, so that its triangles need not be looked
//! at.

use super::Coverage;
use super::camera::Camera;
use super::project::{Projected, outcode};
use crate::simd::Simd;

/// The extent of projected vertices.
pub(crate) struct Extent<S: Simd> {
    min: [S::F; 2],
    max: [S::F; 2],
    /// The outcodes that all vertices have, once some vertex needs clipping.
    shared: S::I,
    clipping: bool,
    regular: bool,
}

impl<S: Simd> Extent<S> {
    #[inline(always)]
    pub fn new(s: S) -> Self {
        let (least, most) = (s.f(f32::MIN), s.f(f32::MAX));
        Self { min: [most; 2], max: [least; 2], shared: s.i(outcode::ALL as i32), clipping: false, regular: false }
    }

    /// Adds a vector of vertices, and returns them as they are stored.
    #[inline(always)]
    pub fn add(&mut self, s: S, vertices: Projected<S>) -> [S::F; 3] {
        match vertices {
            Projected::Regular(v) => {
                for k in 0..2 {
                    (self.min[k], self.max[k]) = (s.min(self.min[k], v[k]), s.max(self.max[k], v[k]));
                }
                self.regular = true;
                v
            }
            Projected::Marked(v) => {
                // A regular vertex among them counts as inside.
                self.shared = s.and(self.shared, s.select_i(s.eq(v[0], v[0]), s.i(0), s.bits(v[0])));
                self.clipping = true;
                v
            }
        }
    }

    /// Are all of them outside the same side? Some that are may be missed.
    #[inline(always)]
    pub fn is_outside<C: Coverage>(&self, s: S, camera: &Camera) -> bool {
        // Plain loops: the compiler does not always inline closures that take vectors.
        if self.regular {
            if self.clipping {
                return false;
            }
            let begin = s.f(-C::SCREEN_SLACK);
            for (k, half) in [camera.half_width, camera.half_height].into_iter().enumerate() {
                let end = s.f(2.0 * half + C::SCREEN_SLACK);
                if s.all(s.le(self.max[k], begin)) || s.all(s.le(end, self.min[k])) {
                    return true;
                }
            }
            return false;
        }
        let keep_near = C::COUNTS_UNPROJECTABLE && camera.near_is_raised;
        let mut plane = if keep_near { 2 * outcode::NEAR } else { outcode::NEAR };
        while self.clipping && plane <= outcode::ALL {
            let bit = s.i(plane as i32);
            if s.all(s.eq_i(s.and(self.shared, bit), bit)) {
                return true;
            }
            plane *= 2;
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::YAxis;
    use crate::geometry::project::project_or_mark;
    use crate::geometry::{Conservative, Exact};
    use crate::simd::{Job, Level, MAX_LANES, run};

    struct Outside<'a, C>(&'a [[f32; 3]; 2 * MAX_LANES], core::marker::PhantomData<C>);

    impl<C: Coverage> Job for Outside<'_, C> {
        type Output = bool;

        #[inline(always)]
        fn run<S: Simd>(self, s: S) -> bool {
            let camera = Camera::new(640, 400, YAxis::Down, 0.5).with_guard_band(C::GUARD_BAND);
            let mut extent = Extent::new(s);
            for first in (0..2 * MAX_LANES).step_by(S::LANES) {
                let mut lanes = [[0.0_f32; MAX_LANES]; 3];
                for k in 0..3 {
                    for lane in 0..S::LANES {
                        lanes[k][lane] = self.0[first + lane][k];
                    }
                }
                // SAFETY: sixteen floats hold a vector.
                let clip = [0, 1, 2].map(|k| unsafe { s.load_f(lanes[k].as_ptr()) });
                extent.add(s, project_or_mark(s, &camera, clip));
            }
            extent.is_outside::<C>(s, &camera)
        }
    }

    #[test]
    fn only_what_is_outside_one_side_is_outside() {
        // x, y, w of a vertex outside of each side: within the guard band, beyond it, and before the near plane.
        let sides = [
            [[-2.0, 0.0, 1.0], [-1e7, 0.0, 1.0], [-2.0, 0.0, 0.25]],
            [[2.0, 0.0, 1.0], [1e7, 0.0, 1.0], [2.0, 0.0, 0.25]],
            [[0.0, -2.0, 1.0], [0.0, -1e7, 1.0], [0.0, -2.0, 0.25]],
            [[0.0, 2.0, 1.0], [0.0, 1e7, 1.0], [0.0, 2.0, 0.25]],
        ];
        let outside = |level, vertices: &[[f32; 3]; 2 * MAX_LANES]| {
            let exact = run(level, Outside::<Exact>(vertices, core::marker::PhantomData));
            let conservative = run(level, Outside::<Conservative>(vertices, core::marker::PhantomData));
            assert_eq!(exact, conservative, "{level:?} {vertices:?}");
            exact
        };
        for level in Level::all() {
            for (side, vertices) in sides.iter().enumerate() {
                for vertex in vertices {
                    let mut all = [*vertex; 2 * MAX_LANES];
                    assert!(outside(level, &all), "{level:?} {vertex:?}");
                    for other in [[0.0, 0.0, 1.0], sides[(side + 1) % 4][0], sides[(side + 1) % 4][1]] {
                        for place in [0, 5, MAX_LANES, 2 * MAX_LANES - 1] {
                            all[place] = other;
                            assert!(!outside(level, &all), "{level:?} {vertex:?} {other:?} at {place}");
                            all[place] = *vertex;
                        }
                    }
                    all[3] = [f32::NAN, 0.0, 1.0];
                    assert!(!outside(level, &all), "{level:?} {vertex:?}: a NaN is outside of nothing");
                }
            }
        }
    }
}
