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

    /// Moves the calling thread to another one of those that it may run on, if there is one; it may come back. False: not
    /// again, for that did not work.
    ///
    /// On newer kernels the thread then keeps to the processors that there were, if others are added to the machine.
    #[must_use]
    pub fn leave(self) -> bool {
        let size = size_of::<libc::cpu_set_t>();
        if self.0 >= 8 * size {
            return false;
        }
        // SAFETY: a set is an array of integers, for which zeros will do, and `size` is its size; the number is one of its
        // bits. 0 is the calling thread.
        unsafe {
            let mut all: libc::cpu_set_t = core::mem::zeroed();
            if libc::sched_getaffinity(0, size, &mut all) != 0 || libc::CPU_COUNT(&all) < 2 {
                return false;
            }
            let mut others = all;
            libc::CPU_CLR(self.0, &mut others);
            libc::sched_setaffinity(0, size, &others) == 0 && libc::sched_setaffinity(0, size, &all) == 0
        }
    }
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
    use super::Processor;

    fn allowed() -> libc::cpu_set_t {
        // SAFETY: as in `leave`.
        unsafe {
            let mut all: libc::cpu_set_t = core::mem::zeroed();
            assert_eq!(libc::sched_getaffinity(0, size_of::<libc::cpu_set_t>(), &mut all), 0);
            all
        }
    }

    #[test]
    fn who_leaves_a_processor_may_run_on_it_as_before() {
        let before = allowed();
        // With one processor there is none to go to.
        let _ = Processor::current().unwrap().leave();
        // SAFETY: both are sets.
        assert!(unsafe { libc::CPU_EQUAL(&before, &allowed()) });
        assert!(!Processor(usize::MAX).leave());
        // SAFETY: as above.
        assert!(unsafe { libc::CPU_EQUAL(&before, &allowed()) });
    }
}
