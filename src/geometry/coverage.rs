//! Defines when a triangle covers a pixel. This file holds every difference between drawing and querying a triangle.
//!
//! [`Exact`] coverage is used by draws: the pixels whose centre is inside (top-left rule), and depths not nearer than
//! the triangle. [`Conservative`] coverage is used by queries: every pixel that the true triangle touches, before its
//! vertices were snapped, and depths not farther than the triangle. `docs/accuracy.md` shows that the margins suffice.

use crate::simd::Simd;

/// Beyond this, in 1/256 pixel, an edge's products do not fit in f64, and edges are set up one by one.
pub(crate) const WIDE: f32 = (1 << 23) as f32;
/// Half of the largest screen, in 1/256 pixel.
const LARGEST_HALF: f32 = (1 << 21) as f32;
/// Position of an edge that bounds nothing, in pixels: far outside any screen.
pub(crate) const UNBOUNDED: f32 = 1e30;
/// Outside every screen, in pixels, and still representable as an integer.
const BEYOND: f32 = (1 << 20) as f32;
/// One and a half units in the last place: the margin from a vertex's rounded 1/w to a bound of the true value.
pub(crate) const VERTEX_MARGIN: f32 = 1.0 / (1 << 23) as f32;
/// How far a query's snapped vertex may be from the true one, in 1/256 pixel, rounded up.
const SNAP_SLACK: i32 = 2;

/// The two sides of a triangle that begin at its topmost corner, as constant and slope: an edge's event in a row is the
/// first pixel on or to the right of it.
pub(crate) struct Sides<S: Simd> {
    pub left: S::D,
    pub left_slope: S::D,
    pub right: S::D,
    pub right_slope: S::D,
}

/// A triangle's depth plane over its bounds.
pub(crate) struct DepthPlane<S: Simd> {
    /// At the corner of the first tile.
    pub first: S::F,
    /// Per 1/256 pixel.
    pub across: S::F,
    pub down: S::F,
    /// Per sub-tile.
    pub across_sub_tile: S::F,
    pub down_sub_tile: S::F,
    /// Covers all rounding errors.
    pub margin: S::F,
}

/// Exact or conservative coverage.
pub(crate) trait Coverage {
    /// Added to the least and the largest coordinate, in 1/256 pixel, before they are rounded down to whole pixels:
    /// gives the first pixel, and the one after the last.
    const TO_PIXELS: (i32, i32);
    /// How far a vertex may be from the screen's centre, in 1/256 pixel, without being clipped.
    const GUARD_BAND: f32;
    /// How far outside the screen a triangle may be, in 1/256 pixel, and still be kept.
    const SCREEN_SLACK: f32;
    /// How far projection and snapping may have moved two corners relative to each other, in 1/256 pixel, where it
    /// matters.
    const CORNER_SHIFT: f32;
    /// Is a triangle ignored if it contains no pixel centre on the screen?
    const NEEDS_CENTRE: bool;
    /// Must triangles that cannot be projected count as visible? A draw drops them.
    const COUNTS_UNPROJECTABLE: bool;
    /// Can a triangle be too wide for edges in f64?
    const MAY_BE_WIDE: bool = Self::GUARD_BAND + 2.0 * LARGEST_HALF > WIDE;

    /// Lanes in which everything at `nearest` and farther is hidden by a tile with this `z_min`.
    fn hidden<S: Simd>(s: S, nearest: S::F, z_min: S::F) -> S::M;

    /// The opposite of [`Self::hidden`].
    fn visible<S: Simd>(s: S, nearest: S::F, z_min: S::F) -> S::M;

    /// Of the triangles with a pixel in their bounds, those that count, given the doubled area.
    fn counts<S: Simd>(s: S, inside: S::M, area: S::F) -> S::M;

    /// Triangles that snapping made degenerate or flipped, and that count nevertheless: their bounds are used instead.
    fn degenerate<S: Simd>(s: S, active: S::M, area: S::F) -> S::M;

    /// An edge through (x, y): the constant part of its event as a row's left and as its right bound, and its slope.
    /// `dy` is not negative.
    fn edge<S: Simd>(s: S, point: [S::D; 2], delta: [S::D; 2]) -> [S::D; 3];

    /// Makes the sides of degenerate triangles unbounded.
    fn open_degenerate<S: Simd>(s: S, degenerate: S::M, sides: Sides<S>) -> Sides<S>;

    /// An edge's events in rows.
    fn event<S: Simd>(s: S, constant: S::D, slope: S::D, row: S::D) -> S::D;

    /// The columns to which events are limited: those of the bounds, or of the screen where that suffices.
    fn columns<S: Simd>(s: S, screen_width: u32, bounds: impl FnOnce() -> (S::I, S::I)) -> (S::I, S::I);

