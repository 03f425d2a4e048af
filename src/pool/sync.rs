//! What threads wait on, in one place, so that a test can put a model in its stead (`tests/pool_interleavings.rs`).

use core::hint::spin_loop;
use core::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};
use std::thread::yield_now;
use std::time::{Duration, Instant};

pub(super) use std::sync::{Arc, Condvar, Mutex, MutexGuard};

/// A thread takes longer to fall asleep and wake than most pieces of work take.
const SPIN: Duration = Duration::from_micros(20);

/// How often there was progress, for those who wait a moment before they sleep. It only says when to look again: what there is
/// to see is under the lock.
#[derive(Default)]
pub(super) struct SpinWait(AtomicU64);

impl SpinWait {
    pub fn changed(&self) {
        self.0.fetch_add(1, Relaxed);
    }

    pub fn count(&self) -> u64 {
        self.0.load(Relaxed)
    }

    /// Waits until the count is another one, but only a moment.
    pub fn wait(&self, count: u64) {
        if cfg!(all(target_family = "wasm", target_os = "unknown")) {
            // There is no clock: reading the time panics.
            return;
        }
        let begin = Instant::now();
        while self.count() == count && begin.elapsed() < SPIN {
            for _ in 0..32 {
                spin_loop();
            }
            // On a processor that others need, too, those who work come first.
            yield_now();
        }
    }
}

/// The number of a thread that is not the pool's, so that it returns to the bins it drew in before. Worker threads count from
/// 0.
pub(super) fn external_thread() -> usize {
    static THREADS: AtomicUsize = AtomicUsize::new(0);
    thread_local!(static NUMBER: usize = usize::MAX - THREADS.fetch_add(1, Relaxed));
    NUMBER.with(|&number| number)
}
