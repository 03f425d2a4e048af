//! Why a call was refused: the status that it returns, and the text that the message callback receives, which names the
//! argument and says what is wrong with it.

use super::status::{self, MOC_Status};
use crate::Error;
#[cfg(feature = "recorder")]
use crate::RecordingError;
#[cfg(feature = "pool")]
use crate::attachment::Taken;

/// A status and, if known here, which argument was wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Refusal {
    pub status: MOC_Status,
    why: Option<&'static str>,
}

impl Refusal {
    pub const fn new(status: MOC_Status, why: &'static str) -> Self {
        Self { status, why: Some(why) }
    }

    /// The explanation, in terms of the C interface.
    pub fn why(self) -> &'static str {
        match (self.why, self.status) {
            (Some(why), _) => why,
            (None, MOC_Status::MOC_STATUS_LIST_FULL) => {
                "a triangle list is full: triangles that did not fit are not drawn"
            }
            (None, MOC_Status::MOC_STATUS_OUT_OF_MEMORY) => "the allocator returned no memory, or misaligned memory",
            (None, MOC_Status::MOC_STATUS_BUSY) => "a pool is drawing into the object: call MOC_Flush first",
            (None, status) => status::text(status),
        }
    }
}

impl From<MOC_Status> for Refusal {
    fn from(status: MOC_Status) -> Self {
        Self { status, why: None }
    }
}

impl From<Error> for Refusal {
    fn from(error: Error) -> Self {
        let status = match error {
            Error::InvalidSize => MOC_Status::MOC_STATUS_INVALID_SIZE,
            Error::InvalidNumber => MOC_Status::MOC_STATUS_INVALID_NUMBER,
            Error::InvalidLayout => MOC_Status::MOC_STATUS_INVALID_LAYOUT,
            Error::IndexOutOfRange => MOC_Status::MOC_STATUS_INDEX_OUT_OF_RANGE,
            Error::SizeMismatch => MOC_Status::MOC_STATUS_SIZE_MISMATCH,
            Error::ListFull => MOC_Status::MOC_STATUS_LIST_FULL,
            Error::OutOfMemory => MOC_Status::MOC_STATUS_OUT_OF_MEMORY,
            // Pools of the C interface may also have an object without a buffer.
            Error::NoObject => MOC_Status::MOC_STATUS_NO_BUFFER,
            Error::UnavailableRule => {
                let why = "the library is compiled without this update_rule";
                return Self::new(MOC_Status::MOC_STATUS_INVALID_ENUM, why);
            }
        };
        status.into()
    }
}

#[cfg(feature = "recorder")]
impl From<RecordingError> for Refusal {
    fn from(error: RecordingError) -> Self {
        let status = match error {
            RecordingError::Busy => MOC_Status::MOC_STATUS_BUSY,
            RecordingError::OutOfMemory => MOC_Status::MOC_STATUS_OUT_OF_MEMORY,
            RecordingError::File(_) => MOC_Status::MOC_STATUS_FILE,
            RecordingError::Invalid { .. } => MOC_Status::MOC_STATUS_INVALID_RECORDING,
        };
        status.into()
    }
}

#[cfg(feature = "pool")]
impl From<Taken> for Refusal {
    fn from(_: Taken) -> Self {
        Self::new(MOC_Status::MOC_STATUS_BUSY, "the object belongs to another pool")
    }
}

/// Adds to an error of the Rust API which argument was wrong, if that is known here.
pub(super) trait Because<T> {
    /// If the status is `status`, explains it with `why`.
    fn because(self, status: MOC_Status, why: &'static str) -> Result<T, Refusal>;
}

impl<T, E: Into<Refusal>> Because<T> for Result<T, E> {
    #[inline]
    fn because(self, status: MOC_Status, why: &'static str) -> Result<T, Refusal> {
        self.map_err(|e| {
            let refusal = e.into();
            if refusal.status == status { Refusal::new(status, why) } else { refusal }
        })
    }
}
