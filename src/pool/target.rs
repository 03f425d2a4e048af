//! The object that a pool draws into, divided into bins with a lock each: one thread draws in a bin, or any number of
//! threads query it.

use core::ptr::NonNull;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard};

use super::grid::Grid;
use crate::buffer::{Region, TileRect};
use crate::simd::MAX_LANES;
use crate::sink::BinnedTriangles;
use crate::source::Mesh;
use crate::vertices::VertexSource;
use crate::{CullingResult, DrawOptions, MaskedOcclusionCulling};

/// A call or a part of one, as submitted.
pub(super) struct Call {
    pub vertices: VertexSource,
    pub triangles: *const u32,
    pub indices: usize,
    pub matrix: Option<[f32; 16]>,
    pub options: DrawOptions,
    pub near: f32,
    /// Number of clears submitted before it; set by the workers.
    pub clears: u64,
}

// SAFETY: the submitter guarantees that the data it points to does not change until the pool has been flushed.
unsafe impl Send for Call {}

/// The requested number of bins.
#[derive(Clone, Copy)]
pub(super) struct Bins {
    pub wide: u32,
    pub high: u32,
    /// The maximum in total.
    pub most: u32,
}

/// The work that a bin draws.
pub(super) enum Work {
    Triangles(BinnedTriangles),
    /// The number of the clear, counting from 1.
    Clear(u64),
    Merge(Vec<Shared>),
}

/// An object that is only read.
pub(super) struct Shared(pub NonNull<MaskedOcclusionCulling>);

// SAFETY: the submitter guarantees that it does not change until the pool has been flushed; it may be shared between
// threads.
unsafe impl Send for Shared {}
// SAFETY: as above.
unsafe impl Sync for Shared {}

/// The data that a bin's lock protects.
#[derive(Default)]
struct Piece {
    /// Tiles drawn into since the bin's coarse cells were refreshed; see `Region`.
    since_refresh: u32,
}

/// On a cache line of its own, so that threads in neighbouring bins do not slow each other down.
#[repr(align(64))]
#[derive(Default)]
struct Bin {
    piece: RwLock<Piece>,
    /// Number of clears that it has performed.
    clears: AtomicU64,
}

pub(super) struct Target {
    moc: Shared,
    /// The pool owns it.
    owned: bool,
    /// All tiles that the object had when the bins were made; a single one if it had no buffer.
    tiles: TileRect,
    grid: Grid,
    bins: Vec<Bin>,
    /// Number of clears submitted so far, for threads that submit or query while another one clears.
    clears: AtomicU64,
}

impl Target {
    /// # Safety
    /// The object does not move until the target is dropped; until then it is only used through the target, or while
    /// nothing is in flight and nobody calls the pool.
    pub unsafe fn new(moc: NonNull<MaskedOcclusionCulling>, owned: bool, bins: Bins) -> Self {
        // SAFETY: the caller's contract.
        let tiles = tiles_of(unsafe { moc.as_ref() });
        let grid = Grid::new(tiles, bins.wide, bins.high, bins.most);
        let bins = (0..grid.len()).map(|_| Bin::default()).collect();
        Self { moc: Shared(moc), owned, tiles, grid, bins, clears: AtomicU64::new(0) }
    }

    /// Has the object's resolution been changed without the pool's knowledge?
    pub fn is_outdated(&self) -> bool {
        self.tiles != tiles_of(self.moc())
    }

    pub fn moc(&self) -> &MaskedOcclusionCulling {
        // SAFETY: `new`'s contract; only shared references are made, and drawing goes through the buffer's pointers.
        unsafe { self.moc.0.as_ref() }
    }

    pub fn pointer(&self) -> NonNull<MaskedOcclusionCulling> {
        self.moc.0
    }

    pub fn bins(&self) -> usize {
        self.bins.len()
    }

    /// The number of columns and rows of bins.
    pub fn bin_count(&self) -> (u32, u32) {
        self.grid.count()
    }

    /// Called when the pool becomes busy or idle.
    pub fn turn(&self) {
        self.moc().attachment().turn();
    }

    /// Counts a clear before it is submitted: from now on earlier contents hide nothing.
    pub fn count_clear(&self) -> u64 {
        self.clears.fetch_add(1, Ordering::AcqRel) + 1
    }

    /// The number of clears submitted so far.
    pub fn clears(&self) -> u64 {
        self.clears.load(Ordering::Acquire)
    }

    /// Have all bins performed the clears before a call? Then everything in the buffer was drawn after them and before
    /// the call.
    fn is_cleared(&self, clears: u64) -> bool {
        self.bins.iter().all(|bin| bin.clears.load(Ordering::Acquire) >= clears)
    }

    /// Bins calls.
    ///
    /// # Safety
    /// The data that they point to can be read.
    pub unsafe fn bin(&self, calls: &[Call], binned: &mut BinnedTriangles) {
        binned.clear();
        let clears = calls.iter().map(|call| call.clears).max();
        let prefilter = clears.is_some_and(|clears| self.is_cleared(clears));
        for call in calls {
            // SAFETY: the caller's contract.
            let mesh = unsafe {
                let triangles = core::slice::from_raw_parts(call.triangles, call.indices);
                Mesh::new(call.vertices, call.matrix.as_ref(), triangles, &call.options)
            };
            self.moc().bin(&mesh, call.near, (self.grid.bounds(), prefilter), binned);
        }
    }

