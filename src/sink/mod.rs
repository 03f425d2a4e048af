//! Triangle sinks: draw into the buffer, query it, or store triangles in lists or the pool's bins.

pub(crate) mod bin;
pub(crate) mod draw;
pub(crate) mod lists;
pub(crate) mod query;
mod whole_mesh;

pub(crate) use bin::{Bin, BinBounds, BinnedTriangles};
pub(crate) use draw::Draw;
pub(crate) use lists::AppendToLists;
pub(crate) use query::Query;

use core::mem::MaybeUninit;

use crate::CullingResult;
use crate::buffer::TileRect;
use crate::geometry::{Corner, Coverage};
use crate::raster::{Batch, Setup, bits};
use crate::simd::Simd;
use crate::statistics::Tally;

/// Receives triangles, a vector at a time, in order.
pub(crate) trait TriangleSink {
    type Coverage: Coverage;
    /// Scratch memory on the stack of a call, uninitialised.
    type Memory;

    /// Whether it looks at a corner and at a whole mesh first: at what the next two functions are given.
    const LOOKS_FIRST: bool = false;

    /// Does one corner of the first triangle decide the call, so that no triangle need be set up?
    #[inline(always)]
    fn is_decided_by(&self, _corner: [f32; 3]) -> bool {
        false
    }

    /// Is a whole mesh of a few vertices hidden, so that none of its triangles need be submitted? `vertices` are all of
    /// them, as projected; `corner` is a corner of a triangle that counts.
    #[inline(always)]
    fn hides_all<S: Simd>(&mut self, _s: S, _corner: [f32; 3], _vertices: &[[f32; 4]]) -> bool {
        false
    }

    /// Processes the triangles in `active`. Returns false if no more are needed.
    fn submit<S: Simd>(
        &mut self,
        setup: Setup<'_, S>,
        corners: [Corner<S>; 3],
        active: S::M,
        memory: &mut Memory<Self::Memory>,
        tally: &mut Tally,
    ) -> bool;

    /// The answer of the call. `in_view`: some triangle is front-facing and overlaps the screen; `stopped`: not all
    /// triangles were submitted, because the sink needed no more or because one cannot be projected.
    #[inline(always)]
    fn result(&self, in_view: bool, _stopped: bool) -> CullingResult {
        if in_view { CullingResult::Visible } else { CullingResult::ViewCulled }
    }
}

/// Scratch memory of a call, uninitialised.
pub(crate) struct Memory<M> {
    pub batch: Batch,
    pub own: MaybeUninit<M>,
}

impl<M> Memory<M> {
    #[inline(always)]
    pub fn uninit() -> Self {
        Self { batch: Batch::uninit(), own: MaybeUninit::uninit() }
    }
}

/// How many of the triangles in `lanes` have the first tile of their bounds in a rectangle, so that each counts in one
/// bin only.
///
/// # Safety
/// Set-up has stored the batch.
unsafe fn begun_in(batch: &Batch, lanes: u32, clip: TileRect) -> u64 {
    let begun = |&lane: &usize| {
        // SAFETY: the caller's contract.
        let [x0, _, y0, _] = unsafe { batch.tiles(lane) };
        (clip.x0..clip.x1).contains(&x0) && (clip.y0..clip.y1).contains(&y0)
    };
    bits(lanes).filter(begun).count() as u64
}

/// How many tiles within a rectangle the bounds of the triangles in `lanes` have.
///
/// # Safety
/// Set-up has stored the batch.
unsafe fn tiles_in(batch: &Batch, lanes: u32, clip: TileRect) -> u64 {
    let mut tiles = 0;
    for lane in bits(lanes) {
        // SAFETY: the caller's contract.
        let [x0, x1, y0, y1] = unsafe { batch.tiles(lane) };
        let wide = (x1 + 1).min(clip.x1).saturating_sub(x0.max(clip.x0));
        let high = (y1 + 1).min(clip.y1).saturating_sub(y0.max(clip.y0));
        tiles += u64::from(wide) * u64::from(high);
    }
    tiles
}
