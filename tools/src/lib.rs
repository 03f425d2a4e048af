//! Code shared by several tools.

pub mod merging;
pub mod rectangle;
pub mod scaling;

/// The oracle of the library's own tests, and their triangles.
#[path = "../../tests/oracle/mod.rs"]
pub mod oracle;
#[path = "../../tests/support/triangles.rs"]
pub mod triangles;

pub use demo::Result;
