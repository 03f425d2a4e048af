//! Candidate tiles: where they are in memory, and what the traversal needs from their tile row.
//!
//! With sixteen lanes they are located a vector at a time, because a look-up in the 32 values of the tile rows is a
//! single instruction there. With narrower vectors such a look-up is a gather, and locating tiles one by one is faster.

use core::mem::MaybeUninit;

use super::{LOW, MAX_TILES, PLACE_SHIFT, TILE_ROWS, TileRows, Words, unpack};
use crate::buffer::{BLOCK, SUB_TILES, TILE_WIDTH};
use crate::raster::tile_op::TileOp;
use crate::simd::{MAX_LANES, Simd};

/// Padded by one vector.
type List<X> = [MaybeUninit<X>; MAX_TILES + MAX_LANES];

/// Lists of the candidate tiles, uninitialised.
#[repr(C, align(64))]
pub(super) struct CandidateTiles {
    /// Tile row number and column.
    pub named: List<u32>,
    /// For located tiles: the byte offset of their planes, plus one if they are fully covered.
    located: List<u32>,
    number: List<u32>,
    /// First column of pixels.
    left: List<u32>,
    /// First column of sub-tiles, relative to the first tile of the bounds.
    sub_column: List<f32>,
}

/// A candidate tile.
pub(crate) struct Tile<T: Simd> {
    pub tile_row: usize,
    /// Byte offset of its planes.
    pub planes: u32,
    /// Whether it is fully covered.
    pub whole: bool,
    pub number: u32,
    /// Its first column of pixels.
    pub left: u32,
    /// Its columns of sub-tiles, relative to the first tile of the bounds.
    pub sub_columns: T::F,
}

