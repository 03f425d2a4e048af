//! The tile rows that triangles reach, and their candidate tiles: those whose `z_min` does not hide the triangle.
//!
//! A vector of triangles becomes a list of tile rows, in order. For a vector of tile rows at a time, the edges bound
//! which tiles each one reaches, and the candidates among these form one flat list. No loop has a branch that depends
//! on the scene. The bounds are computed from the edges in f32 and widened by the rounding error, so they may include a
//! tile too many but never miss one.

mod candidate_tiles;

use core::mem::MaybeUninit;

use super::batch::{Batch, Lanes};
use super::tile_op::TileOp;
use crate::buffer::{Buffer, SUB_TILES, TILE_HEIGHT, TILE_WIDTH, TileRect};
use crate::geometry::Coverage;
use crate::simd::{MAX_LANES, Simd};
use candidate_tiles::{CandidateTiles, HALF_SHIFT, planes_before};

/// Tile rows processed at a time, which is about ten triangles. Sixteen is measurably slower; more than 32 gains
/// nothing.
pub(super) const TILE_ROWS: usize = 32;
/// Candidate tiles processed at a time.
const TILES: usize = 192;
/// Including the last vector's.
pub(crate) const MAX_TILES: usize = TILES + MAX_LANES;
/// Below every tile's `z_min`.
const HIDDEN: f32 = -2.0;
/// Eight roundings: of a constant, a slope, their product and their sum, with slack.
const WIDEN: f32 = 8.0 / (1 << 24) as f32;

pub(super) const PLACE_SHIFT: i32 = 16;
pub(super) const LOW: u32 = (1 << PLACE_SHIFT) - 1;

pub(super) type Words = [MaybeUninit<u32>; TILE_ROWS + MAX_LANES];
type Floats = [MaybeUninit<f32>; TILE_ROWS + MAX_LANES];

/// Rows of tiles that one vector covers: sixteen lanes are sixteen rows of pixels, which is two rows of tiles.
#[inline(always)]
pub(super) const fn height<T: Simd>() -> u32 {
    (T::LANES / SUB_TILES) as u32
}

/// Memory for the lists, uninitialised.
#[repr(C, align(64))]
pub(super) struct TileRowLists {
    /// Lane of the triangle and its tile row, in units of a vector's height.
    place: Words,
    /// The tile row's index and the column of its first tile.
    first: Words,
    /// Number of tiles, possibly 0.
    count: Words,
    /// The nearest depth that the triangle has in the row of tiles, or [`HIDDEN`] if it does not reach it; with sixteen
    /// lanes, one for the upper and one for the lower row.
    upper: Floats,
    lower: Floats,
    /// Of the first row of tiles at column 0: the byte offset of the planes, and the tile index.
    planes: Words,
    index: Words,
    /// First column and number of the fully covered tiles.
    inner_first: Words,
    inner: Words,
    /// Its first row of pixels, and the number of rows of sub-tiles from the first tile of the bounds to it.
    top: Floats,
    sub_row: Words,
    /// The depth bound's change per sub-tile, its limit, and the number of sub-tiles left of the bounds' first tile.
    across: Floats,
    limit: Floats,
    sub_column: Words,
    /// For each triangle: its lane and first row, and its number of rows.
    first_of_triangle: [MaybeUninit<u32>; MAX_LANES],
    rows_of_triangle: [MaybeUninit<u32>; MAX_LANES],
    /// Tile rows with a candidate tile.
    with_candidates: [MaybeUninit<u32>; TILE_ROWS + 1],
    tiles: CandidateTiles,
}

/// The tile rows of some triangles, and how far they have been processed.
pub(super) struct TileRows<'a> {
    lists: &'a mut TileRowLists,
    /// Triangles whose tile rows are not listed yet, and the row at which the first of them continues.
    todo: u32,
    row: u32,
    /// Number of tile rows listed, and the next one to process.
    listed: usize,
    next: usize,
    /// How many to list next.
    room: usize,
}

/// Candidates found at a time.
pub(super) struct Candidates {
    pub tile_rows: usize,
    pub tiles: usize,
}

