//! Bounding boxes of a vector of triangles, and which of them the buffer's least depths hide.
//!
//! A box of one or two columns and rows of tiles is compared with the least depths of its four corners' tiles, which are
//! all its tiles; a larger one with those of areas of 128x64 pixels (see `areas.rs`) in the same way, by the same
//! gathers. Without areas half of a castle's triangles that got edges had no open tile.

use super::setup::{Purpose, VERTEX_MARGIN};
use super::survivors::Corner;
use crate::buffer::areas::{AREA_COLUMN_SHIFT, AREA_ROW_SHIFT, AREA_TILES_W};
use crate::buffer::{Buffer, TileRect};
use crate::simd::Simd;

/// How far, in 1/256 pixel, a snapped vertex of a query may be from the true one, and a little.
pub(super) const QUERY_SLACK: i32 = 2;

/// Where least depths may be looked at.
#[derive(Clone, Copy)]
pub(super) struct Look {
    /// Inside of these tiles.
    pub clip: TileRect,
    /// Their areas are kept up to date.
    pub areas: bool,
}

/// The boxes of a vector of triangles: of a draw the pixels whose centre is inside, of a query those that are touched.
pub(super) struct Boxes<S: Simd> {
    /// The largest coordinate in size.
    pub widest: S::F,
    /// Pixels on the screen, the last outside.
    pub column0: S::I,
    pub column1: S::I,
    pub row0: S::I,
    pub row1: S::I,
    /// Tiles, the last inside.
    pub tile_x0: S::I,
    pub tile_x1: S::I,
    pub tile_y0: S::I,
    pub tile_y1: S::I,
    /// Boxes that hold a pixel.
    pub inside: S::M,
    /// A bound of the nearest corner's true depth.
    pub nearest: S::F,
}

