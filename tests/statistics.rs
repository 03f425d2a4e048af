//! Statistics count what their documentation says, identically on every instruction set, however long the calls are.

mod scenes;

use masked_occlusion_culling::{
    ClipSpaceLayout, DrawOptions, Implementation, MaskedOcclusionCulling, ModelSpaceLayout, Settings, TriList,
    UpdateRule, Vertices,
};
use scenes::Scene;

const RULES: [UpdateRule; 4] = [UpdateRule::ThreeLayer, UpdateRule::Quick, UpdateRule::Accurate, UpdateRule::FourLayer];

fn vertices(scene: &Scene) -> Vertices<'_> {
    let space = match scene.matrix {
        Some(matrix) => ModelSpaceLayout::XYZ_PADDED.with_matrix(matrix),
        None => ClipSpaceLayout::XYZW.into(),
    };
    Vertices::new(scene.vertices.as_flattened(), space).unwrap()
}

fn objects(scene: &Scene, update_rule: UpdateRule) -> Vec<MaskedOcclusionCulling> {
    let all = Implementation::available();
    all.iter()
        .map(|&implementation| {
            let mut moc = MaskedOcclusionCulling::new(
                333,
                205,
                Settings::default()
                    .with_implementation(implementation)
                    .with_update_rule(update_rule)
                    .with_statistics(true),
            )
            .unwrap();
            moc.set_near_clip_plane(scene.near).unwrap();
            moc
        })
        .collect()
}

fn assert_equal(scene: &Scene, objects: &[MaskedOcclusionCulling], when: &str) {
    for moc in &objects[1..] {
        let (who, rule) = (moc.implementation(), moc.update_rule());
        assert_eq!(moc.statistics(), objects[0].statistics(), "{} {rule:?} {who:?}, {when}", scene.name);
    }
}

/// Thousands of triangles per call: how many are processed at a time must make no difference.
fn long_calls(call: impl Fn(&mut MaskedOcclusionCulling, Vertices<'_>, &[u32], &DrawOptions)) {
    for scene in scenes::all() {
        let all = scene.objects.concat();
        let options = DrawOptions::default();
        for rule in RULES {
            let mut objects = objects(&scene, rule);
            for time in 0..3 {
                objects.iter_mut().for_each(|moc| call(moc, vertices(&scene), &all, &options));
                assert_equal(&scene, &objects, &format!("time {time}"));
            }
        }
    }
}

#[test]
fn long_draws_count_the_same_everywhere() {
    long_calls(|moc, vertices, all, options| {
        moc.render_triangles(vertices, all, options).unwrap();
    });
}

#[test]
fn long_queries_count_the_same_everywhere() {
    // With an empty buffer at first, then with one that hides more and more.
    long_calls(|moc, vertices, all, options| {
        moc.test_triangles(vertices, all, options).unwrap();
        moc.render_triangles(vertices, &all[..all.len() / 6 * 3], options).unwrap();
    });
}

#[test]
fn lists_count_the_same_everywhere() {
    for scene in scenes::all() {
        let all = scene.objects.concat();
        let options = DrawOptions::default();
        let mut objects = objects(&scene, UpdateRule::ThreeLayer);
        for moc in &mut objects {
            let mut storage = vec![0.0; 9 * all.len()];
            let mut lists = [TriList::new(&mut storage)];
            moc.bin_triangles(vertices(&scene), &all, &mut lists, 1, 1, &options).unwrap();
            moc.render_trilist(&lists[0], None).unwrap();
        }
        assert_equal(&scene, &objects, "a list");
    }
}

#[test]
fn counts_are_what_was_asked() {
    for &implementation in Implementation::available() {
        let mut moc = MaskedOcclusionCulling::new(
            64,
            16,
            Settings::default().with_implementation(implementation).with_statistics(true),
        )
        .unwrap();
        let wall = [[-1.0, -1.0, 0.0, 1.0], [3.0, -1.0, 0.0, 1.0], [-1.0, 3.0, 0.0, 1.0], [f32::NAN; 4]];
        let vertices = Vertices::clip_space(&wall);
        // One front-facing, one back-facing, one degenerate.
        moc.render_triangles(vertices, &[0, 1, 2, 0, 2, 1, 0, 1, 3], &DrawOptions::default()).unwrap();
        let drawn = moc.statistics().occluders;
        assert_eq!((drawn.num_processed_triangles, drawn.num_rasterized_triangles), (3, 1));
        assert_eq!((drawn.num_tiles_traversed, drawn.num_tiles_updated, drawn.num_tiles_merged), (4, 4, 4));
        assert_eq!(drawn.num_dropped_triangles, 1);
        moc.test_rect(-1.0, -1.0, 1.0, 1.0, 2.0);
        moc.test_rect(5.0, 5.0, 6.0, 6.0, 2.0);
        moc.test_triangles(vertices, &[0, 1, 2, 0, 1, 2], &DrawOptions::default()).unwrap();
        let tested = moc.statistics().occludees;
        assert_eq!((tested.num_processed_rectangles, tested.num_processed_triangles), (2, 2));
        assert_eq!(moc.statistics().occluders, drawn);
        // They cover the object's whole life, not a frame.
        moc.clear_buffer();
        moc.set_resolution(32, 8).unwrap();
        assert_eq!(moc.statistics().occludees, tested);
    }
}

#[test]
fn dropped_triangles_are_counted_always() {
    let mut moc = MaskedOcclusionCulling::new(64, 16, Settings::default()).unwrap();
    let wall = [[-1.0, -1.0, 0.0, 1.0], [3.0, -1.0, 0.0, 1.0], [-1.0, 3.0, 0.0, 1.0], [f32::NAN; 4]];
    moc.render_triangles(Vertices::clip_space(&wall), &[0, 1, 2, 0, 1, 3], &DrawOptions::default()).unwrap();
    moc.test_rect(-1.0, -1.0, 1.0, 1.0, 2.0);
    let all = moc.statistics();
    assert_eq!(all.occluders.num_dropped_triangles, 1);
    assert_eq!((all.occluders.num_processed_triangles, all.occluders.num_tiles_updated), (0, 0));
    assert_eq!(all.occludees.num_processed_rectangles, 0);
}
