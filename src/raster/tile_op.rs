//! What the traversal does in a tile: an update, a comparison.

use crate::buffer::TilePlace;
use crate::geometry::Coverage;
use crate::simd::Simd;

/// An operation on tiles.
pub(crate) trait TileOp<T: Simd> {
    /// Planes of the buffer that it reads.
    const PLANES: usize;
    /// Which pixels and depths it is given.
    type Coverage: Coverage;

    /// Tiles with this `z_min` in which something at `nearest` matters.
    #[inline(always)]
    fn is_candidate(t: T, z_min: T::F, nearest: T::F) -> T::M {
        Self::Coverage::visible(t, nearest, z_min)
    }

    /// Processes the pixels `covered` at `depth` in a tile of a row and, with sixteen lanes, in the tile below. False: no more
    /// tiles are needed.
    ///
    /// # Safety
    /// It is a tile of the buffer, which the operation may use.
    unsafe fn tile(&mut self, t: T, at: TilePlace, row: impl Fn() -> u32, covered: T::I, depth: T::F) -> bool;

    /// The same for all pixels of the tile or tiles.
    ///
    /// # Safety
    /// As [`Self::tile`].
    unsafe fn whole_tile(&mut self, t: T, at: TilePlace, row: impl Fn() -> u32, depth: T::F) -> bool;

    /// Comes after some tiles, at most [`MAX_TILES`](super::tile_rows::MAX_TILES).
    #[inline(always)]
    fn tiles_done(&mut self, _tiles: usize) {}
}
