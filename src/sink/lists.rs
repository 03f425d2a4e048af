//! Appends triangles to lists, one per bin of the screen.

use super::{Memory, TriangleSink};
use crate::bins::TriList;
use crate::buffer::{TILE_HEIGHT, TILE_WIDTH};
use crate::geometry::{Corner, Exact};
use crate::raster::{Setup, bits, setup};
use crate::simd::Simd;
use crate::statistics::Tally;

/// Appends triangles to the list of every bin that their bounds reach.
pub(crate) struct AppendToLists<'b, 'c> {
    lists: &'b mut [TriList<'c>],
    bin_size: (u32, u32),
    bins: (u32, u32),
    /// Set if a list was full.
    full: &'b mut bool,
}

impl<'b, 'c> AppendToLists<'b, 'c> {
    /// `bins.0` by `bins.1` lists, row by row, for bins of `bin_size` pixels.
    pub fn new(lists: &'b mut [TriList<'c>], bin_size: (u32, u32), bins: (u32, u32), full: &'b mut bool) -> Self {
        assert_eq!(lists.len() as u64, u64::from(bins.0) * u64::from(bins.1));
        Self { lists, bin_size, bins, full }
    }
}

impl TriangleSink for AppendToLists<'_, '_> {
    type Coverage = Exact;
    type Memory = ();

    #[inline(always)]
    fn submit<S: Simd>(
        &mut self,
        setup: Setup<'_, S>,
        corners: [Corner<S>; 3],
        active: S::M,
        memory: &mut Memory<()>,
        tally: &mut Tally,
    ) -> bool {
        let batch = &mut memory.batch;
        let rasterized = setup::orient::<S, Exact>(setup, corners, active, batch);
        tally.rasterized += u64::from(rasterized.count_ones());
        let (wide, high) = (self.bin_size.0 / TILE_WIDTH, self.bin_size.1 / TILE_HEIGHT);
        for lane in bits(rasterized) {
            // SAFETY: `orient` stores the corners.
            let triangle = batch.corners.each_ref().map(|x| unsafe { x.get(lane) });
            // SAFETY: `orient` stored the batch.
            let [x0, x1, y0, y1] = unsafe { batch.tiles(lane) };
            // The last column and row of bins extend to the screen's edge.
            let column = |tile: u32| (tile / wide).min(self.bins.0 - 1);
            let row = |tile: u32| (tile / high).min(self.bins.1 - 1);
            for y in row(y0)..=row(y1) {
                for x in column(x0)..=column(x1) {
                    *self.full |= !self.lists[(y * self.bins.0 + x) as usize].push(&triangle);
                }
            }
        }
        true
    }
}
