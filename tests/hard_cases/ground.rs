//! A ground plane from 1/1000 to 100,000 away: every outdoor scene has one, and most of its depth range is in the row
//! of pixels below the horizon.

use masked_occlusion_culling::YAxis;

use crate::cases::Case;
use crate::cases::measured::Measured;
use crate::cases::subject::Subject;
use crate::oracle::homogeneous::Homogeneous;
use crate::oracle::snap::snapped;
use crate::oracle::{Oracle, Triangle, UNIT, Vertex};

pub const CASES: &[&Case] = &[&QUADS, &ROWS, &CLIPPED, &USUAL, &NONE];

static QUADS: Case = Case::new("ground plane from 1e-3 to 1e5, two triangles", quads);
static ROWS: Case = Case::new("ground plane from 1e-3 to 1e5, 50 rows of tiles", rows);
static CLIPPED: Case = Case::new("ground plane from behind the eye to 1e5, near plane 1e-3", || clipped(NEAREST));
static USUAL: Case = Case::new("ground plane from behind the eye to 1e5, near plane 0.1", || clipped(0.1));
static NONE: Case = Case::new("ground plane from behind the eye to 1e5, no near plane", || clipped(0.0));

const SIZE: (usize, usize) = (1024, 1024);
/// For clipped triangles, which take longer to compare.
const SMALL: (usize, usize) = (256, 256);
const HALF: i64 = 512 * UNIT;
const NEAREST: f32 = 1e-3;
const FARTHEST: f32 = 1e5;
/// Height of the eye above the ground; the lower it is, the more of the near end is in view.
const HEIGHTS: [f32; 7] = [5e-4, 1e-3, 0.02, 1.7, 30.0, 1000.0, 40_000.0];

/// The ground's vertex at the distance that lands on row `y` and column `x` of the grid, in units; rows run down.
fn vertex(height: f32, x: i64, y: i64) -> [f32; 4] {
    let half = HALF as f64;
    // From the horizon in the middle of the screen down to the vertex, in half screens: height / w.
    let down = (y - HALF) as f64 / half;
    let w = (f64::from(height) / down) as f32;
    [((x - HALF) as f64 / half * f64::from(w)) as f32, (-down * f64::from(w)) as f32, 0.0, w]
}

/// The rows of the grid at the ground's farthest and nearest ends; but not so far below the screen that it is uncertain
/// where on the grid a vertex lands.
fn ends(height: f32) -> (i64, i64) {
    let row = |w: f32| HALF + (f64::from(height) / f64::from(w) * HALF as f64) as i64;
    (row(FARTHEST).max(HALF + 1), row(NEAREST).min(HALF + 1400 * UNIT))
}

fn triangles(vertices: &[[f32; 4]]) -> Vec<Triangle> {
    let corner = |v: &[f32; 4]| snapped(*v, SIZE, false).expect("a vertex on the grid");
    vertices.chunks_exact(3).map(|t| [corner(&t[0]), corner(&t[1]), corner(&t[2])]).collect()
}

/// Two triangles from row `top` to `bottom` and from column `left` to `right`.
fn quad(height: f32, [left, right]: [i64; 2], [top, bottom]: [i64; 2]) -> [[f32; 4]; 6] {
    let v = |x, y| vertex(height, x, y);
    [v(left, top), v(right, top), v(right, bottom), v(left, top), v(right, bottom), v(left, bottom)]
}

fn quads() -> Measured {
    let mut subject = Subject::new(SIZE, YAxis::Down);
    let oracle = Oracle::new(SIZE.0, SIZE.1);
    let mut measured = Measured::default();
    for height in HEIGHTS {
        let (top, bottom) = ends(height);
        let quad = quad(height, [-700 * UNIT, 1900 * UNIT], [top, bottom]);
        for (corners, t) in quad.chunks_exact(3).zip(triangles(&quad)) {
            subject.clear();
            subject.draw_clip(corners);
            measured.one(&t, subject.depth(), &oracle);
        }
        subject.draw_clip(&quad);
        // The ground hides nothing of itself.
        measured.shown(subject.test_clip(&quad));
        for t in quad.chunks_exact(3) {
            measured.shown(subject.test_clip(t));
        }
    }
    measured
}

