//! From clip space to the screen: projection, clipping, screen bounds, and the definition of coverage for draws and
//! queries.

pub(crate) mod camera;
pub(crate) mod clip;
pub(crate) mod coverage;
pub(crate) mod extent;
pub(crate) mod project;
pub(crate) mod screen_bounds;

pub(crate) use camera::{Camera, Facing};
pub(crate) use coverage::{Conservative, Coverage, Exact};
pub(crate) use project::project;
pub(crate) use screen_bounds::ScreenBounds;

use crate::simd::Simd;

/// A triangle's corner on the screen, for each lane: x and y in 1/256 pixel, as whole numbers, and 1/w.
pub(crate) type Corner<S> = [<S as Simd>::F; 3];