impl TileRows<'_> {
    /// Address of the planes of the `k`th candidate tile, as a byte offset; past the last one, that of some tile.
    ///
    /// # Safety
    /// `next` counted the tile, or the one [`AHEAD`](crate::raster::traverse::AHEAD) before it.
    #[inline(always)]
    pub unsafe fn about<T: Simd, S: TileOp<T>>(&self, k: usize) -> u32 {
        // SAFETY: the caller's contract: the lists are padded by a vector. With sixteen lanes, the counted tiles were
        // located.
        unsafe {
            if T::LANES == MAX_LANES {
                return self.lists.tiles.located.get_unchecked(k).assume_init();
            }
            let (tile_row, x) = unpack(self.lists.tiles.named.get_unchecked(k).assume_init());
            self.lists.planes.get_unchecked(tile_row).assume_init() + x * bytes_of::<T, S>()
        }
    }

    /// The column of the `k`th candidate tile.
    ///
    /// # Safety
    /// `next` counted the tile.
    #[inline(always)]
    pub unsafe fn column(&self, k: usize) -> u32 {
        // SAFETY: the caller's contract.
        unsafe { self.lists.tiles.named.get_unchecked(k).assume_init() & LOW }
    }

    /// The `k`th candidate tile.
    ///
    /// # Safety
    /// `next` counted the tile.
    #[inline(always)]
    pub unsafe fn tile<T: Simd, S: TileOp<T>>(&self, t: T, k: usize) -> Tile<T> {
        let lists = &*self.lists;
        // SAFETY: the caller's contract; the tile rows of counted tiles were bounded, and with sixteen lanes
        // the tiles were located.
        unsafe {
            let (tile_row, x) = unpack(lists.tiles.named.get_unchecked(k).assume_init());
            let sub_columns = t.and(t.iota(), t.i(3));
            if T::LANES == MAX_LANES {
                let at = lists.tiles.located.get_unchecked(k).assume_init();
                let first = lists.tiles.sub_column.get_unchecked(k).assume_init();
                return Tile {
                    tile_row,
                    planes: at & !1,
                    whole: at & 1 != 0,
                    number: lists.tiles.number.get_unchecked(k).assume_init(),
                    left: lists.tiles.left.get_unchecked(k).assume_init(),
                    // Small integers: exact.
                    sub_columns: t.add(t.f(first), t.to_f(sub_columns)),
                };
            }
            let of = |list: &Words| list.get_unchecked(tile_row).assume_init();
            let first = (4 * x).wrapping_sub(of(&lists.sub_column));
            Tile {
                tile_row,
                planes: of(&lists.planes) + x * bytes_of::<T, S>(),
                whole: x.wrapping_sub(of(&lists.inner_first)) < of(&lists.inner),
                number: of(&lists.index) + x,
                left: x * TILE_WIDTH,
                sub_columns: t.to_f(t.or(t.i(first as i32), sub_columns)),
            }
        }
    }

    /// Locates the candidate tiles, a vector at a time.
    ///
    /// # Safety
    /// The first `tiles` were listed.
    #[inline(always)]
    pub(super) unsafe fn locate<T: Simd, S: TileOp<T>>(&mut self, t: T, tiles: usize) {
        let lists = &mut *self.lists;
        // SAFETY: there is room for a vector after the last tile.
        unsafe { t.store_i(lists.tiles.located.as_mut_ptr().add(tiles).cast(), t.i(0)) };
        let mut k = 0;
        while k < tiles {
            // SAFETY: the caller's contract; a padding vector was written after them; all 32 words of
            // the tile row lists were written. The tile lists have room for a vector after the last tile.
            unsafe {
                let word = t.load_i(lists.tiles.named.as_ptr().add(k).cast());
                let (tile_row, x) =
                    (t.and(t.sra::<PLACE_SHIFT>(word), t.i(TILE_ROWS as i32 - 1)), t.and(word, t.i(LOW as i32)));
                let of = |list: &Words| t.bits(t.lookup_32(list.as_ptr().cast(), tile_row));
                let inner = t.sub_i(x, of(&lists.inner_first));
                let whole = t.and_not_m(t.gt_i(t.i(0), inner), t.gt_i(of(&lists.inner), inner));
                let whole = t.select_i(whole, t.i(1), t.i(0));
                let at = t.or(t.add_i(of(&lists.planes), planes_before::<T, S>(t, x)), whole);
                t.store_i(lists.tiles.located.as_mut_ptr().add(k).cast(), at);
                t.store_i(lists.tiles.number.as_mut_ptr().add(k).cast(), t.add_i(of(&lists.index), x));
                t.store_i(lists.tiles.left.as_mut_ptr().add(k).cast(), t.shl::<5>(x));
                let column = t.sub_i(t.shl::<2>(x), of(&lists.sub_column));
                t.store_f(lists.tiles.sub_column.as_mut_ptr().add(k).cast(), t.to_f(column));
            }
            k += T::LANES;
        }
    }
}

/// Shift that gives the byte offset of the lower tile's half of a block's plane.
pub(super) const HALF_SHIFT: i32 = (SUB_TILES * size_of::<u32>()).trailing_zeros() as i32;
const BLOCK_SHIFT: i32 = (BLOCK * size_of::<u32>()).trailing_zeros() as i32;

/// Size of a block's planes in bytes.
#[inline(always)]
const fn bytes_of<T: Simd, S: TileOp<T>>() -> u32 {
    (S::PLANES as u32) << BLOCK_SHIFT
}

/// Size of the planes of this many blocks in bytes.
#[inline(always)]
pub(super) fn planes_before<T: Simd, S: TileOp<T>>(t: T, blocks: T::I) -> T::I {
    const { assert!(S::PLANES < 8) }
    let mut planes = t.i(0);
    if S::PLANES & 1 != 0 {
        planes = blocks;
    }
    if S::PLANES & 2 != 0 {
        planes = t.add_i(planes, t.shl::<1>(blocks));
    }
    if S::PLANES & 4 != 0 {
        planes = t.add_i(planes, t.shl::<2>(blocks));
    }
    t.shl::<BLOCK_SHIFT>(planes)
}
