//! Reads vertices of any layout into vectors, and projects them into the scratch.

use super::scratch::Scratch;
use crate::VertexLayout;
use crate::geometry::extent::Extent;
use crate::geometry::project::{MatrixRows, project_or_mark};
use crate::geometry::{Camera, Coverage, project};
use crate::simd::{MAX_LANES, Simd};
use crate::vertices::VertexSource;

/// How a call reads its vertices: layout and matrix, in vector form.
pub(crate) struct VertexReader<S: Simd> {
    pub s: S,
    source: VertexSource,
    packing: Packing,
    rows: Option<MatrixRows<S>>,
}

/// Layouts that load without a gather, which is measurably faster.
#[derive(Clone, Copy, PartialEq)]
enum Packing {
    /// x, y and z (or w), 12 bytes per vertex.
    Three,
    /// 16 bytes per vertex: x, y and either the third or the fourth float.
    Four {
        third: usize,
    },
    Other,
}

impl Packing {
    fn of(layout: VertexLayout) -> Self {
        match (layout.stride, layout.offset_y, layout.offset_zw) {
            (12, 4, 8) => Packing::Three,
            (16, 4, 8) => Packing::Four { third: 2 },
            (16, 4, 12) => Packing::Four { third: 3 },
            _ => Packing::Other,
        }
    }
}

impl<S: Simd> VertexReader<S> {
    #[inline(always)]
    pub fn new(s: S, source: VertexSource, matrix: Option<&[f32; 16]>) -> Self {
        Self { s, source, packing: Packing::of(source.layout), rows: matrix.map(|m| MatrixRows::new(s, m)) }
    }

    /// Distance between vertices, in bytes.
    #[inline(always)]
    pub fn stride(&self) -> usize {
        self.source.layout.stride as usize
    }

    /// Address of a vertex's x.
    #[inline(always)]
    pub fn at(&self, index: u32) -> *const u8 {
        // The stride is not negative. With 32-bit pointers the product may wrap around, as may have the caller's base
        // if the mesh does not use its first vertices.
        self.source.base.wrapping_add((index as usize).wrapping_mul(self.stride()))
    }

    /// Vertices `first` to `first + LANES` in clip space. `whole`: another vertex follows them, or the whole stride of
    /// the last one may be read.
    ///
    /// # Safety
    /// They can be read, and `whole` is true only as described.
    #[inline(always)]
    pub unsafe fn load(&self, first: u32, whole: bool) -> [S::F; 3] {
        let (s, p, layout) = (self.s, self.at(first), self.source.layout);
        let stride = self.stride();
        // SAFETY: the caller's contract; sixteen bytes of every vertex may be read if `whole`.
        let v = unsafe {
            match self.packing {
                Packing::Three => {
                    let v = s.load_triangles(p.cast());
                    [s.float_of_bits(v[0]), s.float_of_bits(v[1]), s.float_of_bits(v[2])]
                }
                Packing::Four { third } if whole => {
                    let v = s.load_quads(p.cast());
                    [v[0], v[1], if third == 2 { v[2] } else { v[3] }]
                }
                _ => [
                    s.load_strided(p, stride),
                    s.load_strided(p.offset(layout.offset_y as isize), stride),
                    s.load_strided(p.offset(layout.offset_zw as isize), stride),
                ],
            }
        };
        self.to_clip(v)
    }

    /// `count` packed vertices starting at `first`, fewer than there are lanes, in clip space; the remaining lanes are
    /// zero.
    ///
    /// # Safety
    /// They can be read.
    #[inline(always)]
    unsafe fn load_first(&self, first: u32, count: usize) -> [S::F; 3] {
        let (s, p) = (self.s, self.at(first).cast::<u32>());
        let mut words = [0; 4 * MAX_LANES];
        // Written as vectors and read back as vectors, so that store forwarding works.
        let mut copy = |n: usize, vectors: usize| {
            for k in 0..vectors {
                let at = k * S::LANES;
                // SAFETY: the caller's contract; the array holds four vectors.
                unsafe { s.store_i(words.as_mut_ptr().add(at), s.load_some(p.wrapping_add(at), n.saturating_sub(at))) };
            }
        };
        // SAFETY: the array holds four vectors.
        let v = unsafe {
            match self.packing {
                Packing::Four { third } => {
                    // Of the last vertex, nothing after its third float is read.
                    copy(4 * count - 3 + third, 4);
                    let v = s.load_quads(words.as_ptr().cast());
                    [v[0], v[1], if third == 2 { v[2] } else { v[3] }]
                }
                _ => {
                    copy(3 * count, 3);
                    s.load_triangles(words.as_ptr()).map(|v| s.float_of_bits(v))
                }
            }
        };
        self.to_clip(v)
    }

