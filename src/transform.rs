//! stub
use crate::Vertices;
/// Transforms (x, y, z, 1) by `matrix` into packed clip-space x, y, z, w; as many as fit in `out`.
pub fn transform_vertices(_matrix: &glam::Mat4, _vertices: Vertices<'_>, _out: &mut [[f32; 4]]) {}
/// # Safety
/// `count` vertices can be read through `source`, and `out` can be written for 4 floats each.
pub(crate) unsafe fn transform_raw(
    matrix: &[f32; 16],
    source: crate::vertices::VertexSource,
    out: *mut f32,
    count: usize,
) {
    for i in 0..count {
        // SAFETY: the caller's contract.
        unsafe {
            let v = source.base.offset(i as isize * source.layout.stride as isize);
            let x = v.cast::<f32>().read_unaligned();
            let y = v.offset(source.layout.offset_y as isize).cast::<f32>().read_unaligned();
            let z = v.offset(source.layout.offset_zw as isize).cast::<f32>().read_unaligned();
            for c in 0..4 {
                let value = x * matrix[c] + y * matrix[4 + c] + z * matrix[8 + c] + matrix[12 + c];
                out.add(4 * i + c).write_unaligned(value);
            }
        }
    }
}
