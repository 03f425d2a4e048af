//! Matrices with tiny and huge scales, and worlds far from their origin: a model in micrometres, a planet in metres.
//!
//! The library transforms in f32, as a GPU does. This measures the whole path from positions, against an oracle that
//! transforms in double: where products and sums in f32 lose digits, the triangle differs.

use glam::Mat4;
use masked_occlusion_culling::{Vertices, YAxis};

use crate::cases::Case;
use crate::cases::measured::Measured;
use crate::cases::subject::Subject;
use crate::oracle::bounds::power;
use crate::oracle::homogeneous::Homogeneous;
use crate::support::both_sides;

pub const CASES: &[&Case] = &[&POWERS, &OTHERS, &THOUSAND, &MILLION];

static POWERS: Case = Case::new("models and views scaled by 2^-90 to 2^90", powers);
static OTHERS: Case = Case::new("models and views scaled by 1e-25 to 1e25", others);
static THOUSAND: Case = Case::new("world 1,000 units from its origin", || far_away(1e3));
static MILLION: Case = Case::new("world 1,000,000 units from its origin", || far_away(1e6));

const SIZE: (usize, usize) = (128, 64);

/// Rows for x, y and w of a camera 8 units before the middle of the world, turned by rational sines and cosines.
const CAMERA: [[f64; 4]; 3] =
    [[0.6, 0.0, -0.8, 0.0], [-0.8 * 0.625, 1.875, -0.6 * 0.625, 0.25], [0.75, 0.25, 0.5625, 8.0]];

type Positions = [[f32; 3]; 3];

/// Triangles 0.1 to 4 units large, within 3 units of the middle of the world.
fn triangles() -> Vec<Positions> {
    let mut random = fastrand::Rng::with_seed(51);
    let mut triangles = Vec::new();
    for k in 0..120 {
        let size = [0.1, 1.0, 4.0][k % 3];
        let middle = [(); 3].map(|()| random.f32() * 6.0 - 3.0);
        triangles.push([(); 3].map(|()| middle.map(|c| c + (random.f32() - 0.5) * size)));
    }
    triangles
}

/// The camera as passed to the library: its linear part times `linear`, and then all of it times `view`.
fn matrix(linear: f64, view: f64) -> Mat4 {
    let rows = CAMERA.map(|[x, y, z, t]| [x * linear, y * linear, z * linear, t].map(|c| (c * view) as f32));
    of_rows(rows)
}

fn of_rows([x, y, w]: [[f32; 4]; 3]) -> Mat4 {
    let mut columns = [0.0; 16];
    for k in 0..4 {
        (columns[4 * k], columns[4 * k + 1], columns[4 * k + 3]) = (x[k], y[k], w[k]);
    }
    Mat4::from_cols_array(&columns)
}

/// The triangle in clip space, transformed in double.
fn exact_clip(matrix: &Mat4, t: &Positions) -> [[f64; 3]; 3] {
    let m = matrix.to_cols_array().map(f64::from);
    t.map(|p| {
        let [x, y, z] = p.map(f64::from);
        [0, 1, 3].map(|row| m[row] * x + m[4 + row] * y + (m[8 + row] * z + m[12 + row]))
    })
}

/// Draws each triangle and measures it; returns the depths of all.
fn measure(subject: &mut Subject, measured: &mut Measured, matrix: &Mat4, triangles: &[Positions]) -> Vec<f32> {
    let mut all = Vec::new();
    for t in triangles {
        let clip = exact_clip(matrix, t);
        let Some(exact) = Homogeneous::new(&clip, 0.0, SIZE, false) else { continue };
        let farthest = clip.iter().fold(0.0, |m: f64, v| m.max(v[2]));
        subject.clear();
        subject.render(Vertices::model_space(t, matrix.to_cols_array()), &[0, 1, 2], &both_sides());
        measured.clipped(&exact, 1.0 / farthest, subject.depth(), SIZE.0);
        all.extend_from_slice(subject.depth());
    }
    all
}

fn powers() -> Measured {
    let mut subject = Subject::new(SIZE, YAxis::Down);
    let mut measured = Measured::default();
    let triangles = triangles();
    let plain = measure(&mut subject, &mut measured, &matrix(1.0, 1.0), &triangles);
    for model in [-90, -40, 0, 40, 90] {
        for view in [-30, 0, 30] {
            let scale = power(model) as f32;
            let scaled: Vec<_> = triangles.iter().map(|t| t.map(|p| p.map(|c| c * scale))).collect();
            let depth = measure(&mut subject, &mut measured, &matrix(power(-model), power(view)), &scaled);
            // The same pixels, and depths that differ only by the view's power of two.
            let same = |(a, b): (&f32, &f32)| if *a < 0.0 { *b < 0.0 } else { *a == *b * power(view) as f32 };
            if let Some(i) = plain.iter().zip(&depth).position(|p| !same(p)) {
                let (plain, scaled) = (plain[i], depth[i]);
                panic!("model 2^{model}, view 2^{view}: {plain:e} became {scaled:e}");
            }
        }
    }
    measured
}

fn others() -> Measured {
    let mut subject = Subject::new(SIZE, YAxis::Down);
    let mut measured = Measured::default();
    for model in [1e-25, 1e-12, 1e-3, 1e3, 1e12, 1e25] {
        for view in [1e-9, 3.0, 7e10] {
            let scaled: Vec<_> = triangles().iter().map(|t| t.map(|p| p.map(|c| c * model as f32))).collect();
            measure(&mut subject, &mut measured, &matrix(1.0 / model, view), &scaled);
        }
    }
    measured
}

fn far_away(distance: f64) -> Measured {
    let mut subject = Subject::new(SIZE, YAxis::Down);
    let mut measured = Measured::default();
    for away in [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.75, 0.5, 0.625]] {
        let away = away.map(|c| c * distance);
        let move_away = |p: [f32; 3]| [0, 1, 2].map(|k| (f64::from(p[k]) + away[k]) as f32);
        let moved: Vec<_> = triangles().iter().map(|t| t.map(move_away)).collect();
        let rows = CAMERA.map(|[x, y, z, t]| [x, y, z, t - x * away[0] - y * away[1] - z * away[2]].map(|c| c as f32));
        measure(&mut subject, &mut measured, &of_rows(rows), &moved);
    }
    measured
}

/// A power of two only changes the exponent: the same pixels and the same digits.
#[test]
fn matrices_scaled_by_powers_of_two() {
    POWERS.measured().assert_clipped().assert_behind(1.1e-4, 0.0);
}

/// Other factors round each element, and the oracle uses the rounded elements.
#[test]
fn matrices_of_tiny_and_huge_scale() {
    OTHERS.measured().assert_clipped().assert_behind(1.1e-4, 0.0);
}

/// The matrix subtracts the distance again, in f32, which loses digits of the position.
#[test]
fn a_world_a_thousand_units_from_its_origin() {
    THOUSAND.measured().assert_clipped().assert_behind(1.4e-4, 0.0);
}

/// Six of seven digits are lost: there is no guarantee for the original positions, only for their values in f32.
#[test]
fn a_world_a_million_units_from_its_origin() {
    let m = MILLION.measured();
    assert!(m.depths > 500 && m.off <= 0.7 && m.nearer <= 80_000.0, "{m:?}");
    m.assert_behind(0.03, 0.02);
}
