//! A pool of drawing threads: calls return at once, and [`CullingThreadpool::flush`] waits until everything is drawn.
//!
//! ```text
//! render ──> batches    calls, in the order of submission
//!            bin        one thread projects and culls a batch (see `sink/bin.rs`)
//!            draw       each bin, a rectangle of the screen, draws the batches in order, one thread at a time
//! ```
//!
//! A tile belongs to exactly one bin, so it receives the triangles in the order of submission: the bits are those of
//! one thread, whatever the number of threads and bins. `schedule.rs` assigns the work, `workers.rs` has the threads,
//! `processor.rs` moves a thread that was woken on its waker's processor, `gate.rs` guards access to the object,
//! `target.rs` has the bins and their locks, and `grid.rs` their rectangles on the screen.
//!
//! A call's arrays are only read to bin it. When a call returns, at most `max_jobs` calls are not yet binned, so a
//! program may rotate among `max_jobs` + 1 arrays without a flush. Only queries can tell whether binned calls have been
//! drawn yet.
//!
//! Threads without work sleep. A caller that finds no room for another batch works until there is, and so does a
//! flushing thread, because waking a sleeping thread may take longer than drawing a small frame. If there is nothing
//! for such a caller to do, it spins briefly before it sleeps, as worker threads do. No more threads are started than
//! there are processors: they would only compete with the others and could preempt one that holds a bin.

mod gate;
mod grid;
mod processor;
mod schedule;
mod settings;
mod sync;
mod target;
#[cfg(test)]
mod tests;
mod workers;

use core::fmt;
use core::marker::PhantomData;
use core::ptr::NonNull;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::thread::{self, JoinHandle};

use crate::attachment::Taken;
use crate::float_environment::in_default_environment;
use crate::source::Mesh;
use crate::vertices::VertexSource;
use crate::{CullingResult, DrawOptions, Error, MaskedOcclusionCulling, VertexLayout, Vertices};
use gate::Gate;
pub use settings::{ThreadStart, ThreadpoolSettings};
use target::{Bins, Call, Shared, Work};
use workers::Workers;

/// Larger numbers are assumed to be mistakes.
const MAX_THREADS: u32 = 1024;
/// More bins do not give threads more to do: triangles that reach several bins are set up once for each.
const BINS_PER_THREAD: u32 = 4;
/// Larger calls are split, so that several threads can project them.
const CALL_TRIANGLES: usize = 1536;

/// Draws into a [`MaskedOcclusionCulling`] with several threads, and gives the same bits as one thread.
///
/// Several threads may submit and query at once; the calls of one thread take effect in order.
///
/// ```
/// use masked_occlusion_culling::{
///     CullingResult, CullingThreadpool, DrawOptions, MaskedOcclusionCulling, Settings, ThreadpoolSettings, Vertices,
/// };
///
/// let culling = MaskedOcclusionCulling::new(640, 360, Settings::default())?;
/// let pool = CullingThreadpool::new(ThreadpoolSettings::default().with_threads(2))?;
/// // The pool owns the object until it returns it.
/// pool.set_buffer(culling);
/// pool.wake_threads();
///
/// // A wall 10 in front of the eye, which looks along -z: w is -z.
/// let wall = [[-20.0, -20.0, -10.0], [20.0, -20.0, -10.0], [20.0, 20.0, -10.0], [-20.0, 20.0, -10.0]];
/// let perspective = [1.0, 0.0, 0.0, 0.0, 0.0, 1.8, 0.0, 0.0, 0.0, 0.0, -1.0, -1.0, 0.0, 0.0, -0.2, 0.0];
/// let wall = Vertices::model_space(&wall, perspective);
/// pool.clear_buffer()?;
/// // Returns at once; everything is drawn when the scope ends.
/// pool.scope(|scope| scope.render_triangles(wall, &[0, 1, 2, 0, 2, 3], &DrawOptions::default()))?;
/// assert_eq!(pool.test_rect(-0.1, -0.1, 0.1, 0.1, 12.0)?, CullingResult::Occluded);
/// let culling = pool.take_buffer().expect("it was given");
/// # assert_eq!(culling.resolution(), (640, 360));
/// # Ok::<(), masked_occlusion_culling::Error>(())
/// ```
pub struct CullingThreadpool {
    gate: Arc<Gate>,
    threads: Vec<JoinHandle<()>>,
}

