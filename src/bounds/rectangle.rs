//! Tests rectangles against the buffer: the cheap query, for projected bounding boxes.
//!
//! A rectangle is widened to the pixels that it touches. Whole tiles are compared by their `z_min`; only if that does
//! not decide, sub-tiles are compared with their layers. Most rectangles are small and hidden, and one vector for each
//! of up to four rows of tiles decides them.

use core::marker::PhantomData;

use crate::buffer::hiz::row_is_open;
use crate::buffer::pixels::shows;
use crate::buffer::rules::{Rule, with_rule};
use crate::buffer::{Buffer, CLEARED, TILE_HEIGHT, TILE_WIDTH, TileRect};
use crate::simd::{self, Job, Level, Simd};
use crate::{CullingResult, YAxis};

/// Factor from a rounded 1/w to a bound that is not farther than the true value.
const NEARER: f32 = 1.0 + 1.0 / (1 << 23) as f32;

/// Tests [x min, y min, x max, y max] in normalised device coordinates at `w_min`. Also returns the number of tiles
/// whose layers were read, if statistics are enabled.
#[inline(always)]
pub(crate) fn test(
    level: Level,
    buffer: &Buffer,
    y_axis: YAxis,
    [x_min, y_min, x_max, y_max]: [f32; 4],
    w_min: f32,
) -> (CullingResult, u64) {
    test_spans(level, buffer, y_axis, (x_min, x_max), (y_min, y_max), w_min)
}

/// In pairs, which are passed in registers. An array would be stored as four floats and loaded as a vector, which
/// defeats store forwarding and is measurably slower.
#[inline(never)]
fn test_spans(
    level: Level,
    buffer: &Buffer,
    y_axis: YAxis,
    (x_min, x_max): (f32, f32),
    (y_min, y_max): (f32, f32),
    w_min: f32,
) -> (CullingResult, u64) {
    // NaN fails every comparison and so ends here too.
    let sound = x_min <= x_max && y_min <= y_max && w_min > 0.0;
    if !sound {
        return (CullingResult::Visible, 0);
    }
    if x_max <= -1.0 || x_min >= 1.0 || y_max <= -1.0 || y_min >= 1.0 {
        return (CullingResult::ViewCulled, 0);
    }
    let depth = 1.0 / w_min * NEARER;
    let pixels = Pixels::touched(buffer, y_axis, [x_min, y_min, x_max, y_max]);
    // What is visible usually shows in the middle. Statistics count the tiles that the rest looks at.
    let (column, row) = (pixels.x0.midpoint(pixels.x1), pixels.y0.midpoint(pixels.y1));
    // SAFETY: a pixel of the buffer, and its tile. For concurrent draws, see `SmallRectangle`.
    let seen = unsafe {
        *buffer.z_min_of(column / TILE_WIDTH, row / TILE_HEIGHT) <= depth
            && !buffer.statistics()
            && shows(buffer, column, row, depth)
    };
    if seen {
        return (CullingResult::Visible, 0);
    }
    let tiles = pixels.tiles();
    let open = if SmallRectangle::holds(tiles) {
        let open = simd::run(level, SmallRectangle { buffer, tiles, depth });
        if open == 0 {
            return (CullingResult::Occluded, 0);
        }
        Some(open)
    } else {
        None
    };
    let query = RectangleQuery { buffer, pixels, depth, open };
    with_rule!(buffer.rule(), R => simd::run(level, Layers::<R>::of(query)))
}

/// The tiles that a rectangle touches, at least one; all tiles if it is not a valid rectangle.
pub(crate) fn tiles(buffer: &Buffer, y_axis: YAxis, [x_min, y_min, x_max, y_max]: [f32; 4]) -> TileRect {
    // NaN fails every comparison.
    if !(x_min <= x_max && y_min <= y_max) {
        return buffer.all_tiles();
    }
    Pixels::touched(buffer, y_axis, [x_min, y_min, x_max, y_max]).tiles()
}

/// The first and last of `size` pixels across [-1, 1] that an interval touches. An interval that ends on a pixel
/// boundary does not touch the next pixel. In f64 the rounding error is far below a pixel.
///
/// The compiler vectorises the two axes as long as every line is one instruction of baseline x86-64. Checked
/// conversions, `clamp`, `floor` and `ceil` are not, and are measurably slower.
#[inline(always)]
fn touched(min: f32, max: f32, size: u32) -> (u32, u32) {
    let size = f64::from(size as i32);
    let half = size * 0.5;
    let larger = |a: f64, b: f64| if a > b { a } else { b };
    let smaller = |a: f64, b: f64| if a < b { a } else { b };
    let first = smaller(larger(f64::from(min) * half + half, 0.0), size - 1.0);
    let end = smaller(f64::from(max) * half + half, size);
    // The next smaller number: its integer part is the last pixel. Anything not above 0 becomes NaN or stays below it,
    // and neither is larger.
    let below = f64::from_bits(end.to_bits().wrapping_sub(1));
    // SAFETY: neither is NaN, and both are in 0 to `size`.
    let whole = |x: f64| unsafe { x.to_int_unchecked::<i32>() as u32 };
    (whole(first), whole(larger(below, first)))
}

