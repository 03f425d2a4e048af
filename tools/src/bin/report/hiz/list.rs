//! Screen triangles: the output of culling and the input of the rasteriser.

use super::lanes::MOST;

/// The corners of triangles, one array per coordinate: x and y on the grid, and the bits of 1/w.
#[derive(Default)]
pub struct TriangleList {
    arrays: [[Vec<i32>; 3]; 3],
    len: usize,
}

impl TriangleList {
    pub fn len(&self) -> usize {
        self.len
    }

    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Makes room for `more` triangles and for the excess that a vector store writes behind them.
    pub fn reserve(&mut self, more: usize) {
        let room = self.len + more + MOST;
        if self.arrays[0][0].len() < room {
            let room = room.next_power_of_two();
            self.arrays.iter_mut().flatten().for_each(|array| array.resize(room, 0));
        }
    }

    /// A corner's x, y and depth from triangle `at` on. A whole vector can be read for every triangle of the list.
    pub fn read_at(&self, corner: usize, at: usize) -> [*const i32; 3] {
        debug_assert!(at < self.len);
        self.arrays[corner].each_ref().map(|array| array.as_ptr().wrapping_add(at))
    }

    /// Where the x, y and depth of a corner of the next triangles are written.
    pub fn write_at(&mut self, corner: usize) -> [*mut i32; 3] {
        let at = self.len;
        self.arrays[corner].each_mut().map(|array| array.as_mut_ptr().wrapping_add(at))
    }

    /// Adds the triangles that were written.
    ///
    /// # Safety
    /// There is room for as many.
    pub unsafe fn grow(&mut self, by: usize) {
        self.len += by;
    }

    pub fn push(&mut self, corners: [([i32; 2], f32); 3]) {
        self.reserve(1);
        for (arrays, ([x, y], depth)) in self.arrays.iter_mut().zip(corners) {
            for (array, value) in arrays.iter_mut().zip([x, y, depth.to_bits() as i32]) {
                array[self.len] = value;
            }
        }
        self.len += 1;
    }
}
