//! Binning triangles.

use super::lifecycle::BINS;
use super::mesh::{Describe, MOC_Mesh, MeshArguments};
use super::pointers::{check_length, object, slice_mut, with_buffer};
use super::refusal::{Because, Refusal};
use super::status::{MOC_Status, guard_result};
use super::types::{MOC_TriList, MOC_VertexLayout};
use crate::bins::FLOATS_PER_TRIANGLE;
use crate::{CullingResult, MaskedOcclusionCulling, TriList};

/// The lists of the bins, as C passes them.
struct BinArguments {
    lists: *mut MOC_TriList,
    bins_w: u32,
    bins_h: u32,
}

/// Projects triangles and appends each one that may be drawn to the list of every bin that it overlaps, to be drawn
/// later by MOC_RenderTrilist. Nothing is drawn.
///
/// `lists` is an array of `bins_w` times `bins_h` lists, row by row; the caller has set their `data`, `capacity` and
/// `count` (0 at first). The bins are those of MOC_ComputeBinWidthHeight. The other arguments are those of
/// MOC_RenderTriangles. `result` (may be null) receives MOC_VIEW_CULLED if no triangle may be drawn, otherwise
/// MOC_VISIBLE; on errors MOC_VISIBLE. Several threads may bin at once, each into its own lists.
///
/// Errors: as MOC_RenderTriangles and MOC_ComputeBinWidthHeight; MOC_STATUS_NULL_POINTER also for a list with a
/// capacity but no `data`; MOC_STATUS_INVALID_LAYOUT also if `lists` is misaligned; MOC_STATUS_INVALID_SIZE also for a
/// capacity larger than memory can hold. In all these cases nothing is binned. MOC_STATUS_LIST_FULL: a list is full;
/// the triangles that fitted are in the lists.
///
/// # Safety
/// As MOC_TestTriangles, every vertex from the lowest to the highest index included. `lists` is null or can be
/// written for `bins_w` times `bins_h` lists, and the `data` of each for 9 * `capacity` floats; nobody else uses
/// them meanwhile.
#[unsafe(export_name = symbol!(MOC_BinTriangles))]
pub unsafe extern "C" fn MOC_BinTriangles(
    moc: *const MaskedOcclusionCulling,
    vertices: *const f32,
    triangles: *const u32,
    n_triangles: i32,
    lists: *mut MOC_TriList,
    bins_w: u32,
    bins_h: u32,
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
    unsafe { guard_result(result, || bin(moc, mesh, BinArguments { lists, bins_w, bins_h })) }
}

/// As MOC_BinTriangles, with the length of the vertex array in floats: an index of a vertex that is not entirely inside
/// the array is an error, and nothing is binned.
///
/// Errors: as MOC_BinTriangles and MOC_RenderTrianglesChecked.
///
/// # Safety
/// As MOC_BinTriangles, where `vertices` can be read for `vertex_floats` floats, whatever the indices.
#[unsafe(export_name = symbol!(MOC_BinTrianglesChecked))]
pub unsafe extern "C" fn MOC_BinTrianglesChecked(
    moc: *const MaskedOcclusionCulling,
    vertices: *const f32,
    vertex_floats: usize,
    triangles: *const u32,
    n_triangles: i32,
    lists: *mut MOC_TriList,
    bins_w: u32,
    bins_h: u32,
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
    unsafe { guard_result(result, || bin(moc, mesh, BinArguments { lists, bins_w, bins_h })) }
}

/// MOC_BinTriangles or MOC_BinTrianglesChecked for a mesh described by a struct.
///
/// Errors: as those and as MOC_RenderMesh.
///
/// # Safety
/// As MOC_TestMesh. `lists` is null or can be written for `bins_w` times `bins_h` lists, and the `data` of each for
/// 9 * `capacity` floats; nobody else uses them meanwhile.
#[unsafe(export_name = symbol!(MOC_BinMesh))]
pub unsafe extern "C" fn MOC_BinMesh(
    moc: *const MaskedOcclusionCulling,
    mesh: *const MOC_Mesh,
    lists: *mut MOC_TriList,
    bins_w: u32,
    bins_h: u32,
    result: *mut i32,
) -> MOC_Status {
    // SAFETY: the caller's contract.
    unsafe { guard_result(result, || bin(moc, mesh, BinArguments { lists, bins_w, bins_h })) }
}

/// # Safety
/// As MOC_BinTriangles, and [`Describe::check`].
unsafe fn bin(
    moc: *const MaskedOcclusionCulling,
    mesh: impl Describe,
    bins: BinArguments,
) -> Result<CullingResult, Refusal> {
    let BinArguments { lists, bins_w, bins_h } = bins;
    // SAFETY: the caller's contract.
    let moc = unsafe { object(moc) }?;
    // SAFETY: the caller's contract.
    let mesh = unsafe { mesh.check(moc) }?;
    if lists.is_null() {
        return Err(Refusal::new(MOC_Status::MOC_STATUS_NULL_POINTER, "lists is null"));
    }
    // Bounds the product of the counts before any list is read.
    with_buffer(moc)?.compute_bin_size(bins_w, bins_h).because(MOC_Status::MOC_STATUS_INVALID_SIZE, BINS)?;
    let count = bins_w as usize * bins_h as usize;
    // SAFETY: the caller's contract; the two structs have the same layout.
    let lists = unsafe { slice_mut(lists.cast::<TriList<'_>>(), count) }
        .because(MOC_Status::MOC_STATUS_INVALID_LAYOUT, "lists is misaligned")?;
    if lists.iter().any(|list| list.capacity > 0 && list.data.is_null()) {
        return Err(Refusal::new(MOC_Status::MOC_STATUS_NULL_POINTER, "a list has a capacity but no data"));
    }
    lists.iter().try_for_each(|list| check_length::<[f32; FLOATS_PER_TRIANGLE]>(list.capacity as usize))?;
    Ok(moc.bin_mesh(&mesh.mesh(), lists, bins_w, bins_h)?)
}
