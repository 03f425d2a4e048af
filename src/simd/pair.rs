//! Doubles the number of lanes: two vectors of a narrower instruction set side by side.
//!
//! SAFETY of every block without its own comment: the caller of an `unsafe fn` guarantees it for the whole vector,
//! and so for each half.

use super::{Outlined, Simd, strided};

#[derive(Clone, Copy)]
pub(super) struct Pair<S>(pub S);

/// A job for the pair, as a job for the half.
struct InPair<J>(J);

impl<S: Simd, J: Outlined<Pair<S>>> Outlined<S> for InPair<J> {
    type Output = J::Output;

    #[inline(always)]
    fn run(self, s: S) -> J::Output {
        self.0.run(Pair(s))
    }
}

macro_rules! pairwise {
    ($($name:ident($($a:ident: $t:ident),+) -> $r:ident;)*) => {$(
        #[inline(always)]
        fn $name(self $(, $a: Self::$t)+) -> Self::$r {
            [self.0.$name($($a[0]),+), self.0.$name($($a[1]),+)]
        }
    )*};
}

impl<S: Simd> Simd for Pair<S> {
    const LANES: usize = 2 * S::LANES;
    type F = [S::F; 2];
    type I = [S::I; 2];
    type M = [S::M; 2];
    type D = [S::D; 2];

    #[inline(always)]
    fn outlined<J: Outlined<Self>>(self, job: J) -> J::Output {
        self.0.outlined(InPair(job))
    }

    #[inline(always)]
    fn f(self, x: f32) -> Self::F {
        [self.0.f(x); 2]
    }
    #[inline(always)]
    fn i(self, x: i32) -> Self::I {
        [self.0.i(x); 2]
    }
    #[inline(always)]
    fn d(self, x: f64) -> Self::D {
        [self.0.d(x); 2]
    }
    #[inline(always)]
    fn iota(self) -> Self::I {
        let low = self.0.iota();
        [low, self.0.add_i(low, self.0.i(S::LANES as i32))]
    }

    #[inline(always)]
    unsafe fn load_records(self, p: *const f32, index: *const u32) -> [Self::F; 3] {
        unsafe {
            let (low, high) = (self.0.load_records(p, index), self.0.load_records(p, index.add(3 * S::LANES)));
            [[low[0], high[0]], [low[1], high[1]], [low[2], high[2]]]
        }
    }
    #[inline(always)]
    unsafe fn store_records(self, p: *mut f32, [x, y, z]: [Self::F; 3]) {
        unsafe {
            self.0.store_records(p, [x[0], y[0], z[0]]);
            self.0.store_records(p.add(4 * S::LANES), [x[1], y[1], z[1]]);
        }
    }
    #[inline(always)]
    unsafe fn load_f(self, p: *const f32) -> Self::F {
        unsafe { [self.0.load_f(p), self.0.load_f(p.add(S::LANES))] }
    }
    #[inline(always)]
    unsafe fn load_i(self, p: *const u32) -> Self::I {
        unsafe { [self.0.load_i(p), self.0.load_i(p.add(S::LANES))] }
    }
    #[inline(always)]
    unsafe fn load_some(self, p: *const u32, n: usize) -> Self::I {
        unsafe { [self.0.load_some(p, n), self.0.load_some(p.wrapping_add(S::LANES), n.saturating_sub(S::LANES))] }
    }
    #[inline(always)]
    unsafe fn store_f(self, p: *mut f32, x: Self::F) {
        unsafe {
            self.0.store_f(p, x[0]);
            self.0.store_f(p.add(S::LANES), x[1]);
        }
    }
    #[inline(always)]
    unsafe fn store_i(self, p: *mut u32, x: Self::I) {
        unsafe {
            self.0.store_i(p, x[0]);
            self.0.store_i(p.add(S::LANES), x[1]);
        }
    }
    #[inline(always)]
    unsafe fn store_d(self, p: *mut f64, x: Self::D) {
        unsafe {
            self.0.store_d(p, x[0]);
            self.0.store_d(p.add(S::LANES), x[1]);
        }
    }
    #[inline(always)]
    unsafe fn load_strided(self, p: *const u8, stride: usize) -> Self::F {
        unsafe { [self.0.load_strided(p, stride), self.0.load_strided(strided(p, S::LANES, stride).cast(), stride)] }
    }
    #[inline(always)]
    unsafe fn gather(self, p: *const f32, index: Self::I) -> Self::F {
        unsafe { [self.0.gather(p, index[0]), self.0.gather(p, index[1])] }
    }
    #[inline(always)]
    unsafe fn gather_pairs(self, p: *const f32, index: Self::I) -> [Self::F; 2] {
        let (a, b) = unsafe { (self.0.gather_pairs(p, index[0]), self.0.gather_pairs(p, index[1])) };
        [[a[0], b[0]], [a[1], b[1]]]
    }
    #[inline(always)]
    unsafe fn load_triangles(self, p: *const u32) -> [Self::I; 3] {
        let (a, b) = unsafe { (self.0.load_triangles(p), self.0.load_triangles(p.add(3 * S::LANES))) };
        [[a[0], b[0]], [a[1], b[1]], [a[2], b[2]]]
    }
    #[inline(always)]
    unsafe fn load_quads(self, p: *const f32) -> [Self::F; 4] {
        let (a, b) = unsafe { (self.0.load_quads(p), self.0.load_quads(p.add(4 * S::LANES))) };
        [[a[0], b[0]], [a[1], b[1]], [a[2], b[2]], [a[3], b[3]]]
    }
    #[inline(always)]
    unsafe fn compress(self, p: *mut u32, m: Self::M, x: Self::I) -> usize {
        // SAFETY: the caller's contract; the second half starts at most LANES / 2 after `p`.
        unsafe {
            let n = self.0.compress(p, m[0], x[0]);
            n + self.0.compress(p.add(n), m[1], x[1])
        }
    }

