//! Which boxes are hidden, by a full-resolution z-buffer.

use super::landscape::{Landscape, NEAR};
use crate::rectangle::hides;
use demo::raster::ZBuffer;

pub struct Truth {
    /// For each box: whether it is hidden.
    pub is_hidden: Vec<bool>,
    /// For each box: whether it may be culled, with the benefit of rounding.
    pub may_be_hidden: Vec<bool>,
    /// Number of hidden boxes.
    pub hidden: usize,
}

impl Truth {
    pub fn new(landscape: &Landscape, width: u32, height: u32) -> Self {
        let size = (width as usize, height as usize);
        let mut exact = ZBuffer::new(size.0, size.1);
        // Grown by half a step of the vertex grid.
        let mut generous = ZBuffer { grow: 1.0 / 512.0, ..ZBuffer::new(size.0, size.1) };
        for object in landscape.terrain.iter().chain(&landscape.foreground) {
            for buffer in [&mut exact, &mut generous] {
                buffer.draw(object, 0, &landscape.clip_from_world, NEAR);
            }
        }
        let is_hidden: Vec<bool> = landscape.boxes.iter().map(|b| hides(&exact, b, NEAR, 1.0, 0.0)).collect();
        let may_be_hidden = landscape.boxes.iter().map(|b| hides(&generous, b, NEAR, 1.0 + 1e-5, 1e-3)).collect();
        Self { hidden: is_hidden.iter().filter(|h| **h).count(), is_hidden, may_be_hidden }
    }
}
