//! The masked hierarchical depth buffer: its memory, update rules, HiZ, clearing and merging.
//!
//! The screen is divided into tiles of 32x8 pixels, each of eight 8x4 sub-tiles in two rows of four; lane `i` of a
//! vector is the sub-tile in column `i % 4` and row `i / 4`. Bit `8 * y + x` of a mask is the pixel in column `x` and
//! row `y` of the sub-tile. In memory two vertically adjacent tiles form a block: five planes of sixteen words (20
//! bytes per sub-tile) under the three-layer rule, seven (28 bytes) under the four-layer rule and three (12 bytes)
//! under the others, plane after plane, with the upper tile's eight words first. A plane of a block is thus one cache
//! line; vectors of sixteen lanes process a whole block, and vectors of eight lanes half of it.
//!
//! Besides the planes, each tile has `z_min`, the least of its reference depths: depth is 1/w, so the least is the
//! farthest. A triangle or rectangle behind all of a tile is rejected by one comparison. The value [`CLEARED`] there
//! means that nothing has been drawn since the last clear and that the planes hold stale contents: a clear writes four
//! bytes per tile and nothing else. These values and those of the coarse level (see `hiz.rs`) form the hierarchy, HiZ.
//!
//! Sub-tiles outside the screen, in the tiles at its right and bottom edge, are infinitely near from the start, so that
//! they never hold back `z_min`. In sub-tiles that are partly outside, a triangle that covers any pixel inside covers
//! all pixels outside.

pub(crate) mod hiz;
pub(crate) mod merge;
pub(crate) mod pixels;
mod region;
pub(crate) mod rules;
mod tile;

pub(crate) use region::Region;
pub(crate) use tile::{ClearState, TilePlace, TileRect, load};

use crate::allocator::AlignedWords;
use crate::simd::MAX_LANES;
use crate::{Allocator, Error, ScissorRect, UpdateRule};
use rules::{Rule, with_rule};

/// The largest width and height of a buffer, in pixels.
pub(crate) const MAX_SIZE: u32 = 16_384;

pub(crate) const TILE_WIDTH: u32 = 32;
pub(crate) const TILE_HEIGHT: u32 = 8;
const BLOCK_HEIGHT: u32 = 2 * TILE_HEIGHT;
/// Sub-tiles in a tile, and lanes in a tile's vector.
pub(crate) const SUB_TILES: usize = 8;

/// Words in a plane of a block, which is two tiles.
pub(crate) const BLOCK: usize = 2 * SUB_TILES;

/// `z_min` of a tile into which nothing has been drawn since the last clear.
pub(crate) const CLEARED: f32 = -1.0;
/// The reference depth of sub-tiles outside the screen.
const OUTSIDE: f32 = f32::MAX;

pub(crate) struct Buffer {
    width: u32,
    height: u32,
    tiles_w: u32,
    tiles_h: u32,
    rule: UpdateRule,
    statistics: bool,
    planes: AlignedWords,
    /// `z_min` of the tiles, then of the coarse level's cells, with room for a vector after each; then a counter, see
    /// [`Buffer::since_refresh`].
    hiz: AlignedWords,
    coarse_w: u32,
    first_coarse: usize,
    /// For the blocks that the screen's edge crosses, the pixels of each sub-tile that are outside: first for the right
    /// column, then for the bottom row, then for the corner.
    outside: [[u32; BLOCK]; 3],
    /// The column of tiles and the row of blocks in which the screen's edge crosses sub-tiles, if any.
    edge_column: u32,
    edge_row: u32,
}

