//! Memory that begins and ends at inaccessible pages: a read or write outside an array crashes.

use std::ptr::null_mut;

/// A writable region between two inaccessible pages.
pub struct Guarded {
    writable: *mut u8,
    bytes: usize,
    page: usize,
}

impl Guarded {
    /// Room for at least `bytes`.
    pub fn new(bytes: usize) -> Self {
        // SAFETY: sysconf only returns a value.
        let page = usize::try_from(unsafe { libc::sysconf(libc::_SC_PAGESIZE) }).expect("a page size");
        let bytes = bytes.next_multiple_of(page);
        let flags = libc::MAP_PRIVATE | libc::MAP_ANONYMOUS | libc::MAP_NORESERVE;
        // SAFETY: a new anonymous mapping at an address of the system's choice.
        let base = unsafe { libc::mmap(null_mut(), bytes + 2 * page, libc::PROT_NONE, flags, -1, 0) };
        assert!(base != libc::MAP_FAILED, "no memory for a guarded region");
        // SAFETY: the first page is inside of the mapping.
        let writable = unsafe { base.cast::<u8>().add(page) };
        // SAFETY: the pages between the first and the last, which lie inside of the mapping just made.
        let status = unsafe { libc::mprotect(writable.cast(), bytes, libc::PROT_READ | libc::PROT_WRITE) };
        assert_eq!(status, 0, "the region cannot be made writable");
        Self { writable, bytes, page }
    }

    /// `len` bytes of unspecified contents that end right before an inaccessible page, or begin right after one.
    pub fn place(&mut self, len: usize, at_end: bool) -> *mut u8 {
        assert!(len <= self.bytes);
        // SAFETY: `len <= bytes`, so the offset is inside of the region.
        unsafe { self.writable.add(if at_end { self.bytes - len } else { 0 }) }
    }

    /// A copy of `data` placed in the same way. At the end, only 4-byte alignment is guaranteed.
    pub fn put<T: Copy>(&mut self, data: &[T], at_end: bool) -> *mut T {
        let len = size_of_val(data);
        let place = self.place(len, at_end);
        // SAFETY: `place` has room for `len` bytes, and `data` lies elsewhere.
        unsafe { data.as_ptr().cast::<u8>().copy_to_nonoverlapping(place, len) };
        place.cast()
    }
}

impl Drop for Guarded {
    fn drop(&mut self) {
        // SAFETY: the mapping that `new` made, with its two forbidden pages.
        unsafe { libc::munmap(self.writable.sub(self.page).cast(), self.bytes + 2 * self.page) };
    }
}
