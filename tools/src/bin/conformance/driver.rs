//! The interface to a graphics driver: returns the coverage of a batch of triangles, separately for each.
//!
//! The target has four unsigned words per pixel, and the fragment shader of triangle i writes bit i of the 128. A
//! logical exclusive-or with the contents, a fixed function of both APIs, keeps the triangles separate: nothing is
//! summed or hashed, so no two differences can cancel. If a driver shaded a pixel twice for one triangle, its bit would
//! be lost.

use std::error::Error;

use masked_occlusion_culling::YAxis;

use crate::view::View;

/// Words of coverage per pixel.
pub const WORDS: usize = 4;
/// Triangles that are drawn together.
pub const BATCH: usize = 32 * WORDS;
/// The vertices of a batch, as x, y, z, w.
pub type Vertices = [[f32; 4]; 3 * BATCH];

/// A device opened through one API, with a target for one screen at a time.
pub trait Driver {
    /// The device, its driver and their versions.
    fn name(&self) -> &str;

    /// The API, and the direction in which it counts rows.
    fn api(&self) -> (&'static str, YAxis);

    /// The number of subpixel bits.
    fn subpixel_bits(&self) -> u32;

    /// The largest side of a viewport.
    fn most_side(&self) -> u32;

    /// Creates the target.
    fn set_view(&mut self, view: View) -> Result<(), Box<dyn Error>>;

    /// Starts drawing a batch into a cleared target.
    fn draw(&mut self, vertices: &Vertices) -> Result<(), Box<dyn Error>>;

    /// Waits for the batch: [`WORDS`] words per pixel in native byte order, row 0 first.
    fn read(&mut self) -> Result<&[u8], Box<dyn Error>>;
}