impl Buffer {
    pub fn new(
        width: u32,
        height: u32,
        rule: UpdateRule,
        allocator: Allocator,
        statistics: bool,
    ) -> Result<Self, Error> {
        let (tiles_w, tiles_h) = (width.div_ceil(TILE_WIDTH), height.div_ceil(TILE_HEIGHT));
        // Whole blocks.
        let tiles = tiles_w as usize * tiles_h.next_multiple_of(2) as usize;
        let right = width - (tiles_w - 1) * TILE_WIDTH;
        let bottom = height - (tiles_h - 1) / 2 * BLOCK_HEIGHT;
        let (coarse_w, coarse_h) = hiz::counts(tiles_w, tiles_h);
        let first_coarse = tiles + MAX_LANES;
        let mut buffer = Self {
            width,
            height,
            tiles_w,
            tiles_h,
            rule,
            statistics,
            planes: AlignedWords::new(tiles * plane_count(rule) * SUB_TILES, allocator)?,
            hiz: AlignedWords::new(first_coarse + coarse_w as usize * coarse_h as usize + MAX_LANES + 1, allocator)?,
            coarse_w,
            first_coarse,
            outside: [outside(right, BLOCK_HEIGHT), outside(TILE_WIDTH, bottom), outside(right, bottom)],
            edge_column: if width.is_multiple_of(8) { u32::MAX } else { tiles_w - 1 },
            edge_row: if height.is_multiple_of(4) { u32::MAX } else { (tiles_h - 1) / 2 },
        };
        buffer.clear();
        Ok(buffer)
    }

    pub fn width(&self) -> u32 {
        self.width
    }

    pub fn height(&self) -> u32 {
        self.height
    }

    /// Width and height, in pixels.
    #[inline(always)]
    pub fn size(&self) -> (u32, u32) {
        (self.width, self.height)
    }

    pub fn tiles_w(&self) -> u32 {
        self.tiles_w
    }

    pub fn rule(&self) -> UpdateRule {
        self.rule
    }

    /// Are statistics collected?
    pub fn statistics(&self) -> bool {
        self.statistics
    }

    /// Every tile of the buffer.
    pub fn all_tiles(&self) -> TileRect {
        TileRect { x0: 0, y0: 0, x1: self.tiles_w, y1: self.tiles_h }
    }

    pub fn clear(&mut self) {
        // SAFETY: `&mut self`, and the array has that length; any bit pattern is an f32.
        let z_min = unsafe {
            core::slice::from_raw_parts_mut(self.hiz.as_ptr().cast::<core::mem::MaybeUninit<f32>>(), self.hiz.len())
        };
        z_min.fill(core::mem::MaybeUninit::new(CLEARED));
        // SAFETY: `&mut self`.
        unsafe { self.since_refresh().write(0) };
    }

    pub fn bin_size(&self, bins_w: u32, bins_h: u32) -> Result<(u32, u32), Error> {
        let of = |size: u32, bins: u32, tile: u32| match size.checked_div(bins) {
            Some(bin) if bin >= tile => Ok(bin / tile * tile),
            _ => Err(Error::InvalidSize),
        };
        Ok((of(self.width, bins_w, TILE_WIDTH)?, of(self.height, bins_h, TILE_HEIGHT)?))
    }

    /// The tiles of a scissor rectangle, or of the whole screen.
    pub fn scissor_tiles(&self, scissor: Option<ScissorRect>) -> Result<TileRect, Error> {
        let Some(r) = scissor else { return Ok(self.all_tiles()) };
        let span = |min: i32, max: i32, size: u32, tile: u32| {
            let (min, max) = (u32::try_from(min).ok()?, u32::try_from(max).ok()?);
            let end = size.next_multiple_of(tile);
            let whole = min % tile == 0 && (max % tile == 0 || max == size);
            (whole && min <= max && max <= end).then_some((min / tile, max.div_ceil(tile)))
        };
        let (x0, x1) = span(r.min_x, r.max_x, self.width, TILE_WIDTH).ok_or(Error::InvalidSize)?;
        let (y0, y1) = span(r.min_y, r.max_y, self.height, TILE_HEIGHT).ok_or(Error::InvalidSize)?;
        Ok(TileRect { x0, y0, x1, y1 })
    }