    /// The depth bound of the first sub-tile, and its change per sub-tile, across and down.
    fn depth_bound<S: Simd>(s: S, degenerate: S::M, plane: &DepthPlane<S>) -> [S::F; 3];

    /// The limit that [`Self::clamp`] applies to the bound, from the farthest vertex and a bound of the nearest.
    fn depth_limit<S: Simd>(s: S, farthest: S::F, nearest: S::F) -> S::F;

    /// The depth bound of a sub-tile, limited to the triangle's own depth range.
    fn clamp<S: Simd>(s: S, plane: S::F, limit: S::F) -> S::F;
}

/// Slope of an edge, and its position at row 0's centre in pixels, measured from `left` (in 1/256 pixel). Also one over
/// `dy`.
#[inline(always)]
fn line<S: Simd>(s: S, [x, y]: [S::D; 2], [dx, dy]: [S::D; 2], left: f64) -> [S::D; 3] {
    // A quarter replaces zero: the caller makes such an edge unbounded.
    let inverse = s.div_d(s.d(1.0), s.max_d(dy, s.d(0.25)));
    let slope = s.mul_d(dx, inverse);
    let rows = s.mul_d(s.sub_d(s.d(128.0), y), s.d(1.0 / 256.0));
    let columns = s.mul_d(s.sub_d(x, s.d(left)), s.d(1.0 / 256.0));
    [s.add_d(columns, s.mul_d(slope, rows)), slope, inverse]
}

/// `x` in the lanes of a mask, 0 elsewhere.
#[inline(always)]
pub(crate) fn where_d<S: Simd>(s: S, m: S::M, x: f32) -> S::D {
    s.to_d(s.select(m, s.f(x), s.f(0.0)))
}

/// Pixels whose centre is inside; depths not nearer than the triangle.
pub(crate) struct Exact;

impl Coverage for Exact {
    const TO_PIXELS: (i32, i32) = (127, 127);
    /// With the largest screen's centre added, coordinates stay below 2^26.
    const GUARD_BAND: f32 = ((1 << 26) - (1 << 21)) as f32;
    const SCREEN_SLACK: f32 = 0.0;
    const CORNER_SHIFT: f32 = 0.0;
    const NEEDS_CENTRE: bool = true;
    const COUNTS_UNPROJECTABLE: bool = false;

    #[inline(always)]
    fn hidden<S: Simd>(s: S, nearest: S::F, z_min: S::F) -> S::M {
        s.le(nearest, z_min)
    }

    #[inline(always)]
    fn visible<S: Simd>(s: S, nearest: S::F, z_min: S::F) -> S::M {
        s.lt(z_min, nearest)
    }

    #[inline(always)]
    fn counts<S: Simd>(s: S, inside: S::M, area: S::F) -> S::M {
        s.and_m(inside, s.lt(s.f(0.0), area))
    }

    #[inline(always)]
    fn degenerate<S: Simd>(s: S, _: S::M, _: S::F) -> S::M {
        s.first(0)
    }

    #[inline(always)]
    fn edge<S: Simd>(s: S, point: [S::D; 2], delta: [S::D; 2]) -> [S::D; 3] {
        let [at, slope, inverse] = line(s, point, delta, 128.0);
        let at = s.add_d(at, s.sub_d(s.d(1.0), s.mul_d(inverse, s.d(1.0 / 512.0))));
        [at, at, slope]
    }

    #[inline(always)]
    fn open_degenerate<S: Simd>(_: S, _: S::M, sides: Sides<S>) -> Sides<S> {
        sides
    }

    /// Exact regardless of how the sum is rounded, see `raster/setup.rs`.
    #[inline(always)]
    fn event<S: Simd>(s: S, constant: S::D, slope: S::D, row: S::D) -> S::D {
        s.mul_add_d(slope, row, constant)
    }

    /// Events lie between the corners, so limiting them to the screen suffices.
    #[inline(always)]
    fn columns<S: Simd>(s: S, screen_width: u32, _: impl FnOnce() -> (S::I, S::I)) -> (S::I, S::I) {
        (s.i(0), s.i(screen_width as i32))
    }

    #[inline(always)]
    fn depth_bound<S: Simd>(s: S, _: S::M, plane: &DepthPlane<S>) -> [S::F; 3] {
        let &DepthPlane { first, across_sub_tile, down_sub_tile, margin, .. } = plane;
        let farthest_corner = s.add(s.min(across_sub_tile, s.f(0.0)), s.min(down_sub_tile, s.f(0.0)));
        [s.add(first, s.sub(farthest_corner, margin)), across_sub_tile, down_sub_tile]
    }

