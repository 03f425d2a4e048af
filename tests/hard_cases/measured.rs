//! What is measured of a case; docs/accuracy.md says what each figure is.

use masked_occlusion_culling::CullingResult;

use crate::cases::subject::Subject;
use crate::oracle::bounds::{block_bound, inside_by, ulp};
use crate::oracle::homogeneous::Homogeneous;
use crate::oracle::{Oracle, Triangle, depth_at_pixel, span};
use crate::support::is_empty;

/// Exact depths are off by a few parts in 10^16; less than this, in parts of an exact depth, is none.
const EXACT: f64 = 1e-15;

#[derive(Clone, Debug)]
pub struct Measured {
    /// Triangles drawn.
    pub triangles: u64,
    /// Pixels whose coverage was compared.
    pub pixels: u64,
    /// Pixels that are covered and should not be, or should be and are not.
    pub wrong: u64,
    /// How far the centre of a wrong pixel lies from the exact line, at most, in pixels.
    pub off: f64,
    /// Pixels whose depth was compared.
    pub depths: u64,
    /// Stored less exact depth at the pixel's centre, in units in the last place of the exact one: the greatest. Above
    /// zero is too near.
    pub nearer: f64,
    /// Stored depth less the exact bound of its block of 8x4 pixels, in units in the last place of the bound: the greatest.
    /// Above zero a point of the block between pixel centres may be farther than the buffer says.
    pub over: f64,
    /// Exact bound less stored depth, in units in the last place of the bound: the greatest.
    pub behind: f64,
    /// The same as a part of the bound.
    pub part: f64,
    /// Pixels stored more than a hundredth behind the bound.
    pub far_behind: u64,
    /// Triangles that were refused, and of which nothing was drawn.
    pub refused: u64,
    /// Pixels where neighbours leave a crack, or overlap.
    pub cracks: u64,
    /// Pixels that are covered, and of which the buffer no longer knows.
    pub forgotten: u64,
    /// Queries asked of what shows.
    pub asked: u64,
    /// Those of them answered OCCLUDED.
    pub hidden: u64,
}

impl Default for Measured {
    fn default() -> Self {
        Self {
            triangles: 0,
            pixels: 0,
            wrong: 0,
            off: 0.0,
            depths: 0,
            nearer: f64::NEG_INFINITY,
            over: f64::NEG_INFINITY,
            behind: f64::NEG_INFINITY,
            part: f64::NEG_INFINITY,
            far_behind: 0,
            refused: 0,
            cracks: 0,
            forgotten: 0,
            asked: 0,
            hidden: 0,
        }
    }
}

impl Measured {
    /// Takes in the depth stored for a pixel that something covers.
    pub fn depth(&mut self, stored: f32, exact: f64) {
        let stored = f64::from(stored);
        // NaN would be lost in every maximum below.
        assert!(stored > 0.0 && stored.is_finite(), "{stored} is stored");
        let nearer = stored - exact;
        let nearer = if nearer.abs() <= exact * EXACT { 0.0 } else { nearer };
        self.depths += 1;
        self.nearer = self.nearer.max(nearer / ulp(exact));
    }

    /// Takes in how far it is behind a bound.
    pub fn bound(&mut self, stored: f32, bound: f64) {
        let stored = f64::from(stored);
        self.behind = self.behind.max((bound - stored) / ulp(bound));
        self.part = self.part.max((bound - stored) / bound);
        self.far_behind += u64::from(stored < 0.99 * bound);
    }

    /// Takes in a pixel whose coverage is wrong, `distance` pixels from the line that decides.
    pub fn wrong(&mut self, distance: f64) {
        self.wrong += 1;
        self.off = self.off.max(distance.abs());
    }

    /// Takes in the answer about something that shows.
    pub fn shown(&mut self, answer: CullingResult) {
        self.asked += 1;
        self.hidden += u64::from(answer == CullingResult::Occluded);
    }

    /// A buffer that holds one triangle on the grid, every pixel of it.
    pub fn one(&mut self, t: &Triangle, depth: &[f32], oracle: &Oracle) {
        self.triangles += 1;
        self.pixels += depth.len() as u64;
        let stored = depth.iter().filter(|d| !is_empty(**d)).count();
        let mut found = 0;
        for row in oracle.rows(t) {
            let mut bound = (usize::MAX, 0.0);
            for column in span(t, row, oracle.width) {
                let stored = depth[row * oracle.width + column];
                if is_empty(stored) {
                    self.wrong(inside_by(t, column, row));
                    continue;
                }
                found += 1;
                if bound.0 != column / 8 {
                    bound = (column / 8, block_bound(t, column, row));
                }
                self.depth(stored, depth_at_pixel(t, column, row));
                self.over = self.over.max((f64::from(stored) - bound.1) / ulp(bound.1));
                self.bound(stored, bound.1);
            }
        }
        if found != stored {
            for (i, _) in depth.iter().enumerate().filter(|(_, d)| !is_empty(**d)) {
                let (column, row) = (i % oracle.width, i / oracle.width);
                if !span(t, row, oracle.width).contains(&column) {
                    self.wrong(inside_by(t, column, row));
                }
            }
        }
    }

