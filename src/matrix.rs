//! The matrix type of the interface: 16 floats, from any math library.

/// A 4x4 matrix, column by column: `m` transforms (x, y, z, 1) to
/// x' = x·m\[0\] + y·m\[4\] + z·m\[8\] + m\[12\], y' with m\[1\], m\[5\], m\[9\], m\[13\], and w' with m\[3\], m\[7\],
/// m\[11\], m\[15\]. z' (m\[2\], m\[6\], m\[10\], m\[14\]) is only used by
/// [`transform_vertices`](crate::transform_vertices).
///
/// This is the memory layout of OpenGL's column-major matrices, which multiply a column vector from the left, and of
/// Direct3D's row-major ones, which multiply a row vector from the right. It can be made from arrays, and with the
/// feature `glam` (a default) from the `glam::Mat4` of the version that the crate re-exports. From another version or
/// another library pass the array:
///
/// ```
/// use masked_occlusion_culling::Matrix;
///
/// let scale = [2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0];
/// let columns = [[2.0, 0.0, 0.0, 0.0], [0.0, 2.0, 0.0, 0.0], [0.0, 0.0, 2.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
/// assert_eq!(Matrix::from(scale), Matrix::from(columns));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Matrix([f32; 16]);

impl Matrix {
    /// The 16 floats, column by column.
    pub const fn as_array(&self) -> &[f32; 16] {
        &self.0
    }
}

impl From<[f32; 16]> for Matrix {
    fn from(columns: [f32; 16]) -> Self {
        Self(columns)
    }
}

impl From<&[f32; 16]> for Matrix {
    fn from(columns: &[f32; 16]) -> Self {
        Self(*columns)
    }
}

impl From<[[f32; 4]; 4]> for Matrix {
    fn from(columns: [[f32; 4]; 4]) -> Self {
        Self(core::array::from_fn(|i| columns[i / 4][i % 4]))
    }
}

#[cfg(feature = "glam")]
impl From<glam::Mat4> for Matrix {
    fn from(matrix: glam::Mat4) -> Self {
        Self(matrix.to_cols_array())
    }
}

#[cfg(feature = "glam")]
impl From<&glam::Mat4> for Matrix {
    fn from(matrix: &glam::Mat4) -> Self {
        Self(matrix.to_cols_array())
    }
}