impl<'a> TileRows<'a> {
    /// # Safety
    /// Set-up stored the lanes `triangles` of the batch; the clip consists of tiles of the buffer.
    #[inline(always)]
    pub unsafe fn new<T: Simd, S: TileOp<T>>(
        t: T,
        lists: &'a mut MaybeUninit<TileRowLists>,
        clip: TileRect,
        batch: &Batch,
        triangles: u32,
    ) -> Self {
        // SAFETY: every field is an array of `MaybeUninit`.
        let lists = unsafe { lists.assume_init_mut() };
        // SAFETY: the arrays hold a vector; set-up stored the tiles of all bounds.
        unsafe {
            let rows_of = |tiles: &Lanes<u32>| {
                let row = t.load_i(tiles.as_ptr());
                if height::<T>() == 1 { row } else { t.sra::<1>(row) }
            };
            let first = t.max_i(rows_of(&batch.tile_y0), t.i((clip.y0 / height::<T>()) as i32));
            let last = t.min_i(rows_of(&batch.tile_y1), t.i(clip.y1.div_ceil(height::<T>()) as i32 - 1));
            let rows = t.max_i(t.sub_i(t.add_i(last, t.i(1)), first), t.i(0));
            t.store_i(lists.first_of_triangle.as_mut_ptr().cast(), t.or(t.shl::<PLACE_SHIFT>(t.iota()), first));
            t.store_i(lists.rows_of_triangle.as_mut_ptr().cast(), rows);
        }
        if T::LANES == MAX_LANES {
            // With sixteen lanes all 32 words are looked up, even if only one vector was bounded.
            let TileRowLists { planes, index, inner_first, inner, sub_column, .. } = lists;
            for list in [planes, index, inner_first, inner, sub_column] {
                // SAFETY: a list has room for three vectors.
                unsafe { t.store_i(list.as_mut_ptr().add(T::LANES).cast(), t.i(0)) };
            }
        }
        const { assert!(S::FIRST_TILE_ROWS <= TILE_ROWS) }
        Self { lists, todo: triangles, row: 0, listed: 0, next: 0, room: S::FIRST_TILE_ROWS }
    }

    /// Lane of the triangle, and tile row in units of a vector's height.
    ///
    /// # Safety
    /// `next` listed the tile row.
    #[inline(always)]
    pub unsafe fn place(&self, tile_row: usize) -> (usize, u32) {
        // SAFETY: those were written; the caller's contract.
        let word = unsafe { self.lists.place.get_unchecked(tile_row).assume_init() };
        unpack(word)
    }

    /// The index of the `k`th tile row that has a candidate.
    ///
    /// # Safety
    /// `next` counted it.
    #[inline(always)]
    pub unsafe fn with_candidates(&self, k: usize) -> usize {
        // SAFETY: the caller's contract.
        unsafe { self.lists.with_candidates.get_unchecked(k).assume_init() as usize }
    }

    /// Its first row of pixels, and the number of rows of sub-tiles from the first tile of the bounds to it.
    ///
    /// # Safety
    /// `next` listed the tile row.
    #[inline(always)]
    pub unsafe fn rows(&self, tile_row: usize) -> (f32, i32) {
        // SAFETY: those were bounded; the caller's contract.
        unsafe {
            let sub_row = self.lists.sub_row.get_unchecked(tile_row).assume_init();
            (self.lists.top.get_unchecked(tile_row).assume_init(), sub_row as i32)
        }
    }

    /// The depth bound's change per sub-tile, and its limit.
    ///
    /// # Safety
    /// `next` listed the tile row.
    #[inline(always)]
    pub unsafe fn slope(&self, tile_row: usize) -> (f32, f32) {
        // SAFETY: those were bounded; the caller's contract.
        unsafe {
            (
                self.lists.across.get_unchecked(tile_row).assume_init(),
                self.lists.limit.get_unchecked(tile_row).assume_init(),
            )
        }
    }

