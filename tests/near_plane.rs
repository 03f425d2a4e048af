//! Triangles that cross the near plane, or extend beyond any guard band, against their exact intersection with every
//! pixel's ray. A clipped vertex is snapped too, so edges may move slightly; depth may not be nearer than the true
//! plane within that distance.

mod oracle;
mod support;

use std::cell::RefCell;

use masked_occlusion_culling::{MaskedOcclusionCulling, YAxis};
use oracle::homogeneous::{Homogeneous, Place};
use proptest::prelude::*;
use support::{AXES, check, draw_clip, is_empty, name, objects, read};

const SIZE: (usize, usize) = (96, 64);

/// How far an edge may move, in pixels.
const TOLERANCE: f64 = 1.0 / 16.0;

type Corners = [[f32; 3]; 3];

/// The allowed contents of a pixel: the position of its centre relative to the triangle, and the nearest depth.
type Allowed = Vec<(Place, f64)>;

fn allowed(v: &Corners, near: f32, axis: YAxis) -> Option<Allowed> {
    let wide = v.map(|c| c.map(f64::from));
    let exact = Homogeneous::new(&wide, f64::from(near), SIZE, axis == YAxis::Up)?;
    // Nothing is drawn nearer than the near plane.
    let limit = if near > 0.0 { f64::from(1.0 / near) } else { f64::INFINITY };
    let pixel = |i: usize| {
        let (column, row) = (i % SIZE.0, i / SIZE.0);
        let most = (exact.depth(column, row) + TOLERANCE * exact.slope()).min(limit);
        (exact.place(column, row, TOLERANCE), most * (1.0 + 1e-6))
    };
    Some((0..SIZE.0 * SIZE.1).map(pixel).collect())
}

fn compare(
    moc: &mut MaskedOcclusionCulling,
    v: &Corners,
    near: f32,
    whole: bool,
    allowed: &Allowed,
    depth: &mut Vec<f32>,
) -> Result<(), String> {
    moc.set_near_clip_plane(near).unwrap();
    moc.clear_buffer();
    draw_clip(moc, &v.map(|[x, y, w]| [x, y, 0.0, w]));
    read(moc, depth);
    for (i, (&stored, &(place, most))) in depth.iter().zip(allowed).enumerate() {
        let why = match (place, is_empty(stored)) {
            (Place::Inside, true) if whole => "is missed".into(),
            (Place::Outside, false) => "is covered falsely".into(),
            (_, false) if stored.is_nan() || f64::from(stored) > most => {
                format!("is too near: {stored:e}, at most {most:e}")
            }
            _ => continue,
        };
        return Err(format!("{}, near {near:e}: ({}, {}) {why}\n{v:?}", name(moc), i % SIZE.0, i / SIZE.0));
    }
    Ok(())
}

fn run(cases: u32, seed: u64, strategy: &impl Strategy<Value = (Corners, f32)>, whole: bool) {
    let state = RefCell::new((objects(SIZE), Vec::new()));
    check(cases, seed, strategy, |(v, near)| {
        let (objects, depth) = &mut *state.borrow_mut();
        for axis in AXES {
            // Edge-on triangles have no interior: the only requirement is that nothing breaks.
            let allowed = allowed(&v, near, axis).unwrap_or_default();
            let mut of_axis = objects.iter_mut().filter(|moc| moc.y_axis() == axis);
            of_axis.try_for_each(|moc| compare(moc, &v, near, whole, &allowed, depth))?;
        }
        Ok(())
    });
}

fn corner(w: impl Strategy<Value = f32>) -> impl Strategy<Value = [f32; 3]> {
    (-3.0..3.0f32, -3.0..3.0f32, w).prop_map(|(x, y, w)| [x, y, w])
}

/// One or two corners behind the eye and the others in front, in any rotation.
fn crossing() -> impl Strategy<Value = Corners> {
    (corner(-4.0..0.0f32), corner(-4.0..4.0f32), corner(0.5..6.0f32), 0..3usize).prop_map(|(a, b, c, turn)| {
        let mut v = [a, b, c];
        v.rotate_left(turn);
        v
    })
}

