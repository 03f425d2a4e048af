//! The pool's actual workers and schedule under loom: every interleaving of the threads (with a few switches between
//! two waits), with a target that records its calls. Nothing hangs, nothing is lost, no two threads draw in a bin at
//! once, and each bin draws in the order of submission.
#![allow(dead_code, reason = "the two files are parts of a larger module")]

#[path = "../src/pool/schedule.rs"]
mod schedule;
#[path = "../src/pool/workers.rs"]
mod workers;

mod processor {
    /// The processor on which a thread runs makes no difference.
    #[derive(Clone, Copy, PartialEq, Eq)]
    pub(super) struct Processor;

    impl Processor {
        pub fn current() -> Option<Self> {
            Some(Self)
        }

        pub fn leave(self) -> bool {
            true
        }
    }
}

mod sync {
    pub(super) use loom::sync::{Arc, Condvar, Mutex, MutexGuard};

    /// Callers are not distinguished.
    pub(super) fn external_thread() -> usize {
        usize::MAX
    }

    /// No spinning: threads go to sleep at once, or check again if something was finished.
    #[derive(Default)]
    pub(super) struct SpinWait(loom::sync::atomic::AtomicU64);

    impl SpinWait {
        pub fn changed(&self) {
            self.0.fetch_add(1, loom::sync::atomic::Ordering::Relaxed);
        }

        pub fn count(&self) -> u64 {
            self.0.load(loom::sync::atomic::Ordering::Relaxed)
        }

        pub fn wait(&self, _: u64) {}
    }
}

mod sink {
    /// Call numbers instead of triangles.
    #[derive(Default)]
    pub struct BinnedTriangles(pub Vec<u32>);

    impl BinnedTriangles {
        pub fn clear(&mut self) {
            self.0.clear();
        }
    }
}

mod target {
    use super::sink::BinnedTriangles;
    use super::sync::Arc;
    use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::SeqCst};
    use std::sync::{Mutex, TryLockError};

    pub struct Call {
        pub number: u32,
        pub indices: usize,
        pub clears: u64,
    }

    pub enum Work {
        Triangles(BinnedTriangles),
        Clear(u64),
    }

    pub struct Target {
        pub drawn: Vec<Mutex<Vec<u32>>>,
        pub clears: AtomicU64,
        busy: Vec<AtomicBool>,
        /// Odd while work is in flight.
        turns: AtomicU64,
        /// Parts drawn by bins, for tests that wait without calling the workers.
        parts: loom::sync::Mutex<usize>,
        progress: loom::sync::Condvar,
    }

    impl Target {
        pub fn new(bins: usize) -> Self {
            let drawn = (0..bins).map(|_| Mutex::default()).collect();
            Self {
                drawn,
                clears: AtomicU64::new(0),
                busy: (0..bins).map(|_| AtomicBool::new(false)).collect(),
                turns: AtomicU64::new(0),
                parts: loom::sync::Mutex::new(0),
                progress: loom::sync::Condvar::new(),
            }
        }

        pub fn turn(&self) {
            self.turns.fetch_add(1, SeqCst);
        }

        pub fn is_busy(&self) -> bool {
            self.turns.load(SeqCst) % 2 == 1
        }

        /// Waits until this many parts are drawn; if no thread draws them, loom reports a deadlock.
        pub fn wait(&self, parts: usize) {
            let mut drawn = self.parts.lock().unwrap();
            while *drawn < parts {
                drawn = self.progress.wait(drawn).unwrap();
            }
        }

        pub fn bins(&self) -> usize {
            self.drawn.len()
        }

        pub fn clears(&self) -> u64 {
            self.clears.load(SeqCst)
        }

        pub unsafe fn bin(&self, calls: &[Call], binned: &mut BinnedTriangles) {
            binned.clear();
            loom::thread::yield_now();
            binned.0.extend(calls.iter().map(|call| call.number));
            assert!(calls.iter().all(|call| call.clears == calls[0].clears), "a clear ends a batch");
        }

        pub fn draw(&self, bin: usize, work: &[Arc<Work>]) {
            assert!(self.is_busy(), "the object is marked busy before anything is drawn");
            assert!(!self.busy[bin].swap(true, SeqCst), "two threads in a bin");
            loom::thread::yield_now();
            let mut drawn = match self.drawn[bin].try_lock() {
                Ok(drawn) => drawn,
                Err(TryLockError::Poisoned(_) | TryLockError::WouldBlock) => panic!("two threads in a bin"),
            };
            for work in work {
                match &**work {
                    Work::Triangles(binned) => drawn.extend(&binned.0),
                    Work::Clear(number) => drawn.push(1000 + *number as u32),
                }
            }
            drop(drawn);
            assert!(self.busy[bin].swap(false, SeqCst));
            *self.parts.lock().unwrap() += work.len();
            self.progress.notify_all();
        }
    }
}

