//! The thread pool: creating it, its threads and its object. Draws and queries are in `pool_calls.rs`.

use core::ffi::{c_char, c_void};
use core::ptr::NonNull;

use super::lifecycle::{NEAR, RESOLUTION};
use super::pointers::{check_out, read, read_size, write, write_size};
use super::pool_state::PoolState;
use super::refusal::{Because, Refusal};
use super::status::{MOC_Status, guard};
use crate::{CullingThreadpool, Error, MaskedOcclusionCulling, ThreadStart, ThreadpoolSettings};

/// A pool of threads that draw into an object; see MOC_ThreadpoolCreate.
#[derive(Debug)]
pub struct MOC_Threadpool {
    pub(super) pool: CullingThreadpool,
    /// The matrices and layouts for calls that do not pass their own.
    pub(super) state: PoolState,
}

impl MOC_Threadpool {
    fn new(settings: ThreadpoolSettings) -> Result<*mut Self, Error> {
        let pool = CullingThreadpool::new(settings)?;
        Ok(Box::into_raw(Box::new(Self { pool, state: PoolState::default() })))
    }
}

pub(super) const EMPTY: &str = "no buffer: call MOC_ThreadpoolSetBuffer first, with an object that has one";

/// # Safety
/// Null or from `MOC_ThreadpoolCreate` and not destroyed.
pub(super) unsafe fn handle<'a>(pool: *const MOC_Threadpool) -> Result<&'a MOC_Threadpool, Refusal> {
    // SAFETY: the caller's contract.
    unsafe { pool.as_ref() }.ok_or(Refusal::new(MOC_Status::MOC_STATUS_NULL_POINTER, "the pool is null"))
}

/// Called on each worker thread of a pool when it starts, with the `user` of the settings and the thread's number,
/// counted from 0: to set its priority or affinity, or to register it with a profiler. It must not throw.
pub type MOC_ThreadStart = Option<unsafe extern "C" fn(user: *mut c_void, number: u32)>;

/// Settings of MOC_ThreadpoolCreateFrom. Zero the struct, then set `size` and whatever should differ from the defaults.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct MOC_ThreadpoolSettings {
    /// sizeof(MOC_ThreadpoolSettings).
    pub size: u32,
    /// Worker threads of the pool, 0 to 1024. Fewer are started if there are fewer processors besides the
    /// caller's, but at least one. 0: the work is done by the calls that flush or submit, and by
    /// MOC_ThreadpoolWorkOnce.
    pub threads: u32,
    /// Columns and rows of bins on the screen; 0: 4. There are at most four bins per thread, none smaller than
    /// 128x64 pixels, and the screen is divided into rows first.
    pub bins_w: u32,
    /// See `bins_w`.
    pub bins_h: u32,
    /// How many calls' arrays may still be read when a draw call returns; 0: 32. Small calls are gathered into
    /// batches of at most half as many, so a larger number makes them cheaper.
    pub max_jobs: u32,
    /// Processors available to the pool and its caller; 0: as many as the system reports.
    pub processors: u32,
    /// Number of the program's own threads that will call MOC_ThreadpoolWorkOnce. It only affects the number of bins.
    pub external_threads: u32,
    /// Must be 0.
    pub reserved: u32,
    /// Prefix of the thread names, in UTF-8; the thread's number is appended. Null: "culling". It is copied.
    pub thread_name: *const c_char,
    /// Called by each worker thread when it starts; null: no callback.
    pub thread_start: MOC_ThreadStart,
    /// Passed to `thread_start`.
    pub user: *mut c_void,
}

/// The program's pointer, passed to its callback on other threads.
struct User(*mut c_void);

// SAFETY: it is only passed to the callback; the caller of MOC_ThreadpoolCreateFrom vouches that other threads may
// use it.
unsafe impl Send for User {}
// SAFETY: as above.
unsafe impl Sync for User {}

