//! WebAssembly's simd128: four lanes, used in pairs of vectors. Masks are vectors of all ones or all zeros.
//!
//! A module that contains these instructions does not load on an engine without them, so there is nothing to detect:
//! they are used if the whole crate is compiled with `-C target-feature=+simd128`. Relaxed SIMD is not used, because
//! its results may differ between machines. Operations on values are safe functions here.
//!
//! SAFETY of every block without its own comment: the caller of an `unsafe fn` guarantees that its pointers are valid.
//! Loads and stores need no alignment.

use core::arch::wasm32::*;

use super::compress::FOUR_LANES;
use super::pair::Pair;
use super::{Job, Outlined, Simd, record, store_relaxed, strided};

#[derive(Clone, Copy)]
pub(super) struct Simd128(());

#[inline(never)]
pub(super) fn enter<J: Job>(job: J) -> J::Output {
    // This file is compiled only if the whole module has simd128, so the token needs no further proof.
    job.run(Pair(Simd128(())))
}

/// Interleaves the low halves of two vectors.
#[inline(always)]
fn zip_low(a: v128, b: v128) -> v128 {
    i32x4_shuffle::<0, 4, 1, 5>(a, b)
}

#[inline(always)]
fn zip_high(a: v128, b: v128) -> v128 {
    i32x4_shuffle::<2, 6, 3, 7>(a, b)
}

/// The low halves of two vectors.
#[inline(always)]
fn low_halves(a: v128, b: v128) -> v128 {
    i64x2_shuffle::<0, 2>(a, b)
}

#[inline(always)]
fn high_halves(a: v128, b: v128) -> v128 {
    i64x2_shuffle::<1, 3>(a, b)
}

impl Simd for Simd128 {
    const LANES: usize = 4;
    type F = v128;
    type I = v128;
    type M = v128;
    type D = [v128; 2];

    #[inline(never)]
    fn outlined<J: Outlined<Self>>(self, job: J) -> J::Output {
        job.run(self)
    }

