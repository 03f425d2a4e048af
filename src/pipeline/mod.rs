//! The way of a triangle, one step a file.
//!
//! ```text
//! vertices ──> project    transform, project, snap, mark: once a vertex, a chunk at a time
//!              chunk      which vertices, in what order; pages where they lie far apart
//! indices  ──> cull       reject what faces away, lies outside or holds no pixel centre; compact the rest
//!              clip       the few that cross the near plane or leave the guard band, back into the stream in order
//!          ──> setup      edges and depth plane, full vectors of survivors
//!          ──> traverse   the tiles of each: coverage, depth bound
//!          ──> last step  update (draw), compare (query), or, before the tiles, into lists (bin)
//! ```
//!
//! A draw, a query and a bin differ in the last step alone, and in which way they round: a draw to less
//! coverage and farther depth, a query to more coverage and nearer depth.
//!
//! All that reaches the buffer is computed with the same operations in the same order on every
//! instruction set, sub-tile by sub-tile; how many triangles are set up together changes nothing.

mod batch;
mod boxes;
mod chunk;
mod clip;
mod cull;
mod edges;
mod kept;
mod last_step;
mod list;
mod open_tiles;
mod pages;
mod project;
mod scratch;
mod setup;
mod strips;
mod survivors;
#[cfg(all(test, any(target_arch = "x86", target_arch = "x86_64")))]
mod tests;
mod tile_step;
mod traverse;

use crate::bins::TriList;
use crate::buffer::{Buffer, TileRect};
use crate::simd::{self, Job, Simd};
use crate::statistics::Tally;
use crate::vertices::VertexSource;
use crate::{BackfaceWinding, CullingResult, DrawOptions, Implementation, Vertices};

use kept::Keep;
pub(crate) use kept::{Cuts, Kept};
use last_step::{Bins, Draw, Query};
pub(crate) use project::{Camera, transform};

/// A call's triangles, three indices each, and how they are to be taken.
pub(crate) struct Mesh<'a> {
    pub vertices: VertexSource,
    pub triangles: &'a [u32],
    pub matrix: Option<&'a [f32; 16]>,
    pub options: &'a DrawOptions,
}

impl<'a> Mesh<'a> {
    pub fn new(vertices: &'a Vertices<'_>, triangles: &'a [u32], options: &'a DrawOptions) -> Self {
        Self { vertices: vertices.source(), triangles, matrix: vertices.matrix(), options }
    }
}

/// What a call has to know about a triangle's facing: which order of its corners runs clockwise in rows
/// counted downwards, which is the order that setup takes.
#[derive(Clone, Copy)]
struct Facing {
    /// Exchange the second and third corner of every triangle.
    swap: bool,
    /// Draw both sides: the order is found triangle by triangle.
    both: bool,
}

impl Facing {
    fn new(winding: BackfaceWinding, camera: &Camera) -> Self {
        // Counter-clockwise with y up looks the same on the screen, where rows may run downwards.
        let front_is_counter_clockwise = winding != BackfaceWinding::CounterClockwise;
        Self { swap: front_is_counter_clockwise == camera.rows_run_down(), both: winding == BackfaceWinding::None }
    }
}

/// Draws a mesh.
///
/// # Safety
/// Every vertex from the lowest to the highest that the mesh names can be read, and nobody else uses the buffer.
pub(crate) unsafe fn draw(
    implementation: Implementation,
    buffer: &Buffer,
    camera: &Camera,
    mesh: &Mesh<'_>,
) -> (CullingResult, Tally) {
    simd::run(implementation, DrawMesh { buffer, camera, mesh })
}

/// Tests a mesh.
///
/// # Safety
/// Every vertex from the lowest to the highest that the mesh names can be read, and nobody draws into the buffer.
pub(crate) unsafe fn test(
    implementation: Implementation,
    buffer: &Buffer,
    camera: &Camera,
    mesh: &Mesh<'_>,
) -> (CullingResult, Tally) {
    simd::run(implementation, TestMesh { buffer, camera, mesh })
}

