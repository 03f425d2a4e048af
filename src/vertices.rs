//! Where vertices come from: a slice that says how many there are, or a bare pointer that does not.

use crate::{Error, VertexLayout};

/// A borrowed array of vertices: the only form in which safe code can hand them over.
#[derive(Clone, Copy)]
pub struct Vertices<'a> {
    data: &'a [f32],
    layout: VertexLayout,
    count: usize,
}

impl<'a> Vertices<'a> {
    /// Vertices that lie in `data` as `layout` says; as many as fit.
    ///
    /// # Errors
    /// [`Error::InvalidLayout`] where the stride or an offset is negative.
    pub fn new(data: &'a [f32], layout: VertexLayout) -> Result<Self, Error> {
        let count = vertex_count(size_of_val(data), layout)?;
        Ok(Self { data, layout, count })
    }

    /// Clip-space vertices `x, y, z, w`; z is ignored.
    pub fn from_clip_space(vertices: &'a [[f32; 4]]) -> Self {
        Self { data: vertices.as_flattened(), layout: VertexLayout::CLIP_SPACE, count: vertices.len() }
    }

    /// Model-space positions, to be drawn with a matrix.
    pub fn from_positions(positions: &'a [[f32; 3]]) -> Self {
        Self { data: positions.as_flattened(), layout: VertexLayout::POSITIONS, count: positions.len() }
    }

    /// How many vertices there are: every index must be below.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Are there none?
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    pub(crate) fn source(&self) -> VertexSource {
        VertexSource { base: self.data.as_ptr().cast(), layout: self.layout }
    }
}

/// How many vertices of `layout` lie whole within `bytes`.
pub(crate) fn vertex_count(bytes: usize, layout: VertexLayout) -> Result<usize, Error> {
    let VertexLayout { stride, offset_y, offset_zw } = layout;
    if stride < 0 || offset_y < 0 || offset_zw < 0 {
        return Err(Error::InvalidLayout);
    }
    let first = offset_y.max(offset_zw) as usize + size_of::<f32>();
    Ok(match (bytes.checked_sub(first), stride as usize) {
        (None, _) => 0,
        (Some(_), 0) => 1,
        (Some(rest), stride) => 1 + rest / stride,
    })
}

/// The pointer form that the kernel reads. Whoever makes one vouches that every vertex that an
/// index names can be read at `base + index * stride`, `+ offset_y` and `+ offset_zw`.
#[derive(Clone, Copy)]
pub(crate) struct VertexSource {
    pub base: *const u8,
    pub layout: VertexLayout,
}
