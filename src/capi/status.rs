//! The status that every function returns, and the version of the interface.

use core::ffi::{CStr, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

use super::messages;
use super::pointers::write;
use super::refusal::Refusal;
use crate::CullingResult;
use crate::float_environment::in_default_environment;

/// The version of this interface: 1000 * major + minor of the library's version.
///
/// Compare it with MOC_GetAbiVersion() to check that header and library belong together: before version 1.0 they must
/// be equal; from then on the major versions must be equal, and the library's minor version must be at least that of
/// the header.
pub const MOC_ABI_VERSION: u32 = 2;

const _: () = {
    const fn number(text: &str) -> u32 {
        match u32::from_str_radix(text, 10) {
            Ok(number) => number,
            Err(_) => panic!("cargo gives numbers"),
        }
    }
    let expected = 1000 * number(env!("CARGO_PKG_VERSION_MAJOR")) + number(env!("CARGO_PKG_VERSION_MINOR"));
    assert!(MOC_ABI_VERSION == expected, "MOC_ABI_VERSION does not follow the crate's version");
};

/// The result of a call. If it is not MOC_STATUS_OK, nothing was drawn, merged or changed, unless the function's
/// documentation says otherwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum MOC_Status {
    /// The call succeeded.
    MOC_STATUS_OK = 0,
    /// A required pointer is null.
    MOC_STATUS_NULL_POINTER = 1,
    /// An integer is not a value of the enumeration or flag that it is passed for.
    MOC_STATUS_INVALID_ENUM = 2,
    /// A width, height, bin count, triangle count, array length or rectangle is out of range.
    MOC_STATUS_INVALID_SIZE = 3,
    /// A number that must be finite is not.
    MOC_STATUS_INVALID_NUMBER = 4,
    /// A vertex layout has a negative stride or, if the length of the array is given, a negative offset; or a pointer
    /// is misaligned (indices and floats to be written must be aligned to 4 bytes, lists to 8).
    MOC_STATUS_INVALID_LAYOUT = 5,
    /// The object has no buffer: call MOC_SetResolution first.
    MOC_STATUS_NO_BUFFER = 6,
    /// An index refers to a vertex that does not exist.
    MOC_STATUS_INDEX_OUT_OF_RANGE = 7,
    /// The two buffers differ in resolution or row direction.
    MOC_STATUS_SIZE_MISMATCH = 8,
    /// A triangle list was full. The triangles that fitted are in the lists.
    MOC_STATUS_LIST_FULL = 9,
    /// An allocation failed.
    MOC_STATUS_OUT_OF_MEMORY = 10,
    /// An internal error. Memory is intact, but the call did not finish.
    MOC_STATUS_INTERNAL = 11,
    /// The file of a recording cannot be created, written or read.
    MOC_STATUS_FILE = 12,
    /// A file is not a recording, or it is truncated or corrupt.
    MOC_STATUS_INVALID_RECORDING = 13,
    /// A pool has work in flight for the object: call MOC_Flush first. Or the object belongs to another pool, or
    /// it is already recording.
    MOC_STATUS_BUSY = 14,
}

/// One text per status, in the order of the enumeration.
const TEXTS: [&CStr; 15] = [
    c"done",
    c"a required pointer is null",
    c"an enumeration argument has an unknown value",
    c"a size, count or rectangle is out of range",
    c"a number is not finite",
    c"a vertex layout is not accepted, or a pointer is misaligned",
    c"no buffer: call MOC_SetResolution first",
    c"an index refers to a vertex that does not exist",
    c"the two buffers differ in resolution or row direction",
    c"a triangle list is full",
    c"out of memory",
    c"internal error in the library",
    c"the recording's file cannot be created, written or read",
    c"the file is not a recording, or it is truncated or corrupt",
    c"a pool is drawing into the object, or it belongs to another pool, or it is already recording",
];

/// The text of a status.
pub(super) fn text(status: MOC_Status) -> &'static str {
    TEXTS[status as usize].to_str().unwrap_or_default()
}

/// The MOC_ABI_VERSION that the library was built with.
#[unsafe(export_name = symbol!(MOC_GetAbiVersion))]
pub extern "C" fn MOC_GetAbiVersion() -> u32 {
    MOC_ABI_VERSION
}

