//! Four lanes in plain Rust: runs anywhere, and is the reference implementation for the others.
//!
//! SAFETY of every block without its own comment: the caller of an `unsafe fn` guarantees that its pointers are valid.

use super::pair::Pair;
use super::{Job, Outlined, Simd, record, store_relaxed, strided};
use crate::float_environment::round_ties_even;

#[derive(Clone, Copy)]
pub(super) struct Scalar4;

/// Not inlined, like those of other instruction sets: the caller would have to save the registers that it uses.
#[inline(never)]
pub(super) fn enter<J: Job>(job: J) -> J::Output {
    job.run(Pair(Scalar4))
}

macro_rules! lanes {
    ($a:ident => $e:expr) => {{
        [
            {
                let $a = $a[0];
                $e
            },
            {
                let $a = $a[1];
                $e
            },
            {
                let $a = $a[2];
                $e
            },
            {
                let $a = $a[3];
                $e
            },
        ]
    }};
    ($a:ident, $b:ident => $e:expr) => {{
        [
            {
                let ($a, $b) = ($a[0], $b[0]);
                $e
            },
            {
                let ($a, $b) = ($a[1], $b[1]);
                $e
            },
            {
                let ($a, $b) = ($a[2], $b[2]);
                $e
            },
            {
                let ($a, $b) = ($a[3], $b[3]);
                $e
            },
        ]
    }};
    ($a:ident, $b:ident, $c:ident => $e:expr) => {{
        [
            {
                let ($a, $b, $c) = ($a[0], $b[0], $c[0]);
                $e
            },
            {
                let ($a, $b, $c) = ($a[1], $b[1], $c[1]);
                $e
            },
            {
                let ($a, $b, $c) = ($a[2], $b[2], $c[2]);
                $e
            },
            {
                let ($a, $b, $c) = ($a[3], $b[3], $c[3]);
                $e
            },
        ]
    }};
}

impl Simd for Scalar4 {
    const LANES: usize = 4;
    type F = [f32; 4];
    type I = [i32; 4];
    type M = [bool; 4];
    type D = [f64; 4];

    fn outlined<J: Outlined<Self>>(self, job: J) -> J::Output {
        job.run(self)
    }

    #[inline(always)]
    fn f(self, x: f32) -> [f32; 4] {
        [x; 4]
    }
    #[inline(always)]
    fn i(self, x: i32) -> [i32; 4] {
        [x; 4]
    }
    #[inline(always)]
    fn iota(self) -> [i32; 4] {
        [0, 1, 2, 3]
    }
    #[inline(always)]
    unsafe fn load_records(self, p: *const f32, index: *const u32) -> [[f32; 4]; 3] {
        let mut v = [[0.0; 4]; 3];
        for lane in 0..4 {
            for k in 0..3 {
                v[k][lane] = unsafe { record(p, index, lane).add(k).read_unaligned() };
            }
        }
        v
    }
    #[inline(always)]
    unsafe fn store_records(self, p: *mut f32, v: [[f32; 4]; 3]) {
        for lane in 0..4 {
            for k in 0..4 {
                unsafe { p.add(4 * lane + k).write_unaligned(v[k.min(2)][lane]) };
            }
        }
    }
    #[inline(always)]
    unsafe fn load_f(self, p: *const f32) -> [f32; 4] {
        unsafe { p.cast::<[f32; 4]>().read_unaligned() }
    }
    #[inline(always)]
    unsafe fn load_i(self, p: *const u32) -> [i32; 4] {
        unsafe { p.cast::<[i32; 4]>().read_unaligned() }
    }
    #[inline(always)]
    unsafe fn load_some(self, p: *const u32, n: usize) -> [i32; 4] {
        let mut lanes = [0; 4];
        for (lane, x) in lanes.iter_mut().enumerate().take(n) {
            *x = unsafe { p.add(lane).read_unaligned() as i32 };
        }
        lanes
    }
    #[inline(always)]
    unsafe fn store_f(self, p: *mut f32, x: [f32; 4]) {
        unsafe { p.cast::<[f32; 4]>().write_unaligned(x) }
    }
    #[inline(always)]
    unsafe fn store_i(self, p: *mut u32, x: [i32; 4]) {
        unsafe { p.cast::<[i32; 4]>().write_unaligned(x) }
    }
    #[inline(always)]
    unsafe fn store_d(self, p: *mut f64, x: [f64; 4]) {
        unsafe { p.cast::<[f64; 4]>().write_unaligned(x) }
    }
    #[inline(always)]
    unsafe fn load_strided(self, p: *const u8, stride: usize) -> [f32; 4] {
        let at = [0, 1, 2, 3];
        lanes!(at => unsafe { strided(p, at, stride).read_unaligned() })
    }
    #[inline(always)]
    unsafe fn gather(self, p: *const f32, index: [i32; 4]) -> [f32; 4] {
        lanes!(index => unsafe { *p.add(index as usize) })
    }
    #[inline(always)]
    unsafe fn load_triangles(self, p: *const u32) -> [[i32; 4]; 3] {
        let t = unsafe { p.cast::<[i32; 12]>().read_unaligned() };
        [[t[0], t[3], t[6], t[9]], [t[1], t[4], t[7], t[10]], [t[2], t[5], t[8], t[11]]]
    }
    #[inline(always)]
    unsafe fn load_quads(self, p: *const f32) -> [[f32; 4]; 4] {
        let v = unsafe { p.cast::<[[f32; 4]; 4]>().read_unaligned() };
        let k = [0, 1, 2, 3];
        lanes!(k => [v[0][k], v[1][k], v[2][k], v[3][k]])
    }
    #[inline(always)]
    unsafe fn load_bytes(self, p: *const u8) -> [i32; 4] {
        unsafe { p.cast::<[u8; 4]>().read().map(i32::from) }
    }
    #[inline(always)]
    unsafe fn compress(self, p: *mut u32, m: [bool; 4], x: [i32; 4]) -> usize {
        let mut n = 0;
        for lane in 0..4 {
            // SAFETY: n <= lane < 4, which the caller's contract covers.
            unsafe { *p.add(n) = x[lane] as u32 };
            n += usize::from(m[lane]);
        }
        n
    }

