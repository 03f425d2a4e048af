//! The allocator callbacks of an object, and the default pair.

use core::ffi::c_void;
use std::alloc::Layout;

use super::pointers::{check_out, object, write};
use super::status::{MOC_Status, guard};
use super::types::{MOC_AlignedAlloc, MOC_AlignedFree};
use crate::MaskedOcclusionCulling;

/// Writes the callbacks that the object was created with or, if there were none, a pair that uses the system's
/// allocator. They may still be called, and passed to other objects, after this object is destroyed. Neither pointer
/// may be null.
///
/// Errors: MOC_STATUS_NULL_POINTER.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile. `alloc` and `free`
/// are null or can be written.
#[unsafe(export_name = symbol!(MOC_GetAllocFreeCallback))]
pub unsafe extern "C" fn MOC_GetAllocFreeCallback(
    moc: *const MaskedOcclusionCulling,
    alloc: *mut MOC_AlignedAlloc,
    free: *mut MOC_AlignedFree,
) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        let moc = unsafe { object(moc) }?;
        check_out(alloc)?;
        check_out(free)?;
        let (a, f) = match moc.allocator().callbacks() {
            Some((a, f)) => (a, f),
            None => (system_alloc as _, system_free as _),
        };
        // SAFETY: not null, as just checked, and the caller's contract.
        unsafe {
            write(alloc, Some(a));
            write(free, Some(f));
        }
        Ok(())
    })
}

/// Stored before each block of [`system_alloc`], so that [`system_free`] knows its layout.
#[derive(Clone, Copy)]
struct Header {
    size: usize,
    alignment: usize,
}

unsafe extern "C" fn system_alloc(alignment: usize, size: usize) -> *mut c_void {
    let alignment = alignment.max(align_of::<Header>());
    // One alignment's worth of room before the block, or more where the header is larger.
    let before = size_of::<Header>().max(alignment);
    let Some(total) = size.checked_add(before) else { return core::ptr::null_mut() };
    let Ok(layout) = Layout::from_size_align(total, alignment) else { return core::ptr::null_mut() };
    // SAFETY: `total` is at least the size of the header, so not 0.
    let base = unsafe { std::alloc::alloc(layout) };
    if base.is_null() {
        return core::ptr::null_mut();
    }
    // SAFETY: `before` bytes from `base` are inside of the allocation; `before` is a multiple of the
    // alignment (both are powers of two), and the header fits in front.
    unsafe {
        let block = base.add(before);
        block.cast::<Header>().sub(1).write(Header { size: total, alignment });
        block.cast()
    }
}

unsafe extern "C" fn system_free(ptr: *mut c_void) {
    if ptr.is_null() {
        return;
    }
    // SAFETY: the contract of MOC_AlignedFree: `ptr` came from `system_alloc`, which wrote the header
    // and made the layout of the same two numbers.
    unsafe {
        let Header { size, alignment } = ptr.cast::<Header>().sub(1).read();
        let base = ptr.cast::<u8>().sub(size_of::<Header>().max(alignment));
        std::alloc::dealloc(base, Layout::from_size_align_unchecked(size, alignment));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn system_callbacks_align_and_take_back() {
        for alignment in [1, 2, 8, 16, 64, 4096] {
            for size in [0, 1, 63, 64, 100_000] {
                // SAFETY: freed once, with the matching callback; written only inside.
                unsafe {
                    let block = system_alloc(alignment, size);
                    assert!(!block.is_null());
                    assert_eq!(block as usize % alignment, 0);
                    block.cast::<u8>().write_bytes(0xab, size);
                    system_free(block);
                }
            }
        }
        // SAFETY: nothing is allocated, and null may be freed.
        unsafe {
            assert!(system_alloc(64, usize::MAX).is_null());
            assert!(system_alloc(3 * 64, 64).is_null());
            system_free(core::ptr::null_mut());
        }
    }
}
