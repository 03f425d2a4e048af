//! The central object: its settings and buffer, and its calls, each of which checks its arguments and forwards them to
//! the kernel.

mod query;
#[cfg(feature = "recorder")]
mod recording;
#[cfg(feature = "recorder")]
mod replay;

use core::fmt;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use crate::attachment::Attachment;
use crate::bins::TriList;
use crate::buffer::{Buffer, MAX_SIZE, Region};
use crate::geometry::Camera;
use crate::kernel;
use crate::recorder::Recorder;
use crate::simd::Level;
use crate::sink::{BinBounds, BinnedTriangles};
use crate::source::Mesh;
use crate::statistics::Counters;
use crate::{
    Allocator, ClipPlanes, CullingResult, DrawOptions, Error, Implementation, ScissorRect, Settings, Statistics,
    UpdateRule, Vertices, YAxis,
};

const NO_BUFFER: &str = "no buffer: callers must check `has_buffer` first";

/// A masked hierarchical depth buffer to draw occluders into and to test occludees against.
///
/// Clip space is (x, y, w) with x to the right, y up and w away from the eye. Depth is 1/w: 0 is infinitely far, larger
/// is nearer. An object may be sent between threads, and shared by threads that only query it.
///
/// ```
/// use masked_occlusion_culling::{CullingResult, DrawOptions, MaskedOcclusionCulling, Settings, Vertices};
///
/// let mut culling = MaskedOcclusionCulling::new(640, 360, Settings::default())?;
/// let wall = [[-10.0, -10.0, 0.0, 10.0], [30.0, -10.0, 0.0, 10.0], [-10.0, 30.0, 0.0, 10.0]];
/// culling.clear_buffer();
/// culling.render_triangles(Vertices::clip_space(&wall), &[0, 1, 2], &DrawOptions::default())?;
/// assert_eq!(culling.test_rect(-0.5, -0.5, 0.0, 0.0, 12.0), CullingResult::Occluded);
/// # Ok::<(), masked_occlusion_culling::Error>(())
/// ```
pub struct MaskedOcclusionCulling {
    /// The first field, so that it is dropped first: dropping it draws whatever a pool still has in flight.
    attachment: Attachment,
    level: Level,
    update_rule: UpdateRule,
    y_axis: YAxis,
    allocator: Allocator,
    statistics: bool,
    /// The bits of the near plane; atomic, so that a pool can set it.
    near: AtomicU32,
    buffer: Option<Buffer>,
    counters: Counters,
    recorder: Recorder,
}

impl fmt::Debug for MaskedOcclusionCulling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MaskedOcclusionCulling")
            .field("implementation", &self.implementation())
            .field("update_rule", &self.update_rule)
            .field("y_axis", &self.y_axis)
            .field("resolution", &self.size())
            .field("near_clip_plane", &self.near_clip_plane())
            .finish_non_exhaustive()
    }
}

impl MaskedOcclusionCulling {
    /// Makes an object with a clear buffer of `width` by `height` pixels, each from 1 to 16,384, using the best
    /// instruction set that the processor has and `settings` allow.
    ///
    /// # Errors
    /// [`Error::InvalidSize`], [`Error::OutOfMemory`], [`Error::UnavailableRule`].
    pub fn new(width: u32, height: u32, settings: Settings) -> Result<Self, Error> {
        let mut moc = Self::without_buffer(settings)?;
        moc.set_resolution(width, height)?;
        Ok(moc)
    }

    /// An object of the C interface, which gets its buffer later. Until then only calls that need no buffer may be
    /// made: `capi` checks [`Self::has_buffer`] before all others.
    pub(crate) fn without_buffer(settings: Settings) -> Result<Self, Error> {
        if !UpdateRule::available().contains(&settings.update_rule) {
            return Err(Error::UnavailableRule);
        }
        Ok(Self {
            attachment: Attachment::default(),
            level: Level::capped(settings.implementation),
            update_rule: settings.update_rule,
            y_axis: settings.y_axis,
            allocator: settings.allocator,
            statistics: settings.statistics,
            near: AtomicU32::new(0),
            buffer: None,
            counters: Counters::default(),
            recorder: Recorder::default(),
        })
    }

    /// The instruction set in use.
    pub fn implementation(&self) -> Implementation {
        self.level.implementation()
    }

    /// The update rule in use.
    pub fn update_rule(&self) -> UpdateRule {
        self.update_rule
    }

