//! Transforming vertices to clip space.

use super::pointers::{check_length, read};
use super::refusal::Refusal;
use super::status::{MOC_Status, guard};
use super::types::MOC_VertexLayout;
use crate::VertexLayout;
use crate::vertices::VertexSource;

/// Transforms `n_vertices` positions (x, y, z, 1) by `matrix` (16 floats, as in MOC_RenderTriangles) and writes them to
/// `out` as packed x, y, z, w, 16 bytes per vertex: the form that draws and tests without a matrix take. Draws and
/// tests with the matrix give the same bits without a second array. No object is needed.
///
/// `vertices` points to the x of the first vertex; `layout` says where the other coordinates are (null: packed x, y, z,
/// 12 bytes per vertex); its last offset is that of z. No alignment is required.
///
/// Errors: MOC_STATUS_NULL_POINTER (`vertices` and `out` may be null if there are no vertices),
/// MOC_STATUS_INVALID_LAYOUT for a negative stride, MOC_STATUS_INVALID_SIZE for more vertices than memory can hold.
///
/// # Safety
/// `matrix` and `layout` are null or can be read, and so can `n_vertices` vertices. `out` can be written for
/// 4 * `n_vertices` floats, and does not overlap the vertices.
#[unsafe(export_name = symbol!(MOC_TransformVertices))]
pub unsafe extern "C" fn MOC_TransformVertices(
    matrix: *const f32,
    vertices: *const f32,
    out: *mut f32,
    n_vertices: u32,
    layout: *const MOC_VertexLayout,
) -> MOC_Status {
    guard(|| {
        const NO_MATRIX: Refusal = Refusal::new(MOC_Status::MOC_STATUS_NULL_POINTER, "matrix is null");
        // SAFETY: the caller's contract.
        let matrix = unsafe { read(matrix.cast::<[f32; 16]>()) }.ok_or(NO_MATRIX)?;
        // SAFETY: the caller's contract.
        let layout = unsafe { read(layout) }.map_or(VertexLayout::POSITIONS, VertexLayout::from);
        if layout.stride < 0 {
            return Err(Refusal::new(
                MOC_Status::MOC_STATUS_INVALID_LAYOUT,
                "the stride of the vertex layout is negative",
            ));
        }
        if n_vertices == 0 {
            return Ok(());
        }
        if vertices.is_null() || out.is_null() {
            return Err(Refusal::new(MOC_Status::MOC_STATUS_NULL_POINTER, "vertices or out is null"));
        }
        check_length::<[f32; 4]>(n_vertices as usize)?;
        let source = VertexSource { base: vertices.cast(), layout };
        // SAFETY: the caller's contract: this many vertices can be read and written.
        unsafe { crate::transform::transform_raw(&matrix, source, out, n_vertices as usize) };
        Ok(())
    })
}
