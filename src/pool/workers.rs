//! The threads of a pool: they take work, do it, and sleep when there is none.
//!
//! While a worker thread is awake, submitted work never waits for a further call: a thread that leaves work behind
//! ensures that a worker checks for it ([`Workers::leave_to_threads`]).
//!
//! Callers lend the data that they submit until a flush returns. A panic in the scheduler, which would be a bug, could
//! make the flush return early or never, so it aborts the process (as in rayon); a panic while drawing is caught, and
//! occluders are missing.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::PoisonError;

use super::processor::Processor;
use super::schedule::{Schedule, Task};
use super::sync::{Arc, Condvar, Mutex, MutexGuard, SpinWait, external_thread};
use super::target::{Call, Target, Work};
use crate::sink::BinnedTriangles;

/// Aborts the process if `action` panics, since that would leave the state inconsistent.
fn abort_on_panic<R>(action: impl FnOnce() -> R) -> R {
    struct Abort;
    impl Drop for Abort {
        fn drop(&mut self) {
            eprintln!("masked-occlusion-culling: the scheduler of a thread pool panicked, which is a bug; aborting");
            std::process::abort();
        }
    }
    let abort = Abort;
    let result = action();
    core::mem::forget(abort);
    result
}

/// State shared by the threads.
pub(super) struct Workers {
    state: Mutex<State>,
    /// There may be work.
    work: Condvar,
    /// Something has been finished.
    progress: Condvar,
    /// Counts finished tasks.
    finished: SpinWait,
    /// Counts submissions that make a batch worth taking.
    news: SpinWait,
}

struct State {
    schedule: Schedule<Call, Arc<Work>>,
    target: Option<Arc<Target>>,
    /// Memory for reuse.
    spare: Vec<BinnedTriangles>,
    /// Worker threads; how many of them wait for work; and how many of those have been notified but are not awake yet.
    threads: usize,
    idle: usize,
    woken: usize,
    /// The processor on which the last waker ran.
    waker: Option<Processor>,
    /// Number of threads that wait for progress.
    waiting: usize,
    suspended: bool,
    stopped: bool,
}

impl State {
    /// Called after each submission.
    fn begin(&self, was_done: bool) {
        if was_done && let Some(target) = &self.target {
            target.turn();
        }
    }
}

