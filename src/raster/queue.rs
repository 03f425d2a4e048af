//! Queues the triangles that survive culling and clipping, in order, until they fill vectors.

use core::mem::MaybeUninit;

use crate::geometry::Corner;
use crate::simd::{MAX_LANES, Simd};

/// Capacity in triangles.
pub(crate) const CAPACITY: usize = 256;

/// Corner by corner (clockwise with y down): x, y, 1/w.
#[repr(C, align(64))]
pub(crate) struct TriangleQueue {
    lanes: [[MaybeUninit<f32>; CAPACITY + MAX_LANES]; 9],
    len: usize,
}

impl TriangleQueue {
    #[inline(always)]
    pub fn uninit() -> MaybeUninit<Self> {
        MaybeUninit::uninit()
    }

    /// Makes an empty queue in this memory.
    #[inline(always)]
    pub fn of(memory: &mut MaybeUninit<Self>) -> &mut Self {
        // SAFETY: the length is written here; everything else is arrays of `MaybeUninit`.
        unsafe {
            (&raw mut (*memory.as_mut_ptr()).len).write(0);
            memory.assume_init_mut()
        }
    }

    #[inline(always)]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Appends a triangle.
    ///
    /// # Panics
    /// If there is no room.
    #[inline]
    pub fn push(&mut self, corners: &[[f32; 3]; 3]) {
        assert!(self.len < CAPACITY);
        for (lanes, &x) in self.lanes.iter_mut().zip(corners.as_flattened()) {
            lanes[self.len].write(x);
        }
        self.len += 1;
    }

    /// Appends the triangles in `m`.
    ///
    /// # Safety
    /// There is room for a vector.
    #[inline(always)]
    pub unsafe fn append<S: Simd>(&mut self, s: S, m: S::M, corners: &[Corner<S>; 3]) {
        debug_assert!(self.len + S::LANES <= CAPACITY + MAX_LANES);
        let mut n = 0;
        for k in 0..9 {
            // SAFETY: the caller's contract.
            unsafe {
                let to = self.lanes.get_unchecked_mut(k).as_mut_ptr().add(self.len);
                n = s.compress(to.cast(), m, s.bits(corners[k / 3][k % 3]));
            }
        }
        self.len += n;
    }

    /// The vector of triangles starting at `first`; lanes after the last triangle are zero.
    #[inline(always)]
    pub fn vector<S: Simd>(&mut self, s: S, first: usize) -> [Corner<S>; 3] {
        assert!(first < self.len && self.len <= CAPACITY);
        if first + S::LANES > self.len {
            for lanes in &mut self.lanes {
                // SAFETY: there is room for a vector after the last triangle.
                unsafe { s.store_f(lanes.as_mut_ptr().add(self.len).cast(), s.f(0.0)) };
            }
        }
        // SAFETY: there is room for a vector after the last triangle, and it was just written.
        let load = |k: usize| unsafe { s.load_f(self.lanes[k].as_ptr().add(first).cast()) };
        [[load(0), load(1), load(2)], [load(3), load(4), load(5)], [load(6), load(7), load(8)]]
    }

    /// Removes the first `n` triangles, which leaves less than a vector.
    #[inline(always)]
    pub fn remove<S: Simd>(&mut self, s: S, n: usize) {
        assert!(n <= self.len && self.len < n + S::LANES);
        if n == self.len {
            self.len = 0;
            return;
        }
        for lanes in &mut self.lanes {
            // SAFETY: there is room for a vector after the last triangle, and it is written first.
            unsafe {
                s.store_f(lanes.as_mut_ptr().add(self.len).cast(), s.f(0.0));
                s.store_f(lanes.as_mut_ptr().cast(), s.load_f(lanes.as_ptr().add(n).cast()));
            }
        }
        self.len -= n;
    }
}
