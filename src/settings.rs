//! What objects are made with, and what draws and queries can be told.

use glam::Mat4;

use crate::{Allocator, BackfaceWinding, ClipPlanes, Implementation, UpdateRule, YAxis};

/// What an object is made with; none of it changes afterwards.
#[derive(Clone, Copy)]
pub struct Settings {
    /// The highest instruction set that may be used.
    pub implementation: Implementation,
    /// How sub-tiles take in triangles.
    pub update_rule: UpdateRule,
    /// The direction in which rows are counted.
    pub y_axis: YAxis,
    /// Where the buffer's memory comes from.
    pub allocator: Allocator,
    /// Whether draws and queries are counted for [`MaskedOcclusionCulling::statistics`]: a tenth of the time of a draw. Dropped
    /// triangles are counted always.
    pub statistics: bool,
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
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DrawOptions {
    /// Takes vertices (x, y, z, 1) to clip space; without it they are clip space (x, y, w) already.
    pub model_to_clip: Option<Mat4>,
    /// Which triangles face away.
    pub winding: BackfaceWinding,
    /// Which planes the mesh may cross; see [`ClipPlanes`].
    pub clip_planes: ClipPlanes,
}

impl DrawOptions {
    /// The default options with a matrix.
    pub fn with_matrix(model_to_clip: Mat4) -> Self {
        Self { model_to_clip: Some(model_to_clip), ..Self::default() }
    }
}
