//! Calls that read the buffer: tests, depth, statistics.

use super::mesh::{Describe, MOC_Mesh, MeshArguments};
use super::messages::note;
use super::pointers::{check_idle, check_out, object, read_size, slice_mut, with_buffer, write};
use super::refusal::{Because, Refusal};
use super::status::{MOC_Status, guard, guard_result, guard_result_as_set};
use super::types::{self, MOC_Statistics, MOC_VertexLayout};
use crate::float_environment::{self, in_default_environment};
use crate::{CullingResult, MaskedOcclusionCulling};

/// Tests occludees: if these triangles were drawn now, would any part of them be nearer than what was drawn, or at the
/// same depth?
///
/// The arguments are those of MOC_RenderTriangles. Every pixel that a triangle touches counts, not only those whose
/// centre it covers. `result` (may be null) receives a MOC_CullingResult. It is MOC_VIEW_CULLED if no front-facing
/// triangle touches a pixel, or if there are no triangles; MOC_OCCLUDED is also possible for triangles that touch no
/// pixel, if all the pixels around them are behind what was drawn. It is MOC_VISIBLE also for triangles with a NaN, an
/// infinite coordinate or a corner farther than 2^40, and on errors. Several threads may test at once.
///
/// The answer is for the triangles, not for what they enclose. If the bounding box of an object crosses the near plane
/// or contains the eye, its faces may be back-facing, or hidden although the object is not: treat such an object as
/// visible. If the near plane is 0 or MOC_CLIP_PLANE_NEAR is omitted, triangles that reach behind the eye within the
/// view are MOC_VISIBLE.
///
/// Errors: as MOC_RenderTriangles, except MOC_STATUS_BUSY: while a pool is drawing into the object, the query goes
/// through the pool.
///
/// # Safety
/// As MOC_RenderTriangles, every vertex from the lowest to the highest index included, but other threads may
/// query `moc` meanwhile.
#[unsafe(export_name = symbol!(MOC_TestTriangles))]
pub unsafe extern "C" fn MOC_TestTriangles(
    moc: *const MaskedOcclusionCulling,
    vertices: *const f32,
    triangles: *const u32,
    n_triangles: i32,
    model_to_clip: *const f32,
    winding: i32,
    clip_planes: i32,
    layout: *const MOC_VertexLayout,
    result: *mut i32,
) -> MOC_Status {
    let mesh = MeshArguments {
        vertices,
        vertex_floats: None,
        triangles,
        n_triangles,
        model_to_clip,
        winding,
        clip_planes,
        layout,
    };
    // SAFETY: the caller's contract.
    unsafe { guard_result(result, || test(moc, mesh)) }
}

/// As MOC_TestTriangles, with the length of the vertex array in floats: an index of a vertex that is not entirely
/// inside the array is an error.
///
/// Errors: as MOC_RenderTrianglesChecked.
///
/// # Safety
/// As MOC_RenderTrianglesChecked, but other threads may query `moc` meanwhile.
#[unsafe(export_name = symbol!(MOC_TestTrianglesChecked))]
pub unsafe extern "C" fn MOC_TestTrianglesChecked(
    moc: *const MaskedOcclusionCulling,
    vertices: *const f32,
    vertex_floats: usize,
    triangles: *const u32,
    n_triangles: i32,
    model_to_clip: *const f32,
    winding: i32,
    clip_planes: i32,
    layout: *const MOC_VertexLayout,
    result: *mut i32,
) -> MOC_Status {
    let mesh = MeshArguments {
        vertices,
        vertex_floats: Some(vertex_floats),
        triangles,
        n_triangles,
        model_to_clip,
        winding,
        clip_planes,
        layout,
    };
    // SAFETY: the caller's contract.
    unsafe { guard_result(result, || test(moc, mesh)) }
}

/// MOC_TestTriangles or MOC_TestTrianglesChecked for a mesh described by a struct.
///
/// Errors: as MOC_RenderMesh, except MOC_STATUS_BUSY.
///
/// # Safety
/// As MOC_RenderMesh, but other threads may query `moc` meanwhile.
#[unsafe(export_name = symbol!(MOC_TestMesh))]
pub unsafe extern "C" fn MOC_TestMesh(
    moc: *const MaskedOcclusionCulling,
    mesh: *const MOC_Mesh,
    result: *mut i32,
) -> MOC_Status {
    // SAFETY: the caller's contract.
    unsafe { guard_result(result, || test(moc, mesh)) }
}