    /// The planes of the first block; each following block is `BLOCK` words per plane further.
    #[inline(always)]
    pub fn planes(&self) -> *mut u32 {
        self.planes.as_ptr()
    }

    /// The planes of tile (x, y), `BLOCK` words apart.
    #[inline(always)]
    pub fn tile(&self, x: u32, y: u32) -> *mut u32 {
        let block = y as usize / 2 * self.tiles_w as usize + x as usize;
        let words = block * plane_count(self.rule) * BLOCK + (y % 2) as usize * SUB_TILES;
        debug_assert!(words < self.planes.len());
        self.planes.as_ptr().wrapping_add(words)
    }

    /// `z_min` of the tiles, row by row, in whole blocks, with room for a vector after them.
    #[inline(always)]
    pub fn z_min(&self) -> *mut f32 {
        self.hiz.as_ptr().cast()
    }

    /// `z_min` of the coarse level's cells, row by row, with room for a vector after them.
    #[inline(always)]
    pub fn coarse(&self) -> *mut f32 {
        self.z_min().wrapping_add(self.first_coarse)
    }

    /// How many tiles have been drawn into since the coarse level was refreshed.
    #[inline(always)]
    fn since_refresh(&self) -> *mut u32 {
        self.hiz.as_ptr().wrapping_add(self.hiz.len() - 1)
    }

    /// Cells per row of the coarse level.
    #[inline(always)]
    pub fn coarse_w(&self) -> u32 {
        self.coarse_w
    }

    /// The index of the coarse level's first cell, counted from the first tile's `z_min`.
    #[inline(always)]
    pub fn first_coarse(&self) -> usize {
        self.first_coarse
    }

    /// `z_min` of tile (x, y).
    #[inline(always)]
    pub fn z_min_of(&self, x: u32, y: u32) -> *mut f32 {
        self.z_min().wrapping_add(y as usize * self.tiles_w as usize + x as usize)
    }

    /// The pixels outside the screen in tile (x, y) and, if y is even, in the tile below, eight words each; `None` if
    /// their block has none.
    #[inline(always)]
    pub fn outside_mask(&self, x: u32, y: u32) -> Option<*const u32> {
        let right = x + 1 == self.tiles_w && !self.width.is_multiple_of(TILE_WIDTH);
        let bottom = y / 2 == (self.tiles_h - 1) / 2 && !self.height.is_multiple_of(BLOCK_HEIGHT);
        let outside = match (right, bottom) {
            (false, false) => return None,
            (true, false) => &self.outside[0],
            (false, true) => &self.outside[1],
            (true, true) => &self.outside[2],
        };
        Some(outside.as_ptr().wrapping_add((y % 2) as usize * SUB_TILES))
    }

    /// Whether the screen's edge crosses sub-tiles anywhere.
    #[inline(always)]
    pub fn has_edge_masks(&self) -> bool {
        self.edge_column != u32::MAX || self.edge_row != u32::MAX
    }

    /// [`Self::outside_mask`], but only if the screen's edge crosses sub-tiles.
    #[inline(always)]
    pub fn edge_mask(&self, x: u32, y: u32) -> Option<*const u32> {
        let right = x == self.edge_column;
        let bottom = y / 2 == self.edge_row;
        if right || bottom { self.outside_mask(x, y) } else { None }
    }
}

/// Words per sub-tile: depths and masks.
#[inline(always)]
fn plane_count(rule: UpdateRule) -> usize {
    with_rule!(rule, R => R::PLANES)
}

/// The pixels of a block outside its first `width` columns and `height` rows.
fn outside(width: u32, height: u32) -> [u32; BLOCK] {
    core::array::from_fn(|lane| {
        let (left, top) = (lane as u32 % 4 * 8, lane as u32 / 4 * 4);
        (0..32).filter(|bit| left + bit % 8 >= width || top + bit / 8 >= height).map(|bit| 1 << bit).sum()
    })
}
