//! The bytes of a recording (`.mocrec`), little-endian, in the format of Intel's library:
//!
//! ```text
//! header     u32 0xA701B600, f32 near plane, u32 width, u32 height
//! entries    each begins with a byte that gives its kind
//!   3        clear: nothing else
//!   1        rectangle: i32 result, f32 x_min, y_min, x_max, y_max, w_min
//!   0, 2     draw, query: i32 result, i32 vertices (0: the entry ends here), i32 bytes per vertex, the vertices from
//!            the lowest used index on, i32 triangles, 3 u32 per triangle, less that lowest index, u8 has a matrix,
//!            [16 f32], i32 clip planes, i32 winding, 3 i32 layout
//! end        0x7F
//! ```
//!
//! Results are those of `CullingResult`, or -1 if unknown.

pub(super) const SIGNATURE: u32 = 0xA701_B600;

pub(super) const RENDER_TRIANGLES: u8 = 0;
pub(super) const TEST_RECT: u8 = 1;
pub(super) const TEST_TRIANGLES: u8 = 2;
pub(super) const CLEAR_BUFFER: u8 = 3;
pub(super) const END: u8 = 0x7f;

pub(super) const UNKNOWN: i32 = -1;
