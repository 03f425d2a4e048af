//! The schedule: which work may be done next, and nothing else.
//!
//! Calls are gathered into batches. A batch is first binned (projected, by one thread), then drawn by every bin, which
//! is a part of the screen. Every bin draws the batches in the order of submission, one thread at a time. So each tile
//! receives the same triangles in the same order as with one thread, whatever the threads do meanwhile.
//!
//! This is a plain state machine; the pool keeps it under one lock and does the work outside the lock. A ready-made
//! queue or a work-stealing pool cannot express an order per bin: each batch would have to wait for the previous one.

use std::collections::VecDeque;

/// A batch accepts calls until it has this weight: the triangles, plus a constant for each call.
pub(super) const BATCH_WEIGHT: usize = 2048;
/// The weight of a call in addition to its triangles.
pub(super) const CALL_WEIGHT: usize = 16;
/// An open batch of this weight is worth a thread's time.
pub(super) const WORTHWHILE: usize = 512;
/// The weight of ready work by which a thread's own bin may lag behind before the thread draws instead of binning more.
const LEAD: usize = 5 * BATCH_WEIGHT / 2;
/// The same for a bin in which another thread drew last, so that its tiles are in that thread's cache, or in which
/// nobody has drawn yet.
const FOREIGN_BIN_LAG: usize = 2 * LEAD;
/// The most batches that a bin draws in one go, so that queries of its tiles need not wait for all of them.
const AT_ONCE: usize = 16;

/// Makes the schedule panic, to test what happens then.
#[cfg(test)]
pub(super) static BREAKS: core::sync::atomic::AtomicBool = core::sync::atomic::AtomicBool::new(false);

/// A thread's next task.
pub(super) enum Task<C, W> {
    /// Bin these calls, then call [`Schedule::binned`].
    Bin { batch: u64, calls: Vec<C> },
    /// Draw these into the bin, in order, then call [`Schedule::drawn`].
    Draw { bin: usize, work: Vec<W> },
}

enum Stage<C, W> {
    /// Accepts calls while it is the last batch.
    Open(Vec<C>),
    /// A thread is binning it.
    Taken,
    Ready(W),
}

struct Batch<C, W> {
    stage: Stage<C, W>,
    /// Number of bins that have not drawn it yet.
    bins_left: usize,
    /// Application calls that end in this batch: a large call is submitted in parts.
    ends: usize,
    /// Total weight of its calls.
    weight: usize,
}

#[derive(Clone, Default)]
struct Bin {
    /// Number of the batch to be drawn next.
    next: u64,
    /// A thread is drawing in it.
    busy: bool,
    /// The thread that drew in it last.
    thread: usize,
}

/// The batches in flight.
pub(super) struct Schedule<C, W> {
    bins: Vec<Bin>,
    batches: VecDeque<Batch<C, W>>,
    /// Number of the first batch in flight, of the first that may still be open, and of the first that is not ready.
    first: u64,
    open: u64,
    ready: u64,
    /// Maximum number of batches in flight, and of calls whose arrays are still read.
    max: usize,
    /// Number of calls whose arrays are still read.
    calls: usize,
}

impl<C, W: Clone> Schedule<C, W> {
    /// A schedule for `bins` bins, with at most `max` batches in flight and at most `max` calls waiting to be binned.
    pub fn new(bins: usize, max: usize) -> Self {
        let (first, open, ready) = (0, 0, 0);
        Self {
            bins: vec![Bin::default(); bins],
            batches: VecDeque::new(),
            first,
            open,
            ready,
            max: max.max(1),
            calls: 0,
        }
    }

    /// Numbers of the first batch in flight and of the next batch to come.
    pub fn in_flight(&self) -> core::ops::Range<u64> {
        self.first..self.first + self.batches.len() as u64
    }

    /// Is nothing in flight?
    pub fn is_done(&self) -> bool {
        self.batches.is_empty()
    }

