//! SSE2, the baseline of x86-64 and i686, and SSE4.1: four lanes, used in pairs of vectors. Masks are vectors of all
//! ones or all zeros. Operations that SSE2 lacks (blends, byte shuffles, some minima) are emulated.
//!
//! SAFETY of every block without its own comment: the token `self` proves that the processor has the instruction set,
//! and the caller of an `unsafe fn` guarantees that its pointers are valid.

use super::arch::*;
use super::compress::FOUR_LANES;
use super::pair::Pair;
use super::{Job, Outlined, Simd, record, store_relaxed, strided};

#[derive(Clone, Copy)]
pub(super) struct Sse2(());

#[derive(Clone, Copy)]
pub(super) struct Sse41(());

/// Not inlined, like those of other instruction sets: the caller would have to save the registers that it uses.
#[inline(never)]
pub(super) fn enter_sse2<J: Job>(job: J) -> J::Output {
    // The target has SSE2, so the token needs no further proof.
    job.run(Pair(Sse2(())))
}

/// # Safety
/// The processor has SSSE3 and SSE4.1.
#[target_feature(enable = "sse4.1,ssse3")]
pub(super) unsafe fn enter_sse41<J: Job>(job: J) -> J::Output {
    job.run(Pair(Sse41(())))
}

/// # Safety
/// The processor has SSSE3 and SSE4.1.
#[target_feature(enable = "sse4.1,ssse3")]
#[inline(never)]
unsafe fn apart_sse41<J: Outlined<Sse41>>(s: Sse41, job: J) -> J::Output {
    job.run(s)
}

/// The lanes as integers, extracted two at a time where registers have 64 bits.
///
/// # Safety
/// The processor has SSE2.
#[inline(always)]
unsafe fn numbers(x: __m128i) -> [u32; 4] {
    // SAFETY: the caller's contract.
    unsafe {
        #[cfg(target_arch = "x86_64")]
        {
            let (low, high) = (_mm_cvtsi128_si64(x), _mm_cvtsi128_si64(_mm_unpackhi_epi64(x, x)));
            [low as u32, (low >> 32) as u32, high as u32, (high >> 32) as u32]
        }
        #[cfg(target_arch = "x86")]
        {
            let mut lanes = [0; 4];
            _mm_storeu_si128(lanes.as_mut_ptr().cast(), x);
            lanes
        }
    }
}

