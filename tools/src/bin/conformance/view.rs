//! The screen that is compared, and the viewport around it, in which a grid point stays a grid point.
//!
//! Drivers differ in how they snap a vertex between points of the subpixel grid, and the APIs do not specify it. So
//! there are no such vertices: each is a multiple of 1/256 pixel, and every step from there to the rasteriser is exact
//! in f32. The viewport is a square whose side is a power of two, at an integer position, so that
//!
//! * x / (side / 2), in normalised device coordinates, has at most 22 bits (x is within 8,192 pixels of the middle),
//! * multiplying by w, and dividing by w or multiplying by 1/w, change only the exponent, because w is a power of two,
//! * so does multiplying by side / 2, and adding the middle gives a multiple of 1/256 below 2^15, 23 bits, in whichever
//!   order a driver scales and adds, fused or not.
//!
//! The result is on the grid of 1/256, which any driver with 8 or more subpixel bits represents; with more bits, the
//! same points are on its finer grid.
//!
//! Clipping creates vertices, too, and those are not on the grid. So nothing is clipped: every vertex is inside the
//! view volume, which is the whole viewport, and the scissor rectangle, which creates no vertices, selects the screen.
//! This does not depend on the driver's guard band (llvmpipe's extends one more viewport on each side).

use masked_occlusion_culling::YAxis;

use tools::oracle::{Triangle, UNIT, Vertex};

/// The largest viewport side that is used; the exactness above depends on it.
const MOST_SIDE: u32 = 16_384;

/// For screens whose sides are not powers of two: the distance from the middle up to which the library's own projection
/// is exact enough to snap to the intended grid point; see `tests/support`.
const ROUNDED_REACH: i64 = 4_095 * UNIT;

/// A screen and the viewport around it.
#[derive(Clone, Copy, Debug)]
pub struct View {
    pub width: usize,
    pub height: usize,
    /// The viewport's side in pixels, a power of two.
    pub side: u32,
}

impl View {
    /// A screen for a driver whose viewports have sides of at most `most` pixels.
    pub fn new((width, height): (u32, u32), most: u32) -> Result<Self, String> {
        let side = MOST_SIDE.min(if most == 0 { 0 } else { 1 << most.ilog2() });
        if width.max(height) > side {
            return Err(format!("a screen of {width}x{height} does not fit into this driver's viewport of {side}"));
        }
        Ok(Self { width: width as usize, height: height as usize, side })
    }

    pub fn pixels(&self) -> usize {
        self.width * self.height
    }

    /// The pixel corner in the viewport's middle.
    fn middle(&self) -> (i64, i64) {
        (self.width as i64 / 2, self.height as i64 / 2)
    }

    /// The viewport's minimum corner in pixels, as drivers take it.
    pub fn corner(&self) -> (i32, i32) {
        let (x, y) = self.middle();
        let half = i64::from(self.side / 2);
        ((x - half) as i32, (y - half) as i32)
    }

    /// How far from the viewport's middle a vertex may be on either axis, in units.
    pub fn reach(&self) -> i64 {
        let whole = i64::from(self.side) * UNIT / 2;
        let powers = self.width.is_power_of_two() && self.height.is_power_of_two();
        if powers { whole } else { whole.min(ROUNDED_REACH) }
    }

    /// The viewport's middle in units.
    pub fn centre(&self) -> (i64, i64) {
        let (x, y) = self.middle();
        (x * UNIT, y * UNIT)
    }

    /// The triangle with coordinates out of range wrapped around from the other side, so that equal coordinates stay
    /// equal.
    pub fn within_reach(&self, t: &Triangle) -> Triangle {
        let (centre, reach) = (self.centre(), self.reach());
        let fold = |v: i64, c: i64| c - reach + (v - c + reach).rem_euclid(2 * reach + 1);
        t.map(|v| Vertex { x: fold(v.x, centre.0), y: fold(v.y, centre.1), z: v.z })
    }

    /// The clip-space vertex that the driver's viewport maps to `v`.
    ///
    /// Rows are counted along the window's y in both APIs: in Vulkan, as in Direct3D, both clip space and rows run
    /// down, in OpenGL up. So one formula serves both.
    pub fn driver_vertex(&self, v: &Vertex) -> [f32; 4] {
        let centre = self.centre();
        let half = (i64::from(self.side) * UNIT / 2) as f64;
        let w = 1.0 / v.z;
        [((v.x - centre.0) as f64 / half * w) as f32, ((v.y - centre.1) as f64 / half * w) as f32, 0.0, w as f32]
    }

    /// The clip-space vertex that the library maps to `v`; the library's clip space has y up whichever way rows are
    /// counted.
    pub fn our_vertex(&self, v: &Vertex, axis: YAxis) -> [f32; 4] {
        let w = 1.0 / v.z;
        let place = |v: i64, size: usize| {
            let half = (size as i64 * UNIT) as f64 / 2.0;
            (v as f64 - half) / half
        };
        let y = place(v.y, self.height);
        let y = if axis == YAxis::Up { y } else { -y };
        [(place(v.x, self.width) * w) as f32, (y * w) as f32, 0.0, w as f32]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ways in which a driver may transform a coordinate from clip space to the window, with or without rounding
    /// after every step.
    fn window(c: f32, w: f32, side: f32, corner: f32) -> [f32; 5] {
        let (half, middle) = (side / 2.0, corner + side / 2.0);
        let (divided, reciprocal) = (c / w, c * (1.0 / w));
        [
            divided * half + middle,
            reciprocal * half + middle,
            reciprocal.mul_add(half, middle),
            (reciprocal + 1.0) * half + corner,
            (divided * 0.5 + 0.5) * side + corner,
        ]
    }

    #[test]
    fn grid_points_arrive_exactly() {
        for size in [(64, 64), (1, 1), (33, 9), (1920, 1080), (16384, 32), (32, 16384)] {
            let view = View::new(size, 32768).unwrap();
            let (centre, reach, corner) = (view.centre(), view.reach(), view.corner());
            let mut random = fastrand::Rng::with_seed(1);
            for i in 0..20_000 {
                let mut offset = || if i < 4 { reach * (i % 2 * 2 - 1) } else { random.i64(-reach..=reach) };
                let (x, y) = (centre.0 + offset(), centre.1 + offset());
                let v = Vertex { x, y, z: 0.5f64.powi(random.i32(0..=6)) };
                let [cx, cy, _, w] = view.driver_vertex(&v);
                assert!(cx.abs() <= w && cy.abs() <= w, "{v:?} would be clipped");
                let side = view.side as f32;
                for (c, corner, wanted) in [(cx, corner.0, x), (cy, corner.1, y)] {
                    for at in window(c, w, side, corner as f32) {
                        assert_eq!(f64::from(at) * UNIT as f64, wanted as f64, "{size:?} {v:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_out_of_reach_comes_in() {
        let view = View::new((64, 64), 16384).unwrap();
        let far = [(9000, 32), (-9000, 32), (100, -8160)].map(|(x, y)| Vertex { x: x * UNIT, y: y * UNIT, z: 1.0 });
        let near = view.within_reach(&far);
        // From end to end it is 16,384 pixels and one unit.
        assert_eq!(near.map(|v| v.x), [(9000 - 16384) * UNIT - 1, (16384 - 9000) * UNIT + 1, 100 * UNIT]);
        assert_eq!(near.map(|v| v.y), far.map(|v| v.y));
    }
}
