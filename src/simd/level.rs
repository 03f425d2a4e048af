//! Detects the processor's instruction sets, and runs jobs on them.

use super::Job;
use super::scalar;
use crate::Implementation;

/// Whether the kernel is compiled for scalar code, which is large and slow to compile: where nothing else would be, or
/// if the feature asks for it.
const SCALAR: bool = cfg!(any(
    feature = "scalar",
    not(any(
        target_arch = "x86",
        target_arch = "x86_64",
        target_arch = "aarch64",
        all(target_arch = "wasm32", target_feature = "simd128")
    ))
));

/// The instruction sets that the kernel is compiled for, the simplest first. Any processor has the first one.
const COMPILED: &[Implementation] = {
    use Implementation::*;
    const ALL: &[Implementation] = &[
        Scalar,
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Sse2,
        #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), feature = "sse41"))]
        Sse41,
        #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), feature = "avx2"))]
        Avx2,
        #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), feature = "avx512"))]
        Avx512,
        #[cfg(target_arch = "aarch64")]
        Neon,
        // A module uses simd128 either throughout or not at all.
        #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
        Simd128,
    ];
    if SCALAR { ALL } else { ALL.split_at(1).1 }
};

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
        Self::all().next_back().unwrap_or(Self(COMPILED[0]))
    }

    /// The best that this processor has up to `highest`, see [`Implementation::capped`].
    pub fn capped(highest: Implementation) -> Self {
        if !highest.is_of_this_architecture() {
            return Self::best();
        }
        Self::all().rfind(|level| level.0 as i32 <= highest as i32).unwrap_or(Self(COMPILED[0]))
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
    /// Every instruction set that the library is compiled for and this processor has, the simplest first.
    pub fn available() -> &'static [Implementation] {
        available()
    }

    /// The best of the [available](Self::available) instruction sets up to `self`, or the simplest one if all are above
    /// it. If `self` belongs to another architecture, there is no limit.
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
        #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), feature = "avx512"))]
        // SAFETY: only detection creates a level, so the processor has the instruction set.
        Implementation::Avx512 => unsafe { super::avx512::enter(job) },
        #[cfg(all(test, any(target_arch = "x86", target_arch = "x86_64"), feature = "avx2"))]
        // SAFETY: as above.
        Implementation::Avx2 if SIXTEEN_LANES.get() => unsafe { super::avx2::enter_sixteen_lanes(job) },
        #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), feature = "avx2"))]
        // SAFETY: as above.
        Implementation::Avx2 => unsafe { super::avx2::enter(job) },
        #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), feature = "sse41"))]
        // SAFETY: as above.
        Implementation::Sse41 => unsafe { super::sse::enter_sse41(job) },
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Implementation::Sse2 => super::sse::enter_sse2(job),
        #[cfg(target_arch = "aarch64")]
        Implementation::Neon => super::neon::enter(job),
        #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
        Implementation::Simd128 => super::wasm::enter(job),
        _ => {
            if SCALAR {
                scalar::enter(job)
            } else {
                unreachable!("no level is created of an instruction set that the kernel is not compiled for")
            }
        }
    }
}

/// The same with at most eight lanes, for work that sixteen cannot do. The bits are the same.
#[inline]
pub(crate) fn run_on_eight_lanes<J: Job>(level: Level, job: J) -> J::Output {
    match level.0 {
        #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), feature = "avx2"))]
        // SAFETY: only detection creates a level, and it reports AVX-512 only together with AVX2.
        Implementation::Avx512 | Implementation::Avx2 => unsafe { super::avx2::enter(job) },
        _ => run(level, job),
    }
}

#[cfg(all(test, any(target_arch = "x86", target_arch = "x86_64"), feature = "avx2"))]
std::thread_local! {
    static SIXTEEN_LANES: core::cell::Cell<bool> = const { core::cell::Cell::new(false) };
}

/// Calls `what` with sixteen lanes, as two vectors side by side, in place of AVX2's eight, on this thread only: tests
/// the code for sixteen lanes without AVX-512.
#[cfg(all(test, any(target_arch = "x86", target_arch = "x86_64"), feature = "avx2"))]
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

/// The instruction sets that the kernel is compiled for and this processor has, the simplest first.
fn available() -> &'static [Implementation] {
    let count = COMPILED.iter().take_while(|&&implementation| is_detected(implementation)).count();
    &COMPILED[..count]
}

/// Whether this processor has an instruction set that the kernel is compiled for.
fn is_detected(implementation: Implementation) -> bool {
    match implementation {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Implementation::Sse41 => is_x86_feature_detected!("sse4.1") && is_x86_feature_detected!("ssse3"),
        // Every processor with AVX2 has these, but a virtual machine may hide them.
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Implementation::Avx2 => {
            is_detected(Implementation::Sse41)
                && is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("fma")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2")
                && is_x86_feature_detected!("lzcnt")
                && is_x86_feature_detected!("popcnt")
        }
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Implementation::Avx512 => {
            is_detected(Implementation::Avx2)
                && is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl")
        }
        // The others are part of the target.
        _ => true,
    }
}
