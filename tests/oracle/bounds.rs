//! The exact depth bound of a block of 8x4 pixels, and the size of a unit in the last place.

use super::{Triangle, UNIT, Vertex, area};

/// 2^k, assembled from bits: exact on every machine.
pub fn power(k: i32) -> f64 {
    assert!((-1022..=1023).contains(&k), "2^{k} is not a normal number");
    f64::from_bits(((1023 + i64::from(k)) as u64) << 52)
}

/// The distance between neighbouring f32 numbers at a positive `x`, which need not be one of them: 2^(e - 23) for 2^e
/// <= x < 2^(e + 1).
pub fn ulp(x: f64) -> f64 {
    assert!(x > 0.0 && x.is_finite(), "{x} has no unit in the last place");
    power(((x.to_bits() >> 52) as i32 - 1023).max(-126) - 23)
}

/// a * b without rounding, as a sum of two (Dekker 1971).
fn product(a: f64, b: f64) -> (f64, f64) {
    let split = |x: f64| {
        let c = x * 134_217_729.0;
        let high = c - (c - x);
        (high, x - high)
    };
    let ((ah, al), (bh, bl), p) = (split(a), split(b), a * b);
    (p, ((ah * bh - p) + ah * bl + al * bh) + al * bl)
}

/// a + b without rounding, as a sum of two (Knuth).
fn sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let t = s - a;
    (s, (a - (s - t)) + (b - t))
}

/// 1/w of the triangle's plane at a point given in units, with sums and products in twice double precision: for slivers,
/// large numbers cancel.
pub fn plane_at(t: &Triangle, x: i64, y: i64) -> f64 {
    let edge = |a: &Vertex, b: &Vertex| (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
    let weights = [edge(&t[1], &t[2]), edge(&t[2], &t[0]), edge(&t[0], &t[1])];
    let (mut total, mut rest) = (0.0, 0.0);
    for (weight, v) in weights.into_iter().zip(t) {
        let low = weight & ((1 << 26) - 1);
        for part in [weight - low, low] {
            let (p, p_rest) = product(part as f64, v.z);
            let (s, s_rest) = sum(total, p);
            total = s;
            rest += p_rest + s_rest;
        }
    }
    (total + rest) / area(t) as f64
}

/// The corners, in units, of the block of 8x4 pixels that contains a pixel.
pub fn block_corners(column: usize, row: usize) -> [(i64, i64); 4] {
    let (x, y) = (column as i64 / 8 * 8 * UNIT, row as i64 / 4 * 4 * UNIT);
    [(x, y), (x + 8 * UNIT, y), (x, y + 4 * UNIT), (x + 8 * UNIT, y + 4 * UNIT)]
}

/// The nearest valid depth for the whole block of a pixel: the plane's least value over the block, but no farther than
/// the farthest vertex.
pub fn block_bound(t: &Triangle, column: usize, row: usize) -> f64 {
    let farthest = t.iter().fold(f64::MAX, |m, v| m.min(v.z));
    block_corners(column, row).iter().fold(f64::MAX, |m, &(x, y)| m.min(plane_at(t, x, y))).max(farthest)
}

/// The signed distance, in pixels, from a pixel's centre to the triangle's edge lines: positive inside, to the nearest
/// line; negative outside, to the farthest of the lines that it is outside of.
pub fn inside_by(t: &Triangle, column: usize, row: usize) -> f64 {
    let (x, y) = (column as i64 * UNIT + UNIT / 2, row as i64 * UNIT + UNIT / 2);
    let turned = if area(t) < 0 { -1.0 } else { 1.0 };
    let edge = |a: &Vertex, b: &Vertex| {
        let (dx, dy) = (b.x - a.x, b.y - a.y);
        let length = ((dx * dx + dy * dy) as f64).sqrt();
        if length == 0.0 { f64::INFINITY } else { (dx * (y - a.y) - dy * (x - a.x)) as f64 / length }
    };
    let least = edge(&t[0], &t[1]) * turned;
    least.min(edge(&t[1], &t[2]) * turned).min(edge(&t[2], &t[0]) * turned) / UNIT as f64
}
