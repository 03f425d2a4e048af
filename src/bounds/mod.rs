//! Queries of screen-space bounds: rectangles.

pub(crate) mod rectangle;