    /// The direction in which rows are counted.
    pub fn y_axis(&self) -> YAxis {
        self.y_axis
    }

    /// The allocator given at creation.
    pub fn allocator(&self) -> Allocator {
        self.allocator
    }

    /// Gives the object a clear buffer of `width` by `height` pixels, each from 1 to 16,384. If the size is unchanged,
    /// this only clears the buffer.
    ///
    /// In a buffer smaller than the screen, a gap between occluders that is narrower than a buffer pixel can disappear,
    /// and what is seen through it on the screen is then culled; `docs/guide.md` says how to handle this.
    ///
    /// # Errors
    /// [`Error::InvalidSize`], [`Error::OutOfMemory`]: the object keeps its previous buffer.
    pub fn set_resolution(&mut self, width: u32, height: u32) -> Result<(), Error> {
        if !(1..=MAX_SIZE).contains(&width) || !(1..=MAX_SIZE).contains(&height) {
            return Err(Error::InvalidSize);
        }
        if self.size() != Some((width, height)) {
            self.buffer = Some(Buffer::new(width, height, self.update_rule, self.allocator, self.statistics)?);
            self.recorder.changed(self.near_clip_plane(), self.size());
        }
        self.clear_buffer();
        Ok(())
    }

    /// Width and height in pixels.
    pub fn resolution(&self) -> (u32, u32) {
        let buffer = self.buffer();
        (buffer.width(), buffer.height())
    }

    /// The same; `None` without a buffer.
    fn size(&self) -> Option<(u32, u32)> {
        self.buffer.as_ref().map(|b| (b.width(), b.height()))
    }

    /// The size in pixels of each of `bins_w` by `bins_h` bins: the buffer's width divided by `bins_w`, rounded down to
    /// a multiple of 32, and its height divided by `bins_h`, rounded down to a multiple of 8. The last column and row
    /// of bins extend to the buffer's edge.
    ///
    /// # Errors
    /// [`Error::InvalidSize`] for zero bins, or bins smaller than a tile.
    pub fn compute_bin_size(&self, bins_w: u32, bins_h: u32) -> Result<(u32, u32), Error> {
        self.buffer().bin_size(bins_w, bins_h)
    }

    /// Sets the near plane, in clip-space w. Anything nearer is clipped. The default is 0.
    ///
    /// # Errors
    /// [`Error::InvalidNumber`] for NaN or infinity: the near plane is unchanged.
    pub fn set_near_clip_plane(&mut self, near: f32) -> Result<(), Error> {
        self.set_near_shared(near)
    }

    /// The same while other threads query; their queries use either value.
    pub(crate) fn set_near_shared(&self, near: f32) -> Result<(), Error> {
        if !near.is_finite() {
            return Err(Error::InvalidNumber);
        }
        if self.near.swap(near.to_bits(), Relaxed) != near.to_bits() {
            self.recorder.changed(near, self.size());
        }
        Ok(())
    }

    /// The near plane, in clip-space w.
    pub fn near_clip_plane(&self) -> f32 {
        f32::from_bits(self.near.load(Relaxed))
    }

    /// Clears every pixel to infinitely far.
    pub fn clear_buffer(&mut self) {
        self.buffer.as_mut().expect(NO_BUFFER).clear();
        self.recorder.clear_buffer();
    }

    /// Merges `other` into this buffer: afterwards this one hides what either hid, except for what its few depths cannot
    /// represent, and never more. The two may differ in instruction set and update rule.
    ///
    /// # Errors
    /// [`Error::SizeMismatch`]: nothing is changed.
    pub fn merge_buffer(&mut self, other: &Self) -> Result<(), Error> {
        self.merge_buffers(&[other])
    }

    /// Merges several buffers into this one, with the same result as merging them one by one in that order.
    ///
    /// # Errors
    /// As [`Self::merge_buffer`]: if one does not match, none is merged.
    pub fn merge_buffers(&mut self, others: &[&Self]) -> Result<(), Error> {
        let theirs = self.mergeable(others)?;
        let level = self.level;
        // SAFETY: nobody draws into the others, which are borrowed.
        unsafe { crate::buffer::merge::merge(level, self.region(), &theirs) };
        Ok(())
    }