/// The operations that SSE2 and SSE4.1 share.
macro_rules! shared {
    () => {
        const LANES: usize = 4;
        type F = __m128;
        type I = __m128i;
        type M = __m128;
        type D = [__m128d; 2];

        #[inline(always)]
        fn f(self, x: f32) -> __m128 {
            unsafe { _mm_set1_ps(x) }
        }
        #[inline(always)]
        fn i(self, x: i32) -> __m128i {
            unsafe { _mm_set1_epi32(x) }
        }
        #[inline(always)]
        fn d(self, x: f64) -> [__m128d; 2] {
            unsafe { [_mm_set1_pd(x); 2] }
        }
        #[inline(always)]
        unsafe fn gather_pairs(self, p: *const f32, index: __m128i) -> [__m128; 2] {
            unsafe {
                let [a, b, c, d] = numbers(index).map(|k| _mm_loadl_epi64(p.add(k as usize).cast()));
                let low = _mm_castsi128_ps(_mm_unpacklo_epi64(a, b));
                let high = _mm_castsi128_ps(_mm_unpacklo_epi64(c, d));
                [_mm_shuffle_ps::<0b10_00_10_00>(low, high), _mm_shuffle_ps::<0b11_01_11_01>(low, high)]
            }
        }
        #[inline(always)]
        fn iota(self) -> __m128i {
            unsafe { _mm_setr_epi32(0, 1, 2, 3) }
        }
        #[inline(always)]
        unsafe fn load_records(self, p: *const f32, index: *const u32) -> [__m128; 3] {
            unsafe {
                let load = |lane: usize| _mm_loadu_ps(record(p, index, lane));
                let (a, b, c, d) = (load(0), load(1), load(2), load(3));
                let (ab, cd) = (_mm_unpacklo_ps(a, b), _mm_unpacklo_ps(c, d));
                let (ab_high, cd_high) = (_mm_unpackhi_ps(a, b), _mm_unpackhi_ps(c, d));
                [_mm_movelh_ps(ab, cd), _mm_movehl_ps(cd, ab), _mm_movelh_ps(ab_high, cd_high)]
            }
        }
        #[inline(always)]
        unsafe fn store_records(self, p: *mut f32, [x, y, z]: [__m128; 3]) {
            unsafe {
                let (xy, xy_high) = (_mm_unpacklo_ps(x, y), _mm_unpackhi_ps(x, y));
                let (zz, zz_high) = (_mm_unpacklo_ps(z, z), _mm_unpackhi_ps(z, z));
                _mm_storeu_ps(p, _mm_movelh_ps(xy, zz));
                _mm_storeu_ps(p.add(4), _mm_movehl_ps(zz, xy));
                _mm_storeu_ps(p.add(8), _mm_movelh_ps(xy_high, zz_high));
                _mm_storeu_ps(p.add(12), _mm_movehl_ps(zz_high, xy_high));
            }
        }
        #[inline(always)]
        unsafe fn load_f(self, p: *const f32) -> __m128 {
            unsafe { _mm_loadu_ps(p) }
        }
        #[inline(always)]
        unsafe fn load_i(self, p: *const u32) -> __m128i {
            unsafe { _mm_loadu_si128(p.cast()) }
        }
        #[inline(always)]
        unsafe fn load_some(self, p: *const u32, n: usize) -> __m128i {
            unsafe {
                let one = |k: usize| _mm_cvtsi32_si128(p.add(k).cast::<i32>().read_unaligned());
                match n {
                    0 => _mm_setzero_si128(),
                    1 => one(0),
                    2 => _mm_loadl_epi64(p.cast()),
                    3 => _mm_unpacklo_epi64(_mm_loadl_epi64(p.cast()), one(2)),
                    _ => _mm_loadu_si128(p.cast()),
                }
            }
        }
        #[inline(always)]
        unsafe fn store_f(self, p: *mut f32, x: __m128) {
            unsafe { _mm_storeu_ps(p, x) }
        }
        #[inline(always)]
        unsafe fn store_i(self, p: *mut u32, x: __m128i) {
            unsafe { _mm_storeu_si128(p.cast(), x) }
        }
        #[inline(always)]
        unsafe fn store_d(self, p: *mut f64, x: [__m128d; 2]) {
            unsafe {
                _mm_storeu_pd(p, x[0]);
                _mm_storeu_pd(p.add(2), x[1])
            }
        }
        #[inline(always)]
        unsafe fn load_strided(self, p: *const u8, stride: usize) -> __m128 {
            unsafe {
                let at = |k: usize| strided(p, k, stride).read_unaligned();
                _mm_setr_ps(at(0), at(1), at(2), at(3))
            }
        }
        #[inline(always)]
        unsafe fn load_triangles(self, p: *const u32) -> [__m128i; 3] {
            unsafe {
                let load = |k: usize| _mm_loadu_ps(p.add(4 * k).cast());
                // a0 b0 c0 a1 | b1 c1 a2 b2 | c2 a3 b3 c3
                let (x, y, z) = (load(0), load(1), load(2));
                let a = _mm_shuffle_ps::<0b10_00_11_00>(x, _mm_shuffle_ps::<0b01_01_10_10>(y, z));
                let b = _mm_shuffle_ps::<0b10_00_10_00>(
                    _mm_shuffle_ps::<0b00_00_01_01>(x, y),
                    _mm_shuffle_ps::<0b10_10_11_11>(y, z),
                );
                let c = _mm_shuffle_ps::<0b11_00_10_00>(_mm_shuffle_ps::<0b01_01_10_10>(x, y), z);
                [_mm_castps_si128(a), _mm_castps_si128(b), _mm_castps_si128(c)]
            }
        }
        #[inline(always)]
        unsafe fn load_quads(self, p: *const f32) -> [__m128; 4] {
            unsafe {
                let (a, b, c, d) =
                    (_mm_loadu_ps(p), _mm_loadu_ps(p.add(4)), _mm_loadu_ps(p.add(8)), _mm_loadu_ps(p.add(12)));
                let (ab, cd) = (_mm_unpacklo_ps(a, b), _mm_unpacklo_ps(c, d));
                let (ab_high, cd_high) = (_mm_unpackhi_ps(a, b), _mm_unpackhi_ps(c, d));
                [
                    _mm_movelh_ps(ab, cd),
                    _mm_movehl_ps(cd, ab),
                    _mm_movelh_ps(ab_high, cd_high),
                    _mm_movehl_ps(cd_high, ab_high),
                ]
            }
        }
        #[inline(always)]
        fn add(self, a: Self::F, b: Self::F) -> __m128 {
            unsafe { _mm_add_ps(a, b) }
        }
        #[inline(always)]
        fn sub(self, a: Self::F, b: Self::F) -> __m128 {
            unsafe { _mm_sub_ps(a, b) }
        }
        #[inline(always)]
        fn mul(self, a: Self::F, b: Self::F) -> __m128 {
            unsafe { _mm_mul_ps(a, b) }
        }
        #[inline(always)]
        fn div(self, a: Self::F, b: Self::F) -> __m128 {
            unsafe { _mm_div_ps(a, b) }
        }
        #[inline(always)]
        fn min(self, a: Self::F, b: Self::F) -> __m128 {
            unsafe { _mm_min_ps(a, b) }
        }
        #[inline(always)]
        fn max(self, a: Self::F, b: Self::F) -> __m128 {
            unsafe { _mm_max_ps(a, b) }
        }
        #[inline(always)]
        fn abs(self, a: Self::F) -> __m128 {
            unsafe { _mm_andnot_ps(_mm_set1_ps(-0.0), a) }
        }
        #[inline(always)]
        fn lt(self, a: Self::F, b: Self::F) -> __m128 {
            unsafe { _mm_cmplt_ps(a, b) }
        }
        #[inline(always)]
        fn le(self, a: Self::F, b: Self::F) -> __m128 {
            unsafe { _mm_cmple_ps(a, b) }
        }
        #[inline(always)]
        fn eq(self, a: Self::F, b: Self::F) -> __m128 {
            unsafe { _mm_cmpeq_ps(a, b) }
        }
        #[inline(always)]
        fn round(self, a: Self::F) -> __m128i {
            unsafe { _mm_cvtps_epi32(a) }
        }
        #[inline(always)]
        fn trunc(self, a: Self::F) -> __m128i {
            unsafe { _mm_cvttps_epi32(a) }
        }
        #[inline(always)]
        fn to_f(self, a: Self::I) -> __m128 {
            unsafe { _mm_cvtepi32_ps(a) }
        }
        #[inline(always)]
        fn bits(self, a: Self::F) -> __m128i {
            unsafe { _mm_castps_si128(a) }
        }
        #[inline(always)]
        fn float_of_bits(self, a: Self::I) -> __m128 {
            unsafe { _mm_castsi128_ps(a) }
        }
        #[inline(always)]
        fn prefetch(self, p: *const u32) {
            // SAFETY: a prefetch does not access memory.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(p.cast()) }
        }
        #[inline(always)]
        unsafe fn store_z_min(self, p: *mut f32, _: usize, a: Self::F) {
            unsafe {
                let m = _mm_min_ps(a, _mm_movehl_ps(a, a));
                store_relaxed(p, _mm_cvtss_f32(_mm_min_ss(m, _mm_shuffle_ps::<1>(m, m))));
            }
        }
        #[inline(always)]
        fn add_i(self, a: Self::I, b: Self::I) -> __m128i {
            unsafe { _mm_add_epi32(a, b) }
        }
        #[inline(always)]
        fn sub_i(self, a: Self::I, b: Self::I) -> __m128i {
            unsafe { _mm_sub_epi32(a, b) }
        }
        #[inline(always)]
        fn sub_sat(self, a: Self::I, b: Self::I) -> __m128i {
            unsafe { _mm_subs_epu16(a, b) }
        }
        #[inline(always)]
        fn and(self, a: Self::I, b: Self::I) -> __m128i {
            unsafe { _mm_and_si128(a, b) }
        }
        #[inline(always)]
        fn or(self, a: Self::I, b: Self::I) -> __m128i {
            unsafe { _mm_or_si128(a, b) }
        }
        #[inline(always)]
        fn and_not(self, a: Self::I, b: Self::I) -> __m128i {
            unsafe { _mm_andnot_si128(a, b) }
        }
        #[inline(always)]
        fn shl<const N: i32>(self, a: __m128i) -> __m128i {
            unsafe { _mm_slli_epi32::<N>(a) }
        }
        #[inline(always)]
        fn sra<const N: i32>(self, a: __m128i) -> __m128i {
            unsafe { _mm_srai_epi32::<N>(a) }
        }
        #[inline(always)]
        fn ones_shl(self, count: Self::I) -> __m128i {
            unsafe {
                // There is no shift by a separate count per lane, so 2^count is made through the exponent of a float.
                // Results for counts beyond 31 are masked out.
                let power =
                    _mm_cvttps_epi32(_mm_castsi128_ps(_mm_slli_epi32::<23>(_mm_add_epi32(count, _mm_set1_epi32(127)))));
                let ones = _mm_sub_epi32(_mm_setzero_si128(), power);
                _mm_andnot_si128(_mm_cmpgt_epi32(count, _mm_set1_epi32(31)), ones)
            }
        }
        #[inline(always)]
        fn gt_i(self, a: Self::I, b: Self::I) -> __m128 {
            unsafe { _mm_castsi128_ps(_mm_cmpgt_epi32(a, b)) }
        }
        #[inline(always)]
        fn eq_i(self, a: Self::I, b: Self::I) -> __m128 {
            unsafe { _mm_castsi128_ps(_mm_cmpeq_epi32(a, b)) }
        }
        #[inline(always)]
        fn select_i(self, m: Self::M, a: Self::I, b: Self::I) -> __m128i {
            unsafe { _mm_castps_si128(self.select(m, _mm_castsi128_ps(a), _mm_castsi128_ps(b))) }
        }
        #[inline(always)]
        fn and_m(self, a: Self::M, b: Self::M) -> __m128 {
            unsafe { _mm_and_ps(a, b) }
        }
        #[inline(always)]
        fn or_m(self, a: Self::M, b: Self::M) -> __m128 {
            unsafe { _mm_or_ps(a, b) }
        }
        #[inline(always)]
        fn and_not_m(self, a: Self::M, b: Self::M) -> __m128 {
            unsafe { _mm_andnot_ps(a, b) }
        }
        #[inline(always)]
        fn mask_bits(self, m: Self::M) -> u32 {
            unsafe { _mm_movemask_ps(m) as u32 }
        }
        #[inline(always)]
        fn to_d(self, a: Self::F) -> [__m128d; 2] {
            unsafe { [_mm_cvtps_pd(a), _mm_cvtps_pd(_mm_movehl_ps(a, a))] }
        }
        #[inline(always)]
        fn d_to_f(self, a: Self::D) -> __m128 {
            unsafe { _mm_movelh_ps(_mm_cvtpd_ps(a[0]), _mm_cvtpd_ps(a[1])) }
        }
        #[inline(always)]
        fn d_to_i(self, a: Self::D) -> __m128i {
            unsafe { _mm_unpacklo_epi64(_mm_cvttpd_epi32(a[0]), _mm_cvttpd_epi32(a[1])) }
        }
        #[inline(always)]
        fn add_d(self, a: Self::D, b: Self::D) -> [__m128d; 2] {
            unsafe { [_mm_add_pd(a[0], b[0]), _mm_add_pd(a[1], b[1])] }
        }
        #[inline(always)]
        fn sub_d(self, a: Self::D, b: Self::D) -> [__m128d; 2] {
            unsafe { [_mm_sub_pd(a[0], b[0]), _mm_sub_pd(a[1], b[1])] }
        }
        #[inline(always)]
        fn mul_d(self, a: Self::D, b: Self::D) -> [__m128d; 2] {
            unsafe { [_mm_mul_pd(a[0], b[0]), _mm_mul_pd(a[1], b[1])] }
        }
        #[inline(always)]
        fn div_d(self, a: Self::D, b: Self::D) -> [__m128d; 2] {
            unsafe { [_mm_div_pd(a[0], b[0]), _mm_div_pd(a[1], b[1])] }
        }
        #[inline(always)]
        fn min_d(self, a: Self::D, b: Self::D) -> [__m128d; 2] {
            unsafe { [_mm_min_pd(a[0], b[0]), _mm_min_pd(a[1], b[1])] }
        }
        #[inline(always)]
        fn max_d(self, a: Self::D, b: Self::D) -> [__m128d; 2] {
            unsafe { [_mm_max_pd(a[0], b[0]), _mm_max_pd(a[1], b[1])] }
        }
    };
}

