//! AVX2: eight lanes. Masks are vectors of all ones or all zeros; a `D` is two registers of four.
//!
//! SAFETY of every block without its own comment: the token `self` proves that the processor has the instruction set,
//! and the caller of an `unsafe fn` guarantees that its pointers are valid.

use super::arch::*;
use super::compress::EIGHT_LANES;
use super::{Job, Outlined, Simd, record, store_relaxed, strided};

#[derive(Clone, Copy)]
pub(super) struct Avx2(());

/// # Safety
/// The processor has AVX2, FMA, BMI1, BMI2, LZCNT and POPCNT.
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
pub(super) unsafe fn enter<J: Job>(job: J) -> J::Output {
    job.run(Avx2(()))
}

/// Enters a job with sixteen lanes, as AVX-512 has.
///
/// # Safety
/// As [`enter`].
#[cfg(test)]
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
pub(super) unsafe fn enter_sixteen_lanes<J: Job>(job: J) -> J::Output {
    job.run(super::pair::Pair(Avx2(())))
}

/// # Safety
/// As [`enter`].
#[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline(never)]
unsafe fn outlined<J: Outlined<Avx2>>(s: Avx2, job: J) -> J::Output {
    job.run(s)
}

/// All ones shifted left by each lane's count. The intrinsic adds a comparison for counts beyond 31, which the
/// instruction itself does not need.
///
/// # Safety
/// The processor has the instruction set.
#[inline]
#[target_feature(enable = "avx2")]
unsafe fn ones_shl(count: __m256i) -> __m256i {
    let ones = _mm256_set1_epi32(-1);
    let shifted;
    // SAFETY: registers only.
    unsafe {
        core::arch::asm!("vpsllvd {}, {}, {}", lateout(ymm_reg) shifted, in(ymm_reg) ones, in(ymm_reg) count,
            options(pure, nomem, nostack, preserves_flags));
    }
    shifted
}

impl Simd for Avx2 {
    const LANES: usize = 8;
    type F = __m256;
    type I = __m256i;
    type M = __m256;
    type D = [__m256d; 2];

    #[inline(always)]
    fn outlined<J: Outlined<Self>>(self, job: J) -> J::Output {
        unsafe { outlined(self, job) }
    }