    #[inline(always)]
    unsafe fn load_bytes(self, p: *const u8) -> Self::I {
        unsafe { [self.0.load_bytes(p), self.0.load_bytes(p.add(S::LANES))] }
    }

    pairwise! {
        trunc(a: F) -> I;
        sub_sat(a: I, b: I) -> I;
        add(a: F, b: F) -> F;
        sub(a: F, b: F) -> F;
        mul(a: F, b: F) -> F;
        div(a: F, b: F) -> F;
        min(a: F, b: F) -> F;
        max(a: F, b: F) -> F;
        abs(a: F) -> F;
        lt(a: F, b: F) -> M;
        le(a: F, b: F) -> M;
        eq(a: F, b: F) -> M;
        select(m: M, a: F, b: F) -> F;
        round(a: F) -> I;
        to_f(a: I) -> F;
        bits(a: F) -> I;
        float_of_bits(a: I) -> F;
        add_i(a: I, b: I) -> I;
        sub_i(a: I, b: I) -> I;
        and(a: I, b: I) -> I;
        or(a: I, b: I) -> I;
        and_not(a: I, b: I) -> I;
        min_i(a: I, b: I) -> I;
        max_i(a: I, b: I) -> I;
        max_u(a: I, b: I) -> I;
        ones_shl(count: I) -> I;
        gt_i(a: I, b: I) -> M;
        eq_i(a: I, b: I) -> M;
        select_i(m: M, a: I, b: I) -> I;
        transpose_bytes(a: I) -> I;
        and_m(a: M, b: M) -> M;
        or_m(a: M, b: M) -> M;
        and_not_m(a: M, b: M) -> M;
        to_d(a: F) -> D;
        d_to_f(a: D) -> F;
        d_to_i(a: D) -> I;
        add_d(a: D, b: D) -> D;
        sub_d(a: D, b: D) -> D;
        mul_d(a: D, b: D) -> D;
        mul_add_d(a: D, b: D, c: D) -> D;
        div_d(a: D, b: D) -> D;
        min_d(a: D, b: D) -> D;
        max_d(a: D, b: D) -> D;
    }

    #[inline(always)]
    fn shl<const N: i32>(self, a: Self::I) -> Self::I {
        [self.0.shl::<N>(a[0]), self.0.shl::<N>(a[1])]
    }
    #[inline(always)]
    fn sra<const N: i32>(self, a: Self::I) -> Self::I {
        [self.0.sra::<N>(a[0]), self.0.sra::<N>(a[1])]
    }
    #[inline(always)]
    fn prefetch(self, p: *const u32) {
        self.0.prefetch(p);
    }
    #[inline(always)]
    unsafe fn store_z_min(self, p: *mut f32, pitch: usize, a: Self::F) {
        unsafe {
            if S::LANES < 8 {
                return self.0.store_z_min(p, pitch, self.0.min(a[0], a[1]));
            }
            self.0.store_z_min(p, pitch, a[0]);
            self.0.store_z_min(p.add(pitch), pitch, a[1]);
        }
    }
    #[inline(always)]
    fn mask_bits(self, m: Self::M) -> u32 {
        self.0.mask_bits(m[0]) | self.0.mask_bits(m[1]) << S::LANES
    }
}
