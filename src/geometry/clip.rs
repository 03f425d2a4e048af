//! Clips the few triangles that cross the near plane or leave the guard band, one by one, in f64.
//!
//! They are clipped against one plane after the other (Sutherland and Hodgman 1974). A new vertex is always computed
//! from the inside end of its edge to the outside end, so that two triangles that share the edge get the same vertex.
//! For the same reason, vertices that need no clipping keep the screen coordinates computed by the vector code.
//!
//! A new vertex is a weighted mean of two that may be as large as the triangle. If its w is so much smaller that
//! rounding could move the vertex by a quarter of a subpixel on the screen, the triangle is rejected as if it were not
//! finite.

use super::camera::{Camera, FARTHEST_W, Facing};
use super::coverage::Coverage;
use crate::float_environment::round_ties_even;

/// A triangle clipped by five planes has at most eight corners, which form a fan of six triangles.
const MAX_VERTICES: usize = 8;
pub(crate) const MAX_TRIANGLES: usize = MAX_VERTICES - 2;

/// The result of clipping a triangle.
pub(crate) enum Clipped {
    /// It is entirely outside.
    Nothing,
    /// A coordinate is NaN, infinite or too far for an occluder.
    Dropped,
    /// Part of an occludee cannot be projected, so it may be visible.
    Unprojectable,
    Polygon(Polygon),
}

/// A convex polygon on the screen.
pub(crate) struct Polygon {
    corners: [[f32; 3]; MAX_VERTICES],
    len: usize,
}

#[derive(Clone, Copy)]
struct Vertex {
    clip: [f64; 3],
    /// Its position computed by the vector code; NaN if it has none.
    screen: [f32; 3],
}

/// Rounding error of a new vertex's coordinates, relative to the triangle's largest: five planes with a few roundings
/// each.
const ROUNDING: f64 = 1.0 / (1_u64 << 48) as f64;

const NO_VERTEX: Vertex = Vertex { clip: [0.0; 3], screen: [f32::NAN; 3] };

/// Clips a triangle, given in clip space and as projected by the vector code (x is NaN where that failed).
#[cold]
#[inline(never)]
pub(crate) fn triangle<C: Coverage>(camera: &Camera, clip: &[[f32; 3]; 3], screen: &[[f32; 3]; 3]) -> Clipped {
    let refused = if C::COUNTS_UNPROJECTABLE { Clipped::Unprojectable } else { Clipped::Dropped };
    if clip.as_flattened().iter().any(|x| !x.is_finite()) {
        return refused;
    }
    let all = |outside: fn([f32; 3]) -> bool| clip.iter().all(|&v| outside(v));
    if all(|[x, _, w]| x < -w)
        || all(|[x, _, w]| x > w)
        || all(|[_, y, w]| y < -w)
        || all(|[_, y, w]| y > w)
        || all(|[_, _, w]| w <= 0.0)
    {
        return Clipped::Nothing;
    }
    if C::COUNTS_UNPROJECTABLE && camera.near_is_raised && clip.iter().any(|v| v[2] < camera.near) {
        return refused;
    }
    if clip.iter().all(|v| v[2] < camera.near) {
        return Clipped::Nothing;
    }
    if clip.iter().any(|v| v[2] > FARTHEST_W) {
        return refused;
    }

    let mut corners = [NO_VERTEX; MAX_VERTICES];
    for k in 0..3 {
        corners[k] = Vertex { clip: clip[k].map(f64::from), screen: screen[k] };
    }
    let mut len = 3;
    let (wide, high) = (
        f64::from(camera.guard_band) / f64::from(camera.half_width),
        f64::from(camera.guard_band) / f64::from(camera.half_height),
    );
    // Inside where a * x + b * y + c * w + d is not negative.
    let planes = [
        [0.0, 0.0, 1.0, -f64::from(camera.near)],
        [1.0, 0.0, wide, 0.0],
        [-1.0, 0.0, wide, 0.0],
        [0.0, 1.0, high, 0.0],
        [0.0, -1.0, high, 0.0],
    ];
    for plane in planes {
        // Most triangles cross one plane only.
        if corners[..len].iter().all(|v| distance(plane, v) >= 0.0) {
            continue;
        }
        (corners, len) = against(plane, &corners, len);
        if plane == planes[0] {
            // On the near plane w is known; after rounding it might be zero.
            for v in corners[..len].iter_mut().filter(|v| v.screen[0].is_nan()) {
                v.clip[2] = v.clip[2].max(f64::from(camera.near));
            }
        }
    }
    if len < 3 {
        return Clipped::Nothing;
    }
    let largest = clip.as_flattened().iter().fold(0.0, |m: f64, x| m.max(f64::from(x.abs())));
    let subpixels = f64::from(camera.half_width.max(camera.half_height));
    let unsure = |v: &Vertex| v.screen[0].is_nan() && largest * ROUNDING * subpixels > 0.25 * v.clip[2];
    if corners[..len].iter().any(unsure) {
        return refused;
    }
    let mut polygon = Polygon { corners: [[0.0; 3]; MAX_VERTICES], len };
    for (to, from) in polygon.corners.iter_mut().zip(&corners[..len]) {
        *to = if from.screen[0].is_nan() { project(camera, from.clip) } else { from.screen };
    }
    Clipped::Polygon(polygon)
}

