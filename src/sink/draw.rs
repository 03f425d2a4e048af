//! Draws into a region of a buffer.

use core::marker::PhantomData;

use super::{Memory, TriangleSink, begun_in, tiles_in};
use crate::buffer::rules::{Inserted, Planes, Rule, with_rule};
use crate::buffer::{Buffer, Region, SUB_TILES, TilePlace, load};
use crate::geometry::{Corner, Exact};
use crate::raster::traverse::{Input, Workspace};
use crate::raster::{Alive, Batch, HizScope, MAX_TILES, Setup, TileOp, setup, traverse};
use crate::simd::{Outlined, Simd};
use crate::statistics::Tally;

/// Draws into a region.
///
/// `COARSE`: the region consists of whole coarse cells. Known when compiled, so that the HiZ test of small draws has
/// no code for the other case.
pub(crate) struct Draw<'a, const COARSE: bool> {
    region: Region<'a>,
}

impl<'a, const COARSE: bool> Draw<'a, COARSE> {
    #[inline(always)]
    pub fn new(region: Region<'a>) -> Self {
        debug_assert_eq!(region.has_coarse_level(), COARSE);
        Self { region }
    }

    /// Updates the tiles of triangles. If `COUNT`, counts them and those in which the reference depth rose.
    #[inline(always)]
    fn update<T: Simd, const COUNT: bool>(
        &mut self,
        t: T,
        alive: &Alive,
        memory: &mut Memory<Workspace>,
    ) -> (u64, u64) {
        let (buffer, clip) = (self.region.buffer(), self.region.tiles());
        let input = Input { buffer, clip, batch: &memory.batch, alive, lists: &mut memory.own };
        // Outlined: the code before it does not depend on the rule and is compiled only once.
        let (counts, tiles) = with_rule!(buffer.rule(), R => {
            t.outlined(UpdateTiles { input, op: Update::<R, COUNT>::new(buffer) })
        });
        self.region.count_drawn(t, tiles);
        counts
    }
}

impl<const COARSE: bool> TriangleSink for Draw<'_, COARSE> {
    type Coverage = Exact;
    type Memory = Workspace;

    #[inline(always)]
    fn submit<S: Simd>(
        &mut self,
        setup: Setup<'_, S>,
        corners: [Corner<S>; 3],
        active: S::M,
        memory: &mut Memory<Workspace>,
        tally: &mut Tally,
    ) -> bool {
        const { assert!(S::LANES.is_multiple_of(SUB_TILES)) }
        let counts = self.region.buffer().statistics();
        let scope = HizScope { clip: self.region.tiles(), coarse: COARSE };
        let alive = setup::set_up::<S, Exact>(setup, scope, corners, active, !counts, &mut memory.batch);
        if alive.rasterized == 0 {
            return true;
        }
        if counts {
            let (batch, clip): (&Batch, _) = (&memory.batch, self.region.tiles());
            // Each bin of a screen gets the same triangles, which must count once; a list has its own.
            // SAFETY: some triangles are rasterized, so set-up stored the batch.
            unsafe {
                tally.rasterized += if COARSE {
                    begun_in(batch, alive.rasterized, clip)
                } else {
                    u64::from(alive.rasterized.count_ones())
                };
                tally.traversed += tiles_in(batch, alive.rasterized, clip);
            }
            let (updated, merged) = self.update::<S, true>(setup.s, &alive, memory);
            (tally.updated, tally.merged) = (tally.updated + updated, tally.merged + merged);
        } else if alive.lanes != 0 {
            self.update::<S, false>(setup.s, &alive, memory);
        }
        true
    }
}

/// Triangles whose tiles are updated.
struct UpdateTiles<'a, O> {
    input: Input<'a>,
    op: O,
}

impl<T: Simd, R: Rule, const COUNT: bool> Outlined<T> for UpdateTiles<'_, Update<'_, R, COUNT>> {
    type Output = ((u64, u64), usize);