impl<S: Simd> Boxes<S> {
    #[inline(always)]
    pub fn new(s: S, buffer: &Buffer, purpose: Purpose, [a, b, c]: &[Corner<S>; 3]) -> Self {
        let (min_x, max_x) = (s.min(a[0], s.min(b[0], c[0])), s.max(a[0], s.max(b[0], c[0])));
        let (min_y, max_y) = (s.min(a[1], s.min(b[1], c[1])), s.max(a[1], s.max(b[1], c[1])));
        let (low, high) = match purpose {
            Purpose::Query => (-QUERY_SLACK, 256 + QUERY_SLACK),
            Purpose::Draw | Purpose::Bin => (127, 127),
        };
        let pixel = |x: S::F, add: i32| s.sra::<8>(s.add_i(s.round(x), s.i(add)));
        let column0 = s.max_i(pixel(min_x, low), s.i(0));
        let column1 = s.min_i(pixel(max_x, high), s.i(buffer.width() as i32));
        let row0 = s.max_i(pixel(min_y, low), s.i(0));
        let row1 = s.min_i(pixel(max_y, high), s.i(buffer.height() as i32));
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

    /// Boxes whose triangles are hidden inside of a rectangle of tiles, or have nothing there.
    ///
    /// How current areas are depends on the instruction set. That changes nothing in the buffer; but a query's counts
    /// would tell, and it leaves them out.
    ///
    /// # Safety
    /// Nobody else writes to the tiles and areas of the rectangle, unless `RACING`: then others may draw there, by stores of
    /// whole words. What is read may be old, which is safe: between clears, least depths only rise.
    #[inline(always)]
    pub unsafe fn hidden<const RACING: bool>(
        &self,
        s: S,
        buffer: &Buffer,
        Look { clip, areas: mut with_areas }: Look,
        purpose: Purpose,
    ) -> S::M {
        let nearest = self.nearest;
        let mut inside = self.inside;
        let [mut x0, mut x1, mut y0, mut y1] = [self.tile_x0, self.tile_x1, self.tile_y0, self.tile_y1];
        if clip != buffer.all_tiles() {
            if clip.x0 >= clip.x1 || clip.y0 >= clip.y1 {
                // No tile of it could stand for the lanes that look at none.
                return self.inside;
            }
            (x0, x1) = (s.max_i(x0, s.i(clip.x0 as i32)), s.min_i(x1, s.i(clip.x1 as i32 - 1)));
            (y0, y1) = (s.max_i(y0, s.i(clip.y0 as i32)), s.min_i(y1, s.i(clip.y1 as i32 - 1)));
            inside = s.and_not_m(s.or_m(s.gt_i(x0, x1), s.gt_i(y0, y1)), inside);
            // What stands side by side is read in pairs, and beside the rectangle others may be writing.
            let width = clip.x1 - clip.x0;
            if width < 2 {
                return s.and_not_m(inside, self.inside);
            }
            with_areas &= width > AREA_TILES_W;
        }
        let two = |a: S::I, b: S::I| s.gt_i(s.i(2), s.sub_i(b, a));
        let tiles = s.and_m(inside, s.and_m(two(x0, x1), two(y0, y1)));
        let (mut few, mut first, mut pitch) = (tiles, s.i(0), s.f(buffer.tiles_w() as f32));
        let mut edge = s.i(clip.x0 as i32);
        let (mut left, mut right, mut top, mut bottom) = (x0, x1, y0, y1);
        if with_areas && s.mask_bits(s.and_not_m(tiles, inside)) != 0 {
            let or_area = |tile: S::I, area: S::I| s.select_i(tiles, tile, area);
            left = or_area(x0, s.sra::<AREA_COLUMN_SHIFT>(x0));
            right = or_area(x1, s.sra::<AREA_COLUMN_SHIFT>(x1));
            top = or_area(y0, s.sra::<AREA_ROW_SHIFT>(y0));
            bottom = or_area(y1, s.sra::<AREA_ROW_SHIFT>(y1));
            edge = or_area(edge, s.sra::<AREA_COLUMN_SHIFT>(edge));
            first = or_area(first, s.i(buffer.first_area() as i32));
            pitch = s.select(tiles, pitch, s.f(buffer.areas_w() as f32));
            few = s.and_m(inside, s.and_m(two(left, right), two(top, bottom)));
        }
        // Exact: there are at most 2^20 tiles.
        let row = |y: S::I| s.add_i(first, s.round(s.mul(s.to_f(y), pitch)));
        let (top, bottom) = (row(top), row(bottom));
        let any = s.i((clip.y0 * buffer.tiles_w() + clip.x0) as i32);
        let at = |row: S::I, x: S::I| s.select_i(few, s.add_i(row, x), any);
        // Where the two columns begin that are read: with the box's first where it has two, else with the one to its left, or
        // on the left edge with itself.
        let pair = s.max_i(s.sub_i(right, s.i(1)), edge);
        // SAFETY: a box that holds a pixel names tiles or areas of the rectangle, the other lanes its first tile. A rectangle
        // beside which another thread may be writing is two wide, in areas, too, if they are looked at; in the whole
        // buffer the second of a pair may be the next row's, and after the last tile and the last area there is room.
        let ([top0, top1], [bottom0, bottom1]) =
            unsafe { (pairs::<S, RACING>(s, buffer, at(top, pair)), pairs::<S, RACING>(s, buffer, at(bottom, pair))) };
        let (first, second) = (s.min(top0, bottom0), s.min(top1, bottom1));
        let one = s.select(s.eq_i(pair, right), first, second);
        let least = s.select(s.eq_i(left, right), one, s.min(first, second));
        let hidden = if purpose == Purpose::Query { s.lt(nearest, least) } else { s.le(nearest, least) };
        s.or_m(s.and_not_m(inside, self.inside), s.and_m(few, hidden))
    }
}

/// Least depths and those beside them.
///
/// # Safety
/// Both can be read; nobody writes them, unless `RACING`: then as words.
#[inline(always)]
unsafe fn pairs<S: Simd, const RACING: bool>(s: S, buffer: &Buffer, index: S::I) -> [S::F; 2] {
    let least = buffer.least();
    // SAFETY: the caller's contract.
    unsafe { if RACING { s.gather_pairs_relaxed(least, index) } else { s.gather_pairs(least, index) } }
}
