//! The oracle's own check: its spans against the same rule as signs of edge functions, and its ray intersection
//! against its spans. A wrong oracle would pass wrong pixels.

mod oracle;
mod support;

use oracle::homogeneous::{Homogeneous, Place};
use oracle::{Triangle, UNIT, area, depth_at_pixel, span};
use support::triangles::of_any_kind;
use support::{check, clip_vertex};

const SIZE: (usize, usize) = (64, 32);

/// Inside by the signs of the three edges; what lies on an edge belongs to left ones and to those at the start of
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
            let axis = if y_up { masked_occlusion_culling::YAxis::Up } else { masked_occlusion_culling::YAxis::Down };
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
