//! Triangles whose w spans twelve orders of magnitude and more: a wall that passes the camera, a face of a sky box, a
//! beam from the muzzle to the horizon. 1/w then changes by as much, and its gradient on thin triangles by far more:
//! docs/accuracy.md explains why f32 suffices.

use masked_occlusion_culling::YAxis;

use crate::cases::Case;
use crate::cases::measured::Measured;
use crate::cases::subject::Subject;
use crate::oracle::bounds::power;
use crate::oracle::homogeneous::Homogeneous;
use crate::oracle::snap::snapped;
use crate::oracle::{Oracle, Triangle, UNIT, Vertex, area};

pub const CASES: &[&Case] = &[&WHOLE, &CUT, &STEEP, &DENORMAL];

static WHOLE: Case = Case::new("w from 1e-6 to 1e6 in one triangle", whole);
static CUT: Case = Case::new("w from 1e-6 to 1e6 in one triangle, near plane between", cut);
static STEEP: Case = Case::new("steepest depth: w from 2^-30 to 2^40 on slivers", steep);
static DENORMAL: Case = Case::new("w from 1e-45 to 1 in one triangle", denormal);

const SIZE: (usize, usize) = (256, 128);

/// The w of three corners, in all orders.
const W: [[f32; 3]; 6] =
    [[1e-6, 1.0, 1e6], [1e6, 1e-6, 1.0], [1.0, 1e6, 1e-6], [1e-6, 1e6, 1e6], [1e6, 1e-6, 1e-6], [1e-6, 1e-3, 1e3]];

fn point(random: &mut fastrand::Rng) -> (i64, i64) {
    (random.i64(-20 * UNIT..=276 * UNIT), random.i64(-20 * UNIT..=148 * UNIT))
}

/// The clip-space vertex at a point of the grid.
fn vertex((x, y): (i64, i64), w: f32) -> [f32; 4] {
    let (half_x, half_y) = (SIZE.0 as f64 * 128.0, SIZE.1 as f64 * 128.0);
    let clip = |v: i64, half: f64| ((v as f64 - half) / half * f64::from(w)) as f32;
    [clip(x, half_x), -clip(y, half_y), 0.0, w]
}

fn whole() -> Measured {
    let mut subject = Subject::new(SIZE, YAxis::Down);
    let oracle = Oracle::new(SIZE.0, SIZE.1);
    let mut measured = Measured::default();
    let mut random = fastrand::Rng::with_seed(21);
    for k in 0..600 {
        let w = W[k % W.len()];
        let corners = [0, 1, 2].map(|i| vertex(point(&mut random), w[i]));
        let t: Triangle = corners.map(|v| snapped(v, SIZE, false).expect("a vertex on the grid"));
        if area(&t) == 0 {
            continue;
        }
        subject.clear();
        subject.draw_clip(&corners);
        measured.one(&t, subject.depth(), &oracle);
        measured.shown(subject.test_clip(&corners));
    }
    measured
}

/// Triangles that are clipped at `near`, or dropped because their size would blur anything so near.
fn clipped(near: f32, triangles: &[[[f32; 4]; 3]]) -> Measured {
    let mut subject = Subject::new(SIZE, YAxis::Down);
    subject.set_near(near);
    // Nothing nearer than 2^-30 is projected.
    let near = f64::from(near).max(1.0 / f64::from(1 << 30));
    let mut measured = Measured::default();
    for t in triangles {
        let corners = t.map(|[x, y, _, w]| [x, y, w].map(f64::from));
        let Some(exact) = Homogeneous::new(&corners, near, SIZE, false) else { continue };
        if !measured.taken(&mut subject, t) {
            continue;
        }
        let farthest = t.iter().fold(0.0_f32, |m, v| m.max(v[3]));
        measured.clipped(&exact, 1.0 / f64::from(farthest), subject.depth(), SIZE.0);
        if subject.depth().iter().any(|d| *d > 0.0) {
            measured.shown(subject.test_clip(t));
        }
    }
    measured
}

