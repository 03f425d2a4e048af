//! The last step: the tiles of each triangle, and what is done in them.
//!
//! Coverage comes from events (see `setup.rs`): eight rows of a tile are eight lanes of 32 pixels each,
//! two shifts a lane; transposing bytes then turns rows into sub-tiles, eight lanes of 8x4 pixels (HPG 2016,
//! section 3.1). A strip of tiles shares its events.

use core::marker::PhantomData;

use super::edges::bits;
use super::setup::{Alive, Batch, Purpose};
use crate::bins::TriList;
use crate::buffer::{Buffer, Rule, SUB_TILES, TILE_HEIGHT, TILE_WIDTH, TileRect, UNTOUCHED, fresh};
use crate::simd::Simd;
use crate::statistics::Tally;

/// What is done with triangles that were set up.
pub(super) trait LastStep {
    const PURPOSE: Purpose;

    /// The tiles that count.
    fn clip(&self, buffer: &Buffer) -> TileRect {
        buffer.all_tiles()
    }

    /// Takes the triangles that are alive, in order. False: no more are needed.
    fn take(&mut self, batch: &Batch, alive: &Alive, tally: &mut Tally) -> bool;
}

/// The events of one strip of tiles: for each of eight rows the first pixel inside and the first beyond.
struct Strip<T: Simd> {
    left: T::I,
    right: T::I,
}

impl<T: Simd> Strip<T> {
    #[inline(always)]
    fn new(t: T, batch: &Batch, lane: usize, tile_y: u32, width: f64) -> Self {
        let rows = t.add_i(t.i((tile_y * TILE_HEIGHT) as i32), t.iota());
        let [left, right] = events(t, batch, lane, rows);
        let clamp = |x: T::D| t.d_to_i(t.min_d(t.max_d(x, t.d(0.0)), t.d(width)));
        Self { left: clamp(left), right: t.select_i(rows_inside(t, batch, lane, rows), clamp(right), t.i(0)) }
    }

    /// The pixels of a tile, a sub-tile a lane.
    #[inline(always)]
    fn coverage(&self, t: T, tile_x: u32) -> T::I {
        let within =
            |x: T::I| t.min_i(t.max_i(t.sub_i(x, t.i((tile_x * TILE_WIDTH) as i32)), t.i(0)), t.i(TILE_WIDTH as i32));
        let (left, right) = (within(self.left), within(self.right));
        t.transpose_bytes(t.and_not(t.ones_shl(right), t.ones_shl(left)))
    }

    /// Of 64 tiles from `start` on, those from the first to the last that any row reaches.
    #[inline(always)]
    fn reach(&self, t: T, start: u32) -> u64 {
        let empty = t.gt_i(t.add_i(self.left, t.i(1)), self.right);
        let first = t.least(t.select(empty, t.f(f32::MAX), t.to_f(self.left)));
        let end = -t.least(t.select(empty, t.f(0.0), t.sub(t.f(0.0), t.to_f(self.right))));
        // To tiles, the end rounded up; MAX saturates.
        let (first, end) = (first as u32 / TILE_WIDTH, (end as u32).div_ceil(TILE_WIDTH));
        let below = |tile: u32| match tile.saturating_sub(start) {
            n @ 0..64 => (1 << n) - 1,
            _ => u64::MAX,
        };
        below(end) & !below(first)
    }
}

/// The left and the right events of eight rows, before they are rounded down.
#[inline(always)]
fn events<T: Simd>(t: T, batch: &Batch, lane: usize, rows: T::I) -> [T::D; 2] {
    let row = t.to_d(t.to_f(rows));
    let left = t.add_d(t.d(batch.left[lane]), t.mul_d(t.d(batch.left_slope[lane]), row));
    let right = t.add_d(t.d(batch.right[lane]), t.mul_d(t.d(batch.right_slope[lane]), row));
    let middle = t.mul_d(t.d(batch.middle_slope[lane]), row);
    [
        t.max_d(left, t.add_d(t.d(batch.middle_left[lane]), middle)),
        t.min_d(right, t.add_d(t.d(batch.middle_right[lane]), middle)),
    ]
}

