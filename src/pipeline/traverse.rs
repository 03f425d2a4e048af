//! The tiles of triangles, and what is done in them.
//!
//! A vector of triangles becomes a list of strips (a row of up to eight tiles of one triangle's box), the
//! strips that are not hidden get their events, and their open tiles become one flat list: three plain loops without
//! a branch that depends on the scene. Nested loops over rows and tiles were slower, for the processor mispredicts
//! where each ends. The price is that a tile's least depth is read before the triangles of the same vector are
//! drawn; what that lets through changes nothing in the buffer.
//!
//! Coverage comes from events (see `setup.rs`): eight rows of a tile are eight lanes of 32 pixels each,
//! two shifts a lane; transposing bytes then turns rows into sub-tiles, eight lanes of 8x4 pixels (HPG 2016,
//! section 3.1).

use core::mem::MaybeUninit;

use super::batch::Batch;
use super::setup::Alive;
use crate::buffer::{Buffer, SUB_TILES, TILE_HEIGHT, TILE_WIDTH, TileRect};
use crate::simd::{MAX_LANES, Simd};

/// Strips taken at a time: those of sixteen triangles, mostly.
const STRIPS: usize = 64;
/// Tiles of a strip.
const TILES: u32 = 8;

/// A row of tiles of a triangle's box.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Strip {
    /// For each row of pixels the first pixel inside and the first beyond, from the screen's left side.
    left: [u32; SUB_TILES],
    right: [u32; SUB_TILES],
    /// Depth bound of each sub-tile of the box's first tile, and its change from sub-tile to sub-tile.
    z: [f32; SUB_TILES],
    across: f32,
    clamp: f32,
    /// Index of the box's first tile in this row of tiles.
    first: u32,
    /// Its column, and the row.
    x0: u32,
    y: u32,
    lane: u32,
}

/// What happens in a tile.
pub(super) trait TileStep<T: Simd> {
    /// Is the bound of a draw clamped from below, rather than that of a query from above?
    const DRAWS: bool;

    /// Tiles of these least depths in which something at `nearest` matters.
    fn open(t: T, least: T::F, nearest: T::F) -> T::M;

    /// Takes the pixels `covered` at `depth` in tile (x, y), which is number `index`. False: no more are needed.
    ///
    /// # Safety
    /// It is a tile of the buffer, and the caller of the pipeline allowed its use.
    unsafe fn tile(&mut self, t: T, index: usize, x: u32, y: u32, covered: T::I, depth: T::F) -> bool;
}

/// Room for the lists; not initialised.
pub(super) struct Lists {
    /// Triangle's lane, group of eight tiles across, and row of tiles.
    rows: [MaybeUninit<u32>; STRIPS + MAX_LANES],
    open: [MaybeUninit<u32>; STRIPS],
    strips: [MaybeUninit<Strip>; STRIPS],
    /// Strip and tile in it.
    tiles: [MaybeUninit<u32>; STRIPS * TILES as usize + SUB_TILES],
}

impl Lists {
    #[inline(always)]
    pub fn new() -> MaybeUninit<Self> {
        MaybeUninit::uninit()
    }
}

const LANE_SHIFT: u32 = 26;
const GROUP_SHIFT: u32 = 16;

/// Triangles that were set up, and where they may go.
pub(super) struct Way<'a> {
    pub buffer: &'a Buffer,
    /// Only tiles inside of it are visited.
    pub clip: TileRect,
    pub batch: &'a Batch,
    pub alive: &'a Alive,
    pub lists: &'a mut MaybeUninit<Lists>,
}

/// What came of a traversal.
#[derive(Clone, Copy, Default)]
pub(super) struct Visited {
    /// The lane at which the step wanted no more.
    pub stopped: Option<u32>,
    /// Tiles that the step was given.
    pub tiles: u64,
    /// Some tile was left out for its least depth.
    pub hidden: bool,
}

