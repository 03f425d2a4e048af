//! Pictures of the depths in a buffer.

use glam::Vec3;

use crate::image::Image;

/// Pictures with longer sides take minutes to compress.
const LARGEST: u32 = 4096;

/// The picture's size: that of the buffer or, if that is too large, a smaller one with the same aspect ratio.
pub fn reduced((width, height): (u32, u32)) -> (usize, usize) {
    let divisor = width.max(height).div_ceil(LARGEST).max(1);
    ((width / divisor).max(1) as usize, (height / divisor).max(1) as usize)
}

/// The depth of every pixel, on a logarithmic scale: near is bright, and pixels where nothing was drawn are dark.
pub fn depth_picture(depth: &[f32], (from_w, from_h): (u32, u32), (width, height): (usize, usize)) -> Image {
    let mut known: Vec<f32> = depth.iter().copied().filter(|d| *d > 0.0).collect();
    let mut quantile = |q: f32| {
        let at = (known.len() as f32 * q) as usize;
        if at < known.len() { known.select_nth_unstable_by(at, f32::total_cmp).1.ln() } else { 1.0 }
    };
    let (far, near) = (quantile(0.002), quantile(0.99));
    let stops = [0x10121f, 0x3b2a63, 0x8c3a70, 0xdc6a55, 0xf9b66a, 0xfcf3c4]
        .map(|c: u32| Vec3::new((c >> 16) as f32, (c >> 8 & 255) as f32, (c & 255) as f32) / 255.0);
    let colour = |d: f32| {
        if d <= 0.0 {
            return Vec3::new(0.02, 0.025, 0.04);
        }
        let t = (0.08 + 0.92 * (d.ln() - far) / (near - far).max(1e-6)).clamp(0.0, 1.0) * (stops.len() - 1) as f32;
        let i = (t as usize).min(stops.len() - 2);
        stops[i].lerp(stops[i + 1], t - i as f32)
    };
    let mut image = Image::new(width, height, Vec3::ZERO);
    for (i, pixel) in image.pixels.iter_mut().enumerate() {
        // The mean of the buffer's pixels that this one covers (at least one).
        let range = |at: usize, to: usize, from: u32| {
            let lo = at * from as usize / to;
            lo..((at + 1) * from as usize / to).max(lo + 1)
        };
        let (mut sum, mut n) = (Vec3::ZERO, 0.0);
        for y in range(i / width, height, from_h) {
            for x in range(i % width, width, from_w) {
                sum += colour(depth[y * from_w as usize + x]);
                n += 1.0;
            }
        }
        *pixel = sum / n;
    }
    image
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_picture_is_reduced_and_keeps_its_shape() {
        assert_eq!(reduced((1920, 1080)), (1920, 1080));
        assert_eq!(reduced((16_384, 16_384)), (4096, 4096));
        assert_eq!(reduced((8000, 1)), (4000, 1));
    }
}
