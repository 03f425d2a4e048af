//! The kinds of triangles that are compared: those of the coverage tests, and some that are built to produce ties.

use std::collections::VecDeque;

use clap::ValueEnum;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{Config, RngSeed, TestRunner};

use crate::view::View;
use tools::oracle::{Triangle, UNIT, Vertex};
use tools::triangles::{self, of_kind};

/// A kind of triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    Uniform,
    Small,
    Tiny,
    OnCentres,
    OnCorners,
    NearHorizontal,
    NearVertical,
    Diagonal,
    FlatWide,
    HorizontalEdge,
    VerticalEdge,
    MixedScale,
    PartlyOff,
    /// Corners anywhere in the viewport, mostly far off the screen
    FarOff,
    /// An edge through the centres of a row of pixels; its ends need not be centres
    ThroughCentres,
    /// Fans of three around a pixel centre, which is on two edges of each
    SharedEdges,
    /// Degenerate: zero area
    Degenerate,
}

impl Kind {
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |v| v.get_name().to_owned())
    }

    /// Its name in the coverage tests, if they have it.
    fn of_the_tests(self) -> Option<triangles::Kind> {
        use triangles::Kind as Of;
        Some(match self {
            Self::Uniform => Of::Uniform,
            Self::Small => Of::Small,
            Self::Tiny => Of::Tiny,
            Self::OnCentres => Of::OnCentres,
            Self::OnCorners => Of::OnCorners,
            Self::NearHorizontal => Of::NearHorizontal,
            Self::NearVertical => Of::NearVertical,
            Self::Diagonal => Of::Diagonal,
            Self::FlatWide => Of::FlatWide,
            Self::HorizontalEdge => Of::HorizontalEdge,
            Self::VerticalEdge => Of::VerticalEdge,
            Self::MixedScale => Of::MixedScale,
            Self::PartlyOff => Of::PartlyOff,
            Self::FarOff | Self::ThroughCentres | Self::SharedEdges | Self::Degenerate => return None,
        })
    }
}

/// The source of triangles of one kind.
enum Source {
    OfTheTests(BoxedStrategy<Triangle>),
    Ours,
}

/// An endless sequence of triangles for a screen, cycling through the kinds; the same for the same seed.
pub struct Triangles {
    view: View,
    sources: Vec<(Kind, Source, VecDeque<Triangle>)>,
    next: usize,
    runner: TestRunner,
    random: fastrand::Rng,
}

impl Triangles {
    pub fn new(view: View, kinds: &[Kind], seed: u64) -> Self {
        let source = |kind: Kind| match kind.of_the_tests() {
            Some(of) => Source::OfTheTests(of_kind(of, (view.width, view.height))),
            None => Source::Ours,
        };
        let sources = kinds.iter().map(|&kind| (kind, source(kind), VecDeque::new())).collect();
        let config = Config { rng_seed: RngSeed::Fixed(seed), failure_persistence: None, ..Config::default() };
        Self { view, sources, next: 0, runner: TestRunner::new(config), random: fastrand::Rng::with_seed(seed) }
    }

    /// The next triangle, and the index of its kind.
    pub fn make_next(&mut self) -> Result<(usize, Triangle), String> {
        let index = self.next;
        self.next = (index + 1) % self.sources.len();
        let (kind, source, waiting) = &mut self.sources[index];
        if waiting.is_empty() {
            match source {
                Source::OfTheTests(strategy) => {
                    let tree = strategy.new_tree(&mut self.runner).map_err(|why| why.to_string())?;
                    waiting.push_back(aimed(*kind, tree.current(), &mut self.random));
                }
                Source::Ours => waiting.extend(Maker { view: self.view, random: &mut self.random }.make(*kind)),
            }
        }
        let triangle = waiting.pop_front().ok_or("no triangle was made")?;
        Ok((index, self.view.within_reach(&triangle)))
    }
}

type Point = (i64, i64);

/// Moves half of the triangles of the kinds that rarely touch a pixel centre onto one; the others are not changed.
fn aimed(kind: Kind, mut t: Triangle, random: &mut fastrand::Rng) -> Triangle {
    let on_centre = |v: i64| v.div_euclid(UNIT) * UNIT + UNIT / 2;
    match kind {
        Kind::NearHorizontal | Kind::NearVertical | Kind::HorizontalEdge | Kind::VerticalEdge if random.bool() => {
            let mut corners = t;
            // The middle corner of a thin triangle, so that its row or column of centres passes through the inside.
            let at = match kind {
                Kind::NearHorizontal => {
                    corners.sort_by_key(|v| v.y);
                    1
                }
                Kind::NearVertical => {
                    corners.sort_by_key(|v| v.x);
                    1
                }
                _ => random.usize(0..3),
            };
            let to = corners[at];
            // The whole triangle is moved, so that it stays as thin, and horizontal or vertical edges stay so.
            let (dx, dy) = (on_centre(to.x) - to.x, on_centre(to.y) - to.y);
            t.map(|v| Vertex { x: v.x + dx, y: v.y + dy, z: v.z })
        }
        Kind::Diagonal if random.bool() => {
            // Only the ends are moved: the corner between them stays, which gives a thickness of up to half a pixel.
            for v in &mut t[..2] {
                (v.x, v.y) = (on_centre(v.x), on_centre(v.y));
            }
            t
        }
        _ => t,
    }
}

