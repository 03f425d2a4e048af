//! Which way a triangle faces is decided exactly, however thin it is, and a draw reports whether anything was in view.

mod oracle;
mod support;

use std::cell::RefCell;

use masked_occlusion_culling::{BackfaceWinding, CullingResult, DrawOptions, MaskedOcclusionCulling, Vertices, YAxis};
use oracle::{Oracle, Triangle, area};
use support::triangles::{Kind, of_kind};
use support::{check, compare_one, mesh, name, objects, read};

fn compare(moc: &mut MaskedOcclusionCulling, t: &Triangle, exact: &Oracle, depth: &mut Vec<f32>) -> Result<(), String> {
    let (vertices, indices) = mesh(&[*t], (exact.width, exact.height), moc.y_axis());
    // If rows go down, the winding is as in normalised device coordinates; if they go up, it is reversed.
    let clockwise = (area(t) > 0) == (moc.y_axis() == YAxis::Down);
    for winding in [BackfaceWinding::Clockwise, BackfaceWinding::CounterClockwise] {
        let away = clockwise == (winding == BackfaceWinding::Clockwise);
        moc.clear_buffer();
        let options = DrawOptions::default().with_winding(winding);
        let result = moc.render_triangles(Vertices::clip_space(&vertices), &indices, &options).unwrap();
        read(moc, depth);
        let fail = |why: &str| Err(format!("{} {winding:?}: {why}\n{vertices:?}", name(moc)));
        if away || area(t) == 0 {
            if depth.iter().any(|d| !support::is_empty(*d)) {
                return fail("draws what faces away");
            }
        } else if let Err(why) = compare_one(t, depth, exact) {
            return fail(&why);
        }
        if depth.iter().any(|d| *d > 0.0) && result != CullingResult::Visible {
            return fail("draws and says that nothing was in view");
        }
    }
    Ok(())
}

fn exact(kind: Kind) {
    for (size, cases) in [((33, 9), 300), ((256, 256), 100), ((16384, 8), 20)] {
        let state = RefCell::new((objects(size), Vec::new()));
        let exact = Oracle::new(size.0, size.1);
        check(cases, kind as u64, &of_kind(kind, size), |t| {
            let (objects, depth) = &mut *state.borrow_mut();
            objects.iter_mut().try_for_each(|moc| compare(moc, &t, &exact, depth))
        });
    }
}

#[test]
fn of_slivers() {
    exact(Kind::Diagonal);
    exact(Kind::NearHorizontal);
    exact(Kind::NearVertical);
}

#[test]
fn of_tiny_ones() {
    exact(Kind::Tiny);
}

#[test]
fn of_far_ones() {
    exact(Kind::FarOff);
}

#[test]
fn of_mixed_scale() {
    exact(Kind::MixedScale);
}
