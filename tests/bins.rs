//! However the work is divided (several calls, bins, scissor rectangles, threads), the buffer is the same.

mod scenes;

use masked_occlusion_culling::{
    ClipSpaceLayout, DrawOptions, Implementation, MaskedOcclusionCulling, ModelSpaceLayout, ScissorRect, Settings,
    TriList, UpdateRule, Vertices, YAxis,
};
use scenes::Scene;

const SIZE: (u32, u32) = (420, 235);
const RULES: [UpdateRule; 4] = [UpdateRule::ThreeLayer, UpdateRule::Quick, UpdateRule::Accurate, UpdateRule::FourLayer];

fn vertices(scene: &Scene) -> Vertices<'_> {
    let space = match scene.matrix {
        Some(matrix) => ModelSpaceLayout::XYZ_PADDED.with_matrix(matrix),
        None => ClipSpaceLayout::XYZW.into(),
    };
    Vertices::new(scene.vertices.as_flattened(), space).unwrap()
}

fn object(
    scene: &Scene,
    implementation: Implementation,
    update_rule: UpdateRule,
    y_axis: YAxis,
) -> MaskedOcclusionCulling {
    let mut moc = MaskedOcclusionCulling::new(
        SIZE.0,
        SIZE.1,
        Settings::default().with_implementation(implementation).with_update_rule(update_rule).with_y_axis(y_axis),
    )
    .unwrap();
    moc.set_near_clip_plane(scene.near).unwrap();
    moc
}

fn bits(moc: &MaskedOcclusionCulling) -> Vec<u32> {
    let mut depth = vec![0.0; (SIZE.0 * SIZE.1) as usize];
    moc.compute_pixel_depth_buffer(&mut depth, false).unwrap();
    depth.into_iter().map(f32::to_bits).collect()
}

/// Every scene, instruction set, rule and row direction, with the bits obtained by drawing object by object.
fn every(test: impl Fn(&Scene, MaskedOcclusionCulling, Vec<u32>, &str)) {
    for scene in scenes::all() {
        for &implementation in Implementation::available() {
            for rule in RULES {
                for axis in [YAxis::Down, YAxis::Up] {
                    let mut reference = object(&scene, implementation, rule, axis);
                    for indices in &scene.objects {
                        reference.render_triangles(vertices(&scene), indices, &DrawOptions::default()).unwrap();
                    }
                    let who = format!("{} {implementation:?} {rule:?} {axis:?}", scene.name);
                    test(&scene, object(&scene, implementation, rule, axis), bits(&reference), &who);
                }
            }
        }
    }
}

#[test]
fn one_call_or_many() {
    every(|scene, mut moc, want, who| {
        let all = scene.objects.concat();
        moc.render_triangles(vertices(scene), &all, &DrawOptions::default()).unwrap();
        assert!(bits(&moc) == want, "{who}: one call for all objects");
        moc.clear_buffer();
        let (mut rest, mut next) = (&all[..], [1, 2, 15, 16, 17, 100, 1023, 1025].into_iter().cycle());
        while !rest.is_empty() {
            let (now, later) = rest.split_at(rest.len().min(3 * next.next().unwrap_or(1)));
            moc.render_triangles(vertices(scene), now, &DrawOptions::default()).unwrap();
            rest = later;
        }
        assert!(bits(&moc) == want, "{who}: calls of many lengths");
    });
}

/// The rectangle of a bin: the last one of a row or column extends to the edge.
fn scissor(bin: u32, bins: (u32, u32), bin_size: (u32, u32)) -> ScissorRect {
    let side = |i: u32, n: u32, step: u32, size: u32| (i * step, if i + 1 == n { size } else { (i + 1) * step });
    let (x, y) = (side(bin % bins.0, bins.0, bin_size.0, SIZE.0), side(bin / bins.0, bins.1, bin_size.1, SIZE.1));
    ScissorRect { min_x: x.0 as i32, min_y: y.0 as i32, max_x: x.1 as i32, max_y: y.1 as i32 }
}

/// Bins every object of the scene into lists that are large enough for it.
fn binned<'a>(
    scene: &Scene,
    moc: &MaskedOcclusionCulling,
    bins: (u32, u32),
    storage: &'a mut [Vec<f32>],
) -> Vec<TriList<'a>> {
    let mut lists: Vec<_> = storage.iter_mut().map(|s| TriList::new(s)).collect();
    for indices in &scene.objects {
        moc.bin_triangles(vertices(scene), indices, &mut lists, bins.0, bins.1, &DrawOptions::default()).unwrap();
    }
    lists
}

fn storage(scene: &Scene, bins: (u32, u32)) -> Vec<Vec<f32>> {
    let triangles: usize = scene.objects.iter().map(|o| o.len() / 3).sum();
    // Clipping can turn one triangle into a few.
    vec![vec![0.0; 9 * (triangles * 2 + 64)]; (bins.0 * bins.1) as usize]
}

#[test]
fn bins_one_by_one() {
    every(|scene, mut moc, want, who| {
        for bins in [(1, 1), (4, 3), (13, 29)] {
            let mut storage = storage(scene, bins);
            let lists = binned(scene, &moc, bins, &mut storage);
            let bin_size = moc.compute_bin_size(bins.0, bins.1).unwrap();
            moc.clear_buffer();
            // In an order that no draw call has: bins do not depend on each other.
            for i in (0..lists.len()).rev() {
                moc.render_trilist(&lists[i], Some(scissor(i as u32, bins, bin_size))).unwrap();
            }
            assert!(bits(&moc) == want, "{who}: {bins:?} bins");
        }
    });
}

#[test]
fn one_list_without_a_scissor() {
    every(|scene, mut moc, want, who| {
        let mut storage = storage(scene, (1, 1));
        let lists = binned(scene, &moc, (1, 1), &mut storage);
        moc.clear_buffer();
        moc.render_trilist(&lists[0], None).unwrap();
        assert!(bits(&moc) == want, "{who}");
    });
}

#[test]
fn bins_on_several_threads() {
    const THREADS: usize = 3;
    every(|scene, mut moc, want, who| {
        let bins = (5, 4);
        let mut storage = storage(scene, bins);
        let lists = binned(scene, &moc, bins, &mut storage);
        let bin_size = moc.compute_bin_size(bins.0, bins.1).unwrap();
        moc.clear_buffer();
        std::thread::scope(|scope| {
            for thread in 0..THREADS {
                let (moc, lists) = (&moc, &lists);
                scope.spawn(move || {
                    for i in (thread..lists.len()).step_by(THREADS) {
                        // SAFETY: the bins' rectangles are disjoint, each is drawn by one thread, and the threads end
                        // with this scope, before anything else uses the object.
                        unsafe { moc.render_trilist_shared(&lists[i], Some(scissor(i as u32, bins, bin_size))) }
                            .unwrap();
                    }
                });
            }
        });
        assert!(bits(&moc) == want, "{who}");
    });
}
