//! AVX-512 (F, BW, DQ, VL), sixteen lanes. Masks are mask registers; a `D` is two registers.
//!
//! SAFETY of every block without its own comment: the token `self` proves that the processor has the instruction set,
//! and the caller of an `unsafe fn` guarantees that its pointers are valid.

use super::arch::*;
use super::{Job, Outlined, Simd, record, store_relaxed, strided};

#[derive(Clone, Copy)]
pub(super) struct Avx512(());

/// # Safety
/// The processor has AVX-512 F, BW, DQ and VL, AVX2, FMA, BMI1, BMI2, LZCNT and POPCNT.
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
pub(super) unsafe fn enter<J: Job>(job: J) -> J::Output {
    job.run(Avx512(()))
}

/// # Safety
/// As [`enter`].
#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
#[inline(never)]
unsafe fn outlined<S, J: Outlined<S>>(s: S, job: J) -> J::Output {
    job.run(s)
}

/// All ones shifted left by each lane's count. The intrinsic adds a comparison for counts beyond 31, which the
/// instruction itself does not need.
///
/// # Safety
/// The processor has the instruction set.
#[inline]
#[target_feature(enable = "avx512f")]
unsafe fn ones_shl(count: __m512i) -> __m512i {
    let ones = _mm512_set1_epi32(-1);
    let shifted;
    // SAFETY: registers only.
    unsafe {
        core::arch::asm!("vpsllvd {}, {}, {}", lateout(zmm_reg) shifted, in(zmm_reg) ones, in(zmm_reg) count,
            options(pure, nomem, nostack, preserves_flags));
    }
    shifted
}

impl Simd for Avx512 {
    const LANES: usize = 16;
    type F = __m512;
    type I = __m512i;
    type M = __mmask16;
    type D = [__m512d; 2];

    #[inline(always)]
    fn outlined<J: Outlined<Self>>(self, job: J) -> J::Output {
        unsafe { outlined(self, job) }
    }