impl CullingThreadpool {
    /// Makes a pool whose threads sleep until [`Self::wake_threads`].
    ///
    /// # Errors
    /// [`Error::InvalidSize`] if `bins_w`, `bins_h` or `max_jobs` is 0, or `threads` is above 1,024;
    /// [`Error::OutOfMemory`] if the system cannot start a thread.
    pub fn new(settings: ThreadpoolSettings) -> Result<Self, Error> {
        let ThreadpoolSettings { bins_w, bins_h, max_jobs, .. } = settings;
        if bins_w == 0 || bins_h == 0 || max_jobs == 0 || settings.threads > MAX_THREADS {
            return Err(Error::InvalidSize);
        }
        let processors = match settings.processors {
            0 => thread::available_parallelism().map_or(u32::MAX, |count| count.get() as u32),
            processors => processors,
        };
        let threads = settings.threads.min(processors.saturating_sub(1).max(1));
        let most = threads.saturating_add(settings.external_threads).saturating_mul(BINS_PER_THREAD);
        let workers = Arc::new(Workers::new(max_jobs as usize));
        let gate = Gate::new(workers.clone(), Bins { wide: bins_w, high: bins_h, most });
        let mut pool = Self { gate: Arc::new(gate), threads: Vec::new() };
        let started = settings.on_thread_start.map(Arc::new);
        for number in 0..threads {
            let (workers, started) = (workers.clone(), started.clone());
            let work = move || {
                if let Some(started) = &started {
                    // If the callback panics, the thread still works.
                    let _ = catch_unwind(AssertUnwindSafe(|| started(number)));
                }
                // The callback may have changed the environment.
                in_default_environment(|| workers.work(number as usize));
            };
            let name = thread_name(&settings.thread_name, number);
            // If this fails, the threads already started end with the pool.
            let start = thread::Builder::new().name(name);
            pool.threads.push(start.spawn(work).map_err(|_| Error::OutOfMemory)?);
        }
        Ok(pool)
    }

    /// The number of worker threads: fewer than requested if there are fewer processors.
    pub fn thread_count(&self) -> u32 {
        self.threads.len() as u32
    }

    /// The number of columns and rows of bins.
    ///
    /// # Errors
    /// [`Error::NoObject`].
    pub fn bin_count(&self) -> Result<(u32, u32), Error> {
        self.gate.with_buffer(|target| Ok(target.bin_count()))
    }

    /// Lets the threads work. Has no effect if they are awake already.
    pub fn wake_threads(&self) {
        self.gate.workers.set_suspended(false);
    }

    /// Draws everything submitted, then puts the threads to sleep. Work submitted later waits until they are woken, or
    /// until a call flushes or does the work ([`Self::work_once`]).
    pub fn suspend_threads(&self) {
        self.flush();
        self.gate.workers.set_suspended(true);
    }

    /// Waits until everything submitted so far is drawn.
    pub fn flush(&self) {
        self.gate.workers.flush();
    }

    /// Does one piece of pending work on the calling thread and returns: for use in jobs of an engine's own job system,
    /// alongside the pool's threads or instead of them. Returns false if nothing is pending that is not already being
    /// worked on.
    pub fn work_once(&self) -> bool {
        self.gate.workers.work_once()
    }

    /// Whether everything submitted has been drawn. Calling [`Self::work_once`] in a loop until then is a flush that
    /// never sleeps.
    pub fn is_done(&self) -> bool {
        self.gate.workers.is_done()
    }