    /// The buffers of other objects, if they can be merged into this one.
    pub(crate) fn mergeable<'o>(&self, others: &[&'o Self]) -> Result<Vec<&'o Buffer>, Error> {
        let mine = self.buffer();
        let fitting = |other: &&'o Self| {
            let theirs = other.buffer();
            if (mine.width(), mine.height(), self.y_axis) != (theirs.width(), theirs.height(), other.y_axis) {
                return Err(Error::SizeMismatch);
            }
            Ok(theirs)
        };
        others.iter().map(fitting).collect()
    }

    /// Draws occluders, given as three indices per triangle.
    ///
    /// Returns `ViewCulled` if every triangle is outside the view or faces away, else `Visible`. Triangles with a NaN
    /// or infinite coordinate are dropped and counted, which is safe: it only removes an occluder.
    ///
    /// # Errors
    /// [`Error::InvalidSize`] if the length of `triangles` is not a multiple of three; [`Error::IndexOutOfRange`].
    /// Nothing is drawn.
    pub fn render_triangles(
        &mut self,
        vertices: Vertices<'_>,
        triangles: &[u32],
        options: &DrawOptions,
    ) -> Result<CullingResult, Error> {
        let mesh = self.mesh(&vertices, triangles, options)?;
        Ok(self.render_mesh(&mesh))
    }

    pub(crate) fn render_mesh(&mut self, mesh: &Mesh<'_>) -> CullingResult {
        let result = if mesh.triangles().is_empty() {
            CullingResult::ViewCulled
        } else {
            let (level, camera) = (self.level, self.camera(mesh.options()));
            let (result, tally) = kernel::draw(level, self.region(), &camera, mesh);
            self.counters.add_draw_alone(self.statistics, &tally);
            result
        };
        self.recorder.render_triangles(Some(result), mesh);
        result
    }

    /// Projects triangles and appends each one that may be drawn to the list of every bin that it reaches; `lists` are
    /// `bins_w * bins_h` bins, row by row.
    ///
    /// # Errors
    /// As [`Self::render_triangles`], and [`Error::InvalidSize`] for a bin count that [`Self::compute_bin_size`]
    /// rejects or that is not the length of `lists`: nothing is binned. [`Error::ListFull`]: a list had no room; the
    /// triangles that fit are in the lists.
    pub fn bin_triangles(
        &self,
        vertices: Vertices<'_>,
        triangles: &[u32],
        lists: &mut [TriList<'_>],
        bins_w: u32,
        bins_h: u32,
        options: &DrawOptions,
    ) -> Result<CullingResult, Error> {
        let mesh = self.mesh(&vertices, triangles, options)?;
        self.bin_mesh(&mesh, lists, bins_w, bins_h)
    }

    pub(crate) fn bin_mesh(
        &self,
        mesh: &Mesh<'_>,
        lists: &mut [TriList<'_>],
        bins_w: u32,
        bins_h: u32,
    ) -> Result<CullingResult, Error> {
        let buffer = self.buffer();
        let bin_size = buffer.bin_size(bins_w, bins_h)?;
        if lists.len() as u64 != u64::from(bins_w) * u64::from(bins_h) {
            return Err(Error::InvalidSize);
        }
        let camera = self.camera(mesh.options());
        let (result, tally, full) =
            kernel::bin_to_lists(self.level, buffer, &camera, mesh, lists, bin_size, (bins_w, bins_h));
        self.counters.add_draw(self.statistics, &tally);
        if full { Err(Error::ListFull) } else { Ok(result) }
    }

    /// Draws a list within `scissor`, or everywhere.
    ///
    /// # Errors
    /// [`Error::InvalidSize`] for a rectangle whose edges are not multiples of 32 and 8 (and not at the buffer's edge),
    /// or that extends beyond the buffer's last tile.
    pub fn render_trilist(&mut self, list: &TriList<'_>, scissor: Option<ScissorRect>) -> Result<(), Error> {
        // SAFETY: `&mut self` excludes every other user of the buffer.
        unsafe { self.render_trilist_shared(list, scissor) }
    }

    /// As [`Self::render_trilist`], for several threads at once.
    ///
    /// # Errors
    /// As [`Self::render_trilist`].
    ///
    /// # Safety
    /// While it runs, no other thread draws into an overlapping rectangle, and none queries, merges, clears or reads
    /// the buffer.
    pub unsafe fn render_trilist_shared(&self, list: &TriList<'_>, scissor: Option<ScissorRect>) -> Result<(), Error> {
        let buffer = self.buffer();
        let scissor = buffer.scissor_tiles(scissor)?;
        // SAFETY: the caller's contract: nobody else uses the rectangle. The coarse level is left unchanged.
        let region = unsafe { Region::new(buffer, scissor, None) };
        let tally = kernel::draw_list(self.level, region, list);
        self.counters.add_draw(self.statistics, &tally);
        Ok(())
    }

    /// Projects a mesh with this near plane and bins its potentially drawn triangles; see [`kernel::bin`].
    pub(crate) fn bin(
        &self,
        mesh: &Mesh<'_>,
        near: f32,
        (bounds, prefilter): (&BinBounds, bool),
        binned: &mut BinnedTriangles,
    ) {
        let camera = self.camera_at(mesh.options(), near);
        // Statistics count hidden triangles too.
        let prefilter = prefilter && !self.statistics;
        let tally = kernel::bin(self.level, self.buffer(), &camera, mesh, (bounds, prefilter), binned);
        self.counters.add_draw(self.statistics, &tally);
    }

    /// Draws binned triangles into a region of this object's buffer; see [`kernel::draw_binned`].
    pub(crate) fn draw_binned<'a>(
        &self,
        region: Region<'_>,
        triangles: impl Iterator<Item = &'a BinnedTriangles>,
        bin: usize,
    ) {
        let tally = kernel::draw_binned(self.level, region, triangles, bin);
        self.counters.add_draw(self.statistics, &tally);
    }

    pub(crate) fn level(&self) -> Level {
        self.level
    }

    /// Writes the depth of every pixel to `depth`, width by height, row by row; negative where nothing has been drawn.
    /// `flip_y` writes the last row first.
    ///
    /// # Errors
    /// [`Error::InvalidSize`] if `depth` is shorter than the buffer.
    pub fn compute_pixel_depth_buffer(&self, depth: &mut [f32], flip_y: bool) -> Result<(), Error> {
        let buffer = self.buffer();
        let pixels = buffer.width() as usize * buffer.height() as usize;
        let depth = depth.get_mut(..pixels).ok_or(Error::InvalidSize)?;
        crate::buffer::pixels::write(buffer, depth, flip_y);
        Ok(())
    }

    /// All counts since the object was made; without [`Settings::statistics`] only that of dropped triangles.
    pub fn statistics(&self) -> Statistics {
        self.counters.snapshot()
    }

    /// Waits until the pool that draws into the object, if any, has drawn everything submitted: for C, where the
    /// program owns the objects that pools draw into.
    pub(crate) fn flush(&self) {
        if let Some(pool) = self.attachment.pool() {
            pool.flush();
        }
    }

    pub(crate) fn attachment(&self) -> &Attachment {
        &self.attachment
    }

    pub(crate) fn recorder(&self) -> &Recorder {
        &self.recorder
    }

    /// Only an object of the C interface can lack one.
    pub(crate) fn has_buffer(&self) -> bool {
        self.buffer.is_some()
    }

    /// # Panics
    /// Without a buffer.
    #[inline(always)]
    pub(crate) fn buffer(&self) -> &Buffer {
        self.buffer.as_ref().expect(NO_BUFFER)
    }

    /// The whole buffer, for drawing.
    fn region(&mut self) -> Region<'_> {
        Region::whole(self.buffer.as_mut().expect(NO_BUFFER))
    }

    fn camera(&self, options: &DrawOptions) -> Camera {
        self.camera_at(options, self.near_clip_plane())
    }

    fn camera_at(&self, options: &DrawOptions, near: f32) -> Camera {
        let near = if options.clip_planes.contains(ClipPlanes::NEAR) { near } else { 0.0 };
        let buffer = self.buffer();
        Camera::new(buffer.width(), buffer.height(), self.y_axis, near)
    }

    /// A mesh with checked indices.
    pub(crate) fn mesh<'a>(
        &self,
        vertices: &'a Vertices<'_>,
        triangles: &'a [u32],
        options: &'a DrawOptions,
    ) -> Result<Mesh<'a>, Error> {
        if !triangles.len().is_multiple_of(3) {
            return Err(Error::InvalidSize);
        }
        self.check_indices(triangles, vertices.len())?;
        // SAFETY: every index refers to a vertex of the slice.
        Ok(unsafe { Mesh::new(vertices.source(), vertices.matrix(), triangles, options) })
    }

    /// Is every index below `count`?
    pub(crate) fn check_indices(&self, triangles: &[u32], count: usize) -> Result<(), Error> {
        match kernel::max_index(self.level, triangles) {
            Some(max) if max as usize >= count => Err(Error::IndexOutOfRange),
            _ => Ok(()),
        }
    }
}
