//! The C interface: `extern "C"` functions and nothing else.
//!
//! Every function checks pointers, enumerations and sizes, makes one call into the Rust API, and returns
//! a status. No panic crosses the boundary. `include/masked_occlusion_culling.h` is generated from these
//! files, so their doc comments are written for C programmers.
#![allow(non_camel_case_types, non_snake_case)]

mod bins;
mod callbacks;
mod draw;
mod float_environment;
mod lifecycle;
mod mesh;
mod messages;
mod pointers;
mod pool;
mod query;
mod recorder;
mod refusal;
mod status;
mod transform;
mod types;

pub use bins::*;
pub use callbacks::*;
pub use draw::*;
pub use lifecycle::*;
pub use messages::*;
pub use pool::*;
pub use query::*;
pub use recorder::*;
pub use status::*;
pub use transform::*;
pub use types::*;
