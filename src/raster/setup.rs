//! Edges and depth plane of a vector of triangles.
//!
//! **Edges.** With the topmost corner first and the corners clockwise, row `r` of pixels is covered from the largest of
//! its left events to the smallest of its right events. The event of an edge is the first pixel whose centre is on or
//! to the right of it, for both sides; that is the top-left rule. It is the floor of `x + slope * r` in f64. The exact
//! value has a denominator of `256 * |dy|`; a bias of `1 - 1 / (512 * |dy|)` turns the ceiling into a floor with a
//! tolerance of half a denominator either way. With coordinates up to 2^23 (32,768 pixels) and 2^14 rows, the rounding
//! errors sum to less than a third of the tolerance, so the event is exact, and a fused multiply-add, which rounds less
//! often, gives the same result. Wider triangles go through `wide_edges.rs`, where the constant part is rounded once. A
//! horizontal edge bounds nothing; the range of rows, which is exact, does.
//!
//! **Depth.** 1/w is a plane on the screen. For each sub-tile, exact coverage needs a bound that is not nearer than the
//! triangle anywhere in the sub-tile; conservative coverage needs one that is not farther. The bound is the plane at
//! the farthest (nearest) corner, less (plus) a margin for rounding, limited to the farthest (nearest) vertex. The
//! slopes and the value at the anchor, which is the corner of the bounds' first tile, are computed in f64 from exact
//! differences and rounded once. In f32, cancellation would cost a percent or more of the depth of floors and walls
//! that reach behind the eye, because their vertices on the near plane are far away and much nearer than what is on the
//! screen.
//!
//! Let `u = 2^-24`, `Z` the nearest vertex, and `s` the largest coordinate plus a tile's width, so that no two of the
//! points here are farther apart than `2 s`. The terms of the value at the anchor sum to at most `Z + 16 Z s^2 / area`,
//! which is below `24 Z s^2 / area`. The quotient comes from f32 by one Newton iteration and has an error of `2^-46`,
//! and the roundings in f64 are far smaller: together less than `2^-40 Z s^2 / area`. Beyond 2^25 the area is not
//! exact, but its error is at most 2, which adds less than `4 / area` of those terms. For a computed area of 3 and a
//! true one of 1 the terms themselves are off by a factor of 3, and the bound still holds: the real rise of a plane
//! whose depths lie in `[0, Z]` is at most `8 Z s^2 / area`, and the computed value differs from it by no more than the
//! error's share of that. The remaining errors scale with the screen, with at most `a = |anchor| + |slope across| *
//! width of the bounds + |slope down| * height of the bounds`: rounding the three values, the corner, the margin and
//! the steps to the sub-tile sums to at most `10 u a`, and a vertex's depth adds one more `u a`. The margin is `16 u a`
//! plus the f64 term above. On slivers it is large, and the clamp decides.

use super::batch::Batch;
use super::hiz_test::{self, HizScope};
use super::wide_edges;
use crate::buffer::Buffer;
use crate::geometry::coverage::{DepthPlane, Sides, UNBOUNDED, WIDE, where_d};
use crate::geometry::{Corner, Coverage, ScreenBounds};
use crate::simd::Simd;

/// Beyond this, in 1/256 pixel, the area is not exact.
const INEXACT: f32 = (1 << 25) as f32;
/// 16 roundings of f32.
const MARGIN: f32 = 16.0 / (1 << 24) as f32;
/// Error of the f64 computation, see above.
const FINE_MARGIN: f32 = 1.0 / (1_u64 << 40) as f32;

/// The result of set-up, a bit per lane.
#[derive(Clone, Copy)]
pub(crate) struct Alive {
    /// Front-facing triangles whose bounds hold a pixel; all others are ignored. If all are hidden and those are
    /// skipped, they may face either way.
    pub rasterized: u32,
    /// Those of them that the HiZ does not hide.
    pub lanes: u32,
}

/// How a call's triangles are set up.
#[derive(Clone, Copy)]
pub(crate) struct Setup<'a, S> {
    pub s: S,
    pub buffer: &'a Buffer,
    /// Corners may be in either order.
    pub both_sides: bool,
}

/// A vector of triangles with the topmost corner first and the corners clockwise with y down.
struct Oriented<S: Simd> {
    corners: [Corner<S>; 3],
    /// Twice the area; exact for coordinates up to 2^25.
    area: S::D,
    deltas: Deltas<S>,
}

