//! Rectangles against the buffer: the cheap query, for projected bounding boxes.
//!
//! A rectangle is widened to the pixels that it touches. Whole tiles are compared by their least depths,
//! and only where that does not settle it, sub-tile by sub-tile with their layers.

use crate::buffer::{
    Accurate, Buffer, FourLayer, Quick, Rule, TILE_HEIGHT, TILE_WIDTH, ThreeLayer, TileRect, UNTOUCHED,
};
use crate::simd::{self, Job, Simd};
use crate::statistics::Tally;
use crate::{CullingResult, Implementation, UpdateRule, YAxis};

/// From a rounded 1/w to a bound that is not farther than the true one.
const NEARER: f32 = 1.0 + 1.0 / (1 << 23) as f32;

/// Tests [x min, y min, x max, y max] in normalised device coordinates at `w_min`.
pub(crate) fn test(
    implementation: Implementation,
    buffer: &Buffer,
    y_axis: YAxis,
    [x_min, y_min, x_max, y_max]: [f32; 4],
    w_min: f32,
) -> (CullingResult, Tally) {
    let tally = Tally::default();
    // NaN fails every comparison: it ends here, too.
    let sound = x_min <= x_max && y_min <= y_max && w_min > 0.0;
    if !sound {
        return (CullingResult::Visible, tally);
    }
    if x_max <= -1.0 || x_min >= 1.0 || y_max <= -1.0 || y_min >= 1.0 {
        return (CullingResult::ViewCulled, tally);
    }
    let depth = 1.0 / w_min * NEARER;
    let pixels = Pixels::touched(buffer, y_axis, [x_min, y_min, x_max, y_max]);
    match buffer.rule() {
        UpdateRule::ThreeLayer => simd::run(implementation, Walk::<ThreeLayer>::new(buffer, pixels, depth)),
        UpdateRule::Quick => simd::run(implementation, Walk::<Quick>::new(buffer, pixels, depth)),
        UpdateRule::Accurate => simd::run(implementation, Walk::<Accurate>::new(buffer, pixels, depth)),
        UpdateRule::FourLayer => simd::run(implementation, Walk::<FourLayer>::new(buffer, pixels, depth)),
    }
}

/// The tiles that a rectangle touches, at least one; all of them where it is not a rectangle.
pub(crate) fn tiles(buffer: &Buffer, y_axis: YAxis, [x_min, y_min, x_max, y_max]: [f32; 4]) -> TileRect {
    // NaN fails every comparison.
    if !(x_min <= x_max && y_min <= y_max) {
        return buffer.all_tiles();
    }
    let p = Pixels::touched(buffer, y_axis, [x_min, y_min, x_max, y_max]);
    TileRect { x0: p.x0 / TILE_WIDTH, y0: p.y0 / TILE_HEIGHT, x1: p.x1 / TILE_WIDTH + 1, y1: p.y1 / TILE_HEIGHT + 1 }
}

/// The first and last of `size` pixels across [-1, 1] that an interval touches. One that ends on a
/// pixel's boundary does not touch the pixel beyond. In f64 nothing is rounded but what is far below a pixel.
#[inline(always)]
fn touched(min: f32, max: f32, size: u32) -> (u32, u32) {
    let pixel = |x: f32| (f64::from(x.clamp(-1.0, 1.0)) * 0.5 + 0.5) * f64::from(size);
    // Conversions to integers instead of `floor` and `ceil`, which the baseline of x86-64 has to call; checked ones were
    // a third of a small rectangle's time.
    // SAFETY: neither is NaN, and both are from 0 to `size`.
    let whole = |x: f64| unsafe { x.to_int_unchecked::<i32>() };
    let first = whole(pixel(min)).min(size as i32 - 1);
    let max = pixel(max);
    let last = whole(max) - i32::from(f64::from(whole(max)) >= max);
    (first as u32, last.max(first) as u32)
}

/// A rectangle of pixels, the last inside.
#[derive(Clone, Copy)]
struct Pixels {
    x0: u32,
    y0: u32,
    x1: u32,
    y1: u32,
}

