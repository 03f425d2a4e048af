//! AVX2 and FMA: eight lanes, blocks of 8x1 pixels. Masks are vectors.

use core::arch::x86_64::*;

use super::lanes::{Lanes, Pass, Words, memory_ops, ops};

#[derive(Clone, Copy)]
pub struct Avx2(());

impl Avx2 {
    /// # Safety
    /// The processor has AVX2 and FMA.
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,lzcnt,popcnt")]
    pub unsafe fn run<P: Pass>(pass: P) -> P::Output {
        pass.run(Self(()))
    }
}

/// For each mask, the indices of its lanes, in order.
static COMPRESS: [[u8; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut n) = (0, 0);
        while lane < 8 {
            if mask >> lane & 1 == 1 {
                table[mask][n] = lane as u8;
                n += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

/// Transposes four registers of two rows of four words each, in either direction.
///
/// # Safety
/// The processor has AVX2.
#[inline]
#[target_feature(enable = "avx2")]
unsafe fn transpose([a, b, c, d]: [__m256; 4]) -> [__m256; 4] {
    let pair = |x, y| _mm256_castpd_ps(_mm256_unpacklo_pd(_mm256_castps_pd(x), _mm256_castps_pd(y)));
    let other = |x, y| _mm256_castpd_ps(_mm256_unpackhi_pd(_mm256_castps_pd(x), _mm256_castps_pd(y)));
    let (low_ab, low_cd) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
    let (high_ab, high_cd) = (_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
    [pair(low_ab, low_cd), other(low_ab, low_cd), pair(high_ab, high_cd), other(high_ab, high_cd)]
}

/// a * b - c * d of four lanes in doubles, which hold the products of 26-bit integers exactly.
///
/// # Safety
/// The processor has AVX2 and FMA.
#[inline]
#[target_feature(enable = "avx2,fma")]
unsafe fn cross(a: __m128i, b: __m128i, c: __m128i, d: __m128i) -> __m128 {
    let cd = _mm256_mul_pd(_mm256_cvtepi32_pd(c), _mm256_cvtepi32_pd(d));
    _mm256_cvtpd_ps(_mm256_fmsub_pd(_mm256_cvtepi32_pd(a), _mm256_cvtepi32_pd(b), cd))
}

impl Lanes for Avx2 {
    const N: usize = 8;
    const LOG_HEIGHT: u32 = 0;
    type F = __m256;
    type I = __m256i;
    type M = __m256i;

    ops! {
        f(x: f32) -> __m256 = _mm256_set1_ps(x);
        i(x: i32) -> __m256i = _mm256_set1_epi32(x);
        bits_of(x: __m256) -> __m256i = _mm256_castps_si256(x);
        float_of(x: __m256i) -> __m256 = _mm256_castsi256_ps(x);
        add(a: __m256, b: __m256) -> __m256 = _mm256_add_ps(a, b);
        sub(a: __m256, b: __m256) -> __m256 = _mm256_sub_ps(a, b);
        mul(a: __m256, b: __m256) -> __m256 = _mm256_mul_ps(a, b);
        div(a: __m256, b: __m256) -> __m256 = _mm256_div_ps(a, b);
        min(a: __m256, b: __m256) -> __m256 = _mm256_min_ps(a, b);
        max(a: __m256, b: __m256) -> __m256 = _mm256_max_ps(a, b);
        mul_add(a: __m256, b: __m256, c: __m256) -> __m256 = _mm256_fmadd_ps(a, b, c);
        round(a: __m256) -> __m256i = _mm256_cvtps_epi32(a);
        to_f(a: __m256i) -> __m256 = _mm256_cvtepi32_ps(a);
        add_i(a: __m256i, b: __m256i) -> __m256i = _mm256_add_epi32(a, b);
        sub_i(a: __m256i, b: __m256i) -> __m256i = _mm256_sub_epi32(a, b);
        mul_i(a: __m256i, b: __m256i) -> __m256i = _mm256_mullo_epi32(a, b);
        min_i(a: __m256i, b: __m256i) -> __m256i = _mm256_min_epi32(a, b);
        max_i(a: __m256i, b: __m256i) -> __m256i = _mm256_max_epi32(a, b);
        and_i(a: __m256i, b: __m256i) -> __m256i = _mm256_and_si256(a, b);
        or_i(a: __m256i, b: __m256i) -> __m256i = _mm256_or_si256(a, b);
        shr(a: __m256i, n: u32) -> __m256i = _mm256_sra_epi32(a, _mm_cvtsi32_si128(n as i32));
        shl(a: __m256i, n: u32) -> __m256i = _mm256_sll_epi32(a, _mm_cvtsi32_si128(n as i32));
        cross(a: __m256i, b: __m256i, c: __m256i, d: __m256i) -> __m256 = {
            let low = cross(
                _mm256_castsi256_si128(a),
                _mm256_castsi256_si128(b),
                _mm256_castsi256_si128(c),
                _mm256_castsi256_si128(d),
            );
            let high = cross(
                _mm256_extracti128_si256::<1>(a),
                _mm256_extracti128_si256::<1>(b),
                _mm256_extracti128_si256::<1>(c),
                _mm256_extracti128_si256::<1>(d),
            );
            _mm256_set_m128(high, low)
        };
        lt(a: __m256, b: __m256) -> __m256i = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b));
        le(a: __m256, b: __m256) -> __m256i = _mm256_castps_si256(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b));
        lt_i(a: __m256i, b: __m256i) -> __m256i = _mm256_cmpgt_epi32(b, a);
        eq_i(a: __m256i, b: __m256i) -> __m256i = _mm256_cmpeq_epi32(a, b);
        and_m(a: __m256i, b: __m256i) -> __m256i = _mm256_and_si256(a, b);
        or_m(a: __m256i, b: __m256i) -> __m256i = _mm256_or_si256(a, b);
        bits(m: __m256i) -> u32 = _mm256_movemask_ps(_mm256_castsi256_ps(m)) as u32;
        select(m: __m256i, yes: __m256, no: __m256) -> __m256 = _mm256_blendv_ps(no, yes, _mm256_castsi256_ps(m));
        select_i(m: __m256i, yes: __m256i, no: __m256i) -> __m256i = _mm256_blendv_epi8(no, yes, m);
        any_negative(a: __m256i) -> bool = _mm256_movemask_ps(_mm256_castsi256_ps(a)) != 0;
        least(a: __m256) -> f32 = {
            let four = _mm_min_ps(_mm256_castps256_ps128(a), _mm256_extractf128_ps::<1>(a));
            let two = _mm_min_ps(four, _mm_movehl_ps(four, four));
            _mm_cvtss_f32(_mm_min_ss(two, _mm_movehdup_ps(two)))
        };
    }

    memory_ops! {
        load(p: *const f32) -> __m256 = _mm256_loadu_ps(p);
        load_i(p: *const i32) -> __m256i = _mm256_loadu_si256(p.cast());
        store(p: *mut f32, x: __m256) = _mm256_storeu_ps(p, x);
        store_i(p: *mut i32, x: __m256i) = _mm256_storeu_si256(p.cast(), x);
        compress(p: *mut i32, keep: u32, x: __m256i) = {
            let order = _mm256_cvtepu8_epi32(_mm_loadl_epi64(COMPRESS[keep as usize].as_ptr().cast()));
            _mm256_storeu_si256(p.cast(), _mm256_permutevar8x32_epi32(x, order));
        };
        // Depths outside become 0, which never passes the test: no masked store is needed, which is slow on AMD.
        raise(p: *mut f32, outside: __m256i, depth: __m256) = {
            let within = _mm256_andnot_ps(_mm256_castsi256_ps(_mm256_srai_epi32::<31>(outside)), depth);
            _mm256_store_ps(p, _mm256_max_ps(within, _mm256_load_ps(p)));
        };
        spread(p: *mut Words, x: [__m256i; 4]) = {
            let x = transpose([
                _mm256_castsi256_ps(x[0]),
                _mm256_castsi256_ps(x[1]),
                _mm256_castsi256_ps(x[2]),
                _mm256_castsi256_ps(x[3]),
            ]);
            for (k, x) in x.into_iter().enumerate() {
                _mm_storeu_ps(p.add(k).cast(), _mm256_castps256_ps128(x));
                _mm_storeu_ps(p.add(4 + k).cast(), _mm256_extractf128_ps::<1>(x));
            }
        };
        transform(columns: &[[f32; 4]; 4], from: *const [f32; 4], to: *mut [f32; 4]) = {
            let column = |c: usize| _mm256_broadcast_ps(&_mm_loadu_ps(columns[c].as_ptr()));
            let (x, y, z, one) = (column(0), column(1), column(2), column(3));
            for k in 0..4 {
                let v = _mm256_loadu_ps(from.add(2 * k).cast());
                let zw = _mm256_fmadd_ps(_mm256_permute_ps::<0xaa>(v), z, one);
                let yzw = _mm256_fmadd_ps(_mm256_permute_ps::<0x55>(v), y, zw);
                let clip = _mm256_fmadd_ps(_mm256_permute_ps::<0>(v), x, yzw);
                _mm256_storeu_ps(to.add(2 * k).cast(), clip);
            }
        };
    }

    #[inline(always)]
    unsafe fn fetch<const STEP: usize>(self, base: *const Words, index: *const u32) -> [__m256i; 4] {
        // SAFETY: the token, and the caller's contract.
        unsafe {
            let at = |k: usize| _mm_loadu_ps(base.add(*index.add(STEP * k) as usize).cast());
            let rows = [
                _mm256_set_m128(at(4), at(0)),
                _mm256_set_m128(at(5), at(1)),
                _mm256_set_m128(at(6), at(2)),
                _mm256_set_m128(at(7), at(3)),
            ];
            let [a, b, c, d] = transpose(rows);
            [_mm256_castps_si256(a), _mm256_castps_si256(b), _mm256_castps_si256(c), _mm256_castps_si256(d)]
        }
    }
}
