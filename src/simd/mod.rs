//! The vector layer: only the operations that the kernel needs, identical on every instruction set.
//!
//! The kernel is written once, generic over [`Simd`], and is entered through [`run`]. That takes a [`Level`] created by
//! detection, selects the token of that instruction set (a zero-sized value whose existence proves that the processor
//! has it) and calls the [`Job`] inside a function compiled for it. For this to work, everything in between is
//! `#[inline(always)]`: a helper that is not inlined is compiled for the baseline, and each intrinsic in it becomes a
//! call.
//!
//! Every operation gives the same bits everywhere. Where instruction sets differ, this layer defines the result: `min`
//! and `max` return their second operand if either is NaN (as on x86), division is IEEE division, nothing is fused
//! (except in `mul_add_d`), and rounding to integers is to nearest even.

#[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), feature = "avx2"))]
mod avx2;
#[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), feature = "avx512"))]
mod avx512;
mod compress;
mod level;
#[cfg(target_arch = "aarch64")]
mod neon;
mod pair;
mod scalar;
#[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
mod sse;
#[cfg(test)]
mod tests;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod wasm;

#[cfg(all(target_arch = "x86", not(target_feature = "sse2")))]
compile_error!(
    "without SSE2 floats are rounded as the x87 unit does, and the same bits everywhere cannot be promised: \
    build for i686, not for i586"
);

#[cfg(target_arch = "x86")]
use core::arch::x86 as arch;
#[cfg(target_arch = "x86_64")]
use core::arch::x86_64 as arch;
use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

#[cfg(all(test, any(target_arch = "x86", target_arch = "x86_64"), feature = "avx2"))]
pub(crate) use level::with_sixteen_lanes;
pub(crate) use level::{Level, run, run_on_eight_lanes};

use compress::EIGHT_LANES;

/// The largest number of lanes of any vector.
pub(crate) const MAX_LANES: usize = 16;

/// Vectors of `LANES` 32-bit floats (`F`) or integers (`I`), masks (`M`) and 64-bit floats (`D`).
///
/// The token's value proves that the processor can run the operations; every method relies on that.
pub(crate) trait Simd: Copy {
    const LANES: usize;
    type F: Copy;
    type I: Copy;
    type M: Copy;
    type D: Copy;

    /// Calls a job in a function of its own, compiled for this token: for code that several callers share and that runs
    /// long enough to be worth a call.
    fn outlined<J: Outlined<Self>>(self, job: J) -> J::Output;

    fn f(self, x: f32) -> Self::F;
    fn i(self, x: i32) -> Self::I;
    /// 0, 1, 2, ... LANES - 1.
    fn iota(self) -> Self::I;

