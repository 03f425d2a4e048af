//! The recorder of a library that is compiled without one: it never records.

use crate::CullingResult;
use crate::source::Mesh;

#[derive(Default)]
pub(crate) struct Recorder(());

impl Recorder {
    pub fn is_on(&self) -> bool {
        false
    }

    pub fn changed(&self, _near: f32, _size: Option<(u32, u32)>) {}

    pub fn clear_buffer(&self) {}

    pub fn test_rect(&self, _result: Option<CullingResult>, _edges: [f32; 4], _w_min: f32) {}

    pub fn render_triangles(&self, _result: Option<CullingResult>, _mesh: &Mesh<'_>) {}

    pub fn test_triangles(&self, _result: Option<CullingResult>, _mesh: &Mesh<'_>) {}
}