/// Projects a mesh into lists, `bins.0` by `bins.1` of `bin_size` pixels. True when one was full.
///
/// # Safety
/// Every vertex from the lowest to the highest that the mesh names can be read.
pub(crate) unsafe fn bin(
    implementation: Implementation,
    buffer: &Buffer,
    camera: &Camera,
    mesh: &Mesh<'_>,
    lists: &mut [TriList<'_>],
    bin_size: (u32, u32),
    bins: (u32, u32),
) -> (CullingResult, Tally, bool) {
    assert_eq!(lists.len() as u64, u64::from(bins.0) * u64::from(bins.1));
    simd::run(implementation, BinMesh { buffer, camera, mesh, lists, bin_size, bins })
}

/// Draws a list inside of a rectangle of tiles.
///
/// # Safety
/// The list's triangles can be read, and nobody else uses the tiles of the rectangle.
pub(crate) unsafe fn draw_list(
    implementation: Implementation,
    buffer: &Buffer,
    list: &TriList<'_>,
    scissor: TileRect,
) -> Tally {
    // A vector of sixteen lanes takes two tiles, one below the other, and may not take one that is outside.
    let whole_blocks =
        scissor.y0.is_multiple_of(2) && (scissor.y1.is_multiple_of(2) || scissor.y1 == buffer.all_tiles().y1);
    let job = DrawList { buffer, list, scissor };
    if whole_blocks { simd::run(implementation, job) } else { simd::run_on_eight_lanes(implementation, job) }
}

/// Projects a mesh and keeps what may be drawn, for some pieces of the screen, after what was kept before. `sift`: without
/// what the buffer hides already; meanwhile other threads may be drawing into it by [`draw_kept`], but not clearing it.
///
/// # Safety
/// Every vertex from the lowest to the highest that the mesh names can be read.
pub(crate) unsafe fn keep(
    implementation: Implementation,
    buffer: &Buffer,
    camera: &Camera,
    mesh: &Mesh<'_>,
    (cuts, sift): (&Cuts, bool),
    kept: &mut Kept,
) -> Tally {
    simd::run(implementation, KeepMesh { buffer, camera, mesh, cuts, sift, kept })
}

/// Draws what was kept, in order, inside of a piece of the screen: a rectangle of tiles that begins with an area and ends with
/// one or at the buffer's end, and its number among the cuts that it was kept for. `drawn` counts for the rectangle when its
/// areas are due.
///
/// # Safety
/// Nobody else writes the rectangle's tiles and areas; others may read least depths as words.
pub(crate) unsafe fn draw_kept<'a>(
    implementation: Implementation,
    buffer: &Buffer,
    kept: impl Iterator<Item = &'a Kept>,
    (clip, piece): (TileRect, usize),
    drawn: &mut u32,
) -> Tally {
    simd::run(implementation, DrawKept { buffer, kept, clip, piece, drawn })
}

/// The largest of the indices.
pub(crate) fn max_index(implementation: Implementation, indices: &[u32]) -> Option<u32> {
    (!indices.is_empty()).then(|| simd::run(implementation, chunk::IndexRange(indices)).1)
}

macro_rules! mesh_job {
    ($job:ident, |$s:ident, $buffer:ident| $last:expr) => {
        struct $job<'a> {
            buffer: &'a Buffer,
            camera: &'a Camera,
            mesh: &'a Mesh<'a>,
        }

        impl Job for $job<'_> {
            type Output = (CullingResult, Tally);

            #[inline(always)]
            fn run<S: Simd>(self, $s: S) -> Self::Output {
                let $buffer = self.buffer;
                let mut last = $last;
                cull::mesh($s, $buffer, self.camera, self.mesh, &mut last)
            }
        }
    };
}

// SAFETY: the caller of `draw` vouches for the buffer.
mesh_job!(DrawMesh, |s, buffer| unsafe { Draw::new(s, buffer) });
mesh_job!(TestMesh, |s, buffer| Query::new(s, buffer));

struct BinMesh<'a, 'b, 'c> {
    buffer: &'a Buffer,
    camera: &'a Camera,
    mesh: &'a Mesh<'a>,
    lists: &'b mut [TriList<'c>],
    bin_size: (u32, u32),
    bins: (u32, u32),
}

impl Job for BinMesh<'_, '_, '_> {
    type Output = (CullingResult, Tally, bool);

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Self::Output {
        let mut last = Bins::new(self.lists, self.bin_size, self.bins);
        let (result, tally) = cull::mesh(s, self.buffer, self.camera, self.mesh, &mut last);
        (result, tally, last.full)
    }
}

struct DrawList<'a, 'b> {
    buffer: &'a Buffer,
    list: &'a TriList<'b>,
    scissor: TileRect,
}

impl Job for DrawList<'_, '_> {
    type Output = Tally;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Tally {
        let mut last = Draw::inside(s, self.buffer, self.scissor, None);
        list::draw(s, self.buffer, self.list, self.scissor, &mut last)
    }
}

struct KeepMesh<'a> {
    buffer: &'a Buffer,
    camera: &'a Camera,
    mesh: &'a Mesh<'a>,
    cuts: &'a Cuts,
    sift: bool,
    kept: &'a mut Kept,
}

impl Job for KeepMesh<'_> {
    type Output = Tally;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Tally {
        let mut last = Keep::new(self.kept, self.cuts, self.sift);
        cull::mesh(s, self.buffer, self.camera, self.mesh, &mut last).1
    }
}

struct DrawKept<'a, I> {
    buffer: &'a Buffer,
    kept: I,
    clip: TileRect,
    piece: usize,
    drawn: &'a mut u32,
}

impl<'k, I: Iterator<Item = &'k Kept>> Job for DrawKept<'_, I> {
    type Output = Tally;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Tally {
        let mut last = Draw::inside(s, self.buffer, self.clip, Some(self.drawn));
        kept::draw(s, self.buffer, self.kept, (self.clip, self.piece), &mut last)
    }
}
