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

use super::batch::{Batch, Lanes};
use super::setup::Alive;
use super::strips::{self, Strips, height};
use super::tile_step::TileStep;
use crate::buffer::{BLOCK, Buffer, TilePlace, TileRect};
use crate::simd::{MAX_LANES, Simd};

/// The rows of a strip.
#[repr(C, align(64))]
struct Rows {
    /// For each row of pixels the first pixel inside and the first beyond, from the screen's left side.
    left: [u32; MAX_LANES],
    right: [u32; MAX_LANES],
    /// Depth bound of each sub-tile of the box's first tile.
    z: [f32; MAX_LANES],
}

/// Tiles are asked for so many before they are taken: 3 to 6 percent of a frame of two scenes, none of a third.
const AHEAD: usize = 6;

/// Room for the lists; not initialised. In this order: the other way round scenes were 1 to 2 percent slower.
#[repr(C)]
pub(super) struct Lists {
    rows: [MaybeUninit<Rows>; strips::STRIPS],
    strips: MaybeUninit<strips::Lists>,
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
    let Lists { strips, rows } = unsafe { lists.assume_init_mut() };
    let mut strips = Strips::new(t, strips, clip, batch, alive.lanes);
    // By value, for who stores into a tile might have changed what stands behind a reference.
    let (first_planes, first_least, pitch) = (buffer.planes(), buffer.least(), buffer.tiles_w() as usize);
    while let Some(open) = strips.next::<T, S>(t, buffer, clip, batch) {
        for k in 0..open.strips {
            let strip = strips.opened(k);
            let (lane, _) = strips.place(strip);
            // SAFETY: strips are fewer than there is room for; setup stored what it found of the lane.
            unsafe {
                let rows = rows.get_unchecked_mut(strip).as_mut_ptr();
                write_rows::<T, S>(t, batch, lane, strips.rows(strip), buffer.width(), rows);
            }
        }
        for k in 0..open.tiles {
            if k + AHEAD < open.tiles {
                let planes = first_planes.wrapping_byte_add(strips.about::<T, S>(k + AHEAD) as usize);
                for plane in 0..S::PLANES {
                    t.prefetch(planes.wrapping_add(plane * BLOCK));
                }
            }
            let tile = strips.tile::<T, S>(t, k);
            // SAFETY: strips with open tiles were written above; vectors of as many words as there are lanes.
            let (left, right, z) = unsafe {
                let rows = rows.get_unchecked(tile.strip).as_ptr();
                let (left, right) = (&raw const (*rows).left, &raw const (*rows).right);
                (t.load_i(left.cast()), t.load_i(right.cast()), t.load_f((&raw const (*rows).z).cast()))
            };
            let (across, clamp) = strips.slope(tile.strip);
            let plane = t.add(z, t.mul(t.f(across), tile.sub_columns));
            let clamp = t.f(clamp);
            let depth = if S::DRAWS { t.max(plane, clamp) } else { t.min(plane, clamp) };
            let row = || strips.place(tile.strip).1 * height::<T>();
            // SAFETY: a tile of the triangle's box is a tile of the buffer.
            let more = unsafe {
                let least = first_least.add(tile.number as usize);
                let planes = first_planes.byte_add(tile.planes as usize);
                let at = TilePlace { x: strips.column(k), planes, least, pitch };
                if tile.whole {
                    step.whole_tile(t, at, row, depth)
                } else {
                    step.tile(t, at, row, coverage(t, left, right, tile.left), depth)
                }
            };
            if !more {
                return Some(strips.place(tile.strip).0 as u32);
            }
        }
        step.tiles_done(open.tiles);
    }
    None
}

/// The pixels of a tile, a sub-tile a lane, from the events of its rows.
#[inline(always)]
fn coverage<T: Simd>(t: T, left: T::I, right: T::I, first: u32) -> T::I {
    let from = t.i(first as i32);
    let (left, right) = (t.sub_sat(left, from), t.sub_sat(right, from));
    t.transpose_bytes(t.and_not(t.ones_shl(right), t.ones_shl(left)))
}

/// Writes the events and depths of the triangle in `lane`, from row `top` of pixels on.
///
/// # Safety
/// Setup stored all of the lane; `to` can be written.
#[inline(always)]
unsafe fn write_rows<T: Simd, S: TileStep<T>>(
    t: T,
    batch: &Batch,
    lane: usize,
    (top, sub_row): (f32, i32),
    width: u32,
    to: *mut Rows,
) {
    // SAFETY: the caller's contract.
    let of_d = |field: &Lanes<f64>| t.d(unsafe { field.get(lane) });
    // SAFETY: the caller's contract.
    let of = |field: &Lanes<f32>| t.f(unsafe { field.get(lane) });
    // SAFETY: the caller's contract.
    let of_i = |field: &Lanes<u32>| t.i(unsafe { field.get(lane) } as i32);
    let rows = t.add(t.f(top), t.to_f(t.iota()));
    let row = t.to_d(rows);
    let event = |constant: &Lanes<f64>, slope: &Lanes<f64>| {
        let (constant, slope) = (of_d(constant), of_d(slope));
        // A draw's events are exact however it is rounded; a query's have to come to the same on all instruction sets.
        if S::DRAWS { t.mul_add_d(slope, row, constant) } else { t.add_d(constant, t.mul_d(slope, row)) }
    };
    let left = event(&batch.left, &batch.left_slope);
    let right = event(&batch.right, &batch.right_slope);
    let left = t.d_to_i(t.max_d(left, event(&batch.middle_left, &batch.middle_slope)));
    let right = t.d_to_i(t.min_d(right, event(&batch.middle_right, &batch.middle_slope)));
    // Into the box. Events of a query may lie beyond the corners, where an edge is nearly horizontal; those of a draw
    // do not, but beyond the screen. In rows outside of the box they may be anything, and what does not fit in an integer, too.
    let (column0, column1) =
        if S::DRAWS { (t.i(0), t.i(width as i32)) } else { (of_i(&batch.column0), of_i(&batch.column1)) };
    let left = t.min_i(t.max_i(left, column0), column1);
    let right = t.max_i(t.min_i(right, column1), column0);
    let inside = t.and_m(t.le(of(&batch.row0), rows), t.lt(rows, of(&batch.row1)));
    let right = t.select_i(inside, right, t.i(0));
    let sub_row = t.to_f(t.add_i(t.i(sub_row), t.sra::<2>(t.iota())));
    let z = t.add(of(&batch.z), t.mul(of(&batch.z_down), sub_row));
    // SAFETY: the caller's contract; the arrays hold a vector.
    unsafe {
        t.store_i((&raw mut (*to).left).cast(), left);
        t.store_i((&raw mut (*to).right).cast(), right);
        t.store_f((&raw mut (*to).z).cast(), z);
    }
}
