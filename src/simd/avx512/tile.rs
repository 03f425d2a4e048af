//! Eight lanes of AVX-512, for a tile; a `D` is one register.

use core::arch::x86_64::*;

use super::Avx512Tile;
use crate::simd::Simd;

impl Simd for Avx512Tile {
    const LANES: usize = 8;
    type F = __m256;
    type I = __m256i;
    type M = __mmask8;
    type D = __m512d;

    #[inline(always)]
    fn f(self, x: f32) -> __m256 {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_set1_ps(x) }
    }
    #[inline(always)]
    fn i(self, x: i32) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_set1_epi32(x) }
    }
    #[inline(always)]
    fn d(self, x: f64) -> __m512d {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm512_set1_pd(x) }
    }
    #[inline(always)]
    fn iota(self) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7) }
    }
    #[inline(always)]
    unsafe fn load_f(self, p: *const f32) -> __m256 {
        // SAFETY: the token, and the caller's contract.
        unsafe { _mm256_loadu_ps(p) }
    }
    #[inline(always)]
    unsafe fn load_i(self, p: *const u32) -> __m256i {
        // SAFETY: the token, and the caller's contract.
        unsafe { _mm256_loadu_epi32(p.cast()) }
    }
    #[inline(always)]
    unsafe fn store_f(self, p: *mut f32, x: __m256) {
        // SAFETY: the token, and the caller's contract.
        unsafe { _mm256_storeu_ps(p, x) }
    }
    #[inline(always)]
    unsafe fn store_i(self, p: *mut u32, x: __m256i) {
        // SAFETY: the token, and the caller's contract.
        unsafe { _mm256_storeu_epi32(p.cast(), x) }
    }
    #[inline(always)]
    unsafe fn store_d(self, p: *mut f64, x: __m512d) {
        // SAFETY: the token, and the caller's contract.
        unsafe { _mm512_storeu_pd(p, x) }
    }
    #[inline(always)]
    unsafe fn gather(self, p: *const f32, index: __m256i) -> __m256 {
        // SAFETY: the token, and the caller's contract.
        unsafe { _mm256_i32gather_ps::<4>(p, index) }
    }
    #[inline(always)]
    unsafe fn load_strided(self, p: *const u8, stride: usize) -> __m256 {
        // SAFETY: the token, and the caller's contract.
        unsafe {
            // A stride that fits in 26 bits keeps 15 of them in 31.
            if stride >> 26 == 0 {
                let offsets = _mm256_mullo_epi32(self.iota(), _mm256_set1_epi32(stride as i32));
                return _mm256_i32gather_ps::<1>(p.cast(), offsets);
            }
            let at = |k: usize| p.add(k * stride).cast::<f32>().read_unaligned();
            _mm256_setr_ps(at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7))
        }
    }
    #[inline(always)]
    unsafe fn load_triangles(self, p: *const u32) -> [__m256i; 3] {
        // SAFETY: the token, and the caller's contract.
        unsafe {
            let load = |k: usize| _mm256_loadu_epi32(p.add(8 * k).cast());
            let (a, b, c): (__m256i, __m256i, __m256i) = (load(0), load(1), load(2));
            let lower = _mm256_setr_epi32(0, 3, 6, 9, 12, 15, 0, 0);
            let upper = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 10, 13);
            let first = _mm256_permutex2var_epi32(_mm256_permutex2var_epi32(a, lower, b), upper, c);
            let lower = _mm256_setr_epi32(1, 4, 7, 10, 13, 0, 0, 0);
            let upper = _mm256_setr_epi32(0, 1, 2, 3, 4, 8, 11, 14);
            let second = _mm256_permutex2var_epi32(_mm256_permutex2var_epi32(a, lower, b), upper, c);
            let lower = _mm256_setr_epi32(2, 5, 8, 11, 14, 0, 0, 0);
            let upper = _mm256_setr_epi32(0, 1, 2, 3, 4, 9, 12, 15);
            let third = _mm256_permutex2var_epi32(_mm256_permutex2var_epi32(a, lower, b), upper, c);
            [first, second, third]
        }
    }
    #[inline(always)]
    unsafe fn load_quads(self, p: *const f32) -> [__m256; 4] {
        // SAFETY: the token, and the caller's contract.
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
    unsafe fn compress(self, p: *mut u32, m: __mmask8, x: __m256i) -> usize {
        // SAFETY: the token, and the caller's contract.
        unsafe {
            // In a register, then stored whole: the compressing store is microcode on some processors.
            _mm256_storeu_epi32(p.cast(), _mm256_maskz_compress_epi32(m, x));
            m.count_ones() as usize
        }
    }
    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> __m256 {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_add_ps(a, b) }
    }
    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> __m256 {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_sub_ps(a, b) }
    }
    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> __m256 {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_mul_ps(a, b) }
    }
    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> __m256 {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_div_ps(a, b) }
    }
    #[inline(always)]
    fn min(self, a: Self::F, b: Self::F) -> __m256 {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_min_ps(a, b) }
    }
    #[inline(always)]
    fn max(self, a: Self::F, b: Self::F) -> __m256 {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_max_ps(a, b) }
    }
    #[inline(always)]
    fn abs(self, a: Self::F) -> __m256 {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_andnot_ps(_mm256_set1_ps(-0.0), a) }
    }
    #[inline(always)]
    fn lt(self, a: Self::F, b: Self::F) -> __mmask8 {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_cmp_ps_mask::<_CMP_LT_OQ>(a, b) }
    }
    #[inline(always)]
    fn le(self, a: Self::F, b: Self::F) -> __mmask8 {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_cmp_ps_mask::<_CMP_LE_OQ>(a, b) }
    }
    #[inline(always)]
    fn eq(self, a: Self::F, b: Self::F) -> __mmask8 {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_cmp_ps_mask::<_CMP_EQ_OQ>(a, b) }
    }
    #[inline(always)]
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> __m256 {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_mask_blend_ps(m, b, a) }
    }
    #[inline(always)]
    fn round(self, a: Self::F) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_cvtps_epi32(a) }
    }
    #[inline(always)]
    fn to_f(self, a: Self::I) -> __m256 {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_cvtepi32_ps(a) }
    }
    #[inline(always)]
    fn bits(self, a: Self::F) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_castps_si256(a) }
    }
    #[inline(always)]
    fn float_of_bits(self, a: Self::I) -> __m256 {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_castsi256_ps(a) }
    }
    #[inline(always)]
    fn least(self, a: Self::F) -> f32 {
        // SAFETY: the token proves the instruction set.
        unsafe {
            let m = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a));
            let m = _mm_min_ps(m, _mm_movehl_ps(m, m));
            _mm_cvtss_f32(_mm_min_ss(m, _mm_shuffle_ps::<1>(m, m)))
        }
    }
    #[inline(always)]
    fn add_i(self, a: Self::I, b: Self::I) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_add_epi32(a, b) }
    }
    #[inline(always)]
    fn sub_i(self, a: Self::I, b: Self::I) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_sub_epi32(a, b) }
    }
    #[inline(always)]
    fn and(self, a: Self::I, b: Self::I) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_and_si256(a, b) }
    }
    #[inline(always)]
    fn or(self, a: Self::I, b: Self::I) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_or_si256(a, b) }
    }
    #[inline(always)]
    fn and_not(self, a: Self::I, b: Self::I) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_andnot_si256(a, b) }
    }
    #[inline(always)]
    fn min_i(self, a: Self::I, b: Self::I) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_min_epi32(a, b) }
    }
    #[inline(always)]
    fn max_i(self, a: Self::I, b: Self::I) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_max_epi32(a, b) }
    }
    #[inline(always)]
    fn max_u(self, a: Self::I, b: Self::I) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_max_epu32(a, b) }
    }
    #[inline(always)]
    fn shl<const N: i32>(self, a: __m256i) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_sll_epi32(a, _mm_cvtsi32_si128(N)) }
    }
    #[inline(always)]
    fn sra<const N: i32>(self, a: __m256i) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_sra_epi32(a, _mm_cvtsi32_si128(N)) }
    }
    #[inline(always)]
    fn ones_shl(self, count: Self::I) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_sllv_epi32(_mm256_set1_epi32(-1), count) }
    }
    #[inline(always)]
    fn gt_i(self, a: Self::I, b: Self::I) -> __mmask8 {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_cmpgt_epi32_mask(a, b) }
    }
    #[inline(always)]
    fn eq_i(self, a: Self::I, b: Self::I) -> __mmask8 {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_cmpeq_epi32_mask(a, b) }
    }
    #[inline(always)]
    fn select_i(self, m: Self::M, a: Self::I, b: Self::I) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm256_mask_blend_epi32(m, b, a) }
    }
    #[inline(always)]
    fn transpose_bytes(self, a: Self::I) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe {
            let order =
                _mm256_broadcastsi128_si256(_mm_setr_epi8(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15));
            _mm256_shuffle_epi8(a, order)
        }
    }
    #[inline(always)]
    fn and_m(self, a: __mmask8, b: __mmask8) -> __mmask8 {
        a & b
    }
    #[inline(always)]
    fn or_m(self, a: __mmask8, b: __mmask8) -> __mmask8 {
        a | b
    }
    #[inline(always)]
    fn and_not_m(self, a: __mmask8, b: __mmask8) -> __mmask8 {
        !a & b
    }
    #[inline(always)]
    fn mask_bits(self, m: __mmask8) -> u32 {
        u32::from(m)
    }
    #[inline(always)]
    fn to_d(self, a: Self::F) -> __m512d {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm512_cvtps_pd(a) }
    }
    #[inline(always)]
    fn d_to_f(self, a: Self::D) -> __m256 {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm512_cvtpd_ps(a) }
    }
    #[inline(always)]
    fn d_to_i(self, a: Self::D) -> __m256i {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm512_cvttpd_epi32(a) }
    }
    #[inline(always)]
    fn add_d(self, a: Self::D, b: Self::D) -> __m512d {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm512_add_pd(a, b) }
    }
    #[inline(always)]
    fn sub_d(self, a: Self::D, b: Self::D) -> __m512d {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm512_sub_pd(a, b) }
    }
    #[inline(always)]
    fn mul_d(self, a: Self::D, b: Self::D) -> __m512d {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm512_mul_pd(a, b) }
    }
    #[inline(always)]
    fn div_d(self, a: Self::D, b: Self::D) -> __m512d {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm512_div_pd(a, b) }
    }
    #[inline(always)]
    fn min_d(self, a: Self::D, b: Self::D) -> __m512d {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm512_min_pd(a, b) }
    }
    #[inline(always)]
    fn max_d(self, a: Self::D, b: Self::D) -> __m512d {
        // SAFETY: the token proves the instruction set.
        unsafe { _mm512_max_pd(a, b) }
    }
}
