//! Queries that end early: without statistics the library looks at one pixel, at one corner of a mesh and at the mesh
//! as a whole first. The answers are those of the full query, which statistics ask for.

use fastrand::Rng;
use masked_occlusion_culling::{
    BackfaceWinding, CullingResult, DrawOptions, Implementation, MaskedOcclusionCulling, Settings, UpdateRule,
    Vertices, YAxis,
};

const RULES: [UpdateRule; 4] = [UpdateRule::ThreeLayer, UpdateRule::Quick, UpdateRule::Accurate, UpdateRule::FourLayer];
const SIZES: [(u32, u32); 4] = [(320, 180), (333, 77), (40, 300), (8, 4)];
const BOX: [u32; 36] =
    [0, 1, 3, 0, 3, 2, 4, 6, 7, 4, 7, 5, 0, 4, 5, 0, 5, 1, 2, 3, 7, 2, 7, 6, 0, 2, 6, 0, 6, 4, 1, 5, 7, 1, 7, 3];

/// The same object with statistics and without.
fn pair(
    size: (u32, u32),
    implementation: Implementation,
    rule: UpdateRule,
    axis: YAxis,
) -> [MaskedOcclusionCulling; 2] {
    [true, false].map(|statistics| {
        let settings = Settings::default()
            .with_implementation(implementation)
            .with_update_rule(rule)
            .with_y_axis(axis)
            .with_statistics(statistics);
        MaskedOcclusionCulling::new(size.0, size.1, settings).unwrap()
    })
}

/// The corners of a box in clip space; some boxes cross the near plane or the screen's sides, or are flat.
fn corners(random: &mut Rng) -> Vec<[f32; 4]> {
    let w = [0.05, 1.0, 1.0, 3.0, 20.0][random.usize(..5)] * (0.5 + random.f32());
    let spread = [1.5, 1.0, 4.0][random.usize(..3)];
    let size = [0.001, 0.02, 0.2, 1.0][random.usize(..4)];
    let at = |random: &mut Rng| (random.f32() - 0.5) * 2.0 * spread * w;
    let (x, y) = (at(random), at(random));
    let [sx, sy, sw] = [(); 3].map(|()| random.f32() * size * w * f32::from(random.u8(..8) != 0));
    (0..8).map(|k| [x + sx * (k & 1) as f32, y + sy * (k >> 1 & 1) as f32, 0.0, w + sw * (k >> 2 & 1) as f32]).collect()
}

fn triangles(random: &mut Rng) -> (Vec<[f32; 4]>, Vec<u32>) {
    let count = random.usize(1..40);
    let vertices = (0..3 * count)
        .map(|_| {
            let w = 0.1 + random.f32() * 20.0;
            [(random.f32() - 0.5) * 3.0 * w, (random.f32() - 0.5) * 3.0 * w, 0.0, w]
        })
        .collect();
    (vertices, (0..3 * count as u32).collect())
}

fn winding(random: &mut Rng) -> BackfaceWinding {
    [BackfaceWinding::None, BackfaceWinding::Clockwise, BackfaceWinding::CounterClockwise][random.usize(..3)]
}

#[test]
fn early_answers_are_those_of_the_full_query() {
    let mut answers = [0_u64; 3];
    for (seed, &size) in SIZES.iter().enumerate() {
        for (rule, axis) in RULES.into_iter().zip([YAxis::Down, YAxis::Up, YAxis::Down, YAxis::Up]) {
            for &implementation in Implementation::available() {
                // The same for every instruction set.
                let mut random = Rng::with_seed(seed as u64);
                for _ in 0..20 {
                    let mut objects = pair(size, implementation, rule, axis);
                    for _ in 0..random.usize(..12) {
                        let (vertices, indices) =
                            if random.bool() { triangles(&mut random) } else { (corners(&mut random), BOX.to_vec()) };
                        let options = DrawOptions::default().with_winding(winding(&mut random));
                        for moc in &mut objects {
                            moc.render_triangles(Vertices::clip_space(&vertices), &indices, &options).unwrap();
                        }
                    }
                    for _ in 0..60 {
                        let (vertices, indices) = if random.u8(..4) == 0 {
                            triangles(&mut random)
                        } else {
                            (corners(&mut random), BOX.to_vec())
                        };
                        let options = DrawOptions::default().with_winding(winding(&mut random));
                        let [full, early] = objects.each_ref().map(|moc| {
                            moc.test_triangles(Vertices::clip_space(&vertices), &indices, &options).unwrap()
                        });
                        assert_eq!(early, full, "{implementation:?} {rule:?} {size:?} {vertices:?}");
                        answers[match full {
                            CullingResult::Visible => 0,
                            CullingResult::Occluded => 1,
                            CullingResult::ViewCulled => 2,
                        }] += 1;
                        let [x, y] = [(); 2].map(|()| (random.f32() - 0.5) * 2.4);
                        let [width, height] = [(); 2].map(|()| random.f32() * [0.05, 0.3, 2.0][random.usize(..3)]);
                        let w = 0.1 + random.f32() * 25.0;
                        let [full, early] = objects.each_ref().map(|moc| moc.test_rect(x, y, x + width, y + height, w));
                        assert_eq!(early, full, "{implementation:?} {rule:?} {size:?} {x} {y} {width} {height} {w}");
                    }
                }
            }
        }
    }
    assert!(answers.iter().all(|n| *n > 1_000), "{answers:?}");
}
