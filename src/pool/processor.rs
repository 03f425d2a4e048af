//! On which processor a thread runs.
//!
//! A thread that is woken should work beside who woke it, not in turn with it. Linux sees to that, but as the guest of a
//! hypervisor it seems to take a processor that sleeps for one that it was not given: now and then a thread was woken on the
//! processor of who woke it, and then again and again, for it ran there last and frames are too short for loads to be
//! balanced. A pool of one thread drew a castle at half of its speed then, frame after frame.

/// A processor's number.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Processor(usize);

#[cfg(target_os = "linux")]
impl Processor {
    /// The one that the calling thread runs on.
    pub fn current() -> Option<Self> {
        // SAFETY: it has no requirements.
        usize::try_from(unsafe { libc::sched_getcpu() }).ok().map(Self)
    }

    /// Moves the calling thread to another one of those that it may run on, if there is one; it may come back. False: do not
    /// try again, because it failed or because something else sets the thread's affinity.
    ///
    /// On newer kernels the thread then keeps to the processors that there were, if others are added to the machine.
    #[must_use]
    pub fn leave(self) -> bool {
        self.leave_while(|| ())
    }

    /// `meanwhile` runs once the thread has moved and may not return yet. An affinity that the program sets on the thread by
    /// then is kept, because it differs from the one set here. Linux has no atomic compare-and-set for this, so an
    /// affinity set between the check and the write, a system call apart, is lost.
    fn leave_while(self, meanwhile: impl FnOnce()) -> bool {
        let Some(all) = affinity() else { return false };
        let mut others = all;
        if self.0 >= 8 * size_of_val(&others) {
            return false;
        }
        // SAFETY: the two are sets, and the number is one of their bits.
        unsafe {
            if libc::CPU_COUNT(&all) < 2 {
                return false;
            }
            libc::CPU_CLR(self.0, &mut others);
        }
        if !set_affinity(&others) {
            return false;
        }
        meanwhile();
        // SAFETY: both are sets.
        let is_ours = affinity().is_some_and(|now| unsafe { libc::CPU_EQUAL(&now, &others) });
        is_ours && set_affinity(&all)
    }
}

/// The processors that the calling thread may run on.
#[cfg(target_os = "linux")]
fn affinity() -> Option<libc::cpu_set_t> {
    // SAFETY: a set is an array of integers, for which zeros will do, and the size is its own. 0 is the calling thread.
    unsafe {
        let mut set: libc::cpu_set_t = core::mem::zeroed();
        (libc::sched_getaffinity(0, size_of_val(&set), &mut set) == 0).then_some(set)
    }
}

#[cfg(target_os = "linux")]
fn set_affinity(set: &libc::cpu_set_t) -> bool {
    // SAFETY: a set and its size. 0 is the calling thread.
    unsafe { libc::sched_setaffinity(0, size_of_val(set), set) == 0 }
}

#[cfg(not(target_os = "linux"))]
impl Processor {
    pub fn current() -> Option<Self> {
        None
    }

    pub fn leave(self) -> bool {
        false
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::{Processor, affinity, set_affinity};

    fn equal(a: &libc::cpu_set_t, b: &libc::cpu_set_t) -> bool {
        // SAFETY: both are sets.
        unsafe { libc::CPU_EQUAL(a, b) }
    }

    #[test]
    fn who_leaves_a_processor_may_run_on_it_as_before() {
        let before = affinity().unwrap();
        // With one processor there is none to go to.
        let _ = Processor::current().unwrap().leave();
        assert!(equal(&before, &affinity().unwrap()));
        assert!(!Processor(usize::MAX).leave());
        assert!(equal(&before, &affinity().unwrap()));
    }

    #[test]
    fn an_affinity_that_the_program_sets_meanwhile_stays() {
        let before = affinity().unwrap();
        let here = Processor::current().unwrap();
        // SAFETY: sets are arrays of integers, for which zeros will do, and the number is that of a processor.
        let (several, pinned) = unsafe {
            let mut pinned: libc::cpu_set_t = core::mem::zeroed();
            libc::CPU_SET(here.0, &mut pinned);
            (libc::CPU_COUNT(&before) > 1, pinned)
        };
        let moved = here.leave_while(|| assert!(set_affinity(&pinned)));
        assert!(!moved);
        if several {
            assert!(equal(&pinned, &affinity().unwrap()));
        }
        assert!(set_affinity(&before));
    }
}
