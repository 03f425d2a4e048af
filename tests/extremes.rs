//! Coordinates of all magnitudes at once, as in no real scene: the results must still be within bounds.

use masked_occlusion_culling::{
    BackfaceWinding, CullingResult, DrawOptions, Implementation, MaskedOcclusionCulling, Settings, UpdateRule, Vertices,
};

/// A number of either sign between 10^-25 and 10^25, with a uniformly distributed exponent; sometimes zero.
fn any_size(random: &mut fastrand::Rng, limit: f32) -> f32 {
    if random.u32(..16) == 0 {
        return 0.0;
    }
    let size = 10.0_f32.powf((random.f32() * 2.0 - 1.0) * limit);
    if random.bool() { size } else { -size }
}

fn object(rule: UpdateRule, width: u32, height: u32) -> MaskedOcclusionCulling {
    let settings = Settings::default().with_implementation(Implementation::Avx512).with_update_rule(rule);
    MaskedOcclusionCulling::new(width, height, settings).unwrap()
}

const BOTH_SIDES: DrawOptions = DrawOptions::new().with_winding(BackfaceWinding::None);

/// Nothing in front of the near plane is ever stored, in particular nothing infinitely near, which would hide
/// everything.
#[test]
fn no_depth_is_nearer_than_the_near_plane() {
    let mut random = fastrand::Rng::with_seed(1);
    let mut depth = vec![0.0; 64 * 48];
    let rules = [
        (UpdateRule::ThreeLayer, 0.0),
        (UpdateRule::Quick, 0.25),
        (UpdateRule::Accurate, 0.0),
        (UpdateRule::FourLayer, 0.0),
    ];
    for (rule, near) in rules {
        let mut moc = object(rule, 64, 48);
        moc.set_near_clip_plane(near).unwrap();
        // Nothing nearer than 2^-30 is projected.
        let nearest = 1.0 / near.max(2.0_f32.powi(-30)) * 1.000_001;
        let mut drawn = 0;
        for limit in [3.0, 10.0, 25.0] {
            for _ in 0..4000 {
                let triangle: [[f32; 4]; 3] =
                    core::array::from_fn(|_| core::array::from_fn(|_| any_size(&mut random, limit)));
                moc.clear_buffer();
                moc.render_triangles(Vertices::clip_space(&triangle), &[0, 1, 2], &BOTH_SIDES).unwrap();
                moc.compute_pixel_depth_buffer(&mut depth, false).unwrap();
                drawn += usize::from(depth.iter().any(|&d| d > 0.0));
                assert!(depth.iter().all(|&d| d <= nearest), "{triangle:?}");
            }
        }
        assert!(drawn > 500, "only {drawn} triangles reached the screen");
    }
}

/// An empty buffer hides nothing: a triangle that is not visible in it is outside the view.
#[test]
fn an_empty_buffer_never_answers_occluded() {
    let mut random = fastrand::Rng::with_seed(2);
    for (width, height) in [(1, 1), (3, 2), (64, 48)] {
        let moc = object(UpdateRule::ThreeLayer, width, height);
        let mut culled = 0;
        for k in 0..6000 {
            let triangle: [[f32; 4]; 3] = core::array::from_fn(|_| {
                if k % 2 == 0 {
                    // Around the screen, where the bounds may overlap it but the triangle does not.
                    let mut side = || random.i32(-9..=9) as f32;
                    [side(), side(), 0.0, 1.0]
                } else {
                    core::array::from_fn(|_| any_size(&mut random, 6.0))
                }
            });
            let answer = moc.test_triangles(Vertices::clip_space(&triangle), &[0, 1, 2], &BOTH_SIDES).unwrap();
            assert_ne!(answer, CullingResult::Occluded, "{width}x{height} {triangle:?}");
            culled += usize::from(answer == CullingResult::ViewCulled);
        }
        assert!(culled > 100, "{culled}");
    }
}

/// Found by the fuzzer: the bounds of this triangle contain the only pixel, but the triangle misses it.
#[test]
fn a_triangle_that_passes_by_the_only_pixel_is_view_culled() {
    let moc = object(UpdateRule::ThreeLayer, 1, 1);
    let triangle = [[4.0, -9.0, 0.0, 1.0], [5.0, -3.0, 0.0, 1.0], [-8.0, 1.0, 0.0, 1.0]];
    let answer = moc.test_triangles(Vertices::clip_space(&triangle), &[0, 1, 2], &BOTH_SIDES);
    assert_eq!(answer, Ok(CullingResult::ViewCulled));
}

/// Found in review: these corners are so far away that f32 places them several subpixels off, and the triangle overlaps
/// a corner of the screen by less than that. A query has to account for how far off they may be.
#[test]
fn a_triangle_with_far_corners_is_seen_at_the_corner_of_the_screen() {
    let moc = object(UpdateRule::ThreeLayer, 1920, 1080);
    let triangle = [
        [-433.0577, 774.12885, 0.0, 2.3610508],
        [131.28049, -230.7281, 0.0, 0.708027],
        [120.40197, 213.67404, 0.0, 1.2955712],
    ];
    let options = DrawOptions::default();
    let answer = moc.test_triangles(Vertices::clip_space(&triangle), &[0, 1, 2], &options);
    assert_eq!(answer, Ok(CullingResult::Visible));
}

/// An infinite coordinate is counted, and the triangle visible, even if two other corners would put it outside the
/// screen.
#[test]
fn what_is_not_finite_is_outside_of_nothing() {
    let mut moc = object(UpdateRule::ThreeLayer, 64, 48);
    for bad in [f32::INFINITY, f32::NAN, f32::NEG_INFINITY] {
        let triangle = [[bad, -1.0, 0.0, 1.0], [3.0, -1.0, 0.0, 1.0], [3.0, 1.0, 0.0, 1.0]];
        let before = moc.statistics().occluders.num_dropped_triangles;
        moc.render_triangles(Vertices::clip_space(&triangle), &[0, 1, 2], &BOTH_SIDES).unwrap();
        assert_eq!(moc.statistics().occluders.num_dropped_triangles, before + 1, "{bad}");
        let answer = moc.test_triangles(Vertices::clip_space(&triangle), &[0, 1, 2], &BOTH_SIDES);
        assert_eq!(answer, Ok(CullingResult::Visible), "{bad}");
    }
}

/// Beyond 2^40 an occluder is dropped and counted, and an occludee is visible.
#[test]
fn what_is_too_far_is_dropped_or_visible() {
    let mut moc = object(UpdateRule::ThreeLayer, 64, 48);
    let wall = |w: f32| [[-w, -w, 0.0, w], [3.0 * w, -w, 0.0, w], [-w, 3.0 * w, 0.0, w]];
    let far = wall(2.0 * (1_u64 << 40) as f32);
    moc.render_triangles(Vertices::clip_space(&far), &[0, 1, 2], &BOTH_SIDES).unwrap();
    assert_eq!(moc.statistics().occluders.num_dropped_triangles, 1);
    moc.render_triangles(Vertices::clip_space(&wall(1.0)), &[0, 1, 2], &BOTH_SIDES).unwrap();
    let test = |v: &[[f32; 4]]| moc.test_triangles(Vertices::clip_space(v), &[0, 1, 2], &BOTH_SIDES);
    assert_eq!(test(&wall(1e6)), Ok(CullingResult::Occluded));
    assert_eq!(test(&far), Ok(CullingResult::Visible));
}
