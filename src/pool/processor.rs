//! The processor on which a thread runs.
//!
//! A woken thread should run alongside its waker, not compete with it for a processor. Linux takes care of that, but as
//! a guest of a hypervisor it seems to mistake a sleeping processor for one that it does not have: occasionally a
//! thread is woken on its waker's processor, and then again every time, because it last ran there and frames are too
//! short for load balancing. The pool then runs at a fraction of its speed, frame after frame.

/// A processor's number.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct Processor(usize);

#[cfg(target_os = "linux")]
impl Processor {
    /// The processor on which the calling thread is running.
    pub fn current() -> Option<Self> {
        // SAFETY: it has no requirements.
        usize::try_from(unsafe { libc::sched_getcpu() }).ok().map(Self)
    }

    /// Moves the calling thread to another processor of its affinity mask, if there is one; it may come back. Returns
    /// false if there is no point in trying again, because it failed or because something else sets the thread's
    /// affinity.
    ///
    /// On newer kernels the thread will then not use processors that are added to the machine later.
    #[must_use]
    pub fn leave(self) -> bool {
        self.leave_while(|| ())
    }

    /// `meanwhile` runs after the thread has moved and before it may return. If the program sets an affinity on the
    /// thread by then, it is kept, because it differs from the one set here. Linux has no atomic compare-and-set for
    /// this, so an affinity that is set between the check and the write, which are one system call apart, is lost.
    fn leave_while(self, meanwhile: impl FnOnce()) -> bool {
        let Some(all) = affinity() else { return false };
        let mut others = all;
        if self.0 >= 8 * size_of_val(&others) {
            return false;
        }
        // SAFETY: both are valid sets, and the number is one of their bits.
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
        // SAFETY: both are valid sets.
        let is_ours = affinity().is_some_and(|now| unsafe { libc::CPU_EQUAL(&now, &others) });
        is_ours && set_affinity(&all)
    }
}

/// The processors that the calling thread may run on.
#[cfg(target_os = "linux")]
fn affinity() -> Option<libc::cpu_set_t> {
    // SAFETY: a set is an array of integers, which may be all zeros, and the size is its own. 0 is the calling thread.
    unsafe {
        let mut set: libc::cpu_set_t = core::mem::zeroed();
        (libc::sched_getaffinity(0, size_of_val(&set), &mut set) == 0).then_some(set)
    }
}

#[cfg(target_os = "linux")]
fn set_affinity(set: &libc::cpu_set_t) -> bool {
    // SAFETY: a valid set and its size. 0 is the calling thread.
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
        // SAFETY: both are valid sets.
        unsafe { libc::CPU_EQUAL(a, b) }
    }

    #[test]
    fn who_leaves_a_processor_may_run_on_it_as_before() {
        let before = affinity().unwrap();
        // With one processor there is nowhere to go.
        let _ = Processor::current().unwrap().leave();
        assert!(equal(&before, &affinity().unwrap()));
        assert!(!Processor(usize::MAX).leave());
        assert!(equal(&before, &affinity().unwrap()));
    }

    #[test]
    fn an_affinity_that_the_program_sets_meanwhile_stays() {
        let before = affinity().unwrap();
        let here = Processor::current().unwrap();
        // SAFETY: sets are arrays of integers, which may be all zeros, and the number is that of a processor.
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
