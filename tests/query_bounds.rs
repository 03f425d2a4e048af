//! The tightest case for a query: a wall hides all of an occludee except the part in one block of 8x4 pixels, where the
//! wall is just behind the occludee's nearest point. That point is visible, so the answer must never be hidden.

mod oracle;
mod support;

use std::cell::RefCell;

use masked_occlusion_culling::{
    CullingResult, DrawOptions, Implementation, MaskedOcclusionCulling, Settings, Vertices, YAxis,
};
use oracle::{Triangle, UNIT, Vertex};
use proptest::prelude::*;
use support::{AXES, RULES, check, draw, name, object, test_clip};

const SIZE: (usize, usize) = (64, 32);
const BLOCK: (usize, usize) = (8, 4);

/// x and y in pixels, with the object's row direction, and 1/w.
type Point = [f64; 3];

fn to_screen([x, y, w]: [f32; 3], axis: YAxis) -> Point {
    let [x, y, w] = [x, y, w].map(f64::from);
    let y = if axis == YAxis::Up { y } else { -y };
    [(x / w * 0.5 + 0.5) * SIZE.0 as f64, (y / w * 0.5 + 0.5) * SIZE.1 as f64, 1.0 / w]
}

/// The part of a polygon in which `sign` times the coordinate is at least `sign` times `bound`.
fn cut(polygon: &[Point], coordinate: usize, sign: f64, bound: f64) -> Vec<Point> {
    let mut out = Vec::new();
    for (i, a) in polygon.iter().enumerate() {
        let b = &polygon[(i + 1) % polygon.len()];
        let distance = |p: &Point| sign * (p[coordinate] - bound);
        let (da, db) = (distance(a), distance(b));
        if da >= 0.0 {
            out.push(*a);
        }
        if (da >= 0.0) != (db >= 0.0) {
            let t = da / (da - db);
            out.push([0, 1, 2].map(|k| a[k] + t * (b[k] - a[k])));
        }
    }
    out
}

/// The nearest 1/w of a triangle within a block, well away from the block's edges.
fn nearest_in(t: &[Point; 3], block: (usize, usize)) -> Option<f64> {
    const INSIDE: f64 = 1e-4;
    let mut polygon = t.to_vec();
    for (k, index, step) in [(0, block.0, BLOCK.0), (1, block.1, BLOCK.1)] {
        polygon = cut(&polygon, k, 1.0, (index * step) as f64 + INSIDE);
        polygon = cut(&polygon, k, -1.0, ((index + 1) * step) as f64 - INSIDE);
    }
    polygon.iter().map(|p| p[2]).reduce(f64::max)
}

/// A rectangle of pixels, at one depth.
fn rectangle(x: (usize, usize), y: (usize, usize), z: f64) -> [Triangle; 2] {
    let corner = |x: usize, y: usize| Vertex { x: x as i64 * UNIT, y: y as i64 * UNIT, z };
    let (a, b, c, d) = (corner(x.0, y.0), corner(x.1, y.0), corner(x.1, y.1), corner(x.0, y.1));
    [[a, b, c], [a, c, d]]
}

/// Hides everything outside one block with `near`, and that block with `z`.
fn walls(moc: &mut MaskedOcclusionCulling, block: (usize, usize), z: f64, near: f64) {
    let (x0, y0) = (block.0 * BLOCK.0, block.1 * BLOCK.1);
    let (x1, y1) = (x0 + BLOCK.0, y0 + BLOCK.1);
    let (w, h) = SIZE;
    moc.clear_buffer();
    for (x, y, z) in [
        ((x0, x1), (y0, y1), z),
        ((0, x0), (0, h), near),
        ((x1, w), (0, h), near),
        ((x0, x1), (0, y0), near),
        ((x0, x1), (y1, h), near),
    ] {
        if x.0 < x.1 && y.0 < y.1 {
            draw(moc, &rectangle(x, y, z));
        }
    }
}

fn compare(moc: &mut MaskedOcclusionCulling, v: &[[f32; 3]; 3], block: (usize, usize)) -> Result<(), String> {
    let screen = v.map(|v| to_screen(v, moc.y_axis()));
    let Some(nearest) = nearest_in(&screen, block) else { return Ok(()) };
    let clip = v.map(|[x, y, w]| [x, y, 0.0, w]);
    // Behind by what converting to 1/w and back loses in single precision, and no more.
    walls(moc, block, nearest * (1.0 - 4e-7), 4.0);
    if test_clip(moc, &clip) != CullingResult::Visible {
        return Err(format!("{}: in block {block:?} it shows at {nearest:e}\n{v:?}", name(moc)));
    }
    // A wall in front of all its corners hides it.
    let corner = screen.iter().map(|p| p[2]).fold(0.0, f64::max);
    walls(moc, block, corner * 1.001, 4.0);
    if test_clip(moc, &clip) == CullingResult::Visible {
        return Err(format!("{}: in block {block:?} it is hidden\n{v:?}", name(moc)));
    }
    Ok(())
}

