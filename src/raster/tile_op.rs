//! The operations of the traversal in a tile: an update or a comparison.

use super::tile_rows::TILE_ROWS;
use crate::buffer::TilePlace;
use crate::geometry::Coverage;
use crate::simd::Simd;

/// An operation on tiles.
pub(crate) trait TileOp<T: Simd> {
    /// Number of the buffer's planes that it reads.
    const PLANES: usize;
    /// How many tile rows to list at first: few if the first tile may end the traversal.
    const FIRST_TILE_ROWS: usize = TILE_ROWS;
    /// The kind of coverage and depth bound it needs.
    type Coverage: Coverage;

    /// Tiles with this `z_min` in which something at `nearest` has an effect.
    #[inline(always)]
    fn is_candidate(t: T, z_min: T::F, nearest: T::F) -> T::M {
        Self::Coverage::visible(t, nearest, z_min)
    }

    /// Processes the pixels `covered` at `depth` in a tile of a row and, with sixteen lanes, in the tile below. Returns
    /// false if no more tiles are needed.
    ///
    /// # Safety
    /// `at` is a tile of the buffer, and the operation may access it.
    unsafe fn tile(&mut self, t: T, at: TilePlace, row: impl Fn() -> u32, covered: T::I, depth: T::F) -> bool;

    /// As [`Self::tile`], with all pixels of the tile or tiles covered.
    ///
    /// # Safety
    /// As [`Self::tile`].
    unsafe fn whole_tile(&mut self, t: T, at: TilePlace, row: impl Fn() -> u32, depth: T::F) -> bool;

    /// Called after some tiles, at most [`MAX_TILES`](super::tile_rows::MAX_TILES).
    #[inline(always)]
    fn tiles_done(&mut self, _tiles: usize) {}
}