    /// Lists the next candidate tiles; `None` if there are no more tile rows.
    ///
    /// # Safety
    /// With the batch and clip given to [`Self::new`], of this buffer.
    #[inline(always)]
    pub unsafe fn next<T: Simd, S: TileOp<T>>(
        &mut self,
        t: T,
        buffer: &Buffer,
        clip: TileRect,
        batch: &Batch,
    ) -> Option<Candidates> {
        if self.next == self.listed {
            self.list::<T>(t);
            if self.listed == 0 {
                return None;
            }
            let mut k = 0;
            while k < self.listed {
                // SAFETY: `k` is below the number listed, and the list is padded.
                unsafe { self.bound::<T, S>(t, buffer, clip, batch, k) };
                k += T::LANES;
            }
        }
        let found = self.find_candidates::<T, S>(t, buffer, clip);
        if T::LANES == MAX_LANES {
            // SAFETY: they were just listed.
            unsafe { self.locate::<T, S>(t, found.tiles) };
        }
        Some(found)
    }

    /// Lists the tile rows of the next triangles.
    #[inline(always)]
    fn list<T: Simd>(&mut self, t: T) {
        let mut listed = 0;
        let mut place = 0;
        let room = core::mem::replace(&mut self.room, TILE_ROWS);
        while self.todo != 0 && listed < room {
            let lane = self.todo.trailing_zeros() as usize;
            // SAFETY: `new` wrote the values of every lane; there is room for a vector after `TILE_ROWS`.
            let rows = unsafe {
                place = self.lists.first_of_triangle.get_unchecked(lane).assume_init() + self.row;
                let places = t.add_i(t.i(place as i32), t.iota());
                t.store_i(self.lists.place.as_mut_ptr().add(listed).cast(), places);
                self.lists.rows_of_triangle.get_unchecked(lane).assume_init()
            };
            let taken = (rows - self.row).min(T::LANES as u32).min((room - listed) as u32);
            listed += taken as usize;
            self.row += taken;
            if self.row == rows {
                self.row = 0;
                self.todo &= self.todo - 1;
            }
        }
        // Only whole vectors are bounded, so the last entry is repeated.
        // SAFETY: there is room for a vector after `TILE_ROWS`.
        unsafe { t.store_i(self.lists.place.as_mut_ptr().add(listed).cast(), t.i(place as i32)) };
        (self.listed, self.next) = (listed, 0);
    }