fn run(cases: u32, seed: u64, corner: impl Strategy<Value = [f32; 3]> + Clone) {
    let objects: Vec<_> = Implementation::available()
        .iter()
        .flat_map(|&i| RULES.map(|rule| AXES.map(|axis| object(i, rule, axis, SIZE))))
        .flatten()
        .collect();
    let objects = RefCell::new(objects);
    let triangle = [corner.clone(), corner.clone(), corner];
    let block = (0..SIZE.0 / BLOCK.0, 0..SIZE.1 / BLOCK.1);
    check(cases, seed, &(triangle, block), |(v, block)| {
        objects.borrow_mut().iter_mut().try_for_each(|moc| compare(moc, &v, block))
    });
}

/// Depths from 0.3 to 3: steep planes.
#[test]
fn steep_occludees() {
    run(1500, 1, (-1.0..1.0f32, -1.0..1.0f32, 0.3..3.0f32).prop_map(|(x, y, w)| [x * w, y * w, w]));
}

#[test]
fn gentle_occludees() {
    run(1000, 2, (-1.0..1.0f32, -1.0..1.0f32, 1.9..2.1f32).prop_map(|(x, y, w)| [x * w, y * w, w]));
}

#[test]
fn thin_occludees() {
    run(1000, 3, (-1.0..1.0f32, -0.01..0.01f32, 0.3..3.0f32).prop_map(|(x, y, w)| [x * w, y * w, w]));
    run(1000, 4, (0.2..0.21f32, -1.0..1.0f32, 0.3..3.0f32).prop_map(|(x, y, w)| [x * w, y * w, w]));
}

#[test]
fn occludees_that_leave_the_screen() {
    run(1000, 5, (-40.0..40.0f32, -40.0..40.0f32, 0.3..3.0f32).prop_map(|(x, y, w)| [x * w, y * w, w]));
}

/// Walls left and right of a gap given in pixels of a screen: the answer of an object of another size for a rectangle
/// behind it.
fn behind_a_gap((width, height): (u32, u32), screen: f32, gap: (f32, f32), rectangle: (f32, f32)) -> CullingResult {
    let mut moc = MaskedOcclusionCulling::new(width, height, Settings::default()).unwrap();
    let ndc = |pixel: f32| pixel / screen * 2.0 - 1.0;
    for (x0, x1) in [(-1.0, ndc(gap.0)), (ndc(gap.1), 1.0)] {
        let wall = [[x0, -1.0, 0.0, 1.0], [x1, -1.0, 0.0, 1.0], [x1, 1.0, 0.0, 1.0], [x0, 1.0, 0.0, 1.0]];
        moc.render_triangles(Vertices::clip_space(&wall), &[0, 1, 2, 0, 2, 3], &DrawOptions::default()).unwrap();
    }
    moc.test_rect(ndc(rectangle.0), -0.5, ndc(rectangle.1), 0.5, 2.0)
}

/// The limit of the guarantee in buffers smaller than the screen, as described in docs/guide.md.
#[test]
fn a_gap_closes_in_a_buffer_whose_pixels_are_wider() {
    let (screen, gap) = (1920.0, (600.5, 605.5));
    let behind = (500.0, 700.0);
    assert_eq!(behind_a_gap((1920, 1080), screen, gap, behind), CullingResult::Visible);
    // A pixel of this buffer is six screen pixels wide: it has centres at 597 and 603, and the gap is open at 603.
    assert_eq!(behind_a_gap((320, 180), screen, gap, behind), CullingResult::Visible);
    // The gap is between two centres.
    assert_eq!(behind_a_gap((320, 180), screen, (597.5, 602.5), behind), CullingResult::Occluded);
    assert_eq!(behind_a_gap((640, 360), screen, (597.5, 602.5), behind), CullingResult::Visible);
}

/// The guide's remedy for straight silhouettes: a rectangle enlarged by one buffer pixel on each side.
#[test]
fn a_larger_rectangle_makes_up_for_a_straight_edge_between_pixel_centres() {
    let (screen, pixel) = (1920.0, 6.0);
    let mut culled = 0;
    for step in 0..48 {
        // The right wall begins outside the screen.
        let gap = (600.0 + step as f32 / 8.0, 3000.0);
        let sticks_out = (500.0, gap.0 + 0.25);
        culled += u32::from(behind_a_gap((320, 180), screen, gap, sticks_out) == CullingResult::Occluded);
        let larger = (sticks_out.0 - pixel, sticks_out.1 + pixel);
        assert_eq!(behind_a_gap((320, 180), screen, gap, larger), CullingResult::Visible, "{gap:?}");
    }
    assert!(culled > 0, "there is nothing to make up for");
}
