//! Triangle lists: filled by `bin_triangles`, drawn by `render_trilist`.

use core::fmt;
use core::marker::PhantomData;

/// Floats per binned triangle: x, y in 1/256 pixel and 1/w, for three vertices.
pub(crate) const FLOATS_PER_TRIANGLE: usize = 9;

/// A list of projected triangles in memory that the caller lends. The same struct as C's `MOC_TriList`.
#[repr(C)]
pub struct TriList<'a> {
    pub(crate) capacity: u32,
    pub(crate) len: u32,
    pub(crate) data: *mut f32,
    lent: PhantomData<&'a mut [f32]>,
}

// SAFETY: it is a unique borrow of a slice of floats in another form.
unsafe impl Send for TriList<'_> {}
// SAFETY: shared access only reads.
unsafe impl Sync for TriList<'_> {}

impl fmt::Debug for TriList<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TriList").field("capacity", &self.capacity).field("len", &self.len).finish_non_exhaustive()
    }
}

impl<'a> TriList<'a> {
    /// An empty list that stores up to `storage.len() / 9` triangles.
    pub fn new(storage: &'a mut [f32]) -> Self {
        let capacity = (storage.len() / FLOATS_PER_TRIANGLE).min(u32::MAX as usize) as u32;
        Self { capacity, len: 0, data: storage.as_mut_ptr(), lent: PhantomData }
    }

    /// The maximum number of triangles.
    pub fn capacity(&self) -> usize {
        self.capacity as usize
    }

    /// The number of triangles.
    pub fn len(&self) -> usize {
        self.len as usize
    }

    /// Is the list empty?
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Removes the triangles but keeps the storage.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Appends a triangle; returns false if the list is full.
    #[inline]
    pub(crate) fn push(&mut self, triangle: &[f32; FLOATS_PER_TRIANGLE]) -> bool {
        if self.len >= self.capacity || self.data.is_null() {
            return false;
        }
        // SAFETY: `len < capacity`, and `data` holds `capacity` triangles: by `new` for a list made in Rust, by the
        // contract of the C functions for one made there. Written unaligned, because the alignment of memory from C is
        // not guaranteed.
        unsafe {
            self.data
                .add(self.len as usize * FLOATS_PER_TRIANGLE)
                .cast::<[f32; FLOATS_PER_TRIANGLE]>()
                .write_unaligned(*triangle);
        }
        self.len += 1;
        true
    }

    /// The corners of a triangle: x, y and 1/w each.
    #[inline]
    pub(crate) fn get(&self, triangle: usize) -> [[f32; 3]; 3] {
        assert!(triangle < self.len() && self.len <= self.capacity && !self.data.is_null());
        // SAFETY: `triangle < len <= capacity`, and `data` holds `capacity` triangles: by `new` for a list
        // made in Rust, by the contract of the C functions for one made there. Read unaligned, as above.
        unsafe { self.data.add(triangle * FLOATS_PER_TRIANGLE).cast::<[[f32; 3]; 3]>().read_unaligned() }
    }
}
