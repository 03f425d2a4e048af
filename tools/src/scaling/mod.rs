//! How drawing time grows: with triangles, with pixels, and with sheets one behind another.

pub mod culler;
pub mod job;
pub mod measure;
pub mod mesh;
pub mod other;
pub mod ours;
pub mod plot;
pub mod scene;
pub mod table;
