//! What a call can refuse, and nothing else: each variant is one status of the C interface.

use core::fmt;

/// Why a call was refused. Nothing was drawn, merged or changed unless the variant says otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Error {
    /// A pointer that has to name something was null (C interface only).
    NullPointer,
    /// An integer that stands for an enumeration has no meaning there (C interface only).
    InvalidEnum,
    /// A width, height, bin count, triangle count or rectangle is outside of what is accepted.
    InvalidSize,
    /// A number that has to be finite is not (the near plane).
    InvalidNumber,
    /// A vertex layout whose stride or an offset is negative; in the C interface also a misaligned pointer.
    InvalidLayout,
    /// The object has no buffer yet: call `set_resolution` first.
    NoBuffer,
    /// An index names a vertex that is not there.
    IndexOutOfRange,
    /// Two buffers of different resolution, or with rows in different directions, cannot be merged.
    SizeMismatch,
    /// A triangle list was full: the triangles that fit are in it, the others are not drawn from it.
    ListFull,
    /// The allocator returned nothing. The object keeps the buffer that it had.
    OutOfMemory,
    /// The library failed inside; no memory was harmed, but the call did not finish (C interface only).
    Internal,
    /// A recording's file could not be made, written or read (C interface only; in Rust see
    /// [`RecordingError`](crate::RecordingError)).
    File,
    /// A file is no recording, or it is cut or broken (C interface only).
    InvalidRecording,
    /// A pool is drawing into the object: flush first. Or the object belongs to another pool, or (C interface only) it is
    /// already recording.
    Busy,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Error::NullPointer => "a pointer that has to name something is null",
            Error::InvalidEnum => "an enumeration has no such value",
            Error::InvalidSize => "a size, count or rectangle is outside of what is accepted",
            Error::InvalidNumber => "a number that has to be finite is not",
            Error::InvalidLayout => "a vertex layout or the alignment of a pointer is not accepted",
            Error::NoBuffer => "no buffer: the resolution was never set",
            Error::IndexOutOfRange => "an index names a vertex that is not there",
            Error::SizeMismatch => "the two buffers differ in resolution or row direction",
            Error::ListFull => "a triangle list is full",
            Error::OutOfMemory => "out of memory",
            Error::Internal => "the library failed inside",
            Error::File => "a recording's file cannot be made, written or read",
            Error::InvalidRecording => "a file is no recording, or it is cut or broken",
            Error::Busy => {
                "a pool is drawing into the object, or it belongs to another pool, or it is already recording"
            }
        })
    }
}

impl std::error::Error for Error {}