    /// Sets the object to draw into, which the pool owns until [`Self::take_buffer`]. A previous object that the pool
    /// owns is dropped once everything submitted is drawn.
    pub fn set_buffer(&self, moc: MaskedOcclusionCulling) {
        let moc = NonNull::from(Box::leak(Box::new(moc)));
        // SAFETY: just leaked, and freed with the target.
        let done = unsafe { self.gate.exchange(Some((moc, true))) };
        debug_assert!(done.is_ok(), "no other pool has it");
    }

    /// Flushes, and returns the object; `None` if the pool does not own one.
    pub fn take_buffer(&self) -> Option<MaskedOcclusionCulling> {
        self.gate.take_owned()
    }

    /// Draws what was submitted so far, then switches to this object, or to none. The object keeps its near plane.
    ///
    /// # Errors
    /// [`Taken`] if the object belongs to another pool; nothing changes.
    ///
    /// # Safety
    /// The object does not move until another one is set, the pool is dropped, or the object itself is dropped;
    /// the two may be dropped in either order. Until then no `&mut` to it is used while the pool has work in
    /// flight or is being called; `&` may be used for queries at any time, except while the pool sets an object
    /// or a resolution.
    pub(crate) unsafe fn set_buffer_unowned(&self, moc: Option<NonNull<MaskedOcclusionCulling>>) -> Result<(), Taken> {
        // SAFETY: the caller's contract.
        unsafe { self.gate.exchange(moc.map(|moc| (moc, false))) }
    }

    /// Draws everything submitted, then changes the object's resolution and clears it.
    ///
    /// # Errors
    /// [`Error::NoObject`], and those of [`MaskedOcclusionCulling::set_resolution`].
    pub fn set_resolution(&self, width: u32, height: u32) -> Result<(), Error> {
        self.gate.resize(|moc| moc.set_resolution(width, height))
    }

    /// Flushes, and sets the object's near plane, in clip-space w.
    ///
    /// # Errors
    /// [`Error::InvalidNumber`] for NaN or infinity: the near plane is unchanged. [`Error::NoObject`] if there is no
    /// object.
    pub fn set_near_clip_plane(&self, near: f32) -> Result<(), Error> {
        self.flush();
        if !near.is_finite() {
            return Err(Error::InvalidNumber);
        }
        let pass = self.gate.pass();
        let target = pass.as_ref().ok_or(Error::NoObject)?;
        let _recording = self.gate.recording(target);
        target.moc().set_near_shared(near)
    }

    /// Flushes, and clears the object. The buffer is clear when this returns.
    ///
    /// # Errors
    /// [`Error::NoObject`].
    pub fn clear_buffer(&self) -> Result<(), Error> {
        self.gate.with_buffer(|target| {
            let _recording = self.gate.recording(target);
            self.gate.workers.do_now(|| Work::Clear(target.count_clear()));
            target.moc().recorder().clear_buffer();
            Ok(())
        })
    }

    /// Draws, within `calls`, data that outlives the scope, and flushes at its end.
    ///
    /// # Panics
    /// If `calls` does.
    pub fn scope<'e, R>(&'e self, calls: impl FnOnce(&Scope<'e>) -> R) -> R {
        let scope = Scope { pool: self, lives: PhantomData };
        calls(&scope)
    }

    /// Draws occluders, in order with the calls around it; see [`MaskedOcclusionCulling::render_triangles`]. Returns at
    /// once, or does some of the work if there is no room.
    ///
    /// # Safety
    /// The vertices and the indices must not change until the pool has been flushed.
    ///
    /// # Errors
    /// Those of that method, and [`Error::NoObject`].
    pub unsafe fn render_triangles(
        &self,
        vertices: Vertices<'_>,
        triangles: &[u32],
        options: &DrawOptions,
    ) -> Result<(), Error> {
        match self.with_object(|moc| moc.mesh(&vertices, triangles, options)) {
            // SAFETY: the caller's contract.
            Ok(mesh) => unsafe { self.render_mesh(&mesh) },
            Err(error) => {
                self.refuse();
                Err(error)
            }
        }
    }

