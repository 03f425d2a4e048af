//! Triangles that are projected once and drawn later, in pieces of the screen: what threads hand to each other.
//!
//! All that survives is kept in order, in vectors, and with each vector, for each piece of the screen, which of its triangles
//! reach it. Survivors of several meshes share the vectors of setup, which a mesh of a dozen triangles drawn by itself does not
//! fill.

use super::batch::Batch;
use super::boxes::{Boxes, Look};
use super::last_step::{All, LastStep, take_survivors};
use super::scratch::MAX_LANES;
use super::setup::{Alive, Purpose, Setup};
use super::survivors::{Corner, ROOM, Survivors};
use crate::buffer::{Buffer, TILE_HEIGHT, TILE_WIDTH, TileRect};
use crate::simd::Simd;
use crate::statistics::Tally;

/// Pieces of the screen, in columns and rows: from and to of each, in 1/256 pixel.
pub(crate) struct Cuts {
    columns: Vec<[f32; 2]>,
    rows: Vec<[f32; 2]>,
}

impl Cuts {
    /// Columns and rows, in tiles, begin and end at these.
    pub fn new(columns: &[u32], rows: &[u32]) -> Self {
        let spans = |cuts: &[u32], size: u32| -> Vec<[f32; 2]> {
            cuts.windows(2).map(|cut| [cut[0], cut[1]].map(|tiles| (256 * tiles * size) as f32)).collect()
        };
        Self { columns: spans(columns, TILE_WIDTH), rows: spans(rows, TILE_HEIGHT) }
    }

    fn pieces(&self) -> usize {
        self.columns.len() * self.rows.len()
    }
}

/// Triangles on the screen, in order.
#[derive(Default)]
pub(crate) struct Kept {
    blocks: Vec<Block>,
    /// Blocks in use; the others wait to be used again.
    used: usize,
}

/// No instruction set has shorter vectors in the pipeline.
const VECTORS: usize = ROOM / 8;

/// A vector's loads touch one cache line each, or two.
#[repr(align(64))]
struct Corners([f32; 9 * ROOM]);

/// Triangles that have to be asked alike whether they face the eye.
struct Block {
    /// Vector by vector, x, y and 1/w of the three corners: one stream to write and to read, of which a piece of the screen
    /// leaves out parts.
    corners: Box<Corners>,
    both_sides: bool,
    vectors: usize,
    /// For each piece of the screen, for each vector, the triangles that reach it.
    reach: Vec<u16>,
}

impl Block {
    fn range(k: usize, lanes: usize) -> core::ops::Range<usize> {
        9 * lanes * k..9 * lanes * (k + 1)
    }

    #[inline(always)]
    fn vector(&self, k: usize, lanes: usize) -> &[f32] {
        &self.corners.0[Self::range(k, lanes)]
    }

    #[inline(always)]
    fn vector_mut(&mut self, k: usize, lanes: usize) -> &mut [f32] {
        &mut self.corners.0[Self::range(k, lanes)]
    }
}

impl Kept {
    /// Forgets the triangles; the memory stays.
    pub fn clear(&mut self) {
        self.used = 0;
    }

    /// A block with room for a vector.
    #[inline(always)]
    fn open(&mut self, both_sides: bool, pieces: usize, lanes: usize) -> &mut Block {
        let fits = |block: &Block| block.both_sides == both_sides && (block.vectors + 1) * lanes <= ROOM;
        if self.used == 0 || !fits(&self.blocks[self.used - 1]) {
            self.next_block(both_sides, pieces);
        }
        &mut self.blocks[self.used - 1]
    }

    #[cold]
    fn next_block(&mut self, both_sides: bool, pieces: usize) {
        if self.used == self.blocks.len() {
            let corners = Box::new(Corners([0.0; 9 * ROOM]));
            self.blocks.push(Block { corners, both_sides, vectors: 0, reach: Vec::new() });
        }
        let block = &mut self.blocks[self.used];
        (block.both_sides, block.vectors) = (both_sides, 0);
        block.reach.resize(pieces * VECTORS, 0);
        self.used += 1;
    }
}

/// The last step that keeps triangles.
pub(super) struct Keep<'a> {
    kept: &'a mut Kept,
    cuts: &'a Cuts,
    /// What the buffer hides already is left out. Other threads may be drawing.
    sift: bool,
}

impl<'a> Keep<'a> {
    #[inline(always)]
    pub fn new(kept: &'a mut Kept, cuts: &'a Cuts, sift: bool) -> Self {
        Self { kept, cuts, sift }
    }
}