impl Workers {
    pub fn new(max_jobs: usize) -> Self {
        let schedule = Schedule::new(1, max_jobs);
        let state = State {
            schedule,
            target: None,
            spare: Vec::new(),
            threads: 0,
            idle: 0,
            woken: 0,
            waker: None,
            waiting: 0,
            suspended: true,
            stopped: false,
        };
        Self {
            state: Mutex::new(state),
            work: Condvar::new(),
            progress: Condvar::new(),
            finished: SpinWait::default(),
            news: SpinWait::default(),
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing panics while holding the lock; even if it did, the state would still be consistent.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The main loop of a pool thread, until [`Self::stop`].
    pub fn work(&self, number: usize) {
        abort_on_panic(|| self.take_turns(number));
    }

    fn take_turns(&self, number: usize) {
        let mut state = self.lock();
        state.threads += 1;
        // Whether the last wake-up was on the waker's processor without leaving it, and whether leaving is still
        // allowed.
        let (mut in_turn, mut may_leave) = (false, true);
        // Whether it has already spun for more work since its last task or sleep.
        let mut waited = false;
        while !state.stopped {
            let task = match state.suspended {
                true => None,
                false if waited => state.schedule.claim(number),
                false => state.schedule.claim_worthwhile(number),
            };
            state = match task {
                Some(task) => {
                    waited = false;
                    self.perform(state, task)
                }
                // Small calls arrive faster than a thread wakes, and a batch of several is cheaper.
                None if !waited && !state.suspended => {
                    waited = true;
                    let count = self.news.count();
                    drop(state);
                    self.news.wait(count);
                    self.lock()
                }
                None => {
                    state.idle += 1;
                    let mut state = self.work.wait(state).unwrap_or_else(PoisonError::into_inner);
                    state.idle -= 1;
                    waited = false;
                    state.woken = state.woken.saturating_sub(1);
                    // Taken, so that it is not counted again if all threads are woken.
                    let waker = state.waker.take();
                    let shared = Processor::current().filter(|&here| waker == Some(here));
                    if let Some(here) = shared
                        && in_turn
                        && may_leave
                    {
                        drop(state);
                        may_leave = here.leave();
                        state = self.lock();
                    }
                    // Once may be a coincidence.
                    in_turn = shared.is_some() && !in_turn;
                    state
                }
            };
        }
    }

    /// Wakes a sleeping thread if there is work, but only one at a time: waking takes a system call, and it takes tens
    /// of microseconds until the thread runs, during which others may do its work.
    fn wake(&self, state: &mut State) {
        if state.idle > state.woken && !state.suspended && state.schedule.has_work() {
            state.woken += 1;
            state.waker = Processor::current();
            self.work.notify_one();
        }
    }

    /// Wakes a worker for remaining work if none is awake to find it.
    fn leave_to_threads(&self, state: &mut State) {
        if state.idle == state.threads && state.woken == 0 {
            self.wake(state);
        }
    }

    /// Performs a task, outside the lock.
    fn perform<'a>(&'a self, mut state: MutexGuard<'a, State>, task: Task<Call, Arc<Work>>) -> MutexGuard<'a, State> {
        // Each thread wakes the next, so that a submission wakes at most one.
        self.wake(&mut state);
        let target = state.target.clone();
        match task {
            Task::Bin { batch, calls } => {
                let mut binned = state.spare.pop().unwrap_or_default();
                drop(state);
                let bin = || {
                    if let Some(target) = &target {
                        // SAFETY: the submitter guarantees that the calls' data is valid until the pool has been
                        // flushed, and a flush waits for this.
                        unsafe { target.bin(&calls, &mut binned) };
                    }
                };
                // A panic would be a bug in this library. Missing occluders are safe, and no thread is left waiting.
                if catch_unwind(AssertUnwindSafe(bin)).is_err() {
                    binned.clear();
                }
                drop(target);
                state = self.lock();
                state.schedule.binned(batch, Arc::new(Work::Triangles(binned)));
            }
            Task::Draw { bin, work } => {
                drop(state);
                if let Some(target) = &target {
                    target.draw(bin, &work);
                }
                let count = work.len();
                drop((work, target));
                state = self.lock();
                let State { schedule, spare, target, .. } = &mut *state;
                schedule.drawn(bin, count, |work| {
                    if let Ok(Work::Triangles(binned)) = Arc::try_unwrap(work) {
                        spare.push(binned);
                    }
                });
                if schedule.is_done()
                    && let Some(target) = target
                {
                    target.turn();
                }
            }
        }
        self.finished.changed();
        if state.waiting > 0 {
            self.progress.notify_all();
        }
        state
    }

    /// Performs a task, or waits until another thread has performed one.
    fn help<'a>(&'a self, mut state: MutexGuard<'a, State>) -> MutexGuard<'a, State> {
        if let Some(task) = state.schedule.claim(external_thread()) {
            return self.perform(state, task);
        }
        // The last task of a frame takes less time than sleeping and waking.
        let count = self.finished.count();
        drop(state);
        self.finished.wait(count);
        state = self.lock();
        if self.finished.count() != count {
            return state;
        }
        state.waiting += 1;
        let mut state = self.progress.wait(state).unwrap_or_else(PoisonError::into_inner);
        state.waiting -= 1;
        state
    }

    /// Submits a call or a part of one; `ends`: it completes the call. If there is no room, the caller works until
    /// there is.
    pub fn submit(&self, mut call: Call, ends: bool) {
        let weight = call.indices / 3;
        abort_on_panic(|| {
            let mut state = self.lock();
            loop {
                // Under the lock, so that clears and calls are ordered relative to each other.
                call.clears = state.target.as_ref().map_or(0, |target| target.clears());
                let was_done = state.schedule.is_done();
                match state.schedule.submit(call, weight, ends) {
                    Ok(worthwhile) => {
                        state.begin(was_done);
                        if worthwhile {
                            self.news.changed();
                            self.wake(&mut state);
                        } else {
                            self.leave_to_threads(&mut state);
                        }
                        return;
                    }
                    Err(back) => call = back,
                }
                state = self.help(state);
            }
        });
    }

    /// The same for work that does not need binning.
    pub fn submit_ready(&self, work: impl FnOnce() -> Work) {
        abort_on_panic(|| self.leave_to_threads(&mut self.push_ready(work)));
    }

    /// Draws everything submitted, then this, before it returns. If nothing else is in flight, no thread is woken for
    /// it.
    pub fn do_now(&self, work: impl FnOnce() -> Work) {
        self.flush();
        abort_on_panic(|| self.finish(self.push_ready(work)));
    }

    fn push_ready(&self, work: impl FnOnce() -> Work) -> MutexGuard<'_, State> {
        let mut state = self.lock();
        while state.schedule.is_full() {
            state = self.help(state);
        }
        let was_done = state.schedule.is_done();
        // Created under the lock, so that clears are numbered in the order in which they are performed.
        state.schedule.submit_ready(Arc::new(work()));
        state.begin(was_done);
        state
    }

    /// Works until everything in flight is drawn.
    pub fn flush(&self) {
        abort_on_panic(|| {
            let mut state = self.lock();
            self.wake(&mut state);
            self.finish(state);
        });
    }

    fn finish<'a>(&'a self, mut state: MutexGuard<'a, State>) {
        let end = state.schedule.in_flight().end;
        while state.schedule.in_flight().start < end {
            state = self.help(state);
        }
        // Other threads may have submitted meanwhile.
        self.leave_to_threads(&mut state);
    }

    /// Performs one task, if one is pending that no thread has taken.
    pub fn work_once(&self) -> bool {
        abort_on_panic(|| {
            let mut state = self.lock();
            let Some(task) = state.schedule.claim(external_thread()) else { return false };
            let mut state = self.perform(state, task);
            self.leave_to_threads(&mut state);
            true
        })
    }

    /// Is nothing in flight?
    pub fn is_done(&self) -> bool {
        self.lock().schedule.is_done()
    }

    /// Switches to another target. Nothing may be in flight, and the caller must prevent submissions meanwhile.
    pub fn set_target(&self, target: Option<Arc<Target>>) {
        abort_on_panic(|| {
            let mut state = self.lock();
            state.schedule.set_bins(target.as_ref().map_or(1, |target| target.bins()));
            state.target = target;
        });
    }

    pub fn set_suspended(&self, suspended: bool) {
        self.lock().suspended = suspended;
        self.work.notify_all();
    }

    /// Ends [`Self::work`].
    pub fn stop(&self) {
        self.lock().stopped = true;
        self.work.notify_all();
    }
}
