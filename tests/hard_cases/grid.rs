//! Vertices at positions where comparisons are decided by equality: on the screen's edges, on the corners of tiles and
//! sub-tiles, on the guard band.

use masked_occlusion_culling::YAxis;

use crate::cases::Case;
use crate::cases::measured::Measured;
use crate::cases::subject::Subject;
use crate::oracle::homogeneous::Homogeneous;
use crate::oracle::{Oracle, Triangle, UNIT, Vertex, area, span};

pub const CASES: &[&Case] = &[&CORNERS, &BESIDE, &BAND, &BEYOND, &ASKED];

static CORNERS: Case = Case::new("vertices on the screen's edges and on corners of tiles", || lattice(0));
static BESIDE: Case = Case::new("the same, each within 1/256 pixel of there", || lattice(1));
static BAND: Case = Case::new("vertices on the guard band", || guard_band(0, true));
static BEYOND: Case = Case::new("vertices one step of f32 beyond the guard band", || guard_band(STEP, false));
static ASKED: Case = Case::new("queries with vertices on their guard band, and one step beyond", queries);

/// The guard bands of draws and of queries, from the screen's centre, in units; and the step of f32 on the former.
const DRAWN_BAND: i64 = (1 << 26) - (1 << 21);
const QUERY_BAND: i64 = 1 << 22;
const STEP: i64 = 4;

/// Every triangle whose corners are corners of tiles and sub-tiles, each moved by up to `off` units.
fn lattice(off: i64) -> Measured {
    let size = (64, 16);
    let mut points = Vec::new();
    for x in [0, 8, 32, 40, 64] {
        for y in [0, 4, 8, 12, 16] {
            points.push((x * UNIT, y * UNIT));
        }
    }
    let mut subjects = [YAxis::Down, YAxis::Up].map(|axis| Subject::new(size, axis));
    let oracle = Oracle::new(size.0, size.1);
    let mut measured = Measured::default();
    let mut random = fastrand::Rng::with_seed(31);
    let mut turn = 0;
    for i in 0..points.len() {
        for j in 0..i {
            for k in 0..j {
                let t: Triangle = [(i, 1.0), (j, 0.25), (k, 0.5)].map(|(p, z)| {
                    let (x, y) = points[p];
                    Vertex { x: x + random.i64(-off..=off), y: y + random.i64(-off..=off), z }
                });
                if area(&t) == 0 {
                    continue;
                }
                turn += 1;
                let subject = &mut subjects[turn % 2];
                subject.clear();
                subject.draw(&[t]);
                measured.one(&t, subject.depth(), &oracle);
            }
        }
    }
    measured
}

const SIZE: (usize, usize) = (256, 64);

/// A triangle with one corner on or near the screen and one or two on a band `far` units from its centre, with w = 1.
fn reaching(random: &mut fastrand::Rng, far: i64) -> Triangle {
    let (half_x, half_y) = (SIZE.0 as i64 * 128, SIZE.1 as i64 * 128);
    let near = |random: &mut fastrand::Rng| (random.i64(-64 * UNIT..320 * UNIT), random.i64(-32 * UNIT..=96 * UNIT));
    let distant = |random: &mut fastrand::Rng| {
        let side = if random.bool() { far } else { -far };
        // Along the band, a multiple of the f32 spacing there.
        let along = match random.u32(0..4) {
            0 => 0,
            1 => side,
            _ => random.i64(-far / 64..=far / 64) * 64,
        };
        let (x, y) = if random.bool() { (side, along) } else { (along, side) };
        (half_x + x, half_y + y)
    };
    let mut corners = [near(random), distant(random), if random.bool() { near(random) } else { distant(random) }];
    random.shuffle(&mut corners);
    let mut z = [1.0, 0.5, 0.0625];
    random.shuffle(&mut z);
    [0, 1, 2].map(|k| Vertex { x: corners[k].0, y: corners[k].1, z: z[k] })
}

/// A triangle as wide as the guard band with an edge exactly through a pixel's centre on the screen: a tie, which the
/// last bit of the edge's slope would decide if it were rounded.
fn through_a_centre(random: &mut fastrand::Rng) -> Triangle {
    let centre = |n: i64| n * UNIT + UNIT / 2;
    let (x, y) = (centre(random.i64(0..256)), centre(random.i64(0..64)));
    let most = (DRAWN_BAND - (1 << 17)) / 32;
    let (a, b) = (random.i64(-most..=most), random.i64(-most..=most));
    let back = 4 * random.i64(1..=8);
    let side = random.i64(0..2) * 2 - 1;
    [
        Vertex { x: x + 32 * a, y: y + 32 * b, z: 1.0 },
        Vertex { x: x - back * a, y: y - back * b, z: 0.5 },
        Vertex { x: x - side * 4 * b, y: y + side * 4 * a, z: 0.25 },
    ]
}

