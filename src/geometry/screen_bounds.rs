//! Screen bounds of a vector of triangles.

use super::Corner;
use super::coverage::{Coverage, VERTEX_MARGIN};
use crate::simd::Simd;

/// The screen bounds of a vector of triangles, in the pixels that their coverage considers.
pub(crate) struct ScreenBounds<S: Simd> {
    /// The largest magnitude of a coordinate, in 1/256 pixel.
    pub widest: S::F,
    /// Pixels on the screen, end exclusive.
    pub column0: S::I,
    pub column1: S::I,
    pub row0: S::I,
    pub row1: S::I,
    /// Tiles, end inclusive.
    pub tile_x0: S::I,
    pub tile_x1: S::I,
    pub tile_y0: S::I,
    pub tile_y1: S::I,
    /// Bounds that contain a pixel.
    pub inside: S::M,
    /// A bound of the nearest corner's true 1/w.
    pub nearest: S::F,
}

impl<S: Simd> ScreenBounds<S> {
    #[inline(always)]
    pub fn new<C: Coverage>(s: S, (width, height): (u32, u32), [a, b, c]: &[Corner<S>; 3]) -> Self {
        let (min_x, max_x) = (s.min(a[0], s.min(b[0], c[0])), s.max(a[0], s.max(b[0], c[0])));
        let (min_y, max_y) = (s.min(a[1], s.min(b[1], c[1])), s.max(a[1], s.max(b[1], c[1])));
        let (low, high) = C::TO_PIXELS;
        let pixel = |x: S::F, add: i32| s.sra::<8>(s.add_i(s.round(x), s.i(add)));
        let column0 = s.max_i(pixel(min_x, low), s.i(0));
        let column1 = s.min_i(pixel(max_x, high), s.i(width as i32));
        let row0 = s.max_i(pixel(min_y, low), s.i(0));
        let row1 = s.min_i(pixel(max_y, high), s.i(height as i32));
        Self {
            widest: s.max(s.max(s.abs(min_x), s.abs(max_x)), s.max(s.abs(min_y), s.abs(max_y))),
            column0,
            column1,
            row0,
            row1,
            tile_x0: s.sra::<5>(column0),
            tile_x1: s.sra::<5>(s.sub_i(column1, s.i(1))),
            tile_y0: s.sra::<3>(row0),
            tile_y1: s.sra::<3>(s.sub_i(row1, s.i(1))),
            inside: s.and_m(s.gt_i(column1, column0), s.gt_i(row1, row0)),
            nearest: s.mul(s.max(a[2], s.max(b[2], c[2])), s.f(1.0 + VERTEX_MARGIN)),
        }
    }
}