/// Not negative inside of the plane.
fn distance([a, b, c, d]: [f64; 4], v: &Vertex) -> f64 {
    a * v.clip[0] + b * v.clip[1] + c * v.clip[2] + d
}

/// Clips against one plane. A convex polygon gains at most one corner.
fn against(plane: [f64; 4], corners: &[Vertex; MAX_VERTICES], len: usize) -> ([Vertex; MAX_VERTICES], usize) {
    let mut out = [NO_VERTEX; MAX_VERTICES];
    let mut n = 0;
    let mut push = |v: Vertex| {
        // Rounding can make a sliver cross a plane more than twice; a corner that does not fit is a point of the
        // sliver.
        if n < MAX_VERTICES {
            out[n] = v;
            n += 1;
        }
    };
    for k in 0..len {
        let (from, to) = (&corners[k], &corners[if k + 1 < len { k + 1 } else { 0 }]);
        let (at_from, at_to) = (distance(plane, from), distance(plane, to));
        if at_from >= 0.0 {
            push(*from);
        }
        if (at_from >= 0.0) != (at_to >= 0.0) {
            let (inside, outside, near, far) =
                if at_from >= 0.0 { (from, to, at_from, at_to) } else { (to, from, at_to, at_from) };
            let part = near / (near - far);
            // A mean with two weights, neither of which loses a small value next to a large one.
            let between = |k: usize| inside.clip[k] * (1.0 - part) + outside.clip[k] * part;
            push(Vertex { clip: [between(0), between(1), between(2)], screen: [f32::NAN; 3] });
        }
    }
    (out, n)
}

/// Projects a new vertex to the screen and snaps it.
fn project(camera: &Camera, [x, y, w]: [f64; 3]) -> [f32; 3] {
    let limit = f64::from(1 << 26);
    let snap = |x: f64, scale: f32, half: f32| {
        round_ties_even((x / w * f64::from(scale) + f64::from(half)).clamp(-limit, limit)) as f32
    };
    [snap(x, camera.half_width, camera.half_width), snap(y, camera.row_scale, camera.half_height), (1.0 / w) as f32]
}

impl Polygon {
    /// Emits the triangles of the polygon's fan that are on the screen and may be front-facing, with their corners in
    /// set-up's order. Outlined: few triangles are clipped, and the loop over the others is hot.
    #[inline(never)]
    pub fn emit<C: Coverage>(&self, camera: &Camera, facing: Facing, mut push: impl FnMut(&[[f32; 3]; 3])) {
        for k in 1..self.len - 1 {
            if self.faces::<C>(facing, k) && self.on_screen(camera, k) {
                let [a, b, c] = [self.corners[0], self.corners[k], self.corners[k + 1]];
                push(&if facing.swap { [a, c, b] } else { [a, b, c] });
            }
        }
    }

    /// May triangle `k` of the fan be front-facing?
    fn faces<C: Coverage>(&self, facing: Facing, k: usize) -> bool {
        let [[x0, y0, _], [x1, y1, _], [x2, y2, _]] = [self.corners[0], self.corners[k], self.corners[k + 1]];
        let (dx1, dy1) = (f64::from(x1) - f64::from(x0), f64::from(y1) - f64::from(y0));
        let (dx2, dy2) = (f64::from(x2) - f64::from(x0), f64::from(y2) - f64::from(y0));
        let area = dx1 * dy2 - dx2 * dy1;
        let area = if facing.swap { -area } else { area };
        let slack = if C::CORNER_SHIFT > 0.0 {
            f64::from(C::CORNER_SHIFT) * (dx1.abs() + dy1.abs() + dx2.abs() + dy2.abs() + 8.0)
        } else {
            0.0
        };
        facing.both || area > -slack
    }

    /// Do the bounds of triangle `k` of the fan overlap the screen?
    fn on_screen(&self, camera: &Camera, k: usize) -> bool {
        let overlaps = |axis: usize, half: f32| {
            let [a, b, c] = [self.corners[0][axis], self.corners[k][axis], self.corners[k + 1][axis]];
            a.max(b).max(c) > -2.0 && a.min(b).min(c) < 2.0 * half + 2.0
        };
        overlaps(0, camera.half_width) && overlaps(1, camera.half_height)
    }
}

