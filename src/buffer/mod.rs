//! The masked hierarchical depth buffer: where it lies in memory and how a tile of it is read.
//!
//! The screen is cut into tiles of 32x8 pixels, each of eight 8x4 sub-tiles in two rows of four; lane `i`
//! of a vector is the sub-tile in column `i % 4` and row `i / 4`. Bit `8 * y + x` of a mask is the pixel
//! in column `x` and row `y` of the sub-tile. In memory two tiles, one below the other, are a block: five planes of
//! sixteen words (20 bytes a sub-tile) under the three-layer rule, seven (28 bytes) under the four-layer rule and three
//! (12 bytes) under the others, plane after plane, the upper tile's eight words first. So a plane is one cache line, vectors of sixteen lanes take a
//! block at once, and vectors of eight lanes half of it.
//!
//! Beside them each tile has the least of its reference depths, so that a triangle or rectangle behind
//! all of it is done with in one comparison. There, [`UNTOUCHED`] says that nothing was drawn since the
//! last clear and that the planes hold old contents: a clear writes four bytes a tile and no more.
//!
//! Sub-tiles that lie outside of the screen, in the tiles of its right and lower border, are infinitely
//! near from the start: nothing draws into them, nothing waits for them. Of sub-tiles that lie partly outside,
//! a triangle that covers any pixel inside covers all pixels outside.

mod accurate;
pub(crate) mod areas;
mod four_layer;
pub(crate) mod merge;
pub(crate) mod pixels;
mod quick;
mod rule;
#[cfg(test)]
mod tests;
mod three_layer;

pub(crate) use accurate::Accurate;
pub(crate) use four_layer::FourLayer;
pub(crate) use quick::Quick;
pub(crate) use rule::{Planes, Rule};
pub(crate) use three_layer::ThreeLayer;

use crate::allocator::AlignedWords;
use crate::simd::{MAX_LANES, Simd, store_relaxed};
use crate::{Allocator, Error, ScissorRect, UpdateRule};

pub(crate) const TILE_WIDTH: u32 = 32;
pub(crate) const TILE_HEIGHT: u32 = 8;
const BLOCK_HEIGHT: u32 = 2 * TILE_HEIGHT;
/// Sub-tiles in a tile, which is lanes in a tile's vector.
pub(crate) const SUB_TILES: usize = 8;

