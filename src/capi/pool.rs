//! The pool of threads: making it, its threads and its object. What it draws and answers is in `pool_calls.rs`.

use core::ffi::{c_char, c_void};
use core::ptr::NonNull;

use super::lifecycle::{NEAR, RESOLUTION};
use super::pointers::{check_out, read, write, write_size};
use super::pool_state::PoolState;
use super::refusal::{Because, Refusal};
use super::status::{MOC_Status, guard};
use crate::{CullingThreadpool, Error, MaskedOcclusionCulling, ThreadStart, ThreadpoolSettings};

/// A pool of threads that draw into an object; see MOC_ThreadpoolCreate.
pub struct MOC_Threadpool {
    pub(super) pool: CullingThreadpool,
    /// What the next calls without a matrix of their own are drawn with.
    pub(super) state: PoolState,
}

impl MOC_Threadpool {
    fn new(settings: ThreadpoolSettings) -> Result<*mut Self, Error> {
        let pool = CullingThreadpool::with_settings(settings)?;
        Ok(Box::into_raw(Box::new(Self { pool, state: PoolState::default() })))
    }
}

pub(super) const EMPTY: &str = "no buffer: call MOC_ThreadpoolSetBuffer first, with an object that has one";

/// # Safety
/// Null or from `MOC_ThreadpoolCreate` and not destroyed.
pub(super) unsafe fn handle<'a>(pool: *const MOC_Threadpool) -> Result<&'a MOC_Threadpool, Refusal> {
    // SAFETY: the caller's contract.
    unsafe { pool.as_ref() }.ok_or(Refusal::new(Error::NullPointer, "the pool is null"))
}

/// Called by a thread of a pool when it starts, with the `user` of the settings and the thread's number from 0 on: for its priority,
/// its affinity, or a profiler. It must not throw.
pub type MOC_ThreadStart = Option<unsafe extern "C" fn(user: *mut c_void, number: u32)>;

/// How MOC_ThreadpoolCreateFrom makes a pool. Fill it with zeros, then set `size` and what should differ from the defaults.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct MOC_ThreadpoolSettings {
    /// sizeof(MOC_ThreadpoolSettings).
    pub size: u32,
    /// Threads of the pool's own, 0 to 1024. There are fewer where there are fewer processors besides the caller's, but one at least.
    /// 0: the work is done by whoever flushes, submits or calls MOC_ThreadpoolWorkOnce.
    pub threads: u32,
    /// The columns and rows into which the screen is cut; 0: 4. There are no more than four bins per thread, none smaller than 128x64
    /// pixels, and rows of the screen first.
    pub bins_w: u32,
    /// See `bins_w`.
    pub bins_h: u32,
    /// Calls whose arrays may still be read when a call that draws returns; 0: 32. Small calls are gathered into batches of half as many
    /// at most, so that a larger number makes them cheaper.
    pub max_jobs: u32,
    /// Processors that the pool and its caller have; 0: as many as the system says.
    pub processors: u32,
    /// Threads of the program's own that will call MOC_ThreadpoolWorkOnce. It only says how many bins are worth having.
    pub external_threads: u32,
    /// 0.
    pub reserved: u32,
    /// What the names of the threads begin with, in UTF-8; their numbers follow. Null: "culling". It is copied.
    pub thread_name: *const c_char,
    /// Called by each thread when it starts; null: nothing is.
    pub thread_start: MOC_ThreadStart,
    /// For `thread_start`.
    pub user: *mut c_void,
}

/// A program's pointer, for its callback on other threads.
struct User(*mut c_void);

// SAFETY: it is only handed to the callback; the caller of MOC_ThreadpoolCreateFrom vouches that threads may have it.
unsafe impl Send for User {}
// SAFETY: as above.
unsafe impl Sync for User {}

impl MOC_ThreadpoolSettings {
    /// # Safety
    /// `thread_name` is null or a C string; `thread_start` may be called by any thread.
    unsafe fn to_rust(self) -> Result<ThreadpoolSettings, Refusal> {
        if self.reserved != 0 {
            return Err(Refusal::new(Error::InvalidEnum, "reserved is not 0"));
        }
        let mut settings = ThreadpoolSettings::default();
        let or = |value: u32, default: u32| if value == 0 { default } else { value };
        settings.threads = self.threads;
        settings.bins_w = or(self.bins_w, settings.bins_w);
        settings.bins_h = or(self.bins_h, settings.bins_h);
        settings.max_jobs = or(self.max_jobs, settings.max_jobs);
        settings.processors = self.processors;
        settings.external_threads = self.external_threads;
        if !self.thread_name.is_null() {
            // SAFETY: not null, and the caller's contract.
            let name = unsafe { core::ffi::CStr::from_ptr(self.thread_name) };
            settings.thread_name = name.to_string_lossy().into_owned();
        }
        let user = User(self.user);
        settings.on_thread_start = self.thread_start.map(|start| -> ThreadStart {
            Box::new(move |number| {
                let User(user) = &user;
                // SAFETY: the caller's contract.
                unsafe { start(*user, number) }
            })
        });
        Ok(settings)
    }
}

