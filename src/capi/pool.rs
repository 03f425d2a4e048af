//! The pool of threads.

use core::ptr::NonNull;
use std::sync::{Mutex, PoisonError};

use super::lifecycle::{NEAR, RESOLUTION};
use super::mesh::{CheckedMesh, MeshArguments};
use super::messages::note;
use super::pointers::{check_out, objects, read, slice_mut, write};
use super::query::odd_rectangle;
use super::refusal::{Because, Refusal};
use super::status::{MOC_Status, guard, guard_result};
use super::types::{self, MOC_VertexLayout};
use crate::{CullingResult, CullingThreadpool, Error, MaskedOcclusionCulling, VertexLayout};

/// A pool of threads that draw into an object; see MOC_ThreadpoolCreate.
pub struct MOC_Threadpool {
    pool: CullingThreadpool,
    /// What the next calls are drawn with.
    state: Mutex<State>,
}

#[derive(Clone, Copy)]
struct State {
    matrix: Option<[f32; 16]>,
    layout: MOC_VertexLayout,
}

impl MOC_Threadpool {
    /// A mesh with what is set, checked.
    ///
    /// # Safety
    /// As [`MeshArguments::check`].
    unsafe fn mesh<'a>(
        &self,
        vertices: *const f32,
        triangles: *const u32,
        n_triangles: i32,
        winding: i32,
        clip_planes: i32,
    ) -> Result<CheckedMesh<'a>, Refusal> {
        let State { matrix, layout } = *self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let arguments = MeshArguments {
            vertices,
            vertex_floats: None,
            triangles,
            n_triangles,
            model_to_clip: matrix.as_ref().map_or(core::ptr::null(), |matrix| matrix.as_ptr()),
            winding,
            clip_planes,
            layout: &raw const layout,
        };
        // SAFETY: the caller's contract, and two locals.
        self.pool.with_object(|moc| Ok(unsafe { arguments.check(moc) })).because(Error::NoBuffer, EMPTY)?
    }

    fn change(&self, change: impl FnOnce(&mut State)) {
        change(&mut self.state.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

const EMPTY: &str = "no buffer: call MOC_ThreadpoolSetBuffer first, with an object that has one";

/// # Safety
/// Null or from `MOC_ThreadpoolCreate` and not destroyed.
unsafe fn handle<'a>(pool: *const MOC_Threadpool) -> Result<&'a MOC_Threadpool, Refusal> {
    // SAFETY: the caller's contract.
    unsafe { pool.as_ref() }.ok_or(Refusal::new(Error::NullPointer, "the pool is null"))
}

/// Makes a pool of `threads` threads (0 to 1024) and writes it to `out` (null there on errors). Where `processors` leaves fewer
/// besides the caller's, there are fewer threads, but one at least; 0: as many processors as the system says. The threads sleep
/// until MOC_ThreadpoolWakeThreads, and whenever there is nothing to do. The caller gives the pool back to
/// MOC_ThreadpoolDestroy.
///
/// Once: MOC_ThreadpoolSetBuffer, MOC_ThreadpoolWakeThreads. Each frame: MOC_ThreadpoolClearBuffer; a matrix and a draw for
/// each mesh; MOC_ThreadpoolFlush; tests.
///
/// Calls that draw return at once. The threads draw in `bins_w` times `bins_h` pieces of the screen (no more than four a
/// thread, none smaller than 128x64 pixels, and rows of the screen first), in each in the order in which the calls
/// came: the buffer gets the same bits as from one thread. At most `max_jobs` batches of calls are
/// in flight; a caller who finds no room works until there is. Without threads (0), whoever flushes does the work.
///
/// Several threads may submit and query at once, and call every other function of the pool but MOC_ThreadpoolDestroy.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_INVALID_SIZE where `bins_w`, `bins_h` or `max_jobs` is 0 or `threads` above 1024,
/// MOC_STATUS_OUT_OF_MEMORY where the system starts no more threads.
///
/// # Safety
/// `out` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn MOC_ThreadpoolCreate(
    threads: u32,
    bins_w: u32,
    bins_h: u32,
    max_jobs: u32,
    processors: u32,
    out: *mut *mut MOC_Threadpool,
) -> MOC_Status {
    guard(|| {
        check_out(out)?;
        // SAFETY: not null, and the caller's contract.
        unsafe { write(out, core::ptr::null_mut()) };
        let pool = match processors {
            0 => CullingThreadpool::new(threads, bins_w, bins_h, max_jobs)?,
            _ => CullingThreadpool::with_processors(threads, bins_w, bins_h, max_jobs, processors)?,
        };
        let state = Mutex::new(State { matrix: None, layout: VertexLayout::CLIP_SPACE.into() });
        // SAFETY: as above.
        unsafe { write(out, Box::into_raw(Box::new(MOC_Threadpool { pool, state }))) };
        Ok(())
    })
}

/// Draws what was submitted, ends the threads, and frees the pool; the object that it drew into stays. Null is
/// allowed.
///
/// # Safety
/// `pool` is null or from MOC_ThreadpoolCreate and not destroyed; nobody uses it any more. What was submitted since the
/// last MOC_ThreadpoolFlush can still be read, and the object is still there.
#[unsafe(no_mangle)]
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
#[unsafe(no_mangle)]
pub unsafe extern "C" fn MOC_ThreadpoolWakeThreads(pool: *const MOC_Threadpool) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        unsafe { handle(pool) }?.pool.wake_threads();
        Ok(())
    })
}

