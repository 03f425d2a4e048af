//! Which boxes are hidden, by a z-buffer that keeps the depth of every pixel.

use crate::landscape::{Landscape, NEAR};
use crate::raster::ZBuffer;

pub struct Truth {
    /// For each box: is it hidden?
    pub is_hidden: Vec<bool>,
    /// For each box: may it be culled, with the benefit of rounding?
    pub may_be_hidden: Vec<bool>,
    /// How many are hidden.
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
        let is_hidden: Vec<bool> = landscape.boxes.iter().map(|b| hides(&exact, b, 1.0, 0.0)).collect();
        let may_be_hidden = landscape.boxes.iter().map(|b| hides(&generous, b, 1.0 + 1e-5, 1e-3)).collect();
        Self { hidden: is_hidden.iter().filter(|h| **h).count(), is_hidden, may_be_hidden }
    }
}

/// Is everything nearer than the rectangle, in all pixels that it touches? Depths are taken times `factor`, and the
/// rectangle is drawn in by `inset` pixels.
fn hides(buffer: &ZBuffer, &[x_min, y_min, x_max, y_max, w]: &[f32; 5], factor: f32, inset: f64) -> bool {
    let across = |x: f32| (f64::from(x) * 0.5 + 0.5) * buffer.width as f64;
    let down = |y: f32| (0.5 - f64::from(y) * 0.5) * buffer.height as f64;
    // From the first pixel touched to the one after the last.
    let pixels = |low: f64, high: f64, end: usize| {
        let first = ((low + inset).floor() as usize).min(end - 1);
        first..((high - inset).ceil() as usize).clamp(first + 1, end)
    };
    let columns = pixels(across(x_min), across(x_max), buffer.width);
    pixels(down(y_max), down(y_min), buffer.height).all(|row| {
        let row = &buffer.depth[row * buffer.width..][..buffer.width];
        row[columns.clone()].iter().all(|depth| depth * factor > NEAR / w)
    })
}
