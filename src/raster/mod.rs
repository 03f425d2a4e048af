//! Rasterises vectors of triangles: set-up, the tile rows that they reach, and an operation in each tile.

pub(crate) mod batch;
pub(crate) mod hiz_test;
pub(crate) mod queue;
pub(crate) mod setup;
mod tile_op;
mod tile_rows;
pub(crate) mod traverse;
mod wide_edges;

pub(crate) use batch::Batch;
pub(crate) use hiz_test::HizScope;
pub(crate) use queue::TriangleQueue;
pub(crate) use setup::{Alive, Setup};
pub(crate) use tile_op::TileOp;
pub(crate) use tile_rows::MAX_TILES;
pub(crate) use traverse::traverse;

/// The positions of the set bits of a mask.
pub(crate) fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    core::iter::from_fn(move || {
        (mask != 0).then(|| {
            let bit = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            bit
        })
    })
}