/// Makes a pool of `threads` threads (0 to 1024) and writes it to `out` (null there on errors). Where `processors` leaves fewer
/// besides the caller's, there are fewer threads, but one at least; 0: as many processors as the system says. The threads sleep
/// until MOC_ThreadpoolWakeThreads, and whenever there is nothing to do. The caller gives the pool back to
/// MOC_ThreadpoolDestroy.
///
/// Once: MOC_ThreadpoolSetBuffer, MOC_ThreadpoolWakeThreads. Each frame: MOC_ThreadpoolClearBuffer; a matrix and a draw for
/// each mesh; MOC_ThreadpoolFlush; tests.
///
/// Calls that draw return at once. The threads draw in `bins_w` times `bins_h` pieces of the screen (no more than four per
/// thread, none smaller than 128x64 pixels, and rows of the screen first), in each in the order in which the calls
/// came: the buffer gets the same bits as from one thread. While a thread of the pool is awake, what was submitted is drawn
/// without another call. With none awake, or none at all, it waits for MOC_ThreadpoolWakeThreads, MOC_ThreadpoolFlush,
/// MOC_ThreadpoolSuspendThreads or MOC_ThreadpoolWorkOnce.
///
/// At most `max_jobs` calls still read their arrays when a call that draws returns; where there would be more, the caller works until
/// there are not. So a program that goes round among `max_jobs` + 1 arrays needs no flush before it writes to one again.
///
/// Several threads may submit and query at once, and call every other function of the pool but MOC_ThreadpoolDestroy.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_INVALID_SIZE where `bins_w`, `bins_h` or `max_jobs` is 0 or `threads` above 1024,
/// MOC_STATUS_OUT_OF_MEMORY where the system starts no more threads.
///
/// # Safety
/// `out` is null or can be written.
#[unsafe(export_name = symbol!(MOC_ThreadpoolCreate))]
pub unsafe extern "C" fn MOC_ThreadpoolCreate(
    threads: u32,
    bins_w: u32,
    bins_h: u32,
    max_jobs: u32,
    processors: u32,
    out: *mut *mut MOC_Threadpool,
) -> MOC_Status {
    let settings = || Ok(ThreadpoolSettings { threads, bins_w, bins_h, max_jobs, processors, ..Default::default() });
    // SAFETY: the caller's contract.
    guard(|| unsafe { create(settings, out) })
}

/// MOC_ThreadpoolCreate with more settings: for pools whose work is done by the threads of the program's own job system, for names of
/// threads, and for a callback when a thread starts.
///
/// Errors: as there, and MOC_STATUS_NULL_POINTER for the settings, MOC_STATUS_INVALID_SIZE for a `size` that is too small,
/// MOC_STATUS_INVALID_ENUM for a `reserved` that is not 0.
///
/// # Safety
/// `settings` is null or can be read for as many bytes as its `size` says, its `thread_name` is null or a C string, and its `thread_start` may be called with its
/// `user` by any thread. `out` is null or can be written.
#[unsafe(export_name = symbol!(MOC_ThreadpoolCreateFrom))]
pub unsafe extern "C" fn MOC_ThreadpoolCreateFrom(
    settings: *const MOC_ThreadpoolSettings,
    out: *mut *mut MOC_Threadpool,
) -> MOC_Status {
    let settings = || {
        // SAFETY: the caller's contract. The size comes first, and nothing beyond it is read.
        let size =
            unsafe { read(settings.cast::<u32>()) }.ok_or(Refusal::new(Error::NullPointer, "settings is null"))?;
        if (size as usize) < size_of::<MOC_ThreadpoolSettings>() {
            return Err(Refusal::new(Error::InvalidSize, "size is less than sizeof(MOC_ThreadpoolSettings)"));
        }
        // SAFETY: not null, and as large as it says; the caller's contract.
        unsafe { read(settings).map_or(Ok(ThreadpoolSettings::default()), |settings| settings.to_rust()) }
    };
    // SAFETY: the caller's contract.
    guard(|| unsafe { create(settings, out) })
}

