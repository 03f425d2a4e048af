//! What a call needs for a moment, on its stack: the projected vertices of one chunk of triangles and the
//! triangles that survive. Nothing is allocated, nothing depends on the
//! mesh's size, and calls from several threads do not meet.

use core::mem::MaybeUninit;

/// Vertices of a chunk: the triangle's three local numbers share a word, ten bits each.
pub(super) const LOCAL_BITS: i32 = 10;
const VERTICES: usize = 1 << LOCAL_BITS;
/// Of those, the last are kept for vertices that clipping makes.
pub(super) const CLIPPED_VERTICES: usize = 192;
pub(super) const CHUNK_VERTICES: usize = VERTICES - CLIPPED_VERTICES;
/// Triangles of a chunk.
pub(super) const CHUNK_TRIANGLES: usize = 512;
/// Survivors of a chunk and of clipping.
pub(super) const SURVIVORS: usize = CHUNK_TRIANGLES + 2 * CLIPPED_VERTICES;
pub(super) use crate::simd::MAX_LANES;

#[repr(C, align(64))]
pub(super) struct Scratch {
    /// x of each vertex in 1/256 pixel, a whole number; or, as a NaN, the marks of a vertex that has to be clipped.
    pub x: [MaybeUninit<f32>; VERTICES + MAX_LANES],
    /// y likewise.
    pub y: [MaybeUninit<f32>; VERTICES + MAX_LANES],
    /// 1/w.
    pub z: [MaybeUninit<f32>; VERTICES + MAX_LANES],
    /// Surviving triangles: the local numbers of their corners.
    pub survivors: [MaybeUninit<u32>; SURVIVORS + MAX_LANES],
}

impl Scratch {
    #[inline(always)]
    pub fn uninit() -> MaybeUninit<Self> {
        MaybeUninit::uninit()
    }

    /// All of it is arrays of `MaybeUninit`, so that it may be used as it comes.
    #[inline(always)]
    pub fn of(memory: &mut MaybeUninit<Self>) -> &mut Self {
        // SAFETY: every field is an array of `MaybeUninit`, which needs no initialisation.
        unsafe { memory.assume_init_mut() }
    }

    /// Puts a vertex where clipping or a list wants it.
    #[inline(always)]
    pub fn set_vertex(&mut self, local: usize, [x, y, z]: [f32; 3]) {
        self.x[local].write(x);
        self.y[local].write(y);
        self.z[local].write(z);
    }

    /// Repeats the last of `len` survivors, so that a vector loaded from anywhere among them is written memory.
    #[inline(always)]
    pub fn pad(&mut self, len: usize) {
        if len > 0 {
            let last = self.survivors[len - 1];
            self.survivors[len..len + MAX_LANES].fill(last);
        }
    }
}

/// Three local numbers in a word.
#[inline(always)]
pub(super) fn pack([a, b, c]: [u32; 3]) -> u32 {
    debug_assert!((a | b | c) < VERTICES as u32);
    a | b << LOCAL_BITS | c << (2 * LOCAL_BITS)
}
