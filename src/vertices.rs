//! Vertex inputs: a slice, which knows its length, or a bare pointer, which does not.

use crate::{Error, Matrix, VertexLayout};

/// Where x, y and w of clip-space vertices are stored, in bytes.
///
/// Packed `x, y, z, w` is [`Self::XYZW`], packed `x, y, w` is [`Self::XYW`], and arrays of `n` x, `n` y and `n` w, one
/// after the other, are `ClipSpaceLayout::new(4, 4 * n, 8 * n)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ClipSpaceLayout {
    /// Bytes from one vertex to the next; not negative.
    pub stride: i32,
    /// Bytes from x to y.
    pub offset_y: i32,
    /// Bytes from x to w.
    pub offset_w: i32,
}

impl ClipSpaceLayout {
    /// Packed `x, y, z, w`, 16 bytes per vertex. z is not read.
    pub const XYZW: Self = Self::new(16, 4, 12);
    /// Packed `x, y, w`, 12 bytes per vertex.
    pub const XYW: Self = Self::new(12, 4, 8);

    /// A layout from its stride and offsets in bytes.
    pub const fn new(stride: i32, offset_y: i32, offset_w: i32) -> Self {
        Self { stride, offset_y, offset_w }
    }
}

/// Where x, y and z of model-space vertices are stored, in bytes.
///
/// Packed `x, y, z` is [`Self::XYZ`]; positions at the start of a larger vertex are `ModelSpaceLayout::new(stride, 4,
/// 8)`; arrays of `n` x, `n` y and `n` z, one after the other, are `ModelSpaceLayout::new(4, 4 * n, 8 * n)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ModelSpaceLayout {
    /// Bytes from one vertex to the next; not negative.
    pub stride: i32,
    /// Bytes from x to y.
    pub offset_y: i32,
    /// Bytes from x to z.
    pub offset_z: i32,
}

impl ModelSpaceLayout {
    /// Packed `x, y, z`, 12 bytes per vertex.
    pub const XYZ: Self = Self::new(12, 4, 8);
    /// `x, y, z` and a fourth float that is not read, 16 bytes per vertex.
    pub const XYZ_PADDED: Self = Self::new(16, 4, 8);

    /// A layout from its stride and offsets in bytes.
    pub const fn new(stride: i32, offset_y: i32, offset_z: i32) -> Self {
        Self { stride, offset_y, offset_z }
    }

    /// Vertices of this layout, transformed to clip space by `model_to_clip`.
    pub fn with_matrix(self, model_to_clip: impl Into<Matrix>) -> VertexSpace {
        VertexSpace::Model(self, model_to_clip.into())
    }
}

/// The space that vertices are in, and with it how they are read.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum VertexSpace {
    /// x, y, w in clip space.
    Clip(ClipSpaceLayout),
    /// x, y, z in model space, and the matrix that transforms (x, y, z, 1) to clip space.
    Model(ModelSpaceLayout, Matrix),
}

impl From<ClipSpaceLayout> for VertexSpace {
    fn from(layout: ClipSpaceLayout) -> Self {
        Self::Clip(layout)
    }
}

impl VertexSpace {
    /// From the form used by C, recordings and the kernel.
    pub(crate) fn from_parts(layout: VertexLayout, model_to_clip: Option<Matrix>) -> Self {
        let VertexLayout { stride, offset_y, offset_zw } = layout;
        match model_to_clip {
            None => Self::Clip(ClipSpaceLayout::new(stride, offset_y, offset_zw)),
            Some(matrix) => Self::Model(ModelSpaceLayout::new(stride, offset_y, offset_zw), matrix),
        }
    }

    pub(crate) fn layout(&self) -> VertexLayout {
        match *self {
            Self::Clip(ClipSpaceLayout { stride, offset_y, offset_w }) => VertexLayout::new(stride, offset_y, offset_w),
            Self::Model(layout, _) => layout.into(),
        }
    }

    pub(crate) fn matrix(&self) -> Option<&Matrix> {
        match self {
            Self::Clip(_) => None,
            Self::Model(_, matrix) => Some(matrix),
        }
    }
}

impl From<ModelSpaceLayout> for VertexLayout {
    fn from(ModelSpaceLayout { stride, offset_y, offset_z }: ModelSpaceLayout) -> Self {
        Self::new(stride, offset_y, offset_z)
    }
}

/// A borrowed array of vertices, in clip space or in model space with their matrix.
///
/// ```
/// use masked_occlusion_culling::{ClipSpaceLayout, ModelSpaceLayout, Vertices};
///
/// let clip = [[-10.0, -10.0, 0.0, 10.0], [30.0, -10.0, 0.0, 10.0], [-10.0, 30.0, 0.0, 10.0]];
/// assert_eq!(Vertices::clip_space(&clip).len(), 3);
///
/// let identity = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
/// let positions = [[0.0, 0.0, 5.0], [1.0, 0.0, 5.0], [0.0, 1.0, 5.0]];
/// assert_eq!(Vertices::model_space(&positions, identity).len(), 3);
///
/// // Two vertices of a position and two texture coordinates each.
/// let mesh = [0.0, 0.0, 5.0, 0.5, 0.5, 1.0, 0.0, 5.0, 1.0, 0.5];
/// let layout = ModelSpaceLayout::new(20, 4, 8);
/// assert_eq!(Vertices::new(&mesh, layout.with_matrix(identity))?.len(), 2);
/// # Ok::<(), masked_occlusion_culling::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Vertices<'a> {
    data: &'a [f32],
    space: VertexSpace,
    count: usize,
}

impl<'a> Vertices<'a> {
    /// Vertices stored in `data` according to `space`; as many as fit. A [`ClipSpaceLayout`] is itself a space, and
    /// [`ModelSpaceLayout::with_matrix`] makes one from a layout and a matrix.
    ///
    /// # Errors
    /// [`Error::InvalidLayout`] if the stride or an offset is negative.
    pub fn new(data: &'a [f32], space: impl Into<VertexSpace>) -> Result<Self, Error> {
        let space = space.into();
        let count = vertex_count(size_of_val(data), space.layout())?;
        Ok(Self { data, space, count })
    }

    /// Clip-space vertices `x, y, z, w`; z is not read.
    pub fn clip_space(vertices: &'a [[f32; 4]]) -> Self {
        let space = VertexSpace::Clip(ClipSpaceLayout::XYZW);
        Self { data: vertices.as_flattened(), space, count: vertices.len() }
    }

    /// Model-space positions `x, y, z` and the matrix that transforms (x, y, z, 1) to clip space.
    pub fn model_space(positions: &'a [[f32; 3]], model_to_clip: impl Into<Matrix>) -> Self {
        let space = ModelSpaceLayout::XYZ.with_matrix(model_to_clip);
        Self { data: positions.as_flattened(), space, count: positions.len() }
    }

    /// The number of vertices: every index must be less.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Are there no vertices?
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// The space that they are in.
    pub fn space(&self) -> VertexSpace {
        self.space
    }

    pub(crate) fn source(&self) -> VertexSource {
        VertexSource { base: self.data.as_ptr().cast(), layout: self.space.layout() }
    }

    pub(crate) fn matrix(&self) -> Option<&[f32; 16]> {
        self.space.matrix().map(Matrix::as_array)
    }
}

/// How many vertices of `layout` fit entirely within `bytes`.
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

/// The pointer form that the kernel reads: vertex `i` is at `base + i * stride`. `Mesh::new` states what must be
/// readable.
#[derive(Clone, Copy)]
pub(crate) struct VertexSource {
    pub base: *const u8,
    pub layout: VertexLayout,
}