    /// A rejected draw counts as one without triangles, because a C++ program that rotates among arrays does not see
    /// its status.
    pub(crate) fn refuse(&self) {
        let vertices = VertexSource { base: core::ptr::null(), layout: VertexLayout::CLIP_SPACE };
        let (triangles, options) = (NonNull::<u32>::dangling().as_ptr().cast_const(), DrawOptions::default());
        let call = Call { vertices, triangles, indices: 0, matrix: None, options, near: 0.0, clears: 0 };
        // Without an object nothing is in flight.
        let _ = self.gate.with_buffer(|_| {
            self.gate.workers.submit(call, true);
            Ok::<(), Error>(())
        });
    }

    /// # Safety
    /// Every vertex from the lowest to the highest index of the mesh can be read; the vertices and the indices do not
    /// change until the pool has been flushed.
    pub(crate) unsafe fn render_mesh(&self, mesh: &Mesh<'_>) -> Result<(), Error> {
        let (vertices, triangles, matrix, options) = (mesh.vertices(), mesh.triangles(), mesh.matrix(), mesh.options());
        self.gate.with_buffer(|target| {
            let _recording = self.gate.recording(target);
            let near = target.moc().near_clip_plane();
            let mut rest = triangles;
            loop {
                // A call without triangles is one part too: it counts among those whose arrays a program rotates.
                let (part, later) = rest.split_at(rest.len().min(3 * CALL_TRIANGLES));
                let (triangles, indices) = (part.as_ptr(), part.len());
                let (matrix, options) = (matrix.copied(), *options);
                let call = Call { vertices, triangles, indices, matrix, options, near, clears: 0 };
                self.gate.workers.submit(call, later.is_empty());
                rest = later;
                if rest.is_empty() {
                    break;
                }
            }
            target.moc().recorder().render_triangles(None, mesh);
            Ok(())
        })
    }

    /// Merges other buffers into the pool's, in order with the calls around it, with a thread per bin; see
    /// [`MaskedOcclusionCulling::merge_buffers`].
    ///
    /// # Safety
    /// The others must not move or change until the pool has been flushed.
    ///
    /// # Errors
    /// Those of that method, and [`Error::NoObject`].
    pub unsafe fn merge_buffers(&self, others: &[&MaskedOcclusionCulling]) -> Result<(), Error> {
        self.gate.with_buffer(|target| {
            // Merging a buffer with itself has no effect.
            let others = others.iter().copied().filter(|&other| NonNull::from(other) != target.pointer());
            let others: Vec<&MaskedOcclusionCulling> = others.collect();
            target.moc().mergeable(&others)?;
            let others = others.into_iter().map(|other| Shared(NonNull::from(other))).collect();
            self.gate.workers.submit_ready(|| Work::Merge(others));
            Ok(())
        })
    }

    /// Tests a rectangle against what has been drawn so far; see [`MaskedOcclusionCulling::test_rect`].
    ///
    /// # Errors
    /// [`Error::NoObject`].
    pub fn test_rect(
        &self,
        x_min: f32,
        y_min: f32,
        x_max: f32,
        y_max: f32,
        w_min: f32,
    ) -> Result<CullingResult, Error> {
        self.gate.with_buffer(|target| Ok(self.gate.rect(target, [x_min, y_min, x_max, y_max], w_min)))
    }

    /// Tests occludees against what has been drawn so far; see [`MaskedOcclusionCulling::test_triangles`]. The answer
    /// is `Visible` if they are hidden only by contents that a pending clear will remove, even if they touch no pixel.
    ///
    /// # Errors
    /// Those of that method, and [`Error::NoObject`].
    pub fn test_triangles(
        &self,
        vertices: Vertices<'_>,
        triangles: &[u32],
        options: &DrawOptions,
    ) -> Result<CullingResult, Error> {
        let mesh = self.with_object(|moc| moc.mesh(&vertices, triangles, options))?;
        self.test_mesh(&mesh)
    }

