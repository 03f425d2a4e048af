//! Vertices to clip space, for callers that want them there.

use crate::simd::{self, Job, Simd};
use crate::vertices::{VertexSource, vertex_count};
use crate::{Error, Implementation, Matrix, ModelSpaceLayout, pipeline};

/// Transforms the positions (x, y, z, 1) that lie in `data` as `layout` says by `matrix` into packed clip-space x, y, z, w: as many
/// as there are positions or places in `out`, whichever is less. The same bits as a draw with that matrix computes.
///
/// # Errors
/// [`Error::InvalidLayout`] where the stride or an offset is negative: nothing is written.
pub fn transform_vertices(
    matrix: impl Into<Matrix>,
    data: &[f32],
    layout: ModelSpaceLayout,
    out: &mut [[f32; 4]],
) -> Result<(), Error> {
    let layout = layout.into();
    let count = vertex_count(size_of_val(data), layout)?.min(out.len());
    let source = VertexSource { base: data.as_ptr().cast(), layout };
    // SAFETY: both slices have that many.
    unsafe { transform_raw(matrix.into().as_array(), source, out.as_mut_ptr().cast(), count) };
    Ok(())
}

/// # Safety
/// `count` vertices can be read from `source`, and `out` can be written for four floats each; it may be unaligned.
pub(crate) unsafe fn transform_raw(matrix: &[f32; 16], source: VertexSource, out: *mut f32, count: usize) {
    let best = *Implementation::available().last().unwrap_or(&Implementation::Scalar);
    // In parts whose vertices have numbers of 32 bits, as those that a mesh names.
    const PART: usize = 1 << 30;
    let mut done = 0;
    while done < count {
        let part = PART.min(count - done);
        let base = source.base.wrapping_add(done * source.layout.stride as usize);
        let source = VertexSource { base, ..source };
        simd::run(best, Transform { matrix, source, out: out.wrapping_add(4 * done), count: part });
        done += part;
    }
}

struct Transform<'a> {
    matrix: &'a [f32; 16],
    source: VertexSource,
    out: *mut f32,
    count: usize,
}

impl Job for Transform<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        // SAFETY: whoever made the job vouched for both arrays.
        unsafe { pipeline::transform(s, self.matrix, self.source, self.out, self.count) }
    }
}
