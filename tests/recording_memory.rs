//! Loading a recording when memory runs out: an error at every allocation, and the program goes on.
#![cfg(all(feature = "capi", feature = "recorder"))]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::fs;

use masked_occlusion_culling::capi::{MOC_RecordingDestroy, MOC_RecordingFromMemory, MOC_Status};
use masked_occlusion_culling::{DrawOptions, MaskedOcclusionCulling, Recording, RecordingError, Settings, Vertices};

/// The system's allocator until this thread has used up its allowance.
struct Limited;

thread_local! {
    static ALLOWANCE: Cell<Option<usize>> = const { Cell::new(None) };
}

/// Whether the thread may allocate once more.
fn allowed() -> bool {
    ALLOWANCE
        .try_with(|allowance| match allowance.get() {
            None => true,
            Some(0) => false,
            Some(n) => {
                allowance.set(Some(n - 1));
                true
            }
        })
        .unwrap_or(true)
}

// SAFETY: every call goes to the system's allocator or returns null, as an allocator may.
unsafe impl GlobalAlloc for Limited {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: the caller's contract.
        if allowed() { unsafe { System.alloc(layout) } } else { core::ptr::null_mut() }
    }

    unsafe fn dealloc(&self, ptr: *mut u8, layout: Layout) {
        // SAFETY: the caller's contract.
        unsafe { System.dealloc(ptr, layout) }
    }

    unsafe fn realloc(&self, ptr: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller's contract.
        if allowed() { unsafe { System.realloc(ptr, layout, size) } } else { core::ptr::null_mut() }
    }
}

#[global_allocator]
static LIMITED: Limited = Limited;

fn with_allowance<R>(n: usize, what: impl FnOnce() -> R) -> R {
    ALLOWANCE.set(Some(n));
    let result = what();
    ALLOWANCE.set(None);
    result
}

/// A file with clears, draws and queries.
fn file() -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("frames.mocrec");
    let mut moc = MaskedOcclusionCulling::new(64, 64, Settings::default()).unwrap();
    moc.recorder_start(&path).unwrap();
    let wall = [[-1.0, -1.0, 0.0, 2.0], [1.0, -1.0, 0.0, 2.0], [0.0, 1.0, 0.0, 2.0]];
    for _ in 0..20 {
        moc.clear_buffer();
        moc.render_triangles(Vertices::clip_space(&wall), &[0, 1, 2], &DrawOptions::default()).unwrap();
        moc.test_triangles(Vertices::clip_space(&wall), &[0, 1, 2], &DrawOptions::default()).unwrap();
        moc.test_rect(-0.5, -0.5, 0.5, 0.5, 3.0);
    }
    moc.recorder_stop().unwrap();
    fs::read(path).unwrap()
}

#[test]
fn an_allocation_that_fails_is_an_error_in_rust() {
    let bytes = file();
    let mut failed = 0;
    loop {
        match with_allowance(failed, || Recording::from_bytes(&bytes)) {
            Ok(recording) => {
                assert_eq!(recording.calls.len(), 80);
                break;
            }
            Err(error) => assert!(matches!(error, RecordingError::OutOfMemory), "{failed}: {error}"),
        }
        failed += 1;
    }
    // A mesh takes at least its vertices, its triangles and a box.
    assert!(failed > 3 * 40, "{failed}");
}

#[test]
fn an_allocation_that_fails_is_an_error_in_c() {
    let bytes = file();
    let mut failed = 0;
    loop {
        let mut recording = core::ptr::null_mut();
        // SAFETY: the bytes can be read, and the pointer written.
        let status =
            with_allowance(failed, || unsafe { MOC_RecordingFromMemory(bytes.as_ptr(), bytes.len(), &mut recording) });
        if status == MOC_Status::MOC_STATUS_OK {
            // SAFETY: loaded above, and destroyed once.
            assert_eq!(unsafe { MOC_RecordingDestroy(recording) }, MOC_Status::MOC_STATUS_OK);
            break;
        }
        assert_eq!(status, MOC_Status::MOC_STATUS_OUT_OF_MEMORY, "{failed}");
        assert!(recording.is_null());
        failed += 1;
    }
    assert!(failed > 3 * 40, "{failed}");
}
