//! Vertices to the screen: transform, divide, snap to 1/256 pixel, mark what has to be clipped.
//!
//! A vertex is regular when it lies between the near plane and 2^40 and within a guard band around the screen:
//! some 250,000 pixels for draws, whose coverage is exact for whatever snapped coordinates come out; 16,384 pixels
//! for queries, which have to bound where the true vertex is, and so need f32 to be finer than a subpixel. Of the
//! others, x becomes a NaN that carries outcodes, so that a whole triangle outside of one plane still dies in a vector.
//!
//! Depths 1/w between 2^-40 and 2^40 keep every later product of depths and coordinates out of the
//! denormal numbers: the bits do not depend on whether the processor flushes those.

use super::scratch::Scratch;
use crate::simd::Simd;
use crate::vertices::VertexSource;
use crate::{VertexLayout, YAxis};

/// Nearer than this nothing is projected, whatever the near plane.
pub(super) const NEAREST_W: f32 = 1.0 / (1 << 30) as f32;
/// Occluders farther than this are dropped; occludees count as being there.
pub(super) const FARTHEST_W: f32 = (1_u64 << 40) as f32;
/// The guard band of draws: how far from the screen's centre a vertex may lie, in 1/256 pixel. With the largest
/// screen's centre added it stays below 2^26.
pub(super) const GUARD_BAND: f32 = ((1 << 26) - (1 << 21)) as f32;
/// The guard band of queries. Four roundings of numbers below 2^23 and the snap move a vertex by less than 1.6
/// subpixels.
const QUERY_GUARD_BAND: f32 = (1 << 22) as f32;

/// How far, in 1/256 pixel, two snapped vertices of a query may have moved against each other.
pub(super) const SHIFT: f32 = 4.0;

/// Outcodes of a vertex, the low bits of a marked x.
pub(super) mod outcode {
    pub const NEAR: u32 = 1;
    pub const LEFT: u32 = 2;
    pub const RIGHT: u32 = 4;
    pub const BELOW: u32 = 8;
    pub const ABOVE: u32 = 16;
    pub const ALL: u32 = 31;
    /// What marks carry besides.
    pub const MARK: u32 = 0x7fc0_0000;
}

/// From clip space to the screen of a buffer.
#[derive(Clone, Copy)]
pub(crate) struct Camera {
    /// Half the width, in 1/256 pixel.
    pub half_width: f32,
    /// Half the height, in 1/256 pixel; positive.
    pub half_height: f32,
    /// y of normalised device coordinates to rows: minus half the height where rows run down.
    pub row_scale: f32,
    /// The near plane, at least [`NEAREST_W`].
    pub near: f32,
    /// How far from the screen's centre a vertex may lie, in 1/256 pixel.
    pub guard_band: f32,
    /// Is the near plane closer than can be projected? Then a query may not rely on what clipping removes.
    pub near_is_raised: bool,
}

impl Camera {
    pub fn new(width: u32, height: u32, y_axis: YAxis, near: f32) -> Self {
        let (half_width, half_height) = (width as f32 * 128.0, height as f32 * 128.0);
        Self {
            half_width,
            half_height,
            row_scale: if y_axis == YAxis::Down { -half_height } else { half_height },
            near: near.max(NEAREST_W),
            guard_band: GUARD_BAND,
            near_is_raised: near < NEAREST_W,
        }
    }

    /// The same for a query.
    pub fn for_queries(self) -> Self {
        Self { guard_band: QUERY_GUARD_BAND, ..self }
    }

    pub fn rows_run_down(&self) -> bool {
        self.row_scale < 0.0
    }
}

/// A matrix, an element a vector: the rows for x, y and w.
pub(super) struct Rows<S: Simd>([[S::F; 4]; 3]);

impl<S: Simd> Rows<S> {
    #[inline(always)]
    pub fn new(s: S, m: &[f32; 16]) -> Self {
        let row = |r: usize| [s.f(m[r]), s.f(m[4 + r]), s.f(m[8 + r]), s.f(m[12 + r])];
        Self([row(0), row(1), row(3)])
    }

    /// (x, y, z, 1) to clip-space x, y, w.
    #[inline(always)]
    pub fn apply(&self, s: S, [x, y, z]: [S::F; 3]) -> [S::F; 3] {
        [dot(s, &self.0[0], x, y, z), dot(s, &self.0[1], x, y, z), dot(s, &self.0[2], x, y, z)]
    }
}

/// A row of a matrix times (x, y, z, 1). Written once, so that every path rounds alike.
#[inline(always)]
fn dot<S: Simd>(s: S, row: &[S::F; 4], x: S::F, y: S::F, z: S::F) -> S::F {
    s.add(s.add(s.mul(x, row[0]), s.mul(y, row[1])), s.add(s.mul(z, row[2]), row[3]))
}