    #[inline(always)]
    fn f(self, x: f32) -> v128 {
        f32x4_splat(x)
    }
    #[inline(always)]
    fn i(self, x: i32) -> v128 {
        i32x4_splat(x)
    }
    #[inline(always)]
    fn d(self, x: f64) -> [v128; 2] {
        [f64x2_splat(x); 2]
    }
    #[inline(always)]
    fn iota(self) -> v128 {
        i32x4(0, 1, 2, 3)
    }
    #[inline(always)]
    unsafe fn load_records(self, p: *const f32, index: *const u32) -> [v128; 3] {
        let load = |lane: usize| unsafe { v128_load(record(p, index, lane).cast()) };
        let (a, b, c, d) = (load(0), load(1), load(2), load(3));
        let (ab, cd) = (zip_low(a, b), zip_low(c, d));
        [low_halves(ab, cd), high_halves(ab, cd), low_halves(zip_high(a, b), zip_high(c, d))]
    }
    #[inline(always)]
    unsafe fn store_records(self, p: *mut f32, [x, y, z]: [v128; 3]) {
        let (xy, xy_high) = (zip_low(x, y), zip_high(x, y));
        let (zz, zz_high) = (zip_low(z, z), zip_high(z, z));
        let records =
            [low_halves(xy, zz), high_halves(xy, zz), low_halves(xy_high, zz_high), high_halves(xy_high, zz_high)];
        for lane in 0..4 {
            unsafe { v128_store(p.add(4 * lane).cast(), records[lane]) };
        }
    }
    #[inline(always)]
    unsafe fn load_f(self, p: *const f32) -> v128 {
        unsafe { v128_load(p.cast()) }
    }
    #[inline(always)]
    unsafe fn load_i(self, p: *const u32) -> v128 {
        unsafe { v128_load(p.cast()) }
    }
    #[inline(always)]
    unsafe fn load_some(self, p: *const u32, n: usize) -> v128 {
        // SAFETY: the caller's contract: `n` words, or four; loads need no alignment.
        unsafe {
            match n {
                0 => i32x4_splat(0),
                1 => v128_load32_zero(p),
                2 => v128_load64_zero(p.cast()),
                3 => v128_load32_lane::<2>(v128_load64_zero(p.cast()), p.add(2)),
                _ => v128_load(p.cast()),
            }
        }
    }
    #[inline(always)]
    unsafe fn store_f(self, p: *mut f32, x: v128) {
        unsafe { v128_store(p.cast(), x) }
    }
    #[inline(always)]
    unsafe fn store_i(self, p: *mut u32, x: v128) {
        unsafe { v128_store(p.cast(), x) }
    }
    #[inline(always)]
    unsafe fn store_d(self, p: *mut f64, x: [v128; 2]) {
        unsafe {
            v128_store(p.cast(), x[0]);
            v128_store(p.add(2).cast(), x[1]);
        }
    }
    #[inline(always)]
    unsafe fn load_strided(self, p: *const u8, stride: usize) -> v128 {
        unsafe {
            let at = |k: usize| strided(p, k, stride).cast::<u32>();
            let v = v128_load32_zero(at(0));
            let v = v128_load32_lane::<1>(v, at(1));
            let v = v128_load32_lane::<2>(v, at(2));
            v128_load32_lane::<3>(v, at(3))
        }
    }
    #[inline(always)]
    unsafe fn gather(self, p: *const f32, index: v128) -> v128 {
        unsafe {
            let at = |k: u32| p.add(k as usize).cast::<u32>();
            let v = v128_load32_zero(at(u32x4_extract_lane::<0>(index)));
            let v = v128_load32_lane::<1>(v, at(u32x4_extract_lane::<1>(index)));
            let v = v128_load32_lane::<2>(v, at(u32x4_extract_lane::<2>(index)));
            v128_load32_lane::<3>(v, at(u32x4_extract_lane::<3>(index)))
        }
    }
    #[inline(always)]
    unsafe fn gather_pairs(self, p: *const f32, index: v128) -> [v128; 2] {
        // SAFETY: the caller's contract, index by index: two floats each.
        unsafe {
            let at = |k: u32| p.add(k as usize).cast::<u64>();
            let low = v128_load64_zero(at(u32x4_extract_lane::<0>(index)));
            let low = v128_load64_lane::<1>(low, at(u32x4_extract_lane::<1>(index)));
            let high = v128_load64_zero(at(u32x4_extract_lane::<2>(index)));
            let high = v128_load64_lane::<1>(high, at(u32x4_extract_lane::<3>(index)));
            [i32x4_shuffle::<0, 2, 4, 6>(low, high), i32x4_shuffle::<1, 3, 5, 7>(low, high)]
        }
    }
    #[inline(always)]
    unsafe fn load_triangles(self, p: *const u32) -> [v128; 3] {
        let load = |k: usize| unsafe { v128_load(p.add(4 * k).cast()) };
        // a0 b0 c0 a1 | b1 c1 a2 b2 | c2 a3 b3 c3
        let (x, y, z) = (load(0), load(1), load(2));
        [
            i32x4_shuffle::<0, 1, 2, 5>(i32x4_shuffle::<0, 3, 6, 6>(x, y), z),
            i32x4_shuffle::<0, 1, 2, 6>(i32x4_shuffle::<1, 4, 7, 7>(x, y), z),
            i32x4_shuffle::<0, 1, 4, 7>(i32x4_shuffle::<2, 5, 5, 5>(x, y), z),
        ]
    }
    #[inline(always)]
    unsafe fn load_quads(self, p: *const f32) -> [v128; 4] {
        let load = |k: usize| unsafe { v128_load(p.add(4 * k).cast()) };
        let (a, b, c, d) = (load(0), load(1), load(2), load(3));
        let (ab, cd) = (zip_low(a, b), zip_low(c, d));
        let (ab_high, cd_high) = (zip_high(a, b), zip_high(c, d));
        [low_halves(ab, cd), high_halves(ab, cd), low_halves(ab_high, cd_high), high_halves(ab_high, cd_high)]
    }
    #[inline(always)]
    unsafe fn load_bytes(self, p: *const u8) -> v128 {
        let bytes = unsafe { v128_load32_zero(p.cast()) };
        u32x4_extend_low_u16x8(u16x8_extend_low_u8x16(bytes))
    }
    #[inline(always)]
    unsafe fn compress(self, p: *mut u32, m: v128, x: v128) -> usize {
        let bits = self.mask_bits(m);
        // SAFETY: four bits select one of the table's permutations, which are sixteen bytes each; and the caller's
        // contract.
        unsafe {
            let order = v128_load(FOUR_LANES.as_ptr().add(bits as usize).cast());
            v128_store(p.cast(), i8x16_swizzle(x, order));
        }
        bits.count_ones() as usize
    }
    #[inline(always)]
    fn add(self, a: v128, b: v128) -> v128 {
        f32x4_add(a, b)
    }
    #[inline(always)]
    fn sub(self, a: v128, b: v128) -> v128 {
        f32x4_sub(a, b)
    }
    #[inline(always)]
    fn mul(self, a: v128, b: v128) -> v128 {
        f32x4_mul(a, b)
    }
    #[inline(always)]
    fn div(self, a: v128, b: v128) -> v128 {
        f32x4_div(a, b)
    }
    #[inline(always)]
    fn min(self, a: v128, b: v128) -> v128 {
        // `pmin(x, y)` is `y < x ? y : x`: its first operand when either is NaN or they are equal.
        f32x4_pmin(b, a)
    }
    #[inline(always)]
    fn max(self, a: v128, b: v128) -> v128 {
        // As above: `x < y ? y : x`.
        f32x4_pmax(b, a)
    }
    #[inline(always)]
    fn abs(self, a: v128) -> v128 {
        f32x4_abs(a)
    }
    #[inline(always)]
    fn lt(self, a: v128, b: v128) -> v128 {
        f32x4_lt(a, b)
    }
    #[inline(always)]
    fn le(self, a: v128, b: v128) -> v128 {
        f32x4_le(a, b)
    }
    #[inline(always)]
    fn eq(self, a: v128, b: v128) -> v128 {
        f32x4_eq(a, b)
    }
    #[inline(always)]
    fn select(self, m: v128, a: v128, b: v128) -> v128 {
        v128_bitselect(a, b, m)
    }
    #[inline(always)]
    fn round(self, a: v128) -> v128 {
        i32x4_trunc_sat_f32x4(f32x4_nearest(a))
    }
    #[inline(always)]
    fn trunc(self, a: v128) -> v128 {
        i32x4_trunc_sat_f32x4(a)
    }
    #[inline(always)]
    fn to_f(self, a: v128) -> v128 {
        f32x4_convert_i32x4(a)
    }
    #[inline(always)]
    fn bits(self, a: v128) -> v128 {
        a
    }
    #[inline(always)]
    fn float_of_bits(self, a: v128) -> v128 {
        a
    }
    #[inline(always)]
    unsafe fn store_z_min(self, p: *mut f32, _: usize, a: v128) {
        let halves = f32x4_pmin(a, i64x2_shuffle::<1, 1>(a, a));
        let least = f32x4_pmin(halves, i32x4_shuffle::<1, 1, 1, 1>(halves, halves));
        unsafe { store_relaxed(p, f32x4_extract_lane::<0>(least)) }
    }
    #[inline(always)]
    fn add_i(self, a: v128, b: v128) -> v128 {
        i32x4_add(a, b)
    }
    #[inline(always)]
    fn sub_i(self, a: v128, b: v128) -> v128 {
        i32x4_sub(a, b)
    }
    #[inline(always)]
    fn sub_sat(self, a: v128, b: v128) -> v128 {
        u16x8_sub_sat(a, b)
    }
    #[inline(always)]
    fn and(self, a: v128, b: v128) -> v128 {
        v128_and(a, b)
    }
    #[inline(always)]
    fn or(self, a: v128, b: v128) -> v128 {
        v128_or(a, b)
    }
    #[inline(always)]
    fn and_not(self, a: v128, b: v128) -> v128 {
        v128_andnot(b, a)
    }
    #[inline(always)]
    fn min_i(self, a: v128, b: v128) -> v128 {
        i32x4_min(a, b)
    }
    #[inline(always)]
    fn max_i(self, a: v128, b: v128) -> v128 {
        i32x4_max(a, b)
    }
    #[inline(always)]
    fn max_u(self, a: v128, b: v128) -> v128 {
        u32x4_max(a, b)
    }
    #[inline(always)]
    fn shl<const N: i32>(self, a: v128) -> v128 {
        i32x4_shl(a, N as u32)
    }
    #[inline(always)]
    fn sra<const N: i32>(self, a: v128) -> v128 {
        i32x4_shr(a, N as u32)
    }
    #[inline(always)]
    fn ones_shl(self, count: v128) -> v128 {
        // All lanes of a shift have the same count. Instead, byte `k` of a lane is looked up as 0xff shifted left by
        // the count minus `8 * k`, which is 0 from 8 on: both in the table and, by the definition of swizzle, beyond
        // its end.
        let table = u8x16(0xff, 0xfe, 0xfc, 0xf8, 0xf0, 0xe0, 0xc0, 0x80, 0, 0, 0, 0, 0, 0, 0, 0);
        let count = i32x4_min(count, i32x4_splat(255));
        let count = i8x16_shuffle::<0, 0, 0, 0, 4, 4, 4, 4, 8, 8, 8, 8, 12, 12, 12, 12>(count, count);
        i8x16_swizzle(table, u8x16_sub_sat(count, u32x4_splat(0x1810_0800)))
    }
    #[inline(always)]
    fn gt_i(self, a: v128, b: v128) -> v128 {
        i32x4_gt(a, b)
    }
    #[inline(always)]
    fn eq_i(self, a: v128, b: v128) -> v128 {
        i32x4_eq(a, b)
    }
    #[inline(always)]
    fn select_i(self, m: v128, a: v128, b: v128) -> v128 {
        v128_bitselect(a, b, m)
    }
    #[inline(always)]
    fn transpose_bytes(self, a: v128) -> v128 {
        i8x16_shuffle::<0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15>(a, a)
    }
    #[inline(always)]
    fn and_m(self, a: v128, b: v128) -> v128 {
        v128_and(a, b)
    }
    #[inline(always)]
    fn or_m(self, a: v128, b: v128) -> v128 {
        v128_or(a, b)
    }
    #[inline(always)]
    fn and_not_m(self, a: v128, b: v128) -> v128 {
        v128_andnot(b, a)
    }
    #[inline(always)]
    fn mask_bits(self, m: v128) -> u32 {
        i32x4_bitmask(m).into()
    }
    #[inline(always)]
    fn to_d(self, a: v128) -> [v128; 2] {
        [f64x2_promote_low_f32x4(a), f64x2_promote_low_f32x4(i64x2_shuffle::<1, 1>(a, a))]
    }
    #[inline(always)]
    fn d_to_f(self, a: [v128; 2]) -> v128 {
        low_halves(f32x4_demote_f64x2_zero(a[0]), f32x4_demote_f64x2_zero(a[1]))
    }
    #[inline(always)]
    fn d_to_i(self, a: [v128; 2]) -> v128 {
        low_halves(i32x4_trunc_sat_f64x2_zero(a[0]), i32x4_trunc_sat_f64x2_zero(a[1]))
    }
    #[inline(always)]
    fn add_d(self, a: [v128; 2], b: [v128; 2]) -> [v128; 2] {
        [f64x2_add(a[0], b[0]), f64x2_add(a[1], b[1])]
    }
    #[inline(always)]
    fn sub_d(self, a: [v128; 2], b: [v128; 2]) -> [v128; 2] {
        [f64x2_sub(a[0], b[0]), f64x2_sub(a[1], b[1])]
    }
    #[inline(always)]
    fn mul_d(self, a: [v128; 2], b: [v128; 2]) -> [v128; 2] {
        [f64x2_mul(a[0], b[0]), f64x2_mul(a[1], b[1])]
    }
    #[inline(always)]
    fn div_d(self, a: [v128; 2], b: [v128; 2]) -> [v128; 2] {
        [f64x2_div(a[0], b[0]), f64x2_div(a[1], b[1])]
    }
    #[inline(always)]
    fn min_d(self, a: [v128; 2], b: [v128; 2]) -> [v128; 2] {
        [f64x2_pmin(b[0], a[0]), f64x2_pmin(b[1], a[1])]
    }
    #[inline(always)]
    fn max_d(self, a: [v128; 2], b: [v128; 2]) -> [v128; 2] {
        [f64x2_pmax(b[0], a[0]), f64x2_pmax(b[1], a[1])]
    }
}
