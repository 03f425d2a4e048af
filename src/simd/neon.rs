//! NEON, the baseline of aarch64: four lanes, used in pairs of vectors. Masks are vectors of all ones or all zeros.
//!
//! SAFETY of every block without its own comment: the token `self` proves that the processor has the instruction set,
//! and the caller of an `unsafe fn` guarantees that its pointers are valid.

use core::arch::aarch64::*;

use super::compress::FOUR_LANES;
use super::pair::Pair;
use super::{Job, Outlined, Simd, record, store_relaxed, strided};

#[derive(Clone, Copy)]
pub(super) struct Neon(());

pub(super) fn enter<J: Job>(job: J) -> J::Output {
    // Every aarch64 processor that Rust's std supports has NEON, so the token needs no further proof.
    job.run(Pair(Neon(())))
}

impl Simd for Neon {
    const LANES: usize = 4;
    type F = float32x4_t;
    type I = int32x4_t;
    type M = uint32x4_t;
    type D = [float64x2_t; 2];

    #[inline(never)]
    fn outlined<J: Outlined<Self>>(self, job: J) -> J::Output {
        job.run(self)
    }

    #[inline(always)]
    fn f(self, x: f32) -> float32x4_t {
        unsafe { vdupq_n_f32(x) }
    }
    #[inline(always)]
    fn i(self, x: i32) -> int32x4_t {
        unsafe { vdupq_n_s32(x) }
    }
    #[inline(always)]
    fn d(self, x: f64) -> [float64x2_t; 2] {
        unsafe { [vdupq_n_f64(x); 2] }
    }
    #[inline(always)]
    fn iota(self) -> int32x4_t {
        unsafe { vld1q_s32([0, 1, 2, 3].as_ptr()) }
    }
    #[inline(always)]
    unsafe fn load_records(self, p: *const f32, index: *const u32) -> [float32x4_t; 3] {
        unsafe {
            let load = |lane: usize| vld1q_f32(record(p, index, lane));
            let (a, b, c, d) = (load(0), load(1), load(2), load(3));
            let (ac, bd) = (vzip1q_f32(a, c), vzip1q_f32(b, d));
            let (ac_high, bd_high) = (vzip2q_f32(a, c), vzip2q_f32(b, d));
            [vzip1q_f32(ac, bd), vzip2q_f32(ac, bd), vzip1q_f32(ac_high, bd_high)]
        }
    }
    #[inline(always)]
    unsafe fn store_records(self, p: *mut f32, [x, y, z]: [float32x4_t; 3]) {
        unsafe { vst4q_f32(p, float32x4x4_t(x, y, z, z)) }
    }
    #[inline(always)]
    unsafe fn load_f(self, p: *const f32) -> float32x4_t {
        unsafe { vld1q_f32(p) }
    }
    #[inline(always)]
    unsafe fn load_i(self, p: *const u32) -> int32x4_t {
        unsafe { vld1q_s32(p.cast()) }
    }
    #[inline(always)]
    unsafe fn load_some(self, p: *const u32, n: usize) -> int32x4_t {
        let mut lanes = [0_u32; 4];
        for (lane, x) in lanes.iter_mut().enumerate().take(n) {
            // SAFETY: the caller's contract.
            *x = unsafe { p.add(lane).read_unaligned() };
        }
        // SAFETY: four words.
        unsafe { vld1q_s32(lanes.as_ptr().cast()) }
    }
    #[inline(always)]
    unsafe fn store_f(self, p: *mut f32, x: float32x4_t) {
        unsafe { vst1q_f32(p, x) }
    }
    #[inline(always)]
    unsafe fn store_i(self, p: *mut u32, x: int32x4_t) {
        unsafe { vst1q_s32(p.cast(), x) }
    }
    #[inline(always)]
    unsafe fn store_d(self, p: *mut f64, x: [float64x2_t; 2]) {
        unsafe {
            vst1q_f64(p, x[0]);
            vst1q_f64(p.add(2), x[1])
        }
    }
    #[inline(always)]
    unsafe fn load_strided(self, p: *const u8, stride: usize) -> float32x4_t {
        unsafe {
            let at = |k: usize| strided(p, k, stride).read_unaligned();
            vld1q_f32([at(0), at(1), at(2), at(3)].as_ptr())
        }
    }
    #[inline(always)]
    unsafe fn gather(self, p: *const f32, index: int32x4_t) -> float32x4_t {
        unsafe {
            let mut k = [0u32; 4];
            vst1q_s32(k.as_mut_ptr().cast(), index);
            let at = |k: u32| *p.add(k as usize);
            vld1q_f32([at(k[0]), at(k[1]), at(k[2]), at(k[3])].as_ptr())
        }
    }
    #[inline(always)]
    unsafe fn gather_pairs(self, p: *const f32, index: int32x4_t) -> [float32x4_t; 2] {
        unsafe {
            let mut k = [0u32; 4];
            vst1q_s32(k.as_mut_ptr().cast(), index);
            let at = |k: u32| vld1_f32(p.add(k as usize));
            let (low, high) = (vcombine_f32(at(k[0]), at(k[1])), vcombine_f32(at(k[2]), at(k[3])));
            [vuzp1q_f32(low, high), vuzp2q_f32(low, high)]
        }
    }
    #[inline(always)]
    unsafe fn load_triangles(self, p: *const u32) -> [int32x4_t; 3] {
        unsafe {
            let t = vld3q_s32(p.cast());
            [t.0, t.1, t.2]
        }
    }
    #[inline(always)]
    unsafe fn load_quads(self, p: *const f32) -> [float32x4_t; 4] {
        let v = unsafe { vld4q_f32(p) };
        [v.0, v.1, v.2, v.3]
    }
    #[inline(always)]
    unsafe fn load_bytes(self, p: *const u8) -> int32x4_t {
        unsafe {
            let bytes = vcreate_u8(u64::from(p.cast::<u32>().read_unaligned()));
            vreinterpretq_s32_u32(vmovl_u16(vget_low_u16(vmovl_u8(bytes))))
        }
    }
    #[inline(always)]
    unsafe fn compress(self, p: *mut u32, m: uint32x4_t, x: int32x4_t) -> usize {
        unsafe {
            let bits = self.mask_bits(m) as usize;
            let order = vld1q_u8(FOUR_LANES.as_ptr().add(bits).cast());
            vst1q_u8(p.cast(), vqtbl1q_u8(vreinterpretq_u8_s32(x), order));
            bits.count_ones() as usize
        }
    }
    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> float32x4_t {
        unsafe { vaddq_f32(a, b) }
    }
    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> float32x4_t {
        unsafe { vsubq_f32(a, b) }
    }
    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> float32x4_t {
        unsafe { vmulq_f32(a, b) }
    }
    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> float32x4_t {
        unsafe { vdivq_f32(a, b) }
    }
    #[inline(always)]
    fn min(self, a: Self::F, b: Self::F) -> float32x4_t {
        unsafe { vbslq_f32(vcltq_f32(a, b), a, b) }
    }
    #[inline(always)]
    fn max(self, a: Self::F, b: Self::F) -> float32x4_t {
        unsafe { vbslq_f32(vcgtq_f32(a, b), a, b) }
    }
    #[inline(always)]
    fn abs(self, a: Self::F) -> float32x4_t {
        unsafe { vabsq_f32(a) }
    }
    #[inline(always)]
    fn lt(self, a: Self::F, b: Self::F) -> uint32x4_t {
        unsafe { vcltq_f32(a, b) }
    }
    #[inline(always)]
    fn le(self, a: Self::F, b: Self::F) -> uint32x4_t {
        unsafe { vcleq_f32(a, b) }
    }
    #[inline(always)]
    fn eq(self, a: Self::F, b: Self::F) -> uint32x4_t {
        unsafe { vceqq_f32(a, b) }
    }
    #[inline(always)]
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> float32x4_t {
        unsafe { vbslq_f32(m, a, b) }
    }
    #[inline(always)]
    fn round(self, a: Self::F) -> int32x4_t {
        unsafe { vcvtnq_s32_f32(a) }
    }
    #[inline(always)]
    fn trunc(self, a: Self::F) -> int32x4_t {
        unsafe { vcvtq_s32_f32(a) }
    }
    #[inline(always)]
    fn to_f(self, a: Self::I) -> float32x4_t {
        unsafe { vcvtq_f32_s32(a) }
    }
    #[inline(always)]
    fn bits(self, a: Self::F) -> int32x4_t {
        unsafe { vreinterpretq_s32_f32(a) }
    }
    #[inline(always)]
    fn float_of_bits(self, a: Self::I) -> float32x4_t {
        unsafe { vreinterpretq_f32_s32(a) }
    }
    #[inline(always)]
    unsafe fn store_z_min(self, p: *mut f32, _: usize, a: Self::F) {
        unsafe { store_relaxed(p, vminvq_f32(a)) }
    }
    #[inline(always)]
    fn add_i(self, a: Self::I, b: Self::I) -> int32x4_t {
        unsafe { vaddq_s32(a, b) }
    }
    #[inline(always)]
    fn sub_i(self, a: Self::I, b: Self::I) -> int32x4_t {
        unsafe { vsubq_s32(a, b) }
    }
    #[inline(always)]
    fn sub_sat(self, a: Self::I, b: Self::I) -> int32x4_t {
        unsafe { vreinterpretq_s32_u16(vqsubq_u16(vreinterpretq_u16_s32(a), vreinterpretq_u16_s32(b))) }
    }
    #[inline(always)]
    fn and(self, a: Self::I, b: Self::I) -> int32x4_t {
        unsafe { vandq_s32(a, b) }
    }
    #[inline(always)]
    fn or(self, a: Self::I, b: Self::I) -> int32x4_t {
        unsafe { vorrq_s32(a, b) }
    }
    #[inline(always)]
    fn min_i(self, a: Self::I, b: Self::I) -> int32x4_t {
        unsafe { vminq_s32(a, b) }
    }
    #[inline(always)]
    fn max_i(self, a: Self::I, b: Self::I) -> int32x4_t {
        unsafe { vmaxq_s32(a, b) }
    }
    #[inline(always)]
    fn and_not(self, a: Self::I, b: Self::I) -> int32x4_t {
        unsafe { vbicq_s32(b, a) }
    }
    #[inline(always)]
    fn max_u(self, a: Self::I, b: Self::I) -> int32x4_t {
        unsafe { vreinterpretq_s32_u32(vmaxq_u32(vreinterpretq_u32_s32(a), vreinterpretq_u32_s32(b))) }
    }
    #[inline(always)]
    fn shl<const N: i32>(self, a: int32x4_t) -> int32x4_t {
        unsafe { vshlq_s32(a, vdupq_n_s32(N)) }
    }
    #[inline(always)]
    fn sra<const N: i32>(self, a: int32x4_t) -> int32x4_t {
        unsafe { vshlq_s32(a, vdupq_n_s32(-N)) }
    }
    #[inline(always)]
    fn ones_shl(self, count: Self::I) -> int32x4_t {
        unsafe {
            // The instruction only uses the lowest byte of a count.
            vshlq_s32(vdupq_n_s32(-1), vminq_s32(count, vdupq_n_s32(32)))
        }
    }
    #[inline(always)]
    fn gt_i(self, a: Self::I, b: Self::I) -> uint32x4_t {
        unsafe { vcgtq_s32(a, b) }
    }
    #[inline(always)]
    fn eq_i(self, a: Self::I, b: Self::I) -> uint32x4_t {
        unsafe { vceqq_s32(a, b) }
    }
    #[inline(always)]
    fn select_i(self, m: Self::M, a: Self::I, b: Self::I) -> int32x4_t {
        unsafe { vbslq_s32(m, a, b) }
    }
    #[inline(always)]
    fn transpose_bytes(self, a: Self::I) -> int32x4_t {
        unsafe {
            let order = vld1q_u8([0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15].as_ptr());
            vreinterpretq_s32_u8(vqtbl1q_u8(vreinterpretq_u8_s32(a), order))
        }
    }
    #[inline(always)]
    fn and_m(self, a: Self::M, b: Self::M) -> uint32x4_t {
        unsafe { vandq_u32(a, b) }
    }
    #[inline(always)]
    fn or_m(self, a: Self::M, b: Self::M) -> uint32x4_t {
        unsafe { vorrq_u32(a, b) }
    }
    #[inline(always)]
    fn and_not_m(self, a: Self::M, b: Self::M) -> uint32x4_t {
        unsafe { vbicq_u32(b, a) }
    }
    #[inline(always)]
    fn mask_bits(self, m: Self::M) -> u32 {
        unsafe { vaddvq_u32(vandq_u32(m, vld1q_u32([1, 2, 4, 8].as_ptr()))) }
    }
    #[inline(always)]
    fn to_d(self, a: Self::F) -> [float64x2_t; 2] {
        unsafe { [vcvt_f64_f32(vget_low_f32(a)), vcvt_high_f64_f32(a)] }
    }
    #[inline(always)]
    fn d_to_f(self, a: Self::D) -> float32x4_t {
        unsafe { vcombine_f32(vcvt_f32_f64(a[0]), vcvt_f32_f64(a[1])) }
    }
    #[inline(always)]
    fn d_to_i(self, a: Self::D) -> int32x4_t {
        unsafe { vcombine_s32(vmovn_s64(vcvtq_s64_f64(a[0])), vmovn_s64(vcvtq_s64_f64(a[1]))) }
    }
    #[inline(always)]
    fn add_d(self, a: Self::D, b: Self::D) -> [float64x2_t; 2] {
        unsafe { [vaddq_f64(a[0], b[0]), vaddq_f64(a[1], b[1])] }
    }
    #[inline(always)]
    fn sub_d(self, a: Self::D, b: Self::D) -> [float64x2_t; 2] {
        unsafe { [vsubq_f64(a[0], b[0]), vsubq_f64(a[1], b[1])] }
    }
    #[inline(always)]
    fn mul_d(self, a: Self::D, b: Self::D) -> [float64x2_t; 2] {
        unsafe { [vmulq_f64(a[0], b[0]), vmulq_f64(a[1], b[1])] }
    }
    #[inline(always)]
    fn mul_add_d(self, a: Self::D, b: Self::D, c: Self::D) -> [float64x2_t; 2] {
        unsafe { [vfmaq_f64(c[0], a[0], b[0]), vfmaq_f64(c[1], a[1], b[1])] }
    }
    #[inline(always)]
    fn div_d(self, a: Self::D, b: Self::D) -> [float64x2_t; 2] {
        unsafe { [vdivq_f64(a[0], b[0]), vdivq_f64(a[1], b[1])] }
    }
    #[inline(always)]
    fn min_d(self, a: Self::D, b: Self::D) -> [float64x2_t; 2] {
        unsafe { [vbslq_f64(vcltq_f64(a[0], b[0]), a[0], b[0]), vbslq_f64(vcltq_f64(a[1], b[1]), a[1], b[1])] }
    }
    #[inline(always)]
    fn max_d(self, a: Self::D, b: Self::D) -> [float64x2_t; 2] {
        unsafe { [vbslq_f64(vcgtq_f64(a[0], b[0]), a[0], b[0]), vbslq_f64(vcgtq_f64(a[1], b[1]), a[1], b[1])] }
    }
}
