//! The caller's allocator: all memory of a buffer comes from it and is returned to it, and if it fails the object keeps
//! its previous state.

use core::ffi::c_void;
use core::sync::atomic::{AtomicIsize, AtomicUsize, Ordering::SeqCst};
use std::sync::Mutex;

use masked_occlusion_culling::{
    Allocator, CullingResult, DrawOptions, Error, MaskedOcclusionCulling, Settings, UpdateRule, Vertices,
};

static HELD: AtomicIsize = AtomicIsize::new(0);
static CALLS: AtomicUsize = AtomicUsize::new(0);
/// How many more allocations succeed.
static LEFT: AtomicIsize = AtomicIsize::new(isize::MAX);
/// The counters are shared: one test at a time.
static TURN: Mutex<()> = Mutex::new(());

unsafe extern "C" fn counted_alloc(alignment: usize, size: usize) -> *mut c_void {
    if LEFT.fetch_sub(1, SeqCst) <= 0 {
        return core::ptr::null_mut();
    }
    assert!(alignment.is_power_of_two());
    HELD.fetch_add(1, SeqCst);
    CALLS.fetch_add(1, SeqCst);
    let mut out = core::ptr::null_mut();
    // SAFETY: the alignment is a power of two, and `out` points to a local variable.
    let failed = unsafe { libc::posix_memalign(&mut out, alignment.max(size_of::<usize>()), size) };
    assert_eq!(failed, 0);
    out
}

unsafe extern "C" fn counted_free(ptr: *mut c_void) {
    HELD.fetch_sub(1, SeqCst);
    // SAFETY: the library passes back a pointer from `counted_alloc`.
    unsafe { libc::free(ptr) };
}

fn object(update_rule: UpdateRule) -> MaskedOcclusionCulling {
    // SAFETY: the two functions are a pair, and may be called from any thread.
    let allocator = unsafe { Allocator::from_callbacks(counted_alloc, counted_free) };
    let settings = Settings::default().with_update_rule(update_rule).with_allocator(allocator);
    MaskedOcclusionCulling::new(64, 32, settings).unwrap()
}

#[test]
fn all_that_was_taken_is_given_back() {
    let _turn = TURN.lock().unwrap();
    LEFT.store(isize::MAX, SeqCst);
    for rule in [UpdateRule::ThreeLayer, UpdateRule::Quick, UpdateRule::Accurate, UpdateRule::FourLayer] {
        let before = CALLS.load(SeqCst);
        let mut moc = object(rule);
        for size in [(64, 32), (1, 1), (1920, 1080), (1920, 1080), (7, 5)] {
            moc.set_resolution(size.0, size.1).unwrap();
        }
        assert!(CALLS.load(SeqCst) > before, "the callbacks were not asked");
        assert!(HELD.load(SeqCst) > 0);
        drop(moc);
        assert_eq!(HELD.load(SeqCst), 0);
    }
}

#[test]
fn a_failing_allocator_leaves_the_buffer() {
    let _turn = TURN.lock().unwrap();
    LEFT.store(isize::MAX, SeqCst);
    let mut moc = object(UpdateRule::ThreeLayer);
    let wall = [[-1.0, -1.0, 0.0, 1.0], [3.0, -1.0, 0.0, 1.0], [-1.0, 3.0, 0.0, 1.0]];
    moc.render_triangles(Vertices::clip_space(&wall), &[0, 1, 2], &DrawOptions::default()).unwrap();
    let held = HELD.load(SeqCst);
    // Makes each of a new buffer's allocations fail in turn.
    for left in 0.. {
        LEFT.store(left, SeqCst);
        let result = moc.set_resolution(640, 320);
        LEFT.store(isize::MAX, SeqCst);
        if result.is_ok() {
            assert!(left > 0, "a buffer without an allocation");
            break;
        }
        assert_eq!(result, Err(Error::OutOfMemory));
        assert_eq!(moc.resolution(), (64, 32));
        assert_eq!(HELD.load(SeqCst), held, "a failed resize leaks");
        assert_eq!(moc.test_rect(-1.0, -1.0, 1.0, 1.0, 2.0), CullingResult::Occluded);
    }
    drop(moc);
    assert_eq!(HELD.load(SeqCst), 0);
}