    /// `N` vertices as stored in memory, consecutively.
    ///
    /// # Safety
    /// They can be read.
    #[inline(always)]
    pub unsafe fn load_each<const N: usize>(&self, indices: [u32; N]) -> [[f32; N]; 3] {
        let mut v = [[0.0; N]; 3];
        for (lane, index) in indices.into_iter().enumerate() {
            let (p, layout) = (self.at(index), self.source.layout);
            // SAFETY: the caller's contract.
            unsafe {
                v[0][lane] = p.cast::<f32>().read_unaligned();
                v[1][lane] = p.offset(layout.offset_y as isize).cast::<f32>().read_unaligned();
                v[2][lane] = p.offset(layout.offset_zw as isize).cast::<f32>().read_unaligned();
            }
        }
        v
    }

    #[inline(always)]
    pub fn to_clip(&self, v: [S::F; 3]) -> [S::F; 3] {
        match &self.rows {
            Some(rows) => rows.apply(self.s, v),
            None => v,
        }
    }

    /// Projects `count` vertices starting at `first` into the scratch. Says whether all of them are outside the same
    /// side of the view; of fewer than a vector it does not try.
    ///
    /// # Safety
    /// They can be read; `count` is at least 1 and at most the chunk's size.
    #[inline(always)]
    pub unsafe fn dense<C: Coverage>(&self, camera: &Camera, first: u32, count: usize, scratch: &mut Scratch) -> bool {
        let s = self.s;
        if count < S::LANES && self.packing != Packing::Other {
            // SAFETY: the caller's contract.
            let [x, y, z] = unsafe { project(s, camera, self.load_first(first, count)) };
            // SAFETY: the scratch has room for a vector.
            unsafe { s.store_records(scratch.vertex(0), [x, y, z]) };
            return false;
        }
        if count < S::LANES {
            let last = count as u32 - 1;
            let indices: [u32; MAX_LANES] = core::array::from_fn(|lane| first + (lane as u32).min(last));
            // SAFETY: the caller's contract; the scratch has room for a vector.
            unsafe { self.each(camera, indices, 0, scratch) };
            return false;
        }
        let mut extent = Extent::new(s);
        let mut local = 0;
        loop {
            // SAFETY: the caller's contract; local + LANES <= count.
            unsafe {
                let clip = self.load(first + local as u32, local + S::LANES < count);
                s.store_records(scratch.vertex(local), extent.add(s, project_or_mark(s, camera, clip)));
            }
            local += S::LANES;
            if local >= count {
                break;
            }
            // The last vector ends with the last vertex and repeats some earlier ones.
            local = local.min(count - S::LANES);
        }
        extent.is_outside::<C>(s, camera)
    }

    /// Projects vertices one index at a time, for meshes with scattered indices.
    ///
    /// # Safety
    /// They can be read; there is at least one and at most a chunk's worth.
    #[inline(always)]
    pub unsafe fn sparse(&self, camera: &Camera, indices: &[u32], scratch: &mut Scratch) {
        for (k, local) in scratch.local[..indices.len()].iter_mut().enumerate() {
            local.write(k as u32);
        }
        let mut local = 0;
        while local < indices.len() {
            let group: [u32; MAX_LANES] = core::array::from_fn(|lane| indices[(local + lane).min(indices.len() - 1)]);
            // SAFETY: the caller's contract; the scratch has room for a vector after the chunk's vertices.
            unsafe { self.each(camera, group, local, scratch) };
            local += S::LANES;
        }
    }

    /// # Safety
    /// All sixteen indices refer to vertices that can be read; `local` is within the chunk.
    #[inline(always)]
    unsafe fn each(&self, camera: &Camera, indices: [u32; MAX_LANES], local: usize, scratch: &mut Scratch) {
        let s = self.s;
        // SAFETY: the caller's contract; arrays of sixteen hold a vector.
        unsafe {
            let v = self.load_each(indices);
            let v = [s.load_f(v[0].as_ptr()), s.load_f(v[1].as_ptr()), s.load_f(v[2].as_ptr())];
            let [x, y, z] = project(s, camera, self.to_clip(v));
            s.store_records(scratch.vertex(local), [x, y, z]);
        }
    }
}
