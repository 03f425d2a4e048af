//! stub
pub fn test(_: crate::Implementation, _: &crate::buffer::Buffer, _: crate::YAxis, _: [f32; 4], _: f32) -> (crate::CullingResult, crate::statistics::Tally) { (crate::CullingResult::Visible, Default::default()) }
