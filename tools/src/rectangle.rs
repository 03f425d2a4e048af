//! The screen rectangle of a box, and whether a z-buffer hides it.

use glam::{Mat4, Vec3};

use demo::camera::box_corners;
use demo::raster::ZBuffer;

/// The rectangle of a box in normalised device coordinates (minimum x and y, maximum x and y) and its minimum w; none
/// if it crosses the near plane.
pub fn rectangle(lo: Vec3, hi: Vec3, clip: &Mat4, near: f32) -> Option<[f32; 5]> {
    let mut r = [f32::INFINITY, f32::INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY, f32::INFINITY];
    for p in box_corners(lo, hi).map(|p| *clip * p.extend(1.0)) {
        if p.w <= near {
            return None;
        }
        let (x, y) = (p.x / p.w, p.y / p.w);
        r = [r[0].min(x), r[1].min(y), r[2].max(x), r[3].max(y), r[4].min(p.w)];
    }
    Some(r)
}

/// Whether all pixels that a rectangle touches on the screen are nearer than it. Depths are multiplied by `factor`, and
/// the rectangle is shrunk by `inset` pixels. Depths are z/w scaled by `near`.
pub fn hides(
    buffer: &ZBuffer,
    &[x_min, y_min, x_max, y_max, w]: &[f32; 5],
    near: f32,
    factor: f32,
    inset: f64,
) -> bool {
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
        row[columns.clone()].iter().all(|depth| depth * factor > near / w)
    })
}
