//! Calls that change the buffer: clearing, merging, drawing triangles and lists.

use super::mesh::{Describe, MOC_Mesh, MeshArguments};
use super::pointers::{check_idle, check_length, idle_object_mut, object, objects, read, with_buffer};
use super::refusal::{Because, Refusal};
use super::status::{MOC_Status, guard, guard_result};
use super::types::{MOC_ScissorRect, MOC_TriList, MOC_VertexLayout};
use crate::bins::FLOATS_PER_TRIANGLE;
use crate::{CullingResult, MaskedOcclusionCulling, ScissorRect, TriList};

const EMPTY: &str = "one of the objects has no buffer: call MOC_SetResolution first";

/// Clears every pixel to infinitely far: the first call of a frame. It writes little more than four bytes per 32x8
/// tile.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_NO_BUFFER, MOC_STATUS_BUSY while a pool is drawing into the object.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed; no other thread uses it meanwhile.
#[unsafe(export_name = symbol!(MOC_ClearBuffer))]
pub unsafe extern "C" fn MOC_ClearBuffer(moc: *mut MaskedOcclusionCulling) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        let moc = unsafe { idle_object_mut(moc) }?;
        with_buffer(moc)?;
        moc.clear_buffer();
        Ok(())
    })
}

/// Merges the buffer of `other` into that of `moc`: afterwards `moc` hides what either of them hid, except for what its
/// few depths cannot represent, and never more. `other` is not changed. The two must have the same resolution and
/// MOC_YAxis; they may differ in instruction set and update rule. Merging an object with itself changes nothing.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_NO_BUFFER, MOC_STATUS_SIZE_MISMATCH, MOC_STATUS_BUSY while a pool is
/// drawing into either.
///
/// # Safety
/// Both are null or from MOC_Create and not destroyed. No other thread uses `moc` meanwhile, and none
/// changes `other`.
#[unsafe(export_name = symbol!(MOC_MergeBuffer))]
pub unsafe extern "C" fn MOC_MergeBuffer(
    moc: *mut MaskedOcclusionCulling,
    other: *const MaskedOcclusionCulling,
) -> MOC_Status {
    guard(|| {
        if core::ptr::eq(moc, other) {
            // SAFETY: the caller's contract. No second reference to the same object is made.
            with_buffer(unsafe { object(other) }?)?;
            return Ok(());
        }
        // SAFETY: the caller's contract, and the two are not the same.
        let moc = unsafe { idle_object_mut(moc) }?;
        // SAFETY: as above.
        let other =
            unsafe { object(other) }.because(MOC_Status::MOC_STATUS_NULL_POINTER, "the other object is null")?;
        check_to_merge(moc, &[other])?;
        Ok(moc.merge_buffer(other)?)
    })
}

/// Merges the buffers of `count` other objects into that of `moc`: the same bits as calling MOC_MergeBuffer for each of
/// them in that order, but faster. If `moc` itself is among `others`, that entry changes nothing.
///
/// Errors: as MOC_MergeBuffer, and MOC_STATUS_NULL_POINTER for a null in the array. On an error nothing is merged.
///
/// # Safety
/// `others` is null or can be read for `count` pointers. All objects are null or from MOC_Create and not destroyed.
/// No other thread uses `moc` meanwhile, and none changes the others.
#[unsafe(export_name = symbol!(MOC_MergeBuffers))]
pub unsafe extern "C" fn MOC_MergeBuffers(
    moc: *mut MaskedOcclusionCulling,
    others: *const *const MaskedOcclusionCulling,
    count: u32,
) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        let mut others = unsafe { objects(others, count) }?;
        others.retain(|&other| !core::ptr::eq(other, moc));
        // SAFETY: the caller's contract, and none of the others is the same.
        let moc = unsafe { idle_object_mut(moc) }?;
        check_to_merge(moc, &others)?;
        Ok(moc.merge_buffers(&others)?)
    })
}

