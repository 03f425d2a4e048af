//! Code of the programs `demo` and `replay`; the tools use its scenes, pictures and z-buffer, too.

pub mod args;
pub mod camera;
pub mod compiler;
pub mod depth_picture;
pub mod exchange;
pub mod gltf_buffers;
pub mod image;
pub mod load;
#[path = "../../tests/native/mod.rs"]
pub mod native;
pub mod options;
pub mod picture;
pub mod play;
pub mod raster;
pub mod scene;
pub mod shade;
pub mod shapes;
pub mod split;
pub mod town;

/// An error message for the user.
pub type Result<T, E = Box<dyn std::error::Error>> = std::result::Result<T, E>;
