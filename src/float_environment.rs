//! Runs calls in the floating-point environment that the compiler assumes: round to nearest, denormals kept, no traps.
//!
//! Engines change it per thread: another rounding mode, denormals flushed to zero, exceptions that raise a signal.
//! Identical bits and conservative answers need the default, and a division by zero whose result is masked out later
//! must not end the program. So every exported function reads the control register, which is very cheap; only if it
//! differs from the default is it set, and restored at the end.

/// Whether the calling thread is in the default floating-point environment.
#[inline]
pub(crate) fn is_default() -> bool {
    control::is_default(control::read())
}

/// Runs `body` in the default floating-point environment.
#[inline]
pub(crate) fn in_default_environment<R>(body: impl FnOnce() -> R) -> R {
    if is_default() { body() } else { elsewhere(body) }
}

#[cold]
#[inline(never)]
fn elsewhere<R>(body: impl FnOnce() -> R) -> R {
    /// Restores the previous value, even while a panic unwinds.
    struct SetBack(control::Register);
    impl Drop for SetBack {
        fn drop(&mut self) {
            control::write(self.0);
        }
    }

    let _before = SetBack(control::read());
    control::write(control::DEFAULT);
    let (mut body, mut result) = (Some(body), None);
    let mut call: &mut dyn FnMut() = &mut || result = body.take().map(|body| body());
    // Opaque to the compiler, which could otherwise move arithmetic past the two writes.
    core::hint::black_box(&mut call)();
    result.expect("the body ran")
}

/// Rounds to the nearest integer, ties to even, by additions. `x` is below 2^51 in magnitude, or NaN.
///
/// The standard library calls C's `rint` if the baseline has no such instruction, and MinGW's `rint` obeys the x87
/// control word, which engines also change and which this library does not set.
#[inline]
pub(crate) fn round_ties_even(x: f64) -> f64 {
    // 1.5 * 2^52: the unit in the last place of the sum is one, so the addition rounds.
    const SHIFT: f64 = 6_755_399_441_055_744.0;
    ((x + SHIFT) - SHIFT).copysign(x)
}

/// MXCSR: six exception flags in the low bits, control bits above them.
#[cfg(any(target_arch = "x86_64", all(target_arch = "x86", target_feature = "sse")))]
mod control {
    use core::arch::asm;

    pub type Register = u32;
    /// All exceptions masked, round to nearest, denormals kept.
    pub const DEFAULT: Register = 0x1f80;

    #[inline]
    pub fn is_default(register: Register) -> bool {
        register & !0x3f == DEFAULT
    }

    #[inline]
    pub fn read() -> Register {
        let mut register = 0u32;
        // SAFETY: it only writes the four bytes of the operand.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut register, options(nostack, preserves_flags)) };
        register
    }

    #[inline]
    pub fn write(register: Register) {
        // SAFETY: it only reads the four bytes of the operand. The value is either the default, which compiled code
        // assumes, or the previous value, restored before the caller's code continues.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const register, options(nostack, preserves_flags)) };
    }
}

/// FPCR: rounding, flushing, default NaNs and traps; all zero by default.
#[cfg(target_arch = "aarch64")]
mod control {
    use core::arch::asm;

    pub type Register = u64;
    pub const DEFAULT: Register = 0;

    #[inline]
    pub fn is_default(register: Register) -> bool {
        register == DEFAULT
    }

    #[inline]
    pub fn read() -> Register {
        let register: u64;
        // SAFETY: it reads a register of the thread.
        unsafe { asm!("mrs {}, fpcr", out(reg) register, options(nomem, nostack, preserves_flags)) };
        register
    }

    #[inline]
    pub fn write(register: Register) {
        // SAFETY: the value is either the default, which compiled code assumes, or the previous value, restored before
        // the caller's code continues.
        unsafe { asm!("msr fpcr, {}", in(reg) register, options(nostack, preserves_flags)) };
    }
}

/// No such control register, or none that is supported here.
#[cfg(not(any(target_arch = "x86_64", all(target_arch = "x86", target_feature = "sse"), target_arch = "aarch64")))]
mod control {
    pub type Register = ();
    pub const DEFAULT: Register = ();

    #[inline]
    pub fn is_default((): Register) -> bool {
        true
    }

    #[inline]
    pub fn read() -> Register {}

    #[inline]
    pub fn write((): Register) {}
}

#[cfg(test)]
mod rounding {
    use super::round_ties_even;

    #[test]
    fn it_rounds_as_the_standard_library_does() {
        let mut random = fastrand::Rng::with_seed(3);
        let largest = f64::from(1u32 << 31) * f64::from(1 << 20) - 1.0;
        let mut all =
            vec![0.0, 0.5, 1.5, 2.5, 0.499_999_999_999_999_94, f64::MIN_POSITIVE, f64::NAN, largest, largest - 0.5];
        for bits in 0..51 {
            let power = (1u64 << bits) as f64;
            all.extend([power - 0.5, power, power + 0.5]);
            all.extend((0..200).map(|_| random.f64() * power));
            all.extend((0..20).map(|_| (random.f64() * power).floor() + 0.5));
        }
        for x in all.iter().filter(|x| x.is_nan() || x.abs() <= largest).flat_map(|x| [*x, -x]) {
            let (is, should) = (round_ties_even(x), x.round_ties_even());
            assert!(
                is.to_bits() == should.to_bits() || is.is_nan() && should.is_nan(),
                "{x:e}: {is:e}, not {should:e}"
            );
        }
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;

    #[test]
    fn the_environment_is_the_default_inside_and_as_before_outside() {
        // Round up, flush denormals, trap all exceptions except inexact and denormal.
        let odd = 0xd140;
        let inside = |odd| {
            control::write(odd);
            let seen = in_default_environment(|| control::read() & !0x3f);
            let after = control::read();
            control::write(control::DEFAULT);
            (seen, after)
        };
        assert_eq!(inside(odd), (control::DEFAULT, odd));
        assert_eq!(inside(control::DEFAULT | 1), (control::DEFAULT, control::DEFAULT | 1));
        control::write(odd);
        let panicked = std::panic::catch_unwind(|| in_default_environment(|| std::panic::resume_unwind(Box::new(()))));
        let after = control::read();
        control::write(control::DEFAULT);
        assert!(panicked.is_err());
        assert_eq!(after, odd);
    }
}
