//! The exact answer, slow and sharing no code with the library.
//!
//! Triangles are in screen space: x and y in 1/256 pixel, y in the direction in which rows are counted (row 0 first),
//! and z = 1/w. Coverage is decided in 64-bit integers: a triangle covers the rows whose centre is at or after its least
//! y and strictly before its greatest; in a row, it covers the pixels from the first one whose centre is on or to the
//! right of the left edge to the last one strictly left of the right edge.
#![allow(dead_code, reason = "every test uses a part of it")]

pub mod bounds;
pub mod homogeneous;
pub mod snap;

/// Subpixel units per pixel.
pub const UNIT: i64 = 256;

/// A snapped vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    pub x: i64,
    pub y: i64,
    pub z: f64,
}

pub type Triangle = [Vertex; 3];

/// The first pixels of row `row` to the right of the edges of a closed polygon, in ascending order: the pixels from the
/// first up to the second are filled, those from the third up to the fourth, and so on.
pub fn crossings(polygon: &[(i64, i64)], row: i64) -> Vec<i64> {
    let centre = row * UNIT + UNIT / 2;
    let mut found = Vec::new();
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let ((xa, ya), (xb, yb)) = if a.1 <= b.1 { (a, b) } else { (b, a) };
        if ya <= centre && centre < yb {
            // The least p with p * 256 + 128 >= xa + (xb - xa) * (centre - ya) / (yb - ya).
            let n = (xa - UNIT / 2) * (yb - ya) + (xb - xa) * (centre - ya);
            found.push(-(-n).div_euclid(UNIT * (yb - ya)));
        }
    }
    found.sort_unstable();
    found
}

/// The columns of `row`, on a screen `width` pixels wide, whose centres the triangle covers.
pub fn span(triangle: &Triangle, row: usize, width: usize) -> std::ops::Range<usize> {
    let corners = triangle.map(|v| (v.x, v.y));
    match crossings(&corners, row as i64)[..] {
        [left, right] => {
            let clamp = |p: i64| p.clamp(0, width as i64) as usize;
            clamp(left)..clamp(right)
        }
        _ => 0..0,
    }
}

/// Twice the area, in square units; positive if the corners run clockwise on a screen whose rows go down.
pub fn area(t: &Triangle) -> i64 {
    (t[1].x - t[0].x) * (t[2].y - t[0].y) - (t[2].x - t[0].x) * (t[1].y - t[0].y)
}

