//! What the traversal asks of a draw and of a query.

use crate::buffer::TilePlace;
use crate::simd::Simd;

/// What happens in a tile.
pub(super) trait TileStep<T: Simd> {
    /// Planes of the buffer.
    const PLANES: usize;
    /// Is the bound of a draw clamped from below, rather than that of a query from above?
    const DRAWS: bool;

    /// Tiles of these least depths in which something at `nearest` matters.
    fn open(t: T, least: T::F, nearest: T::F) -> T::M;

    /// Takes the pixels `covered` at `depth` in a tile of a row, and, with sixteen lanes, in the tile below. False: no
    /// more are needed.
    ///
    /// # Safety
    /// It is a tile of the buffer, and the caller of the pipeline allowed its use.
    unsafe fn tile(&mut self, t: T, at: TilePlace, row: impl Fn() -> u32, covered: T::I, depth: T::F) -> bool;

    /// The same for all pixels of the tile or tiles.
    ///
    /// # Safety
    /// As [`Self::tile`].
    unsafe fn whole_tile(&mut self, t: T, at: TilePlace, row: impl Fn() -> u32, depth: T::F) -> bool;

    /// Comes after some tiles, at most [`MAX_TILES`](super::strips::MAX_TILES).
    #[inline(always)]
    fn tiles_done(&mut self, _tiles: usize) {}
}
