//! stub
use crate::{bins::TriList, buffer::Buffer, statistics::Tally, vertices::VertexSource, CullingResult, DrawOptions, Implementation, YAxis};
pub struct Camera;
impl Camera { pub fn new(_: u32, _: u32, _: YAxis, _: f32) -> Self { Self } }
#[allow(dead_code)]
pub struct Mesh<'a> { pub vertices: VertexSource, pub triangles: &'a [u32], pub options: &'a DrawOptions }
pub unsafe fn draw(_: Implementation, _: &Buffer, _: &Camera, _: &Mesh) -> (CullingResult, Tally) { (CullingResult::Visible, Tally::default()) }
pub unsafe fn test(_: Implementation, _: &Buffer, _: &Camera, _: &Mesh) -> (CullingResult, Tally) { (CullingResult::Visible, Tally::default()) }
pub unsafe fn bin(_: Implementation, _: &Buffer, _: &Camera, _: &Mesh, _: &mut [TriList<'_>], _: (u32, u32), _: (u32, u32)) -> (CullingResult, Tally, bool) { (CullingResult::Visible, Tally::default(), false) }
pub unsafe fn draw_list(_: Implementation, _: &Buffer, _: &TriList<'_>, _: [u32; 4]) -> Tally { Tally::default() }
pub fn max_index(_: Implementation, triangles: &[u32]) -> Option<u32> { triangles.iter().copied().max() }