fn rows() -> Measured {
    let mut subject = Subject::new(SIZE, YAxis::Down);
    let mut oracle = Oracle::new(SIZE.0, SIZE.1);
    let mut measured = Measured::default();
    for height in HEIGHTS {
        let (top, bottom) = ends(height);
        // Rows of tiles, each covering the same share of the remaining distance to the horizon, like a terrain's levels
        // of detail.
        let mut edges = vec![bottom];
        while edges.len() < 50 && edges[edges.len() - 1] > top {
            let last = edges[edges.len() - 1];
            edges.push((HALF + (last - HALF) * 3 / 4).max(top));
        }
        let mut mesh = Vec::new();
        for pair in edges.windows(2) {
            for column in -2..6 {
                let x = column * 256 * UNIT;
                mesh.extend(quad(height, [x, x + 256 * UNIT], [pair[1], pair[0]]));
            }
        }
        let triangles = triangles(&mesh);
        oracle.clear();
        triangles.iter().for_each(|t| oracle.draw(t));
        // At a single depth no rule gives up a pixel, and all pixels are compared.
        let flat: Vec<_> = triangles.iter().map(|t| t.map(|v| Vertex { z: 1.0, ..v })).collect();
        subject.clear();
        subject.draw(&flat);
        measured.coverage(triangles.iter().copied(), subject.depth(), &oracle);
        subject.clear();
        subject.draw_clip(&mesh);
        measured.depths(subject.depth(), &oracle);
        // No tile that covers a pixel's centre is hidden by the others.
        for (t, corners) in triangles.iter().zip(mesh.chunks_exact(3)) {
            if oracle.shows(t) {
                measured.shown(subject.test_clip(corners));
            }
        }
    }
    measured
}

fn clipped(near: f32) -> Measured {
    let mut subject = Subject::new(SMALL, YAxis::Down);
    subject.set_near(near);
    let mut measured = Measured::default();
    for height in HEIGHTS {
        let far = FARTHEST;
        let ground = [
            [[-3.0 * far, -height, 0.0, far], [3.0 * far, -height, 0.0, far], [0.0, -height, 0.0, -far]],
            [[-far, -height, 0.0, far], [-0.3, -height, 0.0, -0.1], [0.7, -height, 0.0, -0.3]],
            [[0.0, -height, 0.0, far], [far, -height, 0.0, -far], [-far, -height, 0.0, -far]],
        ];
        for t in ground {
            let corners = t.map(|[x, y, _, w]| [x, y, w].map(f64::from));
            let exact = Homogeneous::new(&corners, f64::from(near), SMALL, false).expect("not edge-on");
            if !measured.taken(&mut subject, &t) {
                continue;
            }
            measured.clipped(&exact, 1.0 / f64::from(far), subject.depth(), SMALL.0);
            measured.shown(subject.test_clip(&t));
        }
    }
    measured
}

/// A single quad for all of it: the depth of a whole plane has to come from three corners whose 1/w differ by a factor
/// of 10^8.
#[test]
fn a_ground_plane_of_two_triangles() {
    QUADS.measured().assert_exact().assert_behind(1.3e-4, 0.0);
}

/// Tiles that grow with distance; the last rows are less than a pixel high.
#[test]
fn a_ground_plane_of_rows() {
    ROWS.measured().assert_exact().assert_behind(0.25, 0.07);
}

/// The plane continues under the eye and behind it, as it does in games.
#[test]
fn a_ground_plane_from_behind_the_eye() {
    let m = CLIPPED.measured();
    m.assert_clipped().assert_behind(0.017, 2e-4);
    assert_eq!(m.refused, 0);
}

/// With the near plane of a typical camera.
#[test]
fn a_ground_plane_from_behind_the_eye_and_a_usual_near_plane() {
    let m = USUAL.measured();
    m.assert_clipped().assert_behind(0.017, 2e-4);
    assert_eq!(m.refused, 0);
}

/// As for an object whose near plane has not been set: only the guard band clips the ground, at w = height / 1984. From
/// a tenth of a unit above it, that is too near for triangles as large as 1e5, and they are dropped.
#[test]
fn a_ground_plane_from_behind_the_eye_without_near_plane() {
    let m = NONE.measured();
    m.assert_clipped().assert_behind(0.017, 2e-4);
    assert_eq!(m.refused, 9);
}
