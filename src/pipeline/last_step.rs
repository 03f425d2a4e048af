//! The last step: what a draw, a query and a binning do with triangles that were set up.

use core::marker::PhantomData;
use core::mem::MaybeUninit;

use super::batch::Batch;
use super::edges::bits;
use super::setup::{Alive, Purpose, Setup, set_up};
use super::strips::MAX_TILES;
use super::survivors::{Corner, Survivors};
use super::tile_step::TileStep;
use super::traverse::{Lists, Way, traverse};
use crate::UpdateRule;
use crate::bins::TriList;
use crate::buffer::{
    Accurate, Buffer, FourLayer, Quick, Rule, SUB_TILES, TILE_HEIGHT, TILE_WIDTH, ThreeLayer, TilePlace, TileRect,
    Touched, areas, load,
};
use crate::simd::{Apart, Simd};
use crate::statistics::Tally;

/// What is done with triangles that were set up.
pub(super) trait LastStep {
    const PURPOSE: Purpose;

    /// Takes the triangles that are alive, in order. False: no more are needed.
    fn take(&mut self, batch: &Batch, alive: &Alive, tally: &mut Tally) -> bool;

    /// Is it given survivors before they are set up?
    const KEEPS: bool = false;

    /// Is given survivors; what setup makes of them is for later.
    #[inline(always)]
    fn keep<S: Simd>(&mut self, _setup: Setup<'_, S>, _corners: &[Corner<S>; 3], _active: S::M) {}

    /// Did any triangle come to anything? One can have its box on the screen and touch no pixel.
    #[inline(always)]
    fn found(&self) -> bool {
        true
    }
}

/// Are survivors that do not fill a vector taken, too, or do they wait for more?
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum All {
    Yes,
    No,
}

/// Sets up survivors, vector by vector, and takes them to the last step. False: no more are needed.
///
/// `direct`: the only triangles of a small call, which need not wait until they are written and read.
#[inline(always)]
pub(super) fn take_survivors<S: Simd, L: LastStep>(
    setup: Setup<'_, S>,
    survivors: &mut Survivors,
    direct: Option<([Corner<S>; 3], S::M)>,
    all: All,
    batch: &mut Batch,
    last: &mut L,
    tally: &mut Tally,
) -> bool {
    let end = if all == All::Yes { survivors.len() } else { survivors.len() / S::LANES * S::LANES };
    let mut direct = direct;
    let mut done = 0;
    loop {
        let (corners, active) = match direct.take() {
            Some(vector) => vector,
            None if done < end => {
                let vector = (survivors.vector(setup.s, done), setup.s.first(end - done));
                done += S::LANES.min(end - done);
                vector
            }
            None => break,
        };
        if L::KEEPS {
            last.keep(setup, &corners, active);
            continue;
        }
        let alive = set_up(setup, corners, active, batch);
        if alive.rasterized != 0 && !last.take(batch, &alive, tally) {
            return false;
        }
    }
    survivors.forget(setup.s, end);
    true
}

/// Draws into a buffer, inside of a rectangle of tiles.
pub(super) struct Draw<'a, T> {
    t: T,
    buffer: &'a Buffer,
    clip: TileRect,
    lists: MaybeUninit<Lists>,
    /// How many tiles were drawn into since the clip's areas were brought up to date, if that is done.
    drawn: Option<&'a mut u32>,
}

impl<'a, T: Simd> Draw<'a, T> {
    /// # Safety
    /// Nobody else uses the buffer.
    #[inline(always)]
    pub unsafe fn new(t: T, buffer: &'a Buffer) -> Self {
        // SAFETY: the caller's contract.
        let drawn = unsafe { &mut *buffer.drawn() };
        Self::inside(t, buffer, buffer.all_tiles(), Some(drawn))
    }

    #[inline(always)]
    pub fn inside(t: T, buffer: &'a Buffer, clip: TileRect, drawn: Option<&'a mut u32>) -> Self {
        const { assert!(T::LANES.is_multiple_of(SUB_TILES)) }
        Self { t, buffer, clip, lists: Lists::new(), drawn }
    }
}