/// 1/w of the triangle's plane at a point given in units. Within the triangle nothing cancels, and the error is a few
/// parts in 10^16 at most.
pub fn depth_at(t: &Triangle, x: i64, y: i64) -> f64 {
    let edge = |a: &Vertex, b: &Vertex| (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
    let (e0, e1, e2) = (edge(&t[1], &t[2]), edge(&t[2], &t[0]), edge(&t[0], &t[1]));
    (e0 as f64 * t[0].z + e1 as f64 * t[1].z + e2 as f64 * t[2].z) / area(t) as f64
}

/// 1/w at the centre of a pixel.
pub fn depth_at_pixel(t: &Triangle, column: usize, row: usize) -> f64 {
    depth_at(t, column as i64 * UNIT + UNIT / 2, row as i64 * UNIT + UNIT / 2)
}

/// The least depth that a useful buffer stores for a pixel that only this triangle covers: the plane's least value over
/// the pixel's 8x4 block, but no farther than the triangle's farthest vertex. For thin triangles, whose planes are
/// ill-conditioned, just that vertex.
pub fn useful_depth(t: &Triangle, column: usize, row: usize) -> f64 {
    let farthest = t.iter().fold(f64::MAX, |m, v| m.min(v.z));
    let nearest = t.iter().fold(0.0, |m: f64, v| m.max(v.z));
    let side = |a: &Vertex, b: &Vertex| ((b.x - a.x) as f64).hypot((b.y - a.y) as f64);
    let longest = side(&t[0], &t[1]).max(side(&t[1], &t[2])).max(side(&t[2], &t[0]));
    let height = area(t).abs() as f64 / longest;
    if height < (2 * UNIT) as f64 {
        return farthest * 0.999;
    }
    // Single precision represents the plane of a long triangle less accurately.
    let slack = nearest * (0.001 + 1e-5 * longest / height);
    let (x, y) = (column as i64 / 8 * 8 * UNIT, row as i64 / 4 * 4 * UNIT);
    let corners = [(x, y), (x + 8 * UNIT, y), (x, y + 4 * UNIT), (x + 8 * UNIT, y + 4 * UNIT)];
    let block = corners.iter().fold(f64::MAX, |m, &(x, y)| m.min(depth_at(t, x, y)));
    (block.max(farthest) - slack).max(farthest * 0.999)
}

/// An exact depth buffer: the nearest depth of everything drawn, in any order.
#[derive(Clone)]
pub struct Oracle {
    pub width: usize,
    pub height: usize,
    /// 1/w at the pixel centre, row by row; -1 where nothing was drawn.
    pub depth: Vec<f64>,
}

impl Oracle {
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height, depth: vec![-1.0; width * height] }
    }

    pub fn clear(&mut self) {
        self.depth.fill(-1.0);
    }

    /// The rows that a triangle may reach.
    pub fn rows(&self, t: &Triangle) -> std::ops::Range<usize> {
        let (low, high) = t.iter().fold((i64::MAX, i64::MIN), |(a, b), v| (a.min(v.y), b.max(v.y)));
        let clamp = |y: i64| (y.div_euclid(UNIT)).clamp(0, self.height as i64) as usize;
        clamp(low)..clamp(high + UNIT)
    }

    pub fn draw(&mut self, t: &Triangle) {
        for row in self.rows(t) {
            for column in span(t, row, self.width) {
                let depth = depth_at_pixel(t, column, row);
                let pixel = &mut self.depth[row * self.width + column];
                *pixel = pixel.max(depth);
            }
        }
    }

    pub fn merge(&mut self, other: &Oracle) {
        for (mine, theirs) in self.depth.iter_mut().zip(&other.depth) {
            *mine = mine.max(*theirs);
        }
    }

    /// Would the triangle be visible at a pixel centre that it covers? Equal depth is visible.
    pub fn shows(&self, t: &Triangle) -> bool {
        self.rows(t)
            .any(|row| span(t, row, self.width).any(|c| depth_at_pixel(t, c, row) >= self.depth[row * self.width + c]))
    }

    /// Would a point inside the triangle, given by weights that sum to 16, be visible in the pixel that contains it?
    pub fn shows_at(&self, t: &Triangle, weights: [i64; 3]) -> bool {
        let mix = |v: [i64; 3]| (0..3).map(|i| v[i] * weights[i]).sum::<i64>().div_euclid(16 * UNIT);
        let (column, row) = (mix(t.map(|v| v.x)), mix(t.map(|v| v.y)));
        if !(0..self.width as i64).contains(&column) || !(0..self.height as i64).contains(&row) {
            return false;
        }
        let depth = (0..3).map(|i| t[i].z * weights[i] as f64).sum::<f64>() / 16.0;
        depth >= self.depth[row as usize * self.width + column as usize]
    }

    /// Would a rectangle at `depth`, given in pixels, be visible in one of the pixels that it overlaps by more than the
    /// rounding error?
    pub fn rectangle_shows(&self, x: (f64, f64), y: (f64, f64), depth: f64) -> bool {
        let slack = 1e-3;
        let pixels = |(low, high): (f64, f64), size: usize| {
            let first = (low + slack).floor().clamp(0.0, size as f64) as usize;
            let last = (high - slack).ceil().clamp(0.0, size as f64) as usize;
            first..last
        };
        pixels(y, self.height).any(|row| pixels(x, self.width).any(|c| depth >= self.depth[row * self.width + c]))
    }
}
