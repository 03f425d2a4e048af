//! The errors of the frame recorder.

use core::fmt;
use std::io;

/// Why a frame was not recorded, or a recording not loaded.
#[derive(Debug)]
#[non_exhaustive]
pub enum RecordingError {
    /// The object is already recording.
    Busy,
    /// The file could not be created, written or read.
    File(io::Error),
    /// There is not enough memory for the file's contents.
    OutOfMemory,
    /// The file is not a recording, or is truncated or corrupt.
    Invalid {
        /// Offset of the first invalid byte of the file.
        offset: usize,
        /// The error at that byte.
        why: &'static str,
    },
}

impl fmt::Display for RecordingError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutOfMemory => f.write_str("out of memory"),
            Self::Busy => f.write_str("already recording"),
            Self::File(error) => write!(f, "a recording cannot be made, written or read: {error}"),
            Self::Invalid { offset: 0, why } => write!(f, "not a recording: {why}"),
            Self::Invalid { offset, why } => write!(f, "corrupt recording: {why}, at byte {offset}"),
        }
    }
}

impl std::error::Error for RecordingError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::File(error) => Some(error),
            _ => None,
        }
    }
}

impl From<io::Error> for RecordingError {
    fn from(error: io::Error) -> Self {
        Self::File(error)
    }
}
