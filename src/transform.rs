//! Vertices to clip space, for callers that want them there.

use glam::Mat4;

use crate::Vertices;
use crate::simd::{self, Job, Simd};
use crate::vertices::VertexSource;
use crate::{Implementation, pipeline};

/// Transforms positions (x, y, z, 1) by `matrix` into packed clip-space x, y, z, w: as many as there are
/// vertices or places in `out`, whichever is less. The same bits as a draw with that matrix computes.
pub fn transform_vertices(matrix: &Mat4, vertices: Vertices<'_>, out: &mut [[f32; 4]]) {
    let count = vertices.len().min(out.len());
    // SAFETY: both slices have that many.
    unsafe { transform_raw(matrix, vertices.source(), out.as_mut_ptr().cast(), count) }
}

/// # Safety
/// `count` vertices can be read from `source`, and `out` can be written for four floats each; it may be unaligned.
pub(crate) unsafe fn transform_raw(matrix: &Mat4, source: VertexSource, out: *mut f32, count: usize) {
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
    matrix: &'a Mat4,
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
