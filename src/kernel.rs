//! The path of a triangle: any source, any sink, one driver, for one instruction set.
//!
//! ```text
//! source/    mesh        vertices are read in chunks (or pages, if far apart), transformed, projected, snapped and
//!                        marked; triangles that are back-facing, outside or without a pixel centre are culled, and
//!                        the few that cross the near plane or leave the guard band are clipped
//!            list        triangles that were projected into a list
//!            binned      triangles that the pool binned
//! raster/    queue       full vectors of triangles
//!            set-up      screen bounds, HiZ, edges, depth plane
//!            traversal   tile rows, candidate tiles, coverage and depth bound of each
//! sink/      draw        update tiles by a rule
//!            query       compare tiles
//!            lists, bin  store triangles to be drawn later
//! ```
//!
//! A draw and a query differ in their sink and in their coverage (see `geometry/coverage.rs`): a draw rounds to less
//! coverage and farther depth, a query to more coverage and nearer depth.
//!
//! Everything that reaches the buffer is computed with the same operations in the same order on every instruction set,
//! sub-tile by sub-tile; how many triangles are set up together makes no difference.

#[cfg(all(test, any(target_arch = "x86", target_arch = "x86_64"), feature = "avx2", feature = "pool"))]
mod tests;

use crate::CullingResult;
use crate::bins::TriList;
use crate::buffer::{Buffer, Region};
use crate::geometry::Camera;
use crate::simd::{self, Job, Level, MAX_LANES, Simd};
use crate::sink::{AppendToLists, Bin, BinBounds, BinnedTriangles, Draw, Query, TriangleSink};
use crate::source::{self, Binned, IndexRange, Mesh, MeshTriangles, TriangleSource};
use crate::statistics::Tally;

/// Draws a mesh.
pub(crate) fn draw(level: Level, region: Region<'_>, camera: &Camera, mesh: &Mesh<'_>) -> (CullingResult, Tally) {
    let buffer = region.buffer();
    simd::run(level, Drive { buffer, source: MeshTriangles::new(mesh, camera), sink: Draw::<true>::new(region) })
}

/// Tests a mesh. The answer is only valid if nobody drew in the meantime.
pub(crate) fn test(level: Level, buffer: &Buffer, camera: &Camera, mesh: &Mesh<'_>) -> (CullingResult, Tally) {
    let job = Drive { buffer, source: MeshTriangles::new(mesh, camera), sink: Query::new(buffer) };
    // Where one or two vectors decide, narrow ones decide sooner.
    if mesh.triangles().len() <= 3 * MAX_LANES { simd::run_on_eight_lanes(level, job) } else { simd::run(level, job) }
}

/// Projects a mesh into lists, `bins.0` by `bins.1` of `bin_size` pixels. True if a list was full.
pub(crate) fn bin_to_lists(
    level: Level,
    buffer: &Buffer,
    camera: &Camera,
    mesh: &Mesh<'_>,
    lists: &mut [TriList<'_>],
    bin_size: (u32, u32),
    bins: (u32, u32),
) -> (CullingResult, Tally, bool) {
    let mut full = false;
    let sink = AppendToLists::new(lists, bin_size, bins, &mut full);
    let (result, tally) = simd::run(level, Drive { buffer, source: MeshTriangles::new(mesh, camera), sink });
    (result, tally, full)
}

/// Draws a list into a region.
pub(crate) fn draw_list(level: Level, region: Region<'_>, list: &TriList<'_>) -> Tally {
    let (buffer, tiles) = (region.buffer(), region.tiles());
    // With sixteen lanes two tiles are updated at a time, one below the other, and both must be in the region.
    let whole_blocks = tiles.y0.is_multiple_of(2) && (tiles.y1.is_multiple_of(2) || tiles.y1 == buffer.all_tiles().y1);
    let job = Drive { buffer, source: list, sink: Draw::<false>::new(region) };
    let (_, tally) = if whole_blocks { simd::run(level, job) } else { simd::run_on_eight_lanes(level, job) };
    tally
}

/// Projects a mesh and appends its potentially drawn triangles to the binned ones. `prefilter`: leaves out those that
/// the buffer already hides; meanwhile other threads may draw into it, but must not clear it.
pub(crate) fn bin(
    level: Level,
    buffer: &Buffer,
    camera: &Camera,
    mesh: &Mesh<'_>,
    (bounds, prefilter): (&BinBounds, bool),
    binned: &mut BinnedTriangles,
) -> Tally {
    let sink = Bin::new(binned, bounds, prefilter);
    simd::run(level, Drive { buffer, source: MeshTriangles::new(mesh, camera), sink }).1
}

/// Draws binned triangles, in order, into the region of a bin, which starts at a coarse cell boundary and ends at one
/// or at the buffer's edge; `bin` is the bin's index among those for which they were binned.
pub(crate) fn draw_binned<'a>(
    level: Level,
    region: Region<'_>,
    triangles: impl Iterator<Item = &'a BinnedTriangles>,
    bin: usize,
) -> Tally {
    let buffer = region.buffer();
    simd::run(level, Drive { buffer, source: Binned { triangles, bin }, sink: Draw::<true>::new(region) }).1
}

/// The largest of the indices.
pub(crate) fn max_index(level: Level, indices: &[u32]) -> Option<u32> {
    (!indices.is_empty()).then(|| simd::run(level, IndexRange(indices)).1)
}

/// Feeds all triangles of a source to a sink. By value, so that the compiler can keep it in registers.
struct Drive<'a, Q, K> {
    buffer: &'a Buffer,
    source: Q,
    sink: K,
}

impl<Q: TriangleSource, K: TriangleSink> Job for Drive<'_, Q, K> {
    type Output = (CullingResult, Tally);

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Self::Output {
        let Self { buffer, source, mut sink } = self;
        source::drive(s, buffer, source, &mut sink)
    }
}
