//! stub
use crate::Vertices;
/// Transforms (x, y, z, 1) by `matrix` into packed clip-space x, y, z, w; as many as fit in `out`.
pub fn transform_vertices(_matrix: &glam::Mat4, _vertices: Vertices<'_>, _out: &mut [[f32; 4]]) {}