    /// Performs some work, in order, in a bin.
    pub fn draw(&self, bin: usize, work: &[Arc<Work>]) {
        let clip = self.grid.tiles(bin);
        let mut piece = self.bins[bin].piece.write().unwrap_or_else(PoisonError::into_inner);
        for run in work.chunk_by(|a, b| matches!((&**a, &**b), (Work::Triangles(..), Work::Triangles(..)))) {
            // A panic would be a bug in this library. Missing occluders are safe, but a missed clear after them is not.
            let _ = catch_unwind(AssertUnwindSafe(|| self.draw_run(bin, clip, &mut piece, run)));
        }
    }

    /// Performs work of one kind: a run of triangles, or a single piece of other work.
    fn draw_run(&self, bin: usize, clip: TileRect, piece: &mut Piece, run: &[Arc<Work>]) {
        let buffer = self.moc().buffer();
        // SAFETY: this thread holds the bin's write lock, so nobody else writes its tiles and coarse cells. Binning
        // threads read `z_min` word by word, and direct queries of the object that began earlier discard their answers.
        let mut region = unsafe { Region::new(buffer, clip, Some(&mut piece.since_refresh)) };
        match &*run[0] {
            Work::Triangles(..) => {
                let triangles = run.iter().filter_map(|work| match &**work {
                    Work::Triangles(triangles) => Some(triangles),
                    _ => None,
                });
                self.moc().draw_binned(region, triangles, bin);
            }
            Work::Clear(number) => {
                region.clear();
                // After the tiles, for threads that read them without the lock.
                self.bins[bin].clears.store(*number, Ordering::Release);
            }
            Work::Merge(others) => self.merge(others, region),
        }
    }

    fn merge(&self, others: &[Shared], region: Region<'_>) {
        // SAFETY: the submitter guarantees that they are valid.
        let others: Vec<&MaskedOcclusionCulling> = others.iter().map(|other| unsafe { other.0.as_ref() }).collect();
        // Their sizes matched when they were submitted, and nobody changes them meanwhile.
        if let Ok(theirs) = self.moc().mergeable(&others) {
            // SAFETY: the submitter guarantees that nobody draws into the others.
            unsafe { crate::buffer::merge::merge(self.moc().level(), region, &theirs) };
        }
    }

    /// Queries while nobody draws in the bins that contain a tile of a rectangle, or a tile whose `z_min` is loaded in
    /// the same vector as one of those. Anything drawn before a clear that is submitted but still pending hides
    /// nothing.
    pub fn query(&self, tiles: TileRect, ask: impl FnOnce(&MaskedOcclusionCulling) -> CullingResult) -> CullingResult {
        match self.look(tiles, ask) {
            (CullingResult::Occluded, true) => CullingResult::Visible,
            (result, _) => result,
        }
    }

    /// The same for any result of `ask`. True: some of what was drawn is still to be cleared.
    pub fn look<R>(&self, tiles: TileRect, ask: impl FnOnce(&MaskedOcclusionCulling) -> R) -> (R, bool) {
        let clears = self.clears.load(Ordering::Acquire);
        let read = |bin: usize| self.bins[bin].piece.read().unwrap_or_else(PoisonError::into_inner);
        // Vectors extend into the following rows of tiles.
        let ahead = (MAX_LANES as u32).div_ceil(self.tiles.x1);
        let y1 = (tiles.y1 + ahead).min(self.tiles.y1);
        let looked_at = TileRect { x0: 0, x1: self.tiles.x1, y0: tiles.y0, y1 };
        // Most rectangles lie in one bin, and then no list is allocated.
        let mut bins = self.grid.touched(looked_at);
        let first: Option<RwLockReadGuard<'_, Piece>> = bins.next().map(read);
        let rest: Vec<RwLockReadGuard<'_, Piece>> = bins.map(read).collect();
        let stale = self.grid.touched(tiles).any(|bin| self.bins[bin].clears.load(Ordering::Acquire) < clears);
        let result = ask(self.moc());
        drop((first, rest));
        (result, stale)
    }

    /// Rebuilds the bins after the object's resolution changed.
    pub fn resized(mut self, bins: Bins) -> Self {
        let owned = core::mem::take(&mut self.owned);
        // SAFETY: `self`'s contract still holds.
        unsafe { Self::new(self.moc.0, owned, bins) }
    }

    /// The object, if the pool owns it.
    pub fn into_owned(mut self) -> Option<MaskedOcclusionCulling> {
        let owned = core::mem::take(&mut self.owned);
        // SAFETY: it came from a box that was leaked to the pool, and is not freed again.
        owned.then(|| *unsafe { Box::from_raw(self.moc.0.as_ptr()) })
    }

    pub fn is_owned(&self) -> bool {
        self.owned
    }

    /// Every tile.
    pub fn all_tiles(&self) -> TileRect {
        self.tiles
    }
}

impl Drop for Target {
    fn drop(&mut self) {
        if self.owned {
            // SAFETY: it came from a box that was leaked to the pool.
            drop(unsafe { Box::from_raw(self.moc.0.as_ptr()) });
        }
    }
}

/// All tiles of an object, or a single one if it has no buffer yet.
fn tiles_of(moc: &MaskedOcclusionCulling) -> TileRect {
    if moc.has_buffer() { moc.buffer().all_tiles() } else { TileRect { x0: 0, y0: 0, x1: 1, y1: 1 } }
}
