//! Terrain and foreground in a buffer each, merged, against everything in one buffer.

pub mod landscape;
pub mod measure;
pub mod truth;