/// Refuses objects that cannot currently be merged.
pub(super) fn check_to_merge(moc: &MaskedOcclusionCulling, others: &[&MaskedOcclusionCulling]) -> Result<(), Refusal> {
    let check = |other: &MaskedOcclusionCulling| {
        check_idle(other)?;
        with_buffer(other).map(|_| ())
    };
    let all = with_buffer(moc).and_then(|_| others.iter().try_for_each(|other| check(other)));
    all.because(MOC_Status::MOC_STATUS_NO_BUFFER, EMPTY)
}

/// Draws occluders: from now on they hide what is behind them. Front-to-back order is fastest and hides most.
///
/// - `vertices`: the x of the first vertex, at any address. May be null if there are no triangles.
/// - `triangles`: three indices per triangle. May be null if there are no triangles.
/// - `n_triangles`: the number of triangles, 0 or more.
/// - `model_to_clip`: 16 floats m that transform the model's x, y, z to clip space: x' = x*m[0] + y*m[4] + z*m[8] +
///   m[12], y' with m[1] m[5] m[9] m[13], w' with m[3] m[7] m[11] m[15]; m[2] m[6] m[10] m[14] are not used. OpenGL and
///   Direct3D store their matrices in this order (docs/conventions.md). Null: the vertices are in clip space.
/// - `winding`: a MOC_BackfaceWinding, of the triangle as seen on the screen.
/// - `clip_planes`: MOC_ClipPlanes. MOC_CLIP_PLANE_ALL is always correct.
/// - `layout`: where the coordinates are. Null: (16, 4, 12), packed x, y, z, w. With a matrix the last offset is that
///   of z instead of w, so null is wrong: pass (12, 4, 8) for packed x, y, z, or (16, 4, 8) for x, y, z and a fourth
///   float.
/// - `result`: may be null. Receives MOC_VIEW_CULLED if every triangle is outside the view, back-facing or dropped, or
///   if there are none; otherwise MOC_VISIBLE.
///
/// Triangles with a NaN, an infinite coordinate, or a corner farther than 2^40 are dropped; MOC_GetDroppedTriangles
/// counts them.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_INVALID_ENUM, MOC_STATUS_INVALID_SIZE for a negative count or, with
/// 32-bit pointers, more indices than memory can hold, MOC_STATUS_INVALID_LAYOUT for a negative stride or indices
/// that are not aligned to 4 bytes, MOC_STATUS_NO_BUFFER, MOC_STATUS_BUSY while a pool is drawing into the object.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed; no other thread uses it meanwhile. The indices, the
/// matrix and the layout can be read, and so can every vertex from the lowest to the highest index of the call,
/// whether or not an index names it: its x, y and w (or z), and all between in vertices of 12 or 16 bytes with
/// y at 4 and w (or z) at 8 or 12. For untrusted indices use MOC_RenderTrianglesChecked.
#[unsafe(export_name = symbol!(MOC_RenderTriangles))]
pub unsafe extern "C" fn MOC_RenderTriangles(
    moc: *mut MaskedOcclusionCulling,
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
    unsafe { guard_result(result, || render(moc, mesh)) }
}

/// As MOC_RenderTriangles, with the length of the vertex array in floats, counted from `vertices`: an index of a vertex
/// that is not entirely inside the array is an error, and nothing is drawn.
///
/// Errors: as MOC_RenderTriangles, MOC_STATUS_INDEX_OUT_OF_RANGE, and MOC_STATUS_INVALID_LAYOUT also for a negative
/// offset.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed; no other thread uses it meanwhile. `vertices` can be
/// read for `vertex_floats` floats, and so can the indices, the matrix and the layout.
#[unsafe(export_name = symbol!(MOC_RenderTrianglesChecked))]
pub unsafe extern "C" fn MOC_RenderTrianglesChecked(
    moc: *mut MaskedOcclusionCulling,
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
    unsafe { guard_result(result, || render(moc, mesh)) }
}

