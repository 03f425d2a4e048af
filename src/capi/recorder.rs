//! Recording frames, and reading recordings.

use core::ffi::{CStr, c_char};
use std::path::Path;

use super::mesh::{Describe, MOC_Mesh, MOC_UNCHECKED, MeshArguments};
use super::pointers::{check_out, object, read_size, slice, with_buffer, write};
use super::refusal::{Because, Refusal};
use super::status::{MOC_Status, guard};
use super::types::{self, MOC_VertexLayout};
use crate::allocator::{try_box, try_collect};
use crate::{MaskedOcclusionCulling, RecordedCall, RecordedMesh, Recording};

/// In recordings: the answer is not known.
pub const MOC_RESULT_UNKNOWN: i32 = -1;

/// The kind of a recorded call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum MOC_RecordedCallKind {
    /// MOC_RenderTriangles or MOC_RenderMesh.
    MOC_RECORDED_RENDER_TRIANGLES = 0,
    /// MOC_TestRect.
    MOC_RECORDED_TEST_RECT = 1,
    /// MOC_TestTriangles or MOC_TestMesh.
    MOC_RECORDED_TEST_TRIANGLES = 2,
    /// MOC_ClearBuffer.
    MOC_RECORDED_CLEAR_BUFFER = 3,
}

const NO_RECORDING: Refusal = Refusal::new(MOC_Status::MOC_STATUS_NULL_POINTER, "the recording is null");
const NO_CALL: Refusal = Refusal::new(MOC_Status::MOC_STATUS_INDEX_OUT_OF_RANGE, "index is not below num_calls");

/// A recording in memory; see MOC_RecordingLoad.
#[derive(Debug)]
pub struct MOC_Recording {
    recording: Recording,
    /// The layout and mesh of each call that has one, in the order of the calls. The meshes point into the recording
    /// and to the layouts, neither of which changes.
    _layouts: Vec<Option<MOC_VertexLayout>>,
    meshes: Vec<Option<MOC_Mesh>>,
}

/// The header of a recording.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct MOC_RecordingInfo {
    /// sizeof(MOC_RecordingInfo).
    pub size: u32,
    /// The near plane, in clip-space w.
    pub near_clip_plane: f32,
    /// Width of the buffer in pixels.
    pub width: u32,
    /// Height of the buffer in pixels.
    pub height: u32,
    /// Number of recorded calls.
    pub num_calls: u32,
}

/// A recorded call.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct MOC_RecordedCall {
    /// sizeof(MOC_RecordedCall).
    pub size: u32,
    /// A MOC_RecordedCallKind.
    pub kind: i32,
    /// The MOC_CullingResult that the call returned, or MOC_RESULT_UNKNOWN.
    pub result: i32,
    /// For rectangles: x_min, y_min, x_max, y_max in normalised device coordinates, and w_min. Otherwise zeros.
    pub rect: [f32; 5],
    /// For draws and tests of triangles: the mesh, for MOC_RenderMesh and MOC_TestMesh. Otherwise null. Valid until the
    /// recording is destroyed.
    pub mesh: *const MOC_Mesh,
    /// Number of floats from `mesh->vertices` on.
    pub vertex_floats: usize,
}

/// Records clears, draws and queries into a file from now on, to be read by MOC_RecordingLoad; see docs/recordings.md
/// for the format. `path` is UTF-8 on Windows, whatever the code page; on Unix its bytes are passed on unchanged.
/// Changing the near plane or the resolution ends a recording that already contains a call. Merges and triangle lists
/// are not recorded.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_NO_BUFFER, MOC_STATUS_BUSY if it is already recording, MOC_STATUS_FILE
/// if the file cannot be created, or on Windows if `path` is not UTF-8.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile; `path` is null or
/// ends with a zero.
#[unsafe(export_name = symbol!(MOC_RecorderStart))]
pub unsafe extern "C" fn MOC_RecorderStart(moc: *const MaskedOcclusionCulling, path: *const c_char) -> MOC_Status {
    // SAFETY: the caller's contract.
    let start = || -> Result<(), Refusal> {
        unsafe { with_buffer(object(moc)?)?.recorder_start(self::path(path)?).map_err(Refusal::from) }
    };
    guard(|| start().because(MOC_Status::MOC_STATUS_BUSY, "already recording"))
}

