//! Vertices to the screen: transform, divide, snap to 1/256 pixel, mark what has to be clipped.
//!
//! A vertex is regular when it lies between the near plane and 2^40 and within the guard band around the screen:
//! some 250,000 pixels for exact coverage, which is exact for whatever snapped coordinates come out; 16,384 pixels
//! for conservative coverage, which has to bound where the true vertex is and so needs f32 to be finer than a subpixel. The x
//! of the other vertices becomes a NaN that carries outcodes, so that a triangle outside one plane is still rejected in a vector.
//!
//! Depths 1/w between 2^-40 and 2^40 keep every later product of depths and coordinates out of the
//! denormal numbers: the bits do not depend on whether the processor flushes those.

use glam::Mat4;

use super::camera::{Camera, FARTHEST_W};
use crate::simd::Simd;

/// Outcodes of a vertex, the low bits of a marked x.
pub(crate) mod outcode {
    pub const NEAR: u32 = 1;
    pub const LEFT: u32 = 2;
    pub const RIGHT: u32 = 4;
    pub const BELOW: u32 = 8;
    pub const ABOVE: u32 = 16;
    pub const ALL: u32 = 31;
    /// What marks carry besides.
    pub const MARK: u32 = 0x7fc0_0000;
}

/// The rows of a matrix for x, y and w, each element in every lane.
pub(crate) struct MatrixRows<S: Simd>([[S::F; 4]; 3]);

impl<S: Simd> MatrixRows<S> {
    #[inline(always)]
    pub fn new(s: S, matrix: &Mat4) -> Self {
        let m = matrix.to_cols_array();
        let row = |r: usize| [s.f(m[r]), s.f(m[4 + r]), s.f(m[8 + r]), s.f(m[12 + r])];
        Self([row(0), row(1), row(3)])
    }

    /// (x, y, z, 1) to clip-space x, y, w.
    #[inline(always)]
    pub fn apply(&self, s: S, [x, y, z]: [S::F; 3]) -> [S::F; 3] {
        [dot(s, &self.0[0], x, y, z), dot(s, &self.0[1], x, y, z), dot(s, &self.0[2], x, y, z)]
    }
}

/// A row of a matrix times (x, y, z, 1). The only place, so that every path rounds alike.
#[inline(always)]
pub(crate) fn dot<S: Simd>(s: S, row: &[S::F; 4], x: S::F, y: S::F, z: S::F) -> S::F {
    s.add(s.add(s.mul(x, row[0]), s.mul(y, row[1])), s.add(s.mul(z, row[2]), row[3]))
}

/// Clip space (x, y, w) to the screen: x and y in 1/256 pixel, and 1/w; or marks.
#[inline(always)]
pub(crate) fn project<S: Simd>(s: S, camera: &Camera, [x, y, w]: [S::F; 3]) -> [S::F; 3] {
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
    // What is not finite is outside no plane: clipping counts it as dropped, or as visible.
    let largest = s.max(s.max(s.abs(x), s.abs(y)), s.abs(w));
    let finite = s.and_m(s.le(largest, s.f(f32::MAX)), s.and_m(s.eq(x, x), s.eq(y, y)));
    marks = s.select_i(finite, marks, s.i(outcode::MARK as i32));
    [s.select(regular, column, s.float_of_bits(marks)), s.select(regular, row, s.f(0.0)), z]
}

/// A bit in the lanes of a mask.
#[inline(always)]
pub(crate) fn bit_where<S: Simd>(s: S, m: S::M, bit: u32) -> S::I {
    s.select_i(m, s.i(bit as i32), s.i(0))
}
