//! The point of the 1/256-pixel grid on which a clip-space vertex lands, if rounding to single precision on the way
//! leaves no doubt.

use super::Vertex;

/// The vertex on a screen of `size`; `None` if four roundings in f32 might put it on another grid point, or if it is
/// not in front of the eye.
pub fn snapped([x, y, _, w]: [f32; 4], size: (usize, usize), y_up: bool) -> Option<Vertex> {
    if w.is_nan() || w <= 0.0 {
        return None;
    }
    let power_of_two = w.to_bits() & 0x7f_ffff == 0;
    let axis = |c: f32, size: usize| {
        let half = size as f64 * 128.0;
        let offset = f64::from(c) / f64::from(w) * half;
        let at = offset + half;
        let point = at.round_ties_even();
        // 1/w, its product with the coordinate, the product with half the screen, and the sum.
        let exact = power_of_two && size.is_power_of_two();
        let scaled = if exact { 0.0 } else { 3.0 * offset.abs() };
        let summed = if exact && at == point && at.abs() < 16_777_216.0 { 0.0 } else { at.abs() };
        let doubt = (scaled + summed) / 16_777_216.0 * 1.000_001;
        ((at - point).abs() + doubt < 0.5).then_some(point as i64)
    };
    let row = axis(if y_up { y } else { -y }, size.1)?;
    Some(Vertex { x: axis(x, size.0)?, y: row, z: 1.0 / f64::from(w) })
}
