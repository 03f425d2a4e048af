//! Why a call was refused: the status that it returns, and for the message callback the argument and what is wrong with it.

use crate::Error;

/// An [`Error`] and, where the boundary knows more than that, which argument it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Refusal {
    pub error: Error,
    why: Option<&'static str>,
}

impl Refusal {
    pub const fn new(error: Error, why: &'static str) -> Self {
        Self { error, why: Some(why) }
    }

    /// What a reader of C has to change.
    pub fn why(self) -> &'static str {
        match (self.why, self.error) {
            (Some(why), _) => why,
            (None, Error::NullPointer) => "a pointer that has to name something is null",
            (None, Error::InvalidEnum) => "an enumeration has no such value",
            (None, Error::InvalidSize) => "a size, count or rectangle is outside of what is accepted",
            (None, Error::InvalidNumber) => "a number that has to be finite is not",
            (None, Error::InvalidLayout) => "a vertex layout or the alignment of a pointer is not accepted",
            (None, Error::NoBuffer) => "no buffer: call MOC_SetResolution first",
            (None, Error::IndexOutOfRange) => "an index names a vertex that is not there",
            (None, Error::SizeMismatch) => "the two buffers differ in resolution or row direction",
            (None, Error::ListFull) => "a triangle list is full: what fitted is in it, the rest is not drawn",
            (None, Error::OutOfMemory) => "the allocator gave no memory, or memory that is not aligned as asked for",
            (None, Error::Internal) => "the library failed inside",
            (None, Error::File) => "the recording's file cannot be made, written or read",
            (None, Error::InvalidRecording) => "the file is no recording, or it is cut or broken",
            (None, Error::Busy) => "a pool is drawing into the object: call MOC_Flush first",
        }
    }
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        Self { error, why: None }
    }
}

/// For results of the Rust API, where the boundary can say which argument is meant.
pub(super) trait Because<T> {
    /// Where the error is `error`, `why` says what is wrong.
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
