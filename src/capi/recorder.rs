//! Recording frames, and reading recordings.

use core::ffi::{CStr, c_char};
use std::path::Path;

use super::mesh::MeshArguments;
use super::pointers::{check_out, object, slice, write};
use super::refusal::{Because, Refusal};
use super::status::{MOC_Status, guard};
use super::types::{self, MOC_VertexLayout};
use crate::source::Mesh;
use crate::{DrawOptions, Error, MaskedOcclusionCulling, RecordedCall, RecordedMesh, Recording};

/// No answer is known, in recordings.
pub const MOC_RESULT_UNKNOWN: i32 = -1;

/// What a recorded call is.
#[repr(i32)]
pub enum MOC_RecordedCallKind {
    /// MOC_RenderTriangles.
    MOC_RECORDED_RENDER_TRIANGLES = 0,
    /// MOC_TestRect.
    MOC_RECORDED_TEST_RECT = 1,
    /// MOC_TestTriangles.
    MOC_RECORDED_TEST_TRIANGLES = 2,
    /// MOC_ClearBuffer.
    MOC_RECORDED_CLEAR_BUFFER = 3,
}

const NO_RECORDING: Refusal = Refusal::new(Error::NullPointer, "the recording is null");
const NO_CALL: Refusal = Refusal::new(Error::IndexOutOfRange, "index is not below num_calls");

/// A recording that was read; see MOC_RecordingLoad.
pub struct MOC_Recording {
    recording: Recording,
}

/// What a recording begins with.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct MOC_RecordingInfo {
    /// The near plane, in clip-space w.
    pub near_clip_plane: f32,
    /// In pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// How many calls were recorded.
    pub num_calls: u32,
}

/// A recorded call. What its kind does not have is zero. The pointers stay right until the recording is destroyed.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct MOC_RecordedCall {
    /// A MOC_RecordedCallKind.
    pub kind: i32,
    /// The MOC_CullingResult that was answered, or MOC_RESULT_UNKNOWN.
    pub result: i32,
    /// Of rectangles: x_min, y_min, x_max, y_max in normalised device coordinates, and w_min.
    pub rect: [f32; 5],
    /// Of meshes: the arguments of the call, and the length of the vertices in floats. The matrix is null where there is none.
    pub vertices: *const f32,
    /// As above.
    pub vertex_floats: usize,
    /// As above.
    pub triangles: *const u32,
    /// As above.
    pub n_triangles: i32,
    /// As above.
    pub model_to_clip: *const f32,
    /// As above.
    pub winding: i32,
    /// As above.
    pub clip_planes: i32,
    /// As above.
    pub layout: MOC_VertexLayout,
}

/// Records clears, draws and queries into a file from now on, to be read by MOC_RecordingLoad; see docs/recordings.md for the
/// format. `path` is UTF-8 on Windows, whatever the code page; on Unix its bytes are passed on unchanged. Setting another near
/// plane or resolution ends the recording, once it holds a call; merges and lists are not recorded.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_NO_BUFFER, MOC_STATUS_BUSY if it is already recording, MOC_STATUS_FILE if the
/// file cannot be created, or on Windows if `path` is not UTF-8.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile; `path` is null or ends with
/// a zero.
#[unsafe(export_name = symbol!(MOC_RecorderStart))]
pub unsafe extern "C" fn MOC_RecorderStart(moc: *const MaskedOcclusionCulling, path: *const c_char) -> MOC_Status {
    // SAFETY: the caller's contract.
    let start = || -> Result<(), Refusal> {
        unsafe { Ok(object(moc)?.recorder_start(self::path(path)?).map_err(Error::from)?) }
    };
    guard(|| start().because(Error::Busy, "a recording is under way already"))
}

/// Ends the recording. Nothing happens where there is none. An object that is destroyed ends its recording, too.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_FILE where something could not be written, now or before.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile.
#[unsafe(export_name = symbol!(MOC_RecorderStop))]
pub unsafe extern "C" fn MOC_RecorderStop(moc: *const MaskedOcclusionCulling) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| unsafe { Ok(object(moc)?.recorder_stop().map_err(Error::from)?) })
}