    #[inline(always)]
    fn add(self, a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
        lanes!(a, b => a + b)
    }
    #[inline(always)]
    fn sub(self, a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
        lanes!(a, b => a - b)
    }
    #[inline(always)]
    fn mul(self, a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
        lanes!(a, b => a * b)
    }
    #[inline(always)]
    fn div(self, a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
        lanes!(a, b => a / b)
    }
    #[inline(always)]
    fn min(self, a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
        lanes!(a, b => if a < b { a } else { b })
    }
    #[inline(always)]
    fn max(self, a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
        lanes!(a, b => if a > b { a } else { b })
    }
    #[inline(always)]
    fn abs(self, a: [f32; 4]) -> [f32; 4] {
        lanes!(a => a.abs())
    }
    #[inline(always)]
    fn lt(self, a: [f32; 4], b: [f32; 4]) -> [bool; 4] {
        lanes!(a, b => a < b)
    }
    #[inline(always)]
    fn le(self, a: [f32; 4], b: [f32; 4]) -> [bool; 4] {
        lanes!(a, b => a <= b)
    }
    #[inline(always)]
    fn eq(self, a: [f32; 4], b: [f32; 4]) -> [bool; 4] {
        lanes!(a, b => a == b)
    }
    #[inline(always)]
    fn select(self, m: [bool; 4], a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
        lanes!(m, a, b => if m { a } else { b })
    }
    #[inline(always)]
    fn round(self, a: [f32; 4]) -> [i32; 4] {
        // A value too large for an i32 may be rounded differently, but is clamped to the same result.
        lanes!(a => round_ties_even(f64::from(a)) as i32)
    }
    #[inline(always)]
    fn trunc(self, a: [f32; 4]) -> [i32; 4] {
        lanes!(a => a as i32)
    }
    #[inline(always)]
    fn to_f(self, a: [i32; 4]) -> [f32; 4] {
        lanes!(a => a as f32)
    }
    #[inline(always)]
    fn bits(self, a: [f32; 4]) -> [i32; 4] {
        lanes!(a => a.to_bits() as i32)
    }
    #[inline(always)]
    fn float_of_bits(self, a: [i32; 4]) -> [f32; 4] {
        lanes!(a => f32::from_bits(a as u32))
    }
    #[inline(always)]
    unsafe fn store_z_min(self, p: *mut f32, _: usize, a: [f32; 4]) {
        let least = |a: f32, b: f32| if a < b { a } else { b };
        unsafe { store_relaxed(p, least(least(a[0], a[1]), least(a[2], a[3]))) }
    }