use loom::thread;
use std::sync::atomic::Ordering::SeqCst;
use sync::Arc;
use target::{Call, Target, Work};
use workers::Workers;

fn call(number: u32) -> Call {
    // Each call fills a batch.
    Call { number, indices: 3 * schedule::BATCH_WEIGHT, clears: 0 }
}

/// A call so small that no thread is woken for it while another is awake.
fn small(number: u32) -> Call {
    Call { number, indices: 3, clears: 0 }
}

fn clear(workers: &Workers, target: &Target) {
    workers.do_now(|| Work::Clear(target.clears.fetch_add(1, SeqCst) + 1));
    assert_eq!(
        target.drawn[0].lock().unwrap().last(),
        Some(&(1000 + target.clears() as u32)),
        "cleared when it returns"
    );
}

/// Runs a program in every interleaving, with this many threads, bins and batches.
fn explore(threads: usize, bins: usize, max_jobs: usize, program: fn(&Workers, &Target), expected: &'static [u32]) {
    let mut model = loom::model::Builder::new();
    model.preemption_bound = Some(2);
    model.max_branches = 50_000;
    // A limit for slow machines; it only skips the remaining interleavings.
    model.max_duration = Some(std::time::Duration::from_secs(15));
    model.check(move || {
        let workers = Arc::new(Workers::new(max_jobs));
        let target = Arc::new(Target::new(bins));
        workers.set_target(Some(target.clone()));
        let threads: Vec<_> = (0..threads)
            .map(|number| {
                let workers = workers.clone();
                thread::spawn(move || workers.work(number))
            })
            .collect();
        program(&workers, &target);
        workers.flush();
        assert!(!target.is_busy());
        for drawn in &target.drawn {
            assert_eq!(*drawn.lock().unwrap(), expected);
        }
        workers.stop();
        threads.into_iter().for_each(|thread| thread.join().unwrap());
    });
}

#[test]
fn calls_and_clears_are_drawn_in_order() {
    let program = |workers: &Workers, target: &Target| {
        workers.set_suspended(false);
        workers.submit(call(1), true);
        clear(workers, target);
        workers.submit(call(2), true);
        workers.flush();
    };
    explore(1, 1, 2, program, &[1, 1001, 2]);
    explore(1, 2, 1, program, &[1, 1001, 2]);
    explore(2, 1, 3, program, &[1, 1001, 2]);
}

#[test]
fn threads_may_sleep_and_wake_at_any_time() {
    let program = |workers: &Workers, _: &Target| {
        workers.submit(call(1), true);
        workers.set_suspended(false);
        workers.set_suspended(true);
        workers.submit(call(2), true);
        workers.flush();
        workers.set_suspended(false);
        workers.set_suspended(false);
        workers.flush();
    };
    explore(1, 1, 1, program, &[1, 2]);
    explore(2, 1, 2, program, &[1, 2]);
}

#[test]
fn two_may_submit_and_flush() {
    let program = |workers: &Workers, target: &Target| {
        workers.set_suspended(false);
        workers.submit(call(1), true);
        workers.flush();
        // Everything submitted earlier is drawn by now, whatever others submit meanwhile.
        assert_eq!(*target.drawn[0].lock().unwrap(), [1]);
        workers.submit(call(2), true);
        clear(workers, target);
        workers.flush();
    };
    explore(1, 1, 1, program, &[1, 2, 1001]);
}

#[test]
fn what_is_submitted_to_awake_threads_needs_no_other_call() {
    let program = |workers: &Workers, target: &Target| {
        workers.set_suspended(false);
        workers.submit(small(1), true);
        target.wait(target.bins());
        workers.submit(small(2), true);
        target.wait(2 * target.bins());
    };
    explore(1, 1, 2, program, &[1, 2]);
    explore(2, 1, 2, program, &[1, 2]);
    explore(1, 2, 2, program, &[1, 2]);
    // Submitted before the threads wake, while there is no room.
    let program = |workers: &Workers, target: &Target| {
        workers.submit(small(1), true);
        workers.set_suspended(false);
        workers.submit(small(2), true);
        workers.submit_ready(|| Work::Triangles(sink::BinnedTriangles(vec![3])));
        target.wait(3 * target.bins());
    };
    explore(1, 1, 1, program, &[1, 2, 3]);
    explore(2, 1, 2, program, &[1, 2, 3]);
}

#[test]
fn a_thread_of_the_program_may_do_the_work() {
    let program = |workers: &Workers, target: &Target| {
        workers.submit(call(1), true);
        workers.set_suspended(false);
        workers.submit(small(2), true);
        while workers.work_once() {}
        // Other threads may still be working on the rest.
        target.wait(2 * target.bins());
        workers.flush();
        assert!(workers.is_done() && !workers.work_once());
    };
    explore(0, 2, 2, program, &[1, 2]);
    explore(1, 1, 2, program, &[1, 2]);
}