/// Ends the recording; does nothing if there is none. Destroying an object also ends its recording.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_FILE if anything could not be written, now or earlier.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile.
#[unsafe(export_name = symbol!(MOC_RecorderStop))]
pub unsafe extern "C" fn MOC_RecorderStop(moc: *const MaskedOcclusionCulling) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| unsafe { object(moc)?.recorder_stop().map_err(Refusal::from) })
}

/// Records a draw that does not go through MOC_RenderTriangles, such as that of a binned mesh. `result`: a
/// MOC_CullingResult, or MOC_RESULT_UNKNOWN. Does nothing if the object is not recording.
///
/// Errors: as MOC_RenderTriangles; on an error nothing is recorded.
///
/// # Safety
/// As MOC_RenderTriangles; other threads may use `moc` as they may during a query.
#[unsafe(export_name = symbol!(MOC_RecordRenderTriangles))]
pub unsafe extern "C" fn MOC_RecordRenderTriangles(
    moc: *const MaskedOcclusionCulling,
    vertices: *const f32,
    triangles: *const u32,
    n_triangles: i32,
    model_to_clip: *const f32,
    winding: i32,
    clip_planes: i32,
    layout: *const MOC_VertexLayout,
    result: i32,
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
    guard(|| unsafe { record(moc, mesh, result) })
}

/// MOC_RecordRenderTriangles for a mesh described by a struct.
///
/// Errors: as MOC_RenderMesh; on an error nothing is recorded.
///
/// # Safety
/// As MOC_RenderMesh; other threads may use `moc` as they may during a query.
#[unsafe(export_name = symbol!(MOC_RecordMesh))]
pub unsafe extern "C" fn MOC_RecordMesh(
    moc: *const MaskedOcclusionCulling,
    mesh: *const MOC_Mesh,
    result: i32,
) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| unsafe { record(moc, mesh, result) })
}

/// # Safety
/// As MOC_RecordRenderTriangles, and [`Describe::check`].
unsafe fn record(moc: *const MaskedOcclusionCulling, mesh: impl Describe, result: i32) -> Result<(), Refusal> {
    // SAFETY: the caller's contract.
    let moc = with_buffer(unsafe { object(moc) }?)?;
    // SAFETY: the caller's contract.
    let mesh = unsafe { mesh.check(moc) }?;
    let result = match result {
        MOC_RESULT_UNKNOWN => None,
        result => Some(types::culling_result(result)?),
    };
    moc.recorder().render_triangles(result, &mesh.mesh());
    Ok(())
}

/// Reads a recording and writes it to `out` (null on errors). `path` is as for MOC_RecorderStart: UTF-8 on Windows. The
/// caller destroys the recording with MOC_RecordingDestroy. Several threads may read from one recording at once.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_FILE if the file cannot be read, or on Windows if `path` is not UTF-8,
/// MOC_STATUS_OUT_OF_MEMORY, MOC_STATUS_INVALID_RECORDING for one that is empty, truncated or corrupt.
///
/// # Safety
/// `path` is null or ends with a zero, `out` is null or can be written.
#[unsafe(export_name = symbol!(MOC_RecordingLoad))]
pub unsafe extern "C" fn MOC_RecordingLoad(path: *const c_char, out: *mut *mut MOC_Recording) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| unsafe { load(out, || Recording::load(self::path(path)?).map_err(Refusal::from)) })
}

/// Like MOC_RecordingLoad, for a file already in memory. `bytes` may be freed once the call returns.
///
/// Errors: MOC_STATUS_NULL_POINTER if `out` is null, or `bytes` is and `size` is not 0, MOC_STATUS_INVALID_RECORDING,
/// MOC_STATUS_OUT_OF_MEMORY.
///
/// # Safety
/// `bytes` is null or can be read for `size` bytes, `out` is null or can be written.
#[unsafe(export_name = symbol!(MOC_RecordingFromMemory))]
pub unsafe extern "C" fn MOC_RecordingFromMemory(
    bytes: *const u8,
    size: usize,
    out: *mut *mut MOC_Recording,
) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| unsafe {
        load(out, || {
            Recording::from_bytes(slice(bytes, size).because(MOC_Status::MOC_STATUS_NULL_POINTER, "bytes is null")?)
                .map_err(Refusal::from)
        })
    })
}

