//! The update rules under random sequences of draws, merges and queries: the buffer is never nearer than an exact one,
//! and no query reports hidden what an exact buffer shows.

mod oracle;
mod support;

use masked_occlusion_culling::{CullingResult, Implementation, MaskedOcclusionCulling, UpdateRule, YAxis};
use oracle::{Oracle, Triangle};
use proptest::prelude::*;
use support::triangles::{Kind, of_any_kind, of_kind};
use support::{RULES, check, conservative, draw, name, object, read, test};

/// Not a multiple of the tile size, so that tiles at the edge are partial.
const SIZE: (usize, usize) = (100, 43);

#[derive(Clone, Debug)]
enum Step {
    Draw(Vec<Triangle>),
    /// Draws into another object, with some rule and instruction set, and merges it.
    Merge(Vec<Triangle>, usize, usize),
    /// A rectangle in pixels and its power-of-two w.
    Rectangle([f64; 4], i32),
    Mesh(Vec<Triangle>),
}

fn batch() -> impl Strategy<Value = Vec<Triangle>> {
    // Large ones fill sub-tiles and so affect the reference depth; the others leave masks behind.
    let any = prop_oneof![of_any_kind(SIZE), of_kind(Kind::PartlyOff, SIZE), of_kind(Kind::Uniform, SIZE)];
    proptest::collection::vec(any, 1..12)
}

fn steps() -> impl Strategy<Value = Vec<Step>> {
    let (w, h) = (SIZE.0 as f64, SIZE.1 as f64);
    let edges = [-10.0..w + 10.0, -10.0..h + 10.0, 0.1..40.0, 0.1..20.0];
    let step = prop_oneof![
        3 => batch().prop_map(Step::Draw),
        1 => (batch(), 0..RULES.len(), 0..8usize).prop_map(|(b, r, i)| Step::Merge(b, r, i)),
        2 => (edges, 0..=7i32).prop_map(|([x, y, w, h], k)| Step::Rectangle([x, y, x + w, y + h], k)),
        2 => proptest::collection::vec(of_any_kind(SIZE), 1..3).prop_map(Step::Mesh),
    ];
    proptest::collection::vec(step, 1..14)
}

/// Tests a rectangle in pixels, with the object's row direction, using `test_rect`.
fn rectangle(moc: &MaskedOcclusionCulling, [x0, y0, x1, y1]: [f64; 4], w: f32) -> CullingResult {
    let x = |v: f64| (v * 2.0 / SIZE.0 as f64 - 1.0) as f32;
    let y = |v: f64| (v * 2.0 / SIZE.1 as f64 - 1.0) as f32;
    let (low, high) = if moc.y_axis() == YAxis::Up { (y(y0), y(y1)) } else { (-y(y1), -y(y0)) };
    moc.test_rect(x(x0), low, x(x1), high, w)
}

/// Would an exact buffer show any of it: at a covered centre, or at an inner point of a touched pixel?
fn shows(oracle: &Oracle, t: &Triangle) -> bool {
    const POINTS: [[i64; 3]; 10] = [
        [14, 1, 1],
        [1, 14, 1],
        [1, 1, 14],
        [6, 5, 5],
        [10, 5, 1],
        [1, 10, 5],
        [5, 1, 10],
        [7, 8, 1],
        [1, 7, 8],
        [8, 1, 7],
    ];
    oracle::area(t) != 0 && (oracle.shows(t) || POINTS.iter().any(|p| oracle.shows_at(t, *p)))
}

