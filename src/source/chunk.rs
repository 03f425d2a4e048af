//! Chunks: as many triangles as the scratch holds vertices for, with each vertex projected once.
//!
//! Most meshes index vertices that lie close together, and every vertex between the least and the largest index of a
//! chunk is projected. If they lie in several places (two rows of a wide grid, say), only the pages of sixteen vertices
//! that contain an index are. If they are scattered more widely than that, corners are projected one triangle at a
//! time.
//!
//! A large mesh is read once per frame, so it is seldom in the inner caches, and it is read in bursts: a chunk's
//! indices, its vertices, then nothing until the next chunk. The data of the next chunk is therefore prefetched while a
//! chunk's triangles are processed.

use super::scratch::{CHUNK_TRIANGLES, CHUNK_VERTICES, Scratch};
use super::vertex_reader::VertexReader;
use crate::geometry::{Camera, Coverage};
use crate::simd::{Job, MAX_LANES, Simd};

/// The least and the largest of a non-empty set of indices.
pub(crate) struct IndexRange<'a>(pub &'a [u32]);

impl Job for IndexRange<'_> {
    type Output = (u32, u32);

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> (u32, u32) {
        index_range(s, self.0, None)
    }
}

/// The least and the largest; with `vertices`, one cache line from that address on is prefetched with each vector of
/// indices.
#[inline(always)]
fn index_range<S: Simd>(s: S, indices: &[u32], vertices: Option<*const u8>) -> (u32, u32) {
    // The least is the complement of the largest complement.
    let (mut low, mut high) = (s.i(0), s.i(0));
    let mut done = 0;
    while done < indices.len() {
        let left = indices.len() - done;
        // SAFETY: no more is read than remains.
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

/// How the corners of a chunk's triangles refer to vertices in the scratch.
#[derive(Clone, Copy)]
pub(super) enum Numbering {
    /// By the mesh's indices; vertex `base` is the first.
    From(u32),
    /// By the scratch's local numbers, starting with triangle `first` of the mesh.
    Local { first: usize },
}

/// A chunk whose vertices are in the scratch.
#[derive(Clone, Copy)]
pub(super) struct Chunk {
    /// The first triangle after it.
    pub end: usize,
    pub numbering: Numbering,
    /// Number of vertices, if they are consecutive in the scratch and in the mesh's order; else 0.
    pub vertices: usize,
    /// All of its vertices are outside the same side of the view.
    pub outside: bool,
    /// Where the next chunk's vertices are if they follow this one's, as they usually do, and how many of their cache
    /// lines to prefetch with each vector of triangles.
    next_vertices: *const u8,
    lines: usize,
}

const LINE: usize = 64;

/// Cache lines of this many vertices for each of this many vectors of triangles. None if the vertices are more than a
/// line apart: most of the lines would not be read, and there could be very many.
#[inline(always)]
fn lines(vertices: usize, stride: usize, vectors: usize) -> usize {
    if stride > LINE { 0 } else { (vertices * stride).div_ceil(LINE).div_ceil(vectors) }
}

impl Chunk {
    pub const NONE: Self = Self {
        end: 0,
        numbering: Numbering::From(0),
        vertices: 0,
        outside: false,
        next_vertices: core::ptr::null(),
        lines: 0,
    };

    /// Prefetches a part of the next chunk's data with each vector of triangles; `position` is the first triangle of
    /// the vector.
    #[inline(always)]
    pub fn prefetch_next<S: Simd>(&mut self, s: S, indices: &[u32], position: usize) {
        if self.end == indices.len() / 3 {
            return;
        }
        let next = indices.as_ptr().wrapping_add(3 * (position + CHUNK_TRIANGLES));
        for line in 0..(size_of::<[u32; 3]>() * S::LANES).div_ceil(LINE) {
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
pub(super) unsafe fn project<S: Simd, C: Coverage>(
    s: S,
    camera: &Camera,
    reader: &VertexReader<S>,
    indices: &[u32],
    position: usize,
    scratch: &mut Scratch,
) -> Chunk {
    let mut count = (indices.len() / 3 - position).min(CHUNK_TRIANGLES);
    let mut chunk = &indices[3 * position..3 * (position + count)];
    // The first chunk's vertices usually begin near the first index.
    let vertices = (position == 0).then(|| reader.at(chunk[0]));
    let (mut least, mut largest) = index_range(s, chunk, vertices);
    // Dense enough that projecting the unused vertices in between pays off.
    let dense = |least: u32, largest: u32, count: usize| ((largest - least) as usize) < 3 * count + MAX_LANES;
    if dense(least, largest, count) && (largest - least) as usize >= CHUNK_VERTICES {
        // Triangles that share few vertices.
        count = CHUNK_VERTICES / 3;
        chunk = &chunk[..3 * count];
        (least, largest) = index_range(s, chunk, None);
    }
    if ((largest - least) as usize) < CHUNK_VERTICES && dense(least, largest, count) {
        let vertices = (largest - least) as usize + 1;
        // SAFETY: the contract of `Mesh::new`: every vertex from the lowest to the highest index can be read.
        let outside = unsafe { reader.dense::<C>(camera, least, vertices, scratch) };
        let (stride, numbering) = (reader.stride(), Numbering::From(least));
        let next_vertices = reader.at(largest).wrapping_add(stride);
        let lines = lines(vertices, stride, count.div_ceil(S::LANES));
        return Chunk { end: position + count, numbering, vertices, outside, next_vertices, lines };
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

#[cfg(test)]
mod tests {
    use super::lines;
    use crate::source::Mesh;
    use crate::source::scratch::{CHUNK_TRIANGLES, CHUNK_VERTICES};
    use crate::vertices::VertexSource;
    use crate::{
        BackfaceWinding, CullingResult, DrawOptions, Implementation, MaskedOcclusionCulling, Settings, VertexLayout,
    };

    /// A mesh in clip space, with the default options.
    ///
    /// # Safety
    /// As [`Mesh::new`].
    unsafe fn mesh(vertices: VertexSource, triangles: &[u32]) -> Mesh<'_> {
        const OPTIONS: DrawOptions = DrawOptions::new();
        // SAFETY: the caller's contract.
        unsafe { Mesh::new(vertices, None, triangles, &OPTIONS) }
    }

    #[test]
    fn what_is_asked_for_ahead_has_an_end() {
        for stride in [0, 8, 12, 16, 64, 65, 4096, i32::MAX as usize] {
            for vectors in [1, CHUNK_TRIANGLES / 16, CHUNK_TRIANGLES / 8] {
                assert!(lines(CHUNK_VERTICES, stride, vectors) <= CHUNK_VERTICES / vectors, "{stride} {vectors}");
            }
        }
        assert_eq!(lines(320, 12, 32), 2);
        assert_eq!(lines(320, 4096, 32), 0);
    }

    #[test]
    fn the_last_of_all_indices_has_no_successor() {
        // One vertex for every index, and enough triangles for several chunks.
        let vertex = [0.0_f32, 0.0, 0.0, 1.0];
        let triangles = [u32::MAX; 3 * 2000];
        let layout = VertexLayout::new(0, 4, 12);
        for &implementation in Implementation::available() {
            let settings = Settings { implementation, ..Settings::default() };
            let mut culling = MaskedOcclusionCulling::new(64, 64, settings).unwrap();
            let vertices = VertexSource { base: vertex.as_ptr().cast(), layout };
            // SAFETY: with a stride of 0 every index names the one vertex.
            let result = culling.render_mesh(&unsafe { mesh(vertices, &triangles) });
            assert_eq!(result, CullingResult::ViewCulled);
        }
    }

    #[test]
    fn the_first_and_the_last_of_all_indices_in_one_triangle() {
        let vertex = [0.0_f32, 0.0, 0.0, 1.0];
        for &implementation in Implementation::available() {
            let settings = Settings { implementation, ..Settings::default() };
            let mut culling = MaskedOcclusionCulling::new(64, 64, settings).unwrap();
            let vertices = VertexSource { base: vertex.as_ptr().cast(), layout: VertexLayout::new(0, 4, 12) };
            let triangles = [0, u32::MAX, u32::MAX / 2];
            // SAFETY: with a stride of 0 every index names the one vertex.
            let result = culling.render_mesh(&unsafe { mesh(vertices, &triangles) });
            assert_eq!(result, CullingResult::ViewCulled);
        }
    }

    /// A mesh may start at any index, so its base may lie that far before the data read: farther than a 32-bit pointer
    /// can express.
    #[test]
    fn a_base_far_before_the_first_vertex_changes_nothing() {
        let (width, height) = (200, 120);
        let grid = 40_u32;
        for (layout, floats) in [
            (VertexLayout::CLIP_SPACE, 4),
            (VertexLayout::new(12, 4, 8), 3),
            (VertexLayout::new(20, 8, 16), 5),
            (VertexLayout::new(20, 8, -4), 5),
        ] {
            // The first float leaves room for the negative offset.
            let mut data = vec![0.0_f32];
            let mut indices = Vec::new();
            for k in 0..grid * grid {
                let w = 2.0 + (k % 7) as f32 * 0.1;
                let mut vertex = vec![0.0; floats];
                vertex[0] = ((k % grid) as f32 / (grid - 1) as f32 * 1.8 - 0.9) * w;
                vertex[layout.offset_y as usize / 4] = ((k / grid) as f32 / (grid - 1) as f32 * 1.8 - 0.9) * w;
                if layout.offset_zw > 0 {
                    vertex[layout.offset_zw as usize / 4] = w;
                } else {
                    *data.last_mut().unwrap() = w;
                }
                data.extend(vertex);
                if k % grid + 1 < grid && k / grid + 1 < grid {
                    indices.extend([k, k + 1, k + grid + 1, k, k + grid + 1, k + grid]);
                }
            }
            // The whole mesh, and scattered triangles, too few for a vector.
            let scattered: Vec<u32> = indices.chunks(3).step_by(211).flatten().copied().collect();
            let few: Vec<u32> = indices[..9].to_vec();
            for (triangles, &implementation) in [&indices, &scattered, &few]
                .into_iter()
                .flat_map(|t| Implementation::available().iter().map(move |i| (t, i)))
            {
                let depth = |first: u32| {
                    let settings = Settings { implementation, ..Settings::default() };
                    let mut culling = MaskedOcclusionCulling::new(width, height, settings).unwrap();
                    let before = (first as usize).wrapping_mul(layout.stride as usize);
                    let base = data[1..].as_ptr().cast::<u8>().wrapping_sub(before);
                    let triangles: Vec<u32> = triangles.iter().map(|k| k + first).collect();
                    let options = DrawOptions { winding: BackfaceWinding::None, ..DrawOptions::default() };
                    let vertices = VertexSource { base, layout };
                    // SAFETY: the indices name the vertices of the array.
                    let mesh = unsafe { Mesh::new(vertices, None, &triangles, &options) };
                    let result = culling.render_mesh(&mesh);
                    assert_eq!(result, CullingResult::Visible);
                    let mut depth = vec![0.0; (width * height) as usize];
                    culling.compute_pixel_depth_buffer(&mut depth, false).unwrap();
                    depth
                };
                let expected = depth(0);
                for first in [1 << 28, 1 << 30, u32::MAX - grid * grid] {
                    assert!(depth(first) == expected, "{implementation:?} {layout:?} {first}");
                }
            }
        }
    }
}
