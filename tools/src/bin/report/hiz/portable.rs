//! Any processor: arrays of eight, blocks of 8x1 pixels. The compiler vectorises them as it can.

use super::lanes::{Lanes, Pass, Words};

const N: usize = 8;
type F = [f32; N];
type I = [i32; N];

#[derive(Clone, Copy)]
pub struct Portable(());

impl Portable {
    pub fn run<P: Pass>(pass: P) -> P::Output {
        pass.run(Self(()))
    }
}

/// Methods that do the same in each lane.
macro_rules! lanewise {
    ($($name:ident($($a:ident: $t:ty),*) -> $r:ty = $e:expr;)*) => {
        $(
            #[inline(always)]
            fn $name(self, $($a: [$t; N]),*) -> [$r; N] {
                let mut out = [<$r>::default(); N];
                for k in 0..N {
                    $(let $a = $a[k];)*
                    out[k] = $e;
                }
                out
            }
        )*
    };
}

impl Lanes for Portable {
    const N: usize = N;
    const LOG_HEIGHT: u32 = 0;
    type F = F;
    type I = I;
    type M = [bool; N];

    lanewise! {
        bits_of(x: f32) -> i32 = x.to_bits() as i32;
        float_of(x: i32) -> f32 = f32::from_bits(x as u32);
        add(a: f32, b: f32) -> f32 = a + b;
        sub(a: f32, b: f32) -> f32 = a - b;
        mul(a: f32, b: f32) -> f32 = a * b;
        div(a: f32, b: f32) -> f32 = a / b;
        min(a: f32, b: f32) -> f32 = if a < b { a } else { b };
        max(a: f32, b: f32) -> f32 = if a > b { a } else { b };
        // A fused multiply-add would be a function call.
        mul_add(a: f32, b: f32, c: f32) -> f32 = a * b + c;
        // Without a call: below 2^22, adding and subtracting 1.5 * 2^23 leaves the nearest integer.
        round(a: f32) -> i32 = (a + 12_582_912.0 - 12_582_912.0) as i32;
        to_f(a: i32) -> f32 = a as f32;
        add_i(a: i32, b: i32) -> i32 = a.wrapping_add(b);
        sub_i(a: i32, b: i32) -> i32 = a.wrapping_sub(b);
        mul_i(a: i32, b: i32) -> i32 = a.wrapping_mul(b);
        min_i(a: i32, b: i32) -> i32 = a.min(b);
        max_i(a: i32, b: i32) -> i32 = a.max(b);
        and_i(a: i32, b: i32) -> i32 = a & b;
        or_i(a: i32, b: i32) -> i32 = a | b;
        cross(a: i32, b: i32, c: i32, d: i32) -> f32 =
            (f64::from(a) * f64::from(b) - f64::from(c) * f64::from(d)) as f32;
        lt(a: f32, b: f32) -> bool = a < b;
        le(a: f32, b: f32) -> bool = a <= b;
        lt_i(a: i32, b: i32) -> bool = a < b;
        eq_i(a: i32, b: i32) -> bool = a == b;
        and_m(a: bool, b: bool) -> bool = a && b;
        or_m(a: bool, b: bool) -> bool = a || b;
        select(m: bool, yes: f32, no: f32) -> f32 = if m { yes } else { no };
        select_i(m: bool, yes: i32, no: i32) -> i32 = if m { yes } else { no };
    }

    #[inline(always)]
    fn f(self, x: f32) -> F {
        [x; N]
    }
    #[inline(always)]
    fn i(self, x: i32) -> I {
        [x; N]
    }
    #[inline(always)]
    fn shr(self, a: I, n: u32) -> I {
        a.map(|a| a >> n)
    }
    #[inline(always)]
    fn shl(self, a: I, n: u32) -> I {
        a.map(|a| a << n)
    }
    #[inline(always)]
    fn bits(self, m: [bool; N]) -> u32 {
        (0..N).fold(0, |bits, k| bits | u32::from(m[k]) << k)
    }
    #[inline(always)]
    fn any_negative(self, a: I) -> bool {
        a.into_iter().fold(0, |any, a| any | a) < 0
    }
    #[inline(always)]
    fn least(self, a: F) -> f32 {
        a.into_iter().fold(f32::INFINITY, f32::min)
    }

    #[inline(always)]
    unsafe fn load(self, p: *const f32) -> F {
        // SAFETY: the caller's contract.
        unsafe { p.cast::<F>().read_unaligned() }
    }
    #[inline(always)]
    unsafe fn load_i(self, p: *const i32) -> I {
        // SAFETY: the caller's contract.
        unsafe { p.cast::<I>().read_unaligned() }
    }
    #[inline(always)]
    unsafe fn store(self, p: *mut f32, x: F) {
        // SAFETY: the caller's contract.
        unsafe { p.cast::<F>().write_unaligned(x) }
    }
    #[inline(always)]
    unsafe fn store_i(self, p: *mut i32, x: I) {
        // SAFETY: the caller's contract.
        unsafe { p.cast::<I>().write_unaligned(x) }
    }
    #[inline(always)]
    unsafe fn compress(self, p: *mut i32, keep: u32, x: I) {
        let mut kept = [0; N];
        let mut n = 0;
        for (k, x) in x.into_iter().enumerate() {
            if keep >> k & 1 == 1 {
                kept[n] = x;
                n += 1;
            }
        }
        // SAFETY: the caller's contract.
        unsafe { self.store_i(p, kept) }
    }
    #[inline(always)]
    unsafe fn raise(self, p: *mut f32, outside: I, depth: F) {
        // SAFETY: the caller's contract.
        unsafe {
            let mut old = self.load(p);
            for k in 0..N {
                let within = if outside[k] < 0 { 0.0 } else { depth[k] };
                old[k] = if within > old[k] { within } else { old[k] };
            }
            self.store(p, old);
        }
    }
    #[inline(always)]
    unsafe fn fetch<const STEP: usize>(self, base: *const Words, index: *const u32) -> [I; 4] {
        let mut out = [[0; N]; 4];
        for k in 0..N {
            // SAFETY: the caller's contract.
            let words = unsafe { *base.add(*index.add(STEP * k) as usize) };
            for (out, word) in out.iter_mut().zip(words) {
                out[k] = word as i32;
            }
        }
        out
    }
    #[inline(always)]
    unsafe fn spread(self, p: *mut Words, x: [I; 4]) {
        for k in 0..N {
            // SAFETY: the caller's contract.
            unsafe { *p.add(k) = x.map(|x| x[k] as u32) };
        }
    }
    #[inline(always)]
    unsafe fn transform(self, columns: &[[f32; 4]; 4], from: *const [f32; 4], to: *mut [f32; 4]) {
        let [cx, cy, cz, one] = columns;
        for k in 0..N {
            // SAFETY: the caller's contract.
            let [x, y, z, _] = unsafe { *from.add(k) };
            let mut clip = [0.0; 4];
            for r in 0..4 {
                clip[r] = x * cx[r] + (y * cy[r] + (z * cz[r] + one[r]));
            }
            // SAFETY: the caller's contract.
            unsafe { *to.add(k) = clip };
        }
    }
}
