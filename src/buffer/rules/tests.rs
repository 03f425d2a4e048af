//! The rules on random sub-tiles: no bound is nearer than what was drawn, layers are nested and ordered, queries agree
//! with them, and the rules with several layers match a plain model.

use core::marker::PhantomData;

use fastrand::Rng;

use super::{Accurate, FourLayer, Quick, Rule, ThreeLayer};
use crate::buffer::BLOCK;
use crate::simd::{Job, Level, Simd, run};

/// As many lanes as the widest vector.
const N: usize = BLOCK;
const FULL: u32 = u32::MAX;

/// The input to sixteen sub-tiles: pixels at a depth, and a query of other pixels.
struct Step {
    mask: [u32; N],
    depth: [f32; N],
    touched: [u32; N],
    asked: [f32; N],
}

/// The result: the layers from far to near, and the rule's answers, a bit per sub-tile.
struct Seen {
    layers: Vec<[(u32, f32); N]>,
    merged: u32,
    hidden: u32,
}

#[repr(align(64))]
struct Memory([u32; 8 * BLOCK]);

struct Sequence<'a, R> {
    steps: &'a [Step],
    rule: PhantomData<R>,
}

impl<R: Rule> Job for Sequence<'_, R> {
    type Output = Vec<Seen>;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Vec<Seen> {
        let mut memory = Memory([0; 8 * BLOCK]);
        let mut all = Vec::new();
        for first in (0..N).step_by(S::LANES) {
            // SAFETY: eight planes are more than any rule has.
            unsafe { R::store(s, memory.0.as_mut_ptr().add(first), &R::empty(s)) };
        }
        for step in self.steps {
            let mut seen = Seen { layers: vec![[(0, 0.0); N]; R::LAYERS], merged: 0, hidden: 0 };
            for first in (0..N).step_by(S::LANES) {
                // SAFETY: arrays of N lanes, planes of N words, and a vector starting at `first` is inside both.
                unsafe {
                    let p = memory.0.as_mut_ptr().add(first);
                    let (mask, depth) =
                        (s.load_i(step.mask.as_ptr().add(first)), s.load_f(step.depth.as_ptr().add(first)));
                    let mut planes = R::load(s, p);
                    let mut all = Memory(memory.0);
                    let inserted = R::insert(s, &mut planes, mask, depth);
                    R::store(s, p, &planes);
                    if s.all(s.eq_i(mask, s.i(-1))) {
                        let p = all.0.as_mut_ptr().add(first);
                        let mut planes = R::load(s, p);
                        let seen = R::insert_all(s, &mut planes, depth);
                        R::store(s, p, &planes);
                        assert_eq!(all.0[..R::PLANES * BLOCK], memory.0[..R::PLANES * BLOCK], "insert_all is insert");
                        assert_eq!(s.mask_bits(seen.live), s.mask_bits(inserted.live));
                        assert_eq!(s.mask_bits(seen.merged), s.mask_bits(inserted.merged));
                    }
                    let (touched, asked) =
                        (s.load_i(step.touched.as_ptr().add(first)), s.load_f(step.asked.as_ptr().add(first)));
                    let planes = R::load(s, memory.0.as_ptr().add(first));
                    seen.merged |= s.mask_bits(inserted.merged) << first;
                    seen.hidden |= s.mask_bits(R::hides(s, &planes, touched, asked)) << first;
                    for (&(mask, z), to) in R::layers(s, &planes)[..R::LAYERS].iter().zip(&mut seen.layers) {
                        let (mut masks, mut depths) = ([0; N], [0.0; N]);
                        s.store_i(masks.as_mut_ptr(), mask);
                        s.store_f(depths.as_mut_ptr(), z);
                        (0..S::LANES).for_each(|lane| to[first + lane] = (masks[lane], depths[lane]));
                    }
                }
            }
            all.push(seen);
        }
        all
    }
}

/// Masks such as triangles leave, and others.
fn mask(random: &mut Rng) -> u32 {
    match random.u8(..6) {
        0 => FULL,
        1 => FULL << random.u32(..32),
        2 => FULL >> random.u32(..32),
        3 => (0..4).map(|row| (0xff << random.u32(..9) & 0xff) << (8 * row)).sum(),
        4 => random.u32(..) & random.u32(..),
        _ => 1 << random.u32(..32) & !random.u32(..2),
    }
}

/// Few distinct values, so that many are equal, or arbitrary ones.
fn depth(random: &mut Rng) -> f32 {
    if random.bool() { random.u8(1..12).into() } else { random.f32() * 8.0 + f32::MIN_POSITIVE }
}

fn steps(random: &mut Rng) -> Vec<Step> {
    let of = |random: &mut Rng| {
        let whole = random.u8(..8) == 0;
        let nearest = if random.bool() { 12.0 } else { 0.0 };
        Step {
            mask: core::array::from_fn(|_| if whole { FULL } else { mask(random) }),
            depth: core::array::from_fn(|_| depth(random) + if whole { nearest } else { 0.0 }),
            touched: core::array::from_fn(|_| mask(random) & mask(random)),
            asked: core::array::from_fn(|_| depth(random)),
        }
    };
    (0..random.usize(1..30)).map(|_| of(random)).collect()
}

/// Runs sequences on every instruction set.
fn sequences<R: Rule>(check: impl Fn(&[Step], &[Seen])) {
    for level in Level::all() {
        let mut random = Rng::with_seed(1);
        for _ in 0..300 {
            let steps = steps(&mut random);
            check(&steps, &run(level, Sequence::<R> { steps: &steps, rule: PhantomData }));
        }
    }
}

