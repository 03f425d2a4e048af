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
    pub row0: [u32; MAX_LANES],
    pub row1: [u32; MAX_LANES],
    pub column0: [u32; MAX_LANES],
    pub column1: [u32; MAX_LANES],
    /// x, y and 1/w of the three corners.
    pub corners: [[f32; MAX_LANES]; 9],
}

impl Batch {
    pub fn new() -> Self {
        Self {
            left: [0.0; MAX_LANES],
            left_slope: [0.0; MAX_LANES],
            right: [0.0; MAX_LANES],
            right_slope: [0.0; MAX_LANES],
            middle_left: [0.0; MAX_LANES],
            middle_right: [0.0; MAX_LANES],
            middle_slope: [0.0; MAX_LANES],
            z: [0.0; MAX_LANES],
            z_across: [0.0; MAX_LANES],
            z_down: [0.0; MAX_LANES],
            z_clamp: [0.0; MAX_LANES],
            nearest: [0.0; MAX_LANES],
            tile_x0: [0; MAX_LANES],
            tile_x1: [0; MAX_LANES],
            tile_y0: [0; MAX_LANES],
            tile_y1: [0; MAX_LANES],
            row0: [0; MAX_LANES],
            row1: [0; MAX_LANES],
            column0: [0; MAX_LANES],
            column1: [0; MAX_LANES],
            corners: [[0.0; MAX_LANES]; 9],
        }
    }
}
