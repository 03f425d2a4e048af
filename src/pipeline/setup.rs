//! Edges and depth plane of a vector of triangles.
//!
//! **Edges.** With the topmost corner first and the corners clockwise, row `r` of pixels is covered from the larger
//! of its left events to the smaller of its right events; the event of an edge is the first pixel whose
//! centre is on or right of it, for both sides, which is the top-left rule. It is the floor of
//! `x + slope * r` in f64. The exact value there has a denominator of `256 * |dy|`; a bias of
//! `1 - 1 / (512 * |dy|)` turns the ceiling into a floor with a tolerance of half a denominator either way.
//! With coordinates up to 2^23 (32,768 pixels) and 2^14 rows, the roundings sum to less than a third of the tolerance,
//! so the event is exact, and a fused multiply-add, which leaves roundings out, comes to the same. Wider triangles go
//! through `edges.rs`, where the constant part is rounded once. A horizontal edge bounds nothing: the range of rows, which
//! is exact by itself, does.
//!
//! **Depth.** 1/w is a plane on the screen. For each sub-tile a draw needs a bound that is not nearer than the
//! triangle anywhere in the sub-tile's square, a query one that is not farther: the plane at the
//! farthest (nearest) corner, less (more) a margin for rounding, clamped to the farthest (nearest) vertex.
//! The slopes and the value at the anchor, the corner of the box's first tile, are computed in f64 from exact differences and
//! rounded once. In f32 what cancels there took a hundredth and more off the depths of floors and walls that reach behind the
//! eye, whose vertices on the near plane are far away and far nearer than what is on the screen.
//!
//! Let `u = 2^-24`, `Z` the nearest vertex, and `s` the largest coordinate and a tile's width, so that no two of the points
//! here are farther apart than `2 s`. The terms of the value at the anchor sum to at most `Z + 16 Z s^2 / area`, which is
//! below `24 Z s^2 / area`. The quotient comes from f32 by one step of Newton's iteration, off by `2^-46`, and the roundings
//! in f64 are far smaller: together less than `2^-40 Z s^2 / area`. Beyond 2^25 the area is not exact, but off by at
//! most 2, which adds less than `4 / area` of those terms. For a computed area of 3 and a true one of 1 the terms themselves
//! are off by a factor of 3, and it holds all the same: the real rise of a plane whose depths lie in `[0, Z]` is at most
//! `8 Z s^2 / area`, and what is computed differs from it by no more than the error's share of that. What follows is of the screen's size, at most
//! `a = |anchor| + |slope across| * box's width + |slope down| * box's height`: rounding the three, the corner, the
//! margin and the walk to the sub-tile sum to at most `10 u a`, a vertex's depth adds one. The margin is `16 u a` and what
//! was said of f64. On slivers it is large, and the clamp decides.

use super::batch::Batch;
use super::boxes::{Boxes, Look, QUERY_SLACK};
use super::edges;
use super::survivors::Corner;
use crate::buffer::Buffer;
use crate::simd::Simd;

/// Beyond this, in 1/256 pixel, edges are set up one by one.
const WIDE: f32 = (1 << 23) as f32;
/// Far more than any screen, in pixels; what bounds nothing is there.
const NOWHERE: f32 = 1e30;
/// Beyond every screen, in pixels, and still an integer.
const BEYOND: f32 = (1 << 20) as f32;
/// Beyond this, in 1/256 pixel, the area is not exact.
const INEXACT: f32 = (1 << 25) as f32;
/// 16 roundings of f32.
const MARGIN: f32 = 16.0 / (1 << 24) as f32;
/// What is off in f64: see above.
const FINE_MARGIN: f32 = 1.0 / (1_u64 << 40) as f32;
/// One unit in the last place and a half: from a vertex's rounded 1/w to a bound of the true one.
pub(super) const VERTEX_MARGIN: f32 = 1.0 / (1 << 23) as f32;

/// What the last step wants of setup.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    Draw,
    Query,
    Bin,
}

/// What setup found, a bit a lane.
#[derive(Clone, Copy, Default)]
pub(super) struct Alive {
    /// Triangles that face the eye and whose box holds a pixel; the others are nothing.
    pub rasterized: u32,
    /// Those that reach the last step.
    pub lanes: u32,
}

/// How a call's triangles are set up.
#[derive(Clone, Copy)]
pub(super) struct Setup<'a, S> {
    pub s: S,
    pub purpose: Purpose,
    pub buffer: &'a Buffer,
    /// Corners may be in either order.
    pub both_sides: bool,
    /// The tiles that the last step takes, and what of them may be looked at.
    pub look: Look,
}