    /// # Safety
    /// `p` can be read for `LANES` values; any alignment.
    unsafe fn load_f(self, p: *const f32) -> Self::F;
    /// # Safety
    /// As [`Self::load_f`].
    unsafe fn load_i(self, p: *const u32) -> Self::I;
    /// The first `n` values starting at `p`, followed by zeros; all `LANES` for a larger `n`.
    /// # Safety
    /// These values can be read; any alignment.
    unsafe fn load_some(self, p: *const u32, n: usize) -> Self::I;
    /// # Safety
    /// `p` can be written for `LANES` values; any alignment.
    unsafe fn store_f(self, p: *mut f32, x: Self::F);
    /// # Safety
    /// As [`Self::store_f`].
    unsafe fn store_i(self, p: *mut u32, x: Self::I);
    /// # Safety
    /// As [`Self::store_f`].
    unsafe fn store_d(self, p: *mut f64, x: Self::D);
    /// Floats at `p`, `p + stride`, `p + 2 * stride`, ... in bytes; any alignment.
    /// # Safety
    /// Each of the `LANES` floats can be read.
    unsafe fn load_strided(self, p: *const u8, stride: usize) -> Self::F;
    /// `p[index]`. Indices are not negative.
    /// # Safety
    /// Each of them can be read.
    unsafe fn gather(self, p: *const f32, index: Self::I) -> Self::F;
    /// `p[index]` and `p[index + 1]`.
    /// # Safety
    /// As [`Self::gather`], of both.
    #[inline(always)]
    unsafe fn gather_pairs(self, p: *const f32, index: Self::I) -> [Self::F; 2] {
        // SAFETY: the caller's contract.
        unsafe { [self.gather(p, index), self.gather(p.add(1), index)] }
    }
    /// `table[index]`. Indices are below `LANES`.
    /// # Safety
    /// `table` can be read for `LANES` floats.
    #[inline(always)]
    unsafe fn lookup(self, table: *const f32, index: Self::I) -> Self::F {
        // SAFETY: the caller's contract.
        unsafe { self.gather(table, index) }
    }
    /// The same for a table of 32 floats.
    /// # Safety
    /// `table` can be read for 32 floats.
    #[inline(always)]
    unsafe fn lookup_32(self, table: *const f32, index: Self::I) -> Self::F {
        // SAFETY: the caller's contract.
        unsafe { self.gather(table, index) }
    }
    /// `LANES` triangles of three indices: the first of each, the second of each, the third of each.
    /// # Safety
    /// `p` can be read for `3 * LANES` indices.
    unsafe fn load_triangles(self, p: *const u32) -> [Self::I; 3];
    /// `LANES` packed groups of four floats: the first of each, the second of each, and so on.
    /// # Safety
    /// `p` can be read for `4 * LANES` floats; any alignment.
    unsafe fn load_quads(self, p: *const f32) -> [Self::F; 4];
    /// The first three floats of the four-float records at `index[0]`, `index[3]`, `index[6]`, ...
    /// # Safety
    /// `3 * LANES - 2` words of `index` and each of the records relative to `p` can be read; any alignment. `p` may be
    /// the address that record 0 would have.
    unsafe fn load_records(self, p: *const f32, index: *const u32) -> [Self::F; 3];
    /// Writes `LANES` records of four floats, the third of which is repeated.
    /// # Safety
    /// `p` can be written for `4 * LANES` floats; any alignment.
    unsafe fn store_records(self, p: *mut f32, v: [Self::F; 3]);
    /// Writes the lanes in `m` to `p`, packed, and returns their number.
    /// # Safety
    /// `p` can be written for `LANES` values, whatever the mask.
    unsafe fn compress(self, p: *mut u32, m: Self::M, x: Self::I) -> usize;

    /// `LANES` bytes, widened to integers.
    /// # Safety
    /// That many bytes can be read from `p`.
    unsafe fn load_bytes(self, p: *const u8) -> Self::I;
    /// For each of the first `n` lanes that is in `m`, writes `first` plus the lane's index, packed, and returns how
    /// many there are.
    /// # Safety
    /// As [`Self::compress`].
    #[inline(always)]
    unsafe fn list_lanes(self, p: *mut u32, m: Self::M, n: usize, first: u32) -> usize {
        // SAFETY: the caller's contract; eight bits index a list of the table.
        unsafe {
            if Self::LANES == 8 {
                let bits = self.mask_bits(m) & ((1 << n.min(8)) - 1);
                let lanes = self.load_bytes(EIGHT_LANES.as_ptr().add(bits as usize).cast());
                self.store_i(p, self.add_i(lanes, self.i(first as i32)));
                bits.count_ones() as usize
            } else {
                self.compress(p, self.and_m(m, self.first(n)), self.add_i(self.i(first as i32), self.iota()))
            }
        }
    }

    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    /// `min` of values that are not negative (nor -0): their bits compare like integers, which is cheaper on some
    /// instruction sets.
    #[inline(always)]
    fn min_positive(self, a: Self::F, b: Self::F) -> Self::F {
        self.min(a, b)
    }
    /// `max` likewise.
    #[inline(always)]
    fn max_positive(self, a: Self::F, b: Self::F) -> Self::F {
        self.max(a, b)
    }
    fn abs(self, a: Self::F) -> Self::F;
    fn lt(self, a: Self::F, b: Self::F) -> Self::M;
    fn le(self, a: Self::F, b: Self::F) -> Self::M;
    fn eq(self, a: Self::F, b: Self::F) -> Self::M;
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F;
    /// To the nearest integer, ties to even; unspecified (but harmless) if it does not fit.
    fn round(self, a: Self::F) -> Self::I;
    /// Towards zero; unspecified (but harmless) if it does not fit.
    fn trunc(self, a: Self::F) -> Self::I;
    fn to_f(self, a: Self::I) -> Self::F;
    fn bits(self, a: Self::F) -> Self::I;
    fn float_of_bits(self, a: Self::I) -> Self::F;
    /// Prefetches the cache line at `p`, which may be any address.
    #[inline(always)]
    fn prefetch(self, _: *const u32) {}
    /// Writes the least of the first eight lanes, none of which is negative, to `p`, and the least of the second eight,
    /// if there are any, to `p + pitch`. A vector of four lanes has one least value.
    /// # Safety
    /// Both can be written.
    unsafe fn store_z_min(self, p: *mut f32, pitch: usize, a: Self::F);