    /// Changes the number of bins.
    ///
    /// # Panics
    /// If something is in flight.
    pub fn set_bins(&mut self, bins: usize) {
        assert!(self.is_done());
        self.bins = (0..bins).map(|thread| Bin { next: self.first, busy: false, thread }).collect();
    }

    /// Accepts a call or a part of one, or returns it if there is no room. `weight`: its triangles; `ends`: it
    /// completes the call. True: there is now enough work to wake a thread.
    pub fn submit(&mut self, call: C, weight: usize, ends: bool) -> Result<bool, C> {
        if ends && self.calls >= self.max {
            return Err(call);
        }
        let (weight, ends) = (weight + CALL_WEIGHT, usize::from(ends));
        let most = self.batch_calls();
        if let Some(Batch { stage: Stage::Open(calls), ends: ending, weight: sum, .. }) = self.batches.back_mut()
            && *sum + weight <= BATCH_WEIGHT
            && calls.len() < most
        {
            calls.push(call);
            *sum += weight;
            *ending += ends;
            self.calls += ends;
            return Ok(*sum >= WORTHWHILE && *sum - weight < WORTHWHILE || calls.len() == most);
        }
        if self.is_full() {
            return Err(call);
        }
        let closes = matches!(self.batches.back(), Some(Batch { stage: Stage::Open(..), .. }));
        self.push(Stage::Open(vec![call]), ends, weight);
        self.calls += ends;
        Ok(closes || weight >= WORTHWHILE || most == 1)
    }

    /// The most calls in a batch: half of those that may wait, so that one batch fills while another is binned.
    fn batch_calls(&self) -> usize {
        self.max.div_ceil(2)
    }

    /// Is there no room for another batch?
    pub fn is_full(&self) -> bool {
        self.batches.len() >= self.max
    }

    /// Accepts work that needs no binning.
    ///
    /// # Panics
    /// If it is full.
    pub fn submit_ready(&mut self, work: W) {
        assert!(!self.is_full());
        self.push(Stage::Ready(work), 0, 0);
        self.find_ready();
    }

    fn push(&mut self, stage: Stage<C, W>, ends: usize, weight: usize) {
        self.batches.push_back(Batch { stage, bins_left: self.bins.len(), ends, weight });
    }

    fn find_ready(&mut self) {
        let after = |ready: u64| self.batches.get((ready - self.first) as usize);
        let mut ready = self.ready;
        while matches!(after(ready), Some(Batch { stage: Stage::Ready(_), .. })) {
            ready += 1;
        }
        let newly = (self.ready - self.first) as usize..(ready - self.first) as usize;
        self.calls -= self.batches.range(newly).map(|batch| batch.ends).sum::<usize>();
        self.ready = ready;
    }

    /// A task for a thread, if there is one.
    pub fn claim(&mut self, thread: usize) -> Option<Task<C, W>> {
        self.claim_worthwhile(thread).or_else(|| self.claim_batch(0))
    }

    /// The same, except for an open batch that is still too light.
    pub fn claim_worthwhile(&mut self, thread: usize) -> Option<Task<C, W>> {
        #[cfg(test)]
        assert!(!BREAKS.load(core::sync::atomic::Ordering::Relaxed), "broken on purpose");
        // If the thread was the last to draw in a bin, the bin's tiles are in its cache.
        let own = self.most_behind(|bin| bin.thread == thread);
        let any = self.most_behind(|_| true);
        let far = |bin: Option<usize>, lead: usize| bin.filter(|&k| self.is_behind(&self.bins[k], lead));
        // Binning runs ahead of drawing, but not far: what has been drawn hides what is binned.
        if let Some(bin) = far(own, LEAD).or(far(any, FOREIGN_BIN_LAG)) {
            return Some(self.claim_bin(bin, thread));
        }
        self.claim_batch(WORTHWHILE).or_else(|| own.or(any).map(|bin| self.claim_bin(bin, thread)))
    }

