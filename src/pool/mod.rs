//! A pool of threads that draw: calls return at once, [`CullingThreadpool::flush`] waits until all of it is drawn.
//!
//! ```text
//! render ──> batches    calls, in the order of submission
//!            keep       a batch is projected and culled by one thread (see `pipeline/kept.rs`)
//!            draw       each bin, a piece of the screen, draws the batches in order, one thread at a time
//! ```
//!
//! A tile belongs to one bin, so it sees the triangles in the order of submission: the bits are those of one thread, whatever
//! the number of threads and bins. `schedule.rs` decides who does what, `crew.rs` has the threads, `processor.rs` moves one
//! that is woken on its waker's processor, `target.rs` has the bins and their locks, `grid.rs` the pieces of the screen.
//!
//! Threads without work sleep. A caller who finds no room for another batch works until there is, and so does who flushes: a
//! thread that sleeps takes tens of microseconds to wake, in which a small frame is drawn. When there is nothing for such a caller
//! to do, it looks about for 20 microseconds before it sleeps. Threads beyond the processors are not started: they would only take
//! turns with the others, and interrupt one that holds a bin.

mod crew;
mod grid;
mod processor;
mod schedule;
mod sync;
mod target;
#[cfg(test)]
mod tests;

use core::marker::PhantomData;
use core::ptr::NonNull;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};
use std::thread::{self, JoinHandle};

use crate::pipeline::Mesh;
use crate::vertices::VertexSource;
use crate::{CullingResult, DrawOptions, Error, MaskedOcclusionCulling, Vertices};
use crew::Crew;
use target::{Bins, Call, Shared, Target, Work};

/// A larger number is a mistake.
const MAX_THREADS: u32 = 1024;
/// More bins bring threads no more to do: triangles that reach several are set up for each.
const BINS_A_THREAD: u32 = 4;
/// Larger calls are cut, so that several threads can project them.
const CALL_TRIANGLES: usize = 1536;

/// Threads that draw into a [`MaskedOcclusionCulling`], with the bits that one thread would give.
///
/// Several threads may submit and query at once; calls of one thread take effect in its order.
///
/// ```
/// use masked_occlusion_culling::glam::Mat4;
/// use masked_occlusion_culling::{CullingResult, CullingThreadpool, DrawOptions, MaskedOcclusionCulling, Vertices};
///
/// let mut culling = MaskedOcclusionCulling::default();
/// culling.set_resolution(640, 360)?;
/// let pool = CullingThreadpool::new(2, 4, 4, 32)?;
/// // The pool has the object until it hands it back.
/// pool.set_buffer(culling);
/// pool.wake_threads();
///
/// // A wall 10 before the eye, which looks along -z: w is -z.
/// let wall = [[-20.0, -20.0, -10.0], [20.0, -20.0, -10.0], [20.0, 20.0, -10.0], [-20.0, 20.0, -10.0]];
/// let perspective = [1.0, 0.0, 0.0, 0.0, 0.0, 1.8, 0.0, 0.0, 0.0, 0.0, -1.0, -1.0, 0.0, 0.0, -0.2, 0.0];
/// let options = DrawOptions::with_matrix(Mat4::from_cols_array(&perspective));
/// pool.clear_buffer()?;
/// // Returns at once; all of it is drawn when the scope ends.
/// pool.scope(|scope| scope.render_triangles(Vertices::from_positions(&wall), &[0, 1, 2, 0, 2, 3], &options))?;
/// assert_eq!(pool.test_rect(-0.1, -0.1, 0.1, 0.1, 12.0)?, CullingResult::Occluded);
/// let culling = pool.take_buffer().expect("it was given");
/// # assert!(culling.resolution().is_some());
/// # Ok::<(), masked_occlusion_culling::Error>(())
/// ```
pub struct CullingThreadpool {
    crew: Arc<Crew>,
    threads: Vec<JoinHandle<()>>,
    bins: Bins,
    /// The bits of the near plane; NaN while only the object's own counts.
    near: AtomicU32,
    /// Held for reading by who submits or queries, for writing by who exchanges it.
    target: RwLock<Option<Arc<Target>>>,
    /// Held around each call while calls are recorded, so that the file has them in the order in which they are drawn.
    recording: Mutex<()>,
}

