//! The tiles of triangles, and what is done in them.
//!
//! The strips of a vector of triangles (see `strips.rs`) that have open tiles get their events and the depths of
//! their sub-tiles; then the open tiles are taken one after the other. Nested loops over triangles, strips and tiles
//! were slower, for the processor mispredicts where each ends. The price of lists is that a tile's least
//! depth is read before the triangles of the same vector are drawn; what that lets through changes nothing in the buffer.
//!
//! Coverage comes from events (see `setup.rs`): the rows of a tile are lanes of 32 pixels each, two shifts a
//! lane; transposing bytes then turns rows into sub-tiles, lanes of 8x4 pixels (HPG 2016, section 3.1).

use core::mem::MaybeUninit;

use super::batch::Batch;
use super::setup::Alive;
use super::strips::{self, Strips, height};
use crate::buffer::{BLOCK, Buffer, TILE_HEIGHT, TILE_WIDTH, TilePlace, TileRect};
use crate::simd::{MAX_LANES, Simd};

/// What the tiles of a strip have in common.
#[repr(C, align(64))]
struct Shared {
    /// For each row of pixels the first pixel inside and the first beyond, from the screen's left side.
    left: [u32; MAX_LANES],
    right: [u32; MAX_LANES],
    /// Depth bound of each sub-tile of the box's first tile, and its change from sub-tile to sub-tile.
    z: [f32; MAX_LANES],
    across: f32,
    clamp: f32,
    /// Sub-tiles left of the box's first tile; the strip's first row of tiles; the triangle's lane.
    sub_column: u32,
    y: u32,
    lane: u32,
    /// Planes and least depth of the first tile in that row.
    planes: *mut u32,
    least: *mut f32,
}

/// What happens in a tile.
pub(super) trait TileStep<T: Simd> {
    /// Planes of the buffer.
    const PLANES: usize;
    /// Is the bound of a draw clamped from below, rather than that of a query from above?
    const DRAWS: bool;

    /// Tiles of these least depths in which something at `nearest` matters.
    fn open(t: T, least: T::F, nearest: T::F) -> T::M;

    /// Takes the pixels `covered` at `depth` in a tile, and, with sixteen lanes, in the tile below. False: no
    /// more are needed.
    ///
    /// # Safety
    /// It is a tile of the buffer, and the caller of the pipeline allowed its use.
    unsafe fn tile(&mut self, t: T, at: TilePlace, covered: T::I, depth: T::F) -> bool;

    /// Comes after at most [`strips::MAX_TILES`] tiles.
    #[inline(always)]
    fn tiles_done(&mut self) {}
}

/// Room for the lists; not initialised.
pub(super) struct Lists {
    strips: MaybeUninit<strips::Lists>,
    shared: [MaybeUninit<Shared>; strips::STRIPS],
}

impl Lists {
    #[inline(always)]
    pub fn new() -> MaybeUninit<Self> {
        MaybeUninit::uninit()
    }
}

/// Triangles that were set up, and where they may go.
pub(super) struct Way<'a> {
    pub buffer: &'a Buffer,
    /// Only tiles inside of it are visited.
    pub clip: TileRect,
    pub batch: &'a Batch,
    pub alive: &'a Alive,
    pub lists: &'a mut MaybeUninit<Lists>,
}

