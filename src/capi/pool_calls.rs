//! Draws and queries of a pool.

use super::draw::check_to_merge;
use super::mesh::{CheckedMesh, Describe, MOC_Mesh};
use super::messages::note;
use super::pointers::{check_out, objects, read, slice_mut};
use super::pool::{EMPTY, MOC_Threadpool, handle};
use super::query::odd_rectangle;
use super::refusal::{Because, Refusal};
use super::status::{MOC_Status, guard, guard_result};
use super::types::{self, MOC_VertexLayout};
use crate::{CullingResult, MaskedOcclusionCulling, VertexLayout};

impl MOC_Threadpool {
    /// # Safety
    /// As [`Describe::check`].
    unsafe fn check<'a>(&self, mesh: impl Describe) -> Result<CheckedMesh<'a>, Refusal> {
        // SAFETY: the caller's contract.
        let checked = self.pool.with_object(|moc| Ok::<_, Refusal>(unsafe { mesh.check(moc) }));
        checked.because(MOC_Status::MOC_STATUS_NO_BUFFER, EMPTY)?
    }

    /// # Safety
    /// As MOC_ThreadpoolRenderMesh and [`Describe::check`].
    unsafe fn render(&self, mesh: impl Describe) -> Result<(), Refusal> {
        // SAFETY: the caller's contract.
        match unsafe { self.check(mesh) } {
            // SAFETY: the caller's contract.
            Ok(mesh) => Ok(unsafe { self.pool.render_mesh(&mesh.mesh()) }?),
            Err(refusal) => {
                self.pool.refuse();
                Err(refusal)
            }
        }
    }

    /// # Safety
    /// As [`Describe::check`].
    unsafe fn test(&self, mesh: impl Describe) -> Result<CullingResult, Refusal> {
        // SAFETY: the caller's contract.
        let mesh = unsafe { self.check(mesh) }?;
        Ok(self.pool.test_mesh(&mesh.mesh())?)
    }
}

/// Sets the matrix of the calling thread's later calls: 16 floats as in MOC_RenderTriangles, which are copied. Null: no
/// matrix, the vertices are in clip space. A thread that has never set a matrix or layout on this pool uses those most
/// recently set by any thread, so one thread may set them and another draw. MOC_ThreadpoolRenderMesh takes both from
/// the mesh.
///
/// Errors: MOC_STATUS_NULL_POINTER for the pool.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads. `model_to_clip` is null or can be read for 16 floats.
#[unsafe(export_name = symbol!(MOC_ThreadpoolSetMatrix))]
pub unsafe extern "C" fn MOC_ThreadpoolSetMatrix(pool: *const MOC_Threadpool, model_to_clip: *const f32) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        let (pool, matrix) = unsafe { (handle(pool)?, read(model_to_clip.cast::<[f32; 16]>())) };
        pool.state.change(|state| state.matrix = matrix);
        Ok(())
    })
}

/// Sets the vertex layout of the calling thread's later calls. Null: (16, 4, 12), packed x, y, z, w, which is wrong
/// with a matrix, because the last offset is then that of z. A thread that has never set one uses the most recent, as
/// in MOC_ThreadpoolSetMatrix.
///
/// Errors: MOC_STATUS_NULL_POINTER for the pool; MOC_STATUS_INVALID_LAYOUT for a negative stride.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads. `layout` is null or can be read.
#[unsafe(export_name = symbol!(MOC_ThreadpoolSetVertexLayout))]
pub unsafe extern "C" fn MOC_ThreadpoolSetVertexLayout(
    pool: *const MOC_Threadpool,
    layout: *const MOC_VertexLayout,
) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        let (pool, layout) = unsafe { (handle(pool)?, read(layout)) };
        let layout = layout.unwrap_or(VertexLayout::CLIP_SPACE.into());
        if layout.stride < 0 {
            return Err(Refusal::new(
                MOC_Status::MOC_STATUS_INVALID_LAYOUT,
                "the stride of the vertex layout is negative",
            ));
        }
        pool.state.change(|state| state.layout = layout);
        Ok(())
    })
}

/// MOC_ThreadpoolFlush, then clears the object's buffer: the first call of a frame. When it returns, the buffer is
/// clear, and the arrays of all earlier calls may be changed or freed.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_NO_BUFFER.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads.
#[unsafe(export_name = symbol!(MOC_ThreadpoolClearBuffer))]
pub unsafe extern "C" fn MOC_ThreadpoolClearBuffer(pool: *const MOC_Threadpool) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| unsafe { handle(pool) }?.pool.clear_buffer().because(MOC_Status::MOC_STATUS_NO_BUFFER, EMPTY))
}

/// MOC_RenderTriangles with the calling thread's matrix and vertex layout. It returns at once, like
/// MOC_ThreadpoolRenderMesh.
///
/// Errors: as MOC_RenderTriangles. Triangles dropped later are counted in the object's statistics.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads. The indices, and every vertex from the lowest to the highest index, can be read and
/// stay unchanged as those of MOC_ThreadpoolRenderMesh.
#[unsafe(export_name = symbol!(MOC_ThreadpoolRenderTriangles))]
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
        let state = handle.state.get();
        // SAFETY: the caller's contract, and a local.
        unsafe { handle.render(state.mesh(vertices, triangles, n_triangles, winding, clip_planes)) }
    })
}