fn keeps_its_promises<R: Rule>() {
    sequences::<R>(|steps, all| {
        for lane in 0..N {
            let mut exact = [0.0_f32; 32];
            let mut reference = 0.0;
            for (step, seen) in steps.iter().zip(all) {
                for (_, z) in exact.iter_mut().enumerate().filter(|(p, _)| step.mask[lane] >> p & 1 != 0) {
                    *z = z.max(step.depth[lane]);
                }
                let layers: Vec<(u32, f32)> = seen.layers.iter().map(|layer| layer[lane]).collect();
                for &(mask, bound) in &layers {
                    let nearer = |pixel: &usize| mask >> pixel & 1 != 0 && bound > exact[*pixel];
                    assert_eq!((0..32).find(nearer), None, "{layers:?} is nearer than {exact:?}");
                }
                assert_eq!(layers[0].0, FULL);
                for pair in layers[1..].windows(2) {
                    assert!(pair[1].0 & !pair[0].0 == 0 && pair[0].1 <= pair[1].1, "{layers:?} from far to near");
                }
                assert!(layers[0].1 >= reference, "the reference fell");
                // The accurate rule also reports this when the reference rose to its previous value.
                assert!(seen.merged >> lane & 1 != 0 || layers[0].1 == reference, "{layers:?}");
                reference = layers[0].1;
                let (touched, asked) = (step.touched[lane], step.asked[lane]);
                let hidden = touched == 0 || layers.iter().any(|&(mask, z)| touched & !mask == 0 && asked < z);
                assert_eq!(seen.hidden >> lane & 1 != 0, hidden, "{layers:?}, {touched:x} at {asked}");
            }
        }
    });
}

#[test]
fn three_layers_keep_their_promises() {
    keeps_its_promises::<ThreeLayer>();
}

#[test]
fn the_quick_rule_keeps_its_promises() {
    keeps_its_promises::<Quick>();
}

#[test]
fn the_accurate_rule_keeps_its_promises() {
    keeps_its_promises::<Accurate>();
}

#[test]
fn four_layers_keep_their_promises() {
    keeps_its_promises::<FourLayer>();
}

/// A sub-tile as the multi-layer rules are specified: a reference depth, and layers from near to far.
struct Model {
    reference: f32,
    layers: Vec<(u32, f32)>,
}

impl Model {
    /// Inserts pixels at a depth, and gives up the layer whose loss costs the least depth.
    fn insert(&mut self, mask: u32, depth: f32) {
        let depth = if mask == 0 { 0.0 } else { depth };
        let at = self.layers.iter().position(|layer| layer.1 < depth).unwrap_or(self.layers.len());
        let in_front = if at == 0 { 0 } else { self.layers[at - 1].0 };
        self.layers.insert(at, (in_front, depth));
        self.layers[at..].iter_mut().for_each(|layer| layer.0 |= mask);
        let last = self.layers.len() - 1;
        if self.layers[last].0 == FULL {
            let full = self.layers.iter().find(|layer| layer.0 == FULL);
            self.reference = full.map_or(self.reference, |layer| layer.1.max(self.reference));
            self.layers.pop();
            return;
        }
        let loss = |k: usize| {
            let (mask, z) = self.layers[k];
            let behind = if k == last { self.reference } else { self.layers[k + 1].1 };
            if k > 0 && self.layers[k - 1].0 == mask { 0.0 } else { z - behind }
        };
        // On a tie the farthest layer goes, or else the nearest of those with equal losses.
        let least = (0..last).reduce(|a, b| if loss(b) < loss(a) { b } else { a }).unwrap_or(last);
        let dropped = if loss(last) <= loss(least).min(self.reference) {
            last
        } else if self.layers.len() == 3 && loss(0).min(self.layers[0].1 * (1.0 / 3.0)) <= loss(1) {
            // Only with three layers.
            0
        } else {
            least
        };
        self.layers.remove(dropped);
    }
}

/// Once every pixel has been drawn, at whatever depths and in whatever order, the reference is no longer empty.
fn fills<R: Rule>() {
    sequences::<R>(|steps, all| {
        for lane in 0..N {
            let mut drawn = 0;
            for (step, seen) in steps.iter().zip(all) {
                drawn |= step.mask[lane];
                let reference = seen.layers[0][lane].1;
                assert_eq!(reference > 0.0, drawn == FULL, "{drawn:x} drawn, the reference is {reference}");
            }
        }
    });
}

#[test]
fn three_layers_fill() {
    fills::<ThreeLayer>();
}

#[test]
fn four_layers_fill() {
    fills::<FourLayer>();
}

fn is_the_model<R: Rule>() {
    sequences::<R>(|steps, all| {
        for lane in 0..N {
            let mut model = Model { reference: 0.0, layers: vec![(FULL, 0.0); R::LAYERS - 1] };
            for (step, seen) in steps.iter().zip(all) {
                model.insert(step.mask[lane], step.depth[lane]);
                let layers: Vec<(u32, f32)> = seen.layers.iter().map(|layer| layer[lane]).collect();
                let expected: Vec<(u32, f32)> =
                    [(FULL, model.reference)].into_iter().chain(model.layers.iter().rev().copied()).collect();
                assert_eq!(layers, expected);
            }
        }
    });
}

#[test]
fn three_layers_are_the_model() {
    is_the_model::<ThreeLayer>();
}

#[test]
fn four_layers_are_the_model() {
    is_the_model::<FourLayer>();
}