/// Clip space (x, y, w) to the screen: x and y in 1/256 pixel, and 1/w; or marks.
#[inline(always)]
pub(super) fn project<S: Simd>(s: S, camera: &Camera, [x, y, w]: [S::F; 3]) -> [S::F; 3] {
    let z = s.div(s.f(1.0), w);
    let across = s.mul(s.mul(x, z), s.f(camera.half_width));
    let down = s.mul(s.mul(y, z), s.f(camera.row_scale));
    let in_range = s.and_m(s.le(s.f(camera.near), w), s.le(w, s.f(FARTHEST_W)));
    let in_band = s.and_m(s.le(s.abs(across), s.f(camera.guard_band)), s.le(s.abs(down), s.f(camera.guard_band)));
    let regular = s.and_m(in_range, in_band);
    let column = s.to_f(s.round(s.add(across, s.f(camera.half_width))));
    let row = s.to_f(s.round(s.add(down, s.f(camera.half_height))));
    if s.all(regular) {
        return [column, row, z];
    }
    let minus_w = s.sub(s.f(0.0), w);
    let mut marks = s.or(bit_where(s, s.lt(w, s.f(camera.near)), outcode::NEAR), s.i(outcode::MARK as i32));
    marks = s.or(marks, s.or(bit_where(s, s.lt(x, minus_w), outcode::LEFT), bit_where(s, s.lt(w, x), outcode::RIGHT)));
    marks = s.or(marks, s.or(bit_where(s, s.lt(y, minus_w), outcode::BELOW), bit_where(s, s.lt(w, y), outcode::ABOVE)));
    // What is not finite is outside of nothing: it is counted, or seen, where triangles are clipped.
    let largest = s.max(s.max(s.abs(x), s.abs(y)), s.abs(w));
    let finite = s.and_m(s.le(largest, s.f(f32::MAX)), s.and_m(s.eq(x, x), s.eq(y, y)));
    marks = s.select_i(finite, marks, s.i(outcode::MARK as i32));
    [s.select(regular, column, s.float_of_bits(marks)), s.select(regular, row, s.f(0.0)), z]
}

/// A bit in the lanes of a mask.
#[inline(always)]
pub(super) fn bit_where<S: Simd>(s: S, m: S::M, bit: u32) -> S::I {
    s.select_i(m, s.i(bit as i32), s.i(0))
}

/// How a call reads its vertices: layout and matrix, ready for vectors.
pub(super) struct Reader<S: Simd> {
    pub s: S,
    source: VertexSource,
    packing: Packing,
    rows: Option<Rows<S>>,
}

/// Layouts that vectors load without gathering: with gathers, a sixth of a frame's time went there.
#[derive(Clone, Copy, PartialEq)]
enum Packing {
    /// x, y and z (or w), 12 bytes a vertex.
    Three,
    /// 16 bytes a vertex, of which the third or the fourth float counts besides x and y.
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

impl<S: Simd> Reader<S> {
    #[inline(always)]
    pub fn new(s: S, source: VertexSource, matrix: Option<&[f32; 16]>) -> Self {
        Self { s, source, packing: Packing::of(source.layout), rows: matrix.map(|m| Rows::new(s, m)) }
    }

    /// From vertex to vertex, in bytes.
    #[inline(always)]
    pub fn stride(&self) -> usize {
        self.source.layout.stride as usize
    }

    /// Address of x of a vertex.
    #[inline(always)]
    pub fn at(&self, index: u32) -> *const u8 {
        // The stride is not negative. With 32-bit pointers the product may wrap around, and so may the caller's base have, if
        // the mesh does not use its first vertices.
        self.source.base.wrapping_add((index as usize).wrapping_mul(self.stride()))
    }

