//! AVX-512: sixteen lanes, blocks of 8x2 pixels. Masks are mask registers.

use core::arch::x86_64::*;

use super::lanes::{Lanes, Pass, Words, memory_ops, ops};

#[derive(Clone, Copy)]
pub struct Avx512(());

impl Avx512 {
    /// # Safety
    /// The processor has AVX2, FMA, and AVX-512 F, BW, DQ and VL.
    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    pub unsafe fn run<P: Pass>(pass: P) -> P::Output {
        pass.run(Self(()))
    }
}

/// Transposes four registers of four rows of four words each, in either direction.
///
/// # Safety
/// The processor has AVX-512 F.
#[inline]
#[target_feature(enable = "avx512f")]
unsafe fn transpose([a, b, c, d]: [__m512i; 4]) -> [__m512i; 4] {
    let (low_ab, low_cd) = (_mm512_unpacklo_epi32(a, b), _mm512_unpacklo_epi32(c, d));
    let (high_ab, high_cd) = (_mm512_unpackhi_epi32(a, b), _mm512_unpackhi_epi32(c, d));
    [
        _mm512_unpacklo_epi64(low_ab, low_cd),
        _mm512_unpackhi_epi64(low_ab, low_cd),
        _mm512_unpacklo_epi64(high_ab, high_cd),
        _mm512_unpackhi_epi64(high_ab, high_cd),
    ]
}

/// a * b - c * d of eight lanes in doubles, which hold the products of 26-bit integers exactly.
///
/// # Safety
/// The processor has AVX-512 F.
#[inline]
#[target_feature(enable = "avx512f")]
unsafe fn cross(a: __m256i, b: __m256i, c: __m256i, d: __m256i) -> __m256 {
    let cd = _mm512_mul_pd(_mm512_cvtepi32_pd(c), _mm512_cvtepi32_pd(d));
    _mm512_cvtpd_ps(_mm512_fmsub_pd(_mm512_cvtepi32_pd(a), _mm512_cvtepi32_pd(b), cd))
}

impl Lanes for Avx512 {
    const N: usize = 16;
    const LOG_HEIGHT: u32 = 1;
    type F = __m512;
    type I = __m512i;
    type M = __mmask16;

