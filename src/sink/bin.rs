//! Bins triangles for the pool: they are projected once and drawn later, bin by bin, by whichever thread takes the bin.
//!
//! All survivors are stored in order, as vectors, and each vector comes with a mask per bin of the triangles that may
//! reach that bin. Survivors of several meshes share set-up vectors, which a mesh of a dozen triangles drawn by itself
//! would not fill.

use super::{Memory, TriangleSink};
use crate::buffer::{TILE_HEIGHT, TILE_WIDTH};
use crate::geometry::{Corner, Exact, ScreenBounds};
use crate::raster::queue::CAPACITY;
use crate::raster::{HizScope, Setup, hiz_test};
use crate::simd::Simd;
use crate::statistics::Tally;

/// The bins of a screen, by column and row: start and end of each, in 1/256 pixel.
pub(crate) struct BinBounds {
    columns: Vec<[f32; 2]>,
    rows: Vec<[f32; 2]>,
}

impl BinBounds {
    /// Columns and rows start and end at these tiles.
    pub fn new(columns: &[u32], rows: &[u32]) -> Self {
        let spans = |ends: &[u32], size: u32| -> Vec<[f32; 2]> {
            ends.windows(2).map(|pair| [pair[0], pair[1]].map(|tiles| (256 * tiles * size) as f32)).collect()
        };
        Self { columns: spans(columns, TILE_WIDTH), rows: spans(rows, TILE_HEIGHT) }
    }

    fn len(&self) -> usize {
        self.columns.len() * self.rows.len()
    }
}

/// Projected triangles, in order, and the bins that each may reach.
#[derive(Default)]
pub(crate) struct BinnedTriangles {
    blocks: Vec<Block>,
    /// Number of blocks in use; the others are kept for reuse.
    used: usize,
}

/// Vectors per block: a vector has at least eight lanes.
pub(crate) const VECTORS: usize = CAPACITY / 8;

/// Aligned so that a vector's loads touch one or two cache lines each.
#[repr(align(64))]
struct Corners([f32; 9 * CAPACITY]);

/// Triangles that are either all two-sided or all one-sided.
pub(crate) struct Block {
    /// Vector by vector, x, y and 1/w of the three corners: one stream, in which a bin skips parts.
    corners: Box<Corners>,
    pub both_sides: bool,
    pub vectors: usize,
    /// For each bin and each vector, the triangles that may reach the bin.
    reach: Vec<u16>,
}

impl Block {
    fn range(k: usize, lanes: usize) -> core::ops::Range<usize> {
        9 * lanes * k..9 * lanes * (k + 1)
    }

    #[inline(always)]
    pub fn vector(&self, k: usize, lanes: usize) -> &[f32] {
        &self.corners.0[Self::range(k, lanes)]
    }

    /// For each vector, the triangles that may reach a bin.
    #[inline(always)]
    pub fn reach(&self, bin: usize) -> &[u16] {
        &self.reach[bin * VECTORS..][..self.vectors]
    }

    #[inline(always)]
    fn vector_mut(&mut self, k: usize, lanes: usize) -> &mut [f32] {
        &mut self.corners.0[Self::range(k, lanes)]
    }
}

impl BinnedTriangles {
    pub fn blocks(&self) -> &[Block] {
        &self.blocks[..self.used]
    }

    /// Removes the triangles but keeps the memory.
    pub fn clear(&mut self) {
        self.used = 0;
    }

    /// A block with room for a vector.
    #[inline(always)]
    fn open(&mut self, both_sides: bool, bins: usize, lanes: usize) -> &mut Block {
        let fits = |block: &Block| block.both_sides == both_sides && (block.vectors + 1) * lanes <= CAPACITY;
        if self.used == 0 || !fits(&self.blocks[self.used - 1]) {
            self.next_block(both_sides, bins);
        }
        &mut self.blocks[self.used - 1]
    }

    #[cold]
    fn next_block(&mut self, both_sides: bool, bins: usize) {
        if self.used == self.blocks.len() {
            let corners = Box::new(Corners([0.0; 9 * CAPACITY]));
            self.blocks.push(Block { corners, both_sides, vectors: 0, reach: Vec::new() });
        }
        let block = &mut self.blocks[self.used];
        (block.both_sides, block.vectors) = (both_sides, 0);
        block.reach.resize(bins * VECTORS, 0);
        self.used += 1;
    }
}

/// Bins triangles for the pool.
pub(crate) struct Bin<'a> {
    binned: &'a mut BinnedTriangles,
    bounds: &'a BinBounds,
    /// Leave out triangles that the buffer already hides, while other threads may be drawing into it.
    prefilter: bool,
}

impl<'a> Bin<'a> {
    #[inline(always)]
    pub fn new(binned: &'a mut BinnedTriangles, bounds: &'a BinBounds, prefilter: bool) -> Self {
        Self { binned, bounds, prefilter }
    }
}

impl TriangleSink for Bin<'_> {
    type Coverage = Exact;
    type Memory = ();

    #[inline(always)]
    fn submit<S: Simd>(
        &mut self,
        setup: Setup<'_, S>,
        corners: [Corner<S>; 3],
        active: S::M,
        _: &mut Memory<()>,
        _: &mut Tally,
    ) -> bool {
        const { assert!(S::LANES * VECTORS >= CAPACITY) }
        let Setup { s, buffer, .. } = setup;
        let [a, b, c] = &corners;
        let mut open = active;
        if self.prefilter {
            let bounds = ScreenBounds::new::<Exact>(s, buffer.size(), &corners);
            let scope = HizScope { clip: buffer.all_tiles(), coarse: true };
            // SAFETY: threads that are drawing meanwhile store `z_min` word by word.
            let hidden = unsafe { hiz_test::hidden::<S, Exact, true>(s, buffer, scope, &bounds) };
            open = s.and_not_m(hidden, s.and_m(active, bounds.inside));
        }
        let bits = s.mask_bits(open);
        if bits == 0 {
            return true;
        }
        // All lanes are stored; a bin only reads those in its mask.
        let block = self.binned.open(setup.both_sides, self.bounds.len(), S::LANES);
        let k = block.vectors;
        block.vectors += 1;
        let reached = |m: S::M| (s.mask_bits(m) & bits) as u16;
        let within = |[from, to]: [f32; 2], low: S::F, high: S::F| s.and_m(s.le(s.f(from), high), s.le(low, s.f(to)));
        let low = |axis: usize| s.min(a[axis], s.min(b[axis], c[axis]));
        let high = |axis: usize| s.max(a[axis], s.max(b[axis], c[axis]));
        let (x0, x1, y0, y1) = (low(0), high(0), low(1), high(1));
        for (column, &span) in self.bounds.columns.iter().enumerate() {
            let reach = reached(within(span, x0, x1));
            for row in 0..self.bounds.rows.len() {
                block.reach[(row * self.bounds.columns.len() + column) * VECTORS + k] = reach;
            }
        }
        for (row, &span) in self.bounds.rows.iter().enumerate() {
            let reach = reached(within(span, y0, y1));
            for column in 0..self.bounds.columns.len() {
                block.reach[(row * self.bounds.columns.len() + column) * VECTORS + k] &= reach;
            }
        }
        let to = block.vector_mut(k, S::LANES).as_mut_ptr();
        for (n, &x) in corners.as_flattened().iter().enumerate() {
            // SAFETY: there is room for nine vectors.
            unsafe { s.store_f(to.add(n * S::LANES), x) };
        }
        true
    }
}