/// Sets up the triangles in `active`; the others may be anything.
#[inline(always)]
pub(super) fn set_up<S: Simd>(
    setup: Setup<'_, S>,
    [a, b, c]: [Corner<S>; 3],
    active: S::M,
    batch: &mut Batch,
) -> Alive {
    let Setup { s, purpose, buffer, both_sides, look } = setup;
    let query = purpose == Purpose::Query;
    let boxes = Boxes::new(s, buffer, purpose, &[a, b, c]);
    let inside = s.and_m(active, boxes.inside);
    let nearest = boxes.nearest;
    let mut hidden = 0;
    if purpose != Purpose::Bin {
        // SAFETY: the pipeline's caller vouches for the buffer.
        hidden = s.mask_bits(unsafe { boxes.hidden::<false>(s, buffer, look, purpose) });
        // Where nothing is counted, nothing more has to be known of a vector that is hidden.
        if !query && !buffer.statistics() && s.mask_bits(inside) & !hidden == 0 {
            return Alive::default();
        }
    }
    let Boxes { column0, column1, row0, row1, tile_x0, tile_x1, tile_y0, tile_y1, .. } = boxes;

    // The topmost corner first.
    let b_top = s.and_m(s.lt(b[1], a[1]), s.le(b[1], c[1]));
    let c_top = s.and_m(s.lt(c[1], a[1]), s.lt(c[1], b[1]));
    let (v0, mut v1, mut v2) =
        (turn(s, b_top, c_top, a, b, c), turn(s, b_top, c_top, b, c, a), turn(s, b_top, c_top, c, a, b));
    if both_sides {
        let back = s.lt(s.d_to_f(doubled_area(s, v0, v1, v2).0), s.f(0.0));
        for k in 0..3 {
            (v1[k], v2[k]) = (s.select(back, v2[k], v1[k]), s.select(back, v1[k], v2[k]));
        }
    }
    let (exact_area, deltas) = doubled_area(s, v0, v1, v2);
    let area = s.d_to_f(exact_area);
    let alive = if query { inside } else { s.and_m(inside, s.lt(s.f(0.0), area)) };

    // SAFETY (of the stores below): the arrays of a batch hold the lanes of any vector.
    macro_rules! store {
        ($field:ident, $value:expr) => {
            // SAFETY: as above.
            unsafe { s.store_f(batch.$field.as_mut_ptr(), $value) }
        };
        (i $field:ident, $value:expr) => {
            // SAFETY: as above.
            unsafe { s.store_i(batch.$field.as_mut_ptr(), $value) }
        };
        (d $field:ident, $value:expr) => {
            // SAFETY: as above.
            unsafe { s.store_d(batch.$field.as_mut_ptr(), $value) }
        };
    }
    let wide = s.mask_bits(s.and_m(s.lt(s.f(WIDE), boxes.widest), active));
    if purpose == Purpose::Bin || wide != 0 {
        let corners = [v0[0], v0[1], v0[2], v1[0], v1[1], v1[2], v2[0], v2[1], v2[2]];
        for (lanes, value) in batch.corners.iter_mut().zip(corners) {
            // SAFETY: as above.
            unsafe { s.store_f(lanes.as_mut_ptr(), value) };
        }
    }
    let mut lanes = s.mask_bits(alive);
    if wide != 0 && !query {
        // In f64 the sign of the area of so wide a triangle may be off.
        lanes = edges::correct_facing(batch, lanes, wide & s.mask_bits(inside));
    }
    let rasterized = lanes;
    store!(i tile_x0, tile_x0);
    store!(i tile_x1, tile_x1);
    store!(i tile_y0, tile_y0);
    store!(i tile_y1, tile_y1);
    if purpose == Purpose::Bin || lanes == 0 {
        return Alive { rasterized, lanes };
    }

    lanes &= !hidden;
    let found = Alive { rasterized, lanes };
    if lanes == 0 {
        return found;
    }

    // Edges.
    let Deltas { right: (dx_r, dy_r), left: (dx_l, dy_l) } = deltas;
    let (x0, y0, x1, y1) = (s.to_d(v0[0]), s.to_d(v0[1]), s.to_d(v1[0]), s.to_d(v1[1]));
    let down = s.lt(v1[1], v2[1]);
    let up = s.lt(v2[1], v1[1]);
    let sign = s.to_d(s.select(down, s.f(1.0), s.f(-1.0)));
    let (dx_m, dy_m) = (s.mul_d(s.sub_d(dx_l, dx_r), sign), s.mul_d(s.sub_d(dy_l, dy_r), sign));
    // A query keeps triangles that snapping made degenerate or turned over: their bounding box stands for them.
    let flat = s.and_m(s.le(area, s.f(0.0)), if query { active } else { s.first(0) });
    macro_rules! store_edge {
        ($field:ident, $value:expr) => {
            let value = $value;
            store!(d $field, value);
            // SAFETY: as above.
            unsafe { s.store_f(batch.rounded.$field.as_mut_ptr(), s.d_to_f(value)) }
        };
    }
    let [_, mut right, mut right_slope] = edge(s, query, [x0, y0], [dx_r, dy_r]);
    let [mut left, _, mut left_slope] = edge(s, query, [x0, y0], [dx_l, dy_l]);
    right = s.add_d(right, nowhere(s, s.eq(v0[1], v1[1]), NOWHERE));
    left = s.add_d(left, nowhere(s, s.eq(v0[1], v2[1]), -NOWHERE));
    if query {
        // Upright edges right and left of everything.
        let keep = s.to_d(s.select(flat, s.f(0.0), s.f(1.0)));
        (right_slope, left_slope) = (s.mul_d(right_slope, keep), s.mul_d(left_slope, keep));
        right = s.add_d(s.mul_d(right, keep), nowhere(s, flat, BEYOND));
        left = s.add_d(s.mul_d(left, keep), nowhere(s, flat, -BEYOND));
    }
    store_edge!(right, right);
    store_edge!(right_slope, right_slope);
    store_edge!(left, left);
    store_edge!(left_slope, left_slope);
    let [middle_left, middle_right, middle_slope] = edge(s, query, [x1, y1], [dx_m, dy_m]);
    let all = s.le(s.f(0.0), s.f(0.0));
    store_edge!(middle_left, s.add_d(middle_left, nowhere(s, s.or_m(flat, s.and_not_m(up, all)), -NOWHERE)));
    store_edge!(middle_right, s.add_d(middle_right, nowhere(s, s.or_m(flat, s.and_not_m(down, all)), NOWHERE)));
    store_edge!(middle_slope, middle_slope);
    store!(row0, s.to_f(row0));
    store!(row1, s.to_f(row1));
    store!(i column0, column0);
    store!(i column1, column1);
    if !query {
        edges::replace_wide(batch, lanes & wide);
    }

    // Depth plane.
    let farthest = s.min(v0[2], s.min(v1[2], v2[2]));
    let one = s.f(1.0);
    let inverse = s.div(one, s.max(area, one));
    let half_way = s.to_d(inverse);
    let fine = s.mul_d(half_way, s.sub_d(s.d(2.0), s.mul_d(s.max_d(exact_area, s.d(1.0)), half_way)));
    let z0 = s.to_d(v0[2]);
    let (dz1, dz2) = (s.sub_d(s.to_d(v1[2]), z0), s.sub_d(s.to_d(v2[2]), z0));
    let across = s.mul_d(s.sub_d(s.mul_d(dz1, dy_l), s.mul_d(dz2, dy_r)), fine);
    let down = s.mul_d(s.sub_d(s.mul_d(dx_r, dz2), s.mul_d(dx_l, dz1)), fine);
    let (first_x, first_y) = (s.to_f(s.shl::<13>(tile_x0)), s.to_f(s.shl::<11>(tile_y0)));
    let (end_x, end_y) = (s.to_f(s.shl::<13>(s.add_i(tile_x1, s.i(1)))), s.to_f(s.shl::<11>(s.add_i(tile_y1, s.i(1)))));
    let from = s.add_d(s.mul_d(across, s.sub_d(s.to_d(first_x), x0)), s.mul_d(down, s.sub_d(s.to_d(first_y), y0)));
    let first = s.d_to_f(s.add_d(z0, from));
    let (across, down) = (s.d_to_f(across), s.d_to_f(down));
    // The margin.
    let span = s.add(boxes.widest, s.f(8192.0));
    let inexact = s.select(s.lt(s.f(INEXACT), boxes.widest), s.mul(inverse, s.f(64.0)), s.f(0.0));
    let terms = s.mul(s.mul(nearest, inverse), s.mul(span, span));
    let off = s.mul(terms, s.add(inexact, s.f(FINE_MARGIN)));
    let rise = s.add(s.mul(s.abs(across), s.sub(end_x, first_x)), s.mul(s.abs(down), s.sub(end_y, first_y)));
    let margin = s.add(off, s.mul(s.add(s.abs(first), rise), s.f(MARGIN)));
    // Per sub-tile of 8 by 4 pixels.
    let (across_sub, down_sub) = (s.mul(across, s.f(2048.0)), s.mul(down, s.f(1024.0)));
    let zero = s.f(0.0);
    let plane = if query {
        let corner = s.add(s.max(across_sub, zero), s.max(down_sub, zero));
        // A true point of the occludee has the depth of its snapped counterpart, which may lie this far away.
        let moved = s.mul(s.add(s.abs(across), s.abs(down)), s.f(QUERY_SLACK as f32));
        let plane = s.add(first, s.add(s.add(corner, moved), margin));
        s.select(flat, s.f(NOWHERE), plane)
    } else {
        let corner = s.add(s.min(across_sub, zero), s.min(down_sub, zero));
        s.add(first, s.sub(corner, margin))
    };
    store!(z, plane);
    store!(z_across, if query { s.select(flat, zero, across_sub) } else { across_sub });
    store!(z_down, if query { s.select(flat, zero, down_sub) } else { down_sub });
    store!(z_clamp, if query { nearest } else { s.mul(farthest, s.f(1.0 - VERTEX_MARGIN)) });
    store!(nearest, nearest);
    found
}

