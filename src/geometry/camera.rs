//! The projection from clip space to a buffer's screen, and which winding is front-facing.

use crate::{BackfaceWinding, YAxis};

/// The nearest w that can be projected, whatever the near plane.
pub(crate) const NEAREST_W: f32 = 1.0 / (1 << 30) as f32;
/// Occluders farther than this are dropped; occludees count as visible.
pub(crate) const FARTHEST_W: f32 = (1_u64 << 40) as f32;

/// From clip space to a buffer's screen.
#[derive(Clone, Copy)]
pub(crate) struct Camera {
    /// Half the width, in 1/256 pixel.
    pub half_width: f32,
    /// Half the height, in 1/256 pixel; positive.
    pub half_height: f32,
    /// Factor from y in normalised device coordinates to rows: minus half the height if y points down.
    pub row_scale: f32,
    /// The near plane, at least [`NEAREST_W`].
    pub near: f32,
    /// How far a vertex may be from the screen's centre, in 1/256 pixel.
    pub guard_band: f32,
    /// Is the near plane closer than can be projected? Then a query must not rely on clipping removing geometry.
    pub near_is_raised: bool,
}

impl Camera {
    /// For a buffer of this size; the guard band is that of [`Exact`](super::Exact) coverage.
    pub fn new(width: u32, height: u32, y_axis: YAxis, near: f32) -> Self {
        let (half_width, half_height) = (width as f32 * 128.0, height as f32 * 128.0);
        Self {
            half_width,
            half_height,
            row_scale: if y_axis == YAxis::Down { -half_height } else { half_height },
            near: near.max(NEAREST_W),
            guard_band: <super::Exact as super::Coverage>::GUARD_BAND,
            near_is_raised: near < NEAREST_W,
        }
    }

    pub fn with_guard_band(self, guard_band: f32) -> Self {
        Self { guard_band, ..self }
    }

    pub fn rows_run_down(&self) -> bool {
        self.row_scale < 0.0
    }
}

/// Which winding is front-facing. Set-up wants corners clockwise with rows counted downwards.
#[derive(Clone, Copy)]
pub(crate) struct Facing {
    /// Swap the second and third corner of every triangle.
    pub swap: bool,
    /// Draw both sides: set-up determines the winding of each triangle.
    pub both: bool,
}

impl Facing {
    pub fn new(winding: BackfaceWinding, camera: &Camera) -> Self {
        // Counter-clockwise with y up looks the same on a screen whose rows run downwards.
        let front_is_counter_clockwise = winding != BackfaceWinding::CounterClockwise;
        Self { swap: front_is_counter_clockwise == camera.rows_run_down(), both: winding == BackfaceWinding::None }
    }
}