impl<T: Simd> LastStep for Draw<'_, T> {
    const PURPOSE: Purpose = Purpose::Draw;

    #[inline(always)]
    fn take(&mut self, batch: &Batch, alive: &Alive, tally: &mut Tally) -> bool {
        if self.buffer.statistics() {
            // Of the pieces of a screen each has what was kept, and a triangle counts once; of lists, what is in them.
            tally.rasterized += match self.drawn {
                Some(_) => begun_in(batch, alive.rasterized, self.clip),
                None => u64::from(alive.rasterized.count_ones()),
            };
            tally.traversed += tiles_in(batch, alive.rasterized, self.clip);
            let (updated, merged) = self.update::<true>(batch, alive);
            (tally.updated, tally.merged) = (tally.updated + updated, tally.merged + merged);
        } else if alive.lanes != 0 {
            self.update::<false>(batch, alive);
        }
        true
    }
}

impl<T: Simd> Draw<'_, T> {
    /// Updates the tiles of triangles. If `COUNT`: how many, and in how many the reference depth rose.
    #[inline(always)]
    fn update<const COUNT: bool>(&mut self, batch: &Batch, alive: &Alive) -> (u64, u64) {
        let &mut Self { t, buffer, clip, ref mut lists, ref mut drawn } = self;
        // Apart: what comes before does not depend on the rule, and is compiled once for all rules.
        let way = Way { buffer, clip, batch, alive, lists };
        let (counts, tiles) = match buffer.rule() {
            UpdateRule::ThreeLayer => {
                t.apart(Traverse { way, step: Update::<ThreeLayer, COUNT>::new(buffer) }).1.done()
            }
            UpdateRule::Quick => t.apart(Traverse { way, step: Update::<Quick, COUNT>::new(buffer) }).1.done(),
            UpdateRule::Accurate => t.apart(Traverse { way, step: Update::<Accurate, COUNT>::new(buffer) }).1.done(),
            UpdateRule::FourLayer => t.apart(Traverse { way, step: Update::<FourLayer, COUNT>::new(buffer) }).1.done(),
        };
        if let Some(count) = drawn {
            // SAFETY: nobody else uses the clip's tiles.
            unsafe { areas::drawn(t, buffer, clip, tiles, count) };
        }
        counts
    }
}

/// Triangles to be taken to a step.
struct Traverse<'a, S> {
    way: Way<'a>,
    step: S,
}

impl<T: Simd, S: TileStep<T>> Apart<T> for Traverse<'_, S> {
    type Output = (Option<u32>, S);

    #[inline(always)]
    fn run(self, t: T) -> (Option<u32>, S) {
        let Self { way, mut step } = self;
        (traverse(t, way, &mut step), step)
    }
}

/// How many of the triangles in `lanes` have the first tile of their box in a rectangle: cut into pieces, a screen counts each
/// once.
fn begun_in(batch: &Batch, lanes: u32, clip: TileRect) -> u64 {
    let begun = |&lane: &usize| {
        let [x0, _, y0, _] = batch.tiles(lane);
        (clip.x0..clip.x1).contains(&x0) && (clip.y0..clip.y1).contains(&y0)
    };
    bits(lanes).filter(begun).count() as u64
}

/// Tiles of the boxes of the triangles in `lanes`, inside of a rectangle.
fn tiles_in(batch: &Batch, lanes: u32, clip: TileRect) -> u64 {
    let mut tiles = 0;
    for lane in bits(lanes) {
        let [x0, x1, y0, y1] = batch.tiles(lane);
        let wide = (x1 + 1).min(clip.x1).saturating_sub(x0.max(clip.x0));
        let high = (y1 + 1).min(clip.y1).saturating_sub(y0.max(clip.y0));
        tiles += u64::from(wide) * u64::from(high);
    }
    tiles
}

/// Updates tiles, and counts them if `COUNT`.
struct Update<'a, R, const COUNT: bool> {
    buffer: &'a Buffer,
    updated: u64,
    merged: u64,
    tiles: usize,
    /// What the next tiles add to both.
    counts: u32,
    /// The screen's edge cuts sub-tiles somewhere.
    cuts: bool,
    rule: PhantomData<R>,
}

impl<'a, R, const COUNT: bool> Update<'a, R, COUNT> {
    #[inline(always)]
    fn new(buffer: &'a Buffer) -> Self {
        Self { buffer, updated: 0, merged: 0, tiles: 0, counts: 0, cuts: buffer.cuts(), rule: PhantomData }
    }

    /// Tiles that were updated, and in which the reference depth rose; and how many were taken, of a vector's height.
    #[inline(always)]
    fn done(&self) -> ((u64, u64), usize) {
        ((self.updated, self.merged), self.tiles)
    }
}

