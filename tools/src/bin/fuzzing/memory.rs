//! The allocator callbacks of the objects under test: they count and poison blocks, and can be made to fail.

use core::ffi::c_void;
use core::sync::atomic::{AtomicI64, AtomicU8, Ordering::Relaxed};

/// Number of live blocks.
static LIVE: AtomicI64 = AtomicI64::new(0);
static MODE: AtomicU8 = AtomicU8::new(0);
static POISON: AtomicU8 = AtomicU8::new(0);

/// What the allocator does on the next call.
#[derive(Clone, Copy)]
#[repr(u8)]
pub enum Mode {
    Works = 0,
    Fails = 1,
    Misaligns = 2,
}

pub fn set_mode(mode: Mode) {
    MODE.store(mode as u8, Relaxed);
}

pub fn live_blocks() -> i64 {
    LIVE.load(Relaxed)
}

/// The 16 bytes before the block hold the address of the system's block.
const HEADER: usize = 16;

pub unsafe extern "C" fn alloc(alignment: usize, size: usize) -> *mut c_void {
    let mode = MODE.load(Relaxed);
    if mode == Mode::Fails as u8 {
        return core::ptr::null_mut();
    }
    let before = alignment.max(HEADER);
    let mut base = core::ptr::null_mut();
    // SAFETY: `before` is a power of two of at least 16; `base` is ours to write.
    if unsafe { libc::posix_memalign(&mut base, before, before + size + HEADER) } != 0 {
        return core::ptr::null_mut();
    }
    // SAFETY: `before + size + HEADER` bytes were allocated; the block starts `before` or 4 bytes more behind
    // the base, ends inside, and has its header in front. A new poison for each block, so that what is read
    // before it is written differs between objects that should agree.
    unsafe {
        let block = base.cast::<u8>().add(before + if mode == Mode::Misaligns as u8 { 4 } else { 0 });
        block.write_bytes(POISON.fetch_add(37, Relaxed), size);
        block.sub(HEADER).cast::<*mut c_void>().write_unaligned(base);
        LIVE.fetch_add(1, Relaxed);
        block.cast()
    }
}

pub unsafe extern "C" fn free(ptr: *mut c_void) {
    if ptr.is_null() {
        return;
    }
    LIVE.fetch_sub(1, Relaxed);
    // SAFETY: `ptr` came from `alloc`, which wrote the base into the header.
    unsafe { libc::free(ptr.cast::<u8>().sub(HEADER).cast::<*mut c_void>().read_unaligned()) };
}
