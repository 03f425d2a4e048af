//! Leaking pixels: the buffer's depth is much farther than the true one.

use glam::Vec3;

use crate::survey::Share;
use demo::image::Image;
use demo::raster::ZBuffer;

const RED: Vec3 = Vec3::new(0.93, 0.13, 0.1);

/// Whether a pixel's depth in the buffer, `stored` in 1/w, is less than half of the true depth.
fn leaks(stored: f32, exact: f32) -> bool {
    exact > 0.0 && stored < 0.5 * exact
}

/// Number of covered pixels that leak. Exact depths are near/w.
pub fn leaking(stored: &[f32], exact: &ZBuffer, near: f32) -> Share {
    let covered = exact.depth.iter().filter(|d| **d > 0.0).count();
    let part = stored.iter().zip(&exact.depth).filter(|(s, e)| leaks(**s, *e / near)).count();
    Share { part, whole: covered }
}

/// The exact depths in grey, near is bright, with leaking pixels in red; at a quarter of the width and height.
pub fn picture(stored: &[f32], exact: &ZBuffer, near: f32) -> Image {
    const STEP: usize = 4;
    let (width, height) = (exact.width / STEP, exact.height / STEP);
    let mut known: Vec<f32> = exact.depth.iter().copied().filter(|d| *d > 0.0).collect();
    known.sort_unstable_by(f32::total_cmp);
    let at = |part: f32| known.get((known.len() as f32 * part) as usize).map_or(0.0, |d| d.ln());
    let (far, near_most) = (at(0.01), at(0.98));
    let mut image = Image::new(width, height, Vec3::ZERO);
    for (i, pixel) in image.pixels.iter_mut().enumerate() {
        let (x, y) = (i % width * STEP, i / width * STEP);
        for p in (0..STEP * STEP).map(|p| (y + p / STEP) * exact.width + x + p % STEP) {
            let depth = exact.depth[p];
            let grey = ((depth.max(1e-30).ln() - far) / (near_most - far).max(1e-6)).clamp(0.0, 1.0);
            let colour = match (leaks(stored[p], depth / near), depth > 0.0) {
                (true, _) => RED,
                (_, true) => Vec3::splat(0.12 + 0.7 * grey),
                _ => Vec3::new(0.05, 0.06, 0.09),
            };
            *pixel += colour / (STEP * STEP) as f32;
        }
    }
    image
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_is_enough_and_nothing_leaks_where_nothing_is() {
        let mut exact = ZBuffer::new(4, 4);
        exact.depth[0] = 0.2;
        exact.depth[1] = 0.2;
        let mut stored = vec![-1.0; 16];
        stored[0] = 1.0;
        stored[1] = 0.9;
        assert_eq!(leaking(&stored, &exact, 0.1), Share { part: 1, whole: 2 });
        let red = picture(&stored, &exact, 0.1).pixels[0];
        assert!(red.x > red.y, "{red}");
    }
}