/// Frees a recording. Null is allowed.
///
/// # Safety
/// `recording` is null or from MOC_RecordingLoad or MOC_RecordingFromMemory, and not destroyed.
#[unsafe(export_name = symbol!(MOC_RecordingDestroy))]
pub unsafe extern "C" fn MOC_RecordingDestroy(recording: *mut MOC_Recording) -> MOC_Status {
    guard(|| {
        if !recording.is_null() {
            // SAFETY: not null, and the caller's contract.
            drop(unsafe { Box::from_raw(recording) });
        }
        Ok(())
    })
}

/// Writes the header of the recording to `out`. The caller sets `out->size` to sizeof(MOC_RecordingInfo) before the
/// call.
///
/// Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_INVALID_SIZE for a `size` that is too small, and nothing is written.
///
/// # Safety
/// `recording` is null or a live one. `out` is null, or can be read and written for the number of bytes given in its
/// `size`.
#[unsafe(export_name = symbol!(MOC_RecordingGetInfo))]
pub unsafe extern "C" fn MOC_RecordingGetInfo(
    recording: *const MOC_Recording,
    out: *mut MOC_RecordingInfo,
) -> MOC_Status {
    guard(|| {
        check_out(out)?;
        // SAFETY: the caller's contract.
        let recording = unsafe { &recording.as_ref().ok_or(NO_RECORDING)?.recording };
        const SIZE: Refusal =
            Refusal::new(MOC_Status::MOC_STATUS_INVALID_SIZE, "size is less than sizeof(MOC_RecordingInfo)");
        // SAFETY: the caller's contract. The size is the first field, and nothing beyond it is read.
        let size = unsafe { read_size(out) }.filter(|&size| size >= size_of::<MOC_RecordingInfo>()).ok_or(SIZE)?;
        let info = MOC_RecordingInfo {
            size: size as u32,
            near_clip_plane: recording.near_clip_plane,
            width: recording.resolution.0,
            height: recording.resolution.1,
            num_calls: recording.calls.len() as u32,
        };
        // SAFETY: not null, and large enough according to its `size`; the caller's contract.
        unsafe { write(out, info) };
        Ok(())
    })
}

/// Writes the recorded call number `index`, counted from 0, to `out`. The caller sets `out->size` to
/// sizeof(MOC_RecordedCall) before the call. The memory that its pointers refer to belongs to the recording and is
/// freed with it.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_INDEX_OUT_OF_RANGE, MOC_STATUS_INVALID_SIZE for a `size` that is too
/// small; nothing is written.
///
/// # Safety
/// `recording` is null or a live one. `out` is null, or can be read and written for the number of bytes given in its
/// `size`.
#[unsafe(export_name = symbol!(MOC_RecordingGetCall))]
pub unsafe extern "C" fn MOC_RecordingGetCall(
    recording: *const MOC_Recording,
    index: u32,
    out: *mut MOC_RecordedCall,
) -> MOC_Status {
    guard(|| {
        check_out(out)?;
        // SAFETY: the caller's contract.
        let MOC_Recording { recording, meshes, .. } = unsafe { recording.as_ref() }.ok_or(NO_RECORDING)?;
        const SIZE: Refusal =
            Refusal::new(MOC_Status::MOC_STATUS_INVALID_SIZE, "size is less than sizeof(MOC_RecordedCall)");
        // SAFETY: the caller's contract. The size is the first field, and nothing beyond it is read.
        let size = unsafe { read_size(out) }.filter(|&size| size >= size_of::<MOC_RecordedCall>()).ok_or(SIZE)?;
        let call = recording.calls.get(index as usize).ok_or(NO_CALL)?;
        let mesh = meshes[index as usize].as_ref();
        // SAFETY: not null, and large enough according to its `size`; the caller's contract.
        unsafe { write(out, in_c(size as u32, call, mesh)) };
        Ok(())
    })
}