    /// Bounds the tiles of a vector of tile rows, starting at index `k`.
    ///
    /// # Safety
    /// `k` is below `TILE_ROWS`, and a vector of places was written from there.
    #[inline(always)]
    unsafe fn bound<T: Simd, S: TileOp<T>>(&mut self, t: T, buffer: &Buffer, clip: TileRect, batch: &Batch, k: usize) {
        // SAFETY: the caller's contract.
        let place = unsafe { t.load_i(self.lists.place.as_ptr().add(k).cast()) };
        let lane = t.sra::<PLACE_SHIFT>(place);
        let row = t.and(place, t.i(LOW as i32));
        // SAFETY: lanes of a batch, whose arrays are as long as the widest vector.
        let of = |field: &Lanes<f32>| unsafe { t.lookup(field.as_ptr(), lane) };
        // SAFETY: as above.
        let of_i = |field: &Lanes<u32>| unsafe { t.bits(t.lookup(field.as_ptr().cast(), lane)) };
        let (column0, column1) = (t.to_f(of_i(&batch.column0)), t.to_f(of_i(&batch.column1)));
        // First and last row of pixels.
        let top = t.mul(t.to_f(row), t.f((height::<T>() * TILE_HEIGHT) as f32));
        let y0 = t.max(top, of(&batch.row0));
        let bottom = t.add(top, t.f((height::<T>() * TILE_HEIGHT) as f32));
        let y1 = t.sub(t.min(bottom, of(&batch.row1)), t.f(1.0));
        let span = Span { t, y0, y1 };

        let edges = &batch.rounded;
        let left = span.bounds(of(&edges.left), of(&edges.left_slope));
        let right = span.bounds(of(&edges.right), of(&edges.right_slope));
        let slope = of(&edges.middle_slope);
        let middle_left = span.bounds(of(&edges.middle_left), slope);
        let middle_right = span.bounds(of(&edges.middle_right), slope);
        // All rows of the span lie between these events, so tiles between them are fully covered.
        let inner_left = t.min(t.max(t.max(left[1], middle_left[1]), column0), column1);
        let inner_right = t.max(t.min(t.min(right[0], middle_right[0]), column1), column0);
        let whole = t.and_m(t.le(of(&batch.row0), top), t.le(bottom, of(&batch.row1)));
        let inner_first = t.sra::<5>(t.add_i(t.trunc(inner_left), t.i(TILE_WIDTH as i32 - 1)));
        let inner_end = t.sra::<5>(t.trunc(inner_right));
        let inner = t.select_i(whole, t.max_i(t.sub_i(inner_end, inner_first), t.i(0)), t.i(0));

        // No row extends past these.
        let left = t.min(t.max(t.max(left[0], middle_left[0]), column0), column1);
        let right = t.max(t.min(t.min(right[1], middle_right[1]), column1), column0);
        // Events are rounded down.
        let (left, right) = (t.trunc(left), t.trunc(right));
        let first = t.max_i(t.sra::<5>(left), t.i(clip.x0 as i32));
        let end = t.sra::<5>(t.add_i(right, t.i(TILE_WIDTH as i32 - 1)));
        let end = t.min_i(end, t.i(clip.x1 as i32));
        let count = t.max_i(t.select_i(t.gt_i(right, left), t.sub_i(end, first), t.i(0)), t.i(0));

        // No tile of a row of tiles gets a nearer depth than this: what the traversal computes, at the sub-tiles where
        // the plane is nearest. Every rounding keeps the order, so this holds to the last bit.
        let (across, limit) = (of(&batch.z_across), of(&batch.z_limit));
        let sub_column = t.shl::<2>(of_i(&batch.tile_x0));
        let first_column = t.sub_i(t.shl::<2>(first), sub_column);
        let last_column = t.add_i(first_column, t.sub_i(t.shl::<2>(count), t.i(1)));
        let rises = |slope: T::F| t.lt(t.f(0.0), slope);
        let plane_across = t.mul(across, t.to_f(t.select_i(rises(across), last_column, first_column)));
        let rows_below = t.sub_i(if height::<T>() == 1 { row } else { t.shl::<1>(row) }, of_i(&batch.tile_y0));
        let sub_row = t.shl::<1>(rows_below);
        let (z, down, nearest_corner) = (of(&batch.z), of(&batch.z_down), of(&batch.nearest));
        let nearest_row = t.select_i(rises(down), t.i(1), t.i(0));
        // A macro: a closure that is called twice is not always inlined.
        macro_rules! nearest_from {
            ($k:expr) => {{
                let row = t.add_i(t.add_i(sub_row, nearest_row), t.i($k));
                let plane = t.add(t.add(z, t.mul(down, t.to_f(row))), plane_across);
                t.min(nearest_corner, S::Coverage::clamp(t, plane, limit))
            }};
        }
        let number = t.shl::<PLACE_SHIFT>(t.add_i(t.i(k as i32), t.iota()));
        macro_rules! store {
            ($list:ident, $value:expr) => {
                // SAFETY: there is room for a vector after `TILE_ROWS`.
                unsafe { t.store_f(self.lists.$list.as_mut_ptr().add(k).cast(), $value) }
            };
            (i $list:ident, $value:expr) => {
                // SAFETY: as above.
                unsafe { t.store_i(self.lists.$list.as_mut_ptr().add(k).cast(), $value) }
            };
        }
        store!(i first, t.or(number, first));
        store!(i count, count);
        // Exact, because there are at most 2^20 tiles.
        let in_rows = t.round(t.mul(t.to_f(row), t.f(buffer.tiles_w() as f32)));
        if height::<T>() == 1 {
            let block = t.round(t.mul(t.to_f(t.sra::<1>(row)), t.f(buffer.tiles_w() as f32)));
            let half = t.shl::<HALF_SHIFT>(t.and(row, t.i(1)));
            store!(i planes, t.add_i(planes_before::<T, S>(t, block), half));
            store!(i index, in_rows);
        } else {
            store!(i planes, planes_before::<T, S>(t, in_rows));
            store!(i index, t.shl::<1>(in_rows));
        }
        store!(across, across);
        store!(limit, limit);
        store!(i sub_column, sub_column);
        store!(i inner_first, inner_first);
        store!(i inner, inner);
        store!(top, top);
        store!(i sub_row, sub_row);
        if height::<T>() == 1 {
            store!(upper, nearest_from!(0));
        } else {
            let middle = t.add(top, t.f(TILE_HEIGHT as f32));
            let closed = t.f(HIDDEN);
            let upper = t.select(t.lt(y0, middle), nearest_from!(0), closed);
            let lower = t.select(t.le(middle, y1), nearest_from!(2), closed);
            store!(upper, upper);
            store!(lower, lower);
        }
    }