    fn add_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn sub_i(self, a: Self::I, b: Self::I) -> Self::I;
    /// `a - b`, or 0 if that is negative, for each 16-bit half: values from 0 to 65535.
    fn sub_sat(self, a: Self::I, b: Self::I) -> Self::I;
    fn and(self, a: Self::I, b: Self::I) -> Self::I;
    fn or(self, a: Self::I, b: Self::I) -> Self::I;
    /// `!a & b`.
    fn and_not(self, a: Self::I, b: Self::I) -> Self::I;
    fn min_i(self, a: Self::I, b: Self::I) -> Self::I;
    fn max_i(self, a: Self::I, b: Self::I) -> Self::I;
    /// The larger as unsigned numbers.
    fn max_u(self, a: Self::I, b: Self::I) -> Self::I;
    /// The largest lane as an unsigned number.
    #[inline(always)]
    fn largest_u(self, a: Self::I) -> u32 {
        let mut lanes = [0; MAX_LANES];
        // SAFETY: the array holds a vector.
        unsafe { self.store_i(lanes.as_mut_ptr(), a) };
        let mut largest = 0;
        let mut lane = 0;
        while lane < Self::LANES {
            largest = largest.max(lanes[lane]);
            lane += 1;
        }
        largest
    }
    fn shl<const N: i32>(self, a: Self::I) -> Self::I;
    /// Arithmetic shift right.
    fn sra<const N: i32>(self, a: Self::I) -> Self::I;
    /// All ones shifted left by each lane's count, from 0 to 65535; a count of 32 or more gives 0.
    fn ones_shl(self, count: Self::I) -> Self::I;
    fn gt_i(self, a: Self::I, b: Self::I) -> Self::M;
    fn eq_i(self, a: Self::I, b: Self::I) -> Self::M;
    fn select_i(self, m: Self::M, a: Self::I, b: Self::I) -> Self::I;
    /// Rows to sub-tiles: in each group of four lanes, byte `j` of lane `i` goes to byte `i` of lane `j`.
    fn transpose_bytes(self, a: Self::I) -> Self::I;