/// # Safety
/// As MOC_TestTriangles, and [`Describe::check`].
unsafe fn test(moc: *const MaskedOcclusionCulling, mesh: impl Describe) -> Result<CullingResult, Refusal> {
    // SAFETY: the caller's contract.
    let moc = unsafe { object(moc) }?;
    // SAFETY: the caller's contract.
    let mesh = unsafe { mesh.check(moc) }?;
    with_buffer(moc)?;
    Ok(moc.test_mesh(&mesh.mesh()))
}

/// Tests a rectangle on the screen, such as the bounds of an object's box. docs/conventions.md has code that computes
/// one from a box.
///
/// - `xmin`, `ymin`, `xmax`, `ymax`: in normalised device coordinates (x right, y up, the screen is -1 to 1, whatever
///   the MOC_YAxis). They may be off screen or infinite. Every pixel that is touched counts.
/// - `wmin`: the clip-space w of the nearest point. Pass 0 if the object crosses the near plane.
/// - `result`: not null. MOC_VIEW_CULLED if the rectangle is off screen; MOC_OCCLUDED if all of it is behind what was
///   drawn; otherwise, and at the same depth, MOC_VISIBLE. Also MOC_VISIBLE if a number is NaN, if `wmin` is not
///   positive, if a minimum is above its maximum, and on errors. A NaN and a minimum above its maximum are reported to
///   the callback of MOC_SetMessageCallback, although the status is MOC_STATUS_OK.
///
/// Several threads may test at once.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_NO_BUFFER.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile. `result` is
/// null or can be written.
#[unsafe(export_name = symbol!(MOC_TestRect))]
pub unsafe extern "C" fn MOC_TestRect(
    moc: *const MaskedOcclusionCulling,
    xmin: f32,
    ymin: f32,
    xmax: f32,
    ymax: f32,
    wmin: f32,
    result: *mut i32,
) -> MOC_Status {
    if !float_environment::is_default() {
        // SAFETY: the caller's contract.
        return unsafe { test_rect_elsewhere(moc, (xmin, ymin), (xmax, ymax), wmin, result) };
    }
    let query = || {
        check_out(result)?;
        // SAFETY: the caller's contract.
        let answer = with_buffer(unsafe { object(moc) }?)?.test_rect(xmin, ymin, xmax, ymax, wmin);
        if answer == CullingResult::Visible {
            note("MOC_TestRect", || odd_rectangle([xmin, ymin, xmax, ymax, wmin]));
        }
        Ok(answer)
    };
    // SAFETY: the caller's contract.
    unsafe { guard_result_as_set(result, query) }
}

/// [`MOC_TestRect`] run in the default floating-point environment. It calls the exported function again, so that the
/// fast path is compiled and inlined only once: a small rectangle takes ten nanoseconds. The arguments come in pairs,
/// which are passed in registers.
///
/// # Safety
/// As there.
#[cold]
#[inline(never)]
unsafe fn test_rect_elsewhere(
    moc: *const MaskedOcclusionCulling,
    (xmin, ymin): (f32, f32),
    (xmax, ymax): (f32, f32),
    wmin: f32,
    result: *mut i32,
) -> MOC_Status {
    // SAFETY: the caller's contract.
    in_default_environment(|| unsafe { MOC_TestRect(moc, xmin, ymin, xmax, ymax, wmin, result) })
}

/// A probable mistake in a rectangle (xmin, ymin, xmax, ymax, wmin), if there is one.
pub(super) fn odd_rectangle([xmin, ymin, xmax, ymax, wmin]: [f32; 5]) -> Option<&'static str> {
    if [xmin, ymin, xmax, ymax, wmin].iter().any(|number| number.is_nan()) {
        Some("a number is NaN: the answer is MOC_VISIBLE")
    } else if xmin > xmax {
        Some("xmin is above xmax: the answer is MOC_VISIBLE")
    } else if ymin > ymax {
        Some("ymin is above ymax (y points up): the answer is MOC_VISIBLE")
    } else {
        None
    }
}

