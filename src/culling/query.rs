//! Queries of an object: triangles and rectangles, directly or through the pool that draws into it.

use crate::bounds::rectangle;
use crate::buffer::TileRect;
use crate::kernel;
use crate::source::Mesh;
use crate::statistics::Tally;
use crate::{CullingResult, DrawOptions, Error, MaskedOcclusionCulling, Vertices};

impl MaskedOcclusionCulling {
    /// Tests occludees: would any part of these triangles, if drawn now, be as near as what was drawn there, or nearer?
    ///
    /// Every pixel that a triangle touches counts, not only those whose centre it covers. The answer is also `Visible`
    /// for triangles with a NaN or infinite coordinate and for those that come closer to the eye than can be projected.
    /// If no front-facing triangle touches a pixel, it is `ViewCulled`, or `Occluded` if everything around the
    /// triangles is hidden.
    ///
    /// The answer is for the triangles, not for the volume that they enclose: treat a box that crosses the near plane
    /// or contains the eye as visible.
    ///
    /// # Errors
    /// [`Error::InvalidSize`], [`Error::IndexOutOfRange`], as [`Self::render_triangles`].
    pub fn test_triangles(
        &self,
        vertices: Vertices<'_>,
        triangles: &[u32],
        options: &DrawOptions,
    ) -> Result<CullingResult, Error> {
        let mesh = self.mesh(&vertices, triangles, options)?;
        Ok(self.test_mesh(&mesh))
    }

    pub(crate) fn test_mesh(&self, mesh: &Mesh<'_>) -> CullingResult {
        if !self.recorder.is_on()
            && let Some((result, tally)) = self.attachment.undisturbed(|| self.look_at_triangles(mesh))
        {
            self.counters.add_query(self.statistics, 0, &tally);
            return result;
        }
        self.noted_triangles(mesh)
    }

    /// Goes through the pool that draws into the object, if there is one, and is recorded in the order in which the
    /// pool draws.
    #[cold]
    fn noted_triangles(&self, mesh: &Mesh<'_>) -> CullingResult {
        // As in `noted_rect`.
        while let Some(pool) = self.attachment.pool() {
            if let Some(result) = pool.test_mesh(&self.attachment, mesh) {
                return result;
            }
        }
        let result = self.ask_triangles(mesh);
        self.recorder.test_triangles(Some(result), mesh);
        result
    }

    /// The same without recording.
    pub(crate) fn ask_triangles(&self, mesh: &Mesh<'_>) -> CullingResult {
        let (result, tally) = self.look_at_triangles(mesh);
        self.counters.add_query(self.statistics, 0, &tally);
        result
    }

    /// The same without counting; also returns the tally.
    fn look_at_triangles(&self, mesh: &Mesh<'_>) -> (CullingResult, Tally) {
        kernel::test(self.level, self.buffer(), &self.camera(mesh.options()), mesh)
    }

    /// Tests a rectangle in normalised device coordinates (x right, y up, the screen is [-1, 1]) whose nearest point is
    /// at `w_min`. Every pixel that it touches counts.
    ///
    /// Returns `ViewCulled` if it is off screen; `Visible` if a coordinate is NaN, `w_min` is not positive, or the
    /// rectangle is empty.
    #[inline(always)]
    pub fn test_rect(&self, x_min: f32, y_min: f32, x_max: f32, y_max: f32, w_min: f32) -> CullingResult {
        // First, so that without a recording nothing else has to be paid for; a small rectangle is very cheap.
        if self.recorder.is_on() {
            return self.noted_rect((x_min, y_min), (x_max, y_max), w_min);
        }
        match self.attachment.undisturbed(|| self.look_at_rect([x_min, y_min, x_max, y_max], w_min)) {
            Some(found) => self.count_rect(found),
            None => self.noted_rect((x_min, y_min), (x_max, y_max), w_min),
        }
    }

    /// Goes through the pool that draws into the object, if there is one, and is recorded in the order in which the
    /// pool draws. In pairs, which are passed in registers; see [`rectangle::test`].
    #[cold]
    fn noted_rect(&self, min: (f32, f32), max: (f32, f32), w_min: f32) -> CullingResult {
        let edges = [min.0, min.1, max.0, max.1];
        // The pool may be given another object meanwhile.
        while let Some(pool) = self.attachment.pool() {
            if let Some(result) = pool.test_rect(&self.attachment, edges, w_min) {
                return result;
            }
        }
        let result = self.ask_rect(edges, w_min);
        self.recorder.test_rect(Some(result), edges, w_min);
        result
    }

    /// The same without recording.
    #[inline(always)]
    pub(crate) fn ask_rect(&self, edges: [f32; 4], w_min: f32) -> CullingResult {
        self.count_rect(self.look_at_rect(edges, w_min))
    }

    /// The same without counting; also returns the tally.
    #[inline(always)]
    fn look_at_rect(&self, edges: [f32; 4], w_min: f32) -> (CullingResult, u64) {
        rectangle::test(self.level, self.buffer(), self.y_axis, edges, w_min)
    }

    #[inline(always)]
    fn count_rect(&self, (result, traversed): (CullingResult, u64)) -> CullingResult {
        self.counters.add_query(self.statistics, 1, &Tally { traversed, ..Tally::default() });
        result
    }

    /// The tiles that a rectangle touches; at least one.
    pub(crate) fn rectangle_tiles(&self, [x_min, y_min, x_max, y_max]: [f32; 4]) -> TileRect {
        rectangle::tiles(self.buffer(), self.y_axis, [x_min, y_min, x_max, y_max])
    }
}
