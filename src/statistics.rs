//! Counters to which each call adds once, at its end, from whichever thread it ran on.

use core::sync::atomic::{AtomicI64, Ordering::Relaxed};

use crate::{OccludeeStatistics, OccluderStatistics, Statistics};

/// The counts of one call, kept in registers until it ends.
#[derive(Clone, Copy, Default)]
pub(crate) struct Tally {
    pub processed: u64,
    pub rasterized: u64,
    pub traversed: u64,
    pub updated: u64,
    pub merged: u64,
    pub dropped: u64,
}

#[derive(Default)]
pub(crate) struct Counters {
    occluders: [AtomicI64; 6],
    occludees: [AtomicI64; 4],
}

impl Counters {
    /// `all`: count everything, not only the dropped triangles.
    pub fn add_draw(&self, all: bool, t: &Tally) {
        add(&self.occluders, draw_counts(all, t));
    }

    /// The same without atomic additions, which are as expensive as a tile's depth test.
    pub fn add_draw_alone(&mut self, all: bool, t: &Tally) {
        for (counter, n) in self.occluders.iter_mut().zip(draw_counts(all, t)) {
            *counter.get_mut() += n as i64;
        }
    }

    /// `all`: count anything at all.
    #[inline]
    pub fn add_query(&self, all: bool, rectangles: u64, t: &Tally) {
        if all {
            add(&self.occludees, [rectangles, t.processed, t.rasterized, t.traversed]);
        }
    }

    pub fn snapshot(&self) -> Statistics {
        let d = self.occluders.each_ref().map(|c| c.load(Relaxed));
        let q = self.occludees.each_ref().map(|c| c.load(Relaxed));
        Statistics {
            occluders: OccluderStatistics {
                num_processed_triangles: d[0],
                num_rasterized_triangles: d[1],
                num_tiles_traversed: d[2],
                num_tiles_updated: d[3],
                num_tiles_merged: d[4],
                num_dropped_triangles: d[5],
            },
            occludees: OccludeeStatistics {
                num_processed_rectangles: q[0],
                num_processed_triangles: q[1],
                num_rasterized_triangles: q[2],
                num_tiles_traversed: q[3],
            },
        }
    }
}

/// Adds the counts of a draw.
#[inline]
fn draw_counts(all: bool, t: &Tally) -> [u64; 6] {
    if all {
        [t.processed, t.rasterized, t.traversed, t.updated, t.merged, t.dropped]
    } else {
        [0, 0, 0, 0, 0, t.dropped]
    }
}

/// Skips zeros, because an atomic addition is as expensive as a tile's depth test.
#[inline]
fn add<const N: usize>(counters: &[AtomicI64; N], counts: [u64; N]) {
    for (counter, n) in counters.iter().zip(counts) {
        if n != 0 {
            counter.fetch_add(n as i64, Relaxed);
        }
    }
}