/// An English text for a status, for logs. Never null; valid as long as the library is loaded.
#[unsafe(export_name = symbol!(MOC_StatusText))]
pub extern "C" fn MOC_StatusText(status: i32) -> *const c_char {
    let text = usize::try_from(status).ok().and_then(|i| TEXTS.get(i));
    text.map_or(c"not a status of this library", |t| t).as_ptr()
}

/// Records success; called directly by functions that have nothing to do.
#[inline]
pub(super) fn done() -> MOC_Status {
    messages::done();
    MOC_Status::MOC_STATUS_OK
}

/// Runs the body of an exported function; a panic becomes a status. The closure must be written inside that function:
/// messages take the function's name from it.
pub(super) fn guard<F: FnOnce() -> Result<(), Refusal>>(body: F) -> MOC_Status {
    in_default_environment(|| run(messages::function_of::<F>, body))
}

/// As [`guard`], for calls with an answer: `result` receives it, or "visible" on errors.
///
/// # Safety
/// `result` is null or can be written.
pub(super) unsafe fn guard_result<F: FnOnce() -> Result<CullingResult, Refusal>>(
    result: *mut i32,
    body: F,
) -> MOC_Status {
    // SAFETY: the caller's contract.
    in_default_environment(|| unsafe { guard_result_as_set(result, body) })
}

/// The same, when already in the default floating-point environment.
///
/// # Safety
/// As there.
#[inline]
pub(super) unsafe fn guard_result_as_set<F: FnOnce() -> Result<CullingResult, Refusal>>(
    result: *mut i32,
    body: F,
) -> MOC_Status {
    let mut answer = CullingResult::Visible;
    let status = run(messages::function_of::<F>, || {
        answer = body()?;
        Ok(())
    });
    if !result.is_null() {
        // SAFETY: not null, and the caller's contract.
        unsafe { write(result, answer as i32) };
    }
    status
}

#[inline]
fn run(name: fn() -> &'static str, body: impl FnOnce() -> Result<(), Refusal>) -> MOC_Status {
    match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => {
            messages::tell_doubt(name);
            done()
        }
        Ok(Err(refusal)) => messages::refused(name(), refusal),
        Err(payload) => {
            // Dropping the panic's payload could panic again.
            core::mem::forget(payload);
            messages::refused(name(), MOC_Status::MOC_STATUS_INTERNAL.into())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_status_has_its_own_text_and_explanation() {
        use MOC_Status::*;
        let all = [
            MOC_STATUS_OK,
            MOC_STATUS_NULL_POINTER,
            MOC_STATUS_INVALID_ENUM,
            MOC_STATUS_INVALID_SIZE,
            MOC_STATUS_INVALID_NUMBER,
            MOC_STATUS_INVALID_LAYOUT,
            MOC_STATUS_NO_BUFFER,
            MOC_STATUS_INDEX_OUT_OF_RANGE,
            MOC_STATUS_SIZE_MISMATCH,
            MOC_STATUS_LIST_FULL,
            MOC_STATUS_OUT_OF_MEMORY,
            MOC_STATUS_INTERNAL,
            MOC_STATUS_FILE,
            MOC_STATUS_INVALID_RECORDING,
            MOC_STATUS_BUSY,
        ];
        assert_eq!(all.len(), TEXTS.len());
        let (mut texts, mut explanations) = (std::collections::BTreeSet::new(), std::collections::BTreeSet::new());
        for (i, status) in all.into_iter().enumerate() {
            assert_eq!(status as usize, i);
            assert!(texts.insert(TEXTS[i]) && explanations.insert(Refusal::from(status).why()), "{status:?}");
        }
    }

    // On targets without unwinding there is nothing to catch: a panic ends the process.
    #[cfg(panic = "unwind")]
    #[test]
    fn a_panic_becomes_a_status_and_the_answer_visible() {
        let mut result = 7;
        // SAFETY: `result` is a local.
        let status = unsafe { guard_result(&mut result, || panic!("on purpose")) };
        assert_eq!((status, result), (MOC_Status::MOC_STATUS_INTERNAL, 0));
    }
}