/// # Safety
/// `out` is null or can be written.
unsafe fn create(
    settings: impl FnOnce() -> Result<ThreadpoolSettings, Refusal>,
    out: *mut *mut MOC_Threadpool,
) -> Result<(), Refusal> {
    check_out(out)?;
    // SAFETY: not null, and the caller's contract.
    unsafe { write(out, core::ptr::null_mut()) };
    let pool = MOC_Threadpool::new(settings()?)
        .because(Error::InvalidSize, "bins_w, bins_h or max_jobs is 0, or threads above 1024")?;
    // SAFETY: as above.
    unsafe { write(out, pool) };
    Ok(())
}

/// Draws what was submitted, ends the threads, and frees the pool; the object that it drew into stays. Null is
/// allowed.
///
/// # Safety
/// `pool` is null or from MOC_ThreadpoolCreate and not destroyed; nobody uses it any more. What was submitted since the
/// last MOC_ThreadpoolFlush can still be read.
#[unsafe(export_name = symbol!(MOC_ThreadpoolDestroy))]
pub unsafe extern "C" fn MOC_ThreadpoolDestroy(pool: *mut MOC_Threadpool) -> MOC_Status {
    guard(|| {
        if !pool.is_null() {
            // SAFETY: not null, and the caller's contract.
            drop(unsafe { Box::from_raw(pool) });
        }
        Ok(())
    })
}

/// Lets the threads work. A second time changes nothing.
///
/// Errors: MOC_STATUS_NULL_POINTER.
///
/// # Safety
/// `pool` is null or from MOC_ThreadpoolCreate and not destroyed.
#[unsafe(export_name = symbol!(MOC_ThreadpoolWakeThreads))]
pub unsafe extern "C" fn MOC_ThreadpoolWakeThreads(pool: *const MOC_Threadpool) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        unsafe { handle(pool) }?.pool.wake_threads();
        Ok(())
    })
}

/// Draws what was submitted, and lets the threads sleep. Calls are taken in meanwhile; they wait until the threads are woken, or
/// somebody flushes or calls MOC_ThreadpoolWorkOnce.
///
/// Errors: MOC_STATUS_NULL_POINTER.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads.
#[unsafe(export_name = symbol!(MOC_ThreadpoolSuspendThreads))]
pub unsafe extern "C" fn MOC_ThreadpoolSuspendThreads(pool: *const MOC_Threadpool) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        unsafe { handle(pool) }?.pool.suspend_threads();
        Ok(())
    })
}

/// Waits until everything that was submitted before is drawn. Afterwards the arrays of those calls may be changed or freed,
/// and, while nobody calls the pool, the object may be drawn into directly.
///
/// Errors: MOC_STATUS_NULL_POINTER.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads.
#[unsafe(export_name = symbol!(MOC_ThreadpoolFlush))]
pub unsafe extern "C" fn MOC_ThreadpoolFlush(pool: *const MOC_Threadpool) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        unsafe { handle(pool) }?.pool.flush();
        Ok(())
    })
}

/// Does one piece of the work that is pending, in the calling thread, and returns: for the jobs of a program's own job system, beside
/// the pool's threads or in their place. Writes 1 to `worked` (null is allowed), or 0 where there is nothing to do now that nobody does
/// yet. A piece is one batch of calls to project, or what one bin has to draw: tens of microseconds as a rule.
///
/// Errors: MOC_STATUS_NULL_POINTER.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads. `worked` is null or can be written.
#[unsafe(export_name = symbol!(MOC_ThreadpoolWorkOnce))]
pub unsafe extern "C" fn MOC_ThreadpoolWorkOnce(pool: *const MOC_Threadpool, worked: *mut i32) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        let did = unsafe { handle(pool) }?.pool.work_once();
        if !worked.is_null() {
            // SAFETY: not null, and the caller's contract.
            unsafe { write(worked, i32::from(did)) };
        }
        Ok(())
    })
}

