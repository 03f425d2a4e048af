//! Chunks: as many triangles as have their vertices in the scratch at a time, each vertex projected once.
//!
//! Most meshes name vertices that lie close together, and all from the least to the largest of a chunk are projected.
//! Where they lie in several places (two rows of a wide grid, say), only the pages of sixteen that are named
//! are. Where they are strewn more widely than that, corners are projected one triangle at a time.

use super::project::{Camera, Reader};
use super::scratch::{CHUNK_TRIANGLES, CHUNK_VERTICES, MAX_LANES, Scratch};
use crate::simd::{Job, Simd};

/// The least and the largest of some indices, of which there is at least one.
pub(super) struct IndexRange<'a>(pub &'a [u32]);

impl Job for IndexRange<'_> {
    type Output = (u32, u32);

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> (u32, u32) {
        index_range(s, self.0, None)
    }
}

/// Asks meanwhile for a cache line a vector of indices, from an address on.
#[inline(always)]
fn index_range<S: Simd>(s: S, indices: &[u32], vertices: Option<*const u8>) -> (u32, u32) {
    // The least is the complement of the largest complement.
    let (mut low, mut high) = (s.i(0), s.i(0));
    let mut done = 0;
    while done < indices.len() {
        let left = indices.len() - done;
        // SAFETY: no more is read than is left.
        let index = unsafe {
            let p = indices.as_ptr().add(done);
            if left >= S::LANES { s.load_i(p) } else { s.load_filled(p, left, *p) }
        };
        low = s.max_u(low, s.and_not(index, s.i(-1)));
        high = s.max_u(high, index);
        if let Some(vertices) = vertices {
            s.prefetch(vertices.wrapping_add(done / S::LANES * LINE).cast());
        }
        done += S::LANES;
    }
    (!s.largest_u(low), s.largest_u(high))
}

/// How the corners of a chunk's triangles name vertices in the scratch.
#[derive(Clone, Copy)]
pub(super) enum Numbering {
    /// As the mesh does, and vertex `base` is the first.
    From(u32),
    /// By the scratch's local numbers, from triangle `first` of the mesh on.
    Local { first: usize },
}

/// A chunk whose vertices are in the scratch.
#[derive(Clone, Copy)]
pub(super) struct Chunk {
    /// The first triangle after it.
    pub end: usize,
    pub numbering: Numbering,
    /// Where the next chunk's vertices are if they follow this one's, as most do, and how many cache lines of them to
    /// ask for with each vector of triangles.
    next_vertices: *const u8,
    lines: usize,
}

const LINE: usize = 64;

impl Chunk {
    pub const NONE: Self = Self { end: 0, numbering: Numbering::From(0), next_vertices: core::ptr::null(), lines: 0 };

    /// Asks for what the next chunk will read, a part with each vector of triangles, of which `position` is the first.
    #[inline(always)]
    pub fn prefetch_next<S: Simd>(&mut self, s: S, indices: &[u32], position: usize) {
        if self.end == indices.len() / 3 {
            return;
        }
        let next = indices.as_ptr().wrapping_add(3 * (position + CHUNK_TRIANGLES));
        for line in 0..(12 * S::LANES).div_ceil(LINE) {
            s.prefetch(next.wrapping_byte_add(line * LINE));
        }
        for _ in 0..self.lines {
            s.prefetch(self.next_vertices.cast());
            self.next_vertices = self.next_vertices.wrapping_add(LINE);
        }
    }
}

/// Projects the vertices of the next chunk.
///
/// # Safety
/// The vertices can be read; `position` is below the number of triangles.
#[inline(always)]
pub(super) unsafe fn project<S: Simd>(
    s: S,
    camera: &Camera,
    reader: &Reader<S>,
    indices: &[u32],
    position: usize,
    scratch: &mut Scratch,
) -> Chunk {
    let mut count = (indices.len() / 3 - position).min(CHUNK_TRIANGLES);
    let mut chunk = &indices[3 * position..3 * (position + count)];
    // The first chunk's vertices begin near the first index, as most do.
    let vertices = (position == 0).then(|| reader.at(chunk[0]));
    let (mut least, mut largest) = index_range(s, chunk, vertices);
    // Dense enough that most of those between are not for nothing.
    let dense = |least: u32, largest: u32, count: usize| ((largest - least) as usize) < 3 * count + MAX_LANES;
    if dense(least, largest, count) && (largest - least) as usize >= CHUNK_VERTICES {
        // Triangles that share few vertices.
        count = CHUNK_VERTICES / 3;
        chunk = &chunk[..3 * count];
        (least, largest) = index_range(s, chunk, None);
    }
    let vertices = (largest - least) as usize + 1;
    if vertices <= CHUNK_VERTICES && dense(least, largest, count) {
        // SAFETY: the caller's contract for the first and last of them; those between lie between in memory.
        unsafe { reader.dense(camera, least, vertices, scratch) };
        let (first, end) = (reader.at(least), reader.at(largest + 1));
        let lines = (end.addr() - first.addr()).div_ceil(LINE).div_ceil(count.div_ceil(S::LANES));
        let numbering = Numbering::From(least);
        return Chunk { end: position + count, numbering, next_vertices: end, lines };
    }
    // SAFETY: the caller's contract.
    let count = unsafe {
        match reader.paged(camera, chunk, (least, largest), scratch) {
            Some(count) => count,
            None => {
                let count = count.min(CHUNK_VERTICES / 3);
                reader.sparse(camera, &chunk[..3 * count], scratch);
                count
            }
        }
    };
    Chunk { end: position + count, numbering: Numbering::Local { first: position }, ..Chunk::NONE }
}