    fn and_m(self, a: Self::M, b: Self::M) -> Self::M;
    fn or_m(self, a: Self::M, b: Self::M) -> Self::M;
    /// `!a & b`.
    fn and_not_m(self, a: Self::M, b: Self::M) -> Self::M;
    /// One bit per lane, lane 0 lowest.
    fn mask_bits(self, m: Self::M) -> u32;
    /// Are all lanes in the mask?
    #[inline(always)]
    fn all(self, m: Self::M) -> bool {
        self.mask_bits(m) == ((1_u64 << Self::LANES) - 1) as u32
    }
    /// [`Self::load_some`] with `fill` after the first `n` values.
    /// # Safety
    /// As [`Self::load_some`].
    #[inline(always)]
    unsafe fn load_filled(self, p: *const u32, n: usize, fill: u32) -> Self::I {
        // SAFETY: the caller's contract.
        self.select_i(self.first(n), unsafe { self.load_some(p, n) }, self.i(fill as i32))
    }
    /// [`Self::gather_pairs`] of words that other threads may be writing with [`store_relaxed`].
    /// # Safety
    /// As [`Self::gather_pairs`].
    #[inline(always)]
    unsafe fn gather_pairs_relaxed(self, p: *const f32, index: Self::I) -> [Self::F; 2] {
        let (mut indices, mut words) = ([0_u32; MAX_LANES], [[0_u32; MAX_LANES]; 2]);
        // SAFETY: the arrays hold a vector; the caller's contract.
        unsafe {
            self.store_i(indices.as_mut_ptr(), index);
            for lane in 0..Self::LANES {
                let at = p.add(indices[lane] as usize).cast_mut();
                words[0][lane] = AtomicU32::from_ptr(at.cast()).load(Relaxed);
                words[1][lane] = AtomicU32::from_ptr(at.add(1).cast()).load(Relaxed);
            }
            words.map(|words| self.load_f(words.as_ptr().cast()))
        }
    }
    /// A mask of the first `n` lanes.
    #[inline(always)]
    fn first(self, n: usize) -> Self::M {
        self.gt_i(self.i(n as i32), self.iota())
    }

    fn d(self, x: f64) -> Self::D;
    fn to_d(self, a: Self::F) -> Self::D;
    /// To the nearest f32.
    fn d_to_f(self, a: Self::D) -> Self::F;
    /// Towards zero; unspecified (but harmless) if it does not fit.
    fn d_to_i(self, a: Self::D) -> Self::I;
    fn add_d(self, a: Self::D, b: Self::D) -> Self::D;
    fn sub_d(self, a: Self::D, b: Self::D) -> Self::D;
    fn mul_d(self, a: Self::D, b: Self::D) -> Self::D;
    /// `a * b + c`, rounded once or twice depending on the instruction set: only for operands for which both give the
    /// same result.
    #[inline(always)]
    fn mul_add_d(self, a: Self::D, b: Self::D, c: Self::D) -> Self::D {
        self.add_d(self.mul_d(a, b), c)
    }
    fn div_d(self, a: Self::D, b: Self::D) -> Self::D;
    fn min_d(self, a: Self::D, b: Self::D) -> Self::D;
    fn max_d(self, a: Self::D, b: Self::D) -> Self::D;
}

/// Writes a word that other threads may be reading.
///
/// # Safety
/// It can be written, and nobody else writes it.
#[inline(always)]
pub(crate) unsafe fn store_relaxed(p: *mut f32, x: f32) {
    // SAFETY: the caller's contract.
    unsafe { AtomicU32::from_ptr(p.cast()) }.store(x.to_bits(), Relaxed);
}

/// Address of the four-float record `index[3 * lane]`. With 32-bit pointers the product may wrap around: `p` is where
/// record 0 would be, and may itself have wrapped.
///
/// # Safety
/// The index can be read.
#[inline(always)]
unsafe fn record(p: *const f32, index: *const u32, lane: usize) -> *const f32 {
    // SAFETY: the caller's contract.
    let index = unsafe { index.add(3 * lane).read_unaligned() };
    p.wrapping_add((index as usize).wrapping_mul(4))
}

/// Address of the float `k` strides after `p`. With vertices in separate arrays and 32-bit pointers, the last one may
/// be more than `isize::MAX` bytes after the first.
#[inline(always)]
fn strided(p: *const u8, k: usize, stride: usize) -> *const f32 {
    p.wrapping_add(k.wrapping_mul(stride)).cast()
}

/// A part of the kernel that is compiled once per token and called, not inlined.
pub(crate) trait Outlined<S> {
    type Output;
    fn run(self, s: S) -> Self::Output;
}

/// A part of the kernel that runs on any instruction set.
pub(crate) trait Job {
    type Output;
    fn run<S: Simd>(self, s: S) -> Self::Output;
}
