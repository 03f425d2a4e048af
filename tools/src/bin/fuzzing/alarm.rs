//! After a crash or a hang, names the episode before the process ends.

use core::ffi::c_int;
use core::sync::atomic::{AtomicU64, Ordering::Relaxed};

static SEED: AtomicU64 = AtomicU64::new(0);
static EPISODE: AtomicU64 = AtomicU64::new(0);

/// Episodes take milliseconds, so this is a hang on any machine.
const PATIENCE_SECONDS: u32 = 60;

/// Installs a handler for memory faults, aborts and the alarm.
pub fn install() {
    for signal in [libc::SIGSEGV, libc::SIGBUS, libc::SIGILL, libc::SIGFPE, libc::SIGABRT, libc::SIGALRM] {
        // SAFETY: an all-zero sigaction is a valid one; the handler calls write and _exit and nothing else,
        // which a handler may, on the stack that Rust set up for faults.
        unsafe {
            let mut action: libc::sigaction = core::mem::zeroed();
            action.sa_sigaction = report as *const () as libc::sighandler_t;
            action.sa_flags = libc::SA_ONSTACK;
            libc::sigaction(signal, &action, core::ptr::null_mut());
        }
    }
}

/// From now on, failures are attributed to this episode.
pub fn enter(seed: u64, episode: u64) {
    SEED.store(seed, Relaxed);
    EPISODE.store(episode, Relaxed);
    // SAFETY: alarm only sets this process's timer.
    unsafe { libc::alarm(PATIENCE_SECONDS) };
}

extern "C" fn report(signal: c_int) {
    let what: &[u8] = if signal == libc::SIGALRM { b"\nHUNG" } else { b"\nCRASHED" };
    print(what);
    print(b": signal ");
    print_number(signal.unsigned_abs().into());
    print(b", run again with --seed ");
    print_number(SEED.load(Relaxed));
    print(b" --episode ");
    print_number(EPISODE.load(Relaxed));
    print(b"\n");
    // SAFETY: _exit may be called in a handler.
    unsafe { libc::_exit(1) }
}

fn print(text: &[u8]) {
    // SAFETY: `text` can be read for its length; write may be called in a handler.
    unsafe { libc::write(libc::STDERR_FILENO, text.as_ptr().cast(), text.len()) };
}

fn print_number(mut n: u64) {
    let mut digits = [0; 20];
    let mut first = digits.len();
    loop {
        first -= 1;
        digits[first] = b'0' + (n % 10) as u8;
        n /= 10;
        if n == 0 {
            break;
        }
    }
    print(&digits[first..]);
}
