//! From clip space to pixels: the grid that vertices are snapped to, and the guard band.

use super::lanes::Lanes;

/// The screen of a buffer.
#[derive(Clone, Copy)]
pub struct Screen {
    /// Vertices are on a grid of 1/2^bits pixel.
    pub bits: u32,
    /// Half the size, in steps of the grid.
    pub half: [f32; 2],
    pub size: [i32; 2],
    /// Guard band: how far beyond the screen's edges vertices may be before a triangle is clipped, in steps of the
    /// grid.
    pub guard: f32,
    /// The near plane, in w.
    pub near: f32,
}

impl Screen {
    /// Picks the finest grid, at most 1/256 pixel, on which edge functions at pixels fit in 32 bits with a guard band of at
    /// least 256 pixels.
    pub fn new(width: u32, height: u32) -> Self {
        assert!((1..=8192).contains(&width) && (1..=8192).contains(&height), "{width}x{height} pixels");
        let fits = |guard: u32, bits: u32| {
            let across = |size: u32| u64::from(size.next_multiple_of(8) + 2 * guard);
            // Twice the area of a triangle of two vertices and a pixel is at most that of the box around them.
            (across(width) * across(height)) << bits < 1 << 31
        };
        let bits = (1..=8).rev().find(|&bits| fits(256, bits)).unwrap_or(1);
        let guard = (256..=4096).step_by(16).take_while(|&guard| fits(guard, bits)).last().unwrap_or(256);
        let unit = (1 << bits) as f32;
        Self {
            bits,
            size: [width as i32, height as i32],
            half: [width as f32 * 0.5 * unit, height as f32 * 0.5 * unit],
            guard: guard as f32 * unit,
            near: 0.0,
        }
    }

    /// The minimum and maximum grid coordinate that needs no clipping.
    pub fn range(&self, axis: usize) -> (f32, f32) {
        (-self.guard, 2.0 * self.half[axis] + self.guard)
    }

    /// The size of that range as a multiple of the screen's.
    pub fn guard_factor(&self, axis: usize) -> f64 {
        1.0 + f64::from(self.guard / self.half[axis])
    }

    /// A vertex (x, y, w) on the grid, and 1/w: computed with the same operations as the vectors, so that there are no
    /// gaps between clipped triangles and others.
    pub fn project(&self, [x, y, w]: [f32; 3]) -> ([i32; 2], f32) {
        let depth = 1.0 / w;
        let on_grid = |v: f32, axis: usize| {
            let (low, high) = self.range(axis);
            (v + self.half[axis]).clamp(low, high).round_ties_even() as i32
        };
        ([on_grid(x * depth * self.half[0], 0), on_grid(y * depth * -self.half[1], 1)], depth)
    }
}

/// The first and last of `size` pixels whose centres are between the minimum and maximum of three coordinates; the last
/// is before the first if there are none. A function, because closures that are called twice are not inlined.
#[inline(always)]
pub fn pixels<L: Lanes>(s: L, bits: u32, [a, b, c]: [L::I; 3], size: i32) -> (L::I, L::I) {
    let half = (1 << bits) / 2;
    let low = s.add_i(s.min_i(a, s.min_i(b, c)), s.i(half - 1));
    let high = s.sub_i(s.max_i(a, s.max_i(b, c)), s.i(half));
    (s.max_i(s.shr(low, bits), s.i(0)), s.min_i(s.shr(high, bits), s.i(size - 1)))
}