#[test]
fn crossing_the_near_plane() {
    run(3000, 1, &(crossing(), 0.05..1.0f32), true);
}

/// With the near plane at the eye, the part that is too close to project may be left out, which is safe.
#[test]
fn crossing_the_eye() {
    run(2000, 2, &(crossing(), Just(0.0f32)), false);
}

/// A floor under the eye, as in every game.
#[test]
fn floors_under_the_eye() {
    let floor = (0.01..2.0f32, 1.0..500.0f32, 0.05..0.3f32)
        .prop_map(|(height, far, near)| ([[-far, -height, -far], [far, -height, -far], [0.0, -height, far]], near));
    run(1000, 3, &floor, true);
}

/// Geometry much nearer than anything on the screen, such as a floor's corners on the near plane, does not make the
/// depths there worse than those of a floor that ends in front of the eye.
#[test]
fn depths_of_floors_under_the_eye() {
    let floor = (0.5..2.0f32, 10.0..500.0f32, 0.001..0.1f32)
        .prop_map(|(height, far, near)| ([[-far, -height, -far], [far, -height, -far], [0.0, -height, far]], near));
    let state = RefCell::new((objects(SIZE), Vec::new()));
    check(500, 7, &floor, |(v, near)| {
        let (objects, depth) = &mut *state.borrow_mut();
        for moc in objects {
            let up = moc.y_axis() == YAxis::Up;
            let Some(exact) = Homogeneous::new(&v.map(|c| c.map(f64::from)), f64::from(near), SIZE, up) else {
                continue;
            };
            moc.set_near_clip_plane(near).unwrap();
            moc.clear_buffer();
            draw_clip(moc, &v.map(|[x, y, w]| [x, y, 0.0, w]));
            read(moc, depth);
            for (i, &stored) in depth.iter().enumerate() {
                let (column, row) = (i % SIZE.0, i / SIZE.0);
                if exact.place(column, row, TOLERANCE) != Place::Inside {
                    continue;
                }
                // Snapping moves the plane by half a subpixel.
                let least = exact.block_depth(column, row) - exact.slope() / 256.0;
                if f64::from(stored) < least * (1.0 - 1e-4) {
                    let name = name(moc);
                    return Err(format!(
                        "{name}, near {near:e}: ({column}, {row}) is too far: {stored:e}, not {least:e}"
                    ));
                }
            }
        }
        Ok(())
    });
}

/// Corners up to a million pixels away: beyond any guard band, so the sides are clipped too.
#[test]
fn beyond_the_guard_band() {
    let far = prop_oneof![-3.0..3.0f32, -300.0..300.0f32, -20_000.0..20_000.0f32];
    let corner = (far.clone(), far, 0.5..8.0f32).prop_map(|(x, y, w)| [x * w, y * w, w]);
    run(3000, 4, &([corner.clone(), corner.clone(), corner], Just(0.1f32)), true);
}

/// Both behind the eye and far out.
#[test]
fn near_plane_and_guard_band_at_once() {
    let far = prop_oneof![-3.0..3.0f32, -3000.0..3000.0f32];
    let corner = (far.clone(), far, prop_oneof![-2.0..8.0f32, 0.1..0.2f32]).prop_map(|(x, y, w)| [x, y, w]);
    run(3000, 5, &([corner.clone(), corner.clone(), corner], 0.1..0.5f32), true);
}

/// Arbitrary w everywhere, nothing to clip: the same guarantee.
#[test]
fn any_w_in_front() {
    let corner = (-1.5..1.5f32, -1.5..1.5f32, 0.3..1000.0f32).prop_map(|(x, y, w)| [x * w, y * w, w]);
    run(3000, 6, &([corner.clone(), corner.clone(), corner], Just(0.1f32)), true);
}
