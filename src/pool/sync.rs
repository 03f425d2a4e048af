//! The primitives that threads wait on, in one place, so that a test can replace them with a model
//! (`tests/pool_interleavings.rs`).

use core::hint::spin_loop;
use core::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};
use std::thread::yield_now;
use std::time::{Duration, Instant};

pub(super) use std::sync::{Arc, Condvar, Mutex, MutexGuard};

/// Falling asleep and waking take longer than most pieces of work.
const SPIN: Duration = Duration::from_micros(20);

/// A progress counter for threads that spin briefly before they sleep. It only says when to check again; the state
/// itself is under the lock.
#[derive(Default)]
pub(super) struct SpinWait(AtomicU64);

impl SpinWait {
    pub fn changed(&self) {
        self.0.fetch_add(1, Relaxed);
    }

    pub fn count(&self) -> u64 {
        self.0.load(Relaxed)
    }

    /// Waits until the count changes, but only briefly.
    pub fn wait(&self, count: u64) {
        if cfg!(all(target_family = "wasm", target_os = "unknown")) {
            // There is no clock here: reading the time panics.
            return;
        }
        let begin = Instant::now();
        while self.count() == count && begin.elapsed() < SPIN {
            for _ in 0..32 {
                spin_loop();
            }
            // If others need the processor too, working threads come first.
            yield_now();
        }
    }
}

/// The number of a thread that does not belong to the pool, so that it returns to the bins in which it drew before.
/// Worker threads count from 0.
pub(super) fn external_thread() -> usize {
    static THREADS: AtomicUsize = AtomicUsize::new(0);
    thread_local!(static NUMBER: usize = usize::MAX - THREADS.fetch_add(1, Relaxed));
    NUMBER.with(|&number| number)
}
