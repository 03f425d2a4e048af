//! The rectangle on the screen around a box, and whether a z-buffer hides it.

use glam::{Mat4, Vec3};

use demo::camera::box_corners;
use demo::raster::ZBuffer;

/// The rectangle around a box in normalised device coordinates (least x and y, greatest x and y) and its least w; none where
/// it reaches before the near plane.
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

/// Is everything nearer than a rectangle in all pixels of the screen that it touches? Depths are taken times `factor`, and the
/// rectangle is drawn in by `inset` pixels. `near` is what depths of z/w are scaled by.
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