/// Lets each thread sleep as soon as it has finished what it is at. Calls are taken in meanwhile, and whoever flushes
/// does the work.
///
/// Errors: MOC_STATUS_NULL_POINTER.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn MOC_ThreadpoolSuspendThreads(pool: *const MOC_Threadpool) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        unsafe { handle(pool) }?.pool.suspend_threads();
        Ok(())
    })
}

/// Waits until everything that was submitted before is drawn. Afterwards the arrays of those calls may be changed or freed,
/// and, while nobody calls the pool, the object may be used directly.
///
/// Errors: MOC_STATUS_NULL_POINTER.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn MOC_ThreadpoolFlush(pool: *const MOC_Threadpool) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        unsafe { handle(pool) }?.pool.flush();
        Ok(())
    })
}

/// Draws into `moc` from now on (null: into nothing), after what was submitted is drawn. A near plane that was set on the pool
/// becomes the object's.
///
/// Errors: MOC_STATUS_NULL_POINTER.
///
/// # Safety
/// `pool` is null or from MOC_ThreadpoolCreate and not destroyed. `moc` is null or from MOC_Create; until another object is set or
/// the pool is destroyed it is not destroyed, and it is used through the pool only, or after MOC_ThreadpoolFlush while nobody
/// calls the pool.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn MOC_ThreadpoolSetBuffer(
    pool: *const MOC_Threadpool,
    moc: *mut MaskedOcclusionCulling,
) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        unsafe { handle(pool)?.pool.set_buffer_unowned(NonNull::new(moc)) };
        Ok(())
    })
}

/// MOC_SetResolution of the pool's object, after what was submitted is drawn.
///
/// Errors: as there, and MOC_STATUS_NO_BUFFER where the pool has no object.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn MOC_ThreadpoolSetResolution(
    pool: *const MOC_Threadpool,
    width: u32,
    height: u32,
) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| {
        unsafe { handle(pool) }?
            .pool
            .set_resolution(width, height)
            .because(Error::InvalidSize, RESOLUTION)
            .because(Error::NoBuffer, EMPTY)
    })
}

/// Sets the near plane of the calls that follow, and of the object, as MOC_SetNearClipPlane does.
///
/// Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_INVALID_NUMBER for NaN or an infinity.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn MOC_ThreadpoolSetNearClipPlane(pool: *const MOC_Threadpool, near: f32) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| unsafe { handle(pool) }?.pool.set_near_clip_plane(near).because(Error::InvalidNumber, NEAR))
}

/// Sets the matrix of the calls that follow, 16 floats as in MOC_RenderTriangles, which are copied; null: none, the
/// vertices are in clip space. Threads that submit share it.
///
/// Errors: MOC_STATUS_NULL_POINTER for the pool.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads. `model_to_clip` is null or can be read for 16 floats.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn MOC_ThreadpoolSetMatrix(pool: *const MOC_Threadpool, model_to_clip: *const f32) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        let (pool, matrix) = unsafe { (handle(pool)?, read(model_to_clip.cast::<[f32; 16]>())) };
        pool.change(|state| state.matrix = matrix);
        Ok(())
    })
}

/// Sets the vertex layout of the calls that follow; null: (16, 4, 12), x, y, z, w packed, which fits no matrix: with one
/// the last offset names z. Threads that submit share it.
///
/// Errors: MOC_STATUS_NULL_POINTER for the pool; MOC_STATUS_INVALID_LAYOUT for a negative stride.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads. `layout` is null or can be read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn MOC_ThreadpoolSetVertexLayout(
    pool: *const MOC_Threadpool,
    layout: *const MOC_VertexLayout,
) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        let (pool, layout) = unsafe { (handle(pool)?, read(layout)) };
        let layout = layout.unwrap_or(VertexLayout::CLIP_SPACE.into());
        if layout.stride < 0 {
            return Err(Refusal::new(Error::InvalidLayout, "the stride of the vertex layout is negative"));
        }
        pool.change(|state| state.layout = layout);
        Ok(())
    })
}