    #[inline(always)]
    fn add_i(self, a: [i32; 4], b: [i32; 4]) -> [i32; 4] {
        lanes!(a, b => a.wrapping_add(b))
    }
    #[inline(always)]
    fn sub_i(self, a: [i32; 4], b: [i32; 4]) -> [i32; 4] {
        lanes!(a, b => a.wrapping_sub(b))
    }
    #[inline(always)]
    fn sub_sat(self, a: [i32; 4], b: [i32; 4]) -> [i32; 4] {
        lanes!(a, b => {
            let half = |shift: u32| ((a as u32 >> shift) as u16).saturating_sub((b as u32 >> shift) as u16);
            (u32::from(half(16)) << 16 | u32::from(half(0))) as i32
        })
    }
    #[inline(always)]
    fn and(self, a: [i32; 4], b: [i32; 4]) -> [i32; 4] {
        lanes!(a, b => a & b)
    }
    #[inline(always)]
    fn or(self, a: [i32; 4], b: [i32; 4]) -> [i32; 4] {
        lanes!(a, b => a | b)
    }
    #[inline(always)]
    fn and_not(self, a: [i32; 4], b: [i32; 4]) -> [i32; 4] {
        lanes!(a, b => !a & b)
    }
    #[inline(always)]
    fn min_i(self, a: [i32; 4], b: [i32; 4]) -> [i32; 4] {
        lanes!(a, b => a.min(b))
    }
    #[inline(always)]
    fn max_i(self, a: [i32; 4], b: [i32; 4]) -> [i32; 4] {
        lanes!(a, b => a.max(b))
    }
    #[inline(always)]
    fn max_u(self, a: [i32; 4], b: [i32; 4]) -> [i32; 4] {
        lanes!(a, b => (a as u32).max(b as u32) as i32)
    }
    #[inline(always)]
    fn shl<const N: i32>(self, a: [i32; 4]) -> [i32; 4] {
        lanes!(a => a << N)
    }
    #[inline(always)]
    fn sra<const N: i32>(self, a: [i32; 4]) -> [i32; 4] {
        lanes!(a => a >> N)
    }
    #[inline(always)]
    fn ones_shl(self, count: [i32; 4]) -> [i32; 4] {
        lanes!(count => u32::MAX.checked_shl(count as u32).unwrap_or(0) as i32)
    }
    #[inline(always)]
    fn gt_i(self, a: [i32; 4], b: [i32; 4]) -> [bool; 4] {
        lanes!(a, b => a > b)
    }
    #[inline(always)]
    fn eq_i(self, a: [i32; 4], b: [i32; 4]) -> [bool; 4] {
        lanes!(a, b => a == b)
    }
    #[inline(always)]
    fn select_i(self, m: [bool; 4], a: [i32; 4], b: [i32; 4]) -> [i32; 4] {
        lanes!(m, a, b => if m { a } else { b })
    }
    #[inline(always)]
    fn transpose_bytes(self, a: [i32; 4]) -> [i32; 4] {
        let b = lanes!(a => a.to_le_bytes());
        let j = [0, 1, 2, 3];
        lanes!(j => i32::from_le_bytes([b[0][j], b[1][j], b[2][j], b[3][j]]))
    }

    #[inline(always)]
    fn and_m(self, a: [bool; 4], b: [bool; 4]) -> [bool; 4] {
        lanes!(a, b => a & b)
    }
    #[inline(always)]
    fn or_m(self, a: [bool; 4], b: [bool; 4]) -> [bool; 4] {
        lanes!(a, b => a | b)
    }
    #[inline(always)]
    fn and_not_m(self, a: [bool; 4], b: [bool; 4]) -> [bool; 4] {
        lanes!(a, b => !a & b)
    }
    #[inline(always)]
    fn mask_bits(self, m: [bool; 4]) -> u32 {
        u32::from(m[0]) | u32::from(m[1]) << 1 | u32::from(m[2]) << 2 | u32::from(m[3]) << 3
    }

    #[inline(always)]
    fn d(self, x: f64) -> [f64; 4] {
        [x; 4]
    }
    #[inline(always)]
    fn to_d(self, a: [f32; 4]) -> [f64; 4] {
        lanes!(a => f64::from(a))
    }
    #[inline(always)]
    fn d_to_f(self, a: [f64; 4]) -> [f32; 4] {
        lanes!(a => a as f32)
    }
    #[inline(always)]
    fn d_to_i(self, a: [f64; 4]) -> [i32; 4] {
        lanes!(a => a as i32)
    }
    #[inline(always)]
    fn add_d(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        lanes!(a, b => a + b)
    }
    #[inline(always)]
    fn sub_d(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        lanes!(a, b => a - b)
    }
    #[inline(always)]
    fn mul_d(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        lanes!(a, b => a * b)
    }
    #[inline(always)]
    fn div_d(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        lanes!(a, b => a / b)
    }
    #[inline(always)]
    fn min_d(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        lanes!(a, b => if a < b { a } else { b })
    }
    #[inline(always)]
    fn max_d(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        lanes!(a, b => if a > b { a } else { b })
    }
}
