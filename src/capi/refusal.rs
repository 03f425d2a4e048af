//! Why a call was refused: the status that it returns and, for the message callback, the argument and what is wrong with it.

use crate::Error;

/// An [`Error`] and, where the boundary knows more, which argument it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Refusal {
    pub error: Error,
    why: Option<&'static str>,
}

impl Refusal {
    pub const fn new(error: Error, why: &'static str) -> Self {
        Self { error, why: Some(why) }
    }

    /// The explanation, in terms of the C interface.
    pub fn why(self) -> &'static str {
        match (self.why, self.error) {
            (Some(why), _) => why,
            (None, Error::NullPointer) => "a required pointer is null",
            (None, Error::InvalidEnum) => "an enumeration argument has an unknown value",
            (None, Error::InvalidSize) => "a size, count or rectangle is out of range",
            (None, Error::InvalidNumber) => "a number is not finite",
            (None, Error::InvalidLayout) => "a vertex layout is not accepted, or a pointer is misaligned",
            (None, Error::NoBuffer) => "no buffer: call MOC_SetResolution first",
            (None, Error::IndexOutOfRange) => "an index names a vertex that does not exist",
            (None, Error::SizeMismatch) => "the two buffers differ in resolution or row direction",
            (None, Error::ListFull) => "a triangle list is full: triangles that did not fit are not drawn",
            (None, Error::OutOfMemory) => "the allocator returned no memory, or misaligned memory",
            (None, Error::Internal) => "internal error in the library",
            (None, Error::File) => "the recording's file cannot be created, written or read",
            (None, Error::InvalidRecording) => "the file is not a recording, or it is truncated or corrupt",
            (None, Error::Busy) => "a pool is drawing into the object: call MOC_Flush first",
        }
    }
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        Self { error, why: None }
    }
}

/// Adds to results of the Rust API which argument was wrong, where the boundary knows it.
pub(super) trait Because<T> {
    /// If the error is `error`, explains it with `why`.
    fn because(self, error: Error, why: &'static str) -> Result<T, Refusal>;
}

impl<T, E: Into<Refusal>> Because<T> for Result<T, E> {
    #[inline]
    fn because(self, error: Error, why: &'static str) -> Result<T, Refusal> {
        self.map_err(|e| {
            let refusal = e.into();
            if refusal.error == error { Refusal::new(error, why) } else { refusal }
        })
    }
}