    ops! {
        f(x: f32) -> __m512 = _mm512_set1_ps(x);
        i(x: i32) -> __m512i = _mm512_set1_epi32(x);
        bits_of(x: __m512) -> __m512i = _mm512_castps_si512(x);
        float_of(x: __m512i) -> __m512 = _mm512_castsi512_ps(x);
        add(a: __m512, b: __m512) -> __m512 = _mm512_add_ps(a, b);
        sub(a: __m512, b: __m512) -> __m512 = _mm512_sub_ps(a, b);
        mul(a: __m512, b: __m512) -> __m512 = _mm512_mul_ps(a, b);
        div(a: __m512, b: __m512) -> __m512 = _mm512_div_ps(a, b);
        min(a: __m512, b: __m512) -> __m512 = _mm512_min_ps(a, b);
        max(a: __m512, b: __m512) -> __m512 = _mm512_max_ps(a, b);
        mul_add(a: __m512, b: __m512, c: __m512) -> __m512 = _mm512_fmadd_ps(a, b, c);
        round(a: __m512) -> __m512i = _mm512_cvtps_epi32(a);
        to_f(a: __m512i) -> __m512 = _mm512_cvtepi32_ps(a);
        add_i(a: __m512i, b: __m512i) -> __m512i = _mm512_add_epi32(a, b);
        sub_i(a: __m512i, b: __m512i) -> __m512i = _mm512_sub_epi32(a, b);
        mul_i(a: __m512i, b: __m512i) -> __m512i = _mm512_mullo_epi32(a, b);
        min_i(a: __m512i, b: __m512i) -> __m512i = _mm512_min_epi32(a, b);
        max_i(a: __m512i, b: __m512i) -> __m512i = _mm512_max_epi32(a, b);
        and_i(a: __m512i, b: __m512i) -> __m512i = _mm512_and_si512(a, b);
        or_i(a: __m512i, b: __m512i) -> __m512i = _mm512_or_si512(a, b);
        shr(a: __m512i, n: u32) -> __m512i = _mm512_sra_epi32(a, _mm_cvtsi32_si128(n as i32));
        shl(a: __m512i, n: u32) -> __m512i = _mm512_sll_epi32(a, _mm_cvtsi32_si128(n as i32));
        cross(a: __m512i, b: __m512i, c: __m512i, d: __m512i) -> __m512 = {
            let low = cross(
                _mm512_castsi512_si256(a),
                _mm512_castsi512_si256(b),
                _mm512_castsi512_si256(c),
                _mm512_castsi512_si256(d),
            );
            let high = cross(
                _mm512_extracti64x4_epi64::<1>(a),
                _mm512_extracti64x4_epi64::<1>(b),
                _mm512_extracti64x4_epi64::<1>(c),
                _mm512_extracti64x4_epi64::<1>(d),
            );
            _mm512_insertf32x8::<1>(_mm512_castps256_ps512(low), high)
        };
        lt(a: __m512, b: __m512) -> __mmask16 = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b);
        le(a: __m512, b: __m512) -> __mmask16 = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b);
        lt_i(a: __m512i, b: __m512i) -> __mmask16 = _mm512_cmplt_epi32_mask(a, b);
        eq_i(a: __m512i, b: __m512i) -> __mmask16 = _mm512_cmpeq_epi32_mask(a, b);
        and_m(a: __mmask16, b: __mmask16) -> __mmask16 = _kand_mask16(a, b);
        or_m(a: __mmask16, b: __mmask16) -> __mmask16 = _kor_mask16(a, b);
        bits(m: __mmask16) -> u32 = _cvtmask16_u32(m);
        select(m: __mmask16, yes: __m512, no: __m512) -> __m512 = _mm512_mask_blend_ps(m, no, yes);
        select_i(m: __mmask16, yes: __m512i, no: __m512i) -> __m512i = _mm512_mask_blend_epi32(m, no, yes);
        any_negative(a: __m512i) -> bool = _mm512_movepi32_mask(a) != 0;
        least(a: __m512) -> f32 = {
            let eight = _mm256_min_ps(_mm512_castps512_ps256(a), _mm512_extractf32x8_ps::<1>(a));
            let four = _mm_min_ps(_mm256_castps256_ps128(eight), _mm256_extractf128_ps::<1>(eight));
            let two = _mm_min_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_min_ss(two, _mm_movehdup_ps(two)))
        };
    }

    memory_ops! {
        load(p: *const f32) -> __m512 = _mm512_loadu_ps(p);
        load_i(p: *const i32) -> __m512i = _mm512_loadu_si512(p.cast());
        store(p: *mut f32, x: __m512) = _mm512_storeu_ps(p, x);
        store_i(p: *mut i32, x: __m512i) = _mm512_storeu_si512(p.cast(), x);
        // Not the instruction that compresses to memory, which takes dozens of cycles on AMD.
        compress(p: *mut i32, keep: u32, x: __m512i) =
            _mm512_storeu_si512(p.cast(), _mm512_maskz_compress_epi32(keep as __mmask16, x));
        // The whole block is stored: a masked store stalls when the same block is read again soon.
        raise(p: *mut f32, outside: __m512i, depth: __m512) = {
            let old = _mm512_load_ps(p);
            let outside = _mm512_movepi32_mask(outside);
            _mm512_store_ps(p, _mm512_mask_max_ps(old, !outside, old, depth));
        };
        spread(p: *mut Words, x: [__m512i; 4]) = {
            for (k, x) in transpose(x).into_iter().enumerate() {
                _mm_storeu_si128(p.add(k).cast(), _mm512_castsi512_si128(x));
                _mm_storeu_si128(p.add(4 + k).cast(), _mm512_extracti32x4_epi32::<1>(x));
                _mm_storeu_si128(p.add(8 + k).cast(), _mm512_extracti32x4_epi32::<2>(x));
                _mm_storeu_si128(p.add(12 + k).cast(), _mm512_extracti32x4_epi32::<3>(x));
            }
        };
        transform(columns: &[[f32; 4]; 4], from: *const [f32; 4], to: *mut [f32; 4]) = {
            let column = |c: usize| _mm512_broadcast_f32x4(_mm_loadu_ps(columns[c].as_ptr()));
            let (x, y, z, one) = (column(0), column(1), column(2), column(3));
            for k in 0..4 {
                let v = _mm512_loadu_ps(from.add(4 * k).cast());
                let zw = _mm512_fmadd_ps(_mm512_permute_ps::<0xaa>(v), z, one);
                let yzw = _mm512_fmadd_ps(_mm512_permute_ps::<0x55>(v), y, zw);
                let clip = _mm512_fmadd_ps(_mm512_permute_ps::<0>(v), x, yzw);
                _mm512_storeu_ps(to.add(4 * k).cast(), clip);
            }
        };
    }

    #[inline(always)]
    unsafe fn fetch<const STEP: usize>(self, base: *const Words, index: *const u32) -> [__m512i; 4] {
        // SAFETY: the token, and the caller's contract.
        unsafe {
            let at = |k: usize| _mm_loadu_si128(base.add(*index.add(STEP * k) as usize).cast());
            let row = |k: usize| {
                let two = _mm512_inserti32x4::<1>(_mm512_castsi128_si512(at(k)), at(4 + k));
                _mm512_inserti32x4::<3>(_mm512_inserti32x4::<2>(two, at(8 + k)), at(12 + k))
            };
            transpose([row(0), row(1), row(2), row(3)])
        }
    }
}
