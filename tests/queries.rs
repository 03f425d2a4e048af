//! Occludees anywhere, with any w, unsnapped, clipped or not: if an exact buffer shows any point of one, it must not be
//! reported hidden or out of view.

mod oracle;
mod support;

use std::cell::RefCell;

use masked_occlusion_culling::{CullingResult, Implementation, MaskedOcclusionCulling, YAxis};
use oracle::{Oracle, Triangle};
use proptest::prelude::*;
use support::triangles::{Kind, of_kind};
use support::{AXES, RULES, check, draw, name, object, test_clip};

const SIZE: (usize, usize) = (128, 64);
const NEAR: f32 = 0.1;

/// The pixel in which a clip-space point is visible, if it is on the screen and not too close to a pixel's edge.
fn pixel([x, y, w]: [f64; 3], axis: YAxis) -> Option<usize> {
    let column = (x / w * 0.5 + 0.5) * SIZE.0 as f64;
    let y = if axis == YAxis::Up { y } else { -y };
    let row = (y / w * 0.5 + 0.5) * SIZE.1 as f64;
    let clear = |v: f64, size: usize| v > 0.0 && v < size as f64 && (v - v.round()).abs() > 1e-4;
    (w >= f64::from(NEAR) && clear(column, SIZE.0) && clear(row, SIZE.1))
        .then(|| row as usize * SIZE.0 + column as usize)
}

/// Points of a triangle: close to the corners, along the edges, inside.
fn points(t: &[[f32; 3]; 3]) -> impl Iterator<Item = [f64; 3]> {
    const STEPS: i32 = 12;
    let wide = t.map(|v| v.map(f64::from));
    (0..=STEPS).flat_map(move |i| {
        (0..=STEPS - i).map(move |j| {
            // Slightly off the edges, so that a point belongs to the triangle without doubt.
            let weight = |n: i32| (f64::from(n) + 1e-5) / (f64::from(STEPS) + 3e-5);
            let weights = [weight(i), weight(j), weight(STEPS - i - j)];
            [0, 1, 2].map(|k| (0..3).map(|c| wide[c][k] * weights[c]).sum())
        })
    })
}

fn ask(moc: &MaskedOcclusionCulling, exact: &Oracle, t: &[[f32; 3]; 3]) -> Result<(), String> {
    let answer = test_clip(moc, &t.map(|[x, y, w]| [x, y, 0.0, w]));
    for p in points(t) {
        let Some(i) = pixel(p, moc.y_axis()) else { continue };
        let wrong = match answer {
            CullingResult::Visible => false,
            CullingResult::ViewCulled => true,
            CullingResult::Occluded => 1.0 / p[2] >= exact.depth[i] * (1.0 + 1e-12),
        };
        if wrong {
            let at = (i % SIZE.0, i / SIZE.0);
            return Err(format!(
                "{}: {answer:?}, but {p:?} is in {at:?} at {:e} before {:e}\n{t:?}",
                name(moc),
                1.0 / p[2],
                exact.depth[i]
            ));
        }
    }
    Ok(())
}

/// Occluders are large and near, so that most of the screen is hidden and answers vary.
fn occluders() -> impl Strategy<Value = Vec<Triangle>> {
    proptest::collection::vec(prop_oneof![of_kind(Kind::PartlyOff, SIZE), of_kind(Kind::Uniform, SIZE)], 4..20)
}

fn run(cases: u32, seed: u64, occludee: impl Strategy<Value = [[f32; 3]; 3]>) {
    let all = Implementation::available();
    let objects: Vec<_> =
        all.iter().flat_map(|&i| RULES.map(|rule| AXES.map(|axis| object(i, rule, axis, SIZE)))).flatten().collect();
    let state = RefCell::new(objects);
    let strategy = (occluders(), proptest::collection::vec(occludee, 1..8));
    check(cases, seed, &strategy, |(occluders, occludees)| {
        let mut exact = Oracle::new(SIZE.0, SIZE.1);
        occluders.iter().for_each(|t| exact.draw(t));
        state.borrow_mut().iter_mut().try_for_each(|moc| {
            moc.clear_buffer();
            moc.set_near_clip_plane(0.0).unwrap();
            draw(moc, &occluders);
            moc.set_near_clip_plane(NEAR).unwrap();
            occludees.iter().try_for_each(|t| ask(moc, &exact, t))
        })
    });
}

fn around(
    spread: impl Strategy<Value = f32> + Clone + 'static,
    depth: std::ops::Range<f32>,
) -> BoxedStrategy<[[f32; 3]; 3]> {
    let offset = (spread.clone(), spread, 0.9..1.1f32);
    ((-1.1..1.1f32, -1.1..1.1f32, depth), [offset.clone(), offset.clone(), offset])
        .prop_map(|((x, y, w), offsets)| {
            offsets.map(|(dx, dy, dw)| {
                let w = w * dw;
                [(x + dx) * w, (y + dy) * w, w]
            })
        })
        .boxed()
}

#[test]
fn occludees_of_every_size() {
    run(300, 1, around(-0.5..0.5f32, 0.5..80.0));
    run(300, 2, around(-0.03..0.03f32, 0.5..80.0));
}

/// A hundredth of a pixel to a pixel.
#[test]
fn tiny_occludees() {
    run(400, 3, around(-0.01..0.01f32, 0.5..80.0));
    run(400, 4, around(-0.0005..0.0005f32, 0.5..80.0));
}

#[test]
fn poles_and_planks() {
    let thin = |x: f32, y: f32| {
        around(-0.5..0.5f32, 1.0..80.0).prop_map(move |t| {
            // Shrunk towards its first corner.
            let (x0, y0) = (t[0][0] / t[0][2], t[0][1] / t[0][2]);
            t.map(|[px, py, w]| [(x0 + (px / w - x0) * x) * w, (y0 + (py / w - y0) * y) * w, w])
        })
    };
    run(300, 5, thin(0.005, 1.0));
    run(300, 6, thin(1.0, 0.01));
}

#[test]
fn occludees_that_cross_the_near_plane_or_leave_the_screen() {
    let any = prop_oneof![-3.0..3.0f32, -300.0..300.0f32];
    let corner = (any.clone(), any, prop_oneof![-2.0..80.0f32, 0.05..0.2f32]).prop_map(|(x, y, w)| [x, y, w]);
    run(600, 7, [corner.clone(), corner.clone(), corner]);
    let far = prop_oneof![-3.0..3.0f32, -3000.0..3000.0f32];
    let corner = (far.clone(), far, 0.2..80.0f32).prop_map(|(x, y, w)| [x * w, y * w, w]);
    run(300, 8, [corner.clone(), corner.clone(), corner]);
}