/// MOC_RenderTriangles or MOC_RenderTrianglesChecked for a mesh described by a struct.
///
/// Errors: as those; MOC_STATUS_NULL_POINTER for a null `mesh`, MOC_STATUS_INVALID_SIZE for a `size` that is too
/// small or a `triangle_count` above INT32_MAX, MOC_STATUS_INVALID_ENUM for an `index_size` other than 4 and 0.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed; no other thread uses it meanwhile. `mesh` is null or can be
/// read for the number of bytes given in its `size`, and what it points to as MOC_Mesh says. `result` is null or can
/// be written.
#[unsafe(export_name = symbol!(MOC_RenderMesh))]
pub unsafe extern "C" fn MOC_RenderMesh(
    moc: *mut MaskedOcclusionCulling,
    mesh: *const MOC_Mesh,
    result: *mut i32,
) -> MOC_Status {
    // SAFETY: the caller's contract.
    unsafe { guard_result(result, || render(moc, mesh)) }
}

/// # Safety
/// As MOC_RenderTriangles, and [`Describe::check`].
unsafe fn render(moc: *mut MaskedOcclusionCulling, mesh: impl Describe) -> Result<CullingResult, Refusal> {
    // SAFETY: the caller's contract.
    let moc = unsafe { idle_object_mut(moc) }?;
    // SAFETY: the caller's contract.
    let mesh = unsafe { mesh.check(moc) }?;
    with_buffer(moc)?;
    Ok(moc.render_mesh(&mesh.mesh()))
}

/// Draws a list that MOC_BinTriangles filled, inside `scissor` (null: everywhere). The list is not changed. It may be
/// drawn into any object with the same resolution and MOC_YAxis as the one that filled it.
///
/// The rectangle's x must be multiples of 32 and its y multiples of 8; max_x may also be the width of the buffer, or
/// that rounded up to a multiple of 32, and max_y the height, or that rounded up to a multiple of 8. Several threads
/// may draw into one object at once, in rectangles that do not overlap, so that each 32x8 tile belongs to one thread.
///
/// Errors: MOC_STATUS_NULL_POINTER (also for a list that is not empty but has no `data`), MOC_STATUS_NO_BUFFER,
/// MOC_STATUS_BUSY while a pool is drawing into the object, MOC_STATUS_INVALID_SIZE for any other rectangle or for a
/// list whose `count` is above its `capacity` or larger than memory can hold; MOC_STATUS_INVALID_LAYOUT if `list` is
/// misaligned. On an error nothing is drawn.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed. Meanwhile no other thread draws into an overlapping
/// rectangle of it, and none queries, merges, clears or resizes it. `list` can be read, its `data` for
/// 9 * `count` floats.
#[unsafe(export_name = symbol!(MOC_RenderTrilist))]
pub unsafe extern "C" fn MOC_RenderTrilist(
    moc: *const MaskedOcclusionCulling,
    list: *const MOC_TriList,
    scissor: *const MOC_ScissorRect,
) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract. Drawing changes the buffer through cells that any `&` may write.
        let moc = unsafe { object(moc) }?;
        if !list.is_null() && !list.is_aligned() {
            return Err(Refusal::new(MOC_Status::MOC_STATUS_INVALID_LAYOUT, "the list is misaligned"));
        }
        const NO_LIST: Refusal = Refusal::new(MOC_Status::MOC_STATUS_NULL_POINTER, "the list is null");
        // SAFETY: null or aligned; the caller's contract; the two structs are laid out the same.
        let list = unsafe { list.cast::<TriList<'_>>().as_ref() }.ok_or(NO_LIST)?;
        if list.len > list.capacity {
            return Err(Refusal::new(MOC_Status::MOC_STATUS_INVALID_SIZE, "the list has a count above its capacity"));
        }
        if list.len > 0 && list.data.is_null() {
            return Err(Refusal::new(MOC_Status::MOC_STATUS_NULL_POINTER, "the list has triangles but no data"));
        }
        check_length::<[f32; FLOATS_PER_TRIANGLE]>(list.len as usize)?;
        check_idle(moc)?;
        with_buffer(moc)?;
        // SAFETY: the caller's contract.
        let scissor = unsafe { read(scissor) }.map(ScissorRect::from);
        // SAFETY: the caller's contract: exclusive inside of the rectangle.
        unsafe { moc.render_trilist_shared(list, scissor) }.because(
            MOC_Status::MOC_STATUS_INVALID_SIZE,
            "the scissor rectangle is empty, outside the buffer, or not in multiples of 32 and 8 pixels",
        )
    })
}