impl Simd for Sse2 {
    shared!();

    #[inline(never)]
    fn outlined<J: Outlined<Self>>(self, job: J) -> J::Output {
        job.run(self)
    }

    #[inline(always)]
    unsafe fn gather(self, p: *const f32, index: __m128i) -> __m128 {
        unsafe {
            let mut k = [0u32; 4];
            _mm_storeu_si128(k.as_mut_ptr().cast(), index);
            let at = |k: u32| *p.add(k as usize);
            _mm_setr_ps(at(k[0]), at(k[1]), at(k[2]), at(k[3]))
        }
    }
    #[inline(always)]
    unsafe fn load_bytes(self, p: *const u8) -> __m128i {
        unsafe {
            let (bytes, zero) = (_mm_cvtsi32_si128(p.cast::<i32>().read_unaligned()), _mm_setzero_si128());
            _mm_unpacklo_epi16(_mm_unpacklo_epi8(bytes, zero), zero)
        }
    }
    #[inline(always)]
    unsafe fn compress(self, p: *mut u32, m: __m128, x: __m128i) -> usize {
        unsafe {
            let bits = _mm_movemask_ps(m) as usize;
            let mut lanes = [0u32; 4];
            _mm_storeu_si128(lanes.as_mut_ptr().cast(), x);
            let mut n = 0;
            for (lane, value) in lanes.into_iter().enumerate() {
                *p.add(n) = value;
                n += bits >> lane & 1;
            }
            n
        }
    }
    #[inline(always)]
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> __m128 {
        unsafe { _mm_or_ps(_mm_and_ps(m, a), _mm_andnot_ps(m, b)) }
    }
    #[inline(always)]
    fn min_i(self, a: Self::I, b: Self::I) -> __m128i {
        unsafe { self.select_i(_mm_castsi128_ps(_mm_cmpgt_epi32(b, a)), a, b) }
    }
    #[inline(always)]
    fn max_i(self, a: Self::I, b: Self::I) -> __m128i {
        unsafe { self.select_i(_mm_castsi128_ps(_mm_cmpgt_epi32(a, b)), a, b) }
    }
    #[inline(always)]
    fn max_u(self, a: Self::I, b: Self::I) -> __m128i {
        unsafe {
            let flip = _mm_set1_epi32(i32::MIN);
            let above = _mm_cmpgt_epi32(_mm_xor_si128(a, flip), _mm_xor_si128(b, flip));
            self.select_i(_mm_castsi128_ps(above), a, b)
        }
    }
    #[inline(always)]
    fn transpose_bytes(self, a: Self::I) -> __m128i {
        unsafe {
            let half = _mm_unpacklo_epi8(a, _mm_srli_si128::<8>(a));
            _mm_unpacklo_epi8(half, _mm_srli_si128::<8>(half))
        }
    }
}