/// Triangles with corners `beyond` the band: still unclipped if that is zero.
fn guard_band(beyond: i64, exact: bool) -> Measured {
    let mut subject = Subject::new(SIZE, YAxis::Down);
    let oracle = Oracle::new(SIZE.0, SIZE.1);
    let mut measured = Measured::default();
    let mut random = fastrand::Rng::with_seed(32);
    for k in 0..1500 {
        let tie = exact && k % 2 == 0;
        let t = if tie { through_a_centre(&mut random) } else { reaching(&mut random, DRAWN_BAND + beyond) };
        if area(&t) == 0 || !(0..SIZE.1).any(|row| !span(&t, row, SIZE.0).is_empty()) {
            continue;
        }
        subject.clear();
        subject.draw(&[t]);
        if exact {
            measured.one(&t, subject.depth(), &oracle);
        } else {
            let corners = t.map(|v| crate::support::clip_vertex(&v, SIZE, YAxis::Down));
            let wide = corners.map(|[x, y, _, w]| [x, y, w].map(f64::from));
            let rays = Homogeneous::new(&wide, 0.0, SIZE, false).expect("not edge-on");
            let farthest = t.iter().fold(f64::MAX, |m, v| m.min(v.z));
            measured.clipped(&rays, farthest, subject.depth(), SIZE.0);
        }
    }
    measured
}

/// Against a buffer of random walls: an occludee visible at a pixel's centre is not reported hidden.
fn queries() -> Measured {
    let mut subject = Subject::new(SIZE, YAxis::Down);
    let mut oracle = Oracle::new(SIZE.0, SIZE.1);
    let mut measured = Measured::default();
    let mut random = fastrand::Rng::with_seed(33);
    for k in 0..3000 {
        if k % 50 == 0 {
            // Walls that leave one corner of the screen free, or nothing.
            subject.clear();
            oracle.clear();
            let wall = |x: i64, y: i64, z: f64| Vertex { x: x * UNIT, y: y * UNIT, z };
            let (x, y) = (random.i64(0..=256), random.i64(0..=64));
            let z = [0.5, 0.25, 0.03125][k / 50 % 3];
            let walls = [
                [wall(0, 0, z), wall(x, 0, z), wall(0, 64, z)],
                [wall(256, 64, z), wall(256, y, z), wall(0, 64, z)],
                [wall(0, 0, z), wall(256, 0, z), wall(128, 64, z)],
            ];
            walls.iter().for_each(|t| oracle.draw(t));
            subject.draw(&walls);
            measured.triangles += 3;
            measured.depths(subject.depth(), &oracle);
        }
        // On this band f32 can represent every unit.
        let t = reaching(&mut random, QUERY_BAND + [0, 1, -1][k % 3]);
        if oracle.shows(&t) {
            let corners = t.map(|v| crate::support::clip_vertex(&v, SIZE, YAxis::Down));
            measured.shown(subject.test_clip(&corners));
        }
    }
    measured
}

/// All triangles of 25 corners of tiles, sub-tiles and the screen.
#[test]
fn vertices_on_corners_of_tiles_and_the_screen() {
    CORNERS.measured().assert_exact().assert_behind(6e-5, 0.0);
}

/// Every corner moved by -1, 0 or 1 unit in x and y: to both sides of the edges of tiles and the screen.
#[test]
fn vertices_beside_corners_of_tiles_and_the_screen() {
    BESIDE.measured().assert_exact().assert_behind(2e-4, 0.0);
}

/// As far out as a vertex may be without being clipped: 253,952 pixels, where products do not fit in doubles. Half of
/// the triangles have an edge that ties with a pixel's centre.
#[test]
fn vertices_on_the_guard_band() {
    BAND.measured().assert_exact().assert_behind(0.0012, 0.0);
}

/// One step farther, where it is clipped.
#[test]
fn vertices_just_beyond_the_guard_band() {
    BEYOND.measured().assert_clipped().assert_behind(0.013, 1e-6);
}

/// A query's guard band is narrower, 16,384 pixels.
#[test]
fn queries_on_their_guard_band() {
    let m = ASKED.measured();
    m.assert_safe().assert_behind(1e-6, 0.0);
    assert!(m.asked > 300, "{m:?}");
}
