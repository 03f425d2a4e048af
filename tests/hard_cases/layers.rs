//! Ten thousand layers in one sub-tile of 8x4 pixels, in every order that distinguishes the rules: foliage, hair, a
//! city seen along its streets. A sub-tile stores two to four of their depths.

use masked_occlusion_culling::{UpdateRule, YAxis};

use crate::cases::Case;
use crate::cases::measured::Measured;
use crate::cases::subject::Subject;
use crate::oracle::snap::snapped;
use crate::oracle::{Oracle, Triangle, UNIT};

pub const CASES: &[&Case] = &[&THREE_LAYER, &QUICK, &ACCURATE, &FOUR_LAYER];

static THREE_LAYER: Case = Case::new("10,000 layers in a sub-tile, three layers", || layers(UpdateRule::ThreeLayer));
static QUICK: Case = Case::new("10,000 layers in a sub-tile, quick", || layers(UpdateRule::Quick));
static ACCURATE: Case = Case::new("10,000 layers in a sub-tile, accurate", || layers(UpdateRule::Accurate));
static FOUR_LAYER: Case = Case::new("10,000 layers in a sub-tile, four layers", || layers(UpdateRule::FourLayer));

const SIZE: (usize, usize) = (8, 4);
const LAYERS: u32 = 10_000;

/// Layer numbers, 0 being the nearest, in drawing order.
fn orders() -> Vec<(&'static str, Vec<u32>)> {
    let all = || 0..LAYERS;
    let mut shuffled: Vec<u32> = all().collect();
    fastrand::Rng::with_seed(41).shuffle(&mut shuffled);
    let half = LAYERS / 2;
    vec![
        ("front to back", all().collect()),
        ("back to front", all().rev().collect()),
        ("random", shuffled),
        // The nearest, the farthest, the second nearest, ...
        ("from both ends", (0..half).flat_map(|k| [k, LAYERS - 1 - k]).collect()),
        ("from the middle", (0..half).flat_map(|k| [half + k, half - 1 - k]).collect()),
        // 0, 5000, 2500, 7500, ...: always halving the largest gap.
        ("halving the gaps", halving()),
        // A hundred objects of a hundred layers, each front to back, the farthest object first.
        ("objects back to front", all().map(|k| (99 - k / 100) * 100 + k % 100).collect()),
    ]
}

fn halving() -> Vec<u32> {
    (0..1_u32 << 14).map(|k| k.reverse_bits() >> 18).filter(|k| *k < LAYERS).collect()
}

/// How the depths of neighbouring layers differ.
#[derive(Clone, Copy)]
enum Spacing {
    /// w from 1 to 1001.
    Even,
    /// One step of f32.
    Least,
}

impl Spacing {
    fn w(self, layer: u32) -> f32 {
        match self {
            Spacing::Even => 1.0 + layer as f32 * 0.1,
            Spacing::Least => f32::from_bits(1.0_f32.to_bits() + layer),
        }
    }
}

/// A layer's triangle in clip space: one in four covers the whole sub-tile, the others a part of it.
fn layer(random: &mut fastrand::Rng, w: f32) -> [[f32; 4]; 3] {
    let corners = match random.u32(0..4) {
        0 => [(-8, -8), (40, -8), (-8, 40)],
        1 => {
            // About half of it, from one side.
            let (a, b) = (random.i32(0..=16), random.i32(0..=16));
            [(a, -8), (b, 16), ([-60, 60][random.usize(0..2)], 4)]
        }
        _ => [(); 3].map(|()| (random.i32(-2..=18), random.i32(-2..=10))),
    };
    // In half pixels; the screen is 16 by 8 of them, powers of two that scale w exactly.
    corners.map(|(x, y)| [(x as f32 / 8.0 - 1.0) * w, (1.0 - y as f32 / 4.0) * w, 0.0, w])
}

fn layers(rule: UpdateRule) -> Measured {
    let mut measured = Measured::default();
    for spacing in [Spacing::Even, Spacing::Least] {
        for (name, order) in orders() {
            let mut random = fastrand::Rng::with_seed(42);
            let mut subject = Subject::of_rule(SIZE, YAxis::Down, rule);
            let mut oracle = Oracle::new(SIZE.0, SIZE.1);
            assert_eq!(order.len(), LAYERS as usize, "{name}");
            for (k, number) in order.into_iter().enumerate() {
                let corners = layer(&mut random, spacing.w(number));
                let t: Triangle = corners.map(|v| snapped(v, SIZE, false).expect("a vertex on the grid"));
                assert!(t.iter().all(|v| v.x % (UNIT / 2) == 0 && v.y % (UNIT / 2) == 0));
                // Where something has already been drawn, coverage can no longer be wrong.
                measured.pixels += oracle.depth.iter().filter(|d| **d < 0.0).count() as u64;
                // If it is visible before it is drawn, it must not be reported hidden then, nor afterwards, since it does not
                // hide itself.
                if oracle.shows(&t) {
                    measured.shown(subject.test_clip(&corners));
                    subject.draw_clip(&corners);
                    oracle.draw(&t);
                    measured.shown(subject.test_clip(&corners));
                } else {
                    subject.draw_clip(&corners);
                }
                measured.triangles += 1;
                measured.depths(subject.depth(), &oracle);
                if k % 500 == 499 {
                    pixels(&mut measured, &subject, &oracle);
                }
            }
        }
    }
    measured
}

/// Each pixel is tested at its exact depth, or at the next nearer value.
fn pixels(measured: &mut Measured, subject: &Subject, oracle: &Oracle) {
    for (i, &exact) in oracle.depth.iter().enumerate().filter(|(_, d)| **d > 0.0) {
        let mut w = (1.0 / exact) as f32;
        while 1.0 / f64::from(w) < exact {
            w = w.next_down();
        }
        measured.shown(subject.test_pixel(i % SIZE.0, i / SIZE.0, w));
    }
}

/// The default rule.
#[test]
fn ten_thousand_layers_with_three_layers() {
    THREE_LAYER.measured().assert_exact().assert_behind(0.02, 5e-5);
}

#[test]
fn ten_thousand_layers_with_four_layers() {
    FOUR_LAYER.measured().assert_exact().assert_behind(0.02, 5e-5);
}

/// The rule of HPG 2016.
#[test]
fn ten_thousand_layers_with_the_quick_rule() {
    QUICK.measured().assert_exact().assert_behind(0.84, 0.02);
}

/// The rule of 2015.
#[test]
fn ten_thousand_layers_with_the_accurate_rule() {
    ACCURATE.measured().assert_exact().assert_behind(0.5, 5e-4);
}
