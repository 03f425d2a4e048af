//! The errors of the Rust interface. The C interface has its own codes (`capi/status.rs`).

use core::fmt;

/// Why a call was rejected. Nothing was drawn, merged or changed unless the variant says otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Error {
    /// A width, height, bin count, array length or rectangle is out of range.
    InvalidSize,
    /// A number that must be finite (the near plane) is not.
    InvalidNumber,
    /// The stride or an offset of a vertex layout is negative.
    InvalidLayout,
    /// An index refers to a vertex that does not exist.
    IndexOutOfRange,
    /// Two buffers with different resolutions or row directions cannot be merged.
    SizeMismatch,
    /// A triangle list was full: it contains the triangles that fit, and the others will not be drawn.
    ListFull,
    /// The allocator returned null. The object keeps its previous buffer.
    OutOfMemory,
    /// The pool has no object to draw into: see `CullingThreadpool::set_buffer`.
    NoObject,
    /// The library is compiled without the update rule: see [`UpdateRule::available`](crate::UpdateRule::available).
    UnavailableRule,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Error::InvalidSize => "a size, count or rectangle is out of range",
            Error::InvalidNumber => "a number is not finite",
            Error::InvalidLayout => "the stride or an offset of a vertex layout is negative",
            Error::IndexOutOfRange => "an index refers to a vertex that does not exist",
            Error::SizeMismatch => "the two buffers differ in resolution or row direction",
            Error::ListFull => "a triangle list is full",
            Error::OutOfMemory => "out of memory",
            Error::NoObject => "the pool has no object to draw into",
            Error::UnavailableRule => "the library is compiled without this update rule",
        })
    }
}

impl std::error::Error for Error {}
