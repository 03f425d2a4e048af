//! Whether the HiZ hides a whole mesh of a few vertices, such as a box, so that none of its triangles need be set up.

use crate::buffer::hiz::row_is_open;
use crate::buffer::{Buffer, TILE_HEIGHT, TILE_WIDTH};
use crate::geometry::coverage::VERTEX_MARGIN;
use crate::geometry::{Conservative, Coverage};
use crate::simd::Simd;

/// Does every tile of the bounds of these vertices hide the nearest of them? They are as projected: x and y in 1/256
/// pixel, 1/w, and a float that does not count. If one needs clipping, the answer is no.
///
/// # Safety
/// One of them is on the screen. Nobody is drawing.
#[inline(always)]
pub(super) unsafe fn is_hidden<S: Simd>(s: S, buffer: &Buffer, vertices: &[[f32; 4]]) -> bool {
    let [mut x0, mut y0, mut x1, mut y1, mut nearest] = [f32::MAX, f32::MAX, f32::MIN, f32::MIN, 0.0_f32];
    for &[x, y, z, _] in vertices {
        if x.is_nan() {
            return false;
        }
        (x0, y0) = (if x < x0 { x } else { x0 }, if y < y0 { y } else { y0 });
        (x1, y1) = (if x > x1 { x } else { x1 }, if y > y1 { y } else { y1 });
        nearest = if z > nearest { z } else { nearest };
    }
    // The pixels that a query considers, as in `ScreenBounds`, and their tiles, the end inclusive.
    let (low, high) = Conservative::TO_PIXELS;
    let (width, height) = buffer.size();
    let first = |x: f32, tile: u32| ((x as i32 + low) >> 8).max(0) / tile as i32;
    let last = |x: f32, size: u32, tile: u32| (((x as i32 + high) >> 8).min(size as i32) - 1).div_euclid(tile as i32);
    let (x0, x1) = (first(x0, TILE_WIDTH), last(x1, width, TILE_WIDTH));
    let (y0, y1) = (first(y0, TILE_HEIGHT), last(y1, height, TILE_HEIGHT));
    let depth = s.f(nearest * (1.0 + VERTEX_MARGIN));
    // The one with a corner on the screen makes sure that there are some.
    debug_assert!(x0 <= x1 && y0 <= y1);
    // A plain loop: the compiler does not always inline closures that take vectors.
    for y in y0..=y1 {
        // SAFETY: tiles of the buffer; the caller's contract.
        if unsafe { row_is_open(s, buffer, x0 as u32, x1 as u32 + 1, y as u32, depth) } {
            return false;
        }
    }
    true
}
