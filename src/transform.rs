//! Transforms vertices to clip space, for callers that need them there.

use crate::geometry::project::dot;
use crate::simd::{self, Job, Level, MAX_LANES, Simd};
use crate::source::VertexReader;
use crate::vertices::{VertexSource, vertex_count};
use crate::{Error, Matrix, ModelSpaceLayout};

/// Transforms positions (x, y, z, 1), stored in `data` according to `layout`, by `matrix` into packed clip-space x, y,
/// z, w: as many as there are positions in `data` or elements in `out`, whichever is less. The bits are those that a
/// draw with that matrix computes.
///
/// # Errors
/// [`Error::InvalidLayout`] if the stride or an offset is negative: nothing is written.
pub fn transform_vertices(
    matrix: impl Into<Matrix>,
    data: &[f32],
    layout: ModelSpaceLayout,
    out: &mut [[f32; 4]],
) -> Result<(), Error> {
    let layout = layout.into();
    let count = vertex_count(size_of_val(data), layout)?.min(out.len());
    let source = VertexSource { base: data.as_ptr().cast(), layout };
    // SAFETY: both slices have that many elements.
    unsafe { transform_raw(matrix.into().as_array(), source, out.as_mut_ptr().cast(), count) };
    Ok(())
}

/// # Safety
/// `count` vertices can be read from `source`, and `out` can be written for four floats each; it may be unaligned.
pub(crate) unsafe fn transform_raw(matrix: &[f32; 16], source: VertexSource, out: *mut f32, count: usize) {
    // In parts whose vertex numbers fit in 32 bits, as the indices of a mesh do.
    const PART: usize = 1 << 30;
    let mut done = 0;
    while done < count {
        let part = PART.min(count - done);
        let base = source.base.wrapping_add(done * source.layout.stride as usize);
        let source = VertexSource { base, ..source };
        simd::run(Level::best(), Transform { matrix, source, out: out.wrapping_add(4 * done), count: part });
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
        // SAFETY: the creator of the job guarantees that both arrays are valid.
        unsafe { transform(s, self.matrix, self.source, self.out, self.count) }
    }
}

/// (x, y, z, 1) times a matrix, for `count` vertices, as packed x, y, z, w.
///
/// # Safety
/// The vertices can be read and `out` can be written for four floats each; either may be unaligned.
#[inline(always)]
unsafe fn transform<S: Simd>(s: S, m: &[f32; 16], source: VertexSource, out: *mut f32, count: usize) {
    let row = |r: usize| [s.f(m[r]), s.f(m[4 + r]), s.f(m[8 + r]), s.f(m[12 + r])];
    let rows = [row(0), row(1), row(2), row(3)];
    let reader = VertexReader::new(s, source, None);
    let mut first = 0;
    while first < count {
        let n = S::LANES.min(count - first);
        // SAFETY: the caller's contract.
        let [x, y, z] = unsafe {
            if n == S::LANES {
                reader.load(first as u32, first + n < count)
            } else {
                let last = count - 1;
                let indices: [u32; MAX_LANES] = core::array::from_fn(|lane| (first + lane).min(last) as u32);
                let v = reader.load_each(indices);
                [s.load_f(v[0].as_ptr()), s.load_f(v[1].as_ptr()), s.load_f(v[2].as_ptr())]
            }
        };
        let mut lanes = [[0.0_f32; MAX_LANES]; 4];
        for (lane, row) in lanes.iter_mut().zip(&rows) {
            // SAFETY: sixteen floats hold a vector.
            unsafe { s.store_f(lane.as_mut_ptr(), dot(s, row, x, y, z)) };
        }
        for k in 0..n {
            let vertex = [lanes[0][k], lanes[1][k], lanes[2][k], lanes[3][k]];
            // SAFETY: the caller's contract.
            unsafe { out.add(4 * (first + k)).cast::<[f32; 4]>().write_unaligned(vertex) };
        }
        first += n;
    }
}
