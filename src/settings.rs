//! Settings of objects, and options of draws and queries.

use crate::{Allocator, BackfaceWinding, ClipPlanes, Implementation, UpdateRule, YAxis};

/// Settings of an object, fixed at creation.
///
/// ```
/// use masked_occlusion_culling::{Settings, UpdateRule, YAxis};
///
/// let settings = Settings::default().with_update_rule(UpdateRule::Quick).with_y_axis(YAxis::Up);
/// assert!(!settings.statistics);
/// ```
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct Settings {
    /// The best instruction set that may be used.
    pub implementation: Implementation,
    /// The update rule of the sub-tiles.
    pub update_rule: UpdateRule,
    /// The direction in which rows are counted.
    pub y_axis: YAxis,
    /// Where the buffer's memory comes from.
    pub allocator: Allocator,
    /// Whether draws and queries are counted for
    /// [`MaskedOcclusionCulling::statistics`](crate::MaskedOcclusionCulling::statistics), which makes draws measurably
    /// slower. Dropped triangles are always counted.
    pub statistics: bool,
}

impl Settings {
    /// These settings with another limit on the instruction set.
    pub const fn with_implementation(self, implementation: Implementation) -> Self {
        Self { implementation, ..self }
    }

    /// These settings with another update rule.
    pub const fn with_update_rule(self, update_rule: UpdateRule) -> Self {
        Self { update_rule, ..self }
    }

    /// These settings with another row direction.
    pub const fn with_y_axis(self, y_axis: YAxis) -> Self {
        Self { y_axis, ..self }
    }

    /// These settings with another allocator.
    pub const fn with_allocator(self, allocator: Allocator) -> Self {
        Self { allocator, ..self }
    }

    /// These settings with statistics enabled or disabled.
    pub const fn with_statistics(self, statistics: bool) -> Self {
        Self { statistics, ..self }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            implementation: Implementation::Avx512,
            update_rule: UpdateRule::default(),
            y_axis: YAxis::default(),
            allocator: Allocator::SYSTEM,
            statistics: false,
        }
    }
}

/// How a mesh is drawn, tested or binned.
///
/// ```
/// use masked_occlusion_culling::{BackfaceWinding, DrawOptions};
///
/// let both_sides = DrawOptions::new().with_winding(BackfaceWinding::None);
/// assert_ne!(both_sides, DrawOptions::default());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub struct DrawOptions {
    /// Which triangles are back-facing.
    pub winding: BackfaceWinding,
    /// Which planes the mesh may cross; see [`ClipPlanes`].
    pub clip_planes: ClipPlanes,
}

impl DrawOptions {
    /// The default: clockwise triangles are back-facing, and all planes may be crossed.
    pub const fn new() -> Self {
        Self { winding: BackfaceWinding::Clockwise, clip_planes: ClipPlanes::ALL }
    }

    /// These options with another back-facing winding.
    pub const fn with_winding(self, winding: BackfaceWinding) -> Self {
        Self { winding, ..self }
    }

    /// These options with other clip planes.
    pub const fn with_clip_planes(self, clip_planes: ClipPlanes) -> Self {
        Self { clip_planes, ..self }
    }
}
