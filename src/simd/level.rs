//! Detects the processor's instruction sets, and runs jobs on them.

use super::Job;
#[cfg(target_arch = "aarch64")]
use super::neon;
use super::scalar;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
use super::wasm;
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
use super::{avx2, avx512, sse};
use crate::Implementation;

/// An instruction set that this processor has. Only detection creates one, which makes [`run`] safe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Level(Implementation);

impl Level {
    /// All levels that this processor has, the simplest first.
    pub fn all() -> impl DoubleEndedIterator<Item = Self> {
        available().iter().map(|&implementation| Self(implementation))
    }

    /// The best that this processor has.
    pub fn best() -> Self {
        Self::all().next_back().unwrap_or(Self(Implementation::Scalar))
    }

    /// The best that this processor has up to `highest`, see [`Implementation::capped`].
    pub fn capped(highest: Implementation) -> Self {
        if highest == Implementation::Scalar {
            return Self(Implementation::Scalar);
        }
        if !highest.is_of_this_architecture() {
            return Self::best();
        }
        Self::all().rfind(|level| level.0 as i32 <= highest as i32).unwrap_or(Self(Implementation::Scalar))
    }

    /// This instruction set, if the processor has it.
    #[cfg(test)]
    pub fn of(implementation: Implementation) -> Option<Self> {
        Self::all().find(|level| level.0 == implementation)
    }

    pub fn implementation(self) -> Implementation {
        self.0
    }
}

impl Implementation {
    /// Every instruction set that this processor can run, the simplest first.
    pub fn available() -> &'static [Implementation] {
        available()
    }

    /// The best instruction set that this processor has, up to `self`. If `self` belongs to another architecture and is
    /// not `Scalar`, there is no limit.
    pub fn capped(self) -> Implementation {
        Level::capped(self).implementation()
    }

    /// Whether it belongs to the architecture that the library is compiled for (the processor may still lack it).
    fn is_of_this_architecture(self) -> bool {
        match self {
            Implementation::Scalar => true,
            Implementation::Sse2 | Implementation::Sse41 | Implementation::Avx2 | Implementation::Avx512 => {
                cfg!(any(target_arch = "x86_64", target_arch = "x86"))
            }
            Implementation::Neon => cfg!(target_arch = "aarch64"),
            Implementation::Simd128 => cfg!(target_arch = "wasm32"),
        }
    }
}

/// Runs `job` on an instruction set.
#[inline]
pub(crate) fn run<J: Job>(level: Level, job: J) -> J::Output {
    match level.0 {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        // SAFETY: only detection creates a level, so the processor has the instruction set.
        Implementation::Avx512 => unsafe { avx512::enter(job) },
        #[cfg(all(test, any(target_arch = "x86", target_arch = "x86_64")))]
        // SAFETY: as above.
        Implementation::Avx2 if SIXTEEN_LANES.get() => unsafe { avx2::enter_sixteen_lanes(job) },
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        // SAFETY: as above.
        Implementation::Avx2 => unsafe { avx2::enter(job) },
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        // SAFETY: as above.
        Implementation::Sse41 => unsafe { sse::enter_sse41(job) },
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Implementation::Sse2 => sse::enter_sse2(job),
        #[cfg(target_arch = "aarch64")]
        Implementation::Neon => neon::enter(job),
        #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
        Implementation::Simd128 => wasm::enter(job),
        _ => scalar::enter(job),
    }
}

/// The same with at most eight lanes, for work that sixteen cannot do. The bits are the same.
#[inline]
pub(crate) fn run_on_eight_lanes<J: Job>(level: Level, job: J) -> J::Output {
    match level.0 {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        // SAFETY: only detection creates a level, and it reports AVX-512 only together with AVX2.
        Implementation::Avx512 | Implementation::Avx2 => unsafe { avx2::enter(job) },
        _ => run(level, job),
    }
}

#[cfg(all(test, any(target_arch = "x86", target_arch = "x86_64")))]
std::thread_local! {
    static SIXTEEN_LANES: core::cell::Cell<bool> = const { core::cell::Cell::new(false) };
}

/// Calls `what` with sixteen lanes, as two vectors side by side, in place of AVX2's eight, on this thread only: tests
/// the code for sixteen lanes without AVX-512.
#[cfg(all(test, any(target_arch = "x86", target_arch = "x86_64")))]
pub(crate) fn with_sixteen_lanes<R>(what: impl FnOnce() -> R) -> R {
    struct Reset;
    impl Drop for Reset {
        fn drop(&mut self) {
            SIXTEEN_LANES.set(false);
        }
    }
    let _reset = Reset;
    SIXTEEN_LANES.set(true);
    what()
}

/// The instruction sets that this processor can run, the simplest first.
fn available() -> &'static [Implementation] {
    use Implementation::*;
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        const ALL: [Implementation; 5] = [Scalar, Sse2, Sse41, Avx2, Avx512];
        let sse41 = is_x86_feature_detected!("sse4.1") && is_x86_feature_detected!("ssse3");
        // Every processor with AVX2 has these, but a virtual machine may hide them.
        let avx2 = sse41
            && is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        let avx512 = avx2
            && is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl");
        &ALL[..2 + usize::from(sse41) + usize::from(avx2) + usize::from(avx512)]
    }
    #[cfg(target_arch = "aarch64")]
    {
        &[Scalar, Neon]
    }
    #[cfg(target_arch = "wasm32")]
    {
        // A module uses simd128 either throughout or not at all.
        if cfg!(target_feature = "simd128") { &[Scalar, Simd128] } else { &[Scalar] }
    }
    #[cfg(not(any(target_arch = "x86", target_arch = "x86_64", target_arch = "aarch64", target_arch = "wasm32")))]
    {
        &[Scalar]
    }
}