#[cfg(test)]
mod tests {
    use fastrand::Rng;

    use super::*;
    use crate::YAxis;
    use crate::geometry::{Conservative, Exact};

    const NOT_PROJECTED: [[f32; 3]; 3] = [[f32::NAN; 3]; 3];

    fn camera() -> Camera {
        Camera::new(640, 400, YAxis::Down, 0.5)
    }

    fn polygon<C: Coverage>(clip: &[[f32; 3]; 3]) -> Option<Vec<[f32; 3]>> {
        match triangle::<C>(&camera().with_guard_band(C::GUARD_BAND), clip, &NOT_PROJECTED) {
            Clipped::Polygon(polygon) => Some(polygon.corners[..polygon.len].to_vec()),
            _ => None,
        }
    }

    fn vertex(rng: &mut Rng) -> [f32; 3] {
        [rng.f32() * 8.0 - 4.0, rng.f32() * 8.0 - 4.0, rng.f32() * 6.0 - 2.0]
    }

    #[test]
    fn what_remains_lies_between_the_near_plane_and_the_guard_band() {
        let mut rng = Rng::with_seed(1);
        let mut polygons = 0;
        for _ in 0..10_000 {
            let clip = [vertex(&mut rng), vertex(&mut rng), vertex(&mut rng)];
            let Some(corners) = polygon::<Conservative>(&clip) else { continue };
            polygons += 1;
            for [x, y, z] in corners {
                // Half a subpixel for snapping.
                let limit = Conservative::GUARD_BAND + 0.5;
                assert!((x - 320.0 * 256.0).abs() <= limit && (y - 200.0 * 256.0).abs() <= limit, "{x} {y}");
                assert!(z > 0.0 && z <= 2.0, "1/w of the near plane is 2: {z}");
                assert!(x == x.round() && y == y.round());
            }
        }
        assert!(polygons > 1_000);
    }

    /// The new vertex of an edge must be the same in both triangles that share it.
    #[test]
    fn a_shared_edge_is_cut_at_the_same_point_from_both_sides() {
        let mut rng = Rng::with_seed(2);
        let mut compared = 0;
        for _ in 0..10_000 {
            let [a, b, c, d] = core::array::from_fn(|_| vertex(&mut rng));
            // The edge crosses the near plane, and nothing else.
            let inside = |v: [f32; 3]| v[2] >= 0.5;
            if inside(a) == inside(b) || !inside(c) || !inside(d) {
                continue;
            }
            let (Some(left), Some(right)) = (polygon::<Exact>(&[a, b, c]), polygon::<Exact>(&[b, a, d])) else {
                continue;
            };
            let on_near = |p: &[[f32; 3]]| p.iter().filter(|v| v[2] == 2.0).copied().collect::<Vec<_>>();
            let (left, right) = (on_near(&left), on_near(&right));
            assert!(left.iter().any(|v| right.contains(v)), "{left:?} {right:?}");
            compared += 1;
        }
        assert!(compared > 500);
    }

    #[test]
    fn what_lies_outside_or_is_no_number_is_told_apart() {
        let nothing = [[-3.0, 0.0, 1.0], [-4.0, 1.0, 1.0], [-5.0, 0.0, 2.0]];
        assert!(matches!(triangle::<Exact>(&camera(), &nothing, &NOT_PROJECTED), Clipped::Nothing));
        let behind = [[0.0, 0.0, 0.25], [0.1, 0.0, 0.25], [0.0, 0.1, 0.1]];
        assert!(matches!(triangle::<Exact>(&camera(), &behind, &NOT_PROJECTED), Clipped::Nothing));
        for bad in [f32::NAN, f32::INFINITY, 1e38] {
            let clip = [[0.0, 0.0, 1.0], [0.5, 0.0, 1.0], [0.0, 0.5, bad]];
            assert!(matches!(triangle::<Exact>(&camera(), &clip, &NOT_PROJECTED), Clipped::Dropped), "{bad}");
            let answer = triangle::<Conservative>(&camera(), &clip, &NOT_PROJECTED);
            assert!(matches!(answer, Clipped::Unprojectable), "{bad}");
        }
    }

    #[test]
    fn vertices_that_were_projected_stay_where_they_are() {
        let clip = [[0.0, 0.0, 1.0], [0.5, 0.0, 1.0], [0.0, 0.5, 0.25]];
        let screen = [[1234.0, 777.0, 1.0], [4321.0, 777.0, 1.0], [f32::NAN; 3]];
        let Clipped::Polygon(polygon) = triangle::<Exact>(&camera(), &clip, &screen) else { panic!("it is in view") };
        let corners = &polygon.corners[..polygon.len];
        assert_eq!(corners.len(), 4);
        assert!(corners.contains(&screen[0]) && corners.contains(&screen[1]));
    }
}
