//! What a graphics driver is asked: the coverage of a batch of triangles, each by itself.
//!
//! The target has four unsigned words a pixel, and the fragment shader of triangle i writes bit i of the 128. A logical
//! exclusive or with what is there, which is a fixed function of both APIs, keeps the triangles apart: nothing is summed or
//! hashed, so that no two differences can cancel. A pixel that a driver shaded twice for one triangle would lose its bit.

use std::error::Error;

use masked_occlusion_culling::YAxis;

use crate::view::View;

/// Words of coverage a pixel.
pub const WORDS: usize = 4;
/// Triangles that are drawn at once.
pub const BATCH: usize = 32 * WORDS;
/// Vertices of a batch, each x, y, z, w.
pub type Vertices = [[f32; 4]; 3 * BATCH];

/// A device through one API, with a target for one screen at a time.
pub trait Driver {
    /// The device, its driver and their versions.
    fn name(&self) -> &str;

    /// The API, and which way rows are counted in it.
    fn api(&self) -> (&'static str, YAxis);

    /// The bits of its subpixel grid.
    fn subpixel_bits(&self) -> u32;

    /// The largest side of a viewport.
    fn most_side(&self) -> u32;

    /// Makes the target.
    fn set_view(&mut self, view: View) -> Result<(), Box<dyn Error>>;

    /// Begins drawing a batch into a clear target.
    fn draw(&mut self, vertices: &Vertices) -> Result<(), Box<dyn Error>>;

    /// Waits for what was drawn: [`WORDS`] words a pixel in the machine's byte order, row 0 first.
    fn read(&mut self) -> Result<&[u8], Box<dyn Error>>;
}
