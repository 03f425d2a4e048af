//! Divides a buffer into bins: rectangles of whole coarse HiZ cells (128x64 pixels), so that each bin refreshes its own
//! cells and no two bins share a block.

use crate::buffer::TileRect;
use crate::buffer::hiz::{COARSE_TILES_H, COARSE_TILES_W};
use crate::sink::BinBounds;

/// The bins, row by row.
pub(super) struct Grid {
    /// Where the columns and rows begin, in tiles, followed by where the last one ends.
    columns: Vec<u32>,
    rows: Vec<u32>,
    bounds: BinBounds,
}

impl Grid {
    /// Makes bins as equal as cells allow: `bins_w * bins_h` of them, but no more than `most` or than there are cells.
    ///
    /// Rows are divided first: `z_min` of a row of tiles is contiguous, and threads drawing side by side would write to
    /// the same cache lines.
    pub fn new(tiles: TileRect, bins_w: u32, bins_h: u32, most: u32) -> Self {
        let bins = bins_w.max(1).saturating_mul(bins_h.max(1)).min(most.max(1));
        let rows = tiles.y1.div_ceil(COARSE_TILES_H);
        let (bins_w, bins_h) = (bins / bins.min(rows), bins.min(rows));
        let cut = |tiles: u32, bins: u32, cell: u32| -> Vec<u32> {
            let cells = tiles.div_ceil(cell);
            let bins = bins.clamp(1, cells);
            let begin = |k: u32| (u64::from(k) * u64::from(cells) / u64::from(bins)) as u32 * cell;
            (0..bins).map(begin).chain([tiles]).collect()
        };
        let (columns, rows) = (cut(tiles.x1, bins_w, COARSE_TILES_W), cut(tiles.y1, bins_h, COARSE_TILES_H));
        Self { bounds: BinBounds::new(&columns, &rows), columns, rows }
    }

    pub fn bounds(&self) -> &BinBounds {
        &self.bounds
    }

    pub fn len(&self) -> usize {
        (self.columns.len() - 1) * (self.rows.len() - 1)
    }

    /// The number of columns and rows.
    pub fn count(&self) -> (u32, u32) {
        (self.columns.len() as u32 - 1, self.rows.len() as u32 - 1)
    }

    /// The tiles of a bin.
    pub fn tiles(&self, bin: usize) -> TileRect {
        let (x, y) = (bin % (self.columns.len() - 1), bin / (self.columns.len() - 1));
        TileRect { x0: self.columns[x], y0: self.rows[y], x1: self.columns[x + 1], y1: self.rows[y + 1] }
    }

    /// The bins that contain a tile of a rectangle, in order.
    pub fn touched(&self, tiles: TileRect) -> impl Iterator<Item = usize> {
        let among = |cuts: &[u32], first: u32, end: u32| {
            let bin = |tile: u32| cuts.partition_point(|&begin| begin <= tile).clamp(1, cuts.len() - 1) - 1;
            bin(first)..bin(end.saturating_sub(1).max(first)) + 1
        };
        let (columns, wide) = (among(&self.columns, tiles.x0, tiles.x1), self.columns.len() - 1);
        among(&self.rows, tiles.y0, tiles.y1).flat_map(move |y| columns.clone().map(move |x| y * wide + x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_cover_every_tile_once_and_begin_with_coarse_cells() {
        for (w, h) in [(1, 1), (60, 135), (512, 2048), (5, 9), (4, 8)] {
            for (bins_w, bins_h, most) in
                [(1, 1, 9), (4, 4, 16), (4, 4, 8), (3, 7, 1), (u32::MAX, u32::MAX, 100), (0, 0, 4)]
            {
                let grid = Grid::new(TileRect { x0: 0, y0: 0, x1: w, y1: h }, bins_w, bins_h, most);
                assert!(grid.len() as u32 <= most);
                let mut seen = vec![0; (w * h) as usize];
                for bin in 0..grid.len() {
                    let t = grid.tiles(bin);
                    assert!(t.x0.is_multiple_of(COARSE_TILES_W) && t.y0.is_multiple_of(COARSE_TILES_H));
                    assert!(t.x0 < t.x1 && t.y0 < t.y1);
                    for (x, y) in (t.y0..t.y1).flat_map(|y| (t.x0..t.x1).map(move |x| (x, y))) {
                        seen[(y * w + x) as usize] += 1;
                        let one = TileRect { x0: x, y0: y, x1: x + 1, y1: y + 1 };
                        assert!(grid.touched(one).eq([bin]));
                    }
                }
                assert!(seen.iter().all(|&n| n == 1));
                let all = TileRect { x0: 0, y0: 0, x1: w, y1: h };
                assert!(grid.touched(all).eq(0..grid.len()));
            }
        }
    }
}
