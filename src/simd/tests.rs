//! Compares every operation on every instruction set with the scalar one, bit by bit.

#[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), feature = "avx2"))]
use super::with_sixteen_lanes;
use super::{Job, Level, Simd, run, scalar};

/// Sixteen lanes of input, as many as the widest vector has.
const N: usize = 16;

#[derive(Clone, Copy)]
struct Input {
    a: [f32; N],
    b: [f32; N],
    i: [u32; N],
    j: [u32; N],
    /// From 0 to 65535, mostly up to 32.
    count: [u32; N],
    /// Below N.
    index: [u32; N],
}

struct AllOperations(Input);

impl Job for AllOperations {
    type Output = Vec<u32>;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Vec<u32> {
        operations(s, &self.0)
    }
}

/// The results of all operations, lane by lane within each operation; vectors of any width give the same.
#[inline(always)]
fn operations<S: Simd>(s: S, input: &Input) -> Vec<u32> {
    let mut out: Vec<Vec<u32>> = Vec::new();
    let (mut kept, mut listed) = (Vec::new(), Vec::new());
    let mut stored_records = Vec::new();
    let count_of_lanes = input.index[0] as usize;
    for first in (0..N).step_by(S::LANES) {
        let mut results: Vec<Vec<u32>> = Vec::new();
        // SAFETY: every array has N elements, and `first + LANES <= N`.
        let (a, b, i, j, count, index) = unsafe {
            (
                s.load_f(input.a.as_ptr().add(first)),
                s.load_f(input.b.as_ptr().add(first)),
                s.load_i(input.i.as_ptr().add(first)),
                s.load_i(input.j.as_ptr().add(first)),
                s.load_i(input.count.as_ptr().add(first)),
                s.load_i(input.index.as_ptr().add(first)),
            )
        };
        let lanes = |x: S::I| {
            let mut lanes = [0; N];
            // SAFETY: N words hold a vector.
            unsafe { s.store_i(lanes.as_mut_ptr(), x) };
            lanes[..S::LANES].to_vec()
        };
        // The bits of a NaN may differ between instruction sets; whether a result is NaN may not.
        let canonical = |x: u32| if f32::from_bits(x).is_nan() { 0x7fc0_0000 } else { x };
        let floats = |x: S::F| lanes(s.bits(x)).into_iter().map(canonical).collect::<Vec<_>>();
        let masks = |m: S::M| lanes(s.select_i(m, s.i(-1), s.i(0)));
        let doubles = |d: S::D| {
            let mut lanes = [0.0_f64; N];
            // SAFETY: N doubles hold a vector.
            unsafe { s.store_d(lanes.as_mut_ptr(), d) };
            let canonical = |x: f64| if x.is_nan() { f64::NAN } else { x }.to_bits();
            lanes[..S::LANES].iter().map(|&x| (canonical(x) ^ (canonical(x) >> 32)) as u32).collect::<Vec<_>>()
        };
        let (da, db) = (s.to_d(a), s.to_d(b));
        let m = s.lt(a, b);
        let k = s.gt_i(i, j);
        results.extend(
            [s.add(a, b), s.sub(a, b), s.mul(a, b), s.div(a, b), s.min(a, b), s.max(a, b), s.abs(a)].map(floats),
        );
        let (positive_a, positive_b) = (s.abs(a), s.abs(b));
        let ordered = s.and_m(s.eq(a, a), s.eq(b, b));
        let positive = [s.min_positive(positive_a, positive_b), s.max_positive(positive_a, positive_b)];
        results.extend(positive.map(|x| floats(s.select(ordered, x, s.f(0.0)))));
        results.extend(
            [m, s.le(a, b), s.eq(a, b), k, s.eq_i(i, j), s.and_m(m, k), s.or_m(m, k), s.and_not_m(m, k)].map(masks),
        );
        results.extend([s.select(m, a, b), s.to_f(i), s.float_of_bits(i)].map(floats));
        results.extend(
            [
                s.add_i(i, j),
                s.sub_i(i, j),
                s.sub_sat(i, j),
                s.and(i, j),
                s.or(i, j),
                s.and_not(i, j),
                s.min_i(i, j),
                s.max_i(i, j),
            ]
            .map(lanes),
        );
        results
            .extend([s.max_u(i, j), s.shl::<13>(i), s.sra::<5>(i), s.ones_shl(count), s.select_i(k, i, j)].map(lanes));
        results.extend(
            [
                s.transpose_bytes(i),
                s.round(s.mul(s.to_f(s.sra::<8>(i)), s.f(0.125))),
                s.trunc(s.mul(s.to_f(s.sra::<8>(i)), s.f(0.125))),
            ]
            .map(lanes),
        );
        let sums =
            [s.add_d(da, db), s.sub_d(da, db), s.mul_d(da, db), s.div_d(da, db), s.min_d(da, db), s.max_d(da, db)];
        results.extend(sums.map(doubles));
        // With integers, for which rounding once or twice gives the same result.
        let whole = |x: S::I| s.to_d(s.to_f(s.sra::<12>(x)));
        results.push(doubles(s.mul_add_d(whole(i), whole(j), whole(index))));
        results.push(floats(s.d_to_f(s.add_d(da, db))));
        results.push(lanes(s.d_to_i(s.to_d(s.mul(s.to_f(s.sra::<4>(i)), s.f(0.37))))));
        results.push(masks(s.first(S::LANES)));
        // SAFETY: indices are below N; one f32 every 8 bytes, starting in the middle of an array of length 4 N, stays
        // inside.
        unsafe {
            results.push(floats(s.gather(input.a.as_ptr(), index)));
            let pairs: Vec<f32> = input.a.iter().copied().chain([0.5]).collect();
            let both = s.gather_pairs(pairs.as_ptr(), index).map(floats);
            assert!(both == s.gather_pairs_relaxed(pairs.as_ptr(), index).map(floats));
            results.extend(both);
            let table_index = s.and(index, s.i(3));
            results.push(floats(s.lookup(input.a.as_ptr(), table_index)));
            let far: Vec<f32> = (0..4 * N).map(|x| x as f32).collect();
            results.push(floats(s.lookup_32(far.as_ptr(), s.and(i, s.i(31)))));
            results.push(floats(s.load_strided(far.as_ptr().cast::<u8>().add(8 * first), 8)));
            // Negative stride: products that wrap around.
            let last = far.as_ptr().cast::<u8>().add(4 * (3 * N - first));
            results.push(floats(s.load_strided(last, 4_usize.wrapping_neg())));
            let triangles: Vec<u32> = (0..3 * N as u32).collect();
            results.extend(s.load_triangles(triangles.as_ptr().add(3 * first)).map(lanes));
            results.extend(s.load_quads(far.as_ptr().add(4 * first)).map(floats));
            let names: Vec<u32> = (0..3 * N as u32).map(|k| 7 * k % N as u32).collect();
            let records = s.load_records(far.as_ptr(), names.as_ptr().add(3 * first));
            results.extend(records.map(floats));
            let mut stored = [0.0_f32; 4 * N];
            s.store_records(stored.as_mut_ptr(), records);
            for lane in stored[..4 * S::LANES].chunks(4) {
                stored_records.extend(lane[..3].iter().map(|x| x.to_bits()));
            }
            let n = count_of_lanes.saturating_sub(first);
            results.push(lanes(s.load_some(input.i.as_ptr().add(first), n)));
            let mut packed = [0; N];
            let n = s.compress(packed.as_mut_ptr(), m, i);
            kept.extend_from_slice(&packed[..n]);
            let named = 1000 + first as u32;
            let n = s.list_lanes(packed.as_mut_ptr(), m, count_of_lanes.saturating_sub(first), named);
            listed.extend_from_slice(&packed[..n]);
            results.push(lanes(s.load_bytes(input.i.as_ptr().cast::<u8>().add(first))));
        }
        let bits = s.mask_bits(m);
        results.push((0..S::LANES).map(|lane| bits >> lane & 1).collect());
        if out.is_empty() {
            out.resize(results.len(), Vec::new());
        }
        for (all, part) in out.iter_mut().zip(results) {
            all.extend(part);
        }
    }
    // The least of each eight lanes; a vector of four has its own.
    let numbers = input.a.map(|x| if x.is_nan() { 0.0 } else { x.abs() });
    let mut least = [f32::INFINITY; 2];
    for first in (0..N).step_by(S::LANES) {
        let mut stored = [f32::INFINITY; 2];
        // SAFETY: N floats hold a vector, and two floats hold the least values of its halves.
        unsafe { s.store_z_min(stored.as_mut_ptr(), 1, s.load_f(numbers.as_ptr().add(first))) };
        for (k, x) in stored.into_iter().enumerate().take(S::LANES.div_ceil(8)) {
            least[first / 8 + k] = least[first / 8 + k].min(x);
        }
    }
    out.push(least.map(f32::to_bits).to_vec());
    out.push(stored_records);
    out.push(kept);
    out.push(listed);
    out.concat()
}

