//! Compares vectors of sixteen lanes with those of eight: buffers, answers and statistics must match to the bit.
//!
//! `tests/same_bits.rs` compares the instruction sets of the processor at hand. Blocks of two tiles, look-ups of 32
//! values and the vectorised location of candidate tiles only exist with sixteen lanes, and many processors have no
//! AVX-512: here two AVX2 vectors emulate one.

#[path = "../../tests/scenes/mod.rs"]
mod scenes;

use crate::simd::with_sixteen_lanes;
use crate::{
    BackfaceWinding, ClipSpaceLayout, CullingResult, CullingThreadpool, DrawOptions, Implementation,
    MaskedOcclusionCulling, ModelSpaceLayout, ScissorRect, Settings, ThreadpoolSettings, TriList, UpdateRule, Vertices,
    YAxis,
};
use scenes::Scene;

/// How an object is constructed, and its size.
#[derive(Clone, Copy, Debug)]
struct Setting {
    update_rule: UpdateRule,
    y_axis: YAxis,
    statistics: bool,
    size: (u32, u32),
}

impl Setting {
    fn object(self, near: f32) -> MaskedOcclusionCulling {
        let Self { update_rule, y_axis, statistics, size } = self;
        let implementation = Implementation::Avx2;
        let settings = Settings { implementation, update_rule, y_axis, statistics, ..Settings::default() };
        let mut moc = MaskedOcclusionCulling::new(size.0, size.1, settings).unwrap();
        moc.set_near_clip_plane(near).unwrap();
        moc
    }
}

/// Every rule and row direction, with and without statistics; blocks crossed by the screen's edge, one that is half
/// outside, and more columns than a vector has lanes.
fn settings() -> Vec<Setting> {
    let mut all = Vec::new();
    for &update_rule in UpdateRule::available() {
        for (y_axis, statistics, size) in [
            (YAxis::Down, true, (333, 205)),
            (YAxis::Up, false, (420, 235)),
            (YAxis::Down, false, (64, 40)),
            (YAxis::Up, true, (1300, 72)),
        ] {
            all.push(Setting { update_rule, y_axis, statistics, size });
        }
    }
    all
}

fn vertices(scene: &Scene) -> Vertices<'_> {
    let space = match scene.matrix {
        Some(matrix) => ModelSpaceLayout::XYZ_PADDED.with_matrix(matrix),
        None => ClipSpaceLayout::XYZW.into(),
    };
    Vertices::new(scene.vertices.as_flattened(), space).unwrap()
}

fn depths(moc: &MaskedOcclusionCulling, (w, h): (u32, u32)) -> Vec<u32> {
    let mut depth = vec![0.0; (w * h) as usize];
    moc.compute_pixel_depth_buffer(&mut depth, false).unwrap();
    depth.into_iter().map(f32::to_bits).collect()
}

/// The outcome of a scene.
#[derive(PartialEq)]
struct Outcome {
    depths: Vec<u32>,
    answers: Vec<CullingResult>,
    statistics: String,
}

/// Compares the outcome of `play` for every scene and setting.
fn compare(play: impl Fn(&Scene, Setting) -> Outcome) {
    if !Implementation::available().contains(&Implementation::Avx2) {
        eprintln!("not compared: this processor has no AVX2");
        return;
    }
    for scene in scenes::all() {
        for setting in settings() {
            let (eight, sixteen) = (play(&scene, setting), with_sixteen_lanes(|| play(&scene, setting)));
            let who = format!("{} {setting:?}", scene.name);
            assert!(eight.depths == sixteen.depths, "{who}: depths");
            assert!(eight.answers == sixteen.answers, "{who}: answers");
            assert_eq!(eight.statistics, sixteen.statistics, "{who}");
        }
    }
}

fn outcome(moc: &MaskedOcclusionCulling, setting: Setting, answers: Vec<CullingResult>) -> Outcome {
    Outcome { depths: depths(moc, setting.size), answers, statistics: format!("{:?}", moc.statistics()) }
}