impl<S: Simd> Oriented<S> {
    #[inline(always)]
    fn new(s: S, both_sides: bool, [a, b, c]: [Corner<S>; 3]) -> Self {
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
        let (area, deltas) = doubled_area(s, v0, v1, v2);
        Self { corners: [v0, v1, v2], area, deltas }
    }

    /// Returns the lanes that count. Stores the corners wherever these lanes or later steps need them, and the tiles of
    /// the bounds.
    #[inline(always)]
    fn facing<C: Coverage, const ALWAYS_STORE: bool>(
        &self,
        s: S,
        bounds: &ScreenBounds<S>,
        active: S::M,
        batch: &mut Batch,
    ) -> (u32, u32) {
        let inside = s.and_m(active, bounds.inside);
        let alive = C::counts(s, inside, s.d_to_f(self.area));
        let wide = if C::MAY_BE_WIDE { s.mask_bits(s.and_m(s.lt(s.f(WIDE), bounds.widest), active)) } else { 0 };
        if ALWAYS_STORE || wide != 0 {
            for (lanes, &value) in batch.corners.iter_mut().zip(self.corners.as_flattened()) {
                // SAFETY: the arrays of a batch hold the lanes of any vector.
                unsafe { s.store_f(lanes.as_mut_ptr(), value) };
            }
        }
        let mut lanes = s.mask_bits(alive);
        if wide != 0 {
            // For a triangle this wide, the sign of the area may be wrong in f64.
            // SAFETY: as there are wide triangles, the corners were stored above.
            lanes = unsafe { wide_edges::correct_facing(batch, lanes, wide & s.mask_bits(inside)) };
        }
        // SAFETY: as above.
        unsafe {
            s.store_i(batch.tile_x0.as_mut_ptr(), bounds.tile_x0);
            s.store_i(batch.tile_x1.as_mut_ptr(), bounds.tile_x1);
            s.store_i(batch.tile_y0.as_mut_ptr(), bounds.tile_y0);
            s.store_i(batch.tile_y1.as_mut_ptr(), bounds.tile_y1);
        }
        (lanes, wide)
    }
}

/// Orients the triangles in `active` and stores their corners and the tiles of their bounds, but no edges: for lists.
/// The other lanes may hold anything. Returns the lanes that count.
#[inline(always)]
pub(crate) fn orient<S: Simd, C: Coverage>(
    setup: Setup<'_, S>,
    corners: [Corner<S>; 3],
    active: S::M,
    batch: &mut Batch,
) -> u32 {
    let Setup { s, buffer, both_sides } = setup;
    let bounds = ScreenBounds::new::<C>(s, buffer.size(), &corners);
    Oriented::new(s, both_sides, corners).facing::<C, true>(s, &bounds, active, batch).0
}

/// Sets up the triangles in `active`; the other lanes may hold anything. `skip_hidden`: hidden triangles need no edges.
#[inline(always)]
pub(crate) fn set_up<S: Simd, C: Coverage>(
    setup: Setup<'_, S>,
    scope: HizScope,
    corners: [Corner<S>; 3],
    active: S::M,
    skip_hidden: bool,
    batch: &mut Batch,
) -> Alive {
    let Setup { s, buffer, both_sides } = setup;
    let bounds = ScreenBounds::new::<C>(s, buffer.size(), &corners);
    // SAFETY: `z_min` is read word by word, which is allowed while others draw (see `Region`); the scope's tiles
    // are the buffer's.
    let hidden = s.mask_bits(unsafe { hiz_test::hidden::<S, C, false>(s, buffer, scope, &bounds) });
    let inside = s.mask_bits(s.and_m(active, bounds.inside));
    if skip_hidden && inside & !hidden == 0 {
        return Alive { rasterized: inside, lanes: 0 };
    }
    let oriented = Oriented::new(s, both_sides, corners);
    let (rasterized, wide) = oriented.facing::<C, false>(s, &bounds, active, batch);
    let lanes = rasterized & !hidden;
    if lanes != 0 {
        edges_and_depth::<S, C>(s, &bounds, &oriented, active, lanes & wide, batch);
    }
    Alive { rasterized, lanes }
}