    #[inline(always)]
    unsafe fn load_f(self, p: *const f32) -> __m256 {
        unsafe { _mm256_loadu_ps(p) }
    }
    #[inline(always)]
    unsafe fn load_i(self, p: *const u32) -> __m256i {
        unsafe { _mm256_loadu_si256(p.cast()) }
    }
    #[inline(always)]
    unsafe fn load_some(self, p: *const u32, n: usize) -> __m256i {
        // SAFETY: masked lanes are not read.
        unsafe { _mm256_maskload_epi32(p.cast(), _mm256_cmpgt_epi32(_mm256_set1_epi32(n.min(8) as i32), self.iota())) }
    }
    #[inline(always)]
    unsafe fn store_f(self, p: *mut f32, x: __m256) {
        unsafe { _mm256_storeu_ps(p, x) }
    }
    #[inline(always)]
    unsafe fn store_i(self, p: *mut u32, x: __m256i) {
        unsafe { _mm256_storeu_si256(p.cast(), x) }
    }
    #[inline(always)]
    unsafe fn store_d(self, p: *mut f64, x: [__m256d; 2]) {
        unsafe {
            _mm256_storeu_pd(p, x[0]);
            _mm256_storeu_pd(p.add(4), x[1]);
        }
    }
    #[inline(always)]
    unsafe fn load_strided(self, p: *const u8, stride: usize) -> __m256 {
        // SAFETY: a stride of at most 27 bits times 7 fits in 31 bits.
        unsafe {
            if stride >> 27 == 0 {
                let offsets = _mm256_mullo_epi32(self.iota(), _mm256_set1_epi32(stride as i32));
                return _mm256_i32gather_ps::<1>(p.cast(), offsets);
            }
            let at = |k: usize| strided(p, k, stride).read_unaligned();
            _mm256_setr_ps(at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7))
        }
    }
    #[inline(always)]
    unsafe fn gather(self, p: *const f32, index: __m256i) -> __m256 {
        unsafe { _mm256_i32gather_ps::<4>(p, index) }
    }
    #[inline(always)]
    unsafe fn gather_pairs(self, p: *const f32, index: __m256i) -> [__m256; 2] {
        unsafe {
            // A gather's cost depends on its number of lanes.
            let low = _mm256_castpd_ps(_mm256_i32gather_pd::<4>(p.cast(), _mm256_castsi256_si128(index)));
            let high = _mm256_castpd_ps(_mm256_i32gather_pd::<4>(p.cast(), _mm256_extracti128_si256::<1>(index)));
            // Pairs 0, 1, 4, 5 and 2, 3, 6, 7 in the halves of a register.
            let order = |x: __m256| _mm256_castpd_ps(_mm256_permute4x64_pd::<0b11_01_10_00>(_mm256_castps_pd(x)));
            let first = _mm256_shuffle_ps::<0b10_00_10_00>(low, high);
            let second = _mm256_shuffle_ps::<0b11_01_11_01>(low, high);
            [order(first), order(second)]
        }
    }
    #[inline(always)]
    unsafe fn load_triangles(self, p: *const u32) -> [__m256i; 3] {
        unsafe {
            let load = |k: usize| _mm256_loadu_si256(p.add(8 * k).cast());
            let (a, b, c): (__m256i, __m256i, __m256i) = (load(0), load(1), load(2));
            // Lane j of output k is word 3 * j + k of the 24: blend the words that are already in place, then permute
            // once.
            let pick = |m0: [i32; 8], x: __m256i, y: __m256i, z: __m256i| {
                let order = _mm256_setr_epi32(m0[0], m0[1], m0[2], m0[3], m0[4], m0[5], m0[6], m0[7]);
                (x, y, z, order)
            };
            let (x, y, z, order) = pick([0, 3, 6, 1, 4, 7, 2, 5], a, b, c);
            let first = _mm256_blend_epi32::<0b0010_0100>(_mm256_blend_epi32::<0b1001_0010>(x, y), z);
            let first = _mm256_permutevar8x32_epi32(first, order);
            let (x, y, z, order) = pick([1, 4, 7, 2, 5, 0, 3, 6], a, b, c);
            let second = _mm256_blend_epi32::<0b0100_1001>(_mm256_blend_epi32::<0b0010_0100>(x, y), z);
            let second = _mm256_permutevar8x32_epi32(second, order);
            let (x, y, z, order) = pick([2, 5, 0, 3, 6, 1, 4, 7], a, b, c);
            let third = _mm256_blend_epi32::<0b1001_0010>(_mm256_blend_epi32::<0b0100_1001>(x, y), z);
            let third = _mm256_permutevar8x32_epi32(third, order);
            [first, second, third]
        }
    }
    #[inline(always)]
    unsafe fn load_quads(self, p: *const f32) -> [__m256; 4] {
        unsafe {
            // Vertices k and k + 4 in the halves of one register.
            let a = _mm256_set_m128(_mm_loadu_ps(p.add(16)), _mm_loadu_ps(p));
            let b = _mm256_set_m128(_mm_loadu_ps(p.add(20)), _mm_loadu_ps(p.add(4)));
            let c = _mm256_set_m128(_mm_loadu_ps(p.add(24)), _mm_loadu_ps(p.add(8)));
            let d = _mm256_set_m128(_mm_loadu_ps(p.add(28)), _mm_loadu_ps(p.add(12)));
            let (ab, cd) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
            let (ab_high, cd_high) = (_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
            [
                _mm256_shuffle_ps::<0b01_00_01_00>(ab, cd),
                _mm256_shuffle_ps::<0b11_10_11_10>(ab, cd),
                _mm256_shuffle_ps::<0b01_00_01_00>(ab_high, cd_high),
                _mm256_shuffle_ps::<0b11_10_11_10>(ab_high, cd_high),
            ]
        }
    }
    #[inline(always)]
    unsafe fn load_records(self, p: *const f32, index: *const u32) -> [__m256; 3] {
        unsafe {
            let load = |lane: usize| _mm_loadu_ps(record(p, index, lane));
            // Vertices k and k + 4 in the halves of one register.
            let (a, b) = (_mm256_set_m128(load(4), load(0)), _mm256_set_m128(load(5), load(1)));
            let (c, d) = (_mm256_set_m128(load(6), load(2)), _mm256_set_m128(load(7), load(3)));
            let (ab, cd) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
            let (ab_high, cd_high) = (_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
            [
                _mm256_shuffle_ps::<0b01_00_01_00>(ab, cd),
                _mm256_shuffle_ps::<0b11_10_11_10>(ab, cd),
                _mm256_shuffle_ps::<0b01_00_01_00>(ab_high, cd_high),
            ]
        }
    }
    #[inline(always)]
    unsafe fn store_records(self, p: *mut f32, [x, y, z]: [__m256; 3]) {
        unsafe {
            let (xy, xy_high) = (_mm256_unpacklo_ps(x, y), _mm256_unpackhi_ps(x, y));
            let (zz, zz_high) = (_mm256_unpacklo_ps(z, z), _mm256_unpackhi_ps(z, z));
            // Records k and k + 4 in the halves of one register.
            let a = _mm256_shuffle_ps::<0b01_00_01_00>(xy, zz);
            let b = _mm256_shuffle_ps::<0b11_10_11_10>(xy, zz);
            let c = _mm256_shuffle_ps::<0b01_00_01_00>(xy_high, zz_high);
            let d = _mm256_shuffle_ps::<0b11_10_11_10>(xy_high, zz_high);
            _mm256_storeu_ps(p, _mm256_permute2f128_ps::<0x20>(a, b));
            _mm256_storeu_ps(p.add(8), _mm256_permute2f128_ps::<0x20>(c, d));
            _mm256_storeu_ps(p.add(16), _mm256_permute2f128_ps::<0x31>(a, b));
            _mm256_storeu_ps(p.add(24), _mm256_permute2f128_ps::<0x31>(c, d));
        }
    }
    #[inline(always)]
    unsafe fn compress(self, p: *mut u32, m: __m256, x: __m256i) -> usize {
        // SAFETY: the mask has eight bits.
        unsafe {
            let bits = _mm256_movemask_ps(m) as usize;
            let order = self.load_bytes(EIGHT_LANES.as_ptr().add(bits).cast());
            _mm256_storeu_si256(p.cast(), _mm256_permutevar8x32_epi32(x, order));
            bits.count_ones() as usize
        }
    }
    #[inline(always)]
    unsafe fn load_bytes(self, p: *const u8) -> __m256i {
        unsafe { _mm256_cvtepu8_epi32(_mm_loadl_epi64(p.cast())) }
    }
    #[inline(always)]
    fn prefetch(self, p: *const u32) {
        // SAFETY: a prefetch does not access memory.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(p.cast()) }
    }
    #[inline(always)]
    unsafe fn store_z_min(self, p: *mut f32, _: usize, a: __m256) {
        unsafe {
            let m = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a));
            let m = _mm_min_ps(m, _mm_movehl_ps(m, m));
            store_relaxed(p, _mm_cvtss_f32(_mm_min_ss(m, _mm_shuffle_ps::<1>(m, m))));
        }
    }
    #[inline(always)]
    unsafe fn lookup(self, table: *const f32, index: __m256i) -> __m256 {
        unsafe { _mm256_permutevar8x32_ps(_mm256_loadu_ps(table), index) }
    }
    #[inline(always)]
    fn f(self, x: f32) -> __m256 {
        unsafe { _mm256_set1_ps(x) }
    }
    #[inline(always)]
    fn i(self, x: i32) -> __m256i {
        unsafe { _mm256_set1_epi32(x) }
    }
    #[inline(always)]
    fn d(self, x: f64) -> [__m256d; 2] {
        unsafe { [_mm256_set1_pd(x); 2] }
    }
    #[inline(always)]
    fn iota(self) -> __m256i {
        unsafe { _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7) }
    }
    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> __m256 {
        unsafe { _mm256_add_ps(a, b) }
    }
    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> __m256 {
        unsafe { _mm256_sub_ps(a, b) }
    }
    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> __m256 {
        unsafe { _mm256_mul_ps(a, b) }
    }
    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> __m256 {
        unsafe { _mm256_div_ps(a, b) }
    }
    #[inline(always)]
    fn min(self, a: Self::F, b: Self::F) -> __m256 {
        unsafe { _mm256_min_ps(a, b) }
    }
    #[inline(always)]
    fn max(self, a: Self::F, b: Self::F) -> __m256 {
        unsafe { _mm256_max_ps(a, b) }
    }
    #[inline(always)]
    fn min_positive(self, a: Self::F, b: Self::F) -> Self::F {
        self.float_of_bits(self.min_i(self.bits(a), self.bits(b)))
    }
    #[inline(always)]
    fn max_positive(self, a: Self::F, b: Self::F) -> Self::F {
        self.float_of_bits(self.max_i(self.bits(a), self.bits(b)))
    }
    #[inline(always)]
    fn abs(self, a: Self::F) -> __m256 {
        unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), a) }
    }
    #[inline(always)]
    fn lt(self, a: Self::F, b: Self::F) -> __m256 {
        unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(a, b) }
    }
    #[inline(always)]
    fn le(self, a: Self::F, b: Self::F) -> __m256 {
        unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(a, b) }
    }
    #[inline(always)]
    fn eq(self, a: Self::F, b: Self::F) -> __m256 {
        unsafe { _mm256_cmp_ps::<_CMP_EQ_OQ>(a, b) }
    }
    #[inline(always)]
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> __m256 {
        unsafe { _mm256_blendv_ps(b, a, m) }
    }
    #[inline(always)]
    fn round(self, a: Self::F) -> __m256i {
        unsafe { _mm256_cvtps_epi32(a) }
    }
    #[inline(always)]
    fn trunc(self, a: Self::F) -> __m256i {
        unsafe { _mm256_cvttps_epi32(a) }
    }
    #[inline(always)]
    fn to_f(self, a: Self::I) -> __m256 {
        unsafe { _mm256_cvtepi32_ps(a) }
    }
    #[inline(always)]
    fn bits(self, a: Self::F) -> __m256i {
        unsafe { _mm256_castps_si256(a) }
    }
    #[inline(always)]
    fn float_of_bits(self, a: Self::I) -> __m256 {
        unsafe { _mm256_castsi256_ps(a) }
    }
    #[inline(always)]
    fn add_i(self, a: Self::I, b: Self::I) -> __m256i {
        unsafe { _mm256_add_epi32(a, b) }
    }
    #[inline(always)]
    fn sub_i(self, a: Self::I, b: Self::I) -> __m256i {
        unsafe { _mm256_sub_epi32(a, b) }
    }
    #[inline(always)]
    fn sub_sat(self, a: Self::I, b: Self::I) -> __m256i {
        unsafe { _mm256_subs_epu16(a, b) }
    }
    #[inline(always)]
    fn and(self, a: Self::I, b: Self::I) -> __m256i {
        unsafe { _mm256_and_si256(a, b) }
    }
    #[inline(always)]
    fn or(self, a: Self::I, b: Self::I) -> __m256i {
        unsafe { _mm256_or_si256(a, b) }
    }
    #[inline(always)]
    fn and_not(self, a: Self::I, b: Self::I) -> __m256i {
        unsafe { _mm256_andnot_si256(a, b) }
    }
    #[inline(always)]
    fn min_i(self, a: Self::I, b: Self::I) -> __m256i {
        unsafe { _mm256_min_epi32(a, b) }
    }
    #[inline(always)]
    fn max_i(self, a: Self::I, b: Self::I) -> __m256i {
        unsafe { _mm256_max_epi32(a, b) }
    }
    #[inline(always)]
    fn max_u(self, a: Self::I, b: Self::I) -> __m256i {
        unsafe { _mm256_max_epu32(a, b) }
    }
    #[inline(always)]
    fn largest_u(self, a: Self::I) -> u32 {
        unsafe {
            let m = _mm_max_epu32(_mm256_castsi256_si128(a), _mm256_extracti128_si256::<1>(a));
            let m = _mm_max_epu32(m, _mm_shuffle_epi32::<0b01_00_11_10>(m));
            _mm_cvtsi128_si32(_mm_max_epu32(m, _mm_shuffle_epi32::<0b10_11_00_01>(m))) as u32
        }
    }
    #[inline(always)]
    fn shl<const N: i32>(self, a: __m256i) -> __m256i {
        unsafe { _mm256_slli_epi32::<N>(a) }
    }
    #[inline(always)]
    fn sra<const N: i32>(self, a: __m256i) -> __m256i {
        unsafe { _mm256_srai_epi32::<N>(a) }
    }
    #[inline(always)]
    fn ones_shl(self, count: Self::I) -> __m256i {
        unsafe { ones_shl(count) }
    }
    #[inline(always)]
    fn gt_i(self, a: Self::I, b: Self::I) -> __m256 {
        unsafe { _mm256_castsi256_ps(_mm256_cmpgt_epi32(a, b)) }
    }
    #[inline(always)]
    fn eq_i(self, a: Self::I, b: Self::I) -> __m256 {
        unsafe { _mm256_castsi256_ps(_mm256_cmpeq_epi32(a, b)) }
    }
    #[inline(always)]
    fn select_i(self, m: Self::M, a: Self::I, b: Self::I) -> __m256i {
        unsafe { _mm256_castps_si256(_mm256_blendv_ps(_mm256_castsi256_ps(b), _mm256_castsi256_ps(a), m)) }
    }
    #[inline(always)]
    fn transpose_bytes(self, a: Self::I) -> __m256i {
        unsafe {
            let order = _mm256_setr_epi8(
                0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15, 0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11,
                15,
            );
            _mm256_shuffle_epi8(a, order)
        }
    }
    #[inline(always)]
    fn and_m(self, a: Self::M, b: Self::M) -> __m256 {
        unsafe { _mm256_and_ps(a, b) }
    }
    #[inline(always)]
    fn or_m(self, a: Self::M, b: Self::M) -> __m256 {
        unsafe { _mm256_or_ps(a, b) }
    }
    #[inline(always)]
    fn and_not_m(self, a: Self::M, b: Self::M) -> __m256 {
        unsafe { _mm256_andnot_ps(a, b) }
    }
    #[inline(always)]
    fn mask_bits(self, m: Self::M) -> u32 {
        unsafe { _mm256_movemask_ps(m) as u32 }
    }
    #[inline(always)]
    fn to_d(self, a: Self::F) -> [__m256d; 2] {
        unsafe { [_mm256_cvtps_pd(_mm256_castps256_ps128(a)), _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(a))] }
    }
    #[inline(always)]
    fn d_to_f(self, a: Self::D) -> __m256 {
        unsafe { _mm256_set_m128(_mm256_cvtpd_ps(a[1]), _mm256_cvtpd_ps(a[0])) }
    }
    #[inline(always)]
    fn d_to_i(self, a: Self::D) -> __m256i {
        unsafe { _mm256_set_m128i(_mm256_cvttpd_epi32(a[1]), _mm256_cvttpd_epi32(a[0])) }
    }
    #[inline(always)]
    fn add_d(self, a: Self::D, b: Self::D) -> [__m256d; 2] {
        unsafe { [_mm256_add_pd(a[0], b[0]), _mm256_add_pd(a[1], b[1])] }
    }
    #[inline(always)]
    fn sub_d(self, a: Self::D, b: Self::D) -> [__m256d; 2] {
        unsafe { [_mm256_sub_pd(a[0], b[0]), _mm256_sub_pd(a[1], b[1])] }
    }
    #[inline(always)]
    fn mul_d(self, a: Self::D, b: Self::D) -> [__m256d; 2] {
        unsafe { [_mm256_mul_pd(a[0], b[0]), _mm256_mul_pd(a[1], b[1])] }
    }
    #[inline(always)]
    fn mul_add_d(self, a: Self::D, b: Self::D, c: Self::D) -> [__m256d; 2] {
        unsafe { [_mm256_fmadd_pd(a[0], b[0], c[0]), _mm256_fmadd_pd(a[1], b[1], c[1])] }
    }
    #[inline(always)]
    fn div_d(self, a: Self::D, b: Self::D) -> [__m256d; 2] {
        unsafe { [_mm256_div_pd(a[0], b[0]), _mm256_div_pd(a[1], b[1])] }
    }
    #[inline(always)]
    fn min_d(self, a: Self::D, b: Self::D) -> [__m256d; 2] {
        unsafe { [_mm256_min_pd(a[0], b[0]), _mm256_min_pd(a[1], b[1])] }
    }
    #[inline(always)]
    fn max_d(self, a: Self::D, b: Self::D) -> [__m256d; 2] {
        unsafe { [_mm256_max_pd(a[0], b[0]), _mm256_max_pd(a[1], b[1])] }
    }
}
