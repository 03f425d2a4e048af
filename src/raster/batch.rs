//! A vector of triangles between set-up and traversal.

use core::mem::MaybeUninit;

use crate::simd::MAX_LANES;

/// A value per lane, uninitialised: zeroing a batch on every call would be measurable.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Lanes<X: Copy>([MaybeUninit<X>; MAX_LANES]);

impl<X: Copy> Lanes<X> {
    /// # Safety
    /// Set-up stored this field for this lane.
    #[inline(always)]
    pub unsafe fn get(&self, lane: usize) -> X {
        // SAFETY: the caller's contract.
        unsafe { self.0[lane % MAX_LANES].assume_init() }
    }

    #[inline(always)]
    pub fn set(&mut self, lane: usize, x: X) {
        self.0[lane].write(x);
    }

    #[inline(always)]
    pub fn as_ptr(&self) -> *const X {
        self.0.as_ptr().cast()
    }

    #[inline(always)]
    pub fn as_mut_ptr(&mut self) -> *mut X {
        self.0.as_mut_ptr().cast()
    }
}

/// A vector of triangles after set-up, read lane by lane by the traversal.
#[repr(C, align(64))]
pub(crate) struct Batch {
    /// Left edge: the constant part of its event, and its slope in pixels per row.
    pub left: Lanes<f64>,
    pub left_slope: Lanes<f64>,
    pub right: Lanes<f64>,
    pub right_slope: Lanes<f64>,
    /// The edge between the two lower corners bounds one side; on the other it is placed where it bounds nothing.
    pub middle_left: Lanes<f64>,
    pub middle_right: Lanes<f64>,
    pub middle_slope: Lanes<f64>,
    /// The edges rounded to f32, which bound the tiles that a tile row reaches.
    pub rounded: Rounded,
    /// Depth bound of the first sub-tile of the first tile, and its change per sub-tile.
    pub z: Lanes<f32>,
    pub z_across: Lanes<f32>,
    pub z_down: Lanes<f32>,
    /// The limit of the bound.
    pub z_limit: Lanes<f32>,
    /// The nearest vertex.
    pub nearest: Lanes<f32>,
    /// Tiles of the bounding box, inclusive.
    pub tile_x0: Lanes<u32>,
    pub tile_x1: Lanes<u32>,
    pub tile_y0: Lanes<u32>,
    pub tile_y1: Lanes<u32>,
    /// Rows and columns of pixels of the bounding box, end exclusive.
    pub row0: Lanes<f32>,
    pub row1: Lanes<f32>,
    pub column0: Lanes<u32>,
    pub column1: Lanes<u32>,
    /// x, y and 1/w of the three corners.
    pub corners: [Lanes<f32>; 9],
}

/// The edges in f32.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Rounded {
    pub left: Lanes<f32>,
    pub left_slope: Lanes<f32>,
    pub right: Lanes<f32>,
    pub right_slope: Lanes<f32>,
    pub middle_left: Lanes<f32>,
    pub middle_right: Lanes<f32>,
    pub middle_slope: Lanes<f32>,
}

impl Batch {
    #[inline(always)]
    pub fn uninit() -> Self {
        // SAFETY: all of it is `MaybeUninit`.
        unsafe { MaybeUninit::uninit().assume_init() }
    }

    /// First and last column and row of tiles of a triangle's bounds.
    ///
    /// # Safety
    /// Set-up has stored the batch.
    #[inline(always)]
    pub unsafe fn tiles(&self, lane: usize) -> [u32; 4] {
        // SAFETY: set-up stores the tiles of all lanes; the caller's contract.
        unsafe { [self.tile_x0.get(lane), self.tile_x1.get(lane), self.tile_y0.get(lane), self.tile_y1.get(lane)] }
    }
}