fn run(rule: UpdateRule, implementation: Implementation, axis: YAxis, steps: &[Step]) -> Result<(), String> {
    let mut moc = object(implementation, rule, axis, SIZE);
    let mut oracle = Oracle::new(SIZE.0, SIZE.1);
    let mut depth = Vec::new();
    for (i, step) in steps.iter().enumerate() {
        let fail = |moc: &MaskedOcclusionCulling, why: String| Err(format!("{}, step {i} {step:?}: {why}", name(moc)));
        match step {
            Step::Draw(triangles) => {
                draw(&mut moc, triangles);
                triangles.iter().for_each(|t| oracle.draw(t));
            }
            Step::Merge(triangles, rule, isa) => {
                let all = Implementation::available();
                let mut other = object(all[isa % all.len()], RULES[*rule], axis, SIZE);
                draw(&mut other, triangles);
                moc.merge_buffer(&other).unwrap();
                triangles.iter().for_each(|t| oracle.draw(t));
            }
            Step::Rectangle(edges, k) => {
                let w = 2.0f32.powi(*k);
                let [x0, y0, x1, y1] = *edges;
                let hidden = rectangle(&moc, *edges, w) == CullingResult::Occluded;
                if hidden && oracle.rectangle_shows((x0, x1), (y0, y1), 1.0 / f64::from(w)) {
                    return fail(&moc, "called hidden, but it shows".into());
                }
            }
            Step::Mesh(triangles) => {
                let hidden = test(&moc, triangles) == CullingResult::Occluded;
                if hidden && triangles.iter().any(|t| shows(&oracle, t)) {
                    return fail(&moc, "called hidden, but it shows".into());
                }
            }
        }
        read(&moc, &mut depth);
        if let Err(why) = conservative(&depth, &oracle) {
            return fail(&moc, why);
        }
    }
    Ok(())
}

fn sequences(rule: UpdateRule) {
    for (i, &implementation) in Implementation::available().iter().enumerate() {
        for axis in support::AXES {
            check(600, i as u64 * 2 + axis as u64, &steps(), |steps| run(rule, implementation, axis, &steps));
        }
    }
}

#[test]
fn three_layer_is_conservative() {
    sequences(UpdateRule::ThreeLayer);
}

#[test]
fn quick_is_conservative() {
    sequences(UpdateRule::Quick);
}

#[test]
fn accurate_is_conservative() {
    sequences(UpdateRule::Accurate);
}

#[test]
fn four_layer_is_conservative() {
    sequences(UpdateRule::FourLayer);
}

/// The rules must not be trivially conservative: whatever was drawn before, a wall in front of it hides everything well
/// behind.
#[test]
fn a_wall_hides_what_is_behind_it() {
    for &implementation in Implementation::available() {
        for rule in RULES {
            let strategy = (batch(), steps_of_rectangles(), of_kind(Kind::Small, SIZE));
            check(60, rule as u64, &strategy, |(before, (edges, w), t)| {
                let mut moc = object(implementation, rule, YAxis::Down, SIZE);
                draw(&mut moc, &before);
                support::draw_clip(&mut moc, &support::wall(0.5));
                let on_screen = |lo: f64, hi: f64, size: usize| hi > 0.01 && lo < size as f64 - 0.01;
                let seen = on_screen(edges[0], edges[2], SIZE.0) && on_screen(edges[1], edges[3], SIZE.1);
                if seen && rectangle(&moc, edges, w) != CullingResult::Occluded {
                    return Err(format!("{}: {edges:?} at {w} is not hidden", name(&moc)));
                }
                if seen && rectangle(&moc, edges, 0.25) != CullingResult::Visible {
                    return Err(format!("{}: {edges:?} in front is not visible", name(&moc)));
                }
                if test(&moc, &[t]) == CullingResult::Visible {
                    return Err(format!("{}: the triangle is not hidden", name(&moc)));
                }
                Ok(())
            });
        }
    }
}

fn steps_of_rectangles() -> impl Strategy<Value = ([f64; 4], f32)> {
    let (w, h) = (SIZE.0 as f64, SIZE.1 as f64);
    let edges = [-10.0..w + 10.0, -10.0..h + 10.0, 0.1..40.0, 0.1..20.0];
    (edges.prop_map(|[x, y, w, h]| [x, y, x + w, y + h]), 0.6..1e9f32)
}
