//! The object that a pool draws into, in bins that are locked one by one: one thread draws in a bin, or any number query it.

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

/// A call, or a part of it, as it was submitted.
pub(super) struct Call {
    pub vertices: VertexSource,
    pub triangles: *const u32,
    pub indices: usize,
    pub matrix: Option<[f32; 16]>,
    pub options: DrawOptions,
    pub near: f32,
    /// Clears that were submitted before it; the workers count.
    pub clears: u64,
}

// SAFETY: who submitted it vouches that what it points to stays as it is until the pool was flushed.
unsafe impl Send for Call {}

/// How many bins are wanted.
#[derive(Clone, Copy)]
pub(super) struct Bins {
    pub wide: u32,
    pub high: u32,
    /// In all.
    pub most: u32,
}

/// What a bin takes in.
pub(super) enum Work {
    Triangles(BinnedTriangles),
    /// The number of the clear, from 1 on.
    Clear(u64),
    Merge(Vec<Shared>),
}

/// An object that is looked at only.
pub(super) struct Shared(pub NonNull<MaskedOcclusionCulling>);

// SAFETY: who submitted it vouches that nobody changes it until the pool was flushed; it may be shared between threads.
unsafe impl Send for Shared {}
// SAFETY: as above.
unsafe impl Sync for Shared {}

/// What goes with the lock of a bin.
#[derive(Default)]
struct Piece {
    /// Tiles drawn into since its coarse cells were refreshed; see `Region`.
    since_refresh: u32,
}

/// On a cache line of its own, so that threads in neighbouring bins do not slow each other down.
#[repr(align(64))]
#[derive(Default)]
struct Bin {
    piece: RwLock<Piece>,
    /// Clears that it saw.
    clears: AtomicU64,
}

pub(super) struct Target {
    moc: Shared,
    /// It goes with the pool.
    owned: bool,
    /// All tiles that the object had when the bins were made; one where it had no buffer.
    tiles: TileRect,
    grid: Grid,
    bins: Vec<Bin>,
    /// Clears submitted so far, for threads that submit or query while another one clears.
    clears: AtomicU64,
}

impl Target {
    /// # Safety
    /// The object stays where it is until the target is dropped; meanwhile it is used through the target only, or
    /// while nothing is in flight and nobody calls the pool.
    pub unsafe fn new(moc: NonNull<MaskedOcclusionCulling>, owned: bool, bins: Bins) -> Self {
        // SAFETY: the caller's contract.
        let tiles = tiles_of(unsafe { moc.as_ref() });
        let grid = Grid::new(tiles, bins.wide, bins.high, bins.most);
        let bins = (0..grid.len()).map(|_| Bin::default()).collect();
        Self { moc: Shared(moc), owned, tiles, grid, bins, clears: AtomicU64::new(0) }
    }

    /// Was its object given another resolution behind its back?
    pub fn is_outdated(&self) -> bool {
        self.tiles != tiles_of(self.moc())
    }

    pub fn moc(&self) -> &MaskedOcclusionCulling {
        // SAFETY: `new`'s contract; only shared references are made, what is drawn goes through the buffer's pointers.
        unsafe { self.moc.0.as_ref() }
    }

    pub fn pointer(&self) -> NonNull<MaskedOcclusionCulling> {
        self.moc.0
    }

    pub fn bins(&self) -> usize {
        self.bins.len()
    }

    /// Columns and rows of bins.
    pub fn bin_count(&self) -> (u32, u32) {
        self.grid.count()
    }

    /// The pool becomes busy, or idle again.
    pub fn turn(&self) {
        self.moc().attachment().turn();
    }

    /// Counts a clear before it is submitted: from now on what was drawn before hides nothing.
    pub fn count_clear(&self) -> u64 {
        self.clears.fetch_add(1, Ordering::AcqRel) + 1
    }

    /// Clears that were submitted so far.
    pub fn clears(&self) -> u64 {
        self.clears.load(Ordering::Acquire)
    }

    /// Did all bins see the clears before a call? Then what is in the buffer was drawn before it, and since.
    fn is_cleared(&self, clears: u64) -> bool {
        self.bins.iter().all(|bin| bin.clears.load(Ordering::Acquire) >= clears)
    }

