//! The interface to a library: enough to draw a frame and to check that it was drawn.

use clap::ValueEnum;
use glam::Mat4;

use super::mesh::Mesh;
use super::scene::Scene;
use crate::Result;
use demo::options::Isa;

pub trait Culler {
    /// Its name in the table and the legends.
    fn name(&self) -> String;
    /// A cleared buffer of this size.
    fn set_size(&mut self, width: u32, height: u32) -> Result<()>;
    fn set_near(&mut self, near: f32);
    fn clear(&mut self);
    fn draw(&mut self, mesh: &Mesh, model_to_clip: &Mat4);
    /// Called after all meshes of a frame, before any query.
    fn finish(&mut self) {}
    /// Whether a rectangle (minimum x and y, maximum x and y, from -1 to 1) at distance `w` is certainly hidden.
    fn hides(&self, rectangle: [f32; 4], w: f32) -> bool;
}

/// The timed part: a clear, and every mesh.
pub fn frame(culler: &mut dyn Culler, scene: &Scene) {
    culler.clear();
    for mesh in &scene.meshes {
        culler.draw(mesh, &scene.clip_from_world);
    }
    culler.finish();
}

const COLUMNS: u16 = 40;
const ROWS: u16 = 25;
/// The rectangles that [`hidden`] tests.
pub const PROBES: usize = COLUMNS as usize * ROWS as usize;

/// Number of rectangles of a grid over the screen, far behind everything, that are hidden: a library that draws less
/// than another, or nothing, is not faster.
pub fn hidden(culler: &dyn Culler) -> usize {
    let edge = |i: u16, n: u16| 2.0 * f32::from(i) / f32::from(n) - 1.0;
    let rectangles = (0..ROWS).flat_map(|y| (0..COLUMNS).map(move |x| (x, y)));
    rectangles
        .filter(|&(x, y)| culler.hides([edge(x, COLUMNS), edge(y, ROWS), edge(x + 1, COLUMNS), edge(y + 1, ROWS)], 1e6))
        .count()
}

/// The name of an instruction set, from a library's number.
pub fn isa_name(number: i32) -> String {
    let known = Isa::value_variants().iter().find(|isa| **isa as i32 == number);
    known.map_or_else(|| format!("instruction set {number}"), |isa| isa.name())
}