/// Clears the object's buffer, in order with the calls around it. From now on nothing that was drawn before hides anything.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_NO_BUFFER.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn MOC_ThreadpoolClearBuffer(pool: *const MOC_Threadpool) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| unsafe { handle(pool) }?.pool.clear_buffer().because(Error::NoBuffer, EMPTY))
}

/// Submits occluders, with the matrix, vertex layout and near plane that are set, and returns at once, or
/// works where `max_jobs` batches are in flight; see MOC_RenderTriangles.
///
/// Errors: as there. Triangles that are dropped later are counted in the object's statistics.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads. The indices, and every vertex from the lowest to the highest index, can be read and stay as they
/// are until MOC_ThreadpoolFlush.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn MOC_ThreadpoolRenderTriangles(
    pool: *const MOC_Threadpool,
    vertices: *const f32,
    triangles: *const u32,
    n_triangles: i32,
    winding: i32,
    clip_planes: i32,
) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        let handle = unsafe { handle(pool) }?;
        // SAFETY: the caller's contract.
        let mesh = unsafe { handle.mesh(vertices, triangles, n_triangles, winding, clip_planes) }?;
        // SAFETY: the caller's contract.
        Ok(unsafe { handle.pool.render_triangles_unchecked(mesh.vertices, mesh.triangles, &mesh.options) }?)
    })
}

/// MOC_TestRect against what is drawn by now. What was submitted and is not drawn hides nothing yet.
///
/// Errors: as there.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads. `result` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn MOC_ThreadpoolTestRect(
    pool: *const MOC_Threadpool,
    xmin: f32,
    ymin: f32,
    xmax: f32,
    ymax: f32,
    wmin: f32,
    result: *mut i32,
) -> MOC_Status {
    let query = || {
        check_out(result)?;
        // SAFETY: the caller's contract.
        let answer =
            unsafe { handle(pool) }?.pool.test_rect(xmin, ymin, xmax, ymax, wmin).because(Error::NoBuffer, EMPTY)?;
        if answer == CullingResult::Visible {
            note("MOC_ThreadpoolTestRect", || odd_rectangle([xmin, ymin, xmax, ymax, wmin]));
        }
        Ok(answer)
    };
    // SAFETY: the caller's contract.
    unsafe { guard_result(result, query) }
}

/// MOC_TestTriangles against what is drawn by now, with the matrix, vertex layout and near plane that are set.
///
/// Errors: as there.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads and MOC_TestTriangles. `result` is null or can be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn MOC_ThreadpoolTestTriangles(
    pool: *const MOC_Threadpool,
    vertices: *const f32,
    triangles: *const u32,
    n_triangles: i32,
    winding: i32,
    clip_planes: i32,
    result: *mut i32,
) -> MOC_Status {
    let query = || {
        // SAFETY: the caller's contract.
        let handle = unsafe { handle(pool) }?;
        // SAFETY: the caller's contract.
        let mesh = unsafe { handle.mesh(vertices, triangles, n_triangles, winding, clip_planes) }?;
        // SAFETY: the caller's contract.
        Ok(unsafe { handle.pool.test_triangles_unchecked(mesh.vertices, mesh.triangles, &mesh.options) }?)
    };
    // SAFETY: the caller's contract.
    unsafe { guard_result(result, query) }
}

/// MOC_ComputePixelDepthBuffer of the pool's object, after what was submitted is drawn.
///
/// Errors: as there.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads and MOC_ComputePixelDepthBuffer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn MOC_ThreadpoolComputePixelDepthBuffer(
    pool: *const MOC_Threadpool,
    out: *mut f32,
    flip_y: i32,
) -> MOC_Status {
    guard(|| {
        check_out(out)?;
        // SAFETY: the caller's contract.
        let pool = &unsafe { handle(pool) }?.pool;
        let flip = types::flag(flip_y, "flip_y is neither 0 nor 1")?;
        // SAFETY: the caller's contract.
        let out = |pixels| unsafe { slice_mut(out, pixels) };
        pool.with_pixels(out, flip)
            .because(Error::NoBuffer, EMPTY)
            .because(Error::InvalidLayout, "out is not at a multiple of 4 bytes")
    })
}

/// Folds the buffers of `count` other objects into the pool's, in order with the calls around it, with the result of
/// MOC_MergeBuffers: each thread takes pieces of the screen.
///
/// Errors: as there; nothing is folded.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads and MOC_MergeBuffers. Nobody changes or destroys the others
/// until MOC_ThreadpoolFlush.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn MOC_ThreadpoolMergeBuffers(
    pool: *const MOC_Threadpool,
    others: *const *const MaskedOcclusionCulling,
    count: u32,
) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        let (pool, others) = unsafe { (handle(pool)?, objects(others, count)?) };
        // SAFETY: the caller's contract.
        unsafe { pool.pool.merge_buffers(&others) }.because(Error::NoBuffer, EMPTY)
    })
}
