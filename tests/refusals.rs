//! Which calls are rejected, with which error, and that they draw and change nothing.

use masked_occlusion_culling::{
    ClipSpaceLayout,
    CullingResult::{ViewCulled, Visible},
    DrawOptions, Error, Implementation, MaskedOcclusionCulling, ModelSpaceLayout, Settings, TriList, Vertices,
};

const TRIANGLE: [[f32; 4]; 3] = [[-1.0, -1.0, 0.0, 1.0], [3.0, -1.0, 0.0, 1.0], [-1.0, 3.0, 0.0, 1.0]];

fn every(mut test: impl FnMut(MaskedOcclusionCulling)) {
    for &implementation in Implementation::available() {
        let moc = MaskedOcclusionCulling::new(64, 32, Settings::default().with_implementation(implementation)).unwrap();
        test(moc);
    }
}

fn untouched(moc: &MaskedOcclusionCulling) -> bool {
    let mut depth = [0.0; 64 * 32];
    moc.compute_pixel_depth_buffer(&mut depth, false).unwrap();
    depth.iter().all(|d| *d < 0.0)
}

#[test]
fn sizes_that_no_object_can_have() {
    for (width, height) in [(0, 0), (0, 8), (8, 0), (16_385, 8), (8, 16_385), (u32::MAX, u32::MAX)] {
        let refused = MaskedOcclusionCulling::new(width, height, Settings::default()).err();
        assert_eq!(refused, Some(Error::InvalidSize), "{width}x{height}");
    }
}

#[test]
fn indices_out_of_range_draw_nothing() {
    every(|mut moc| {
        let (vertices, options) = (Vertices::clip_space(&TRIANGLE), DrawOptions::default());
        // The bad index at every position in meshes of many lengths, so that every lane of the scan sees it.
        for triangles in [1, 2, 5, 6, 11, 43] {
            for place in 0..triangles * 3 {
                for bad in [3, 4, 0x8000_0000, u32::MAX] {
                    let mut indices: Vec<u32> = (0..triangles * 3).map(|i| i % 3).collect();
                    indices[place as usize] = bad;
                    let out = Err(Error::IndexOutOfRange);
                    assert_eq!(moc.render_triangles(vertices, &indices, &options), out, "{place} of {triangles}");
                    assert_eq!(moc.test_triangles(vertices, &indices, &options), out, "{place} of {triangles}");
                    let mut storage = [0.0; 9 * 64];
                    let mut lists = [TriList::new(&mut storage)];
                    assert_eq!(moc.bin_triangles(vertices, &indices, &mut lists, 1, 1, &options), out);
                    assert!(lists[0].is_empty());
                }
            }
        }
        assert!(untouched(&moc));
        assert_eq!(moc.render_triangles(vertices, &[0, 1, 2], &options), Ok(Visible));
        assert!(!untouched(&moc));
    });
}

#[test]
fn no_vertices_and_no_triangles() {
    every(|mut moc| {
        let (none, options) = (Vertices::clip_space(&[]), DrawOptions::default());
        assert_eq!(moc.render_triangles(none, &[0, 0, 0], &options), Err(Error::IndexOutOfRange));
        assert!(moc.render_triangles(none, &[], &options).is_ok());
        assert!(moc.test_triangles(none, &[], &options).is_ok());
        assert!(untouched(&moc));
    });
}

#[test]
fn indices_that_are_not_whole_triangles() {
    every(|mut moc| {
        let (vertices, options) = (Vertices::clip_space(&TRIANGLE), DrawOptions::default());
        for indices in [&[0][..], &[0, 1], &[0, 1, 2, 0], &[0, 1, 2, 0, 1]] {
            assert_eq!(moc.render_triangles(vertices, indices, &options), Err(Error::InvalidSize));
            assert_eq!(moc.test_triangles(vertices, indices, &options), Err(Error::InvalidSize));
        }
        assert!(untouched(&moc));
    });
}

#[test]
fn near_planes_that_are_not_finite() {
    let mut moc = MaskedOcclusionCulling::new(8, 8, Settings::default()).unwrap();
    assert_eq!(moc.near_clip_plane(), 0.0);
    moc.set_near_clip_plane(0.5).unwrap();
    for near in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(moc.set_near_clip_plane(near), Err(Error::InvalidNumber));
        assert_eq!(moc.near_clip_plane(), 0.5);
    }
}

