//! The status of a thread's last call, and the callback that receives what was refused and why.

use core::cell::Cell;
use core::ffi::{c_char, c_void};
use core::fmt::Write;
use core::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Mutex, PoisonError};

use super::refusal::Refusal;
use super::status::{MOC_Status, guard};

/// Receives a message about a call that was refused, or that probably did not do what was intended: `message` names the
/// function, the argument and the reason, as in "MOC_RenderTriangles: no buffer: call MOC_SetResolution first".
///
/// `user` is that of MOC_SetMessageCallback. `status` is the MOC_Status that the call is about to return,
/// MOC_STATUS_OK if it was not refused. `message` is in English and valid only during the callback. It is called on
/// the thread that made the call, possibly on several threads concurrently, and while the library holds no lock of
/// its own. It may call the library; refusals of those calls are not reported. It must not throw or longjmp.
pub type MOC_MessageCallback = Option<unsafe extern "C" fn(user: *mut c_void, status: i32, message: *const c_char)>;

#[derive(Clone, Copy)]
struct Listener {
    callback: unsafe extern "C" fn(*mut c_void, i32, *const c_char),
    user: *mut c_void,
}

// SAFETY: the library never dereferences `user`; MOC_SetMessageCallback requires a callback that any thread may call
// with it.
unsafe impl Send for Listener {}

static LISTENER: Mutex<Option<Listener>> = Mutex::new(None);
/// Whether there is a listener, readable without the lock.
static LISTENING: AtomicBool = AtomicBool::new(false);
/// Whether any call has been refused yet: until then every thread's status is OK, and none has to be reset.
static REFUSED: AtomicBool = AtomicBool::new(false);

thread_local! {
    static LAST: Cell<MOC_Status> = const { Cell::new(MOC_Status::MOC_STATUS_OK) };
    static TELLING: Cell<bool> = const { Cell::new(false) };
    static DOUBT: Cell<Option<&'static str>> = const { Cell::new(None) };
}

/// From now on, calls that are refused, on any thread and for any object or pool, are reported to `callback`, with
/// `user` as its first argument; null (the default): none. There is one callback for the whole process.
///
/// When it returns, another thread may still be running the previous callback.
///
/// Errors: none.
///
/// # Safety
/// `callback` is null, or meets the requirements of MOC_MessageCallback with `user` on any thread until it is
/// replaced and every call that began before that has returned.
#[unsafe(export_name = symbol!(MOC_SetMessageCallback))]
pub unsafe extern "C" fn MOC_SetMessageCallback(callback: MOC_MessageCallback, user: *mut c_void) -> MOC_Status {
    guard(|| {
        let mut listener = LISTENER.lock().unwrap_or_else(PoisonError::into_inner);
        *listener = callback.map(|callback| Listener { callback, user });
        LISTENING.store(listener.is_some(), Relaxed);
        Ok(())
    })
}

/// The MOC_Status of the calling thread's last call, for programs that did not keep it. MOC_GetLastStatus,
/// MOC_StatusText and MOC_GetAbiVersion do not count as calls. MOC_STATUS_OK before the first call.
#[unsafe(export_name = symbol!(MOC_GetLastStatus))]
pub extern "C" fn MOC_GetLastStatus() -> i32 {
    // While a thread is ending, its thread-local variables may be gone.
    LAST.try_with(Cell::get).map_or(0, |status| status as i32)
}

/// Records that a call succeeded.
#[inline]
pub(super) fn done() {
    if REFUSED.load(Relaxed) {
        set_last(MOC_Status::MOC_STATUS_OK);
    }
}

/// Records and reports that the call of this name was refused. Returns its status.
#[cold]
pub(super) fn refused(function: &str, refusal: Refusal) -> MOC_Status {
    let status = refusal.status;
    let _ = DOUBT.try_with(Cell::take);
    tell(function, status, refusal.why());
    REFUSED.store(true, Relaxed);
    set_last(status);
    status
}

/// Reports a call of this name that is not refused, if `doubt` finds a probable mistake.
#[inline]
pub(super) fn note(function: &str, doubt: impl FnOnce() -> Option<&'static str>) {
    if LISTENING.load(Relaxed)
        && let Some(what) = doubt()
    {
        tell(function, MOC_Status::MOC_STATUS_OK, what);
    }
}

/// Notes that the call under way probably does not do what was intended, to be reported when it ends under the name
/// of the exported function.
#[inline]
pub(super) fn doubt(doubt: impl FnOnce() -> Option<&'static str>) {
    if LISTENING.load(Relaxed) {
        let _ = DOUBT.try_with(|slot| slot.set(doubt()));
    }
}

/// Reports what [`doubt`] noted.
#[inline]
pub(super) fn tell_doubt(function: fn() -> &'static str) {
    if LISTENING.load(Relaxed)
        && let Ok(Some(what)) = DOUBT.try_with(Cell::take)
    {
        tell(function(), MOC_Status::MOC_STATUS_OK, what);
    }
}

fn set_last(status: MOC_Status) {
    let _ = LAST.try_with(|last| last.set(status));
}

#[cold]
fn tell(function: &str, status: MOC_Status, why: &str) {
    if !LISTENING.load(Relaxed) || TELLING.try_with(|telling| telling.replace(true)).unwrap_or(true) {
        return;
    }
    // Copied, so that the callback runs without the lock.
    let listener = *LISTENER.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(Listener { callback, user }) = listener {
        let mut text = Text::default();
        // Writing to a `Text` never fails; it truncates.
        let _ = write!(text, "{function}: {why}");
        // SAFETY: the caller of MOC_SetMessageCallback vouched for both; the text is NUL-terminated.
        unsafe { callback(user, status as i32, text.as_ptr()) };
    }
    let _ = TELLING.try_with(|telling| telling.set(false));
}

/// A NUL-terminated text that does not use the allocator, which may be what just failed.
struct Text {
    bytes: [u8; 256],
    len: usize,
}

impl Default for Text {
    fn default() -> Self {
        Self { bytes: [0; 256], len: 0 }
    }
}

impl Text {
    fn as_ptr(&self) -> *const c_char {
        self.bytes.as_ptr().cast()
    }
}

impl Write for Text {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        let free = &mut self.bytes[self.len..255];
        let len = text.len().min(free.len());
        free[..len].copy_from_slice(&text.as_bytes()[..len]);
        self.len += len;
        Ok(())
    }
}

/// The exported function whose body contains a closure of type `T`; `core::any::type_name` has the path of both.
pub(super) fn function_of<T>() -> &'static str {
    let path = core::any::type_name::<T>();
    path.split("::").find(|name| name.starts_with("MOC_")).unwrap_or("masked_occlusion_culling")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_text_is_cut_and_ends() {
        let mut text = Text::default();
        write!(text, "{}{}", "a".repeat(200), "b".repeat(200)).unwrap();
        assert_eq!(text.bytes[254], b'b');
        assert_eq!(text.bytes[255], 0);
    }
}