    /// The first batch that no thread is binning, unless it is the last one and weighs less than `least`.
    fn claim_batch(&mut self, least: usize) -> Option<Task<C, W>> {
        let (end, most) = (self.in_flight().end, self.batch_calls());
        while self.open < end {
            let number = self.open;
            let batch = &mut self.batches[(number - self.first) as usize];
            if let Stage::Open(calls) = &mut batch.stage {
                if number + 1 == end && batch.weight < least && calls.len() < most {
                    return None;
                }
                let calls = core::mem::take(calls);
                batch.stage = Stage::Taken;
                self.open += 1;
                return Some(Task::Bin { batch: number, calls });
            }
            self.open += 1;
        }
        None
    }

    /// Is there something to draw in the bin, and is nobody drawing in it?
    fn is_due(&self, bin: &Bin) -> bool {
        !bin.busy && bin.next < self.ready
    }

    /// Does a bin have at least `lead` weight left to draw?
    fn is_behind(&self, bin: &Bin, lead: usize) -> bool {
        let mut weight = 0;
        self.batches.range((bin.next - self.first) as usize..(self.ready - self.first) as usize).any(|batch| {
            weight += batch.weight;
            weight >= lead
        })
    }

    /// Of the wanted bins that are due, the one that lags farthest behind.
    fn most_behind(&self, wanted: impl Fn(&Bin) -> bool) -> Option<usize> {
        let due = |&k: &usize| self.is_due(&self.bins[k]) && wanted(&self.bins[k]);
        (0..self.bins.len()).filter(due).min_by_key(|&k| self.bins[k].next)
    }

    /// The work to draw in a bin that is due.
    fn claim_bin(&mut self, bin: usize, thread: usize) -> Task<C, W> {
        self.bins[bin].thread = thread;
        let next = self.bins[bin].next;
        let from = (next - self.first) as usize;
        let to = ((self.ready - self.first) as usize).min(from + AT_ONCE);
        let ready = |batch: &Batch<C, W>| match &batch.stage {
            Stage::Ready(work) => Some(work.clone()),
            _ => None,
        };
        let work: Vec<W> = self.batches.range(from..to).filter_map(ready).collect();
        debug_assert_eq!(work.len(), to - from);
        self.bins[bin].busy = true;
        Task::Draw { bin, work }
    }

    /// Would [`Self::claim`] find something?
    pub fn has_work(&self) -> bool {
        let unbinned = self.batches.range((self.open - self.first) as usize..);
        let mut unbinned = unbinned.map(|batch| &batch.stage);
        unbinned.any(|stage| matches!(stage, Stage::Open(..))) || self.bins.iter().any(|bin| self.is_due(bin))
    }

    /// Reports that a batch was binned.
    pub fn binned(&mut self, batch: u64, work: W) {
        self.batches[(batch - self.first) as usize].stage = Stage::Ready(work);
        self.find_ready();
    }