#[test]
fn layouts_with_negative_offsets() {
    for (stride, y, w) in [(-16, 4, 12), (16, -4, 12), (16, 4, -12), (i32::MIN, 0, 0), (0, i32::MIN, 0)] {
        let layout = ClipSpaceLayout::new(stride, y, w);
        assert_eq!(Vertices::new(&[0.0; 16], layout).err(), Some(Error::InvalidLayout));
        let space = ModelSpaceLayout::new(stride, y, w).with_matrix([0.0; 16]);
        assert_eq!(Vertices::new(&[0.0; 16], space).err(), Some(Error::InvalidLayout));
    }
    // Offsets beyond the slice leave no vertex at all.
    for (stride, y, w) in [(16, 4, i32::MAX), (i32::MAX, i32::MAX, i32::MAX), (4, 64, 8)] {
        assert_eq!(Vertices::new(&[0.0; 16], ClipSpaceLayout::new(stride, y, w)).unwrap().len(), 0);
    }
    assert_eq!(Vertices::new(&[0.0; 16], ClipSpaceLayout::XYZW).unwrap().len(), 4);
    assert_eq!(Vertices::new(&[0.0; 15], ClipSpaceLayout::XYZW).unwrap().len(), 3);
    assert_eq!(Vertices::new(&[0.0; 12], ClipSpaceLayout::new(4, 16, 32)).unwrap().len(), 4);
}

#[test]
fn the_instruction_set_is_capped_by_the_argument() {
    let all = Implementation::available();
    for &implementation in all {
        let settings = Settings::default().with_implementation(implementation);
        let moc = MaskedOcclusionCulling::new(8, 8, settings).unwrap();
        assert_eq!(moc.implementation(), implementation);
    }
    let best = MaskedOcclusionCulling::new(8, 8, Settings::default()).unwrap().implementation();
    assert_eq!(best, *all.last().unwrap());
    if cfg!(any(target_arch = "x86", target_arch = "x86_64")) {
        assert!(all.contains(&Implementation::Sse2));
        for cap in [Implementation::Sse2, Implementation::Sse41, Implementation::Avx2, Implementation::Avx512] {
            let got = cap.capped();
            assert!(all.contains(&got) && got as i32 <= cap as i32, "{cap:?} gives {got:?}");
        }
        assert_eq!(Implementation::Sse2.capped(), Implementation::Sse2);
    }
    // An instruction set of another architecture is no limit: programs written for x86-64 ask for AVX-512 everywhere.
    use Implementation::*;
    let foreign: &[Implementation] = match std::env::consts::ARCH {
        "x86_64" => &[Neon, Simd128],
        "aarch64" => &[Sse2, Sse41, Avx2, Avx512, Simd128],
        "wasm32" => &[Sse2, Sse41, Avx2, Avx512, Neon],
        _ => &[],
    };
    for &cap in foreign {
        assert_eq!(cap.capped(), *all.last().unwrap(), "{cap:?}");
    }
    // Scalar code is compiled where there is nothing else, or on request; otherwise the simplest instruction set takes its
    // place.
    assert_eq!(Scalar.capped(), all[0]);
    assert_eq!(all.contains(&Scalar), cfg!(feature = "scalar") || all.len() == 1 && all[0] == Scalar);
}

#[test]
fn what_faces_away_or_lies_outside_is_view_culled() {
    every(|mut moc| {
        let options = DrawOptions::default();
        let vertices = Vertices::clip_space(&TRIANGLE);
        // Clockwise in normalised device coordinates, y up, is back-facing.
        assert_eq!(moc.render_triangles(vertices, &[0, 2, 1], &options), Ok(ViewCulled));
        assert_eq!(moc.test_triangles(vertices, &[0, 2, 1], &options), Ok(ViewCulled));
        for [x, y, w] in [[5.0, 0.0, 1.0], [-5.0, 0.0, 1.0], [0.0, 5.0, 1.0], [0.0, -5.0, 1.0], [0.0, 0.0, -5.0]] {
            let away = TRIANGLE.map(|v| [v[0] * 0.1 + x, v[1] * 0.1 + y, 0.0, w]);
            let away = Vertices::clip_space(&away);
            assert_eq!(moc.render_triangles(away, &[0, 1, 2], &options), Ok(ViewCulled), "{x} {y} {w}");
            assert_eq!(moc.test_triangles(away, &[0, 1, 2], &options), Ok(ViewCulled), "{x} {y} {w}");
        }
        assert!(untouched(&moc));
        assert_eq!(moc.render_triangles(vertices, &[0, 2, 1, 0, 1, 2], &options), Ok(Visible));
    });
}
