//! The measurements of a case; docs/accuracy.md defines each figure.

use masked_occlusion_culling::CullingResult;

use crate::cases::subject::Subject;
use crate::oracle::bounds::{block_bound, inside_by, ulp};
use crate::oracle::homogeneous::Homogeneous;
use crate::oracle::{Oracle, Triangle, depth_at_pixel, span};
use crate::support::is_empty;

/// Exact depths have an error of a few parts in 10^16; a difference below this, relative to the exact depth, counts as
/// none.
const EXACT: f64 = 1e-15;

#[derive(Clone, Debug)]
pub struct Measured {
    /// Triangles drawn.
    pub triangles: u64,
    /// Pixels whose coverage was compared.
    pub pixels: u64,
    /// Pixels that are covered but should not be, or the reverse.
    pub wrong: u64,
    /// The largest distance of a wrong pixel's centre from the exact line, in pixels.
    pub off: f64,
    /// Pixels whose depth was compared.
    pub depths: u64,
    /// The maximum of stored minus exact depth at the pixel's centre, in units in the last place of the exact depth.
    /// Positive means too near.
    pub nearer: f64,
    /// The maximum of stored depth minus the exact bound of its block of 8x4 pixels, in units in the last place of the
    /// bound. If positive, a point of the block between pixel centres may be farther than the buffer says.
    pub over: f64,
    /// The maximum of exact bound minus stored depth, in units in the last place of the bound.
    pub behind: f64,
    /// The same, relative to the bound.
    pub part: f64,
    /// Pixels stored more than one percent behind the bound.
    pub far_behind: u64,
    /// Triangles that were dropped, of which nothing was drawn.
    pub refused: u64,
    /// Pixels where neighbours leave a crack or overlap.
    pub cracks: u64,
    /// Covered pixels that the update rule has given up.
    pub forgotten: u64,
    /// Queries of something visible.
    pub asked: u64,
    /// Those of them that were answered OCCLUDED.
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
    /// Records the stored depth of a pixel that something covers.
    pub fn depth(&mut self, stored: f32, exact: f64) {
        let stored = f64::from(stored);
        // NaN would be lost in every maximum below.
        assert!(stored > 0.0 && stored.is_finite(), "{stored} is stored");
        let nearer = stored - exact;
        let nearer = if nearer.abs() <= exact * EXACT { 0.0 } else { nearer };
        self.depths += 1;
        self.nearer = self.nearer.max(nearer / ulp(exact));
    }

    /// Records how far it is behind a bound.
    pub fn bound(&mut self, stored: f32, bound: f64) {
        let stored = f64::from(stored);
        self.behind = self.behind.max((bound - stored) / ulp(bound));
        self.part = self.part.max((bound - stored) / bound);
        self.far_behind += u64::from(stored < 0.99 * bound);
    }

    /// Records a pixel with wrong coverage, `distance` pixels from the deciding line.
    pub fn wrong(&mut self, distance: f64) {
        self.wrong += 1;
        self.off = self.off.max(distance.abs());
    }

    /// Records the answer for something visible.
    pub fn shown(&mut self, answer: CullingResult) {
        self.asked += 1;
        self.hidden += u64::from(answer == CullingResult::Occluded);
    }

    /// Measures every pixel of a buffer that holds one triangle on the grid.
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

    /// Measures only the coverage of many triangles on the grid, drawn at one depth.
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

    /// Measures only the depths of many triangles on the grid. The bound is the least exact depth of a block's 32
    /// pixels, if all of them are covered. An empty pixel that something covers was given up by the update rule.
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

    /// Draws a single triangle. Returns false if it was dropped and nothing was drawn.
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

    /// Measures a buffer that holds one clipped triangle, given by its ray intersections. `farthest`: 1/w of its
    /// farthest vertex.
    pub fn clipped(&mut self, exact: &Homogeneous, farthest: f64, depth: &[f32], width: usize) {
        self.triangles += 1;
        self.pixels += depth.len() as u64;
        for (i, &stored) in depth.iter().enumerate() {
            let (column, row) = (i % width, i / width);
            let inside = exact.inside_by(column, row);
            // At a smaller distance the oracle itself is uncertain.
            if is_empty(stored) == (inside > 0.0) && inside.abs() > 1e-9 {
                self.wrong(inside);
            }
            if !is_empty(stored) {
                // A wrongly covered pixel is beyond the line, where the plane may end.
                let at = if inside > 0.0 { exact.depth(column, row) } else { exact.depth(column, row).max(farthest) };
                self.depth(stored, at);
                self.bound(stored, exact.block_depth(column, row).max(farthest));
            }
        }
    }

    /// Adds the measurements of another part of the case.
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

    /// No pixel is covered wrongly, none is too near, and nothing visible is reported hidden.
    pub fn assert_exact(&self) -> &Self {
        assert_eq!((self.wrong, self.cracks), (0, 0), "pixels covered wrongly: {self:?}");
        self.assert_safe()
    }

    /// The same for clipped triangles: a new corner is snapped, so pixels whose centres are within half a unit of the
    /// grid of the exact line may be wrong. A whole unit is allowed here, because distant corners are snapped more
    /// coarsely.
    pub fn assert_clipped(&self) -> &Self {
        assert!(self.off <= 1.0 / 256.0, "{} pixels off: {self:?}", self.off);
        assert_eq!(self.cracks, 0, "cracks: {self:?}");
        self.assert_safe()
    }

    /// No pixel is too near, nothing visible is reported hidden, and something was compared.
    pub fn assert_safe(&self) -> &Self {
        assert!(self.depths > 500, "{self:?}");
        assert!(self.nearer <= 0.0, "stored too near: {self:?}");
        assert!(self.over <= 0.0, "too near within a block of 8x4 pixels: {self:?}");
        assert_eq!(self.hidden, 0, "called hidden, but it shows: {self:?}");
        self
    }

    /// No pixel is farther behind its bound than `part` of it, and at most `share` of them by more than one percent.
    pub fn assert_behind(&self, part: f64, share: f64) -> &Self {
        assert!(self.part <= part, "{} behind: {self:?}", self.part);
        assert!(self.behind_share() <= share, "{} are behind: {self:?}", self.behind_share());
        self
    }

    /// The share of covered pixels that are more than one percent behind, or given up.
    pub fn behind_share(&self) -> f64 {
        (self.far_behind + self.forgotten) as f64 / (self.depths + self.forgotten).max(1) as f64
    }
}