impl LastStep for Keep<'_> {
    const PURPOSE: Purpose = Purpose::Draw;
    const KEEPS: bool = true;

    #[inline(always)]
    fn keep<S: Simd>(&mut self, setup: Setup<'_, S>, corners: &[Corner<S>; 3], active: S::M) {
        const { assert!(S::LANES * VECTORS >= ROOM) }
        let Setup { s, buffer, .. } = setup;
        let [a, b, c] = corners;
        let mut open = active;
        if self.sift {
            let boxes = Boxes::new(s, buffer, Purpose::Draw, corners);
            // SAFETY: whoever draws meanwhile stores least depths as words, in which old ones are safe.
            let hidden = unsafe { boxes.hidden::<true>(s, buffer, setup.look, Purpose::Draw) };
            open = s.and_not_m(hidden, s.and_m(active, boxes.inside));
        }
        let bits = s.mask_bits(open);
        if bits == 0 {
            return;
        }
        // All lanes are stored: who draws a piece closes the gaps, for it takes some lanes only anyway.
        let block = self.kept.open(setup.both_sides, self.cuts.pieces(), S::LANES);
        let k = block.vectors;
        block.vectors += 1;
        let kept = |m: S::M| (s.mask_bits(m) & bits) as u16;
        let within = |[from, to]: [f32; 2], low: S::F, high: S::F| s.and_m(s.le(s.f(from), high), s.le(low, s.f(to)));
        let low = |axis: usize| s.min(a[axis], s.min(b[axis], c[axis]));
        let high = |axis: usize| s.max(a[axis], s.max(b[axis], c[axis]));
        let (x0, x1, y0, y1) = (low(0), high(0), low(1), high(1));
        for (column, &span) in self.cuts.columns.iter().enumerate() {
            let reach = kept(within(span, x0, x1));
            for row in 0..self.cuts.rows.len() {
                block.reach[(row * self.cuts.columns.len() + column) * VECTORS + k] = reach;
            }
        }
        for (row, &span) in self.cuts.rows.iter().enumerate() {
            let reach = kept(within(span, y0, y1));
            for column in 0..self.cuts.columns.len() {
                block.reach[(row * self.cuts.columns.len() + column) * VECTORS + k] &= reach;
            }
        }
        let to = block.vector_mut(k, S::LANES).as_mut_ptr();
        for (n, &x) in corners.as_flattened().iter().enumerate() {
            // SAFETY: there is room for nine vectors.
            unsafe { s.store_f(to.add(n * S::LANES), x) };
        }
    }

    #[inline(always)]
    fn take(&mut self, _: &Batch, _: &Alive, _: &mut Tally) -> bool {
        true
    }
}

/// Draws what overlaps a rectangle of tiles.
#[inline(always)]
pub(super) fn draw<'k, S: Simd, L: LastStep>(
    s: S,
    buffer: &Buffer,
    kept: impl Iterator<Item = &'k Kept>,
    (clip, piece): (TileRect, usize),
    last: &mut L,
) -> Tally {
    let mut survivors = Survivors::uninit();
    let survivors = Survivors::of(&mut survivors);
    let mut batch = Batch::uninit();
    let look = Look { clip, areas: true };
    let mut setup = Setup { s, purpose: L::PURPOSE, buffer, both_sides: false, look };
    let mut tally = Tally::default();
    for block in kept.flat_map(|kept| &kept.blocks[..kept.used]) {
        if block.both_sides != setup.both_sides {
            take_survivors(setup, survivors, None, All::Yes, &mut batch, last, &mut tally);
            setup.both_sides = block.both_sides;
        }
        let reach = &block.reach[piece * VECTORS..][..block.vectors];
        for (k, &reach) in reach.iter().enumerate() {
            if reach == 0 {
                continue;
            }
            let from = block.vector(k, S::LANES).as_ptr();
            // SAFETY: nine vectors are there.
            let load = |n: usize| unsafe { s.load_f(from.add(n * S::LANES)) };
            let corners = [[load(0), load(1), load(2)], [load(3), load(4), load(5)], [load(6), load(7), load(8)]];
            // SAFETY: below a vector less than `ROOM` there is room.
            unsafe { survivors.append(s, lanes_of(s, u32::from(reach)), &corners) };
            if survivors.len() > ROOM - MAX_LANES {
                take_survivors(setup, survivors, None, All::No, &mut batch, last, &mut tally);
            }
        }
    }
    take_survivors(setup, survivors, None, All::Yes, &mut batch, last, &mut tally);
    tally
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
