//! The arguments that describe a mesh, as they come from C and as the kernel wants them.

use glam::Mat4;

use super::pointers::{read, slice};
use super::refusal::{Because, Refusal};
use super::types::{self, MOC_VertexLayout};
use crate::vertices::{VertexSource, vertex_count};
use crate::{DrawOptions, Error, MaskedOcclusionCulling, VertexLayout};

/// The arguments of a draw, a query or a binning, in C's form.
pub(super) struct MeshArguments {
    pub vertices: *const f32,
    /// How many floats there are from `vertices` on, where the caller says so.
    pub vertex_floats: Option<usize>,
    pub triangles: *const u32,
    pub n_triangles: i32,
    pub model_to_clip: *const f32,
    pub winding: i32,
    pub clip_planes: i32,
    pub layout: *const MOC_VertexLayout,
}

/// The same, checked as far as it can be.
pub(super) struct CheckedMesh<'a> {
    pub vertices: VertexSource,
    pub triangles: &'a [u32],
    pub options: DrawOptions,
}

impl MeshArguments {
    /// # Safety
    /// Each pointer is null or can be read: `triangles` for three indices a triangle, `model_to_clip` for
    /// 16 floats, and `vertices` for `vertex_floats` floats or, without that, at every vertex from the lowest
    /// to the highest index.
    pub unsafe fn check<'a>(self, moc: &MaskedOcclusionCulling) -> Result<CheckedMesh<'a>, Refusal> {
        const COUNT: Refusal =
            Refusal::new(Error::InvalidSize, "n_triangles is negative, or larger than memory can hold");
        const STRIDE: Refusal = Refusal::new(Error::InvalidLayout, "the stride of the vertex layout is negative");
        let count = usize::try_from(self.n_triangles).map_err(|_| COUNT)?;
        let indices = count.checked_mul(3).ok_or(COUNT)?;
        if count > 0 && self.vertices.is_null() {
            return Err(Refusal::new(Error::NullPointer, "vertices is null"));
        }
        // SAFETY: the caller's contract.
        let layout = unsafe { read(self.layout) }.map_or(VertexLayout::CLIP_SPACE, VertexLayout::from);
        if layout.stride < 0 {
            return Err(STRIDE);
        }
        // SAFETY: the caller's contract.
        let matrix = unsafe { read(self.model_to_clip.cast::<[f32; 16]>()) };
        let options = DrawOptions {
            model_to_clip: matrix.as_ref().map(Mat4::from_cols_array),
            winding: types::winding(self.winding)?,
            clip_planes: types::clip_planes(self.clip_planes)?,
        };
        // SAFETY: the caller's contract.
        let triangles = unsafe { slice(self.triangles, indices) }
            .because(Error::NullPointer, "triangles is null")
            .because(Error::InvalidLayout, "triangles is not aligned to 4 bytes")
            .because(Error::InvalidSize, "n_triangles is larger than memory can hold")?;
        if let Some(floats) = self.vertex_floats {
            let vertices = vertex_count(floats.saturating_mul(size_of::<f32>()), layout)
                .because(Error::InvalidLayout, "an offset of the vertex layout is negative")?;
            moc.check_indices(triangles, vertices)
                .because(Error::IndexOutOfRange, "triangles has an index whose vertex is not within vertex_floats")?;
        }
        Ok(CheckedMesh { vertices: VertexSource { base: self.vertices.cast(), layout }, triangles, options })
    }
}
