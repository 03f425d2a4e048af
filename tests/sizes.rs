//! Every size from 1 to 16,384, partial tiles at the edge, reading back, scissor rectangles and bin sizes.

mod oracle;
mod support;

use masked_occlusion_culling::{
    CullingResult::Occluded, CullingResult::Visible, Error, Implementation, MaskedOcclusionCulling, ScissorRect,
    Settings, TriList, UpdateRule, Vertices, YAxis,
};
use support::{AXES, RULES, both_sides, depth, draw_clip, name, object, wall};

const MAX: u32 = 16_384;

fn every(size: (usize, usize), mut test: impl FnMut(MaskedOcclusionCulling)) {
    for &implementation in Implementation::available() {
        for rule in RULES {
            for axis in AXES {
                test(object(implementation, rule, axis, size));
            }
        }
    }
}

/// A wall covers every pixel, at its depth or slightly farther.
fn assert_covered(moc: &MaskedOcclusionCulling, w: f32) {
    let wrong = |d: &f32| !(*d <= 1.0 / w && *d >= 0.999 / w);
    if let Some(i) = depth(moc).iter().position(wrong) {
        panic!("{}: pixel {i} is {:e}", name(moc), depth(moc)[i]);
    }
}

#[test]
fn every_width_and_height_is_accepted() {
    let all = Implementation::available();
    let mut objects: Vec<_> = all.iter().map(|&i| object(i, UpdateRule::ThreeLayer, YAxis::Down, (1, 1))).collect();
    for n in 1..=MAX {
        let turn = n as usize % objects.len();
        let moc = &mut objects[turn];
        for (w, h) in [(n, 1 + n % 9), (1 + n % 33, n)] {
            // Every size is set; reading back all of them would take minutes.
            assert_eq!(moc.set_resolution(w, h), Ok(()), "{w}x{h}");
            assert_eq!(moc.resolution(), (w, h));
            if n < 80 || n % 61 == 0 || n > MAX - 9 {
                draw_clip(moc, &wall(2.0));
                assert_covered(moc, 2.0);
            }
        }
    }
}

#[test]
fn other_sizes_are_refused_and_the_buffer_stays() {
    every((70, 30), |mut moc| {
        draw_clip(&mut moc, &wall(2.0));
        for (w, h) in
            [(0, 1), (1, 0), (0, 0), (MAX + 1, 1), (1, MAX + 1), (u32::MAX, 8), (8, u32::MAX), (u32::MAX, u32::MAX)]
        {
            assert_eq!(moc.set_resolution(w, h), Err(Error::InvalidSize), "{} {w}x{h}", name(&moc));
            assert_eq!(moc.resolution(), (70, 30));
        }
        assert_covered(&moc, 2.0);
    });
}

#[test]
fn the_largest_size_works() {
    let mut moc = MaskedOcclusionCulling::new(MAX, MAX, Settings::default()).unwrap();
    // A quad that leaves one corner of the screen free.
    let quad = [[-1.0, -1.0, 0.0, 1.0], [1.0, -1.0, 0.0, 1.0], [-1.0, 1.0, 0.0, 1.0]];
    draw_clip(&mut moc, &quad);
    assert_eq!(moc.test_rect(-1.0, -1.0, -0.1, -0.1, 2.0), Occluded);
    assert_eq!(moc.test_rect(0.1, 0.1, 1.0, 1.0, 2.0), Visible);
    // One pixel on each side of the diagonal.
    let pixel = 2.0 / MAX as f32;
    assert_eq!(moc.test_rect(-3.0 * pixel, -3.0 * pixel, -2.0 * pixel, -2.0 * pixel, 2.0), Occluded);
    assert_eq!(moc.test_rect(2.0 * pixel, 2.0 * pixel, 3.0 * pixel, 3.0 * pixel, 2.0), Visible);
}

#[test]
fn partial_tiles_at_the_border_are_filled() {
    for w in (1..=70).step_by(3) {
        for h in [1, 2, 3, 4, 5, 7, 8, 9, 12, 15, 16, 17] {
            for &implementation in Implementation::available() {
                let rule = RULES[(w + h) % RULES.len()];
                let mut moc = object(implementation, rule, AXES[w % 2], (w, h));
                draw_clip(&mut moc, &wall(4.0));
                assert_covered(&moc, 4.0);
                // Up to the edge and beyond it.
                assert_eq!(moc.test_rect(-1.0, -1.0, 1.0, 1.0, 8.0), Occluded, "{}", name(&moc));
                assert_eq!(moc.test_rect(-2.0, -2.0, 2.0, 2.0, 8.0), Occluded, "{}", name(&moc));
            }
        }
    }
}

#[test]
fn setting_the_resolution_clears() {
    every((70, 30), |mut moc| {
        for size in [(70, 30), (70, 30), (71, 29), (640, 360)] {
            draw_clip(&mut moc, &wall(2.0));
            moc.set_resolution(size.0, size.1).unwrap();
            assert!(depth(&moc).iter().all(|d| *d < 0.0), "{}", name(&moc));
        }
        draw_clip(&mut moc, &wall(2.0));
        moc.clear_buffer();
        assert!(depth(&moc).iter().all(|d| *d < 0.0), "{}", name(&moc));
    });
}

/// A triangle in the upper half of the screen, left of the middle.
const UPPER_LEFT: [[f32; 4]; 3] = [[-0.9, 0.1, 0.0, 1.0], [-0.1, 0.2, 0.0, 1.0], [-0.5, 0.9, 0.0, 1.0]];

