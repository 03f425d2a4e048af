//! T-junctions: a corner of one triangle on an edge of another, where a terrain's levels of detail meet or a tool has
//! cut a wall. If the corner is on the line, there is no gap; if it is off the line, the gaps are those of the exact
//! triangles and no others.

use masked_occlusion_culling::YAxis;

use crate::cases::Case;
use crate::cases::measured::Measured;
use crate::cases::subject::Subject;
use crate::oracle::{Oracle, Triangle, UNIT, Vertex, crossings, span};

pub const CASES: &[&Case] = &[&ON, &OFF];

static ON: Case = Case::new("T-junctions on the line", || junctions(0));
static OFF: Case = Case::new("T-junctions 1/256 pixel off the line", || junctions(1));

const SIZE: (usize, usize) = (128, 64);

type Point = (i64, i64);

/// A seam of `steps` equal steps between grid points. On one side is a quad of two triangles, with the whole seam as an
/// edge; on the other a fan with a corner at every point, where the inner ones are `off` units from the line.
struct Seam {
    from: Point,
    step: Point,
    steps: i64,
    off: i64,
}

impl Seam {
    fn random(random: &mut fastrand::Rng, off: i64) -> Self {
        let mut step = (random.i64(200..=6000), random.i64(-2000..=2000));
        if random.bool() {
            // Through the centres of pixels, where a tie decides.
            step = (step.0 / 128 * 128, step.1 / 128 * 128);
        }
        let steps = (SIZE.0 as i64 * UNIT / step.0 + 2).clamp(2, 40);
        let middle = (64 * UNIT + random.i64(-8..=8) * UNIT / 2, 32 * UNIT + random.i64(-8..=8) * UNIT / 2);
        let from = (middle.0 - step.0 * (steps / 2), middle.1 - step.1 * (steps / 2));
        Self { from, step, steps, off }
    }

    fn point(&self, k: i64) -> Point {
        (self.from.0 + self.step.0 * k, self.from.1 + self.step.1 * k)
    }

    /// A point moved perpendicular to the seam, by about 100 pixels, to the quad's side or the fan's.
    fn beside(&self, (x, y): Point, side: i64) -> Point {
        let far = side * 25_000 / self.step.0.abs().max(self.step.1.abs());
        (x - self.step.1 * far, y + self.step.0 * far)
    }

    /// The corners of quad and fan together.
    fn outline(&self) -> [Point; 5] {
        let (first, last) = (self.point(0), self.point(self.steps));
        [first, self.beside(first, 1), self.beside(last, 1), last, self.apex()]
    }

    fn apex(&self) -> Point {
        self.beside(self.point(self.steps / 2), -1)
    }

    fn triangles(&self) -> Vec<Triangle> {
        let vertex = |(x, y): Point, z: f64| Vertex { x, y, z };
        let [first, a, b, last, apex] = self.outline();
        let mut triangles =
            vec![[first, last, b].map(|p| vertex(p, 0.5)), [vertex(first, 0.5), vertex(b, 0.25), vertex(a, 1.0)]];
        let fan = |k: i64| {
            let (x, y) = self.point(k);
            // Displaced to the fan's side, so that a gap opens.
            let off = if k == 0 || k == self.steps { 0 } else { -self.off };
            vertex((x - off * self.step.1.signum(), y + off), 0.5)
        };
        triangles.extend((0..self.steps).map(|k| [fan(k), vertex(apex, 0.125), fan(k + 1)]));
        triangles
    }
}

fn junctions(off: i64) -> Measured {
    let mut subject = Subject::new(SIZE, YAxis::Down);
    let oracle = Oracle::new(SIZE.0, SIZE.1);
    let mut measured = Measured::default();
    let mut random = fastrand::Rng::with_seed(5);
    for _ in 0..80 {
        let seam = Seam::random(&mut random, off);
        let (mut times, mut exact) = (vec![0u8; SIZE.0 * SIZE.1], vec![0u8; SIZE.0 * SIZE.1]);
        for t in seam.triangles() {
            subject.clear();
            subject.draw(&[t]);
            let depth = subject.depth();
            measured.one(&t, depth, &oracle);
            times.iter_mut().zip(depth).for_each(|(n, d)| *n += u8::from(*d >= 0.0));
            for row in oracle.rows(&t) {
                exact[row * SIZE.0..][span(&t, row, SIZE.0)].iter_mut().for_each(|n| *n += 1);
            }
        }
        if off == 0 {
            // The outline is independent of the seam: every pixel in it is covered once.
            exact.fill(0);
            for row in 0..SIZE.1 {
                for pair in crossings(&seam.outline(), row as i64).chunks_exact(2) {
                    let column = |p: i64| p.clamp(0, SIZE.0 as i64) as usize;
                    exact[row * SIZE.0..][column(pair[0])..column(pair[1])].fill(1);
                }
            }
        }
        measured.cracks += times.iter().zip(&exact).filter(|(a, b)| a != b).count() as u64;
    }
    measured
}

/// Corners on the grid and exactly on the longer edge: every pixel on the seam is covered once.
#[test]
fn t_junctions_on_the_line_are_tight() {
    ON.measured().assert_exact().assert_behind(5e-6, 0.0);
}

/// A corner that snapping moved by one unit opens a gap: the pixels in it are those of the exact triangles.
#[test]
fn t_junctions_off_the_line_gape_as_exact_triangles_do() {
    OFF.measured().assert_exact().assert_behind(5e-6, 0.0);
}