/// Words of a plane of a block, which is two tiles.
pub(crate) const BLOCK: usize = 2 * SUB_TILES;

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
    statistics: bool,
    planes: AlignedWords,
    /// The least depths of the tiles, then those of the areas (see `areas.rs`), with room for a vector after each.
    least: AlignedWords,
    areas_w: u32,
    first_area: usize,
    /// For the blocks that the screen's edge cuts: which pixels of each sub-tile are outside.
    /// First those of the right column, then of the lowest row, then of the corner.
    border: [[u32; BLOCK]; 3],
    /// The column of tiles and the row of blocks in which the screen's edge cuts sub-tiles, or none.
    cut_column: u32,
    cut_row: u32,
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
        let (areas_w, areas_h) = areas::counts(tiles_w, tiles_h);
        let first_area = tiles + MAX_LANES;
        let mut buffer = Self {
            width,
            height,
            tiles_w,
            tiles_h,
            rule,
            statistics,
            planes: AlignedWords::new(tiles * plane_count(rule) * SUB_TILES, allocator)?,
            least: AlignedWords::new(first_area + areas_w as usize * areas_h as usize + MAX_LANES + 1, allocator)?,
            areas_w,
            first_area,
            border: [outside(right, BLOCK_HEIGHT), outside(TILE_WIDTH, bottom), outside(right, bottom)],
            cut_column: if width.is_multiple_of(8) { u32::MAX } else { tiles_w - 1 },
            cut_row: if height.is_multiple_of(4) { u32::MAX } else { (tiles_h - 1) / 2 },
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

    /// Are draws and queries counted?
    pub fn statistics(&self) -> bool {
        self.statistics
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
        // SAFETY: `&mut self`, and a word of the buffer.
        unsafe { self.drawn().write(0) };
    }

    /// Clears a rectangle of tiles that begins with an area and ends with one or at the buffer's end.
    ///
    /// # Safety
    /// Nobody else writes its tiles and areas; others may read least depths as words.
    pub unsafe fn clear_tiles(&self, clip: TileRect) {
        // Blocks are whole: the lower tiles of the last may lie below the screen.
        for y in clip.y0..clip.y1.next_multiple_of(2) {
            for x in clip.x0..clip.x1 {
                // SAFETY: the caller's contract.
                unsafe { store_relaxed(self.least_of(x, y), UNTOUCHED) };
            }
        }
        // SAFETY: the caller's contract.
        unsafe { areas::clear(self, clip) };
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

    /// The planes of the first block; those of each next are `BLOCK` words for every plane away.
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

    /// The least depths of the tiles, row by row, for whole blocks, and room for a vector more.
    #[inline(always)]
    pub fn least(&self) -> *mut f32 {
        self.least.as_ptr().cast()
    }

    /// The least depths of the areas, row by row, and room for a vector more.
    #[inline(always)]
    pub fn areas(&self) -> *mut f32 {
        self.least().wrapping_add(self.first_area)
    }

    /// How many tiles were drawn into since the areas were brought up to date.
    #[inline(always)]
    pub fn drawn(&self) -> *mut u32 {
        self.least.as_ptr().wrapping_add(self.least.len() - 1)
    }

    /// Areas in a row.
    #[inline(always)]
    pub fn areas_w(&self) -> u32 {
        self.areas_w
    }

    /// The number of the first area, counted from the first tile's least depth on.
    #[inline(always)]
    pub fn first_area(&self) -> usize {
        self.first_area
    }

    /// The least depth of tile (x, y).
    #[inline(always)]
    pub fn least_of(&self, x: u32, y: u32) -> *mut f32 {
        self.least().wrapping_add(y as usize * self.tiles_w as usize + x as usize)
    }

    /// The pixels that lie outside of the screen in tile (x, y) and, where y is even, in the tile below, eight words
    /// each; if there are any in their block.
    #[inline(always)]
    pub fn border(&self, x: u32, y: u32) -> Option<*const u32> {
        let right = x + 1 == self.tiles_w && !self.width.is_multiple_of(TILE_WIDTH);
        let bottom = y / 2 == (self.tiles_h - 1) / 2 && !self.height.is_multiple_of(BLOCK_HEIGHT);
        let border = match (right, bottom) {
            (false, false) => return None,
            (true, false) => &self.border[0],
            (false, true) => &self.border[1],
            (true, true) => &self.border[2],
        };
        Some(border.as_ptr().wrapping_add((y % 2) as usize * SUB_TILES))
    }

    /// Does the screen's edge cut through sub-tiles anywhere?
    #[inline(always)]
    pub fn cuts(&self) -> bool {
        self.cut_column != u32::MAX || self.cut_row != u32::MAX
    }

    /// The same, if the screen's edge cuts through sub-tiles there.
    #[inline(always)]
    pub fn cut(&self, x: u32, y: u32) -> Option<*const u32> {
        let right = x == self.cut_column;
        let bottom = y / 2 == self.cut_row;
        if right || bottom { self.border(x, y) } else { None }
    }
}

/// Words of a sub-tile: depths and masks.
#[inline(always)]
pub(crate) const fn plane_count(rule: UpdateRule) -> usize {
    match rule {
        UpdateRule::ThreeLayer => ThreeLayer::PLANES,
        UpdateRule::FourLayer => FourLayer::PLANES,
        UpdateRule::Quick => Quick::PLANES,
        UpdateRule::Accurate => Accurate::PLANES,
    }
}

/// The pixels of a block that are not among its first `width` columns and `height` rows.
fn outside(width: u32, height: u32) -> [u32; BLOCK] {
    core::array::from_fn(|lane| {
        let (left, top) = (lane as u32 % 4 * 8, lane as u32 / 4 * 4);
        (0..32).filter(|bit| left + bit % 8 >= width || top + bit / 8 >= height).map(|bit| 1 << bit).sum()
    })
}

/// The contents of tiles into which nothing was drawn, and where their border is.
///
/// # Safety
/// The border can be read for a vector.
#[inline(always)]
unsafe fn fresh<S: Simd, R: Rule>(s: S, border: Option<*const u32>) -> Planes<S> {
    let mut planes = R::empty(s);
    if let Some(outside) = border {
        // SAFETY: the caller's contract.
        let all_outside = s.eq_i(unsafe { s.load_i(outside) }, s.i(-1));
        planes.z0 = s.select(all_outside, s.f(OUTSIDE), planes.z0);
    }
    planes
}

/// Where a tile is: its column, its planes, its least depth, and how far it is to that of the tile below. Its row is
/// seldom asked for, and goes as a function.
#[derive(Clone, Copy)]
pub(crate) struct TilePlace {
    pub x: u32,
    pub planes: *mut u32,
    pub least: *mut f32,
    pub pitch: usize,
}

impl TilePlace {
    #[inline(always)]
    pub fn new(buffer: &Buffer, x: u32, y: u32) -> Self {
        let pitch = buffer.tiles_w() as usize;
        Self { x, planes: buffer.tile(x, y), least: buffer.least_of(x, y), pitch }
    }
}

/// Whether something was drawn since the last clear into a tile, and, for vectors of sixteen lanes, into the tile below
/// (else it is the same again): the bits of their least depths, of which only [`UNTOUCHED`] is negative.
#[derive(Clone, Copy)]
pub(crate) struct Touched {
    upper: i32,
    lower: i32,
}

impl Touched {
    /// # Safety
    /// It is a tile of the buffer, into which nobody draws.
    #[inline(always)]
    pub unsafe fn of<S: Simd>(at: TilePlace) -> Self {
        const { assert!(S::LANES.is_multiple_of(SUB_TILES)) }
        let below = if S::LANES == SUB_TILES { 0 } else { at.pitch };
        // SAFETY: the caller's contract; blocks are whole.
        unsafe { Self { upper: (*at.least).to_bits() as i32, lower: (*at.least.add(below)).to_bits() as i32 } }
    }

    #[inline(always)]
    pub fn all(self) -> bool {
        self.upper | self.lower >= 0
    }

    #[inline(always)]
    pub fn none(self) -> bool {
        self.upper & self.lower < 0
    }
}

/// What is in a tile, or, for a vector of sixteen lanes and an even row, in it and in the tile below.
///
/// # Safety
/// It is a tile of the buffer, which was made for the rule `R` and into which nobody draws.
#[inline(always)]
pub(crate) unsafe fn load<S: Simd, R: Rule>(s: S, buffer: &Buffer, at: TilePlace, row: impl Fn() -> u32) -> Planes<S> {
    // SAFETY: the caller's contract; blocks are whole.
    unsafe {
        let touched = Touched::of::<S>(at);
        let planes = R::load(s, at.planes);
        if touched.all() {
            return planes;
        }
        let untouched = fresh::<S, R>(s, buffer.border(at.x, row()));
        if touched.none() {
            return untouched;
        }
        let first = s.first(SUB_TILES);
        let lanes = if touched.lower < 0 { first } else { s.and_not_m(first, s.first(S::LANES)) };
        choose(s, lanes, &planes, &untouched)
    }
}

/// The lanes in `m` of one, the others of the other.
#[inline(always)]
fn choose<S: Simd>(s: S, m: S::M, a: &Planes<S>, b: &Planes<S>) -> Planes<S> {
    Planes {
        z0: s.select(m, a.z0, b.z0),
        z_near: s.select(m, a.z_near, b.z_near),
        z_mid: s.select(m, a.z_mid, b.z_mid),
        z_far: s.select(m, a.z_far, b.z_far),
        near: s.select_i(m, a.near, b.near),
        mid: s.select_i(m, a.mid, b.mid),
        far: s.select_i(m, a.far, b.far),
    }
}
