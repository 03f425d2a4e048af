//! CPU occlusion culling on a masked hierarchical depth buffer.
//!
//! Draw a scene's large occluders into a [`MaskedOcclusionCulling`], then ask of each object, by a rectangle or
//! by its triangles, whether any of it could be seen. An answer of [`CullingResult::Occluded`] is certain; any
//! doubt is answered [`CullingResult::Visible`].
//!
//! The buffer keeps no depth a pixel. Of each sub-tile of 8x4 pixels it keeps a reference depth, which no pixel is
//! behind, and one to three working layers, each a depth and a mask of the pixels that it speaks for; triangles are
//! taken in by one of four [`UpdateRule`]s (Hasselgren, Andersson, Akenine-Möller: "Masked Software Occlusion
//! Culling", HPG 2016). Depth is 1/w: 0 is infinitely far, larger is nearer.
//!
//! Coverage is exact: vertices are snapped to 1/256 pixel, and a pixel is covered when its centre is, by the top-left
//! rule. Every instruction set (see [`Implementation`]) gives the same bits.
//!
//! The way of a triangle is told in `src/pipeline/mod.rs`, the memory's layout in `src/buffer/mod.rs`, the vector
//! layer in `src/simd/mod.rs`. The C interface is in [`capi`]; C and C++ include what is in `include/`.
#![warn(missing_debug_implementations, missing_docs)]
#![deny(unsafe_op_in_unsafe_fn)]

mod allocator;
mod attachment;
mod bins;
mod buffer;
#[cfg(feature = "capi")]
pub mod capi;
mod culling;
mod error;
mod float_environment;
mod matrix;
mod pipeline;
mod pool;
mod recorder;
mod rectangle;
mod settings;
mod simd;
mod statistics;
mod transform;
mod types;
mod vertices;

/// The version of glam whose `Mat4` can be passed as a [`Matrix`].
#[cfg(feature = "glam")]
pub use glam;

pub use allocator::Allocator;
pub use bins::TriList;
pub use culling::MaskedOcclusionCulling;
pub use error::Error;
pub use matrix::Matrix;
pub use pool::{CullingThreadpool, Scope, ThreadStart, ThreadpoolSettings};
pub use recorder::{RecordedCall, RecordedMesh, RecordedRect, Recording, RecordingError};
pub use settings::{DrawOptions, Settings};
pub use transform::transform_vertices;
pub(crate) use types::VertexLayout;
pub use types::{
    BackfaceWinding, ClipPlanes, CullingResult, Implementation, OccludeeStatistics, OccluderStatistics, ScissorRect,
    Statistics, UpdateRule, YAxis,
};
pub use vertices::{ClipSpaceLayout, ModelSpaceLayout, VertexSpace, Vertices};

/// The README's program is tested.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