/// Rows from the triangle's first to its last; the others have no pixels, whatever their events.
#[inline(always)]
fn rows_inside<T: Simd>(t: T, batch: &Batch, lane: usize, rows: T::I) -> T::M {
    t.and_m(t.gt_i(rows, t.i(batch.row0[lane] as i32 - 1)), t.gt_i(t.i(batch.row1[lane] as i32), rows))
}

/// Visits each tile of a triangle inside of `clip` whose least depth is `open`, strip by strip.
///
/// The tiles of a strip are compared with the triangle's nearest depth eight at a time, so that what is hidden
/// costs no branch of its own. A macro, since a closure that is called from two places is not inlined.
macro_rules! for_each_tile {
    ($t:ident, $buffer:expr, $clip:expr, $batch:ident, $lane:ident, |$least:ident| $open:expr,
        |$x:ident, $y:ident, $index:ident, $strip:ident, $plane:ident| $visit:block) => {{
        let clip: TileRect = $clip;
        let (x0, x1) = ($batch.tile_x0[$lane], $batch.tile_x1[$lane]);
        let (y0, y1) = ($batch.tile_y0[$lane], $batch.tile_y1[$lane]);
        let (z, across, down) = ($t.f($batch.z[$lane]), $t.f($batch.z_across[$lane]), $t.f($batch.z_down[$lane]));
        let column = $t.and($t.iota(), $t.i(3));
        let half = $t.sra::<2>($t.iota());
        let (begin, end) = (x0.max(clip.x0), (x1 + 1).min(clip.x1));
        let mut next_row = y0.max(clip.y0);
        while next_row <= y1 && next_row < clip.y1 {
            let $y = next_row;
            next_row += 1;
            let row = ($y * $buffer.tiles_w()) as usize;
            let mut start = begin;
            while start < end {
                let count = (end - start).min(64);
                let mut tiles = 0_u64;
                let mut k = 0;
                while k < count {
                    // SAFETY: tiles of a triangle's box are tiles of the buffer; after the last there is room for a vector.
                    let $least = unsafe { $t.load_f($buffer.least().add(row + (start + k) as usize)) };
                    tiles |= u64::from($t.mask_bits($open)) << k;
                    k += SUB_TILES as u32;
                }
                tiles &= u64::MAX >> (64 - count);
                if tiles != 0 {
                    let $strip = Strip::new($t, $batch, $lane, $y, $buffer.tiles_w() as f64 * TILE_WIDTH as f64);
                    if count > 4 {
                        tiles &= $strip.reach($t, start);
                    }
                    let sub_row = $t.add_i($t.i(2 * ($y - y0) as i32), half);
                    let z_row = $t.add(z, $t.mul(down, $t.to_f(sub_row)));
                    while tiles != 0 {
                        let $x = start + tiles.trailing_zeros();
                        tiles &= tiles - 1;
                        let $index = row + $x as usize;
                        let sub_column = $t.add_i($t.i(4 * ($x - x0) as i32), column);
                        let $plane = $t.add(z_row, $t.mul(across, $t.to_f(sub_column)));
                        $visit
                    }
                }
                start += count;
            }
        }
    }};
}

/// Draws into a buffer, inside of a rectangle of tiles.
pub(super) struct Draw<'a, T, R> {
    t: T,
    buffer: &'a Buffer,
    clip: TileRect,
    rule: PhantomData<R>,
}

impl<'a, T: Simd, R: Rule> Draw<'a, T, R> {
    pub fn new(t: T, buffer: &'a Buffer, clip: TileRect) -> Self {
        const { assert!(T::LANES == SUB_TILES) }
        Self { t, buffer, clip, rule: PhantomData }
    }
}