/// # Safety
/// `path` is null or ends with a zero.
unsafe fn path<'a>(path: *const c_char) -> Result<&'a Path, Refusal> {
    if path.is_null() {
        return Err(Refusal::new(MOC_Status::MOC_STATUS_NULL_POINTER, "path is null"));
    }
    // SAFETY: not null, and the caller's contract.
    let path = unsafe { CStr::from_ptr(path) };
    #[cfg(unix)]
    let path: &std::ffi::OsStr = std::os::unix::ffi::OsStrExt::from_bytes(path.to_bytes());
    // Not the program's or the system's code page: those cannot name every file.
    #[cfg(not(unix))]
    let path = path.to_str().map_err(|_| MOC_Status::MOC_STATUS_FILE)?;
    Ok(Path::new(path))
}

/// # Safety
/// `out` is null or can be written.
unsafe fn load(out: *mut *mut MOC_Recording, load: impl FnOnce() -> Result<Recording, Refusal>) -> Result<(), Refusal> {
    const NO_MEMORY: MOC_Status = MOC_Status::MOC_STATUS_OUT_OF_MEMORY;
    check_out(out)?;
    // SAFETY: not null, and the caller's contract.
    unsafe { write(out, core::ptr::null_mut()) };
    let recording = load()?;
    let layout = |call| recorded_mesh(call).map(|mesh| mesh.space.layout().into());
    let layouts: Vec<Option<MOC_VertexLayout>> = try_collect(recording.calls.iter().map(layout)).ok_or(NO_MEMORY)?;
    let meshes = recording.calls.iter().zip(&layouts);
    let meshes = meshes.map(|(call, layout)| Some(described(recorded_mesh(call)?, layout.as_ref()?)));
    let meshes = try_collect(meshes).ok_or(NO_MEMORY)?;
    let loaded = MOC_Recording { recording, _layouts: layouts, meshes };
    let loaded = try_box(loaded).ok_or(NO_MEMORY)?;
    // SAFETY: as above.
    unsafe { write(out, Box::into_raw(loaded)) };
    Ok(())
}

/// The mesh of a recorded call that has one.
fn recorded_mesh(call: &RecordedCall) -> Option<&RecordedMesh> {
    match call {
        RecordedCall::RenderTriangles(mesh) | RecordedCall::TestTriangles(mesh) => Some(mesh),
        RecordedCall::ClearBuffer | RecordedCall::TestRect(_) => None,
    }
}

/// A recorded mesh as a C struct that points into the recording and to its layout.
fn described(mesh: &RecordedMesh, layout: &MOC_VertexLayout) -> MOC_Mesh {
    let count = mesh.vertices().map_or(0, |vertices| vertices.len());
    MOC_Mesh {
        size: size_of::<MOC_Mesh>() as u32,
        index_size: 4,
        vertices: mesh.vertices.as_ptr(),
        indices: mesh.triangles.as_ptr().cast(),
        vertex_count: count.min(MOC_UNCHECKED as usize - 1) as u32,
        triangle_count: (mesh.triangles.len() / 3) as u32,
        model_to_clip: mesh.space.matrix().map_or(core::ptr::null(), |matrix| matrix.as_array().as_ptr()),
        layout,
        winding: mesh.options.winding as i32,
        clip_planes: mesh.options.clip_planes.bits() as i32,
    }
}

fn in_c(size: u32, call: &RecordedCall, mesh: Option<&MOC_Mesh>) -> MOC_RecordedCall {
    let (kind, rect, vertex_floats) = match call {
        RecordedCall::ClearBuffer => (MOC_RecordedCallKind::MOC_RECORDED_CLEAR_BUFFER, [0.0; 5], 0),
        RecordedCall::TestRect(rect) => {
            let [x_min, y_min, x_max, y_max] = rect.edges;
            (MOC_RecordedCallKind::MOC_RECORDED_TEST_RECT, [x_min, y_min, x_max, y_max, rect.w_min], 0)
        }
        RecordedCall::RenderTriangles(m) => {
            (MOC_RecordedCallKind::MOC_RECORDED_RENDER_TRIANGLES, [0.0; 5], m.vertices.len())
        }
        RecordedCall::TestTriangles(m) => {
            (MOC_RecordedCallKind::MOC_RECORDED_TEST_TRIANGLES, [0.0; 5], m.vertices.len())
        }
    };
    MOC_RecordedCall {
        size,
        kind: kind as i32,
        result: call.result().map_or(MOC_RESULT_UNKNOWN, |result| result as i32),
        rect,
        mesh: mesh.map_or(core::ptr::null(), core::ptr::from_ref),
        vertex_floats,
    }
}