    /// The coverage alone of many triangles on the grid, drawn at one depth.
    pub fn coverage(&mut self, triangles: impl Iterator<Item = Triangle> + Clone, depth: &[f32], oracle: &Oracle) {
        self.triangles += triangles.clone().count() as u64;
        self.pixels += depth.len() as u64;
        for (i, (stored, exact)) in depth.iter().zip(&oracle.depth).enumerate() {
            if is_empty(*stored) != (*exact < 0.0) {
                let (column, row) = (i % oracle.width, i / oracle.width);
                let distances = triangles.clone().map(|t| inside_by(&t, column, row).abs());
                self.wrong(distances.fold(f64::MAX, f64::min));
            }
        }
    }

    /// The depths alone of many triangles on the grid. The bound is the least exact depth of a block's 32 pixels, where all
    /// of them are covered. A pixel that holds nothing though something covers it was given up by the update rule.
    pub fn depths(&mut self, depth: &[f32], oracle: &Oracle) {
        for block_row in 0..oracle.height / 4 {
            for block_column in 0..oracle.width / 8 {
                let pixels = (0..32).map(|k| (block_row * 4 + k / 8) * oracle.width + block_column * 8 + k % 8);
                let least = pixels.clone().fold(f64::MAX, |m, i| m.min(oracle.depth[i]));
                for i in pixels {
                    let (stored, exact) = (depth[i], oracle.depth[i]);
                    if is_empty(stored) {
                        self.forgotten += u64::from(exact > 0.0);
                    } else if exact < 0.0 {
                        self.wrong(f64::INFINITY);
                    } else {
                        self.depth(stored, exact);
                        if least > 0.0 {
                            self.bound(stored, least);
                        }
                    }
                }
            }
        }
    }

    /// A triangle that is drawn alone. False: it was refused, and nothing was drawn.
    pub fn taken(&mut self, subject: &mut Subject, t: &[[f32; 4]; 3]) -> bool {
        let before = subject.dropped();
        subject.clear();
        subject.draw_clip(t);
        let refused = subject.dropped() > before;
        if refused {
            self.triangles += 1;
            self.refused += 1;
            assert!(subject.depth().iter().all(|d| is_empty(*d)), "{t:?} is refused, and drawn");
        }
        !refused
    }

    /// A buffer that holds one triangle that is clipped, given by what a pixel's ray meets. `farthest`: 1/w of its farthest
    /// vertex.
    pub fn clipped(&mut self, exact: &Homogeneous, farthest: f64, depth: &[f32], width: usize) {
        self.triangles += 1;
        self.pixels += depth.len() as u64;
        for (i, &stored) in depth.iter().enumerate() {
            let (column, row) = (i % width, i / width);
            let inside = exact.inside_by(column, row);
            // Closer than this the oracle itself cannot tell.
            if is_empty(stored) == (inside > 0.0) && inside.abs() > 1e-9 {
                self.wrong(inside);
            }
            if !is_empty(stored) {
                // A pixel that is covered falsely lies beyond the line, where the plane may end.
                let at = if inside > 0.0 { exact.depth(column, row) } else { exact.depth(column, row).max(farthest) };
                self.depth(stored, at);
                self.bound(stored, exact.block_depth(column, row).max(farthest));
            }
        }
    }

    /// Takes in what another part of the case measured.
    pub fn add(&mut self, other: &Measured) {
        self.triangles += other.triangles;
        self.pixels += other.pixels;
        self.wrong += other.wrong;
        self.off = self.off.max(other.off);
        self.depths += other.depths;
        self.nearer = self.nearer.max(other.nearer);
        self.over = self.over.max(other.over);
        self.behind = self.behind.max(other.behind);
        self.part = self.part.max(other.part);
        self.far_behind += other.far_behind;
        self.refused += other.refused;
        self.cracks += other.cracks;
        self.forgotten += other.forgotten;
        self.asked += other.asked;
        self.hidden += other.hidden;
    }

    /// No pixel is covered wrongly, none is too near, and nothing is called hidden that shows.
    pub fn assert_exact(&self) -> &Self {
        assert_eq!((self.wrong, self.cracks), (0, 0), "pixels covered wrongly: {self:?}");
        self.assert_safe()
    }

    /// The same of what is clipped: a new corner is snapped, and pixels may be wrong whose centres lie within half a unit of
    /// the grid, across, of the exact line. Here the unit's whole is allowed, for corners far out are snapped more coarsely.
    pub fn assert_clipped(&self) -> &Self {
        assert!(self.off <= 1.0 / 256.0, "{} pixels off: {self:?}", self.off);
        assert_eq!(self.cracks, 0, "cracks: {self:?}");
        self.assert_safe()
    }

    /// No pixel is too near, and nothing is called hidden that shows; and something was compared.
    pub fn assert_safe(&self) -> &Self {
        assert!(self.depths > 500, "{self:?}");
        assert!(self.nearer <= 0.0, "stored too near: {self:?}");
        assert!(self.over <= 0.0, "too near within a block of 8x4 pixels: {self:?}");
        assert_eq!(self.hidden, 0, "called hidden, but it shows: {self:?}");
        self
    }

    /// No pixel is farther behind its bound than a part of it, and no more than a share of them by over a hundredth.
    pub fn assert_behind(&self, part: f64, share: f64) -> &Self {
        assert!(self.part <= part, "{} behind: {self:?}", self.part);
        assert!(self.behind_share() <= share, "{} are behind: {self:?}", self.behind_share());
        self
    }

    /// The share of covered pixels that are more than a hundredth behind, or given up.
    pub fn behind_share(&self) -> f64 {
        (self.far_behind + self.forgotten) as f64 / (self.depths + self.forgotten).max(1) as f64
    }
}