impl<T: Simd, R: Rule, const COUNT: bool> TileStep<T> for Update<'_, R, COUNT> {
    const PLANES: usize = R::PLANES;
    const DRAWS: bool = true;

    #[inline(always)]
    fn open(t: T, least: T::F, nearest: T::F) -> T::M {
        t.lt(least, nearest)
    }

    #[inline(always)]
    unsafe fn tile(&mut self, t: T, at: TilePlace, row: impl Fn() -> u32, mut covered: T::I, depth: T::F) -> bool {
        // SAFETY: the caller's contract; the buffer was made for the rule `R`.
        let inserted = unsafe {
            if self.cuts
                && let Some(outside) = self.buffer.cut(at.x, row())
            {
                // With a pixel inside of the screen come all pixels outside.
                let outside = t.load_i(outside);
                covered = t.select_i(t.eq_i(covered, t.i(0)), t.i(0), t.or(covered, outside));
            }
            let mut planes = load::<T, R>(t, self.buffer, at, row);
            let inserted = R::insert(t, &mut planes, covered, depth);
            R::store(t, at.planes, &planes);
            t.store_least(at.least, at.pitch, planes.z0);
            inserted
        };
        // Four counts in the bytes of a word: of two tiles with a lane in which something was updated, merged.
        if COUNT {
            let lanes = t.mask_bits(inserted.live) | t.mask_bits(inserted.merged) << 16;
            self.counts += (((lanes & 0x7f7f_7f7f) + 0x7f7f_7f7f) | lanes) >> 7 & 0x0101_0101;
        }
        true
    }

    #[inline(always)]
    unsafe fn whole_tile(&mut self, t: T, at: TilePlace, row: impl Fn() -> u32, depth: T::F) -> bool {
        // SAFETY: the caller's contract; the buffer was made for the rule `R`.
        unsafe {
            if Touched::of::<T>(at).all() && R::replace(t, at.planes, depth) {
                t.store_least(at.least, at.pitch, depth);
                if COUNT {
                    self.counts += if T::LANES == SUB_TILES { 0x0001_0001 } else { 0x0101_0101 };
                }
                return true;
            }
            self.tile(t, at, row, t.i(-1), depth)
        }
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

/// Compares with a buffer until something may be seen.
pub(super) struct Query<'a, T> {
    t: T,
    buffer: &'a Buffer,
    lists: MaybeUninit<Lists>,
    /// Some triangle touched a pixel, or was hidden before setup, which says that it is on the screen.
    found: bool,
}

impl<'a, T: Simd> Query<'a, T> {
    #[inline(always)]
    pub fn new(t: T, buffer: &'a Buffer) -> Self {
        const { assert!(T::LANES.is_multiple_of(SUB_TILES)) }
        Self { t, buffer, lists: Lists::new(), found: false }
    }
}

impl<T: Simd> LastStep for Query<'_, T> {
    const PURPOSE: Purpose = Purpose::Query;

    #[inline(always)]
    fn take(&mut self, batch: &Batch, alive: &Alive, tally: &mut Tally) -> bool {
        let &mut Self { t, buffer, ref mut lists, .. } = self;
        let clip = buffer.all_tiles();
        let way = Way { buffer, clip, batch, alive, lists };
        let (stopped, touches) = match buffer.rule() {
            UpdateRule::ThreeLayer => compared(t.apart(Traverse { way, step: Compare::<ThreeLayer>::new(buffer) })),
            UpdateRule::Quick => compared(t.apart(Traverse { way, step: Compare::<Quick>::new(buffer) })),
            UpdateRule::Accurate => compared(t.apart(Traverse { way, step: Compare::<Accurate>::new(buffer) })),
            UpdateRule::FourLayer => compared(t.apart(Traverse { way, step: Compare::<FourLayer>::new(buffer) })),
        };
        self.found |= touches || alive.rasterized != alive.lanes;
        if !self.found && stopped.is_none() {
            // Whole tiles hid all of it, or it passes by: the first pixel touched tells. Which tiles are looked at
            // together depends on the instruction set, so that being hidden does not.
            let way = Way { buffer, clip, batch, alive, lists };
            self.found = t.apart(Traverse { way, step: Touch }).0.is_some();
        }
        // Triangles after the first that may be seen do not count, however many a vector has.
        let counted = alive.rasterized & stopped.map_or(u32::MAX, |lane| (2 << lane) - 1);
        tally.rasterized += u64::from(counted.count_ones());
        if buffer.statistics() {
            tally.traversed += tiles_in(batch, counted, clip);
        }
        stopped.is_none()
    }

    #[inline(always)]
    fn found(&self) -> bool {
        self.found
    }
}