/// xorshift64*: a fixed stream of bits.
struct Bits(u64);

impl Bits {
    fn next(&mut self) -> u32 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 32) as u32
    }

    fn float(&mut self, special: bool) -> f32 {
        const SPECIAL: [f32; 8] =
            [0.0, -0.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 1.0, f32::MAX, f32::MIN_POSITIVE];
        match self.next() % 4 {
            0 if special => SPECIAL[self.next() as usize % SPECIAL.len()],
            // Of moderate size, so that no result is denormal or overflows.
            _ => f32::from_bits((self.next() & 0x807f_ffff) | (96 + self.next() % 60) << 23),
        }
    }
}

#[test]
fn every_instruction_set_agrees_with_scalar() {
    let mut bits = Bits(0x9e37_79b9_7f4a_7c15);
    for round in 0..500 {
        let special = round % 2 == 1;
        let input = Input {
            a: core::array::from_fn(|_| bits.float(special)),
            b: core::array::from_fn(|_| bits.float(special)),
            i: core::array::from_fn(|_| bits.next()),
            j: core::array::from_fn(|_| bits.next() >> (bits.next() % 32)),
            count: core::array::from_fn(|lane| if lane % 4 == 3 { bits.next() % 65536 } else { bits.next() % 33 }),
            index: core::array::from_fn(|_| bits.next() % N as u32),
        };
        let expected = scalar::enter(AllOperations(input));
        for level in Level::all() {
            let got = run(level, AllOperations(input));
            let same = expected == got;
            assert!(same, "{level:?}, round {round}:\n{expected:x?}\n{got:x?}");
        }
        #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), feature = "avx2"))]
        if let Some(avx2) = Level::of(crate::Implementation::Avx2) {
            let got = with_sixteen_lanes(|| run(avx2, AllOperations(input)));
            assert!(expected == got, "two vectors of AVX2, round {round}:\n{expected:x?}\n{got:x?}");
        }
    }
}
