//! Visits the tiles of triangles: computes their coverage and depth bounds and passes them to a tile operation.
//!
//! For the tile rows of a vector of triangles (see `tile_rows.rs`) that have candidate tiles, the events and the depths
//! of the sub-tiles are computed; then the candidates are processed one after the other. Flat lists replace nested
//! loops over triangles, rows and tiles, because the processor mispredicts the end of every short loop. In return, a
//! tile's `z_min` is read before the triangles of the same vector are drawn; the additional candidates do not change
//! the buffer.
//!
//! Coverage comes from events (see `setup.rs`): the rows of a tile are lanes of 32 pixels each, two shifts per
//! lane; transposing bytes then turns rows into sub-tiles, lanes of 8x4 pixels (HPG 2016, section 3.1).

use core::mem::MaybeUninit;

use super::batch::{Batch, Lanes};
use super::setup::Alive;
use super::tile_op::TileOp;
use super::tile_rows::{self, TileRows, height};
use crate::buffer::{BLOCK, Buffer, TilePlace, TileRect};
use crate::geometry::Coverage;
use crate::simd::{MAX_LANES, Simd};

/// The pixel rows of a tile row.
#[repr(C, align(64))]
struct Rows {
    /// For each pixel row the first pixel inside and the first one past the end, counted from the left of the screen.
    left: [u32; MAX_LANES],
    right: [u32; MAX_LANES],
    /// Depth bound of each sub-tile of the first tile of the bounds.
    z: [f32; MAX_LANES],
}

/// How many tiles ahead memory is prefetched: less than a vector, by which the lists are padded.
pub(super) const AHEAD: usize = 6;

/// Memory for the lists, uninitialised. The order of the fields matters: the reverse order is measurably slower.
#[repr(C)]
pub(crate) struct Workspace {
    rows: [MaybeUninit<Rows>; tile_rows::TILE_ROWS],
    tile_rows: MaybeUninit<tile_rows::TileRowLists>,
}

/// The input of a traversal: triangles after set-up, and the tiles that they may reach.
pub(crate) struct Input<'a> {
    pub buffer: &'a Buffer,
    /// Only tiles inside it are visited.
    pub clip: TileRect,
    pub batch: &'a Batch,
    pub alive: &'a Alive,
    pub lists: &'a mut MaybeUninit<Workspace>,
}

/// Applies an operation to the tiles of the triangles in `alive.lanes`, in order. Returns the lane at which it stopped
/// early.
///
/// # Safety
/// The batch and `alive` come from one call of [`set_up`](super::setup::set_up) with this buffer and the coverage of
/// `op`. The clip lies within the buffer, and `op` may be applied to any of its tiles.
#[inline(always)]
pub(crate) unsafe fn traverse<T: Simd, O: TileOp<T>>(t: T, input: Input<'_>, op: &mut O) -> Option<u32> {
    const { assert!(AHEAD < T::LANES) }
    let Input { buffer, clip, batch, alive, lists } = input;
    // SAFETY: every field is `MaybeUninit`, or an array of them.
    let Workspace { tile_rows, rows } = unsafe { lists.assume_init_mut() };
    // SAFETY: the caller's contract.
    let mut tile_rows = unsafe { TileRows::new::<T, O>(t, tile_rows, clip, batch, alive.lanes) };
    // By value: the compiler must assume that a store into a tile changes anything behind a reference.
    let (first_planes, first_z_min, pitch) = (buffer.planes(), buffer.z_min(), buffer.tiles_w() as usize);
    // SAFETY (of the look-ups below): only tile rows and tiles that `next` found are asked for.
    // SAFETY: the same batch and clip as for `new`.
    while let Some(found) = unsafe { tile_rows.next::<T, O>(t, buffer, clip, batch) } {
        for k in 0..found.tile_rows {
            // SAFETY: as above; there are fewer tile rows than there is room for; set-up stored the lane.
            unsafe {
                let tile_row = tile_rows.with_candidates(k);
                let (lane, _) = tile_rows.place(tile_row);
                let rows = rows.get_unchecked_mut(tile_row).as_mut_ptr();
                write_rows::<T, O::Coverage>(t, batch, lane, tile_rows.rows(tile_row), buffer.width(), rows);
            }
        }
        for k in 0..found.tiles {
            // SAFETY: as above.
            let planes = first_planes.wrapping_byte_add(unsafe { tile_rows.about::<T, O>(k + AHEAD) } as usize);
            for plane in 0..O::PLANES {
                t.prefetch(planes.wrapping_add(plane * BLOCK));
            }
            // SAFETY: as above.
            let tile = unsafe { tile_rows.tile::<T, O>(t, k) };
            // SAFETY: tile rows with candidates were written above; each array holds a vector.
            let (left, right, z) = unsafe {
                let rows = rows.get_unchecked(tile.tile_row).as_ptr();
                let (left, right) = (&raw const (*rows).left, &raw const (*rows).right);
                (t.load_i(left.cast()), t.load_i(right.cast()), t.load_f((&raw const (*rows).z).cast()))
            };
            // SAFETY: as above.
            let (across, limit) = unsafe { tile_rows.slope(tile.tile_row) };
            let plane = t.add(z, t.mul(t.f(across), tile.sub_columns));
            let depth = O::Coverage::clamp(t, plane, t.f(limit));
            // SAFETY: as above.
            let row = || unsafe { tile_rows.place(tile.tile_row) }.1 * height::<T>();
            // SAFETY: a tile of the triangle's bounds is a tile of the buffer.
            let more = unsafe {
                let z_min = first_z_min.add(tile.number as usize);
                let planes = first_planes.byte_add(tile.planes as usize);
                let at = TilePlace { x: tile_rows.column(k), planes, z_min, pitch };
                if tile.whole {
                    op.whole_tile(t, at, row, depth)
                } else {
                    op.tile(t, at, row, coverage(t, left, right, tile.left), depth)
                }
            };
            if !more {
                // SAFETY: as above.
                return Some(unsafe { tile_rows.place(tile.tile_row) }.0 as u32);
            }
        }
        op.tiles_done(found.tiles);
    }
    None
}

/// The pixels of a tile, a sub-tile per lane, from the events of its rows.
#[inline(always)]
fn coverage<T: Simd>(t: T, left: T::I, right: T::I, first: u32) -> T::I {
    let from = t.i(first as i32);
    let (left, right) = (t.sub_sat(left, from), t.sub_sat(right, from));
    t.transpose_bytes(t.and_not(t.ones_shl(right), t.ones_shl(left)))
}

/// Writes the events and depths of the triangle in `lane`, from row `top` of pixels on.
///
/// # Safety
/// Set-up stored all of the lane; `to` can be written.
#[inline(always)]
unsafe fn write_rows<T: Simd, C: Coverage>(
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
        C::event(t, constant, slope, row)
    };
    let left = event(&batch.left, &batch.left_slope);
    let right = event(&batch.right, &batch.right_slope);
    let left = t.d_to_i(t.max_d(left, event(&batch.middle_left, &batch.middle_slope)));
    let right = t.d_to_i(t.min_d(right, event(&batch.middle_right, &batch.middle_slope)));
    // In rows outside the bounds, events may have any value, including ones that do not fit in an integer.
    let (column0, column1) = C::columns(t, width, || (of_i(&batch.column0), of_i(&batch.column1)));
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