/// Generates the kinds that the tests do not have.
struct Maker<'a> {
    view: View,
    random: &'a mut fastrand::Rng,
}

impl Maker<'_> {
    fn make(&mut self, kind: Kind) -> Vec<Triangle> {
        match kind {
            Kind::ThroughCentres => vec![self.through_centres()],
            Kind::SharedEdges => self.fan(),
            Kind::Degenerate => vec![self.degenerate()],
            _ => {
                let corners = [self.anywhere(), self.anywhere(), self.anywhere()];
                vec![self.triangle(corners)]
            }
        }
    }

    /// A triangle with a different w at each corner.
    fn triangle(&mut self, corners: [Point; 3]) -> Triangle {
        corners.map(|(x, y)| Vertex { x, y, z: 0.5f64.powi(self.random.i32(0..=6)) })
    }

    fn anywhere(&mut self) -> Point {
        let ((x, y), reach) = (self.view.centre(), self.view.reach());
        (x + self.random.i64(-reach..=reach), y + self.random.i64(-reach..=reach))
    }

    fn on_screen(&mut self) -> Point {
        let (w, h) = (self.view.width as i64 * UNIT, self.view.height as i64 * UNIT);
        (self.random.i64(0..=w), self.random.i64(0..=h))
    }

    fn pixel_centre(&mut self) -> Point {
        let (w, h) = (self.view.width as i64, self.view.height as i64);
        (self.random.i64(0..w) * UNIT + UNIT / 2, self.random.i64(0..h) * UNIT + UNIT / 2)
    }

    /// An edge through two pixel centres, extended both ways by any number of 256ths of their distance, and a third
    /// corner anywhere.
    fn through_centres(&mut self) -> Triangle {
        let (x, y) = self.pixel_centre();
        // Half of them horizontal or vertical, where the fill rule matters most.
        let step = match self.random.u32(0..4) {
            0 => (1, 0),
            1 => (0, 1),
            _ => (self.random.i64(-7..=7), self.random.i64(-7..=7)),
        };
        let mut end = |sign: i64| {
            let parts = sign * self.random.i64(1..=UNIT * 32);
            (x + step.0 * parts, y + step.1 * parts)
        };
        let ends = [end(1), end(-1)];
        let third = self.on_screen();
        self.turned([ends[0], ends[1], third])
    }

    /// Three triangles around a pixel centre.
    fn fan(&mut self) -> Vec<Triangle> {
        let hub = self.pixel_centre();
        let rim = [0; 3].map(|_| if self.random.bool() { self.pixel_centre() } else { self.on_screen() });
        (0..3).map(|i| self.turned([hub, rim[i], rim[(i + 1) % 3]])).collect()
    }

    fn degenerate(&mut self) -> Triangle {
        let (a, b) = (self.pixel_centre(), self.pixel_centre());
        match self.random.u32(0..4) {
            0 => self.triangle([a, a, a]),
            1 => self.turned([a, a, b]),
            2 => {
                let c = self.on_screen();
                self.turned([c, c, a])
            }
            // Three collinear points: centres are whole pixels apart, so 256ths of the distance are grid points.
            _ => {
                let part = self.random.i64(0..=UNIT);
                let between = |a: i64, b: i64| a + (b - a) / UNIT * part;
                self.turned([a, b, (between(a.0, b.0), between(a.1, b.1))])
            }
        }
    }

    /// Rotates the corners, and picks either winding.
    fn turned(&mut self, mut corners: [Point; 3]) -> Triangle {
        self.random.shuffle(&mut corners);
        self.triangle(corners)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ties::ties;
    use tools::oracle::span;

    #[test]
    fn thin_and_level_kinds_meet_centres_and_cover_pixels() {
        let view = View::new((64, 64), 16_384).unwrap();
        for kind in [Kind::NearHorizontal, Kind::NearVertical, Kind::Diagonal, Kind::HorizontalEdge, Kind::VerticalEdge]
        {
            let mut source = Triangles::new(view, &[kind], 1);
            let triangles: Vec<Triangle> = (0..1000).map(|_| source.make_next().unwrap().1).collect();
            let tied = triangles.iter().filter(|t| ties(t, view) > 0).count();
            let covers = |t: &&Triangle| (0..view.height).any(|row| !span(t, row, view.width).is_empty());
            let covering = triangles.iter().filter(covers).count();
            assert!(tied > 400, "{kind:?}: {tied} of 1000 have a centre on an edge");
            assert!(covering > 200, "{kind:?}: {covering} of 1000 cover a pixel");
        }
    }
}
