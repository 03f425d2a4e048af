//! CPU occlusion culling on a masked hierarchical depth buffer.
#![warn(missing_docs)]
#![deny(unsafe_op_in_unsafe_fn)]

mod allocator;
mod bins;
mod buffer;
pub mod capi;
mod culling;
mod error;
mod pipeline;
mod rectangle;
mod simd;
mod statistics;
mod transform;
mod types;
mod vertices;

pub use allocator::Allocator;
pub use bins::TriList;
pub use culling::{DrawOptions, MaskedOcclusionCulling, Settings};
pub use error::Error;
pub use transform::transform_vertices;
pub use types::{
    BackfaceWinding, ClipPlanes, CullingResult, Implementation, OccludeeStatistics, OccluderStatistics, ScissorRect,
    Statistics, UpdateRule, VertexLayout, YAxis,
};
pub use vertices::Vertices;

/// The README's program is tested.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
