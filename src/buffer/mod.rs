//! The masked hierarchical depth buffer: where it lies in memory and how a tile of it is read.
//!
//! The screen is cut into tiles of 32x8 pixels, each of eight 8x4 sub-tiles in two rows of four; lane `i`
//! of a vector is the sub-tile in column `i % 4` and row `i / 4`. Bit `8 * y + x` of a mask is the pixel
//! in column `x` and row `y` of the sub-tile. A tile is five planes of eight words (20 bytes a
//! sub-tile) under the three-layer rule and three (12 bytes) under the others, plane after plane.
//!
//! Beside them each tile has the least of its reference depths, so that a triangle or rectangle behind
//! all of it is done with in one comparison. There, [`UNTOUCHED`] says that nothing was drawn since the
//! last clear and that the planes hold old contents: a clear writes four bytes a tile and no more.
//!
//! Sub-tiles that lie outside of the screen, in the tiles of its right and lower border, are infinitely
//! near from the start: nothing draws into them, nothing waits for them. Of sub-tiles that lie partly outside,
//! a triangle that covers any pixel inside covers all pixels outside.

mod accurate;
pub(crate) mod merge;
pub(crate) mod pixels;
mod quick;
mod rule;
mod three_layer;

pub(crate) use accurate::Accurate;
pub(crate) use quick::Quick;
pub(crate) use rule::{Planes, Rule};
pub(crate) use three_layer::ThreeLayer;

use crate::allocator::AlignedWords;
use crate::simd::{MAX_LANES, Simd};
use crate::{Allocator, Error, ScissorRect, UpdateRule};

pub(crate) const TILE_WIDTH: u32 = 32;
pub(crate) const TILE_HEIGHT: u32 = 8;
/// Sub-tiles in a tile, which is lanes in a tile's vector.
pub(crate) const SUB_TILES: usize = 8;

/// The least depth of a tile into which nothing was drawn since the last clear.
pub(crate) const UNTOUCHED: f32 = -1.0;
/// The reference depth of sub-tiles outside of the screen.
const OUTSIDE: f32 = f32::MAX;

/// A rectangle of tiles, the second corner outside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TileRect {
    pub x0: u32,
    pub y0: u32,
    pub x1: u32,
    pub y1: u32,
}

pub(crate) struct Buffer {
    width: u32,
    height: u32,
    tiles_w: u32,
    tiles_h: u32,
    rule: UpdateRule,
    planes: AlignedWords,
    least: AlignedWords,
    /// For the tiles that the screen's edge cuts: which pixels of each sub-tile are outside.
    /// First those of the right column, then of the lowest row, then of the corner.
    border: [[u32; SUB_TILES]; 3],
}

impl Buffer {
    pub fn new(width: u32, height: u32, rule: UpdateRule, allocator: Allocator) -> Result<Self, Error> {
        let (tiles_w, tiles_h) = (width.div_ceil(TILE_WIDTH), height.div_ceil(TILE_HEIGHT));
        let tiles = tiles_w as usize * tiles_h as usize;
        let (right, bottom) = (width - (tiles_w - 1) * TILE_WIDTH, height - (tiles_h - 1) * TILE_HEIGHT);
        let mut buffer = Self {
            width,
            height,
            tiles_w,
            tiles_h,
            rule,
            planes: AlignedWords::new(tiles * plane_count(rule) * SUB_TILES, allocator)?,
            // The widest vector may be loaded from the last of them.
            least: AlignedWords::new(tiles + MAX_LANES, allocator)?,
            border: [outside(right, TILE_HEIGHT), outside(TILE_WIDTH, bottom), outside(right, bottom)],
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

    pub fn tiles_w(&self) -> u32 {
        self.tiles_w
    }

    pub fn rule(&self) -> UpdateRule {
        self.rule
    }

    /// Every tile of the buffer.
    pub fn all_tiles(&self) -> TileRect {
        TileRect { x0: 0, y0: 0, x1: self.tiles_w, y1: self.tiles_h }
    }

    pub fn clear(&mut self) {
        // SAFETY: `&mut self`, and the array is that long; any bits are an f32.
        let least = unsafe {
            core::slice::from_raw_parts_mut(self.least.as_ptr().cast::<core::mem::MaybeUninit<f32>>(), self.least.len())
        };
        least.fill(core::mem::MaybeUninit::new(UNTOUCHED));
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

    /// The planes of tile `index` (row by row), which is below the number of tiles.
    #[inline(always)]
    pub fn tile(&self, index: usize) -> *mut u32 {
        debug_assert!((index + 1) * plane_count(self.rule) * SUB_TILES <= self.planes.len());
        self.planes.as_ptr().wrapping_add(index * plane_count(self.rule) * SUB_TILES)
    }

    /// The least depths of the tiles, row by row, and room for a vector more.
    #[inline(always)]
    pub fn least(&self) -> *mut f32 {
        self.least.as_ptr().cast()
    }

    /// The pixels of tile (x, y) that lie outside of the screen, where there are any.
    #[inline(always)]
    pub fn border(&self, x: u32, y: u32) -> Option<&[u32; SUB_TILES]> {
        let right = x + 1 == self.tiles_w && !self.width.is_multiple_of(TILE_WIDTH);
        let bottom = y + 1 == self.tiles_h && !self.height.is_multiple_of(TILE_HEIGHT);
        match (right, bottom) {
            (false, false) => None,
            (true, false) => Some(&self.border[0]),
            (false, true) => Some(&self.border[1]),
            (true, true) => Some(&self.border[2]),
        }
    }
}

/// Words of a sub-tile: depths and masks.
#[inline(always)]
pub(crate) const fn plane_count(rule: UpdateRule) -> usize {
    match rule {
        UpdateRule::ThreeLayer => 5,
        UpdateRule::Quick | UpdateRule::Accurate => 3,
    }
}

/// The pixels of a tile that are not among its first `width` columns and `height` rows.
fn outside(width: u32, height: u32) -> [u32; SUB_TILES] {
    core::array::from_fn(|lane| {
        let (left, top) = (lane as u32 % 4 * 8, lane as u32 / 4 * 4);
        (0..32).filter(|bit| left + bit % 8 >= width || top + bit / 8 >= height).map(|bit| 1 << bit).sum()
    })
}

/// The contents of a tile into which nothing was drawn.
#[inline(always)]
pub(crate) fn fresh<S: Simd, R: Rule>(s: S, border: Option<&[u32; SUB_TILES]>) -> Planes<S> {
    let mut planes = R::empty(s);
    if let Some(outside) = border {
        // SAFETY: eight words.
        let all_outside = s.eq_i(unsafe { s.load_i(outside.as_ptr()) }, s.i(-1));
        planes.z0 = s.select(all_outside, s.f(OUTSIDE), planes.z0);
    }
    planes
}
