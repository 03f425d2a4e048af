//! Terrain and foreground in separate buffers, merged, compared with everything in one buffer.

pub mod landscape;
pub mod measure;
pub mod truth;
