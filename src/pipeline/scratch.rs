//! What a call needs for a moment, on its stack: the projected vertices of one chunk of triangles. Nothing is
//! allocated, nothing depends on the mesh's size, and calls from several threads do not meet.

use core::mem::MaybeUninit;

pub(super) use crate::simd::MAX_LANES;

/// Vertices of a chunk.
pub(super) const CHUNK_VERTICES: usize = 512;
/// Triangles of a chunk.
pub(super) const CHUNK_TRIANGLES: usize = 512;

/// x and y of each vertex in 1/256 pixel, whole numbers, and 1/w; or, as a NaN for x, the marks of a vertex that has to
/// be clipped. Four floats a vertex, so that a vector of corners is loaded without gathering, which was slower by a
/// tenth of a frame.
#[repr(C, align(64))]
pub(super) struct Scratch {
    vertices: [MaybeUninit<[f32; 4]>; CHUNK_VERTICES + MAX_LANES],
}

impl Scratch {
    #[inline(always)]
    pub fn uninit() -> MaybeUninit<Self> {
        MaybeUninit::uninit()
    }

    /// All of it is an array of `MaybeUninit`, so that it may be used as it comes.
    #[inline(always)]
    pub fn of(memory: &mut MaybeUninit<Self>) -> &mut Self {
        // SAFETY: every field is an array of `MaybeUninit`, which needs no initialisation.
        unsafe { memory.assume_init_mut() }
    }

    /// The address of vertex `local`'s x, which may be any number.
    #[inline(always)]
    pub fn vertex(&mut self, local: usize) -> *mut f32 {
        self.vertices.as_mut_ptr().wrapping_add(local).cast()
    }

    /// The address that vertex 0 of the mesh would have if vertex `base` is the first here.
    #[inline(always)]
    pub fn from_base(&self, base: u32) -> *const f32 {
        self.vertices.as_ptr().wrapping_sub(base as usize).cast()
    }
}