/// Exact differences from the first corner to the second and to the third.
struct Deltas<S: Simd> {
    right: (S::D, S::D),
    left: (S::D, S::D),
}

/// Twice the area, positive for clockwise corners in rows that run down; exact for coordinates up to 2^25.
#[inline(always)]
fn doubled_area<S: Simd>(s: S, v0: Corner<S>, v1: Corner<S>, v2: Corner<S>) -> (S::D, Deltas<S>) {
    let (x0, y0) = (s.to_d(v0[0]), s.to_d(v0[1]));
    let right = (s.sub_d(s.to_d(v1[0]), x0), s.sub_d(s.to_d(v1[1]), y0));
    let left = (s.sub_d(s.to_d(v2[0]), x0), s.sub_d(s.to_d(v2[1]), y0));
    let area = s.sub_d(s.mul_d(right.0, left.1), s.mul_d(left.0, right.1));
    (area, Deltas { right, left })
}

/// Of three corners, `y` where the second comes first, `z` where the third does, else `x`.
#[inline(always)]
fn turn<S: Simd>(s: S, second: S::M, third: S::M, x: Corner<S>, y: Corner<S>, z: Corner<S>) -> Corner<S> {
    [
        s.select(second, y[0], s.select(third, z[0], x[0])),
        s.select(second, y[1], s.select(third, z[1], x[1])),
        s.select(second, y[2], s.select(third, z[2], x[2])),
    ]
}