/// Records a draw that MOC_RenderTriangles is not told of, such as that of a mesh that is binned. Note the order of
/// `clip_planes` and `winding`, which is that of the class that engines know. `result`: a MOC_CullingResult, or
/// MOC_RESULT_UNKNOWN. Nothing happens while nothing is recorded.
///
/// Errors: those of MOC_RenderTriangles; nothing is recorded.
///
/// # Safety
/// That of MOC_RenderTriangles; other threads may use `moc` as they may during a query.
#[unsafe(export_name = symbol!(MOC_RecordRenderTriangles))]
pub unsafe extern "C" fn MOC_RecordRenderTriangles(
    moc: *const MaskedOcclusionCulling,
    vertices: *const f32,
    triangles: *const u32,
    n_triangles: i32,
    model_to_clip: *const f32,
    clip_planes: i32,
    winding: i32,
    layout: *const MOC_VertexLayout,
    result: i32,
) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        let moc = unsafe { object(moc) }?;
        moc.buffer()?;
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
        let mesh = unsafe { mesh.check(moc) }?;
        let result = match result {
            MOC_RESULT_UNKNOWN => None,
            result => Some(types::culling_result(result)?),
        };
        // SAFETY: the caller's contract: every vertex from the lowest to the highest index can be read.
        let mesh = unsafe { Mesh::new(mesh.vertices, mesh.triangles, &mesh.options) };
        moc.recorder().render_triangles(result, &mesh);
        Ok(())
    })
}

/// Reads a recording and writes it to `out` (null there on errors). `path` is as for MOC_RecorderStart: UTF-8 on Windows.
/// The caller gives the recording back to MOC_RecordingDestroy. Several threads may read from one recording at once.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_FILE if the file cannot be read, or on Windows if `path` is not UTF-8,
/// MOC_STATUS_OUT_OF_MEMORY, MOC_STATUS_INVALID_RECORDING for one that is empty, truncated or corrupt.
///
/// # Safety
/// `path` is null or ends with a zero, `out` is null or can be written.
#[unsafe(export_name = symbol!(MOC_RecordingLoad))]
pub unsafe extern "C" fn MOC_RecordingLoad(path: *const c_char, out: *mut *mut MOC_Recording) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| unsafe { load(out, || Ok(Recording::load(self::path(path)?).map_err(Error::from)?)) })
}

/// The same of a file that was read into memory, which is not needed afterwards.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_INVALID_RECORDING.
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
            Ok(Recording::from_bytes(slice(bytes, size).because(Error::NullPointer, "bytes is null")?)
                .map_err(Error::from)?)
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

/// Writes to `out` what the recording begins with.
///
/// Errors: MOC_STATUS_NULL_POINTER.
///
/// # Safety
/// `recording` is null or a live one, `out` is null or can be written.
#[unsafe(export_name = symbol!(MOC_RecordingGetInfo))]
pub unsafe extern "C" fn MOC_RecordingGetInfo(
    recording: *const MOC_Recording,
    out: *mut MOC_RecordingInfo,
) -> MOC_Status {
    guard(|| {
        check_out(out)?;
        // SAFETY: the caller's contract.
        let recording = unsafe { &recording.as_ref().ok_or(NO_RECORDING)?.recording };
        let info = MOC_RecordingInfo {
            near_clip_plane: recording.near_clip_plane,
            width: recording.resolution.0,
            height: recording.resolution.1,
            num_calls: recording.calls.len() as u32,
        };
        // SAFETY: not null, and the caller's contract.
        unsafe { write(out, info) };
        Ok(())
    })
}

