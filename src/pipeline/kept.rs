//! Triangles that are projected once and drawn later, in pieces of the screen: what threads hand to each other.
//!
//! All that survives is kept in order, in blocks of vectors. Whoever draws a piece of the screen passes through all of it and takes
//! what overlaps, which costs some fifteen cycles a vector; lists for each piece would have to be written triangle by
//! triangle. Survivors of several meshes share the vectors of setup, which a mesh of a dozen triangles drawn by itself does
//! not fill.

use super::batch::{Batch, Lanes};
use super::last_step::{All, LastStep, take_survivors};
use super::scratch::MAX_LANES;
use super::setup::{Alive, Purpose, Setup};
use super::survivors::{Corner, ROOM, Survivors};
use crate::buffer::{Buffer, TILE_HEIGHT, TILE_WIDTH, TileRect};
use crate::simd::Simd;
use crate::statistics::Tally;

/// Triangles on the screen, in order.
#[derive(Default)]
pub(crate) struct Kept {
    blocks: Vec<Block>,
    /// Blocks in use; the others wait to be used again.
    used: usize,
}

struct Block {
    survivors: Box<Survivors>,
    /// A box around all of them: x and y from, x and y to, in 1/256 pixel.
    bounds: [f32; 4],
}

const NOWHERE: [f32; 4] = [f32::MAX, f32::MAX, f32::MIN, f32::MIN];

impl Kept {
    /// Forgets the triangles; the memory stays.
    pub fn clear(&mut self) {
        self.used = 0;
    }

    /// A block with room for a vector.
    #[inline(always)]
    fn open<S: Simd>(&mut self) -> &mut Block {
        let full = self.used == 0 || self.blocks[self.used - 1].survivors.len() + S::LANES > ROOM;
        if full {
            self.next_block();
        }
        &mut self.blocks[self.used - 1]
    }

    #[cold]
    fn next_block(&mut self) {
        if self.used == self.blocks.len() {
            self.blocks.push(Block { survivors: Survivors::boxed(), bounds: NOWHERE });
        }
        let block = &mut self.blocks[self.used];
        block.survivors.clear();
        block.bounds = NOWHERE;
        self.used += 1;
    }
}

/// The last step that keeps triangles.
pub(super) struct Keep<'a, S> {
    s: S,
    kept: &'a mut Kept,
}

impl<'a, S: Simd> Keep<'a, S> {
    #[inline(always)]
    pub fn new(s: S, kept: &'a mut Kept) -> Self {
        Self { s, kept }
    }
}

impl<S: Simd> LastStep for Keep<'_, S> {
    const PURPOSE: Purpose = Purpose::Bin;

    #[inline(always)]
    fn take(&mut self, batch: &Batch, alive: &Alive, tally: &mut Tally) -> bool {
        let s = self.s;
        tally.rasterized += u64::from(alive.rasterized.count_ones());
        // SAFETY: setup stores the corners of triangles that are to be kept; the arrays hold a vector.
        let of = |lanes: &Lanes<f32>| unsafe { s.load_f(lanes.as_ptr()) };
        let c = batch.corners.each_ref().map(of);
        let corners = [[c[0], c[1], c[2]], [c[3], c[4], c[5]], [c[6], c[7], c[8]]];
        let lanes = lanes_of(s, alive.lanes);
        let block = self.kept.open::<S>();
        // SAFETY: the block has room for a vector.
        unsafe { block.survivors.append(s, lanes, &corners) };
        let [from_x, from_y, to_x, to_y] = around(s, &corners);
        let [x0, y0, x1, y1] = block.bounds;
        block.bounds = [
            x0.min(least(s, s.select(lanes, from_x, s.f(f32::MAX)))),
            y0.min(least(s, s.select(lanes, from_y, s.f(f32::MAX)))),
            x1.max(-least(s, s.select(lanes, s.sub(s.f(0.0), to_x), s.f(f32::MAX)))),
            y1.max(-least(s, s.select(lanes, s.sub(s.f(0.0), to_y), s.f(f32::MAX)))),
        ];
        true
    }
}

/// Draws what overlaps a rectangle of tiles.
#[inline(always)]
pub(super) fn draw<'k, S: Simd, L: LastStep>(
    s: S,
    buffer: &Buffer,
    kept: impl Iterator<Item = &'k Kept>,
    clip: TileRect,
    last: &mut L,
) -> Tally {
    let mut survivors = Survivors::uninit();
    let survivors = Survivors::of(&mut survivors);
    let mut batch = Batch::uninit();
    // The corners were put in order when the triangles were kept.
    let setup = Setup { s, purpose: L::PURPOSE, buffer, both_sides: false, clip, areas: true };
    let mut tally = Tally::default();
    let pixels = |tiles: u32, size: u32| (256 * tiles * size) as f32;
    let from = [pixels(clip.x0, TILE_WIDTH), pixels(clip.y0, TILE_HEIGHT)];
    let to = [pixels(clip.x1, TILE_WIDTH), pixels(clip.y1, TILE_HEIGHT)];
    for block in kept.flat_map(|kept| &kept.blocks[..kept.used]) {
        let [x0, y0, x1, y1] = block.bounds;
        if x1 < from[0] || y1 < from[1] || x0 > to[0] || y0 > to[1] {
            continue;
        }
        let mut first = 0;
        while first < block.survivors.len() {
            let corners = block.survivors.loaded(s, first);
            let [x0, y0, x1, y1] = around(s, &corners);
            let across = s.and_m(s.le(s.f(from[0]), x1), s.le(x0, s.f(to[0])));
            let down = s.and_m(s.le(s.f(from[1]), y1), s.le(y0, s.f(to[1])));
            let overlap = s.and_m(s.first(block.survivors.len() - first), s.and_m(across, down));
            // SAFETY: below a vector less than `ROOM` there is room.
            unsafe { survivors.append(s, overlap, &corners) };
            first += S::LANES;
            if survivors.len() > ROOM - MAX_LANES {
                take_survivors(setup, survivors, None, All::No, &mut batch, last, &mut tally);
            }
        }
    }
    take_survivors(setup, survivors, None, All::Yes, &mut batch, last, &mut tally);
    tally
}

/// Boxes around the triangles of a vector: x and y from, x and y to.
#[inline(always)]
fn around<S: Simd>(s: S, [a, b, c]: &[Corner<S>; 3]) -> [S::F; 4] {
    let low = |k: usize| s.min(a[k], s.min(b[k], c[k]));
    let high = |k: usize| s.max(a[k], s.max(b[k], c[k]));
    [low(0), low(1), high(0), high(1)]
}

/// The least lane.
#[inline(always)]
fn least<S: Simd>(s: S, x: S::F) -> f32 {
    let mut lanes = [f32::MAX; MAX_LANES];
    // SAFETY: the array holds a vector.
    unsafe { s.store_f(lanes.as_mut_ptr(), x) };
    let mut least = f32::MAX;
    for lane in lanes {
        least = least.min(lane);
    }
    least
}

/// A mask of the lanes whose bits are set.
#[inline(always)]
fn lanes_of<S: Simd>(s: S, bits: u32) -> S::M {
    const BITS: [u32; MAX_LANES] = {
        let mut bits = [0; MAX_LANES];
        let mut k = 0;
        while k < MAX_LANES {
            bits[k] = 1 << k;
            k += 1;
        }
        bits
    };
    // SAFETY: the array holds a vector.
    let powers = unsafe { s.load_i(BITS.as_ptr()) };
    s.eq_i(s.and(s.i(bits as i32), powers), powers)
}
