//! A vector of triangles between setup and traversal.

use super::scratch::MAX_LANES;

/// A vector of triangles, set up: what the traversal reads, lane by lane.
#[repr(C, align(64))]
pub(super) struct Batch {
    /// Left edge: constant part of the event, and slope in pixels a row.
    pub left: [f64; MAX_LANES],
    pub left_slope: [f64; MAX_LANES],
    pub right: [f64; MAX_LANES],
    pub right_slope: [f64; MAX_LANES],
    /// The edge between the two lower corners bounds one side; on the other it is nowhere.
    pub middle_left: [f64; MAX_LANES],
    pub middle_right: [f64; MAX_LANES],
    pub middle_slope: [f64; MAX_LANES],
    /// The edges once more, rounded: for bounds of what a row of tiles reaches.
    pub rounded: Rounded,
    /// Depth bound of the first sub-tile of the first tile, and its change from sub-tile to sub-tile.
    pub z: [f32; MAX_LANES],
    pub z_across: [f32; MAX_LANES],
    pub z_down: [f32; MAX_LANES],
    /// The bound is clamped to this: the farthest vertex of a draw, the nearest of a query.
    pub z_clamp: [f32; MAX_LANES],
    /// The nearest vertex.
    pub nearest: [f32; MAX_LANES],
    /// Tiles of the bounding box, the last inside.
    pub tile_x0: [u32; MAX_LANES],
    pub tile_x1: [u32; MAX_LANES],
    pub tile_y0: [u32; MAX_LANES],
    pub tile_y1: [u32; MAX_LANES],
    /// Rows and columns of pixels of the bounding box, the last outside.
    pub row0: [f32; MAX_LANES],
    pub row1: [f32; MAX_LANES],
    pub column0: [f32; MAX_LANES],
    pub column1: [f32; MAX_LANES],
    /// x, y and 1/w of the three corners.
    pub corners: [[f32; MAX_LANES]; 9],
}

/// Edges in f32.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Rounded {
    pub left: [f32; MAX_LANES],
    pub left_slope: [f32; MAX_LANES],
    pub right: [f32; MAX_LANES],
    pub right_slope: [f32; MAX_LANES],
    pub middle_left: [f32; MAX_LANES],
    pub middle_right: [f32; MAX_LANES],
    pub middle_slope: [f32; MAX_LANES],
}

impl Batch {
    /// All zeros.
    pub fn new() -> Self {
        // SAFETY: it is arrays of numbers, and all bits zero are a number of each kind.
        unsafe { core::mem::MaybeUninit::zeroed().assume_init() }
    }
}
