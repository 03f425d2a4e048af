//! The allocator that an object takes all its memory from: the system's, or the caller's callbacks.

use core::ffi::c_void;
use core::ptr::NonNull;
use std::alloc::Layout;

use crate::Error;

/// Allocates `size` bytes at a multiple of `alignment`; returns null if there is no memory.
pub type AlignedAlloc = unsafe extern "C" fn(alignment: usize, size: usize) -> *mut c_void;
/// Frees memory from [`AlignedAlloc`].
pub type AlignedFree = unsafe extern "C" fn(ptr: *mut c_void);

/// Calls an [`AlignedAlloc`] on the library's behalf if the call must be guarded.
pub(crate) type CallAlloc =
    unsafe extern "C" fn(alloc: Option<AlignedAlloc>, alignment: usize, size: usize) -> *mut c_void;

/// Where an object's memory comes from.
#[derive(Clone, Copy, Debug, Default)]
pub struct Allocator {
    callbacks: Option<(AlignedAlloc, AlignedFree)>,
    call_alloc: Option<CallAlloc>,
}

impl Allocator {
    /// The system's allocator.
    pub const SYSTEM: Self = Self { callbacks: None, call_alloc: None };

    /// The caller's own allocator.
    ///
    /// # Safety
    /// `alloc` returns null, or memory of that size and alignment that nobody else uses until it is passed to `free`;
    /// both may be called from any thread that uses the object.
    pub const unsafe fn from_callbacks(alloc: AlignedAlloc, free: AlignedFree) -> Self {
        Self { callbacks: Some((alloc, free)), call_alloc: None }
    }

    /// The same, but with `alloc` called through `call`, if given.
    ///
    /// # Safety
    /// `call` returns what `alloc` returned, or null, and may be called wherever `alloc` may.
    pub(crate) const unsafe fn called_through(self, call: Option<CallAlloc>) -> Self {
        Self { call_alloc: call, ..self }
    }

    /// The callbacks, if there are any.
    pub const fn callbacks(&self) -> Option<(AlignedAlloc, AlignedFree)> {
        self.callbacks
    }

    /// Memory for `layout` (not empty); its contents are undefined.
    pub(crate) fn allocate(&self, layout: Layout) -> Result<NonNull<u8>, Error> {
        assert!(layout.size() > 0);
        let ptr = match (self.callbacks, self.call_alloc) {
            // SAFETY: the layout is not empty, by the assertion above.
            (None, _) => unsafe { std::alloc::alloc(layout) },
            // SAFETY: the caller of `from_callbacks` guarantees that the callback is valid.
            (Some((alloc, _)), None) => unsafe { alloc(layout.align(), layout.size()).cast() },
            // SAFETY: the caller of `called_through` guarantees that it is valid.
            (Some((alloc, _)), Some(call)) => unsafe { call(Some(alloc), layout.align(), layout.size()).cast() },
        };
        let ptr = NonNull::new(ptr).ok_or(Error::OutOfMemory)?;
        if !(ptr.as_ptr() as usize).is_multiple_of(layout.align()) {
            // Memory from a callback that ignores the alignment is returned to it, because every vector load relies on
            // the alignment.
            // SAFETY: allocated just above with this layout.
            unsafe { self.free(ptr, layout) };
            return Err(Error::OutOfMemory);
        }
        Ok(ptr)
    }

    /// # Safety
    /// `ptr` came from `allocate` of the same allocator with the same layout and has not been freed.
    pub(crate) unsafe fn free(&self, ptr: NonNull<u8>, layout: Layout) {
        match self.callbacks {
            // SAFETY: the caller's contract.
            None => unsafe { std::alloc::dealloc(ptr.as_ptr(), layout) },
            // SAFETY: the caller's contract, and `from_callbacks`'s.
            Some((_, free)) => unsafe { free(ptr.as_ptr().cast()) },
        }
    }
}

/// An array of words, initially zero, at a multiple of 64 bytes, from an [`Allocator`].
pub(crate) struct AlignedWords {
    ptr: NonNull<u32>,
    len: usize,
    allocator: Allocator,
}

// SAFETY: it owns its memory like a Box; `from_callbacks` requires callbacks that any thread may call.
unsafe impl Send for AlignedWords {}
// SAFETY: shared access only gives out the pointer; code that writes through it is responsible for exclusive access.
unsafe impl Sync for AlignedWords {}

impl AlignedWords {
    pub fn new(len: usize, allocator: Allocator) -> Result<Self, Error> {
        let ptr: NonNull<u32> = allocator.allocate(Self::layout(len)?)?.cast();
        // Zeroed, because vectors load whole blocks of which only a part may have been written.
        // SAFETY: allocated just above for that many words.
        unsafe { ptr.write_bytes(0, len) };
        Ok(Self { ptr, len, allocator })
    }

    fn layout(len: usize) -> Result<Layout, Error> {
        let bytes = len.checked_mul(4).ok_or(Error::OutOfMemory)?;
        // A multiple of the alignment: a callback may be C11's aligned_alloc, which requires that.
        Ok(Layout::from_size_align(bytes.max(64), 64).map_err(|_| Error::OutOfMemory)?.pad_to_align())
    }

    pub fn as_ptr(&self) -> *mut u32 {
        self.ptr.as_ptr()
    }

    pub fn len(&self) -> usize {
        self.len
    }
}

impl Drop for AlignedWords {
    fn drop(&mut self) {
        if let Ok(layout) = Self::layout(self.len) {
            // SAFETY: allocated in `new` with the same layout, freed here once.
            unsafe { self.allocator.free(self.ptr.cast(), layout) }
        }
    }
}

/// `collect` into a vector, but `None` instead of aborting the program if there is not enough memory.
#[cfg(feature = "recorder")]
pub(crate) fn try_collect<T>(items: impl ExactSizeIterator<Item = T>) -> Option<Vec<T>> {
    let mut all = Vec::new();
    all.try_reserve_exact(items.len()).ok()?;
    all.extend(items);
    Some(all)
}

/// `Box::new`, but `None` instead of aborting the program if there is not enough memory.
#[cfg(feature = "recorder")]
pub(crate) fn try_box<T>(value: T) -> Option<Box<T>> {
    let layout = Layout::new::<T>();
    assert!(layout.size() != 0);
    // SAFETY: the size is not zero. The memory is written before the box owns it, and the box frees it with this
    // layout.
    unsafe {
        let place = NonNull::new(std::alloc::alloc(layout).cast::<T>())?;
        place.write(value);
        Some(Box::from_raw(place.as_ptr()))
    }
}