    /// Lists as many candidate tiles as there is room for.
    #[inline(always)]
    fn find_candidates<T: Simd, S: TileOp<T>>(&mut self, t: T, buffer: &Buffer, clip: TileRect) -> Candidates {
        if clip == buffer.all_tiles() {
            self.find_candidates_in::<T, S, true>(t, buffer)
        } else {
            self.find_candidates_in::<T, S, false>(t, buffer)
        }
    }

    /// `WHOLE`: the clip is the whole buffer; otherwise another thread may be writing next to it.
    #[inline(always)]
    fn find_candidates_in<T: Simd, S: TileOp<T>, const WHOLE: bool>(&mut self, t: T, buffer: &Buffer) -> Candidates {
        let (mut tile_rows, mut tiles) = (0, 0);
        // Candidates found so far in a wide tile row, which takes several rounds and is listed after the last one.
        let mut before = 0;
        while self.next < self.listed && tiles < TILES {
            let k = self.next;
            let lists = &mut *self.lists;
            // SAFETY: the listed tile rows were bounded. The loop checks that the lists have room, and they are padded
            // by a vector. `z_min` is only read for tiles of the buffer, with room for a vector after the last one;
            // where another thread may be writing, only tiles of the clip are read.
            unsafe {
                let first = lists.first.get_unchecked(k).assume_init();
                let count = lists.count.get_unchecked(k).assume_init();
                let index = lists.index.get_unchecked(k).assume_init();
                let z_min = buffer.z_min().add((index + (first & LOW)) as usize);
                let load = |p: *const f32| {
                    if WHOLE { t.load_f(p) } else { t.float_of_bits(t.load_some(p.cast(), count as usize)) }
                };
                let mut candidates = S::is_candidate(t, load(z_min), t.f(lists.upper.get_unchecked(k).assume_init()));
                if height::<T>() == 2 {
                    let lower = load(z_min.add(buffer.tiles_w() as usize));
                    candidates =
                        t.or_m(candidates, S::is_candidate(t, lower, t.f(lists.lower.get_unchecked(k).assume_init())));
                }
                let named = lists.tiles.named.as_mut_ptr().add(tiles).cast();
                let n = t.list_lanes(named, candidates, count as usize, first);
                tiles += n;
                lists.with_candidates.get_unchecked_mut(tile_rows).write(k as u32);
                if count <= T::LANES as u32 {
                    tile_rows += usize::from(before + n != 0);
                    before = 0;
                    self.next += 1;
                } else {
                    // The rest follows in another round.
                    before += n;
                    lists.first.get_unchecked_mut(k).write(first + T::LANES as u32);
                    lists.count.get_unchecked_mut(k).write(count - T::LANES as u32);
                }
            }
        }
        tile_rows += usize::from(before != 0);
        // Only whole vectors are located, and the traversal looks a few tiles ahead.
        // SAFETY: there is room for a vector after the last tile.
        unsafe { t.store_i(self.lists.tiles.named.as_mut_ptr().add(tiles).cast(), t.i(0)) };
        Candidates { tile_rows, tiles }
    }
}

/// The two halves of a list's word.
#[inline(always)]
pub(super) fn unpack(word: u32) -> (usize, u32) {
    ((word >> PLACE_SHIFT) as usize, word & LOW)
}

/// A vector of spans of pixel rows, first and last inclusive.
struct Span<T: Simd> {
    t: T,
    y0: T::F,
    y1: T::F,
}

impl<T: Simd> Span<T> {
    /// The least and the largest event that an edge can have in the span.
    #[inline(always)]
    fn bounds(&self, constant: T::F, slope: T::F) -> [T::F; 2] {
        let t = self.t;
        let (first, last) = (t.mul(slope, self.y0), t.mul(slope, self.y1));
        let widen = t.mul(t.add(t.abs(constant), t.abs(last)), t.f(WIDEN));
        let low = t.sub(t.add(constant, t.min(first, last)), widen);
        let high = t.add(t.add(constant, t.max(first, last)), widen);
        [low, high]
    }
}
