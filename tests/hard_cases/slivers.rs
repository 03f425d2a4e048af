//! Slivers as long as the largest screen: cables, fences, the seams of terrain seen edge-on. Their planes are
//! ill-conditioned, and their edges pass pixel centres closer than single precision can resolve.

use masked_occlusion_culling::YAxis;

use crate::cases::Case;
use crate::cases::measured::Measured;
use crate::cases::subject::Subject;
use crate::oracle::{Oracle, Triangle, UNIT, Vertex, area};

pub const CASES: &[&Case] = &[&WIDE, &HIGH];

static WIDE: Case = Case::new("slivers in every direction, 16,384 wide", || slivers((16_384, 16), YAxis::Down));
static HIGH: Case = Case::new("slivers in every direction, 16,384 high", || slivers((16, 16_384), YAxis::Up));

/// Half a sliver's length along its longer axis, in units: 8,192 pixels.
const REACH: i64 = 8192 * UNIT;

/// Directions of that length: in steps of 1/16 of the tangent of a quarter turn, and a few units off horizontal and
/// vertical.
fn directions() -> Vec<(i64, i64)> {
    let mut found = Vec::new();
    for k in -16..16 {
        found.push((REACH, REACH / 16 * k));
        found.push((REACH / 16 * k, REACH));
    }
    for units in [1, 3, 10, 30, 100, 300, 1000] {
        for off in [units, -units] {
            found.push((REACH, off));
            found.push((off, REACH));
        }
    }
    found
}

fn slivers(size: (usize, usize), axis: YAxis) -> Measured {
    let mut subject = Subject::new(size, axis);
    let oracle = Oracle::new(size.0, size.1);
    let mut measured = Measured::default();
    let mut random = fastrand::Rng::with_seed(1);
    let middle = (size.0 as i64 / 2 * UNIT, size.1 as i64 / 2 * UNIT);
    for (k, (dx, dy)) in directions().into_iter().enumerate() {
        for (j, width) in [1, 2, 24, UNIT].into_iter().enumerate() {
            // Through the middle of the screen, give or take some units.
            let (x, y) = (middle.0 + random.i64(-300..=300), middle.1 + random.i64(-300..=300));
            // The third corner is `width` off the line, at the end or somewhere in between.
            let part = [16, 8, 3, -16][(k + j) % 4];
            let (off_x, off_y) = if dx.abs() > dy.abs() { (0, width) } else { (width, 0) };
            let z = [[0, 0, 0], [0, 6, 3], [5, 0, 1]][(k / 2 + j) % 3].map(|k| 1.0 / f64::from(1 << k));
            let t: Triangle = [
                Vertex { x: x - dx, y: y - dy, z: z[0] },
                Vertex { x: x + dx, y: y + dy, z: z[1] },
                Vertex { x: x + dx * part / 16 + off_x, y: y + dy * part / 16 + off_y, z: z[2] },
            ];
            assert_ne!(area(&t), 0);
            subject.clear();
            subject.draw(&[t]);
            measured.one(&t, subject.depth(), &oracle);
        }
    }
    measured
}

/// A cable from one side of a buffer of 16,384 pixels to the other, at every angle, from 1/256 pixel to a pixel thick.
#[test]
fn slivers_in_every_direction_at_16384_wide() {
    WIDE.measured().assert_exact().assert_behind(0.06, 5e-4);
}

/// The same, vertical, with rows that run up.
#[test]
fn slivers_in_every_direction_at_16384_high() {
    HIGH.measured().assert_exact().assert_behind(0.06, 5e-4);
}