/// Writes the call number `index` to `out`, counted from 0. What its pointers name belongs to the recording and lives as
/// long.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_INDEX_OUT_OF_RANGE.
///
/// # Safety
/// `recording` is null or a live one, `out` is null or can be written.
#[unsafe(export_name = symbol!(MOC_RecordingGetCall))]
pub unsafe extern "C" fn MOC_RecordingGetCall(
    recording: *const MOC_Recording,
    index: u32,
    out: *mut MOC_RecordedCall,
) -> MOC_Status {
    guard(|| {
        check_out(out)?;
        // SAFETY: the caller's contract.
        let MOC_Recording { recording } = unsafe { recording.as_ref() }.ok_or(NO_RECORDING)?;
        let call = recording.calls.get(index as usize).ok_or(NO_CALL)?;
        // SAFETY: not null, and the caller's contract.
        unsafe { write(out, in_c(call)) };
        Ok(())
    })
}

/// # Safety
/// `path` is null or ends with a zero.
unsafe fn path<'a>(path: *const c_char) -> Result<&'a Path, Refusal> {
    if path.is_null() {
        return Err(Refusal::new(Error::NullPointer, "path is null"));
    }
    // SAFETY: not null, and the caller's contract.
    let path = unsafe { CStr::from_ptr(path) };
    #[cfg(unix)]
    let path: &std::ffi::OsStr = std::os::unix::ffi::OsStrExt::from_bytes(path.to_bytes());
    // Not the program's or the system's code page: those cannot name every file.
    #[cfg(not(unix))]
    let path = path.to_str().map_err(|_| Error::File)?;
    Ok(Path::new(path))
}

/// # Safety
/// `out` is null or can be written.
unsafe fn load(out: *mut *mut MOC_Recording, load: impl FnOnce() -> Result<Recording, Refusal>) -> Result<(), Refusal> {
    check_out(out)?;
    // SAFETY: not null, and the caller's contract.
    unsafe { write(out, core::ptr::null_mut()) };
    let recording = load()?;
    // SAFETY: as above.
    unsafe { write(out, Box::into_raw(Box::new(MOC_Recording { recording }))) };
    Ok(())
}

fn in_c(call: &RecordedCall) -> MOC_RecordedCall {
    let plain = MOC_RecordedCall {
        kind: MOC_RecordedCallKind::MOC_RECORDED_CLEAR_BUFFER as i32,
        result: call.result().map_or(MOC_RESULT_UNKNOWN, |result| result as i32),
        rect: [0.0; 5],
        vertices: core::ptr::null(),
        vertex_floats: 0,
        triangles: core::ptr::null(),
        n_triangles: 0,
        model_to_clip: core::ptr::null(),
        winding: 0,
        clip_planes: 0,
        layout: MOC_VertexLayout { stride: 0, offset_y: 0, offset_zw: 0 },
    };
    let mesh = |kind: MOC_RecordedCallKind, mesh: &RecordedMesh| {
        let DrawOptions { model_to_clip, winding, clip_planes } = &mesh.options;
        // A matrix lies there as C has it.
        let matrix = model_to_clip.as_ref().map(AsRef::<[f32; 16]>::as_ref);
        MOC_RecordedCall {
            kind: kind as i32,
            vertices: mesh.vertices.as_ptr(),
            vertex_floats: mesh.vertices.len(),
            triangles: mesh.triangles.as_ptr(),
            n_triangles: (mesh.triangles.len() / 3) as i32,
            model_to_clip: matrix.map_or(core::ptr::null(), |matrix| matrix.as_ptr()),
            winding: *winding as i32,
            clip_planes: clip_planes.bits() as i32,
            layout: mesh.layout.into(),
            ..plain
        }
    };
    match call {
        RecordedCall::ClearBuffer => plain,
        RecordedCall::TestRect(rect) => {
            let [x_min, y_min, x_max, y_max] = rect.edges;
            let kind = MOC_RecordedCallKind::MOC_RECORDED_TEST_RECT as i32;
            MOC_RecordedCall { kind, rect: [x_min, y_min, x_max, y_max, rect.w_min], ..plain }
        }
        RecordedCall::RenderTriangles(m) => mesh(MOC_RecordedCallKind::MOC_RECORDED_RENDER_TRIANGLES, m),
        RecordedCall::TestTriangles(m) => mesh(MOC_RecordedCallKind::MOC_RECORDED_TEST_TRIANGLES, m),
    }
}
