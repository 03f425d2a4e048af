//! Queries of bounds: rectangles on the screen.

pub(crate) mod rectangle;