#[inline(always)]
fn compared<R>((stopped, step): (Option<u32>, Compare<'_, R>)) -> (Option<u32>, bool) {
    (stopped, step.touches)
}

/// Stops at the first tile of which a pixel is touched.
struct Touch;

impl<T: Simd> TileStep<T> for Touch {
    const PLANES: usize = 0;
    const DRAWS: bool = false;

    #[inline(always)]
    fn open(t: T, least: T::F, _: T::F) -> T::M {
        t.eq(least, least)
    }

    #[inline(always)]
    unsafe fn tile(&mut self, t: T, _: TilePlace, _: impl Fn() -> u32, covered: T::I, _: T::F) -> bool {
        nothing(t, covered)
    }

    #[inline(always)]
    unsafe fn whole_tile(&mut self, _: T, _: TilePlace, _: impl Fn() -> u32, _: T::F) -> bool {
        false
    }
}

/// Is no pixel covered?
#[inline(always)]
fn nothing<T: Simd>(t: T, covered: T::I) -> bool {
    t.all(t.eq_i(covered, t.i(0)))
}

struct Compare<'a, R> {
    buffer: &'a Buffer,
    /// Some pixel was touched.
    touches: bool,
    rule: PhantomData<R>,
}

impl<'a, R> Compare<'a, R> {
    #[inline(always)]
    fn new(buffer: &'a Buffer) -> Self {
        Self { buffer, touches: false, rule: PhantomData }
    }
}

impl<T: Simd, R: Rule> TileStep<T> for Compare<'_, R> {
    const PLANES: usize = R::PLANES;
    const DRAWS: bool = false;

    #[inline(always)]
    fn open(t: T, least: T::F, nearest: T::F) -> T::M {
        t.le(least, nearest)
    }

    #[inline(always)]
    unsafe fn tile(&mut self, t: T, at: TilePlace, row: impl Fn() -> u32, covered: T::I, depth: T::F) -> bool {
        self.touches |= !nothing(t, covered);
        // SAFETY: the caller's contract; the buffer was made for the rule `R`.
        let hidden = unsafe { R::hides(t, &load::<T, R>(t, self.buffer, at, row), covered, depth) };
        t.all(hidden)
    }

    #[inline(always)]
    unsafe fn whole_tile(&mut self, t: T, at: TilePlace, row: impl Fn() -> u32, depth: T::F) -> bool {
        // SAFETY: the caller's contract.
        unsafe { self.tile(t, at, row, t.i(-1), depth) }
    }
}

/// Appends to the lists of bins.
pub(super) struct Bins<'b, 'c> {
    lists: &'b mut [TriList<'c>],
    bin_size: (u32, u32),
    bins: (u32, u32),
    /// Some list had no room.
    pub full: bool,
}

impl<'b, 'c> Bins<'b, 'c> {
    pub fn new(lists: &'b mut [TriList<'c>], bin_size: (u32, u32), bins: (u32, u32)) -> Self {
        Self { lists, bin_size, bins, full: false }
    }
}

impl LastStep for Bins<'_, '_> {
    const PURPOSE: Purpose = Purpose::Bin;

    #[inline(always)]
    fn take(&mut self, batch: &Batch, alive: &Alive, tally: &mut Tally) -> bool {
        tally.rasterized += u64::from(alive.rasterized.count_ones());
        let (wide, high) = (self.bin_size.0 / TILE_WIDTH, self.bin_size.1 / TILE_HEIGHT);
        for lane in bits(alive.lanes) {
            // SAFETY: setup stores the corners of every triangle that is binned.
            let triangle = batch.corners.each_ref().map(|x| unsafe { x.get(lane) });
            let [x0, x1, y0, y1] = batch.tiles(lane);
            // The last bin takes what division leaves over.
            let column = |tile: u32| (tile / wide).min(self.bins.0 - 1);
            let row = |tile: u32| (tile / high).min(self.bins.1 - 1);
            for y in row(y0)..=row(y1) {
                for x in column(x0)..=column(x1) {
                    self.full |= !self.lists[(y * self.bins.0 + x) as usize].push(&triangle);
                }
            }
        }
        true
    }
}
