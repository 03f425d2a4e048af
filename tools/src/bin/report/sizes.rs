//! The cost of a triangle by its size: figure 11 of the HPG 2016 paper, comparing the masked buffer with a
//! full-resolution z-buffer.

use std::time::Duration;

use tools::Result;
use tools::scaling::culler::Culler;
use tools::scaling::measure::measure;
use tools::scaling::scene::right_triangles;

/// Length of the legs in pixels.
const LEGS: [u32; 11] = [1, 2, 5, 10, 25, 50, 75, 100, 150, 250, 500];
/// The paper's number.
const TRIANGLES: u32 = 32 << 10;
/// Maximum number of pixels per frame, so that the largest triangles do not take minutes.
const PIXELS: u32 = 400 << 20;

pub struct Row {
    pub leg: u32,
    pub triangles: u32,
    /// One for each library.
    pub seconds: Vec<f64>,
}

impl Row {
    pub fn ns_per_triangle(&self, library: usize) -> f64 {
        self.seconds[library] * 1e9 / f64::from(self.triangles)
    }

    pub fn ns_per_pixel(&self, library: usize) -> f64 {
        self.ns_per_triangle(library) / (f64::from(self.leg * self.leg) / 2.0)
    }
}

pub const fn rows() -> usize {
    LEGS.len()
}

pub fn study(
    cullers: &mut [Box<dyn Culler>],
    size: (u32, u32),
    limit: Duration,
    mut tick: impl FnMut(),
) -> Result<Vec<Row>> {
    let row = |leg: u32| -> Result<Row> {
        let triangles = TRIANGLES.min(2 * PIXELS / (leg * leg));
        let scene = right_triangles(leg as f32, triangles, size.1);
        let samples = measure(cullers, &scene, size, limit)?;
        tick();
        Ok(Row { leg, triangles, seconds: samples.iter().map(|s| s.seconds).collect() })
    };
    LEGS.into_iter().map(row).collect()
}