/// A rectangle of pixels, the end inclusive.
#[derive(Clone, Copy)]
struct Pixels {
    x0: u32,
    y0: u32,
    x1: u32,
    y1: u32,
}

impl Pixels {
    /// The pixels on the screen that a rectangle touches, at least one; no edge is NaN.
    #[inline(always)]
    fn touched(buffer: &Buffer, y_axis: YAxis, [x_min, y_min, x_max, y_max]: [f32; 4]) -> Self {
        let (row_min, row_max) = if y_axis == YAxis::Down { (-y_max, -y_min) } else { (y_min, y_max) };
        let (x0, x1) = touched(x_min, x_max, buffer.width());
        let (y0, y1) = touched(row_min, row_max, buffer.height());
        Self { x0, y0, x1, y1 }
    }

    /// The tiles that contain these pixels.
    #[inline(always)]
    fn tiles(self) -> TileRect {
        let Self { x0, y0, x1, y1 } = self;
        TileRect { x0: x0 / TILE_WIDTH, y0: y0 / TILE_HEIGHT, x1: x1 / TILE_WIDTH + 1, y1: y1 / TILE_HEIGHT + 1 }
    }
}

/// A rectangle of a few tiles, whose `z_min` is compared without a loop, because the loop's end would be mispredicted.
struct SmallRectangle<'a> {
    buffer: &'a Buffer,
    tiles: TileRect,
    depth: f32,
}

const SMALL_ROWS: u32 = 4;
/// The narrowest vector.
const SMALL_COLUMNS: u32 = 8;

impl SmallRectangle<'_> {
    /// Is the rectangle small enough? It has at least one tile. One branch instead of two.
    #[inline(always)]
    fn holds(tiles: TileRect) -> bool {
        let (columns, rows) = (tiles.x1 - tiles.x0 - 1, tiles.y1 - tiles.y0 - 1);
        (columns / SMALL_COLUMNS) | (rows / SMALL_ROWS) == 0
    }
}

impl Job for SmallRectangle<'_> {
    /// A bit for each tile whose `z_min` does not hide the rectangle, eight per row.
    type Output = u32;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> u32 {
        const { assert!(S::LANES >= SMALL_COLUMNS as usize) };
        let Self { buffer, tiles, depth } = self;
        let (pitch, height) = (buffer.tiles_w() as usize, tiles.y1 - tiles.y0);
        // The last row is repeated for missing ones.
        let step = |k: u32| if k < height { pitch } else { 0 };
        let depth = s.f(depth);
        // SAFETY: these are tiles of the buffer, with room for a vector after the last one. Nobody is drawing: a pool's
        // locks ensure that, and a direct query discards its answer otherwise.
        let rows = unsafe {
            let first = buffer.z_min_of(tiles.x0, tiles.y0);
            let second = first.add(step(1));
            let third = second.add(step(2));
            let fourth = third.add(step(3));
            [s.load_f(first), s.load_f(second), s.load_f(third), s.load_f(fourth)]
        };
        let [a, b, c, d] = [s.le(rows[0], depth), s.le(rows[1], depth), s.le(rows[2], depth), s.le(rows[3], depth)];
        let inside = s.first((tiles.x1 - tiles.x0) as usize);
        if s.mask_bits(s.and_m(inside, s.or_m(s.or_m(a, b), s.or_m(c, d)))) == 0 {
            return 0;
        }
        let [a, b, c, d] = [s.and_m(inside, a), s.and_m(inside, b), s.and_m(inside, c), s.and_m(inside, d)];
        let bits = s.mask_bits(a) | s.mask_bits(b) << 8 | s.mask_bits(c) << 16 | s.mask_bits(d) << 24;
        bits & u32::MAX >> (8 * (SMALL_ROWS - height))
    }
}

/// The slow path of a query.
struct RectangleQuery<'a> {
    buffer: &'a Buffer,
    pixels: Pixels,
    depth: f32,
    /// For a small rectangle: the candidate tiles.
    open: Option<u32>,
}

/// Queries tiles by their layers.
struct Layers<'a, R> {
    query: RectangleQuery<'a>,
    rule: PhantomData<R>,
}