/// Takes the triangles in `alive.lanes`, in order, to `step`. The lane at which it wanted no more.
#[inline(always)]
pub(super) fn traverse<T: Simd, S: TileStep<T>>(t: T, way: Way<'_>, step: &mut S) -> Option<u32> {
    let Way { buffer, clip, batch, alive, lists } = way;
    // SAFETY: every field is `MaybeUninit`, or an array of them.
    let Lists { strips, shared } = unsafe { lists.assume_init_mut() };
    let mut strips = Strips::new(strips, alive.lanes);
    while let Some(open) = strips.next::<T, S>(t, buffer, clip, batch) {
        for k in 0..open.strips {
            let strip = strips.opened(k);
            let (lane, row) = strips.place(strip);
            // SAFETY: strips are fewer than there is room for.
            unsafe { share(t, buffer, batch, lane, row * height::<T>(), shared.get_unchecked_mut(strip).as_mut_ptr()) };
        }
        for k in 0..open.tiles {
            let (strip, x) = strips.tile(k);
            // SAFETY: strips with open tiles were written above; vectors of as many words as there are lanes.
            let (strip, left, right, z) = unsafe {
                let strip = shared.get_unchecked(strip).assume_init_ref();
                let (left, right) = (t.load_i(strip.left.as_ptr()), t.load_i(strip.right.as_ptr()));
                (strip, left, right, t.load_f(strip.z.as_ptr()))
            };
            let covered = coverage(t, left, right, x);
            let column = t.or(t.i((4 * x).wrapping_sub(strip.sub_column) as i32), t.and(t.iota(), t.i(3)));
            let plane = t.add(z, t.mul(t.f(strip.across), t.to_f(column)));
            let clamp = t.f(strip.clamp);
            let depth = if S::DRAWS { t.max(plane, clamp) } else { t.min(plane, clamp) };
            // SAFETY: a tile of the triangle's box is a tile of the buffer.
            let more = unsafe {
                let planes = strip.planes.add(x as usize * S::PLANES * BLOCK);
                let at = TilePlace { x, y: strip.y, planes, least: strip.least.add(x as usize) };
                step.tile(t, at, covered, depth)
            };
            if !more {
                return Some(strip.lane);
            }
        }
        step.tiles_done();
    }
    None
}

/// The pixels of a tile, a sub-tile a lane, from the events of its rows.
#[inline(always)]
fn coverage<T: Simd>(t: T, left: T::I, right: T::I, x: u32) -> T::I {
    let from = t.i((x * TILE_WIDTH) as i32);
    let (left, right) = (t.sub_sat(left, from), t.sub_sat(right, from));
    t.transpose_bytes(t.and_not(t.ones_shl(right), t.ones_shl(left)))
}

/// Writes the events and depths of the triangle in `lane`, from row `y` of tiles on.
///
/// # Safety
/// `to` can be written.
#[inline(always)]
unsafe fn share<T: Simd>(t: T, buffer: &Buffer, batch: &Batch, lane: usize, y: u32, to: *mut Shared) {
    let lane = lane % MAX_LANES;
    let rows = t.add_i(t.i((y * TILE_HEIGHT) as i32), t.iota());
    let rows_f = t.to_f(rows);
    let row = t.to_d(rows_f);
    let left = t.add_d(t.d(batch.left[lane]), t.mul_d(t.d(batch.left_slope[lane]), row));
    let right = t.add_d(t.d(batch.right[lane]), t.mul_d(t.d(batch.right_slope[lane]), row));
    let middle = t.mul_d(t.d(batch.middle_slope[lane]), row);
    let left = t.max_d(left, t.add_d(t.d(batch.middle_left[lane]), middle));
    let right = t.min_d(right, t.add_d(t.d(batch.middle_right[lane]), middle));
    // Into the box. Events of a query may lie beyond the corners, where an edge is nearly horizontal; of edges
    // that bound nothing they are nowhere. In rows outside of the box they may be anything.
    let (column0, column1) = (f64::from(batch.column0[lane]), f64::from(batch.column1[lane]));
    let left = t.min_d(t.max_d(left, t.d(column0)), t.d(column1));
    let right = t.max_d(t.min_d(right, t.d(column1)), t.d(column0));
    let inside = t.and_m(t.le(t.f(batch.row0[lane]), rows_f), t.lt(rows_f, t.f(batch.row1[lane])));
    let right = t.select_i(inside, t.d_to_i(right), t.i(0));
    let sub_row = t.add_i(t.i(2 * (y as i32 - batch.tile_y0[lane] as i32)), t.sra::<2>(t.iota()));
    let z = t.add(t.f(batch.z[lane]), t.mul(t.f(batch.z_down[lane]), t.to_f(sub_row)));
    // SAFETY: the caller's contract; the arrays hold a vector.
    unsafe {
        t.store_i((&raw mut (*to).left).cast(), t.d_to_i(left));
        t.store_i((&raw mut (*to).right).cast(), right);
        t.store_f((&raw mut (*to).z).cast(), z);
        (*to).across = batch.z_across[lane];
        (*to).clamp = batch.z_clamp[lane];
        (*to).sub_column = 4 * batch.tile_x0[lane];
        (*to).planes = buffer.row(y);
        (*to).least = buffer.least_of(0, y);
        (*to).y = y;
        (*to).lane = lane as u32;
    }
}
