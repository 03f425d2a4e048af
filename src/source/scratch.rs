//! The projected vertices of one chunk of triangles, on the stack: nothing is allocated, nothing depends on the mesh's
//! size, and threads share nothing.

use core::mem::MaybeUninit;

use crate::simd::MAX_LANES;

/// Vertices per chunk.
pub(super) const CHUNK_VERTICES: usize = 768;
/// Triangles per chunk.
pub(super) const CHUNK_TRIANGLES: usize = 512;

/// Pages of vertices that may lie between the least and the largest index of a chunk (see `pages.rs`).
pub(super) const PAGES: usize = 2048;
/// The slot of a page that is not in the scratch.
pub(super) const NOT_LOADED: u16 = u16::MAX;

/// The slot of each page in the scratch. Between chunks no page is loaded.
pub(super) struct PageTable {
    slots: [u16; PAGES],
    ready: bool,
}

impl PageTable {
    /// Only the flag has to be written before use.
    #[inline(always)]
    fn clear(table: &mut MaybeUninit<Self>) {
        // SAFETY: this only writes, it does not read.
        unsafe { (&raw mut (*table.as_mut_ptr()).ready).write(false) };
    }

    /// The table, with no page loaded.
    ///
    /// # Safety
    /// It is that of a [`Scratch`] from [`Scratch::of`].
    pub unsafe fn of(table: &mut MaybeUninit<Self>) -> &mut [u16; PAGES] {
        // SAFETY: `Scratch::of` wrote the flag, and the slots are written before they are used.
        unsafe {
            let table = table.as_mut_ptr();
            let slots = &raw mut (*table).slots;
            if !(*table).ready {
                slots.write([NOT_LOADED; PAGES]);
                (*table).ready = true;
            }
            &mut *slots
        }
    }
}

/// x and y of each vertex in 1/256 pixel, as whole numbers, and 1/w; for a vertex that needs clipping, x is a NaN that
/// carries marks. Four floats per vertex, so that a vector of corners is loaded without a gather.
#[repr(C, align(64))]
pub(crate) struct Scratch {
    vertices: [MaybeUninit<[f32; 4]>; CHUNK_VERTICES + 2 * MAX_LANES],
    /// The local numbers of the chunk's corners, unless the mesh's own order is used.
    pub local: [MaybeUninit<u32>; 3 * CHUNK_TRIANGLES],
    pub(super) table: MaybeUninit<PageTable>,
}

impl Scratch {
    #[inline(always)]
    pub fn uninit() -> MaybeUninit<Self> {
        MaybeUninit::uninit()
    }

    /// Everything in it is `MaybeUninit`, so it may be used as is.
    #[inline(always)]
    pub fn of(memory: &mut MaybeUninit<Self>) -> &mut Self {
        // SAFETY: every field is `MaybeUninit` or an array of it, which needs no initialisation.
        let scratch = unsafe { memory.assume_init_mut() };
        PageTable::clear(&mut scratch.table);
        scratch
    }

    /// The address of x of vertex `local`, which may be any number.
    #[inline(always)]
    pub fn vertex(&mut self, local: usize) -> *mut f32 {
        self.vertices.as_mut_ptr().wrapping_add(local).cast()
    }

    /// The first `n` vertices.
    ///
    /// # Safety
    /// They were written.
    #[inline(always)]
    pub unsafe fn first(&self, n: usize) -> &[[f32; 4]] {
        let vertices = &self.vertices[..n];
        // SAFETY: the caller's contract.
        unsafe { core::slice::from_raw_parts(vertices.as_ptr().cast(), n) }
    }

    /// The local numbers of the first `n` corners.
    ///
    /// # Safety
    /// They were written.
    #[inline(always)]
    pub unsafe fn local(&self, n: usize) -> &[u32] {
        let local = &self.local[..n];
        // SAFETY: the caller's contract.
        unsafe { core::slice::from_raw_parts(local.as_ptr().cast(), n) }
    }

    /// The address that vertex 0 of the mesh would have if vertex `base` were the first one here.
    #[inline(always)]
    pub fn vertex_zero(&self, base: u32) -> *const f32 {
        self.vertices.as_ptr().wrapping_sub(base as usize).cast()
    }
}
