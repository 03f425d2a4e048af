//! Triangles wider than 32,768 pixels, one by one: their products do not fit in f64, so integer arithmetic is used.
//!
//! The constant part of an edge's event is computed as quotient and remainder of 128-bit integers and rounded once.
//! With coordinates up to 2^26 the remaining error (this rounding and those of the slope, of its product with the row,
//! and of the sum) is below half of the tolerance wherever the event is on the screen.

use super::batch::Batch;
use super::bits;

/// A position, in pixels, at which an edge bounds nothing.
const UNBOUNDED: f64 = crate::geometry::coverage::UNBOUNDED as f64;

/// Corner `k` of a lane.
///
/// # Safety
/// Set-up has stored the corners of the batch.
unsafe fn corner(batch: &Batch, lane: usize, k: usize) -> (i64, i64) {
    // SAFETY: the caller's contract.
    unsafe { (batch.corners[3 * k].get(lane) as i64, batch.corners[3 * k + 1].get(lane) as i64) }
}

/// The front-facing lanes, using the exact sign of the area for those in `wide`.
///
/// # Safety
/// Set-up has stored the corners of the batch.
#[cold]
pub(crate) unsafe fn correct_facing(batch: &Batch, alive: u32, wide: u32) -> u32 {
    let mut lanes = alive & !wide;
    for lane in bits(wide) {
        // SAFETY: the caller's contract.
        let [(x0, y0), (x1, y1), (x2, y2)] = [0, 1, 2].map(|k| unsafe { corner(batch, lane, k) });
        if (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0) > 0 {
            lanes |= 1 << lane;
        }
    }
    lanes
}

/// Replaces the edges of these lanes.
///
/// # Safety
/// If there are any, set-up has stored the corners of the batch.
#[inline(always)]
pub(crate) unsafe fn replace_wide(batch: &mut Batch, wide: u32) {
    if wide != 0 {
        // SAFETY: the caller's contract.
        unsafe { replace(batch, wide) };
    }
}

/// # Safety
/// Set-up has stored the corners of the batch.
#[cold]
unsafe fn replace(batch: &mut Batch, wide: u32) {
    for lane in bits(wide) {
        // SAFETY: the caller's contract.
        let [v0, v1, v2] = [0, 1, 2].map(|k| unsafe { corner(batch, lane, k) });
        let (right, right_slope) = edge(v0, v1).unwrap_or((UNBOUNDED, 0.0));
        let (left, left_slope) = edge(v0, v2).unwrap_or((-UNBOUNDED, 0.0));
        let (upper, lower) = if v1.1 <= v2.1 { (v1, v2) } else { (v2, v1) };
        let (middle, middle_slope) = edge(upper, lower).unwrap_or((0.0, 0.0));
        let middle_left = if v2.1 < v1.1 { middle } else { -UNBOUNDED };
        let middle_right = if v2.1 > v1.1 { middle } else { UNBOUNDED };
        macro_rules! set {
            ($($field:ident)*) => {$(
                batch.$field.set(lane, $field);
                batch.rounded.$field.set(lane, $field as f32);
            )*};
        }
        set!(left left_slope right right_slope middle_left middle_right middle_slope);
    }
}

/// Constant part and slope of the event of an edge from `upper` down to `lower`; `None` for a horizontal edge.
fn edge((x0, y0): (i64, i64), (x1, y1): (i64, i64)) -> Option<(f64, f64)> {
    let (dx, dy) = (i128::from(x1 - x0), i128::from(y1 - y0));
    if dy == 0 {
        return None;
    }
    // At row 0's centre, less half a pixel: a fraction over 256 * dy.
    let numerator = i128::from(x0 - 128) * dy + dx * i128::from(128 - y0);
    let denominator = 256 * dy;
    let (whole, part) = (numerator.div_euclid(denominator), numerator.rem_euclid(denominator));
    // Biased in 1/512 of dy: twice the fraction, less one, over twice the denominator.
    let fraction = (2 * part - 1) as f64 / (2 * denominator) as f64;
    Some(((whole + 1) as f64 + fraction, dx as f64 / dy as f64))
}