impl Simd for Sse41 {
    shared!();

    #[inline(always)]
    fn outlined<J: Outlined<Self>>(self, job: J) -> J::Output {
        unsafe { apart_sse41(self, job) }
    }

    #[inline(always)]
    unsafe fn gather(self, p: *const f32, index: __m128i) -> __m128 {
        unsafe {
            let at = |k: i32| *p.add(k as usize);
            _mm_setr_ps(
                at(_mm_cvtsi128_si32(index)),
                at(_mm_extract_epi32::<1>(index)),
                at(_mm_extract_epi32::<2>(index)),
                at(_mm_extract_epi32::<3>(index)),
            )
        }
    }
    #[inline(always)]
    unsafe fn load_bytes(self, p: *const u8) -> __m128i {
        unsafe { _mm_cvtepu8_epi32(_mm_cvtsi32_si128(p.cast::<i32>().read_unaligned())) }
    }
    #[inline(always)]
    unsafe fn compress(self, p: *mut u32, m: __m128, x: __m128i) -> usize {
        unsafe {
            let bits = _mm_movemask_ps(m) as usize;
            let order = _mm_loadu_si128(FOUR_LANES.as_ptr().add(bits).cast());
            _mm_storeu_si128(p.cast(), _mm_shuffle_epi8(x, order));
            bits.count_ones() as usize
        }
    }
    #[inline(always)]
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> __m128 {
        unsafe { _mm_blendv_ps(b, a, m) }
    }
    #[inline(always)]
    fn min_i(self, a: Self::I, b: Self::I) -> __m128i {
        unsafe { _mm_min_epi32(a, b) }
    }
    #[inline(always)]
    fn max_i(self, a: Self::I, b: Self::I) -> __m128i {
        unsafe { _mm_max_epi32(a, b) }
    }
    #[inline(always)]
    fn max_u(self, a: Self::I, b: Self::I) -> __m128i {
        unsafe { _mm_max_epu32(a, b) }
    }
    #[inline(always)]
    fn transpose_bytes(self, a: Self::I) -> __m128i {
        unsafe { _mm_shuffle_epi8(a, _mm_setr_epi8(0, 4, 8, 12, 1, 5, 9, 13, 2, 6, 10, 14, 3, 7, 11, 15)) }
    }
}