impl<T: Simd, R: Rule> Draw<'_, T, R> {
    /// Takes what a triangle covers of a tile into the buffer. `least` is the tile's least depth.
    ///
    /// # Safety
    /// `index` is tile (x, y) of the buffer, and nobody else uses it.
    #[inline(always)]
    unsafe fn update(&self, index: usize, [x, y]: [u32; 2], mut covered: T::I, depth: T::F, tally: &mut Tally) {
        let (t, buffer) = (self.t, self.buffer);
        // SAFETY: the caller's contract; the buffer was made for the rule `R`.
        let inserted = unsafe {
            let least = buffer.least().add(index);
            let tile = buffer.tile(index);
            let border = buffer.border(x, y);
            if let Some(outside) = border {
                let outside = t.load_i(outside.as_ptr());
                let nothing = t.eq_i(t.and_not(outside, covered), t.i(0));
                covered = t.select_i(nothing, t.i(0), t.or(covered, outside));
            }
            let mut planes = if *least == UNTOUCHED { fresh::<T, R>(t, border) } else { R::load(t, tile) };
            let inserted = R::insert(t, &mut planes, covered, depth);
            R::store(t, tile, &planes);
            *least = t.least(planes.z0);
            inserted
        };
        tally.updated += u64::from(t.mask_bits(inserted.live) != 0);
        tally.merged += u64::from(t.mask_bits(inserted.merged) != 0);
    }

    /// One tile of a small triangle, of four: the second column or row where `right` or `low` is 1.
    #[inline(always)]
    fn small(&self, batch: &Batch, lane: usize, right: u32, low: u32, tally: &mut Tally) {
        let t = self.t;
        let (x, y) = (batch.tile_x0[lane] + right, batch.tile_y0[lane] + low);
        let index = (y * self.buffer.tiles_w() + x) as usize;
        let first_row = (y * TILE_HEIGHT) as i32;
        let rows = t.add_i(t.i(first_row), t.iota());
        let [left, right_events] = events(t, batch, lane, rows);
        let from = t.d(f64::from(x * TILE_WIDTH));
        let within = |e: T::D| t.d_to_i(t.min_d(t.max_d(t.sub_d(e, from), t.d(0.0)), t.d(f64::from(TILE_WIDTH))));
        let (first, end) = (within(left), within(right_events));
        let end = t.select_i(rows_inside(t, batch, lane, rows), end, t.i(0));
        let covered = t.transpose_bytes(t.and_not(t.ones_shl(end), t.ones_shl(first)));
        let sub_column = t.add_i(t.i(4 * right as i32), t.and(t.iota(), t.i(3)));
        let sub_row = t.add_i(t.i(2 * low as i32), t.sra::<2>(t.iota()));
        let z_row = t.add(t.f(batch.z[lane]), t.mul(t.f(batch.z_down[lane]), t.to_f(sub_row)));
        let plane = t.add(z_row, t.mul(t.f(batch.z_across[lane]), t.to_f(sub_column)));
        let depth = t.max(plane, t.f(batch.z_clamp[lane]));
        // SAFETY: a tile of the triangle's box is a tile of the buffer, which the caller of the pipeline keeps to this call.
        unsafe { self.update(index, [x, y], covered, depth, tally) }
    }
}

impl<T: Simd, R: Rule> LastStep for Draw<'_, T, R> {
    const PURPOSE: Purpose = Purpose::Draw;

    #[inline(always)]
    fn clip(&self, _: &Buffer) -> TileRect {
        self.clip
    }

    #[inline(always)]
    fn take(&mut self, batch: &Batch, alive: &Alive, tally: &mut Tally) -> bool {
        let (t, buffer) = (self.t, self.buffer);
        tally.rasterized += u64::from(alive.rasterized.count_ones());
        tally.traversed += alive.boxes.iter().map(|b| u64::from(b.count_ones())).sum::<u64>();
        // One bit a tile, four a triangle, in the triangles' order: a loop over them is predicted well.
        let mut tiles = interleave(alive.open);
        let mut large = alive.large;
        loop {
            let lane = large.trailing_zeros() as usize;
            let before = if large == 0 { u64::MAX } else { (1 << (4 * lane)) - 1 };
            let mut now = tiles & before;
            tiles &= !before;
            while now != 0 {
                let tile = now.trailing_zeros();
                now &= now - 1;
                self.small(batch, tile as usize / 4, tile & 1, tile >> 1 & 1, tally);
            }
            if large == 0 {
                return true;
            }
            large &= large - 1;
            let nearest = t.f(batch.nearest[lane]);
            tally.traversed += tiles_in(batch, lane, self.clip);
            for_each_tile!(
                t,
                buffer,
                self.clip,
                batch,
                lane,
                |least| t.lt(least, nearest),
                |x, y, index, strip, plane| {
                    let depth = t.max(plane, t.f(batch.z_clamp[lane]));
                    // SAFETY: a tile of the buffer, which the caller of the pipeline keeps to this call.
                    unsafe { self.update(index, [x, y], strip.coverage(t, x), depth, tally) }
                }
            );
        }
    }
}