/// Takes the triangles in `alive.lanes`, in order, to `step`.
#[inline(always)]
pub(super) fn traverse<T: Simd, S: TileStep<T>>(t: T, way: Way<'_>, step: &mut S) -> Visited {
    let Way { buffer, clip, batch, alive, lists } = way;
    // SAFETY: every field is an array of `MaybeUninit`.
    let lists = unsafe { lists.assume_init_mut() };
    let whole = clip == buffer.all_tiles();
    let mut todo = alive.lanes;
    let (mut group, mut row) = (0, 0);
    let mut visited = Visited::default();
    loop {
        // Rows of the triangles' boxes, several at a time.
        let mut rows = 0;
        while todo != 0 && rows < STRIPS {
            let lane = todo.trailing_zeros();
            let k = lane as usize;
            let first = batch.tile_y0[k].max(clip.y0);
            let height = (batch.tile_y1[k] + 1).min(clip.y1).saturating_sub(first);
            let groups = (batch.tile_x1[k] - batch.tile_x0[k]) / TILES + 1;
            let word = lane << LANE_SHIFT | group << GROUP_SHIFT | (first + row);
            // SAFETY: there is room for a vector after `STRIPS`.
            unsafe { t.store_i(lists.rows.as_mut_ptr().add(rows).cast(), t.add_i(t.i(word as i32), t.iota())) };
            let taken = (height - row).min(T::LANES as u32).min((STRIPS - rows) as u32);
            rows += taken as usize;
            row += taken;
            if row == height {
                row = 0;
                group += 1;
                if group == groups {
                    group = 0;
                    todo &= todo - 1;
                }
            }
        }
        if rows == 0 {
            return visited;
        }

        // Those with open tiles.
        let mut strips = 0;
        for k in 0..rows {
            // SAFETY: the first `rows` were just written.
            let word = unsafe { lists.rows[k].assume_init() };
            let (lane, x, y) = place(batch, word);
            let (begin, end) = (x.max(clip.x0), (batch.tile_x1[lane] + 1).min(x + TILES).min(clip.x1));
            // SAFETY: a tile of the triangle's box is a tile of the buffer; after the last there is room for a vector.
            let least = unsafe {
                let first = buffer.least().add((y * buffer.tiles_w() + x) as usize);
                if whole { t.load_f(first) } else { some_of(t, first, begin.saturating_sub(x), end.saturating_sub(x)) }
            };
            let open = t.mask_bits(S::open(t, least, t.f(batch.nearest[lane])));
            let below = |tile: u32| (1_u32 << tile.saturating_sub(x).min(TILES)) - 1;
            let inside = below(end) & !below(begin);
            visited.hidden |= open & inside != inside;
            let open = open & inside;
            lists.rows[strips].write(word);
            lists.open[strips].write(open);
            strips += usize::from(open != 0);
        }

        // Their events and depths, and their tiles.
        let mut tiles = 0;
        for k in 0..strips {
            // SAFETY: the first `strips` were just written.
            let (word, mut open) = unsafe { (lists.rows[k].assume_init(), lists.open[k].assume_init()) };
            let (lane, x, y) = place(batch, word);
            let strip = Events::new(t, batch, lane, y, buffer.tiles_w());
            let box_x0 = batch.tile_x0[lane];
            if batch.tile_x1[lane] - box_x0 >= 4 {
                open &= strip.reach(t, x);
            }
            let sub_row = t.add_i(t.i(2 * (y - batch.tile_y0[lane]) as i32), t.sra::<2>(t.iota()));
            let z = t.add(t.f(batch.z[lane]), t.mul(t.f(batch.z_down[lane]), t.to_f(sub_row)));
            let record = lists.strips[k].as_mut_ptr();
            // SAFETY: the fields of a strip hold a vector each; there is room for a vector of tiles after the last.
            unsafe {
                t.store_i((&raw mut (*record).left).cast(), strip.left);
                t.store_i((&raw mut (*record).right).cast(), strip.right);
                t.store_f((&raw mut (*record).z).cast(), z);
                (*record).across = batch.z_across[lane];
                (*record).clamp = batch.z_clamp[lane];
                (*record).first = y * buffer.tiles_w() + box_x0;
                (*record).x0 = box_x0;
                (*record).y = y;
                (*record).lane = lane as u32;
                let tile = t.add_i(t.i(((k as u32) << GROUP_SHIFT | (x - box_x0)) as i32), t.iota());
                let bits = t.gt_i(t.and(t.i(open as i32), t.one_bit_each()), t.i(0));
                tiles += t.compress(lists.tiles.as_mut_ptr().add(tiles).cast(), bits, tile);
            }
        }

        visited.tiles += tiles as u64;
        for k in 0..tiles {
            // SAFETY: the first `tiles` were just written, each with the number of a strip that was.
            let (dx, strip) = unsafe {
                let word = lists.tiles[k].assume_init();
                (word & 0xffff, lists.strips[(word >> GROUP_SHIFT) as usize].assume_init_ref())
            };
            // SAFETY: eight words each.
            let (left, right, z) =
                unsafe { (t.load_i(strip.left.as_ptr()), t.load_i(strip.right.as_ptr()), t.load_f(strip.z.as_ptr())) };
            let x = strip.x0 + dx;
            let covered = coverage(t, left, right, x);
            let sub_column = t.add_i(t.i(4 * dx as i32), t.and(t.iota(), t.i(3)));
            let plane = t.add(z, t.mul(t.f(strip.across), t.to_f(sub_column)));
            let clamp = t.f(strip.clamp);
            let depth = if S::DRAWS { t.max(plane, clamp) } else { t.min(plane, clamp) };
            // SAFETY: a tile of the triangle's box is a tile of the buffer.
            if !unsafe { step.tile(t, (strip.first + dx) as usize, x, strip.y, covered, depth) } {
                visited.stopped = Some(strip.lane);
                visited.tiles -= (tiles - 1 - k) as u64;
                return visited;
            }
        }
    }
}