/// Constant part of an edge's event as the left bound of a row and as the right one, and its slope. `dy` is not
/// negative.
#[inline(always)]
fn edge<S: Simd>(s: S, query: bool, [x, y]: [S::D; 2], [dx, dy]: [S::D; 2]) -> [S::D; 3] {
    // A quarter stands for zero: such an edge is put nowhere by the caller.
    let inverse = s.div_d(s.d(1.0), s.max_d(dy, s.d(0.25)));
    let slope = s.mul_d(dx, inverse);
    // From the corner to row 0's centre, in rows; from pixel 0's centre (its left side for a query) to the corner.
    let rows = s.mul_d(s.sub_d(s.d(128.0), y), s.d(1.0 / 256.0));
    let columns = s.mul_d(s.sub_d(x, s.d(if query { 0.0 } else { 128.0 })), s.d(1.0 / 256.0));
    let at = s.add_d(columns, s.mul_d(slope, rows));
    if query {
        // The row's upper and lower end instead of its centre, and what snapping may have moved.
        let steep = s.max_d(slope, s.sub_d(s.d(0.0), slope));
        let slack = s.add_d(s.mul_d(steep, s.d(0.5 + 1.0 / 128.0)), s.d(1.0 / 128.0));
        [s.sub_d(at, slack), s.add_d(at, s.add_d(slack, s.d(1.0))), slope]
    } else {
        let at = s.add_d(at, s.sub_d(s.d(1.0), s.mul_d(inverse, s.d(1.0 / 512.0))));
        [at, at, slope]
    }
}

/// Nowhere for lanes in `is`, to be added to an edge's constant part.
#[inline(always)]
fn nowhere<S: Simd>(s: S, is: S::M, x: f32) -> S::D {
    s.to_d(s.select(is, s.f(x), s.f(0.0)))
}