/// Tiles of a triangle's box inside of a rectangle.
#[inline(always)]
fn tiles_in(batch: &Batch, lane: usize, clip: TileRect) -> u64 {
    let wide = (batch.tile_x1[lane] + 1).min(clip.x1).saturating_sub(batch.tile_x0[lane].max(clip.x0));
    let high = (batch.tile_y1[lane] + 1).min(clip.y1).saturating_sub(batch.tile_y0[lane].max(clip.y0));
    u64::from(wide) * u64::from(high)
}

/// Sixteen bits of four masks each, bit by bit: bit `4 * lane + k` is bit `lane` of mask `k`.
#[inline(always)]
fn interleave(masks: [u32; 4]) -> u64 {
    let spread = |mask: u32| {
        let mut x = u64::from(mask);
        x = (x | x << 24) & 0x0000_00ff_0000_00ff;
        x = (x | x << 12) & 0x000f_000f_000f_000f;
        x = (x | x << 6) & 0x0303_0303_0303_0303;
        (x | x << 3) & 0x1111_1111_1111_1111
    };
    spread(masks[0]) | spread(masks[1]) << 1 | spread(masks[2]) << 2 | spread(masks[3]) << 3
}

/// Compares with a buffer until something may be seen.
pub(super) struct Query<'a, T, R> {
    t: T,
    buffer: &'a Buffer,
    rule: PhantomData<R>,
}

impl<'a, T: Simd, R: Rule> Query<'a, T, R> {
    pub fn new(t: T, buffer: &'a Buffer, _: TileRect) -> Self {
        const { assert!(T::LANES == SUB_TILES) }
        Self { t, buffer, rule: PhantomData }
    }
}

impl<T: Simd, R: Rule> LastStep for Query<'_, T, R> {
    const PURPOSE: Purpose = Purpose::Query;

    #[inline(always)]
    fn take(&mut self, batch: &Batch, alive: &Alive, tally: &mut Tally) -> bool {
        let (t, buffer) = (self.t, self.buffer);
        for lane in bits(alive.lanes) {
            let nearest = t.f(batch.nearest[lane]);
            let columns = (t.i(batch.column0[lane] as i32), t.i(batch.column1[lane] as i32));
            let open = |least: T::F| t.le(least, nearest);
            for_each_tile!(
                t,
                buffer,
                buffer.all_tiles(),
                batch,
                lane,
                |least| open(least),
                |x, y, index, strip, plane| {
                    // Edges that are nearly horizontal reach beyond the corners; the box does not.
                    let box_strip = Strip::<T> { left: columns.0, right: columns.1 };
                    let mut touched = t.and(strip.coverage(t, x), box_strip.coverage(t, x));
                    if let Some(outside) = buffer.border(x, y) {
                        // SAFETY: eight words.
                        touched = t.and_not(unsafe { t.load_i(outside.as_ptr()) }, touched);
                    }
                    let depth = t.min(plane, t.f(batch.z_clamp[lane]));
                    tally.traversed += 1;
                    // SAFETY: as above; the buffer was made for the rule `R`.
                    let visible = if unsafe { *buffer.least().add(index) } == UNTOUCHED {
                        t.mask_bits(t.eq_i(touched, t.i(0))) != 0xff
                    } else {
                        let planes = unsafe { R::load(t, buffer.tile(index)) };
                        t.mask_bits(R::hides(t, &planes, touched, depth)) != 0xff
                    };
                    if visible {
                        tally.rasterized += u64::from((alive.rasterized & ((2 << lane) - 1)).count_ones());
                        return false;
                    }
                }
            );
        }
        tally.rasterized += u64::from(alive.rasterized.count_ones());
        true
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
            let triangle = core::array::from_fn(|k| batch.corners[k][lane]);
            // The last bin takes what division leaves over.
            let column = |tile: u32| (tile / wide).min(self.bins.0 - 1);
            let row = |tile: u32| (tile / high).min(self.bins.1 - 1);
            for y in row(batch.tile_y0[lane])..=row(batch.tile_y1[lane]) {
                for x in column(batch.tile_x0[lane])..=column(batch.tile_x1[lane]) {
                    self.full |= !self.lists[(y * self.bins.0 + x) as usize].push(&triangle);
                }
            }
        }
        true
    }
}
