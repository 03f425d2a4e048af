//! The smallest program: draw one triangle as an occluder and ask what it hides.

use masked_occlusion_culling::{DrawOptions, Error, MaskedOcclusionCulling, Settings, Vertices};

fn main() -> Result<(), Error> {
    // Uses the best instruction set of this processor.
    let mut culling = MaskedOcclusionCulling::new(640, 360, Settings::default())?;

    // Each frame: clear, draw occluders, test occludees.
    culling.clear_buffer();

    // Clip space: x, y, z, w; z is not read. A point is on screen if -w <= x <= w and -w <= y <= w; w is the distance
    // from the eye. This triangle is 5 away and front-facing: its corners are in counter-clockwise order.
    let triangle = [[-4.0, -4.0, 0.0, 5.0], [4.0, -4.0, 0.0, 5.0], [0.0, 4.0, 0.0, 5.0]];
    culling.render_triangles(Vertices::clip_space(&triangle), &[0, 1, 2], &DrawOptions::default())?;

    // Rectangles in normalised device coordinates (x/w and y/w), and the w of the nearest point.
    println!("behind the triangle:  {:?}", culling.test_rect(-0.1, -0.1, 0.1, 0.1, 8.0));
    println!("in front of it:       {:?}", culling.test_rect(-0.1, -0.1, 0.1, 0.1, 3.0));
    println!("beside it:            {:?}", culling.test_rect(-0.9, 0.6, -0.7, 0.8, 8.0));
    println!("off the screen:       {:?}", culling.test_rect(1.5, -0.1, 1.7, 0.1, 8.0));
    Ok(())
}