    /// As [`Self::test_triangles`].
    pub(crate) fn test_mesh(&self, mesh: &Mesh<'_>) -> Result<CullingResult, Error> {
        self.gate.with_buffer(|target| Ok(self.gate.mesh(target, mesh)))
    }

    /// Gives access to the object itself, which has a buffer.
    pub(crate) fn with_object<R, E: From<Error>>(
        &self,
        look: impl FnOnce(&MaskedOcclusionCulling) -> Result<R, E>,
    ) -> Result<R, E> {
        self.gate.with_buffer(|target| look(target.moc()))
    }

    /// Flushes, and writes the depth of every pixel; see [`MaskedOcclusionCulling::compute_pixel_depth_buffer`].
    ///
    /// # Errors
    /// Those of that method, and [`Error::NoObject`].
    pub fn compute_pixel_depth_buffer(&self, depth: &mut [f32], flip_y: bool) -> Result<(), Error> {
        self.with_pixels(|_| Ok::<_, Error>(depth), flip_y)
    }

    /// The same, into an array that is obtained once its length is known.
    pub(crate) fn with_pixels<'a, E: From<Error>>(
        &self,
        array: impl FnOnce(usize) -> Result<&'a mut [f32], E>,
        flip_y: bool,
    ) -> Result<(), E> {
        self.flush();
        let write = |moc: &MaskedOcclusionCulling| -> Result<(), E> {
            let (width, height) = moc.resolution();
            Ok(moc.compute_pixel_depth_buffer(array(width as usize * height as usize)?, flip_y)?)
        };
        self.gate.with_buffer(|target| target.look(target.all_tiles(), write).0)
    }

    /// Flushes, and returns the object's counts; see [`MaskedOcclusionCulling::statistics`].
    ///
    /// # Errors
    /// [`Error::NoObject`].
    pub fn statistics(&self) -> Result<crate::Statistics, Error> {
        self.flush();
        Ok(self.gate.pass().as_ref().ok_or(Error::NoObject)?.moc().statistics())
    }
}

impl fmt::Debug for CullingThreadpool {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("CullingThreadpool").field("threads", &self.thread_count()).finish_non_exhaustive()
    }
}

impl Drop for CullingThreadpool {
    /// Draws everything submitted and ends the threads.
    fn drop(&mut self) {
        // Detached here, so that the object and the pool may be dropped in either order.
        self.gate.close();
        self.gate.workers.stop();
        for thread in self.threads.drain(..) {
            // A thread that panicked has already reported it.
            let _ = thread.join();
        }
    }
}

/// The name of a thread as the system shows it.
fn thread_name(prefix: &str, number: u32) -> String {
    // Truncated at a NUL, which the system does not accept.
    let prefix: String = prefix.chars().take_while(|&c| c != '\0').collect();
    format!("{prefix} {number}")
}

/// The calls available in [`CullingThreadpool::scope`].
#[derive(Debug)]
pub struct Scope<'e> {
    pool: &'e CullingThreadpool,
    /// Invariant, so that the lifetime of lent data cannot be shortened.
    lives: PhantomData<core::cell::Cell<&'e ()>>,
}

impl<'e> Scope<'e> {
    /// As [`CullingThreadpool::render_triangles`].
    ///
    /// # Errors
    /// Those of that method.
    pub fn render_triangles(
        &self,
        vertices: Vertices<'e>,
        triangles: &'e [u32],
        options: &DrawOptions,
    ) -> Result<(), Error> {
        // SAFETY: the data outlives the scope, which flushes when it ends.
        unsafe { self.pool.render_triangles(vertices, triangles, options) }
    }

    /// As [`CullingThreadpool::merge_buffers`].
    ///
    /// # Errors
    /// Those of that method.
    pub fn merge_buffers(&self, others: &[&'e MaskedOcclusionCulling]) -> Result<(), Error> {
        // SAFETY: as above; objects that the pool owns cannot be lent.
        unsafe { self.pool.merge_buffers(others) }
    }
}

impl Drop for Scope<'_> {
    fn drop(&mut self) {
        self.pool.flush();
    }
}