/// Writes 1 where everything that was submitted is drawn, else 0. MOC_ThreadpoolWorkOnce in a loop until then is a flush that never
/// sleeps.
///
/// Errors: MOC_STATUS_NULL_POINTER.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads. `done` is null or can be written.
#[unsafe(export_name = symbol!(MOC_ThreadpoolIsDone))]
pub unsafe extern "C" fn MOC_ThreadpoolIsDone(pool: *const MOC_Threadpool, done: *mut i32) -> MOC_Status {
    guard(|| {
        check_out(done)?;
        // SAFETY: not null, and the caller's contract.
        unsafe { write(done, i32::from(handle(pool)?.pool.is_done())) };
        Ok(())
    })
}

/// Writes how many threads the pool has of its own: fewer than were asked for where there are fewer processors.
///
/// Errors: MOC_STATUS_NULL_POINTER.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads. `threads` is null or can be written.
#[unsafe(export_name = symbol!(MOC_ThreadpoolGetThreads))]
pub unsafe extern "C" fn MOC_ThreadpoolGetThreads(pool: *const MOC_Threadpool, threads: *mut u32) -> MOC_Status {
    guard(|| {
        check_out(threads)?;
        // SAFETY: not null, and the caller's contract.
        unsafe { write(threads, handle(pool)?.pool.thread_count()) };
        Ok(())
    })
}

/// Writes into how many columns and rows of bins the screen is cut, which changes with the resolution.
///
/// Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_NO_BUFFER, and 0 by 0 is written.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads. `bins_w` and `bins_h` are null or can be written.
#[unsafe(export_name = symbol!(MOC_ThreadpoolGetBins))]
pub unsafe extern "C" fn MOC_ThreadpoolGetBins(
    pool: *const MOC_Threadpool,
    bins_w: *mut u32,
    bins_h: *mut u32,
) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        unsafe { write_size(bins_w, bins_h, handle(pool)?.pool.bin_count()).because(Error::NoBuffer, EMPTY) }
    })
}

/// Draws into `moc` from now on (null: into nothing), after what was submitted is drawn. The object keeps its near plane.
///
/// The object may be destroyed before the pool or after it. It may be queried by MOC_TestRect and MOC_TestTriangles by any thread, also
/// while the pool draws or clears (not while this function or MOC_ThreadpoolSetResolution runs): they answer from what is drawn by then.
/// What would change or copy its buffer while something is in
/// flight is refused (MOC_STATUS_BUSY); MOC_Flush waits for the pool.
///
/// Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_BUSY where `moc` belongs to another pool, and nothing is changed.
///
/// # Safety
/// `pool` is null or from MOC_ThreadpoolCreate and not destroyed. `moc` is null or from MOC_Create and not destroyed; nobody uses it or the
/// object that the pool had meanwhile.
#[unsafe(export_name = symbol!(MOC_ThreadpoolSetBuffer))]
pub unsafe extern "C" fn MOC_ThreadpoolSetBuffer(
    pool: *const MOC_Threadpool,
    moc: *mut MaskedOcclusionCulling,
) -> MOC_Status {
    // SAFETY: the caller's contract; an object that is destroyed leaves its pool first.
    guard(|| unsafe {
        handle(pool)?
            .pool
            .set_buffer_unowned(NonNull::new(moc))
            .because(Error::Busy, "the object belongs to another pool")
    })
}

/// MOC_SetResolution of the pool's object, after what was submitted is drawn.
///
/// Errors: as there, and MOC_STATUS_NO_BUFFER where the pool has no object.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads. Meanwhile nobody queries the object other than through the pool.
#[unsafe(export_name = symbol!(MOC_ThreadpoolSetResolution))]
pub unsafe extern "C" fn MOC_ThreadpoolSetResolution(
    pool: *const MOC_Threadpool,
    width: u32,
    height: u32,
) -> MOC_Status {
    // SAFETY: the caller's contract.
    let done = || unsafe { handle(pool) }?.pool.set_resolution(width, height).because(Error::InvalidSize, RESOLUTION);
    guard(|| done().because(Error::NoBuffer, EMPTY))
}

/// MOC_ThreadpoolFlush, then MOC_SetNearClipPlane of the pool's object.
///
/// Errors: as there, and MOC_STATUS_NO_BUFFER where the pool has no object.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads.
#[unsafe(export_name = symbol!(MOC_ThreadpoolSetNearClipPlane))]
pub unsafe extern "C" fn MOC_ThreadpoolSetNearClipPlane(pool: *const MOC_Threadpool, near: f32) -> MOC_Status {
    // SAFETY: the caller's contract.
    let done = || unsafe { handle(pool) }?.pool.set_near_clip_plane(near).because(Error::InvalidNumber, NEAR);
    guard(|| done().because(Error::NoBuffer, EMPTY))
}