    #[inline(always)]
    fn depth_limit<S: Simd>(s: S, farthest: S::F, _: S::F) -> S::F {
        s.mul(farthest, s.f(1.0 - VERTEX_MARGIN))
    }

    #[inline(always)]
    fn clamp<S: Simd>(s: S, plane: S::F, limit: S::F) -> S::F {
        s.max(plane, limit)
    }
}

/// Every pixel that the true triangle touches; depths not farther than the triangle.
pub(crate) struct Conservative;

impl Coverage for Conservative {
    const TO_PIXELS: (i32, i32) = (-SNAP_SLACK, 256 + SNAP_SLACK);
    /// Four roundings of numbers below 2^23 plus the snap move a vertex by less than 1.6 subpixels.
    const GUARD_BAND: f32 = (1 << 22) as f32;
    const SCREEN_SLACK: f32 = 2.0;
    const CORNER_SHIFT: f32 = 4.0;
    const NEEDS_CENTRE: bool = false;
    const COUNTS_UNPROJECTABLE: bool = true;

    #[inline(always)]
    fn hidden<S: Simd>(s: S, nearest: S::F, z_min: S::F) -> S::M {
        s.lt(nearest, z_min)
    }

    #[inline(always)]
    fn visible<S: Simd>(s: S, nearest: S::F, z_min: S::F) -> S::M {
        s.le(z_min, nearest)
    }

    #[inline(always)]
    fn counts<S: Simd>(_: S, inside: S::M, _: S::F) -> S::M {
        inside
    }

    #[inline(always)]
    fn degenerate<S: Simd>(s: S, active: S::M, area: S::F) -> S::M {
        s.and_m(s.le(area, s.f(0.0)), active)
    }

    /// Evaluated at each row's upper and lower end instead of its centre, plus what snapping may have moved.
    #[inline(always)]
    fn edge<S: Simd>(s: S, point: [S::D; 2], delta: [S::D; 2]) -> [S::D; 3] {
        let [at, slope, _] = line(s, point, delta, 0.0);
        let steep = s.max_d(slope, s.sub_d(s.d(0.0), slope));
        let slack = s.add_d(s.mul_d(steep, s.d(0.5 + 1.0 / 128.0)), s.d(1.0 / 128.0));
        [s.sub_d(at, slack), s.add_d(at, s.add_d(slack, s.d(1.0))), slope]
    }

    /// Vertical edges to the left and right of everything.
    #[inline(always)]
    fn open_degenerate<S: Simd>(s: S, degenerate: S::M, sides: Sides<S>) -> Sides<S> {
        let keep = s.to_d(s.select(degenerate, s.f(0.0), s.f(1.0)));
        Sides {
            right_slope: s.mul_d(sides.right_slope, keep),
            left_slope: s.mul_d(sides.left_slope, keep),
            right: s.add_d(s.mul_d(sides.right, keep), where_d(s, degenerate, BEYOND)),
            left: s.add_d(s.mul_d(sides.left, keep), where_d(s, degenerate, -BEYOND)),
        }
    }

    /// Rounded twice everywhere, so that all instruction sets give the same result.
    #[inline(always)]
    fn event<S: Simd>(s: S, constant: S::D, slope: S::D, row: S::D) -> S::D {
        s.add_d(constant, s.mul_d(slope, row))
    }

    /// Events may lie beyond the corners if an edge is nearly horizontal.
    #[inline(always)]
    fn columns<S: Simd>(_: S, _: u32, bounds: impl FnOnce() -> (S::I, S::I)) -> (S::I, S::I) {
        bounds()
    }

    #[inline(always)]
    fn depth_bound<S: Simd>(s: S, degenerate: S::M, plane: &DepthPlane<S>) -> [S::F; 3] {
        let &DepthPlane { first, across, down, across_sub_tile, down_sub_tile, margin } = plane;
        let zero = s.f(0.0);
        let nearest_corner = s.add(s.max(across_sub_tile, zero), s.max(down_sub_tile, zero));
        // A true point of the occludee has the depth of its snapped counterpart, which may be this far away.
        let moved = s.mul(s.add(s.abs(across), s.abs(down)), s.f(SNAP_SLACK as f32));
        let bound = s.add(first, s.add(s.add(nearest_corner, moved), margin));
        [
            s.select(degenerate, s.f(UNBOUNDED), bound),
            s.select(degenerate, zero, across_sub_tile),
            s.select(degenerate, zero, down_sub_tile),
        ]
    }

    #[inline(always)]
    fn depth_limit<S: Simd>(_: S, _: S::F, nearest: S::F) -> S::F {
        nearest
    }

    #[inline(always)]
    fn clamp<S: Simd>(s: S, plane: S::F, limit: S::F) -> S::F {
        s.min(plane, limit)
    }
}