impl CullingThreadpool {
    /// A pool of `threads` threads, which sleep until [`Self::wake_threads`]; of fewer where there are fewer processors besides
    /// the caller's, but of one at least. The screen is cut into `bins_w` times `bins_h` bins, but into no more than four a
    /// thread, and none smaller than 128 by 64 pixels; rows of the screen first, for threads side by side would write to the
    /// same cache lines. At most `max_jobs` batches of calls are in flight. Without threads (0), whoever flushes does the work.
    ///
    /// # Errors
    /// [`Error::InvalidSize`] where `bins_w`, `bins_h` or `max_jobs` is 0, or `threads` above 1,024; [`Error::OutOfMemory`]
    /// where the system starts no more threads.
    pub fn new(threads: u32, bins_w: u32, bins_h: u32, max_jobs: u32) -> Result<Self, Error> {
        let processors = thread::available_parallelism().map_or(u32::MAX, |count| count.get() as u32);
        Self::with_processors(threads, bins_w, bins_h, max_jobs, processors)
    }

    /// The same where the pool and its caller have so many processors, whatever the system says.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_processors(
        threads: u32,
        bins_w: u32,
        bins_h: u32,
        max_jobs: u32,
        processors: u32,
    ) -> Result<Self, Error> {
        if bins_w == 0 || bins_h == 0 || max_jobs == 0 || threads > MAX_THREADS {
            return Err(Error::InvalidSize);
        }
        let threads = threads.min(processors.saturating_sub(1).max(1));
        let mut pool = Self {
            crew: Arc::new(Crew::new(max_jobs as usize)),
            threads: Vec::new(),
            bins: Bins { wide: bins_w, high: bins_h, most: threads.saturating_mul(BINS_A_THREAD) },
            near: AtomicU32::new(f32::NAN.to_bits()),
            target: RwLock::new(None),
            recording: Mutex::new(()),
        };
        for number in 0..threads as usize {
            let crew = pool.crew.clone();
            let start = thread::Builder::new().name(format!("culling {number}"));
            // Those that did start end with the pool.
            pool.threads.push(start.spawn(move || crew.work(number)).map_err(|_| Error::OutOfMemory)?);
        }
        Ok(pool)
    }

    /// Lets the threads work. A second time changes nothing.
    pub fn wake_threads(&self) {
        self.crew.set_suspended(false);
    }

    /// Lets the threads sleep as soon as each has finished what it is at. Calls are taken in meanwhile.
    pub fn suspend_threads(&self) {
        self.crew.set_suspended(true);
    }

    /// Waits until everything that was submitted before is drawn.
    pub fn flush(&self) {
        self.crew.flush();
    }

    /// Draws into this object from now on, which the pool owns until [`Self::take_buffer`]. One that it had is dropped, after
    /// what was submitted is drawn.
    pub fn set_buffer(&self, moc: MaskedOcclusionCulling) {
        let moc = NonNull::from(Box::leak(Box::new(moc)));
        // SAFETY: leaked just now, and freed with the target.
        unsafe { self.exchange(Some((moc, true))) };
    }

    /// Flushes, and hands the object back. Nothing where there is none that the pool owns.
    pub fn take_buffer(&self) -> Option<MaskedOcclusionCulling> {
        let mut gate = self.gate();
        if !gate.as_ref()?.is_owned() {
            return None;
        }
        self.flush();
        self.crew.set_target(None);
        Arc::into_inner(gate.take()?)?.into_owned()
    }

    /// Draws into this object from now on, or into none, after what was submitted is drawn.
    ///
    /// # Safety
    /// The object stays where it is until another one is set or the pool is dropped; meanwhile it is used through the pool only, or
    /// after a flush while nobody calls the pool.
    pub unsafe fn set_buffer_unowned(&self, moc: Option<NonNull<MaskedOcclusionCulling>>) {
        // SAFETY: the caller's contract.
        unsafe { self.exchange(moc.map(|moc| (moc, false))) }
    }

    /// # Safety
    /// As [`Target::new`].
    unsafe fn exchange(&self, moc: Option<(NonNull<MaskedOcclusionCulling>, bool)>) {
        let mut gate = self.gate();
        self.flush();
        // SAFETY: the caller's contract.
        let new = moc.map(|(moc, owned)| Arc::new(unsafe { Target::new(moc, owned, self.bins) }));
        if let Some(target) = &new {
            // NaN is refused: none was set.
            let _ = target.moc().set_near_shared(f32::from_bits(self.near.load(Relaxed)));
        }
        self.crew.set_target(new.clone());
        *gate = new;
    }

    /// Gives the object another resolution, after what was submitted is drawn, and clears it.
    ///
    /// # Errors
    /// [`Error::NoBuffer`] where the pool has no object; as [`MaskedOcclusionCulling::set_resolution`].
    pub fn set_resolution(&self, width: u32, height: u32) -> Result<(), Error> {
        let mut gate = self.gate();
        self.flush();
        let target = gate.as_ref().ok_or(Error::NoBuffer)?;
        // SAFETY: nothing is in flight, and nobody submits or queries while the gate is held.
        unsafe { &mut *target.pointer().as_ptr() }.set_resolution(width, height)?;
        self.cut_again(&mut gate);
        Ok(())
    }

    /// Makes the bins anew. Nothing is in flight.
    fn cut_again(&self, gate: &mut Option<Arc<Target>>) {
        self.crew.set_target(None);
        // Nobody else holds it: threads let go of it before they report what they did.
        if let Some(target) = gate.take().and_then(Arc::into_inner) {
            *gate = Some(Arc::new(target.resized(self.bins)));
        }
        self.crew.set_target(gate.clone());
    }

    /// Sets the near plane, in clip-space w, of the calls that follow, and of the object.
    ///
    /// # Errors
    /// [`Error::InvalidNumber`] for NaN or an infinity; the plane stays where it was.
    pub fn set_near_clip_plane(&self, near: f32) -> Result<(), Error> {
        if !near.is_finite() {
            return Err(Error::InvalidNumber);
        }
        self.near.store(near.to_bits(), Relaxed);
        match &*self.pass() {
            Some(target) => {
                let _recording = self.recording(target);
                target.moc().set_near_shared(near)
            }
            None => Ok(()),
        }
    }

    /// Clears the object, in order with the calls around it. What was drawn before hides nothing from now on.
    ///
    /// # Errors
    /// [`Error::NoBuffer`].
    pub fn clear_buffer(&self) -> Result<(), Error> {
        self.with_buffer(|target| {
            let _recording = self.recording(target);
            self.crew.submit_ready(|| Work::Clear(target.count_clear()));
            target.moc().recorder().clear_buffer();
            Ok(())
        })
    }

    /// Draws inside of `calls` what lives at least as long as that takes, and flushes at its end.
    ///
    /// # Panics
    /// If `calls` does.
    pub fn scope<'e, R>(&'e self, calls: impl FnOnce(&Scope<'e>) -> R) -> R {
        let scope = Scope { pool: self, lives: PhantomData };
        calls(&scope)
    }

    /// Draws occluders, in order with the calls around it; see [`MaskedOcclusionCulling::render_triangles`]. Returns at once, or
    /// works when there is no room.
    ///
    /// # Safety
    /// The vertices and the indices stay as they are until the pool was flushed.
    ///
    /// # Errors
    /// As there.
    pub unsafe fn render_triangles(
        &self,
        vertices: Vertices<'_>,
        triangles: &[u32],
        options: &DrawOptions,
    ) -> Result<(), Error> {
        self.with_object(|moc| moc.check_mesh(&vertices, triangles))?;
        // SAFETY: `check_mesh` saw that every index names a vertex; the rest is the caller's contract.
        unsafe { self.render_triangles_unchecked(vertices.source(), triangles, options) }
    }

    /// # Safety
    /// Every vertex from the lowest to the highest index in `triangles` can be read through `vertices`, and they and the indices
    /// stay as they are until the pool was flushed.
    pub(crate) unsafe fn render_triangles_unchecked(
        &self,
        vertices: VertexSource,
        triangles: &[u32],
        options: &DrawOptions,
    ) -> Result<(), Error> {
        self.with_buffer(|target| {
            let _recording = self.recording(target);
            let near = target.moc().near_clip_plane();
            for piece in triangles.chunks(3 * CALL_TRIANGLES) {
                let (triangles, indices) = (piece.as_ptr(), piece.len());
                self.crew.submit(Call { vertices, triangles, indices, options: *options, near, clears: 0 });
            }
            // SAFETY: the caller's contract: every vertex from the lowest to the highest index can be read.
            unsafe { target.moc().recorder().render_triangles(None, &Mesh { vertices, triangles, options }) };
            Ok(())
        })
    }

    /// Folds other buffers into the pool's, in order with the calls around it, each bin by a thread; see
    /// [`MaskedOcclusionCulling::merge_buffers`].
    ///
    /// # Safety
    /// The others stay where they are, and nobody changes them, until the pool was flushed.
    ///
    /// # Errors
    /// As there.
    pub unsafe fn merge_buffers(&self, others: &[&MaskedOcclusionCulling]) -> Result<(), Error> {
        self.with_buffer(|target| {
            target.moc().mergeable(others)?;
            let others = others.iter().map(|&other| NonNull::from(other));
            // With itself changes nothing.
            let others = others.filter(|&other| other != target.pointer()).map(Shared).collect();
            self.crew.submit_ready(|| Work::Merge(others));
            Ok(())
        })
    }

    /// Tests a rectangle against what is drawn by now; see [`MaskedOcclusionCulling::test_rect`].
    ///
    /// # Errors
    /// [`Error::NoBuffer`].
    pub fn test_rect(
        &self,
        x_min: f32,
        y_min: f32,
        x_max: f32,
        y_max: f32,
        w_min: f32,
    ) -> Result<CullingResult, Error> {
        self.with_buffer(|target| {
            let edges = [x_min, y_min, x_max, y_max];
            let tiles = target.moc().rectangle_tiles(edges)?;
            let recording = self.recording(target);
            // Before: what is asked while something is drawn may be answered otherwise later, and no answer can be held to it.
            let settled = recording.is_some() && self.crew.is_done();
            let result = target.query(tiles, |moc| moc.ask_rect(edges, w_min))?;
            target.moc().recorder().test_rect(settled.then_some(result), edges, w_min);
            Ok(result)
        })
    }

    /// Tests occludees against what is drawn by now; see [`MaskedOcclusionCulling::test_triangles`]. `Visible` where they are
    /// hidden only by what a clear that was submitted will take away, also if they pass by every pixel.
    ///
    /// # Errors
    /// As there.
    pub fn test_triangles(
        &self,
        vertices: Vertices<'_>,
        triangles: &[u32],
        options: &DrawOptions,
    ) -> Result<CullingResult, Error> {
        self.with_object(|moc| moc.check_mesh(&vertices, triangles))?;
        // SAFETY: `check_mesh` saw that every index names a vertex of the slice.
        unsafe { self.test_triangles_unchecked(vertices.source(), triangles, options) }
    }

    /// As [`Self::test_triangles`].
    ///
    /// # Safety
    /// Every vertex from the lowest to the highest index in `triangles` can be read through `vertices`.
    pub(crate) unsafe fn test_triangles_unchecked(
        &self,
        vertices: VertexSource,
        triangles: &[u32],
        options: &DrawOptions,
    ) -> Result<CullingResult, Error> {
        let mesh = Mesh { vertices, triangles, options };
        self.with_buffer(|target| {
            let recording = self.recording(target);
            // As in `test_rect`.
            let settled = recording.is_some() && self.crew.is_done();
            // SAFETY: the caller's contract: every vertex from the lowest to the highest index can be read.
            let result = target.query(target.all_tiles(), |moc| unsafe { moc.ask_triangles(&mesh) })?;
            // SAFETY: as above.
            unsafe { target.moc().recorder().test_triangles(settled.then_some(result), &mesh) };
            Ok(result)
        })
    }

    /// While calls are recorded: the right to be the next.
    fn recording(&self, target: &Target) -> Option<MutexGuard<'_, ()>> {
        // Whoever has it may work meanwhile, for which it is not needed.
        target.moc().recorder().is_on().then(|| self.recording.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Looks at the object itself, which has a buffer.
    pub(crate) fn with_object<R>(
        &self,
        look: impl FnOnce(&MaskedOcclusionCulling) -> Result<R, Error>,
    ) -> Result<R, Error> {
        self.with_buffer(|target| look(target.moc()))
    }

    /// Flushes, and writes the depth of every pixel; see [`MaskedOcclusionCulling::compute_pixel_depth_buffer`].
    ///
    /// # Errors
    /// As there.
    pub fn compute_pixel_depth_buffer(&self, depth: &mut [f32], flip_y: bool) -> Result<(), Error> {
        self.with_pixels(|_| Ok(depth), flip_y)
    }

    /// The same into an array that is found when its length is known.
    pub(crate) fn with_pixels<'a>(
        &self,
        array: impl FnOnce(usize) -> Result<&'a mut [f32], Error>,
        flip_y: bool,
    ) -> Result<(), Error> {
        self.flush();
        let write = |moc: &MaskedOcclusionCulling| {
            let (width, height) = moc.resolution().ok_or(Error::NoBuffer)?;
            moc.compute_pixel_depth_buffer(array(width as usize * height as usize)?, flip_y)?;
            Ok(CullingResult::Visible)
        };
        self.with_buffer(|target| target.query(target.all_tiles(), write)).map(|_| ())
    }

    /// What the object counted, after a flush; see [`MaskedOcclusionCulling::statistics`].
    ///
    /// # Errors
    /// [`Error::NoBuffer`].
    pub fn statistics(&self) -> Result<crate::Statistics, Error> {
        self.flush();
        Ok(self.pass().as_ref().ok_or(Error::NoBuffer)?.moc().statistics())
    }

    /// The target, whose bins fit its object: after a flush its owner may have given it another resolution.
    fn pass(&self) -> RwLockReadGuard<'_, Option<Arc<Target>>> {
        loop {
            let pass = self.target.read().unwrap_or_else(PoisonError::into_inner);
            if !pass.as_ref().is_some_and(|target| target.is_outdated()) {
                return pass;
            }
            drop(pass);
            let mut gate = self.gate();
            self.flush();
            self.cut_again(&mut gate);
        }
    }

    /// The target, if it has a buffer.
    fn with_buffer<R>(&self, call: impl FnOnce(&Target) -> Result<R, Error>) -> Result<R, Error> {
        let pass = self.pass();
        let target = pass.as_ref().ok_or(Error::NoBuffer)?;
        target.moc().buffer()?;
        call(target)
    }

    fn gate(&self) -> RwLockWriteGuard<'_, Option<Arc<Target>>> {
        self.target.write().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for CullingThreadpool {
    /// Draws what was submitted and ends the threads.
    fn drop(&mut self) {
        self.flush();
        self.crew.stop();
        for thread in self.threads.drain(..) {
            // What a thread says when it ends in a panic, it has said already.
            let _ = thread.join();
        }
    }
}

/// Calls of a [`CullingThreadpool::scope`].
pub struct Scope<'e> {
    pool: &'e CullingThreadpool,
    /// Invariant, so that what is lent cannot be made to live shorter.
    lives: PhantomData<core::cell::Cell<&'e ()>>,
}

impl<'e> Scope<'e> {
    /// As [`CullingThreadpool::render_triangles`].
    ///
    /// # Errors
    /// As there.
    pub fn render_triangles(
        &self,
        vertices: Vertices<'e>,
        triangles: &'e [u32],
        options: &DrawOptions,
    ) -> Result<(), Error> {
        // SAFETY: they are lent for longer than the scope, which flushes when it ends.
        unsafe { self.pool.render_triangles(vertices, triangles, options) }
    }

    /// As [`CullingThreadpool::merge_buffers`].
    ///
    /// # Errors
    /// As there.
    pub fn merge_buffers(&self, others: &[&'e MaskedOcclusionCulling]) -> Result<(), Error> {
        // SAFETY: as above; what the pool owns cannot be lent.
        unsafe { self.pool.merge_buffers(others) }
    }
}

impl Drop for Scope<'_> {
    fn drop(&mut self) {
        self.pool.flush();
    }
}
