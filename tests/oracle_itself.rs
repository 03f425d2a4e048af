//! Checks the oracle itself: its spans against the same rule expressed by signs of edge functions, and its ray
//! intersection against its spans. A wrong oracle would accept wrong pixels.

mod oracle;
mod support;

use masked_occlusion_culling::YAxis;
use oracle::bounds::{inside_by, plane_at, ulp};
use oracle::homogeneous::{Homogeneous, Place};
use oracle::snap::snapped;
use oracle::{Triangle, UNIT, area, depth_at_pixel, span};
use support::triangles::of_any_kind;
use support::{check, clip_vertex};

const SIZE: (usize, usize) = (64, 32);

/// Inside by the signs of the three edge functions; points on an edge belong to left edges and to those at the start of
/// the rows.
fn by_signs(t: &Triangle, column: usize, row: usize) -> bool {
    let (x, y) = (column as i64 * UNIT + UNIT / 2, row as i64 * UNIT + UNIT / 2);
    let mut t = *t;
    if area(&t) < 0 {
        t.swap(1, 2);
    }
    area(&t) != 0
        && (0..3).all(|i| {
            let (a, b) = (&t[i], &t[(i + 1) % 3]);
            let (dx, dy) = (b.x - a.x, b.y - a.y);
            let e = dx * (y - a.y) - dy * (x - a.x);
            e > 0 || e == 0 && (dy < 0 || dy == 0 && dx > 0)
        })
}

#[test]
fn spans_are_the_signs_of_the_edges() {
    check(3000, 1, &of_any_kind(SIZE), |t| {
        for row in 0..SIZE.1 {
            let span = span(&t, row, SIZE.0);
            for column in 0..SIZE.0 {
                if span.contains(&column) != by_signs(&t, column, row) {
                    return Err(format!("({column}, {row})"));
                }
            }
        }
        Ok(())
    });
}

#[test]
fn rays_meet_what_spans_cover() {
    check(1000, 2, &of_any_kind(SIZE), |t| {
        for y_up in [false, true] {
            let axis = if y_up { YAxis::Up } else { YAxis::Down };
            let clip = t.map(|v| clip_vertex(&v, SIZE, axis)).map(|[x, y, _, w]| [x, y, w].map(f64::from));
            let Some(rays) = Homogeneous::new(&clip, 0.0, SIZE, y_up) else { continue };
            for row in 0..SIZE.1 {
                let span = span(&t, row, SIZE.0);
                for column in 0..SIZE.0 {
                    let inside = span.contains(&column);
                    let place = rays.place(column, row, 1e-6);
                    if inside && place == Place::Outside || !inside && place == Place::Inside {
                        return Err(format!("({column}, {row}) is {place:?}"));
                    }
                    let (one, other) = (depth_at_pixel(&t, column, row), rays.depth(column, row));
                    if inside && (one - other).abs() > 1e-6 * one {
                        return Err(format!("({column}, {row}) is at {one:e} or {other:e}"));
                    }
                }
            }
        }
        Ok(())
    });
}

/// The distances by which wrong pixels are judged have the sign of the coverage, and both oracles give the same
/// distance.
#[test]
fn distances_have_the_sign_of_the_spans() {
    check(1000, 3, &of_any_kind(SIZE), |t| {
        if area(&t) == 0 {
            return Ok(());
        }
        let clip = t.map(|v| clip_vertex(&v, SIZE, YAxis::Down)).map(|[x, y, _, w]| [x, y, w].map(f64::from));
        let rays = Homogeneous::new(&clip, 0.0, SIZE, false);
        for row in 0..SIZE.1 {
            let span = span(&t, row, SIZE.0);
            for column in 0..SIZE.0 {
                let distance = inside_by(&t, column, row);
                if distance > 0.0 && !span.contains(&column) || distance < 0.0 && span.contains(&column) {
                    return Err(format!("({column}, {row}) is inside by {distance:e}"));
                }
                let Some(rays) = &rays else { continue };
                let other = rays.inside_by(column, row);
                if (distance - other).abs() > 1e-6 * (1.0 + distance.abs()) {
                    return Err(format!("({column}, {row}) is inside by {distance:e} or {other:e}"));
                }
            }
        }
        Ok(())
    });
}

/// The plane in twice double precision matches the barycentric weights within the triangle, and passes through the corners.
#[test]
fn planes_go_through_their_corners() {
    check(1000, 4, &of_any_kind(SIZE), |t| {
        if area(&t) == 0 {
            return Ok(());
        }
        let middle = |f: fn(&oracle::Vertex) -> i64| t.iter().map(f).sum::<i64>() / 3;
        let mut places = t.map(|v| (v.x, v.y, v.z)).to_vec();
        let (x, y) = (middle(|v| v.x), middle(|v| v.y));
        // A rounded midpoint may be outside a sliver, where the plain sum cancels.
        let thick = area(&t).abs() > 1 << 20;
        places.extend(thick.then(|| (x, y, oracle::depth_at(&t, x, y))));
        match places.iter().find(|&&(x, y, z)| (plane_at(&t, x, y) - z).abs() > 1e-12 * z.abs()) {
            None => Ok(()),
            Some((x, y, z)) => Err(format!("at ({x}, {y}) it is {:e}, not {z:e}", plane_at(&t, *x, *y))),
        }
    });
}

/// Vertices made to land on the grid do, and those halfway between two grid points are ambiguous.
#[test]
fn vertices_snap_to_the_grid() {
    check(1000, 5, &of_any_kind(SIZE), |t| {
        for (axis, y_up) in [(YAxis::Down, false), (YAxis::Up, true)] {
            for v in t {
                let clip = clip_vertex(&v, SIZE, axis);
                if snapped(clip, SIZE, y_up) != Some(v) {
                    return Err(format!("{v:?} snaps to {:?}", snapped(clip, SIZE, y_up)));
                }
                // Half a unit further: x times 2 / 64 / 256 / 2.
                let between = [clip[0] + clip[3] / 16_384.0, clip[1], 0.0, clip[3]];
                if v.x.abs() < 1 << 14 && snapped(between, SIZE, y_up).is_some() {
                    return Err(format!("{v:?} and half a unit is not in doubt"));
                }
            }
        }
        Ok(())
    });
}

#[test]
fn units_in_the_last_place() {
    for x in [1.0f32, 1.5, 0.999_999_94, 3.0e-7, 1.0e30, f32::MIN_POSITIVE] {
        assert_eq!(ulp(x.into()), f64::from(x.next_up()) - f64::from(x), "{x}");
    }
    // Between two numbers, it is their distance.
    assert_eq!(ulp(1.999_999_99), f64::from(f32::EPSILON));
    assert_eq!(ulp(2.0), 2.0 * f64::from(f32::EPSILON));
}
