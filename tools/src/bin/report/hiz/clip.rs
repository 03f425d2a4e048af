//! Triangles that cross the near plane or the guard band: clipped one by one, in doubles.

use masked_occlusion_culling::BackfaceWinding;

use super::list::TriangleList;
use super::screen::Screen;

/// A triangle, and one more corner for each of five planes.
const CORNERS: usize = 8;

/// Clips a triangle, and adds the remaining triangles that may be drawn to the list.
#[cold]
#[inline(never)]
pub fn triangle(screen: &Screen, winding: BackfaceWinding, corners: [[f32; 4]; 3], list: &mut TriangleList) {
    let corners = corners.map(|[x, y, _, w]| [x, y, w]);
    if !corners.as_flattened().iter().all(|v| v.is_finite()) {
        return;
    }
    let [across, down] = [0, 1].map(|axis| screen.guard_factor(axis));
    // A point is inside a plane if the plane's dot product with (x, y, w, 1) is not negative.
    let planes = [
        [0.0, 0.0, 1.0, -f64::from(screen.near.max(f32::MIN_POSITIVE))],
        [1.0, 0.0, across, 0.0],
        [-1.0, 0.0, across, 0.0],
        [0.0, 1.0, down, 0.0],
        [0.0, -1.0, down, 0.0],
    ];
    let mut polygon = [[0.0; 3]; CORNERS];
    let mut n = 3;
    for (to, from) in polygon.iter_mut().zip(corners) {
        *to = from.map(f64::from);
    }
    for [a, b, c, d] in planes {
        let side = |[x, y, w]: [f64; 3]| a * x + b * y + c * w + d;
        let (from, count) = (polygon, n);
        n = 0;
        for i in 0..count {
            let (this, next) = (from[i], from[(i + 1) % count]);
            let (here, there) = (side(this), side(next));
            if here >= 0.0 {
                polygon[n] = this;
                n += 1;
            }
            if (here >= 0.0) != (there >= 0.0) && n < CORNERS {
                let t = here / (here - there);
                polygon[n] = [0, 1, 2].map(|k| this[k] + t * (next[k] - this[k]));
                n += 1;
            }
        }
    }
    let projected = polygon.map(|v| screen.project(v.map(|v| v as f32)));
    for i in 2..n {
        push(screen, winding, [projected[0], projected[i - 1], projected[i]], list);
    }
}

/// Adds a triangle if it is front-facing and its bounds contain a pixel centre.
fn push(screen: &Screen, winding: BackfaceWinding, corners: [([i32; 2], f32); 3], list: &mut TriangleList) {
    let [a, b, c] = corners.map(|(at, _)| at.map(i64::from));
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    let front = match winding {
        BackfaceWinding::Clockwise => area < 0,
        BackfaceWinding::CounterClockwise => area > 0,
        BackfaceWinding::None => area != 0,
    };
    let half = 1 << screen.bits >> 1;
    let holds_a_centre = |axis: usize| {
        let low = a[axis].min(b[axis]).min(c[axis]);
        let high = a[axis].max(b[axis]).max(c[axis]);
        ((low + half - 1) >> screen.bits).max(0) <= ((high - half) >> screen.bits).min(i64::from(screen.size[axis]) - 1)
    };
    if front && holds_a_centre(0) && holds_a_centre(1) {
        let [p, q, r] = corners;
        list.push(if area < 0 { [p, r, q] } else { [p, q, r] });
    }
}