    #[inline(always)]
    fn run(self, t: T) -> Self::Output {
        let Self { input, mut op } = self;
        // SAFETY: `Draw` made the input from triangles that it set up and from its region, whose tiles only it updates.
        unsafe { traverse(t, input, &mut op) };
        op.done()
    }
}

/// Updates tiles by a rule, and counts them if `COUNT`.
struct Update<'a, R, const COUNT: bool> {
    buffer: &'a Buffer,
    updated: u64,
    merged: u64,
    tiles: usize,
    /// The increments for both counters.
    counts: u32,
    /// The screen's edge crosses some sub-tiles.
    has_edge_masks: bool,
    rule: PhantomData<R>,
}

impl<'a, R, const COUNT: bool> Update<'a, R, COUNT> {
    #[inline(always)]
    fn new(buffer: &'a Buffer) -> Self {
        Self {
            buffer,
            updated: 0,
            merged: 0,
            tiles: 0,
            counts: 0,
            has_edge_masks: buffer.has_edge_masks(),
            rule: PhantomData,
        }
    }

    /// Updates a tile and its `z_min`.
    ///
    /// # Safety
    /// As [`TileOp::tile`]; the buffer was made for the rule `R`.
    #[inline(always)]
    unsafe fn insert<T: Simd>(
        &mut self,
        t: T,
        at: TilePlace,
        row: impl Fn() -> u32,
        insert: impl FnOnce(&mut Planes<T>) -> Inserted<T>,
    ) where
        R: Rule,
    {
        // SAFETY: the caller's contract.
        let inserted = unsafe {
            let mut planes = load::<T, R>(t, self.buffer, at, row);
            let inserted = insert(&mut planes);
            R::store(t, at.planes, &planes);
            t.store_z_min(at.z_min, at.pitch, planes.z0);
            inserted
        };
        // Four counts in the bytes of a word: for each of two tiles, whether any lane was updated, and whether any was
        // merged.
        if COUNT {
            let lanes = t.mask_bits(inserted.live) | t.mask_bits(inserted.merged) << 16;
            self.counts += (((lanes & 0x7f7f_7f7f) + 0x7f7f_7f7f) | lanes) >> 7 & 0x0101_0101;
        }
    }

    /// Tiles that were updated, and those in which the reference depth rose; and how many were processed, of a vector's
    /// height.
    #[inline(always)]
    fn done(&self) -> ((u64, u64), usize) {
        ((self.updated, self.merged), self.tiles)
    }
}

impl<T: Simd, R: Rule, const COUNT: bool> TileOp<T> for Update<'_, R, COUNT> {
    const PLANES: usize = R::PLANES;
    type Coverage = Exact;

    #[inline(always)]
    unsafe fn tile(&mut self, t: T, at: TilePlace, row: impl Fn() -> u32, mut covered: T::I, depth: T::F) -> bool {
        // SAFETY: the caller's contract; the buffer was made for the rule `R`.
        unsafe {
            if self.has_edge_masks
                && let Some(outside) = self.buffer.edge_mask(at.x, row())
            {
                // A triangle with a pixel inside the screen covers all pixels outside.
                let outside = t.load_i(outside);
                covered = t.select_i(t.eq_i(covered, t.i(0)), t.i(0), t.or(covered, outside));
            }
            self.insert(t, at, row, |planes| R::insert(t, planes, covered, depth));
        }
        true
    }

    #[inline(always)]
    unsafe fn whole_tile(&mut self, t: T, at: TilePlace, row: impl Fn() -> u32, depth: T::F) -> bool {
        // SAFETY: the caller's contract; the buffer was made for the rule `R`.
        unsafe { self.insert(t, at, row, |planes| R::insert_all(t, planes, depth)) };
        true
    }

    #[inline(always)]
    fn tiles_done(&mut self, tiles: usize) {
        const { assert!(MAX_TILES < 256) }
        self.tiles += tiles;
        if !COUNT {
            return;
        }
        let of = |byte: u32| u64::from(self.counts >> (8 * byte) & 0xff);
        (self.updated, self.merged) = (self.updated + of(0) + of(1), self.merged + of(2) + of(3));
        self.counts = 0;
    }
}