impl<'a, R: Rule> Layers<'a, R> {
    fn of(query: RectangleQuery<'a>) -> Self {
        Self { query, rule: PhantomData }
    }
}

impl<R: Rule> Job for Layers<'_, R> {
    type Output = (CullingResult, u64);

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Self::Output {
        let (tiles, mut looked) = (self.query.pixels.tiles(), 0);
        // SAFETY: the rectangle's tiles are tiles of the buffer. For concurrent draws, see `SmallRectangle`.
        let seen = unsafe {
            match self.query.open {
                Some(open) => self.sees_open::<S, SMALL_COLUMNS>(s, (tiles.x0, tiles.y0), open, &mut looked),
                None => self.sees(s, tiles, &mut looked),
            }
        };
        let looked = if self.query.buffer.statistics() { looked } else { 0 };
        (if seen { CullingResult::Visible } else { CullingResult::Occluded }, looked)
    }
}

impl<R: Rule> Layers<'_, R> {
    /// May any part of the rectangle be visible in the tiles whose bit is set in `open`, `PER_ROW` per row, starting at
    /// tile (x, y)?
    ///
    /// # Safety
    /// As [`Self::sees`].
    #[inline(always)]
    unsafe fn sees_open<S: Simd, const PER_ROW: u32>(
        &self,
        s: S,
        (x, y): (u32, u32),
        mut open: u32,
        looked: &mut u64,
    ) -> bool {
        while open != 0 {
            let tile = open.trailing_zeros();
            open &= open - 1;
            *looked += 1;
            // SAFETY: this is one of the tiles that the rectangle touches.
            if unsafe { self.sees_tile(s, x + tile % PER_ROW, y + tile / PER_ROW) } {
                return true;
            }
        }
        false
    }

    /// May any part of the rectangle be visible in its tiles?
    ///
    /// # Safety
    /// They are tiles of the buffer, and nobody is drawing.
    #[inline(always)]
    unsafe fn sees<S: Simd>(&self, s: S, tiles: TileRect, looked: &mut u64) -> bool {
        let buffer = self.query.buffer;
        let depth = s.f(self.query.depth);
        let lanes = S::LANES as u32;
        let (first, end) = (tiles.x0, tiles.x1);
        for y in tiles.y0..tiles.y1 {
            // SAFETY: the caller's contract.
            if !unsafe { row_is_open(s, buffer, first, end, y, depth) } {
                continue;
            }
            let mut x = first;
            while x < end {
                // SAFETY: the caller's contract; after the last tile there is room for a vector.
                let z_min = unsafe { s.load_f(buffer.z_min_of(x, y)) };
                let open = s.mask_bits(s.and_m(s.first((end - x) as usize), s.le(z_min, depth)));
                // SAFETY: as above; all bits refer to this row.
                if unsafe { self.sees_open::<S, { u32::BITS }>(s, (x, y), open, looked) } {
                    return true;
                }
                x += lanes;
            }
        }
        false
    }

    /// May any part of the rectangle be visible in this tile?
    ///
    /// # Safety
    /// It is a tile of the buffer, and nobody is drawing.
    #[inline(always)]
    unsafe fn sees_tile<S: Simd>(&self, s: S, x: u32, y: u32) -> bool {
        let RectangleQuery { buffer, pixels: p, depth, .. } = self.query;
        // With sixteen lanes the whole block is loaded; in rows of the other tile no pixel is touched.
        let block_y = y & !(S::LANES as u32 / 8 - 1);
        // SAFETY: the caller's contract; the buffer was made for the rule `R`.
        let planes = unsafe {
            if *buffer.z_min_of(x, y) == CLEARED {
                return true;
            }
            R::load(s, buffer.tile(x, block_y))
        };
        // Rows as lanes, with their first and end pixel; a row outside the rectangle has none.
        let rows = s.add_i(s.i((block_y * TILE_HEIGHT) as i32), s.iota());
        let first_row = p.y0.max(y * TILE_HEIGHT);
        let end_row = (p.y1 + 1).min((y + 1) * TILE_HEIGHT);
        let inside = s.and_m(s.gt_i(rows, s.i(first_row as i32 - 1)), s.gt_i(s.i(end_row as i32), rows));
        let within = |column: u32| s.i(column.saturating_sub(x * TILE_WIDTH) as i32);
        let (first, end) = (within(p.x0), within(p.x1 + 1));
        let end = s.select_i(inside, end, s.i(0));
        let touched = s.transpose_bytes(s.and_not(s.ones_shl(end), s.ones_shl(first)));
        !s.all(R::hides(s, &planes, touched, s.f(depth)))
    }
}