#[test]
fn draws_and_queries_are_the_same_on_sixteen_lanes() {
    for winding in [BackfaceWinding::Clockwise, BackfaceWinding::None] {
        compare(|scene, setting| {
            let (mut moc, options) = (setting.object(scene.near), DrawOptions::default().with_winding(winding));
            let mut answers = Vec::new();
            for object in &scene.objects {
                let [x0, y0, x1, y1, nearest] = scene.rectangle(object);
                answers.push(moc.test_rect(x0, y0, x1, y1, nearest));
                answers.push(moc.test_triangles(vertices(scene), object, &options).unwrap());
                answers.push(moc.render_triangles(vertices(scene), object, &options).unwrap());
            }
            // All in one call, so that vectors are full.
            answers.push(moc.test_triangles(vertices(scene), &scene.objects.concat(), &options).unwrap());
            outcome(&moc, setting, answers)
        });
    }
}

#[test]
fn one_call_for_everything_is_the_same_on_sixteen_lanes() {
    compare(|scene, setting| {
        let (mut moc, options) =
            (setting.object(scene.near), DrawOptions::default().with_winding(BackfaceWinding::Clockwise));
        let answer = moc.render_triangles(vertices(scene), &scene.objects.concat(), &options).unwrap();
        outcome(&moc, setting, vec![answer])
    });
}

#[test]
fn merges_are_the_same_on_sixteen_lanes() {
    compare(|scene, setting| {
        let options = DrawOptions::default().with_winding(BackfaceWinding::Clockwise);
        let mut objects = [0, 1].map(|_| setting.object(scene.near));
        for (k, object) in scene.objects.iter().enumerate() {
            objects[k % 2].render_triangles(vertices(scene), object, &options).unwrap();
        }
        let [mut into, from] = objects;
        into.merge_buffer(&from).unwrap();
        outcome(&into, setting, Vec::new())
    });
}

#[test]
fn lists_are_the_same_on_sixteen_lanes() {
    compare(|scene, setting| {
        let (mut moc, options) =
            (setting.object(scene.near), DrawOptions::default().with_winding(BackfaceWinding::Clockwise));
        let triangles = scene.objects.concat();
        // Bins with an odd number of tile rows are drawn with eight lanes.
        let (bins, (w, h)) = ((2, 3), setting.size);
        let mut memory = vec![vec![0.0; 9 * (triangles.len() + 64)]; 6];
        let mut lists: Vec<_> = memory.iter_mut().map(|memory| TriList::new(memory)).collect();
        moc.bin_triangles(vertices(scene), &triangles, &mut lists, bins.0, bins.1, &options).unwrap();
        let (wide, high) = moc.compute_bin_size(bins.0, bins.1).unwrap();
        for (k, list) in lists.iter().enumerate() {
            let (x, y) = (k as u32 % bins.0, k as u32 / bins.0);
            let end = |i: u32, n: u32, step: u32, size: u32| if i + 1 == n { size } else { (i + 1) * step } as i32;
            let scissor = ScissorRect {
                min_x: (x * wide) as i32,
                min_y: (y * high) as i32,
                max_x: end(x, bins.0, wide, w),
                max_y: end(y, bins.1, high, h),
            };
            moc.render_trilist(list, Some(scissor)).unwrap();
        }
        outcome(&moc, setting, Vec::new())
    });
}

/// Nothing wakes the pool's threads: the flushing thread does all the work, in eight bins.
#[test]
fn a_pool_is_the_same_on_sixteen_lanes() {
    compare(|scene, setting| {
        let options = DrawOptions::default().with_winding(BackfaceWinding::Clockwise);
        let pool =
            CullingThreadpool::new(ThreadpoolSettings::default().with_threads(2).with_bins(2, 4).with_processors(8))
                .unwrap();
        pool.set_buffer(setting.object(scene.near));
        pool.scope(|scope| {
            for object in &scene.objects {
                scope.render_triangles(vertices(scene), object, &options).unwrap();
            }
        });
        outcome(&pool.take_buffer().unwrap(), setting, Vec::new())
    });
}
