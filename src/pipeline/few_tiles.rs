//! Batches of small triangles: which tiles are open is known from the look at their boxes (see `boxes.rs`).
//!
//! Where every triangle of a vector has its box in two columns and two rows of tiles, no strip has to be bounded, and no least
//! depth looked at again: each has an upper strip, which gets its lane's number, and perhaps a lower one, eight further. A tile
//! that the box has and the triangle does not reach may be among them, which changes nothing that the buffer says: if nothing was
//! drawn into it, it becomes an empty one. Eight lanes only: what
//! sixteen would gain could not be measured.

use super::batch::{Batch, Lanes};
use super::strips::{Open, PLACE_SHIFT, Placed, Strips};
use super::tile_step::TileStep;
use crate::buffer::Buffer;
use crate::simd::Simd;

/// From an upper strip to its triangle's lower one.
const LOWER: u32 = 8;

/// For each set of open tiles, how they are named, from the first column of the upper strip on; as long as a vector.
static NAMES: [[u32; 8]; 16] = {
    let mut names = [[0; 8]; 16];
    let mut open = 0;
    while open < 16 {
        let (mut tile, mut n) = (0, 0);
        while tile < 4 {
            if open >> tile & 1 == 1 {
                names[open][n] = ((tile as u32 / 2 * LOWER) << PLACE_SHIFT) | (tile as u32 % 2);
                n += 1;
            }
            tile += 1;
        }
        open += 1;
    }
    names
};

impl Strips<'_> {
    /// Lists the open tiles of all triangles.
    ///
    /// # Safety
    /// All of them are in `Alive::few`, for which setup stored what is open.
    #[inline(always)]
    pub(super) unsafe fn list_few<T: Simd, S: TileStep<T>>(&mut self, t: T, buffer: &Buffer, batch: &Batch) -> Open {
        debug_assert!(T::LANES <= LOWER as usize);
        // SAFETY: setup stored the fields of every lane where any is alive; eight and the strip numbers below it are below `STRIPS`.
        unsafe {
            let of = |field: &Lanes<f32>| t.load_f(field.as_ptr());
            let of_i = |field: &Lanes<u32>| t.load_i(field.as_ptr());
            let (x0, y0) = (of_i(&batch.tile_x0), of_i(&batch.tile_y0));
            let (across, clamp) = (of(&batch.z_across), of(&batch.z_clamp));
            let number = t.shl::<PLACE_SHIFT>(t.iota());
            for (k, row) in [(0, y0), (LOWER as usize, t.add_i(y0, t.i(1)))] {
                let none = t.i(0);
                let placed = Placed { row, tile_x0: x0, tile_y0: y0, across, clamp, inner_first: none, inner: none };
                self.place_strips::<T, S>(t, buffer, k, placed);
                t.store_i(self.lists.place.as_mut_ptr().add(k).cast(), t.or(number, row));
            }
            t.store_i(self.lists.first.as_mut_ptr().cast(), t.or(number, x0));
        }
        let (mut strips, mut tiles) = (0, 0);
        while self.todo != 0 {
            let lane = self.todo.trailing_zeros() as usize;
            self.todo &= self.todo - 1;
            // SAFETY: the caller's contract, and what is open is below 16; eight triangles have no more than 16 strips and 32 tiles,
            // after which there is room for a vector.
            unsafe {
                let open = batch.open.get(lane) as usize;
                let first = self.lists.first.get_unchecked(lane).assume_init();
                let names = t.load_i(NAMES.get_unchecked(open).as_ptr());
                t.store_i(self.lists.tiles.named.as_mut_ptr().add(tiles).cast(), t.add_i(names, t.i(first as i32)));
                tiles += open.count_ones() as usize;
                self.lists.opened.get_unchecked_mut(strips).write(lane as u32);
                strips += usize::from(open & 3 != 0);
                self.lists.opened.get_unchecked_mut(strips).write(lane as u32 + LOWER);
                strips += usize::from(open >> 2 != 0);
            }
        }
        Open { strips, tiles }
    }
}