impl Pixels {
    /// Those on the screen that a rectangle touches, at least one; no edge is NaN.
    #[inline(always)]
    fn touched(buffer: &Buffer, y_axis: YAxis, [x_min, y_min, x_max, y_max]: [f32; 4]) -> Self {
        let (row_min, row_max) = if y_axis == YAxis::Down { (-y_max, -y_min) } else { (y_min, y_max) };
        let (x0, x1) = touched(x_min, x_max, buffer.width());
        let (y0, y1) = touched(row_min, row_max, buffer.height());
        Self { x0, y0, x1, y1 }
    }
}

struct Walk<'a, R> {
    buffer: &'a Buffer,
    pixels: Pixels,
    depth: f32,
    rule: core::marker::PhantomData<R>,
}

impl<'a, R: Rule> Walk<'a, R> {
    fn new(buffer: &'a Buffer, pixels: Pixels, depth: f32) -> Self {
        Self { buffer, pixels, depth, rule: core::marker::PhantomData }
    }
}

impl<R: Rule> Job for Walk<'_, R> {
    type Output = (CullingResult, Tally);

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Self::Output {
        let (buffer, p) = (self.buffer, self.pixels);
        let mut tally = Tally::default();
        let depth = s.f(self.depth);
        let (first, end) = (p.x0 / TILE_WIDTH, p.x1 / TILE_WIDTH + 1);
        let (top, bottom) = (p.y0 / TILE_HEIGHT, p.y1 / TILE_HEIGHT);
        let lanes = S::LANES as u32;
        for y in top..=bottom {
            // Lanes that are not behind their whole tile.
            let open_from = |x: u32| {
                // SAFETY: after the last tile there is room for a vector of least depths; nobody draws there, which a pool sees
                // to by its locks.
                let least = unsafe { s.load_f(buffer.least_of(x, y)) };
                s.le(least, depth)
            };
            // Is there any in this row? One branch a row: most have none.
            let mut x = first;
            let mut any = s.first(0);
            while x + lanes <= end {
                any = s.or_m(any, open_from(x));
                x += lanes;
            }
            any = s.or_m(any, s.and_m(s.first((end - x) as usize), open_from(x)));
            if s.mask_bits(any) == 0 {
                continue;
            }
            let mut x = first;
            while x < end {
                let mut open = s.mask_bits(s.and_m(s.first((end - x) as usize), open_from(x)));
                while open != 0 {
                    let lane = open.trailing_zeros();
                    open &= open - 1;
                    tally.traversed += u64::from(buffer.statistics());
                    // SAFETY: one of the tiles that the rectangle touches.
                    if unsafe { self.sees_tile(s, x + lane, y) } {
                        return (CullingResult::Visible, tally);
                    }
                }
                x += lanes;
            }
        }
        (CullingResult::Occluded, tally)
    }
}

impl<R: Rule> Walk<'_, R> {
    /// May something of the rectangle be seen in this tile?
    ///
    /// # Safety
    /// It is a tile of the buffer, and nobody draws.
    #[inline(always)]
    unsafe fn sees_tile<S: Simd>(&self, s: S, x: u32, y: u32) -> bool {
        let (buffer, p) = (self.buffer, self.pixels);
        // Vectors of sixteen lanes take the tile's whole block; rows of the other tile touch nothing.
        let block_y = y & !(S::LANES as u32 / 8 - 1);
        // SAFETY: the caller's contract; the buffer was made for the rule `R`.
        let planes = unsafe {
            if *buffer.least_of(x, y) == UNTOUCHED {
                return true;
            }
            R::load(s, buffer.tile(x, block_y))
        };
        // Rows as lanes, their first and their end pixel; a row outside has none.
        let rows = s.add_i(s.i((block_y * TILE_HEIGHT) as i32), s.iota());
        let first_row = p.y0.max(y * TILE_HEIGHT);
        let end_row = (p.y1 + 1).min((y + 1) * TILE_HEIGHT);
        let inside = s.and_m(s.gt_i(rows, s.i(first_row as i32 - 1)), s.gt_i(s.i(end_row as i32), rows));
        let within = |column: u32| s.i(column.saturating_sub(x * TILE_WIDTH) as i32);
        let (first, end) = (within(p.x0), within(p.x1 + 1));
        let end = s.select_i(inside, end, s.i(0));
        let touched = s.transpose_bytes(s.and_not(s.ones_shl(end), s.ones_shl(first)));
        !s.all(R::hides(s, &planes, touched, s.f(self.depth)))
    }
}