/// Submits occluders and returns at once, unless more than `max_jobs` calls still read their arrays: then the calling
/// thread helps until that is no longer so. The struct, its matrix and its layout are copied. The near plane is the
/// object's.
///
/// Errors: as MOC_RenderMesh. Triangles dropped later are counted in the object's statistics.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads. `mesh` is null or can be read for the number of bytes given in its `size`, and what
/// it points to as MOC_Mesh says. The vertices and indices stay unchanged until MOC_ThreadpoolFlush,
/// MOC_ThreadpoolClearBuffer or MOC_ThreadpoolSetNearClipPlane returns, or `max_jobs` later calls do.
#[unsafe(export_name = symbol!(MOC_ThreadpoolRenderMesh))]
pub unsafe extern "C" fn MOC_ThreadpoolRenderMesh(pool: *const MOC_Threadpool, mesh: *const MOC_Mesh) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| unsafe { handle(pool)?.render(mesh) })
}

/// MOC_TestMesh against what has been drawn so far.
///
/// Errors: as there.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads and MOC_TestMesh.
#[unsafe(export_name = symbol!(MOC_ThreadpoolTestMesh))]
pub unsafe extern "C" fn MOC_ThreadpoolTestMesh(
    pool: *const MOC_Threadpool,
    mesh: *const MOC_Mesh,
    result: *mut i32,
) -> MOC_Status {
    // SAFETY: the caller's contract.
    unsafe { guard_result(result, || handle(pool)?.test(mesh)) }
}

/// MOC_TestRect against what has been drawn so far. Work that is submitted but not yet drawn hides nothing.
///
/// Errors: as there.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads. `result` is null or can be written.
#[unsafe(export_name = symbol!(MOC_ThreadpoolTestRect))]
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
        let answer = unsafe { handle(pool) }?
            .pool
            .test_rect(xmin, ymin, xmax, ymax, wmin)
            .because(MOC_Status::MOC_STATUS_NO_BUFFER, EMPTY)?;
        if answer == CullingResult::Visible {
            note("MOC_ThreadpoolTestRect", || odd_rectangle([xmin, ymin, xmax, ymax, wmin]));
        }
        Ok(answer)
    };
    // SAFETY: the caller's contract.
    unsafe { guard_result(result, query) }
}

/// MOC_TestTriangles with the calling thread's matrix and vertex layout, against what has been drawn so far.
///
/// Errors: as there.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads and MOC_TestTriangles. `result` is null or can be written.
#[unsafe(export_name = symbol!(MOC_ThreadpoolTestTriangles))]
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
        let state = handle.state.get();
        // SAFETY: the caller's contract, and a local.
        unsafe { handle.test(state.mesh(vertices, triangles, n_triangles, winding, clip_planes)) }
    };
    // SAFETY: the caller's contract.
    unsafe { guard_result(result, query) }
}

/// MOC_ComputePixelDepthBuffer for the pool's object, once everything submitted is drawn.
///
/// Errors: as there.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads and MOC_ComputePixelDepthBuffer.
#[unsafe(export_name = symbol!(MOC_ThreadpoolComputePixelDepthBuffer))]
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
        let out = |pixels| unsafe { slice_mut(out, pixels) }.map_err(Refusal::from);
        pool.with_pixels(out, flip)
            .because(MOC_Status::MOC_STATUS_NO_BUFFER, EMPTY)
            .because(MOC_Status::MOC_STATUS_INVALID_LAYOUT, "out is not aligned to 4 bytes")
    })
}

/// Merges the buffers of `count` other objects into the pool's, in order with the calls before and after it. The result
/// is that of MOC_MergeBuffers; each thread merges parts of the screen.
///
/// Errors: as there; on an error nothing is merged.
///
/// # Safety
/// As MOC_ThreadpoolWakeThreads and MOC_MergeBuffers. Nobody changes or destroys the other objects until a flushing
/// call returns.
#[unsafe(export_name = symbol!(MOC_ThreadpoolMergeBuffers))]
pub unsafe extern "C" fn MOC_ThreadpoolMergeBuffers(
    pool: *const MOC_Threadpool,
    others: *const *const MaskedOcclusionCulling,
    count: u32,
) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        let (pool, others) = unsafe { (handle(pool)?, objects(others, count)?) };
        // Merging an object with itself changes nothing, even while it is being drawn into.
        pool.pool
            .with_object(|moc| {
                let others: Vec<_> = others.iter().copied().filter(|&other| !core::ptr::eq(other, moc)).collect();
                Ok::<_, Refusal>(check_to_merge(moc, &others))
            })
            .because(MOC_Status::MOC_STATUS_NO_BUFFER, EMPTY)??;
        // SAFETY: the caller's contract.
        unsafe { pool.pool.merge_buffers(&others) }.because(MOC_Status::MOC_STATUS_NO_BUFFER, EMPTY)
    })
}