impl MOC_ThreadpoolSettings {
    /// # Safety
    /// `thread_name` is null or a C string; `thread_start` may be called by any thread.
    unsafe fn to_rust(self) -> Result<ThreadpoolSettings, Refusal> {
        if self.reserved != 0 {
            return Err(Refusal::new(MOC_Status::MOC_STATUS_INVALID_ENUM, "reserved is not 0"));
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

/// Creates a pool of `threads` threads (0 to 1024) and writes it to `out` (null on errors). If fewer of the
/// `processors` are left besides the caller's, fewer threads are started, but at least one; `processors` 0 means as
/// many as the system reports. The threads sleep until MOC_ThreadpoolWakeThreads, and whenever there is nothing to do.
/// The caller destroys the pool with MOC_ThreadpoolDestroy.
///
/// Once: MOC_ThreadpoolSetBuffer, MOC_ThreadpoolWakeThreads. Each frame: MOC_ThreadpoolClearBuffer; a matrix and a draw
/// for each mesh; MOC_ThreadpoolFlush; tests.
///
/// Draw calls return at once. The threads draw into `bins_w` times `bins_h` bins of the screen (at most four per
/// thread, none smaller than 128x64 pixels; the screen is divided into rows first), within each bin in the order of the
/// calls, so the buffer has the same bits as if one thread drew it. While a worker thread is awake, submitted work is
/// drawn without a further call. With none awake, or none at all, it waits for MOC_ThreadpoolWakeThreads,
/// MOC_ThreadpoolFlush, MOC_ThreadpoolSuspendThreads or MOC_ThreadpoolWorkOnce.
///
/// At most `max_jobs` calls still read their arrays when a draw call returns; beyond that the caller helps until this
/// is so again. A program that rotates among `max_jobs` + 1 arrays therefore needs no flush before it overwrites one.
///
/// Several threads may submit and query at once, and call every other function of the pool except
/// MOC_ThreadpoolDestroy.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_INVALID_SIZE if `bins_w`, `bins_h` or `max_jobs` is 0 or `threads` is
/// above 1024, MOC_STATUS_OUT_OF_MEMORY if the system cannot start the threads.
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

/// MOC_ThreadpoolCreate with more settings: pools whose work is done by the program's own job system, thread names,
/// and a callback when a thread starts.
///
/// Errors: as MOC_ThreadpoolCreate, and MOC_STATUS_NULL_POINTER for the settings, MOC_STATUS_INVALID_SIZE for a
/// `size` that is too small, MOC_STATUS_INVALID_ENUM for a `reserved` that is not 0.
///
/// # Safety
/// `settings` is null or can be read for the number of bytes given in its `size`, its `thread_name` is null or a C
/// string, and its `thread_start` may be called with its `user` by any thread. `out` is null or can be written.
#[unsafe(export_name = symbol!(MOC_ThreadpoolCreateFrom))]
pub unsafe extern "C" fn MOC_ThreadpoolCreateFrom(
    settings: *const MOC_ThreadpoolSettings,
    out: *mut *mut MOC_Threadpool,
) -> MOC_Status {
    let settings = || {
        // SAFETY: the caller's contract. The size is the first field, and nothing beyond it is read.
        let size = unsafe { read_size(settings) }
            .ok_or(Refusal::new(MOC_Status::MOC_STATUS_NULL_POINTER, "settings is null"))?;
        if size < size_of::<MOC_ThreadpoolSettings>() {
            return Err(Refusal::new(
                MOC_Status::MOC_STATUS_INVALID_SIZE,
                "size is less than sizeof(MOC_ThreadpoolSettings)",
            ));
        }
        // SAFETY: not null, and large enough according to its `size`; the caller's contract.
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
        .because(MOC_Status::MOC_STATUS_INVALID_SIZE, "bins_w, bins_h or max_jobs is 0, or threads is above 1024")?;
    // SAFETY: as above.
    unsafe { write(out, pool) };
    Ok(())
}

/// Draws everything submitted, ends the threads, and frees the pool; the object that it drew into remains. Null is
/// allowed.
///
/// # Safety
/// `pool` is null or from MOC_ThreadpoolCreate and not destroyed; nobody uses it any more. The arrays of the calls
/// submitted since the last MOC_ThreadpoolFlush can still be read.
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

/// Wakes the threads, so that they draw what is submitted. Has no effect if they are already awake.
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

/// Draws everything submitted, then puts the threads to sleep. Draw calls are still accepted; they wait until the
/// threads are woken, or until a call flushes or does the work (MOC_ThreadpoolWorkOnce).
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

/// Waits until everything submitted before is drawn. Afterwards the arrays of those calls may be changed or freed and,
/// as long as no thread calls the pool, the object may be drawn into directly.
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

/// Does one piece of pending work on the calling thread and returns: for jobs of the program's own job system,
/// alongside the pool's threads or instead of them. Writes 1 to `worked` (null is allowed), or 0 if nothing is
/// pending that is not already being worked on. A piece is one batch of calls to project, or the batches one bin has
/// to draw: usually tens of microseconds.
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

/// Writes 1 if everything submitted is drawn, otherwise 0. Calling MOC_ThreadpoolWorkOnce in a loop until then is a
/// flush that never sleeps.
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

/// Writes the number of the pool's worker threads: fewer than requested if there are fewer processors.
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

/// Writes the number of columns and rows of bins, which depends on the resolution.
///
/// Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_NO_BUFFER, in which case 0 by 0 is written.
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
        unsafe {
            write_size(bins_w, bins_h, handle(pool)?.pool.bin_count().because(MOC_Status::MOC_STATUS_NO_BUFFER, EMPTY))
        }
    })
}

/// Makes the pool draw into `moc` from now on (null: into no object), once everything submitted before is drawn. The
/// object keeps its near plane.
///
/// The object may be destroyed before or after the pool. MOC_TestRect and MOC_TestTriangles may query it on any
/// thread, even while the pool draws or clears (but not while this function or MOC_ThreadpoolSetResolution runs):
/// they answer from what has been drawn so far. Calls that would change or copy its buffer while work is in flight
/// are refused (MOC_STATUS_BUSY); MOC_Flush waits for the pool.
///
/// Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_BUSY if `moc` belongs to another pool, and nothing is changed.
///
/// # Safety
/// `pool` is null or from MOC_ThreadpoolCreate and not destroyed. `moc` is null or from MOC_Create and not destroyed;
/// no other thread uses it or the pool's previous object meanwhile.
#[unsafe(export_name = symbol!(MOC_ThreadpoolSetBuffer))]
pub unsafe extern "C" fn MOC_ThreadpoolSetBuffer(
    pool: *const MOC_Threadpool,
    moc: *mut MaskedOcclusionCulling,
) -> MOC_Status {
    // SAFETY: the caller's contract; destroying an object detaches it from its pool first.
    guard(|| unsafe { handle(pool)?.pool.set_buffer_unowned(NonNull::new(moc)).map_err(Refusal::from) })
}

/// MOC_SetResolution on the pool's object, once everything submitted is drawn.
///
/// Errors: as there, and MOC_STATUS_NO_BUFFER if the pool has no object.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads. Meanwhile no thread queries the object other than through the pool.
#[unsafe(export_name = symbol!(MOC_ThreadpoolSetResolution))]
pub unsafe extern "C" fn MOC_ThreadpoolSetResolution(
    pool: *const MOC_Threadpool,
    width: u32,
    height: u32,
) -> MOC_Status {
    // SAFETY: the caller's contract.
    let done = || {
        unsafe { handle(pool) }?
            .pool
            .set_resolution(width, height)
            .because(MOC_Status::MOC_STATUS_INVALID_SIZE, RESOLUTION)
    };
    guard(|| done().because(MOC_Status::MOC_STATUS_NO_BUFFER, EMPTY))
}

/// MOC_ThreadpoolFlush, then MOC_SetNearClipPlane on the pool's object.
///
/// Errors: as there, and MOC_STATUS_NO_BUFFER if the pool has no object.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads.
#[unsafe(export_name = symbol!(MOC_ThreadpoolSetNearClipPlane))]
pub unsafe extern "C" fn MOC_ThreadpoolSetNearClipPlane(pool: *const MOC_Threadpool, near: f32) -> MOC_Status {
    // SAFETY: the caller's contract.
    let done =
        || unsafe { handle(pool) }?.pool.set_near_clip_plane(near).because(MOC_Status::MOC_STATUS_INVALID_NUMBER, NEAR);
    guard(|| done().because(MOC_Status::MOC_STATUS_NO_BUFFER, EMPTY))
}