/// Edges and depth planes of a vector of triangles; the lanes in `wide` get theirs by integer arithmetic.
#[inline(always)]
fn edges_and_depth<S: Simd, C: Coverage>(
    s: S,
    bounds: &ScreenBounds<S>,
    oriented: &Oriented<S>,
    active: S::M,
    wide: u32,
    batch: &mut Batch,
) {
    let &ScreenBounds { column0, column1, row0, row1, tile_x0, tile_x1, tile_y0, tile_y1, nearest, .. } = bounds;
    let &Oriented { corners: [v0, v1, v2], area: exact_area, ref deltas } = oriented;
    let area = s.d_to_f(exact_area);
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
    // Edges.
    let &Deltas { right: (dx_r, dy_r), left: (dx_l, dy_l) } = deltas;
    let (x0, y0, x1, y1) = (s.to_d(v0[0]), s.to_d(v0[1]), s.to_d(v1[0]), s.to_d(v1[1]));
    let down = s.lt(v1[1], v2[1]);
    let up = s.lt(v2[1], v1[1]);
    let sign = s.to_d(s.select(down, s.f(1.0), s.f(-1.0)));
    let (dx_m, dy_m) = (s.mul_d(s.sub_d(dx_l, dx_r), sign), s.mul_d(s.sub_d(dy_l, dy_r), sign));
    let degenerate = C::degenerate(s, active, area);
    macro_rules! store_edge {
        ($field:ident, $value:expr) => {
            let value = $value;
            store!(d $field, value);
            // SAFETY: as above.
            unsafe { s.store_f(batch.rounded.$field.as_mut_ptr(), s.d_to_f(value)) }
        };
    }
    let [_, right, right_slope] = C::edge(s, [x0, y0], [dx_r, dy_r]);
    let [left, _, left_slope] = C::edge(s, [x0, y0], [dx_l, dy_l]);
    // A horizontal edge bounds nothing.
    let right = s.add_d(right, where_d(s, s.eq(v0[1], v1[1]), UNBOUNDED));
    let left = s.add_d(left, where_d(s, s.eq(v0[1], v2[1]), -UNBOUNDED));
    let sides = Sides { left, left_slope, right, right_slope };
    let Sides { left, left_slope, right, right_slope } = C::open_degenerate(s, degenerate, sides);
    store_edge!(right, right);
    store_edge!(right_slope, right_slope);
    store_edge!(left, left);
    store_edge!(left_slope, left_slope);
    let [middle_left, middle_right, middle_slope] = C::edge(s, [x1, y1], [dx_m, dy_m]);
    let all = s.le(s.f(0.0), s.f(0.0));
    store_edge!(middle_left, s.add_d(middle_left, where_d(s, s.or_m(degenerate, s.and_not_m(up, all)), -UNBOUNDED)));
    store_edge!(middle_right, s.add_d(middle_right, where_d(s, s.or_m(degenerate, s.and_not_m(down, all)), UNBOUNDED)));
    store_edge!(middle_slope, middle_slope);
    store!(row0, s.to_f(row0));
    store!(row1, s.to_f(row1));
    store!(i column0, column0);
    store!(i column1, column1);
    if C::MAY_BE_WIDE {
        // SAFETY: where there are wide triangles, `Oriented::facing` stored the corners.
        unsafe { wide_edges::replace_wide(batch, wide) };
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
    let span = s.add(bounds.widest, s.f(8192.0));
    let inexact = s.select(s.lt(s.f(INEXACT), bounds.widest), s.mul(inverse, s.f(64.0)), s.f(0.0));
    let terms = s.mul(s.mul(nearest, inverse), s.mul(span, span));
    let off = s.mul(terms, s.add(inexact, s.f(FINE_MARGIN)));
    let rise = s.add(s.mul(s.abs(across), s.sub(end_x, first_x)), s.mul(s.abs(down), s.sub(end_y, first_y)));
    let margin = s.add(off, s.mul(s.add(s.abs(first), rise), s.f(MARGIN)));
    // Per 8x4 sub-tile.
    let (across_sub_tile, down_sub_tile) = (s.mul(across, s.f(2048.0)), s.mul(down, s.f(1024.0)));
    let plane = DepthPlane { first, across, down, across_sub_tile, down_sub_tile, margin };
    let [bound, across, down] = C::depth_bound(s, degenerate, &plane);
    store!(z, bound);
    store!(z_across, across);
    store!(z_down, down);
    store!(z_limit, C::depth_limit(s, farthest, nearest));
    store!(nearest, nearest);
}

/// Exact differences from the first corner to the second and to the third.
struct Deltas<S: Simd> {
    right: (S::D, S::D),
    left: (S::D, S::D),
}

/// Twice the area, positive for clockwise corners with y down; exact for coordinates up to 2^25.
#[inline(always)]
fn doubled_area<S: Simd>(s: S, v0: Corner<S>, v1: Corner<S>, v2: Corner<S>) -> (S::D, Deltas<S>) {
    let (x0, y0) = (s.to_d(v0[0]), s.to_d(v0[1]));
    let right = (s.sub_d(s.to_d(v1[0]), x0), s.sub_d(s.to_d(v1[1]), y0));
    let left = (s.sub_d(s.to_d(v2[0]), x0), s.sub_d(s.to_d(v2[1]), y0));
    let area = s.sub_d(s.mul_d(right.0, left.1), s.mul_d(left.0, right.1));
    (area, Deltas { right, left })
}

/// Selects by which corner comes first: `y` where it is the second, `z` where it is the third, else `x`.
#[inline(always)]
fn turn<S: Simd>(s: S, second: S::M, third: S::M, x: Corner<S>, y: Corner<S>, z: Corner<S>) -> Corner<S> {
    [
        s.select(second, y[0], s.select(third, z[0], x[0])),
        s.select(second, y[1], s.select(third, z[1], x[1])),
        s.select(second, y[2], s.select(third, z[2], x[2])),
    ]
}

#[cfg(test)]
mod tests {
    use fastrand::Rng;

    use super::*;
    use crate::buffer::Buffer;
    use crate::geometry::{Conservative, Exact};
    use crate::raster::bits;
    use crate::simd::{Job, Level, MAX_LANES, run};
    use crate::{Allocator, UpdateRule};

    type Triangle = [[f32; 3]; 3];

    /// Sets up a vector of triangles and passes the index and batch lane of each one that counts to the closure.
    struct SetUp<'a, F>(&'a Buffer, &'a [Triangle; MAX_LANES], F);

    struct Checked<'a, C, F>(SetUp<'a, F>, core::marker::PhantomData<C>);

    impl<C: Coverage, F: FnMut(&Triangle, &Batch, usize)> Job for Checked<'_, C, F> {
        type Output = ();

        #[inline(always)]
        fn run<S: Simd>(self, s: S) {
            let SetUp(buffer, triangles, mut check) = self.0;
            let scope = HizScope { clip: buffer.all_tiles(), coarse: false };
            for first in (0..MAX_LANES).step_by(S::LANES) {
                let mut lanes = [[0.0_f32; MAX_LANES]; 9];
                for (k, lanes) in lanes.iter_mut().enumerate() {
                    for lane in 0..S::LANES {
                        lanes[lane] = triangles[first + lane][k / 3][k % 3];
                    }
                }
                // SAFETY: sixteen floats hold a vector.
                let corner = |k: usize| [0, 1, 2].map(|j| unsafe { s.load_f(lanes[3 * k + j].as_ptr()) });
                let mut batch = Batch::uninit();
                let setup = Setup { s, buffer, both_sides: false };
                let corners = [corner(0), corner(1), corner(2)];
                let alive = set_up::<S, C>(setup, scope, corners, s.first(S::LANES), false, &mut batch);
                for lane in bits(alive.lanes) {
                    check(&triangles[first + lane], &batch, lane);
                }
            }
        }
    }

    fn triangles(rng: &mut Rng, size: i32, around: i32) -> [Triangle; MAX_LANES] {
        core::array::from_fn(|_| {
            let mut corner =
                || [rng.i32(around - size..=around + size) as f32, rng.i32(-size..=size) as f32, 0.1 + rng.f32()];
            let (a, b, c) = (corner(), corner(), corner());
            [a, b, c]
        })
    }

    fn cross(a: [f32; 3], b: [f32; 3], x: i128, y: i128) -> i128 {
        let [ax, ay, bx, by] = [a[0], a[1], b[0], b[1]].map(|x| x as i128);
        (bx - ax) * (y - ay) - (x - ax) * (by - ay)
    }

    /// Compares a row's events with the exact top-left rule at every pixel near them.
    #[test]
    fn events_are_exact() {
        let buffer = Buffer::new(640, 400, UpdateRule::ThreeLayer, Allocator::SYSTEM, false).unwrap();
        for level in Level::all() {
            let mut rng = Rng::with_seed(4);
            let mut rows = 0;
            for size in [40, 300, 5_000, 100_000, 8_000_000, 60_000_000] {
                for _ in 0..60 {
                    let triangles = triangles(&mut rng, size, 80_000);
                    let check = |t: &Triangle, batch: &Batch, lane: usize| {
                        // SAFETY: set-up stored the lane.
                        let get = |lanes: &crate::raster::batch::Lanes<f64>| unsafe { lanes.get(lane) };
                        let (row0, row1) = unsafe { (batch.row0.get(lane) as i64, batch.row1.get(lane) as i64) };
                        for row in [row0, (row0 + row1) / 2, row1 - 1] {
                            let at = |c: f64, slope: f64| (c + slope * row as f64).clamp(-1.0, 641.0).floor() as i128;
                            let left = at(get(&batch.left), get(&batch.left_slope))
                                .max(at(get(&batch.middle_left), get(&batch.middle_slope)));
                            let right = at(get(&batch.right), get(&batch.right_slope))
                                .min(at(get(&batch.middle_right), get(&batch.middle_slope)));
                            for pixel in [left - 1, left, left + 1, right - 1, right, right + 1] {
                                if !(0..640).contains(&pixel) {
                                    continue;
                                }
                                let (x, y) = (256 * pixel + 128, 256 * i128::from(row) + 128);
                                let covered = (0..3).all(|k| {
                                    let (a, b) = (t[k], t[(k + 1) % 3]);
                                    let side = cross(a, b, x, y);
                                    // Clockwise with y down: a top edge runs right, a left edge runs up.
                                    let top_left = b[1] < a[1] || (b[1] == a[1] && b[0] > a[0]);
                                    side > 0 || (side == 0 && top_left)
                                });
                                assert_eq!(
                                    (left..right).contains(&pixel),
                                    covered,
                                    "{level:?} {t:?} row {row} pixel {pixel}"
                                );
                            }
                            rows += 1;
                        }
                    };
                    run(level, Checked::<Exact, _>(SetUp(&buffer, &triangles, check), core::marker::PhantomData));
                }
            }
            assert!(rows > 3_000, "{rows}");
        }
    }

    /// Compares the depth bound at every corner of a few sub-tiles with the plane in f64.
    fn bounds_hold<C: Coverage>(size: i32, holds: impl Fn(f64, f64) -> bool) {
        let buffer = Buffer::new(640, 400, UpdateRule::ThreeLayer, Allocator::SYSTEM, false).unwrap();
        for level in Level::all() {
            let (mut rng, mut compared) = (Rng::with_seed(5), 0);
            for _ in 0..100 {
                let triangles = triangles(&mut rng, size, 80_000);
                let check = |t: &Triangle, batch: &Batch, lane: usize| {
                    let [[x0, y0, z0], [x1, y1, z1], [x2, y2, z2]] = t.map(|v| v.map(f64::from));
                    let area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0);
                    if area < 1e4 {
                        return;
                    }
                    let across = ((z1 - z0) * (y2 - y0) - (z2 - z0) * (y1 - y0)) / area;
                    let down = ((x1 - x0) * (z2 - z0) - (x2 - x0) * (z1 - z0)) / area;
                    // SAFETY: set-up stored the lane.
                    let [z, z_across, z_down] =
                        unsafe { [batch.z.get(lane), batch.z_across.get(lane), batch.z_down.get(lane)] };
                    // SAFETY: it was set up.
                    let [tile_x0, _, tile_y0, _] = unsafe { batch.tiles(lane) };
                    for (column, row) in [(0, 0), (1, 0), (0, 1), (3, 2)] {
                        let bound = f64::from(z + z_down * row as f32 + z_across * column as f32);
                        for (x, y) in [(0, 0), (8, 0), (0, 4), (8, 4)] {
                            let px = f64::from((tile_x0 * 32 + column * 8 + x) * 256);
                            let py = f64::from((tile_y0 * 8 + row * 4 + y) * 256);
                            assert!(holds(bound, z0 + across * (px - x0) + down * (py - y0)), "{level:?} {t:?}");
                        }
                    }
                    compared += 1;
                };
                run(level, Checked::<C, _>(SetUp(&buffer, &triangles, check), core::marker::PhantomData));
            }
            assert!(compared > 100, "{compared}");
        }
    }

    #[test]
    fn a_draw_s_depth_bound_is_never_nearer_than_the_plane() {
        for size in [2_000, 50_000, 4_000_000] {
            bounds_hold::<Exact>(size, |bound, plane| bound <= plane);
        }
    }

    #[test]
    fn a_query_s_depth_bound_is_never_farther_than_the_plane() {
        for size in [2_000, 50_000, 4_000_000] {
            bounds_hold::<Conservative>(size, |bound, plane| bound >= plane);
        }
    }
}
