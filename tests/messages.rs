//! Every function that can reject a call reports it under its own name.

#![cfg(all(target_os = "linux", feature = "capi", feature = "pool", feature = "recorder"))]

mod native;

use std::collections::BTreeSet;
use std::ffi::{CStr, c_char, c_void};
use std::ptr::{null, null_mut};
use std::sync::Mutex;

use masked_occlusion_culling::capi::*;

static TOLD: Mutex<Vec<String>> = Mutex::new(Vec::new());

unsafe extern "C" fn listen(_: *mut c_void, status: i32, message: *const c_char) {
    assert_eq!(status, MOC_Status::MOC_STATUS_NULL_POINTER as i32);
    // SAFETY: the library's text is NUL-terminated.
    let message = unsafe { CStr::from_ptr(message) }.to_str().expect("a text").to_string();
    TOLD.lock().unwrap().push(message);
}

/// Calls every function with null for each pointer that must not be null.
fn call_all() {
    // SAFETY: null is rejected everywhere.
    unsafe {
        MOC_DefaultSettings(null_mut());
        MOC_Create(null(), null_mut());
        MOC_SetResolution(null_mut(), 1, 1);
        MOC_GetResolution(null(), null_mut(), null_mut());
        MOC_ComputeBinWidthHeight(null(), 1, 1, null_mut(), null_mut());
        MOC_SetNearClipPlane(null_mut(), 1.0);
        MOC_GetNearClipPlane(null(), null_mut());
        MOC_GetImplementation(null(), null_mut());
        MOC_GetUpdateRule(null(), null_mut());
        MOC_GetAllocFreeCallback(null(), null_mut(), null_mut());
        MOC_ClearBuffer(null_mut());
        MOC_MergeBuffer(null_mut(), null());
        MOC_MergeBuffers(null_mut(), null(), 1);
        MOC_RenderTriangles(null_mut(), null(), null(), 1, null(), 1, 0x1f, null(), null_mut());
        MOC_RenderTrianglesChecked(null_mut(), null(), 1, null(), 1, null(), 1, 0x1f, null(), null_mut());
        MOC_RenderMesh(null_mut(), null(), null_mut());
        MOC_TestMesh(null(), null(), null_mut());
        MOC_BinMesh(null(), null(), null_mut(), 1, 1, null_mut());
        MOC_RenderTrilist(null(), null(), null());
        MOC_TestTriangles(null(), null(), null(), 1, null(), 1, 0x1f, null(), null_mut());
        MOC_TestTrianglesChecked(null(), null(), 1, null(), 1, null(), 1, 0x1f, null(), null_mut());
        MOC_TestRect(null(), 0.0, 0.0, 1.0, 1.0, 1.0, null_mut());
        MOC_ComputePixelDepthBuffer(null(), null_mut(), 0);
        MOC_ComputePixelDepthBufferChecked(null(), null_mut(), 1, 0);
        MOC_GetStatistics(null(), null_mut());
        MOC_GetDroppedTriangles(null(), null_mut());
        MOC_BinTriangles(null(), null(), null(), 1, null_mut(), 1, 1, null(), 1, 0x1f, null(), null_mut());
        MOC_BinTrianglesChecked(null(), null(), 1, null(), 1, null_mut(), 1, 1, null(), 1, 0x1f, null(), null_mut());
        MOC_TransformVertices(null(), null(), null_mut(), 1, null());
        MOC_RecorderStart(null(), null());
        MOC_RecorderStop(null());
        MOC_RecordRenderTriangles(null(), null(), null(), 1, null(), 1, 0x1f, null(), 0);
        MOC_RecordMesh(null(), null(), 0);
        MOC_RecordingLoad(null(), null_mut());
        MOC_RecordingFromMemory(null(), 1, null_mut());
        MOC_RecordingGetInfo(null(), null_mut());
        MOC_RecordingGetCall(null(), 0, null_mut());
        MOC_Flush(null());
        MOC_ThreadpoolCreate(0, 1, 1, 1, 0, null_mut());
        MOC_ThreadpoolCreateFrom(null(), null_mut());
        MOC_ThreadpoolWorkOnce(null(), null_mut());
        MOC_ThreadpoolIsDone(null(), null_mut());
        MOC_ThreadpoolGetThreads(null(), null_mut());
        MOC_ThreadpoolGetBins(null(), null_mut(), null_mut());
        MOC_ThreadpoolRenderMesh(null(), null());
        MOC_ThreadpoolTestMesh(null(), null(), null_mut());
        MOC_ThreadpoolWakeThreads(null());
        MOC_ThreadpoolSuspendThreads(null());
        MOC_ThreadpoolFlush(null());
        MOC_ThreadpoolSetBuffer(null(), null_mut());
        MOC_ThreadpoolSetResolution(null(), 1, 1);
        MOC_ThreadpoolSetNearClipPlane(null(), 1.0);
        MOC_ThreadpoolSetMatrix(null(), null());
        MOC_ThreadpoolSetVertexLayout(null(), null());
        MOC_ThreadpoolClearBuffer(null());
        MOC_ThreadpoolRenderTriangles(null(), null(), null(), 1, 1, 0x1f);
        MOC_ThreadpoolTestRect(null(), 0.0, 0.0, 1.0, 1.0, 1.0, null_mut());
        MOC_ThreadpoolTestTriangles(null(), null(), null(), 1, 1, 0x1f, null_mut());
        MOC_ThreadpoolComputePixelDepthBuffer(null(), null_mut(), 0);
        MOC_ThreadpoolMergeBuffers(null(), null(), 1);
    }
}

#[test]
fn every_function_that_refuses_names_itself() {
    // SAFETY: the callback meets the requirements.
    unsafe { MOC_SetMessageCallback(Some(listen), null_mut()) };
    call_all();
    let told = core::mem::take(&mut *TOLD.lock().unwrap());
    let named: BTreeSet<String> = told.iter().map(|m| m.split(": ").next().unwrap().to_string()).collect();
    assert_eq!(named.len(), told.len(), "each exactly once: {told:?}");

    // Functions that never reject a call.
    let never = [
        "MOC_GetAbiVersion",
        "MOC_StatusText",
        "MOC_GetLastStatus",
        "MOC_SetMessageCallback",
        "MOC_Destroy",
        "MOC_RecordingDestroy",
        "MOC_ThreadpoolDestroy",
    ];
    let mut expected = native::exported_symbols();
    expected.retain(|name| !never.contains(&name.as_str()));
    assert_eq!(named, expected);
    assert_eq!(MOC_GetLastStatus(), MOC_Status::MOC_STATUS_NULL_POINTER as i32);
}
