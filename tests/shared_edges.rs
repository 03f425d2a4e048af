//! Triangles that share edges never both cover a pixel and never leave one out: each is drawn into a clear buffer, and
//! together they must cover every pixel of the polygon around them exactly once.

mod oracle;
mod support;

use std::cell::RefCell;

use masked_occlusion_culling::MaskedOcclusionCulling;
use oracle::{Triangle, UNIT, Vertex, crossings};
use proptest::prelude::*;
use support::{check, draw, mesh, name, objects, read};

type Point = (i64, i64);

fn flat(a: Point, b: Point, c: Point) -> Triangle {
    [a, b, c].map(|(x, y)| Vertex { x, y, z: 1.0 })
}

/// How often each pixel is covered by triangles drawn one by one.
fn times_covered(moc: &mut MaskedOcclusionCulling, triangles: &[Triangle]) -> Vec<u8> {
    let mut depth = Vec::new();
    read(moc, &mut depth);
    let mut times = vec![0; depth.len()];
    for t in triangles {
        moc.clear_buffer();
        draw(moc, &[*t]);
        read(moc, &mut depth);
        times.iter_mut().zip(&depth).for_each(|(n, d)| *n += u8::from(*d >= 0.0));
    }
    times
}

/// The outline's own coverage, which is independent of the inner edges.
fn outline_covers(outline: &[Point], size: (usize, usize)) -> Vec<u8> {
    let mut cover = vec![0; size.0 * size.1];
    for row in 0..size.1 {
        for pair in crossings(outline, row as i64).chunks_exact(2) {
            let clamp = |p: i64| p.clamp(0, size.0 as i64) as usize;
            if pair[0] < pair[1] {
                cover[row * size.0..][clamp(pair[0])..clamp(pair[1])].fill(1);
            }
        }
    }
    cover
}

fn compare(
    moc: &mut MaskedOcclusionCulling,
    triangles: &[Triangle],
    outline: &[Point],
    size: (usize, usize),
) -> Result<(), String> {
    let want = outline_covers(outline, size);
    let got = times_covered(moc, triangles);
    match got.iter().zip(&want).position(|(a, b)| a != b) {
        None => Ok(()),
        Some(i) => Err(format!(
            "{}: ({}, {}) is covered {} times, not {}\n{:?}",
            name(moc),
            i % size.0,
            i / size.0,
            got[i],
            want[i],
            mesh(triangles, size, moc.y_axis()).0
        )),
    }
}

/// A point in units; `coarse` ones are on the grid of half pixels, where ties occur.
fn point(size: (usize, usize), coarse: bool) -> impl Strategy<Value = Point> + Clone {
    let step = if coarse { UNIT / 2 } else { 1 };
    let axis = move |n: usize| (-(UNIT * 4) / step..=(n as i64 + 4) * UNIT / step).prop_map(move |v| v * step);
    (axis(size.0), axis(size.1))
}

/// On which side of the line from a to b is p?
fn side(a: Point, b: Point, p: Point) -> i64 {
    ((b.0 - a.0) * (p.1 - a.1) - (b.1 - a.1) * (p.0 - a.0)).signum()
}

fn pairs(size: (usize, usize), coarse: bool, cases: u32) {
    let state = RefCell::new(objects(size));
    let p = point(size, coarse);
    check(cases, 7 + u64::from(coarse), &[p.clone(), p.clone(), p.clone(), p], |[a, b, c, d]| {
        if side(a, c, b) * side(a, c, d) >= 0 {
            return Ok(());
        }
        // The order of the corners, and so the direction in which each edge is traversed, must not matter.
        for halves in [[flat(a, b, c), flat(a, c, d)], [flat(c, a, b), flat(d, c, a)], [flat(b, a, c), flat(a, c, d)]] {
            state.borrow_mut().iter_mut().try_for_each(|moc| compare(moc, &halves, &[a, b, c, d], size))?;
        }
        Ok(())
    });
}

#[test]
fn pairs_on_the_half_pixel_grid() {
    pairs((33, 9), true, 600);
    pairs((64, 64), true, 100);
}

#[test]
fn pairs_anywhere() {
    pairs((33, 9), false, 400);
    pairs((160, 90), false, 60);
}

/// A fan around a point: the outline is star-shaped, one corner in each of eight directions.
fn fans(size: (usize, usize), coarse: bool, cases: u32) {
    const RING: [Point; 8] = [(4, 0), (3, 3), (0, 4), (-3, 3), (-4, 0), (-3, -3), (0, -4), (3, -3)];
    let state = RefCell::new(objects(size));
    let scale = UNIT / 8;
    let strategy = (point(size, coarse), proptest::array::uniform8(1..=4 * size.0.min(size.1) as i64 / 2));
    check(cases, 70 + u64::from(coarse), &strategy, |(middle, radii)| {
        let corner = |i: usize| {
            let unit = if coarse { scale * 4 } else { scale + i as i64 };
            (middle.0 + RING[i].0 * radii[i] * unit / 4, middle.1 + RING[i].1 * radii[i] * unit / 4)
        };
        let outline: Vec<Point> = (0..8).map(corner).collect();
        let triangles: Vec<Triangle> = (0..8).map(|i| flat(middle, outline[i], outline[(i + 1) % 8])).collect();
        state.borrow_mut().iter_mut().try_for_each(|moc| compare(moc, &triangles, &outline, size))
    });
}

#[test]
fn fans_on_the_half_pixel_grid() {
    fans((40, 24), true, 80);
}

#[test]
fn fans_anywhere() {
    fans((40, 24), false, 120);
}
