//! Finds the triangles of a vector that the HiZ hides, before their edges are set up.
//!
//! Bounds of up to two by two tiles are compared with `z_min` at their four corner tiles, which are all the tiles they
//! have; larger bounds are compared with the coarse cells in the same way, by the same gathers. Without the coarse
//! level, many large hidden triangles would have their edges set up for nothing.

use crate::buffer::hiz::{COARSE_COLUMN_SHIFT, COARSE_ROW_SHIFT, COARSE_TILES_W};
use crate::buffer::{Buffer, TileRect};
use crate::geometry::{Coverage, ScreenBounds};
use crate::simd::Simd;

/// The part of the HiZ that may be read.
#[derive(Clone, Copy)]
pub(crate) struct HizScope {
    /// These tiles.
    pub clip: TileRect,
    /// Also their coarse cells, which are kept up to date. How recent they are depends on the instruction set, which
    /// does not change the buffer but would change a query's counts, so queries do not read them.
    pub coarse: bool,
}

/// Triangles that are hidden within the scope, or have no pixel there.
///
/// # Safety
/// Nobody else writes to the scope's tiles and cells, unless `RACING`: then others may draw there, storing whole words.
/// Stale values are safe: between clears, `z_min` only rises.
#[inline(always)]
pub(crate) unsafe fn hidden<S: Simd, C: Coverage, const RACING: bool>(
    s: S,
    buffer: &Buffer,
    HizScope { clip, mut coarse }: HizScope,
    bounds: &ScreenBounds<S>,
) -> S::M {
    let nearest = bounds.nearest;
    let mut inside = bounds.inside;
    let [mut x0, mut x1, mut y0, mut y1] = [bounds.tile_x0, bounds.tile_x1, bounds.tile_y0, bounds.tile_y1];
    if clip != buffer.all_tiles() {
        if clip.x0 >= clip.x1 || clip.y0 >= clip.y1 {
            // There is no tile for the inactive lanes to read.
            return bounds.inside;
        }
        (x0, x1) = (s.max_i(x0, s.i(clip.x0 as i32)), s.min_i(x1, s.i(clip.x1 as i32 - 1)));
        (y0, y1) = (s.max_i(y0, s.i(clip.y0 as i32)), s.min_i(y1, s.i(clip.y1 as i32 - 1)));
        inside = s.and_not_m(s.or_m(s.gt_i(x0, x1), s.gt_i(y0, y1)), inside);
        // Neighbours are read in pairs, and next to the rectangle other threads may be writing.
        let width = clip.x1 - clip.x0;
        if width < 2 {
            return s.and_not_m(inside, bounds.inside);
        }
        coarse &= width > COARSE_TILES_W;
    }
    let two = |a: S::I, b: S::I| s.gt_i(s.i(2), s.sub_i(b, a));
    let tiles = s.and_m(inside, s.and_m(two(x0, x1), two(y0, y1)));
    let (mut few, mut first, mut pitch) = (tiles, s.i(0), s.f(buffer.tiles_w() as f32));
    let mut edge = s.i(clip.x0 as i32);
    let (mut left, mut right, mut top, mut bottom) = (x0, x1, y0, y1);
    if coarse && s.mask_bits(s.and_not_m(tiles, inside)) != 0 {
        let or_cell = |tile: S::I, cell: S::I| s.select_i(tiles, tile, cell);
        left = or_cell(x0, s.sra::<COARSE_COLUMN_SHIFT>(x0));
        right = or_cell(x1, s.sra::<COARSE_COLUMN_SHIFT>(x1));
        top = or_cell(y0, s.sra::<COARSE_ROW_SHIFT>(y0));
        bottom = or_cell(y1, s.sra::<COARSE_ROW_SHIFT>(y1));
        edge = or_cell(edge, s.sra::<COARSE_COLUMN_SHIFT>(edge));
        first = or_cell(first, s.i(buffer.first_coarse() as i32));
        pitch = s.select(tiles, pitch, s.f(buffer.coarse_w() as f32));
        few = s.and_m(inside, s.and_m(two(left, right), two(top, bottom)));
    }
    // Exact: there are at most 2^20 tiles.
    let row = |y: S::I| s.add_i(first, s.round(s.mul(s.to_f(y), pitch)));
    let (top, bottom) = (row(top), row(bottom));
    let any = s.i((clip.y0 * buffer.tiles_w() + clip.x0) as i32);
    let at = |row: S::I, x: S::I| s.select_i(few, s.add_i(row, x), any);
    // The pair of columns begins with the first column of the bounds if they have two, else with the one to its left,
    // or at the left edge with the column itself.
    let pair = s.max_i(s.sub_i(right, s.i(1)), edge);
    // SAFETY: lanes whose bounds hold a pixel index tiles or cells of the rectangle, the other lanes its first tile. A
    // rectangle next to which another thread may be writing is at least two tiles wide, and two cells if cells are
    // read. In the whole buffer the second of a pair may belong to the next row, and there is padding after the last
    // tile and the last cell.
    let ([top0, top1], [bottom0, bottom1]) =
        unsafe { (pairs::<S, RACING>(s, buffer, at(top, pair)), pairs::<S, RACING>(s, buffer, at(bottom, pair))) };
    let (first, second) = (s.min(top0, bottom0), s.min(top1, bottom1));
    let one = s.select(s.eq_i(pair, right), first, second);
    let z_min = s.select(s.eq_i(left, right), one, s.min(first, second));
    let hidden = C::hidden(s, nearest, z_min);
    s.or_m(s.and_not_m(inside, bounds.inside), s.and_m(few, hidden))
}

/// `z_min` at this index and at the next.
///
/// # Safety
/// Both can be read; nobody writes them, unless `RACING`: then only whole words.
#[inline(always)]
unsafe fn pairs<S: Simd, const RACING: bool>(s: S, buffer: &Buffer, index: S::I) -> [S::F; 2] {
    let z_min = buffer.z_min();
    // SAFETY: the caller's contract.
    unsafe { if RACING { s.gather_pairs_relaxed(z_min, index) } else { s.gather_pairs(z_min, index) } }
}
