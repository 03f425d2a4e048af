//! The C interface: `extern "C"` functions and nothing else.
//!
//! Every function checks pointers, enumerations and sizes, makes one call into the Rust API, and returns
//! a status. No panic crosses the boundary. `include/masked_occlusion_culling.h` is generated from these
//! files, so their doc comments are written for C programmers.
#![allow(non_camel_case_types, non_snake_case)]
// `m[0]` is C, not a link.
#![allow(rustdoc::broken_intra_doc_links)]

/// The name under which a function is exported: this build's prefix, passed on by build.rs, followed by its own name.
macro_rules! symbol {
    ($name:ident) => {
        concat!(env!("MOC_SYMBOL_PREFIX"), stringify!($name))
    };
}

mod bins;
mod callbacks;
mod draw;
mod lifecycle;
mod mesh;
mod messages;
mod pointers;
#[cfg(feature = "pool")]
mod pool;
#[cfg(feature = "pool")]
mod pool_calls;
#[cfg(feature = "pool")]
mod pool_state;
mod query;
#[cfg(feature = "recorder")]
mod recorder;
mod refusal;
mod status;
mod transform;
mod types;

pub use bins::*;
pub use callbacks::*;
pub use draw::*;
pub use lifecycle::*;
pub use mesh::*;
pub use messages::*;
#[cfg(feature = "pool")]
pub use pool::*;
#[cfg(feature = "pool")]
pub use pool_calls::*;
pub use query::*;
#[cfg(feature = "recorder")]
pub use recorder::*;
pub use status::*;
pub use transform::*;
pub use types::*;