    /// Vertices `first` to `first + LANES` in clip space. `whole`: another vertex follows them, or all of a stride
    /// may be read of the last.
    ///
    /// # Safety
    /// They can be read, and what `whole` says is so.
    #[inline(always)]
    pub unsafe fn load(&self, first: u32, whole: bool) -> [S::F; 3] {
        let (s, p, layout) = (self.s, self.at(first), self.source.layout);
        let stride = self.stride();
        // SAFETY: the caller's contract; sixteen bytes of every vertex may be read where `whole` says so.
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

    /// `count` packed vertices from `first` on, fewer than there are lanes, in clip space; those after them are zeros.
    ///
    /// # Safety
    /// They can be read.
    #[inline(always)]
    unsafe fn load_first(&self, first: u32, count: usize) -> [S::F; 3] {
        const MAX_LANES: usize = super::scratch::MAX_LANES;
        let (s, p) = (self.s, self.at(first).cast::<u32>());
        let mut words = [0; 4 * MAX_LANES];
        // What is written here is read as vectors again, so that neither has to wait for single words.
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
                    // Of the last vertex no more than its third float.
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

    /// `N` vertices as they lie in memory, one after the other.
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

    /// Projects `count` vertices from `first` on into the scratch.
    ///
    /// # Safety
    /// They can be read; `count` is from 1 to the chunk's size.
    #[inline(always)]
    pub unsafe fn dense(&self, camera: &Camera, first: u32, count: usize, scratch: &mut Scratch) {
        let s = self.s;
        if count < S::LANES && self.packing != Packing::Other {
            // SAFETY: the caller's contract.
            let [x, y, z] = unsafe { project(s, camera, self.load_first(first, count)) };
            // SAFETY: the scratch has room for a vector.
            return unsafe { s.store_records(scratch.vertex(0), [x, y, z]) };
        }
        if count < S::LANES {
            let last = count as u32 - 1;
            let indices: [u32; super::scratch::MAX_LANES] =
                core::array::from_fn(|lane| first + (lane as u32).min(last));
            // SAFETY: the caller's contract; the scratch has room for a vector.
            return unsafe { self.each(camera, indices, 0, scratch) };
        }
        let mut local = 0;
        loop {
            // SAFETY: the caller's contract; local + LANES <= count.
            unsafe {
                let [x, y, z] = project(s, camera, self.load(first + local as u32, local + S::LANES < count));
                s.store_records(scratch.vertex(local), [x, y, z]);
            }
            local += S::LANES;
            if local >= count {
                break;
            }
            // The last vector ends with the last vertex and repeats some.
            local = local.min(count - S::LANES);
        }
    }

    /// Projects vertices one index at a time: for meshes whose indices are strewn.
    ///
    /// # Safety
    /// They can be read; there are from 1 to a chunk's size of them.
    #[inline(always)]
    pub unsafe fn sparse(&self, camera: &Camera, indices: &[u32], scratch: &mut Scratch) {
        for (k, local) in scratch.local[..indices.len()].iter_mut().enumerate() {
            local.write(k as u32);
        }
        let mut local = 0;
        while local < indices.len() {
            let group: [u32; super::scratch::MAX_LANES] =
                core::array::from_fn(|lane| indices[(local + lane).min(indices.len() - 1)]);
            // SAFETY: the caller's contract; the scratch has room for a vector after the chunk's vertices.
            unsafe { self.each(camera, group, local, scratch) };
            local += S::LANES;
        }
    }

    /// # Safety
    /// The first `LANES` indices name vertices that can be read; `local` is within the chunk.
    #[inline(always)]
    unsafe fn each(
        &self,
        camera: &Camera,
        indices: [u32; super::scratch::MAX_LANES],
        local: usize,
        scratch: &mut Scratch,
    ) {
        let s = self.s;
        // SAFETY: all sixteen are read, and all name vertices; arrays of sixteen hold a vector.
        unsafe {
            let v = self.load_each(indices);
            let v = [s.load_f(v[0].as_ptr()), s.load_f(v[1].as_ptr()), s.load_f(v[2].as_ptr())];
            let [x, y, z] = project(s, camera, self.to_clip(v));
            s.store_records(scratch.vertex(local), [x, y, z]);
        }
    }
}

/// (x, y, z, 1) times a matrix, for `count` vertices, as packed x, y, z, w.
///
/// # Safety
/// The vertices can be read and `out` can be written for four floats each; either may be unaligned.
#[inline(always)]
pub(crate) unsafe fn transform<S: Simd>(s: S, m: &[f32; 16], source: VertexSource, out: *mut f32, count: usize) {
    let row = |r: usize| [s.f(m[r]), s.f(m[4 + r]), s.f(m[8 + r]), s.f(m[12 + r])];
    let rows = [row(0), row(1), row(2), row(3)];
    let reader = Reader { s, source, packing: Packing::of(source.layout), rows: None };
    let mut first = 0;
    while first < count {
        let n = S::LANES.min(count - first);
        // SAFETY: the caller's contract.
        let [x, y, z] = unsafe {
            if n == S::LANES {
                reader.load(first as u32, first + n < count)
            } else {
                let last = count - 1;
                let indices: [u32; super::scratch::MAX_LANES] =
                    core::array::from_fn(|lane| (first + lane).min(last) as u32);
                let v = reader.load_each(indices);
                [s.load_f(v[0].as_ptr()), s.load_f(v[1].as_ptr()), s.load_f(v[2].as_ptr())]
            }
        };
        let mut lanes = [[0.0_f32; super::scratch::MAX_LANES]; 4];
        for (lane, row) in lanes.iter_mut().zip(&rows) {
            // SAFETY: sixteen floats hold a vector.
            unsafe { s.store_f(lane.as_mut_ptr(), dot(s, row, x, y, z)) };
        }
        for k in 0..n {
            let vertex = [lanes[0][k], lanes[1][k], lanes[2][k], lanes[3][k]];
            // SAFETY: the caller's contract.
            unsafe { out.add(4 * (first + k)).cast::<[f32; 4]>().write_unaligned(vertex) };
        }
        first += n;
    }
}