/// The floats from `begin` to before `end` from `p` on, and nothing else: beside them another thread may be writing.
///
/// # Safety
/// They can be read.
#[inline(always)]
unsafe fn some_of<T: Simd>(t: T, p: *const f32, begin: u32, end: u32) -> T::F {
    let mut lanes = [0.0; SUB_TILES];
    let mut k = begin;
    while k < end {
        // SAFETY: the caller's contract.
        lanes[k as usize] = unsafe { *p.add(k as usize) };
        k += 1;
    }
    // SAFETY: the array holds a vector.
    unsafe { t.load_f(lanes.as_ptr()) }
}

/// Lane, first tile and row of tiles of an entry of the list of rows.
#[inline(always)]
fn place(batch: &Batch, word: u32) -> (usize, u32, u32) {
    let lane = (word >> LANE_SHIFT) as usize;
    let group = word >> GROUP_SHIFT & ((1 << (LANE_SHIFT - GROUP_SHIFT)) - 1);
    (lane, batch.tile_x0[lane] + group * TILES, word & ((1 << GROUP_SHIFT) - 1))
}

/// The pixels of a tile, a sub-tile a lane, from the events of its rows.
#[inline(always)]
fn coverage<T: Simd>(t: T, left: T::I, right: T::I, tile_x: u32) -> T::I {
    let (zero, width, from) = (t.i(0), t.i(TILE_WIDTH as i32), t.i((tile_x * TILE_WIDTH) as i32));
    let left = t.min_i(t.max_i(t.sub_i(left, from), zero), width);
    let right = t.min_i(t.max_i(t.sub_i(right, from), zero), width);
    t.transpose_bytes(t.and_not(t.ones_shl(right), t.ones_shl(left)))
}

/// For each of a strip's eight rows the first pixel inside and the first beyond.
struct Events<T: Simd> {
    left: T::I,
    right: T::I,
}

impl<T: Simd> Events<T> {
    #[inline(always)]
    fn new(t: T, batch: &Batch, lane: usize, tile_y: u32, tiles_w: u32) -> Self {
        let rows = t.add_i(t.i((tile_y * TILE_HEIGHT) as i32), t.iota());
        let row = t.to_d(t.to_f(rows));
        let left = t.add_d(t.d(batch.left[lane]), t.mul_d(t.d(batch.left_slope[lane]), row));
        let right = t.add_d(t.d(batch.right[lane]), t.mul_d(t.d(batch.right_slope[lane]), row));
        let middle = t.mul_d(t.d(batch.middle_slope[lane]), row);
        let left = t.max_d(left, t.add_d(t.d(batch.middle_left[lane]), middle));
        let right = t.min_d(right, t.add_d(t.d(batch.middle_right[lane]), middle));
        let (zero, width) = (t.d(0.0), t.d(f64::from(tiles_w * TILE_WIDTH)));
        let left = t.d_to_i(t.min_d(t.max_d(left, zero), width));
        let right = t.d_to_i(t.min_d(t.max_d(right, zero), width));
        // Rows above the first and below the last have no pixels, whatever their events.
        let inside =
            t.and_m(t.gt_i(rows, t.i(batch.row0[lane] as i32 - 1)), t.gt_i(t.i(batch.row1[lane] as i32), rows));
        // Events of a query may lie beyond the corners, where an edge is nearly horizontal; the box does not.
        let left = t.max_i(left, t.i(batch.column0[lane] as i32));
        let right = t.min_i(right, t.i(batch.column1[lane] as i32));
        Self { left, right: t.select_i(inside, right, t.i(0)) }
    }

    /// Of the tiles from `start` on, those from the first to the last that any row reaches, a bit each.
    #[inline(always)]
    fn reach(&self, t: T, start: u32) -> u32 {
        let empty = t.gt_i(t.add_i(self.left, t.i(1)), self.right);
        let first = t.least(t.select(empty, t.f(f32::MAX), t.to_f(self.left)));
        let end = -t.least(t.select(empty, t.f(0.0), t.sub(t.f(0.0), t.to_f(self.right))));
        // To tiles, the end rounded up; MAX saturates.
        let (first, end) = (first as u32 / TILE_WIDTH, (end as u32).div_ceil(TILE_WIDTH));
        let below = |tile: u32| (1_u32 << tile.saturating_sub(start).min(TILES)) - 1;
        below(end) & !below(first)
    }
}