    /// Reports that a bin drew the next `count` batches. Passes to `done` what all bins have drawn.
    pub fn drawn(&mut self, bin: usize, count: usize, mut done: impl FnMut(W)) {
        let from = (self.bins[bin].next - self.first) as usize;
        for batch in self.batches.range_mut(from..from + count) {
            batch.bins_left -= 1;
        }
        let bin = &mut self.bins[bin];
        (bin.next, bin.busy) = (bin.next + count as u64, false);
        while self.batches.front().is_some_and(|batch| batch.bins_left == 0) {
            if let Some(Batch { stage: Stage::Ready(work), .. }) = self.batches.pop_front() {
                done(work);
            }
            self.first += 1;
        }
        (self.open, self.ready) = (self.open.max(self.first), self.ready.max(self.first));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Plays random turns of submitters and threads, and compares what each bin draws with the order of submission.
    fn play(seed: u64) {
        let mut random = fastrand::Rng::with_seed(seed);
        let (bins, max, threads) = (random.usize(1..6), random.usize(1..5), random.usize(1..5));
        let mut schedule: Schedule<u32, Vec<u32>> = Schedule::new(bins, max);
        let mut drawn: Vec<Vec<u32>> = vec![Vec::new(); bins];
        let mut submitted = Vec::new();
        let mut done = Vec::new();
        let mut tasks: Vec<Task<u32, Vec<u32>>> = Vec::new();
        // Whether each part is the last of its call, and whether it was binned.
        let (mut ends, mut binned): (Vec<bool>, Vec<bool>) = Default::default();
        let parts = random.u32(0..200);
        while (submitted.len() as u32) < parts || !schedule.is_done() {
            let id = submitted.len() as u32;
            let submits = id < parts && (random.bool() || schedule.is_done());
            if submits && random.u8(0..8) == 0 {
                if !schedule.is_full() {
                    schedule.submit_ready(vec![id]);
                    submitted.push(id);
                    ends.push(false);
                    binned.push(true);
                }
            } else if submits {
                let last = random.u8(0..4) != 0;
                if schedule.submit(id, random.usize(0..2 * BATCH_WEIGHT), last).is_ok() {
                    submitted.push(id);
                    ends.push(last);
                    binned.push(false);
                }
            }
            assert!(schedule.in_flight().end - schedule.in_flight().start <= max as u64);
            let unbinned = binned.iter().position(|&binned| !binned).unwrap_or(binned.len());
            assert!(
                ends[unbinned..].iter().filter(|&&last| last).count() <= max,
                "seed {seed}: arrays of too many calls"
            );
            let has_work = schedule.has_work();
            if tasks.len() < threads && random.bool() {
                let task = schedule.claim(random.usize(0..bins + 1));
                assert_eq!(task.is_some(), has_work);
                tasks.extend(task);
            } else if !tasks.is_empty() {
                match tasks.swap_remove(random.usize(0..tasks.len())) {
                    Task::Bin { batch, calls } => {
                        calls.iter().for_each(|&id| binned[id as usize] = true);
                        schedule.binned(batch, calls);
                    }
                    Task::Draw { bin, work } => {
                        drawn[bin].extend(work.iter().flatten());
                        schedule.drawn(bin, work.len(), |work| done.extend(work));
                    }
                }
            }
            // No work is left behind for lack of a thread to wake: without tasks, either there is work or everything is
            // done.
            assert!(!tasks.is_empty() || schedule.has_work() || schedule.is_done());
        }
        assert!(drawn.iter().all(|drawn| *drawn == submitted), "seed {seed}");
        assert_eq!(done, submitted);
    }

    #[test]
    fn every_bin_draws_everything_in_the_order_of_submission() {
        (0..20_000).for_each(play);
    }

    #[test]
    fn small_calls_share_a_batch_and_a_thread_is_woken_once() {
        let mut schedule: Schedule<u32, Vec<u32>> = Schedule::new(1, 400);
        let mut woken = 0;
        let fit = BATCH_WEIGHT / (12 + CALL_WEIGHT);
        for id in 0..fit as u32 {
            woken += u32::from(schedule.submit(id, 12, true).unwrap());
        }
        assert_eq!((schedule.in_flight(), woken), (0..1, 1));
        assert!(schedule.submit(0, 12, true).unwrap());
        assert_eq!(schedule.in_flight(), 0..2);
    }

    #[test]
    fn no_more_calls_wait_to_be_kept_than_were_asked_for() {
        for (most, batches) in [(1, 1), (2, 2), (5, 2), (32, 2)] {
            let mut schedule: Schedule<u32, Vec<u32>> = Schedule::new(1, most);
            for id in 0..most as u32 {
                assert!(schedule.submit(id, 1, true).is_ok());
            }
            assert_eq!(schedule.submit(7, 1, true), Err(7));
            assert_eq!(schedule.in_flight(), 0..batches);
            // One batch is binned: the arrays of its calls are no longer read, though nothing is drawn.
            let Some(Task::Bin { batch, calls }) = schedule.claim(0) else { panic!("a full batch is worth binning") };
            schedule.binned(batch, calls);
            assert_eq!(
                schedule.submit(7, 1, true).is_ok(),
                (batches as usize) < most,
                "{most}: no more batches, either"
            );
        }
    }
}