#[test]
fn rows_are_counted_as_the_axis_says_and_flip_reverses_them() {
    let (w, h) = (70, 30);
    every((w, h), |mut moc| {
        draw_clip(&mut moc, &UPPER_LEFT);
        let straight = depth(&moc);
        let mut flipped = vec![f32::NAN; w * h];
        moc.compute_pixel_depth_buffer(&mut flipped, true).unwrap();
        for row in 0..h {
            assert_eq!(straight[row * w..][..w], flipped[(h - 1 - row) * w..][..w], "{}", name(&moc));
        }
        let half = h / 2 * w;
        let (first, second) = (&straight[..half], &straight[half..]);
        let (upper, lower) = if moc.y_axis() == YAxis::Down { (first, second) } else { (second, first) };
        assert!(upper.iter().any(|d| *d > 0.0), "{}", name(&moc));
        assert!(lower.iter().all(|d| *d < 0.0), "{}", name(&moc));
        assert!(straight.chunks(w).all(|row| row[w / 2..].iter().all(|d| *d < 0.0)), "{}", name(&moc));
    });
}

#[test]
fn reading_back_writes_the_pixels_and_no_more() {
    every((33, 9), |moc| {
        let mut long = vec![7.5; 33 * 9 + 5];
        moc.compute_pixel_depth_buffer(&mut long, false).unwrap();
        assert!(long[..33 * 9].iter().all(|d| *d < 0.0), "{}", name(&moc));
        assert!(long[33 * 9..].iter().all(|d| *d == 7.5), "{}", name(&moc));
        let mut short = vec![7.5; 33 * 9 - 1];
        assert_eq!(moc.compute_pixel_depth_buffer(&mut short, false), Err(Error::InvalidSize));
        assert!(short.iter().all(|d| *d == 7.5), "{}", name(&moc));
    });
}

#[test]
fn scissor_rectangles_are_honoured_exactly() {
    let (w, h) = (200, 45);
    let rectangles = [
        [0, 0, 200, 45],
        [0, 0, 32, 8],
        [32, 8, 64, 16],
        [64, 0, 200, 8],
        [160, 40, 192, 45],
        [192, 40, 200, 45],
        [192, 0, 200, 45],
        [0, 40, 200, 45],
        [96, 16, 160, 40],
        [0, 8, 192, 16],
        // To the end of the last tiles, though the screen ends before that.
        [192, 40, 224, 48],
        // Empty.
        [64, 8, 64, 16],
    ];
    every((w, h), |mut moc| {
        let mesh = wall(2.0);
        let mut storage = [0.0; 9 * 8];
        let mut lists = [TriList::new(&mut storage)];
        moc.bin_triangles(Vertices::clip_space(&mesh), &[0, 1, 2], &mut lists, 1, 1, &both_sides()).unwrap();
        assert!(!lists[0].is_empty(), "{}", name(&moc));
        for [x0, y0, x1, y1] in rectangles {
            moc.clear_buffer();
            let scissor = ScissorRect { min_x: x0, min_y: y0, max_x: x1, max_y: y1 };
            moc.render_trilist(&lists[0], Some(scissor)).unwrap();
            for (i, d) in depth(&moc).iter().enumerate() {
                let (x, y) = ((i % w) as i32, (i / w) as i32);
                let inside = (x0..x1).contains(&x) && (y0..y1).contains(&y);
                assert_eq!(*d > 0.0, inside, "{}: ({x}, {y}) of {scissor:?}", name(&moc));
            }
        }
    });
}

#[test]
fn other_scissor_rectangles_are_refused() {
    every((200, 45), |mut moc| {
        let mesh = wall(2.0);
        let mut storage = [0.0; 9 * 8];
        let mut lists = [TriList::new(&mut storage)];
        moc.bin_triangles(Vertices::clip_space(&mesh), &[0, 1, 2], &mut lists, 1, 1, &both_sides()).unwrap();
        for [x0, y0, x1, y1] in [
            [1, 0, 32, 8],
            [0, 4, 32, 8],
            [0, 0, 33, 8],
            [0, 0, 32, 9],
            [-32, 0, 32, 8],
            [0, -8, 32, 8],
            [0, 0, 256, 8],
            [0, 0, 32, 56],
            [32, 0, 0, 8],
            [0, 8, 32, 0],
            [0, 0, i32::MAX, 8],
            [i32::MIN, 0, 32, 8],
            [i32::MIN, i32::MIN, i32::MAX, i32::MAX],
        ] {
            let scissor = ScissorRect { min_x: x0, min_y: y0, max_x: x1, max_y: y1 };
            let result = moc.render_trilist(&lists[0], Some(scissor));
            assert_eq!(result, Err(Error::InvalidSize), "{} {scissor:?}", name(&moc));
        }
        assert!(depth(&moc).iter().all(|d| *d < 0.0), "{}", name(&moc));
    });
}

#[test]
fn bins_are_whole_tiles() {
    for ((w, h), (bins_w, bins_h), size) in [
        ((1920, 1080), (4, 4), (480, 264)),
        ((1920, 1080), (1, 1), (1920, 1080 / 8 * 8)),
        ((1000, 500), (3, 2), (320, 248)),
        ((64, 16), (2, 2), (32, 8)),
        ((16384, 16), (512, 2), (32, 8)),
        ((95, 23), (2, 2), (32, 8)),
    ] {
        let moc = MaskedOcclusionCulling::new(w, h, Settings::default()).unwrap();
        assert_eq!(moc.compute_bin_size(bins_w, bins_h), Ok(size), "{w}x{h} {bins_w}x{bins_h}");
    }
}