/// Writes the depth (1/w) of every pixel to `out`: width times height floats, row by row in the object's y direction,
/// negative where nothing was drawn. `flip_y` is 1 to write the last row first, 0 to write the first row first. These
/// are the depths that tests compare with, never nearer than what was drawn.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_NO_BUFFER, MOC_STATUS_BUSY while a pool is drawing into the object,
/// MOC_STATUS_INVALID_ENUM for any other `flip_y`, MOC_STATUS_INVALID_LAYOUT if `out` is not aligned to 4 bytes.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile. `out` is
/// null or can be written for width times height floats.
#[unsafe(export_name = symbol!(MOC_ComputePixelDepthBuffer))]
pub unsafe extern "C" fn MOC_ComputePixelDepthBuffer(
    moc: *const MaskedOcclusionCulling,
    out: *mut f32,
    flip_y: i32,
) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| unsafe { depth(moc, out, None, flip_y) })
}

/// As MOC_ComputePixelDepthBuffer, with the length of `out` in floats.
///
/// Errors: as MOC_ComputePixelDepthBuffer, and MOC_STATUS_INVALID_SIZE if `out` is too short.
///
/// # Safety
/// As MOC_ComputePixelDepthBuffer, where `out` can be written for `out_floats` floats.
#[unsafe(export_name = symbol!(MOC_ComputePixelDepthBufferChecked))]
pub unsafe extern "C" fn MOC_ComputePixelDepthBufferChecked(
    moc: *const MaskedOcclusionCulling,
    out: *mut f32,
    out_floats: usize,
    flip_y: i32,
) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| unsafe { depth(moc, out, Some(out_floats), flip_y) })
}

/// # Safety
/// As MOC_ComputePixelDepthBuffer; `out` is null or can be written for `floats` floats, where given.
unsafe fn depth(
    moc: *const MaskedOcclusionCulling,
    out: *mut f32,
    floats: Option<usize>,
    flip_y: i32,
) -> Result<(), Refusal> {
    // SAFETY: the caller's contract.
    let moc = unsafe { object(moc) }?;
    check_out(out)?;
    let flip_y = types::flag(flip_y, "flip_y is neither 0 nor 1")?;
    let (width, height) = with_buffer(moc)?.resolution();
    let pixels = width as usize * height as usize;
    if floats.is_some_and(|floats| floats < pixels) {
        return Err(Refusal::new(MOC_Status::MOC_STATUS_INVALID_SIZE, "out_floats is less than width times height"));
    }
    check_idle(moc)?;
    // SAFETY: at least `pixels` floats, as just checked or by the caller's contract.
    let out = unsafe { slice_mut(out, pixels) }
        .because(MOC_Status::MOC_STATUS_INVALID_LAYOUT, "out is not aligned to 4 bytes")?;
    Ok(moc.compute_pixel_depth_buffer(out, flip_y)?)
}

/// Writes the counts since the object was created; they are never reset. The caller sets `out->size` to
/// sizeof(MOC_Statistics) before the call.
///
/// Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_INVALID_SIZE for a `size` that is too small, and nothing is written.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile. `out` is null, or
/// can be read and written for the number of bytes given in its `size`.
#[unsafe(export_name = symbol!(MOC_GetStatistics))]
pub unsafe extern "C" fn MOC_GetStatistics(moc: *const MaskedOcclusionCulling, out: *mut MOC_Statistics) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        let moc = unsafe { object(moc) }?;
        check_out(out)?;
        const SIZE: Refusal =
            Refusal::new(MOC_Status::MOC_STATUS_INVALID_SIZE, "size is less than sizeof(MOC_Statistics)");
        // SAFETY: the caller's contract. The size is the first field, and nothing beyond it is read.
        let size = unsafe { read_size(out) }.filter(|&size| size >= size_of::<MOC_Statistics>()).ok_or(SIZE)?;
        // SAFETY: not null, and large enough according to its `size`; the caller's contract.
        unsafe { write(out, MOC_Statistics::new(size as u32, moc.statistics())) };
        Ok(())
    })
}

/// Writes the number of triangles dropped by draws since the object was created, because of a NaN, an infinite
/// coordinate, or a distance beyond 2^40. They are counted whether or not the settings ask for statistics.
///
/// Errors: MOC_STATUS_NULL_POINTER.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile. `out` is null or can
/// be written.
#[unsafe(export_name = symbol!(MOC_GetDroppedTriangles))]
pub unsafe extern "C" fn MOC_GetDroppedTriangles(moc: *const MaskedOcclusionCulling, out: *mut i64) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        let moc = unsafe { object(moc) }?;
        check_out(out)?;
        // SAFETY: not null, and the caller's contract.
        unsafe { write(out, moc.statistics().occluders.num_dropped_triangles) };
        Ok(())
    })
}