/// Triangles with w in all orders; every third has a corner as far behind the eye as the farthest is in front.
fn crossing(random: &mut fastrand::Rng) -> Vec<[[f32; 4]; 3]> {
    let mut triangles = Vec::new();
    for k in 0..150 {
        let mut t = W[k % W.len()].map(|w| vertex(point(random), w));
        if k % 3 == 0 {
            t[k / 3 % 3] = vertex(point(random), -1e6);
        }
        triangles.push(t);
    }
    triangles
}

fn cut() -> Measured {
    let mut random = fastrand::Rng::with_seed(22);
    let mut measured = Measured::default();
    for near in [1e-3, 0.1, 1.5] {
        measured.add(&clipped(near, &crossing(&mut random)));
    }
    measured
}

fn steep() -> Measured {
    let mut subject = Subject::new(SIZE, YAxis::Down);
    let oracle = Oracle::new(SIZE.0, SIZE.1);
    let mut measured = Measured::default();
    let mut random = fastrand::Rng::with_seed(23);
    for k in 0..900 {
        // 1/w from 2^-40 to 2^30: the nearest and the farthest that can be drawn, and a third in between or at either
        // end.
        let mut exponents = [30, -40, [30, 29, 0, -30, -40][k % 5]];
        random.shuffle(&mut exponents);
        let [a, b] = [point(&mut random), point(&mut random)];
        // From 1/256 pixel thick to any thickness.
        let c = match k % 3 {
            0 => (a.0 + 1, a.1),
            1 => (b.0, b.1 + random.i64(1..=300)),
            _ => point(&mut random),
        };
        let t: Triangle = [(a, 0), (b, 1), (c, 2)].map(|((x, y), i)| Vertex { x, y, z: power(exponents[i]) });
        if area(&t) == 0 {
            continue;
        }
        subject.clear();
        subject.draw(&[t]);
        measured.one(&t, subject.depth(), &oracle);
    }
    measured
}

fn denormal() -> Measured {
    let mut random = fastrand::Rng::with_seed(24);
    let triangles: Vec<_> = (0..200)
        .map(|k| {
            let tiny = [1e-45, f32::MIN_POSITIVE, 1e-30, 1e-20, 1e-10][k % 5];
            // x and y are given directly: multiplied by such a small w they would vanish.
            let mut t = [1e-3, 1.0, 0.5].map(|w: f32| vertex(point(&mut random), w));
            t[k % 3] = [random.f32() - 0.5, random.f32() - 0.5, 0.0, tiny];
            t
        })
        .collect();
    clipped(0.0, &triangles)
}

/// Nothing to clip: the plane through three depths, only one of which is significant.
#[test]
fn w_from_1e_6_to_1e6_in_one_triangle() {
    WHOLE.measured().assert_exact().assert_behind(0.15, 5e-4);
}

/// The same with a corner behind the eye, clipped by a near plane at 1e-3, 0.1 and 1.5.
#[test]
fn w_from_1e_6_to_1e6_cut_by_the_near_plane() {
    let m = CUT.measured();
    m.assert_clipped().assert_behind(0.35, 0.011);
    assert_eq!(m.refused, 0);
}

/// If the near plane is so near that doubles would blur a new corner by a quarter of a subpixel, which here happens
/// from a ratio of 2 * 10^9 on, a triangle is dropped and counted, and nothing of it is drawn.
#[test]
fn w_from_1e_6_to_1e6_cut_too_near_is_refused() {
    let mut random = fastrand::Rng::with_seed(25);
    let m = clipped(1e-5, &crossing(&mut random));
    m.assert_clipped();
    assert!(m.refused > 50 && m.triangles - m.refused > 20, "{m:?}");
}

/// The steepest depth gradient within the range of w that is drawn: 2^30 across 1/256 pixel.
#[test]
fn the_steepest_depth_gradients() {
    STEEP.measured().assert_exact().assert_behind(0.4, 4e-4);
}

/// 1/w itself overflows f32, and so would a gradient computed from it.
#[test]
fn w_so_small_that_1_over_w_overflows() {
    let m = DENORMAL.measured();
    m.assert_clipped().assert_behind(0.53, 0.006);
    assert_eq!(m.refused, 0);
}