    /// Bins calls.
    ///
    /// # Safety
    /// What they point to can be read.
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

    /// Does some work, in order, in a bin.
    pub fn draw(&self, bin: usize, work: &[Arc<Work>]) {
        let clip = self.grid.tiles(bin);
        let mut piece = self.bins[bin].piece.write().unwrap_or_else(PoisonError::into_inner);
        for run in work.chunk_by(|a, b| matches!((&**a, &**b), (Work::Triangles(..), Work::Triangles(..)))) {
            // A panic would be a bug of ours; then occluders are missing, which is safe, but a clear that comes after them is not.
            let _ = catch_unwind(AssertUnwindSafe(|| self.draw_run(bin, clip, &mut piece, run)));
        }
    }

    /// Does work of one kind, which is one piece of it unless it is triangles.
    fn draw_run(&self, bin: usize, clip: TileRect, piece: &mut Piece, run: &[Arc<Work>]) {
        let buffer = self.moc().buffer();
        // SAFETY: this thread holds the bin's lock for writing, so nobody else writes its tiles and coarse cells. Threads that bin
        // read `z_min` word by word, and direct queries of the object that began before discard their answers.
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
                // After the tiles, for those who read them without the lock.
                self.bins[bin].clears.store(*number, Ordering::Release);
            }
            Work::Merge(others) => self.merge(others, region),
        }
    }

    fn merge(&self, others: &[Shared], region: Region<'_>) {
        // SAFETY: who submitted them vouches for them.
        let others: Vec<&MaskedOcclusionCulling> = others.iter().map(|other| unsafe { other.0.as_ref() }).collect();
        // They fitted when they were submitted, and nobody changes them meanwhile.
        if let Ok(theirs) = self.moc().mergeable(&others) {
            // SAFETY: whoever submitted the others vouches for them.
            unsafe { crate::buffer::merge::merge(self.moc().level(), region, &theirs) };
        }
    }

    /// Queries while nobody draws in the bins that hold a tile of a rectangle, or one whose `z_min` lies in a vector with those of
    /// its tiles. What was drawn before a clear that was submitted, but not done yet, hides nothing.
    pub fn query(&self, tiles: TileRect, ask: impl FnOnce(&MaskedOcclusionCulling) -> CullingResult) -> CullingResult {
        match self.look(tiles, ask) {
            (CullingResult::Occluded, true) => CullingResult::Visible,
            (result, _) => result,
        }
    }

    /// The same for whatever `ask` returns. True: of what was drawn some is to be cleared yet.
    pub fn look<R>(&self, tiles: TileRect, ask: impl FnOnce(&MaskedOcclusionCulling) -> R) -> (R, bool) {
        let clears = self.clears.load(Ordering::Acquire);
        let read = |bin: usize| self.bins[bin].piece.read().unwrap_or_else(PoisonError::into_inner);
        // Vectors go on with the next rows of tiles.
        let ahead = (MAX_LANES as u32).div_ceil(self.tiles.x1);
        let y1 = (tiles.y1 + ahead).min(self.tiles.y1);
        let looked_at = TileRect { x0: 0, x1: self.tiles.x1, y0: tiles.y0, y1 };
        // Most rectangles lie in one bin, for which no list is allocated.
        let mut bins = self.grid.touched(looked_at);
        let first: Option<RwLockReadGuard<'_, Piece>> = bins.next().map(read);
        let rest: Vec<RwLockReadGuard<'_, Piece>> = bins.map(read).collect();
        let stale = self.grid.touched(tiles).any(|bin| self.bins[bin].clears.load(Ordering::Acquire) < clears);
        let result = ask(self.moc());
        drop((first, rest));
        (result, stale)
    }

    /// The same after its object got another resolution.
    pub fn resized(mut self, bins: Bins) -> Self {
        let owned = core::mem::take(&mut self.owned);
        // SAFETY: `self`'s contract goes on.
        unsafe { Self::new(self.moc.0, owned, bins) }
    }

    /// The object, if it goes with the pool.
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

/// All tiles of an object, or one where it has no buffer yet.
fn tiles_of(moc: &MaskedOcclusionCulling) -> TileRect {
    if moc.has_buffer() { moc.buffer().all_tiles() } else { TileRect { x0: 0, y0: 0, x1: 1, y1: 1 } }
}