    #[inline(always)]
    fn f(self, x: f32) -> __m512 {
        unsafe { _mm512_set1_ps(x) }
    }
    #[inline(always)]
    fn i(self, x: i32) -> __m512i {
        unsafe { _mm512_set1_epi32(x) }
    }
    #[inline(always)]
    fn d(self, x: f64) -> [__m512d; 2] {
        unsafe { [_mm512_set1_pd(x); 2] }
    }
    #[inline(always)]
    fn iota(self) -> __m512i {
        unsafe { _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15) }
    }
    #[inline(always)]
    unsafe fn load_f(self, p: *const f32) -> __m512 {
        unsafe { _mm512_loadu_ps(p) }
    }
    #[inline(always)]
    unsafe fn load_i(self, p: *const u32) -> __m512i {
        unsafe { _mm512_loadu_epi32(p.cast()) }
    }
    #[inline(always)]
    unsafe fn load_some(self, p: *const u32, n: usize) -> __m512i {
        // SAFETY: masked lanes are not read.
        unsafe { _mm512_maskz_loadu_epi32(_bzhi_u32(0xffff, n.min(16) as u32) as __mmask16, p.cast()) }
    }
    #[inline(always)]
    unsafe fn store_f(self, p: *mut f32, x: __m512) {
        unsafe { _mm512_storeu_ps(p, x) }
    }
    #[inline(always)]
    unsafe fn store_i(self, p: *mut u32, x: __m512i) {
        unsafe { _mm512_storeu_epi32(p.cast(), x) }
    }
    #[inline(always)]
    unsafe fn store_d(self, p: *mut f64, x: [__m512d; 2]) {
        unsafe {
            _mm512_storeu_pd(p, x[0]);
            _mm512_storeu_pd(p.add(8), x[1])
        }
    }
    #[inline(always)]
    unsafe fn gather(self, p: *const f32, index: __m512i) -> __m512 {
        unsafe { _mm512_i32gather_ps::<4>(index, p) }
    }
    #[inline(always)]
    unsafe fn gather_pairs(self, p: *const f32, index: __m512i) -> [__m512; 2] {
        unsafe {
            // A gather's cost depends on its number of lanes.
            let low = _mm512_castpd_ps(_mm512_i32gather_pd::<4>(_mm512_castsi512_si256(index), p.cast()));
            let high = _mm512_castpd_ps(_mm512_i32gather_pd::<4>(_mm512_extracti32x8_epi32::<1>(index), p.cast()));
            let first = _mm512_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
            let second = _mm512_setr_epi32(1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
            [_mm512_permutex2var_ps(low, first, high), _mm512_permutex2var_ps(low, second, high)]
        }
    }
    #[inline(always)]
    unsafe fn lookup(self, table: *const f32, index: __m512i) -> __m512 {
        unsafe { _mm512_permutexvar_ps(index, _mm512_loadu_ps(table)) }
    }
    #[inline(always)]
    unsafe fn lookup_32(self, table: *const f32, index: __m512i) -> __m512 {
        unsafe { _mm512_permutex2var_ps(_mm512_loadu_ps(table), index, _mm512_loadu_ps(table.add(16))) }
    }
    #[inline(always)]
    unsafe fn load_strided(self, p: *const u8, stride: usize) -> __m512 {
        unsafe {
            // A stride of at most 26 bits times 15 fits in 31 bits.
            if stride >> 26 == 0 {
                let offsets = _mm512_mullo_epi32(self.iota(), _mm512_set1_epi32(stride as i32));
                return _mm512_i32gather_ps::<1>(offsets, p.cast());
            }
            let at = |k: usize| strided(p, k, stride).read_unaligned();
            _mm512_setr_ps(
                at(0),
                at(1),
                at(2),
                at(3),
                at(4),
                at(5),
                at(6),
                at(7),
                at(8),
                at(9),
                at(10),
                at(11),
                at(12),
                at(13),
                at(14),
                at(15),
            )
        }
    }
    #[inline(always)]
    unsafe fn load_triangles(self, p: *const u32) -> [__m512i; 3] {
        unsafe {
            let load = |k: usize| _mm512_loadu_epi32(p.add(16 * k).cast());
            let (a, b, c): (__m512i, __m512i, __m512i) = (load(0), load(1), load(2));
            // Lane j is word 3 * j + 0 of the 48: first from the lower 32, then from the upper 16.
            let lower = _mm512_setr_epi32(0, 3, 6, 9, 12, 15, 18, 21, 24, 27, 30, 0, 0, 0, 0, 0);
            let upper = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 17, 20, 23, 26, 29);
            let first = _mm512_permutex2var_epi32(_mm512_permutex2var_epi32(a, lower, b), upper, c);
            // Lane j is word 3 * j + 1 of the 48: first from the lower 32, then from the upper 16.
            let lower = _mm512_setr_epi32(1, 4, 7, 10, 13, 16, 19, 22, 25, 28, 31, 0, 0, 0, 0, 0);
            let upper = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 18, 21, 24, 27, 30);
            let second = _mm512_permutex2var_epi32(_mm512_permutex2var_epi32(a, lower, b), upper, c);
            // Lane j is word 3 * j + 2 of the 48: first from the lower 32, then from the upper 16.
            let lower = _mm512_setr_epi32(2, 5, 8, 11, 14, 17, 20, 23, 26, 29, 0, 0, 0, 0, 0, 0);
            let upper = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 16, 19, 22, 25, 28, 31);
            let third = _mm512_permutex2var_epi32(_mm512_permutex2var_epi32(a, lower, b), upper, c);
            [first, second, third]
        }
    }
    #[inline(always)]
    unsafe fn load_quads(self, p: *const f32) -> [__m512; 4] {
        unsafe {
            let (a, b) = (_mm512_loadu_ps(p), _mm512_loadu_ps(p.add(16)));
            let (c, d) = (_mm512_loadu_ps(p.add(32)), _mm512_loadu_ps(p.add(48)));
            // Eight first floats, then eight second ones; likewise the third and fourth.
            let low = _mm512_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28, 1, 5, 9, 13, 17, 21, 25, 29);
            let high = _mm512_setr_epi32(2, 6, 10, 14, 18, 22, 26, 30, 3, 7, 11, 15, 19, 23, 27, 31);
            let (ab, cd) = (_mm512_permutex2var_ps(a, low, b), _mm512_permutex2var_ps(c, low, d));
            let (ab_high, cd_high) = (_mm512_permutex2var_ps(a, high, b), _mm512_permutex2var_ps(c, high, d));
            [
                _mm512_shuffle_f32x4::<0b01_00_01_00>(ab, cd),
                _mm512_shuffle_f32x4::<0b11_10_11_10>(ab, cd),
                _mm512_shuffle_f32x4::<0b01_00_01_00>(ab_high, cd_high),
                _mm512_shuffle_f32x4::<0b11_10_11_10>(ab_high, cd_high),
            ]
        }
    }
    #[inline(always)]
    unsafe fn load_records(self, p: *const f32, index: *const u32) -> [__m512; 3] {
        unsafe {
            let load = |lane: usize| _mm_loadu_ps(record(p, index, lane));
            // Vertices k, k + 4, k + 8 and k + 12 in the quarters of one register.
            let (a, b, c, d) = (
                _mm512_castps128_ps512(load(0)),
                _mm512_castps128_ps512(load(1)),
                _mm512_castps128_ps512(load(2)),
                _mm512_castps128_ps512(load(3)),
            );
            let (a, b) = (_mm512_insertf32x4::<1>(a, load(4)), _mm512_insertf32x4::<1>(b, load(5)));
            let (c, d) = (_mm512_insertf32x4::<1>(c, load(6)), _mm512_insertf32x4::<1>(d, load(7)));
            let (a, b) = (_mm512_insertf32x4::<2>(a, load(8)), _mm512_insertf32x4::<2>(b, load(9)));
            let (c, d) = (_mm512_insertf32x4::<2>(c, load(10)), _mm512_insertf32x4::<2>(d, load(11)));
            let (a, b) = (_mm512_insertf32x4::<3>(a, load(12)), _mm512_insertf32x4::<3>(b, load(13)));
            let (c, d) = (_mm512_insertf32x4::<3>(c, load(14)), _mm512_insertf32x4::<3>(d, load(15)));
            let (ab, cd) = (_mm512_unpacklo_ps(a, b), _mm512_unpacklo_ps(c, d));
            let (ab_high, cd_high) = (_mm512_unpackhi_ps(a, b), _mm512_unpackhi_ps(c, d));
            [
                _mm512_shuffle_ps::<0b01_00_01_00>(ab, cd),
                _mm512_shuffle_ps::<0b11_10_11_10>(ab, cd),
                _mm512_shuffle_ps::<0b01_00_01_00>(ab_high, cd_high),
            ]
        }
    }
    #[inline(always)]
    unsafe fn store_records(self, p: *mut f32, [x, y, z]: [__m512; 3]) {
        unsafe {
            let (xy, xy_high) = (_mm512_unpacklo_ps(x, y), _mm512_unpackhi_ps(x, y));
            let (zz, zz_high) = (_mm512_unpacklo_ps(z, z), _mm512_unpackhi_ps(z, z));
            // Records k, k + 4, k + 8 and k + 12 in the quarters of one register.
            let a = _mm512_shuffle_ps::<0b01_00_01_00>(xy, zz);
            let b = _mm512_shuffle_ps::<0b11_10_11_10>(xy, zz);
            let c = _mm512_shuffle_ps::<0b01_00_01_00>(xy_high, zz_high);
            let d = _mm512_shuffle_ps::<0b11_10_11_10>(xy_high, zz_high);
            let (ab, ab_high) =
                (_mm512_shuffle_f32x4::<0b01_00_01_00>(a, b), _mm512_shuffle_f32x4::<0b11_10_11_10>(a, b));
            let (cd, cd_high) =
                (_mm512_shuffle_f32x4::<0b01_00_01_00>(c, d), _mm512_shuffle_f32x4::<0b11_10_11_10>(c, d));
            _mm512_storeu_ps(p, _mm512_shuffle_f32x4::<0b10_00_10_00>(ab, cd));
            _mm512_storeu_ps(p.add(16), _mm512_shuffle_f32x4::<0b11_01_11_01>(ab, cd));
            _mm512_storeu_ps(p.add(32), _mm512_shuffle_f32x4::<0b10_00_10_00>(ab_high, cd_high));
            _mm512_storeu_ps(p.add(48), _mm512_shuffle_f32x4::<0b11_01_11_01>(ab_high, cd_high));
        }
    }
    #[inline(always)]
    unsafe fn compress(self, p: *mut u32, m: __mmask16, x: __m512i) -> usize {
        unsafe {
            // Compressed in a register, then stored whole: the compressing store is microcoded on some processors.
            _mm512_storeu_epi32(p.cast(), _mm512_maskz_compress_epi32(m, x));
            m.count_ones() as usize
        }
    }
    #[inline(always)]
    unsafe fn load_bytes(self, p: *const u8) -> __m512i {
        unsafe { _mm512_cvtepu8_epi32(_mm_loadu_si128(p.cast())) }
    }
    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> __m512 {
        unsafe { _mm512_add_ps(a, b) }
    }
    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> __m512 {
        unsafe { _mm512_sub_ps(a, b) }
    }
    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> __m512 {
        unsafe { _mm512_mul_ps(a, b) }
    }
    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> __m512 {
        unsafe { _mm512_div_ps(a, b) }
    }
    #[inline(always)]
    fn min(self, a: Self::F, b: Self::F) -> __m512 {
        unsafe { _mm512_min_ps(a, b) }
    }
    #[inline(always)]
    fn max(self, a: Self::F, b: Self::F) -> __m512 {
        unsafe { _mm512_max_ps(a, b) }
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
    fn abs(self, a: Self::F) -> __m512 {
        unsafe { _mm512_abs_ps(a) }
    }
    #[inline(always)]
    fn lt(self, a: Self::F, b: Self::F) -> __mmask16 {
        unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b) }
    }
    #[inline(always)]
    fn le(self, a: Self::F, b: Self::F) -> __mmask16 {
        unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b) }
    }
    #[inline(always)]
    fn eq(self, a: Self::F, b: Self::F) -> __mmask16 {
        unsafe { _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(a, b) }
    }
    #[inline(always)]
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> __m512 {
        unsafe { _mm512_mask_blend_ps(m, b, a) }
    }
    #[inline(always)]
    fn round(self, a: Self::F) -> __m512i {
        unsafe { _mm512_cvtps_epi32(a) }
    }
    #[inline(always)]
    fn trunc(self, a: Self::F) -> __m512i {
        unsafe { _mm512_cvttps_epi32(a) }
    }
    #[inline(always)]
    fn to_f(self, a: Self::I) -> __m512 {
        unsafe { _mm512_cvtepi32_ps(a) }
    }
    #[inline(always)]
    fn bits(self, a: Self::F) -> __m512i {
        unsafe { _mm512_castps_si512(a) }
    }
    #[inline(always)]
    fn float_of_bits(self, a: Self::I) -> __m512 {
        unsafe { _mm512_castsi512_ps(a) }
    }
    #[inline(always)]
    fn prefetch(self, p: *const u32) {
        // SAFETY: a prefetch does not access memory.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(p.cast()) }
    }
    #[inline(always)]
    unsafe fn store_z_min(self, p: *mut f32, pitch: usize, a: __m512) {
        unsafe {
            // Within the halves of the register.
            let m = self.min_positive(a, _mm512_shuffle_f32x4::<0b10_11_00_01>(a, a));
            let m = self.min_positive(m, _mm512_permute_ps::<0b01_00_11_10>(m));
            let m = self.min_positive(m, _mm512_permute_ps::<0b10_11_00_01>(m));
            store_relaxed(p, _mm512_cvtss_f32(m));
            store_relaxed(p.add(pitch), _mm_cvtss_f32(_mm512_extractf32x4_ps::<2>(m)));
        }
    }
    #[inline(always)]
    fn add_i(self, a: Self::I, b: Self::I) -> __m512i {
        unsafe { _mm512_add_epi32(a, b) }
    }
    #[inline(always)]
    fn sub_i(self, a: Self::I, b: Self::I) -> __m512i {
        unsafe { _mm512_sub_epi32(a, b) }
    }
    #[inline(always)]
    fn sub_sat(self, a: Self::I, b: Self::I) -> __m512i {
        unsafe { _mm512_subs_epu16(a, b) }
    }
    #[inline(always)]
    fn and(self, a: Self::I, b: Self::I) -> __m512i {
        unsafe { _mm512_and_si512(a, b) }
    }
    #[inline(always)]
    fn or(self, a: Self::I, b: Self::I) -> __m512i {
        unsafe { _mm512_or_si512(a, b) }
    }
    #[inline(always)]
    fn and_not(self, a: Self::I, b: Self::I) -> __m512i {
        unsafe { _mm512_andnot_si512(a, b) }
    }
    #[inline(always)]
    fn min_i(self, a: Self::I, b: Self::I) -> __m512i {
        unsafe { _mm512_min_epi32(a, b) }
    }
    #[inline(always)]
    fn max_i(self, a: Self::I, b: Self::I) -> __m512i {
        unsafe { _mm512_max_epi32(a, b) }
    }
    #[inline(always)]
    fn max_u(self, a: Self::I, b: Self::I) -> __m512i {
        unsafe { _mm512_max_epu32(a, b) }
    }
    #[inline(always)]
    fn largest_u(self, a: Self::I) -> u32 {
        unsafe { _mm512_reduce_max_epu32(a) }
    }
    #[inline(always)]
    fn shl<const N: i32>(self, a: __m512i) -> __m512i {
        unsafe { _mm512_sll_epi32(a, _mm_cvtsi32_si128(N)) }
    }
    #[inline(always)]
    fn sra<const N: i32>(self, a: __m512i) -> __m512i {
        unsafe { _mm512_sra_epi32(a, _mm_cvtsi32_si128(N)) }
    }
    #[inline(always)]
    fn ones_shl(self, count: Self::I) -> __m512i {
        unsafe { ones_shl(count) }
    }
    #[inline(always)]
    fn gt_i(self, a: Self::I, b: Self::I) -> __mmask16 {
        unsafe { _mm512_cmpgt_epi32_mask(a, b) }
    }
    #[inline(always)]
    fn eq_i(self, a: Self::I, b: Self::I) -> __mmask16 {
        unsafe { _mm512_cmpeq_epi32_mask(a, b) }
    }
    #[inline(always)]
    fn select_i(self, m: Self::M, a: Self::I, b: Self::I) -> __m512i {
        unsafe { _mm512_mask_blend_epi32(m, b, a) }
    }
    #[inline(always)]
    fn transpose_bytes(self, a: Self::I) -> __m512i {
        unsafe {
            let order = _mm512_broadcast_i32x4(_mm_setr_epi8(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15));
            _mm512_shuffle_epi8(a, order)
        }
    }
    #[inline(always)]
    fn and_m(self, a: __mmask16, b: __mmask16) -> __mmask16 {
        a & b
    }
    #[inline(always)]
    fn or_m(self, a: __mmask16, b: __mmask16) -> __mmask16 {
        a | b
    }
    #[inline(always)]
    fn and_not_m(self, a: __mmask16, b: __mmask16) -> __mmask16 {
        !a & b
    }
    #[inline(always)]
    fn mask_bits(self, m: __mmask16) -> u32 {
        u32::from(m)
    }
    #[inline(always)]
    fn to_d(self, a: Self::F) -> [__m512d; 2] {
        unsafe { [_mm512_cvtps_pd(_mm512_castps512_ps256(a)), _mm512_cvtps_pd(_mm512_extractf32x8_ps::<1>(a))] }
    }
    #[inline(always)]
    fn d_to_f(self, a: Self::D) -> __m512 {
        unsafe { _mm512_insertf32x8::<1>(_mm512_castps256_ps512(_mm512_cvtpd_ps(a[0])), _mm512_cvtpd_ps(a[1])) }
    }
    #[inline(always)]
    fn d_to_i(self, a: Self::D) -> __m512i {
        unsafe { _mm512_inserti32x8::<1>(_mm512_castsi256_si512(_mm512_cvttpd_epi32(a[0])), _mm512_cvttpd_epi32(a[1])) }
    }
    #[inline(always)]
    fn add_d(self, a: Self::D, b: Self::D) -> [__m512d; 2] {
        unsafe { [_mm512_add_pd(a[0], b[0]), _mm512_add_pd(a[1], b[1])] }
    }
    #[inline(always)]
    fn sub_d(self, a: Self::D, b: Self::D) -> [__m512d; 2] {
        unsafe { [_mm512_sub_pd(a[0], b[0]), _mm512_sub_pd(a[1], b[1])] }
    }
    #[inline(always)]
    fn mul_d(self, a: Self::D, b: Self::D) -> [__m512d; 2] {
        unsafe { [_mm512_mul_pd(a[0], b[0]), _mm512_mul_pd(a[1], b[1])] }
    }
    #[inline(always)]
    fn mul_add_d(self, a: Self::D, b: Self::D, c: Self::D) -> [__m512d; 2] {
        unsafe { [_mm512_fmadd_pd(a[0], b[0], c[0]), _mm512_fmadd_pd(a[1], b[1], c[1])] }
    }
    #[inline(always)]
    fn div_d(self, a: Self::D, b: Self::D) -> [__m512d; 2] {
        unsafe { [_mm512_div_pd(a[0], b[0]), _mm512_div_pd(a[1], b[1])] }
    }
    #[inline(always)]
    fn min_d(self, a: Self::D, b: Self::D) -> [__m512d; 2] {
        unsafe { [_mm512_min_pd(a[0], b[0]), _mm512_min_pd(a[1], b[1])] }
    }
    #[inline(always)]
    fn max_d(self, a: Self::D, b: Self::D) -> [__m512d; 2] {
        unsafe { [_mm512_max_pd(a[0], b[0]), _mm512_max_pd(a[1], b[1])] }
    }
}
