//! CPU occlusion culling on a masked hierarchical depth buffer.
//!
//! Draw a scene's large occluders into a [`MaskedOcclusionCulling`], then ask for each object, by a rectangle or by its
//! triangles, whether any of it could be seen. An answer of [`CullingResult::Occluded`] is certain; in case of doubt
//! the answer is [`CullingResult::Visible`].
//!
//! The buffer stores no depth per pixel. For each sub-tile of 8x4 pixels it stores a reference depth, which no pixel is
//! behind, and one to three working layers, each a depth and a mask of the pixels to which it applies; triangles are
//! inserted by one of four [`UpdateRule`]s (Hasselgren, Andersson, Akenine-Möller: "Masked Software Occlusion
//! Culling", HPG 2016). Depth is 1/w: 0 is infinitely far, larger is nearer.
//!
//! Coverage is exact: vertices are snapped to 1/256 pixel, and a pixel is covered when its centre is, by the top-left
//! rule. Every instruction set (see [`Implementation`]) gives the same bits.
//!
//! ```
//! use masked_occlusion_culling::{CullingResult, DrawOptions, MaskedOcclusionCulling, Settings, Vertices};
//!
//! let mut culling = MaskedOcclusionCulling::new(640, 360, Settings::default())?;
//! // Each frame: clear, draw occluders, test occludees. A wall at distance 10, in clip space: x, y, z (not read), w.
//! culling.clear_buffer();
//! let wall = [[-10.0, -10.0, 0.0, 10.0], [30.0, -10.0, 0.0, 10.0], [-10.0, 30.0, 0.0, 10.0]];
//! culling.render_triangles(Vertices::clip_space(&wall), &[0, 1, 2], &DrawOptions::default())?;
//! // A rectangle in normalised device coordinates, whose nearest point is at distance 12.
//! assert_eq!(culling.test_rect(-0.5, -0.5, 0.0, 0.0, 12.0), CullingResult::Occluded);
//! # Ok::<(), masked_occlusion_culling::Error>(())
//! ```
//!
//! For meshes with a matrix use [`Vertices::model_space`]; to draw with several threads, [`CullingThreadpool`]; for
//! recorded frames, [`Recording`].
//!
//! # Features
//!
//! All but `scalar` are on by default. To leave some out, list the others:
//! `{ version = "0.2", default-features = false, features = ["pool", "avx512"] }`.
//!
//! - `capi`: the C functions (`capi`), declared by the headers in `include/`. Without it, a Rust program exports none.
//! - `glam`: `glam::Mat4` can be used as a [`Matrix`]. Without it, use arrays.
//! - `pool`: the thread pool, `CullingThreadpool`. `recorder`: recording and replay, `Recording`.
//! - `sse41`, `avx2`, `avx512` (includes `avx2`): instruction sets of x86 above SSE2, from which the best is chosen at
//!   run time. Other architectures have only one.
//! - `quick`, `accurate`, `four-layer`: update rules besides the three-layer rule.
//! - `scalar`: the scalar code is also compiled where the target has vector instructions, which only tests need. Other
//!   targets always have it.
//!
//! `docs/platforms.md` has the size of the library with and without each.
//!
//! `src/kernel.rs` describes the path of a triangle, `src/buffer/mod.rs` the memory layout, `src/simd/mod.rs` the
//! vector layer.
#![warn(missing_debug_implementations, missing_docs)]
#![deny(unsafe_op_in_unsafe_fn)]
// Some functions exist only for C, the pool or the recorder, some operations only for other instruction sets.
#![cfg_attr(
    not(all(
        feature = "capi",
        feature = "pool",
        feature = "recorder",
        feature = "sse41",
        feature = "avx512",
        feature = "quick",
        feature = "accurate"
    )),
    allow(dead_code)
)]

mod allocator;
mod attachment;
mod bins;
mod bounds;
mod buffer;
#[cfg(feature = "capi")]
pub mod capi;
mod culling;
mod error;
mod float_environment;
mod geometry;
mod kernel;
mod matrix;
#[cfg(feature = "pool")]
mod pool;
mod raster;
#[cfg(feature = "recorder")]
mod recorder;
#[cfg(not(feature = "recorder"))]
#[path = "recorder/absent.rs"]
mod recorder;
mod settings;
mod simd;
mod sink;
mod source;
mod statistics;
mod transform;
mod types;
mod vertices;

/// The version of glam whose `Mat4` can be passed as a [`Matrix`].
#[cfg(feature = "glam")]
pub use glam;

pub use allocator::{AlignedAlloc, AlignedFree, Allocator};
pub use bins::TriList;
pub use culling::MaskedOcclusionCulling;
pub use error::Error;
pub use matrix::Matrix;
#[cfg(feature = "pool")]
pub use pool::{CullingThreadpool, Scope, ThreadStart, ThreadpoolSettings};
#[cfg(feature = "recorder")]
pub use recorder::{RecordedCall, RecordedMesh, RecordedRect, Recording, RecordingError};
pub use settings::{DrawOptions, Settings};
pub use transform::transform_vertices;
pub(crate) use types::VertexLayout;
pub use types::{
    BackfaceWinding, ClipPlanes, CullingResult, Implementation, OccludeeStatistics, OccluderStatistics, ScissorRect,
    Statistics, UpdateRule, YAxis,
};
pub use vertices::{ClipSpaceLayout, ModelSpaceLayout, VertexSpace, Vertices};

/// Tests the README's program.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
