//! Named tests of known failure modes of occlusion cullers of this kind, one line each, in the order of queries,
//! rendering, merging and bins. All of them run on every instruction set and with every update rule.

mod oracle;
mod support;

use masked_occlusion_culling::{
    CullingResult::{Occluded, ViewCulled, Visible},
    Error, Implementation, MaskedOcclusionCulling, TriList, UpdateRule, Vertices, YAxis,
};
use oracle::homogeneous::{Homogeneous, Place};
use support::{RULES, bits, both_sides, depth, draw_clip, name, object, test_clip, wall};

/// Every instruction set and rule.
fn every(size: (usize, usize), mut test: impl FnMut(MaskedOcclusionCulling)) {
    for &implementation in Implementation::available() {
        for rule in RULES {
            test(object(implementation, rule, YAxis::Down, size));
        }
    }
}

#[test]
fn d01_rect_off_screen_is_view_culled() {
    every((320, 180), |moc| {
        for [x0, y0, x1, y1] in [
            [1.5, -0.5, 2.0, 0.5],
            [-2.0, -0.5, -1.5, 0.5],
            [-0.5, 1.5, 0.5, 2.0],
            [-0.5, -2.0, 0.5, -1.5],
            [1e30, 1e30, 2e30, 2e30],
            [-3e38, -3e38, -2e38, -2e38],
        ] {
            assert_eq!(moc.test_rect(x0, y0, x1, y1, 1.0), ViewCulled, "{} {x0} {y0} {x1} {y1}", name(&moc));
        }
        assert_eq!(moc.test_rect(0.9, -0.5, 1.5, 0.5, 1.0), Visible, "{}", name(&moc));
    });
}

#[test]
fn d02_rect_with_a_huge_or_infinite_edge_is_visible() {
    every((1920, 1080), |moc| {
        for edge in [2.3e6, 1e10, f32::MAX, f32::INFINITY] {
            assert_eq!(moc.test_rect(0.0, -1.0, edge, 1.0, 1.0), Visible, "{} {edge}", name(&moc));
            assert_eq!(moc.test_rect(-edge, -1.0, 0.0, 1.0, 1.0), Visible, "{} {edge}", name(&moc));
            assert_eq!(moc.test_rect(-edge, -edge, edge, edge, 1.0), Visible, "{} {edge}", name(&moc));
            assert_eq!(moc.test_rect(-1.0, 0.0, 1.0, edge, 1.0), Visible, "{} {edge}", name(&moc));
        }
    });
}

#[test]
fn d02_a_huge_rect_behind_a_wall_is_still_occluded() {
    every((200, 100), |mut moc| {
        draw_clip(&mut moc, &wall(2.0));
        let m = f32::MAX;
        assert_eq!(moc.test_rect(-m, -m, m, m, 4.0), Occluded, "{}", name(&moc));
        let inf = f32::INFINITY;
        assert_eq!(moc.test_rect(-inf, -inf, inf, inf, 4.0), Occluded, "{}", name(&moc));
    });
}

#[test]
fn d03_rect_at_or_behind_the_eye_or_nan_is_visible() {
    every((320, 180), |mut moc| {
        for drawn in [false, true] {
            if drawn {
                draw_clip(&mut moc, &wall(1e-3));
            }
            for w in [0.0, -0.0, -1.0, f32::NEG_INFINITY, f32::NAN, -f32::MIN_POSITIVE] {
                assert_eq!(moc.test_rect(-0.5, -0.5, 0.5, 0.5, w), Visible, "{} w {w}", name(&moc));
            }
            for k in 0..4 {
                let mut edges = [-0.5, -0.5, 0.5, 0.5];
                edges[k] = f32::NAN;
                let [x0, y0, x1, y1] = edges;
                assert_eq!(moc.test_rect(x0, y0, x1, y1, 1.0), Visible, "{} {edges:?}", name(&moc));
            }
        }
    });
}

/// x and y in pixels from the lower left of a 256x128 screen.
fn at(x: f32, y: f32, w: f32) -> [f32; 4] {
    [(x / 128.0 - 1.0) * w, (y / 64.0 - 1.0) * w, 0.0, w]
}

#[test]
fn d04_triangles_between_pixel_centres_are_visible() {
    // A triangle inside one pixel that misses its centre, and a pole 0.3 pixels wide between two columns of centres.
    let small = [at(100.6, 50.6, 2.0), at(100.9, 50.6, 2.0), at(100.6, 50.9, 2.0)];
    let pole = [at(30.6, 10.0, 2.0), at(30.9, 10.0, 2.0), at(30.6, 90.0, 2.0)];
    let flat = [at(20.0, 30.6, 2.0), at(220.0, 30.6, 2.0), at(20.0, 30.9, 2.0)];
    every((256, 128), |mut moc| {
        for t in [small, pole, flat] {
            assert_eq!(test_clip(&moc, &t), Visible, "{} {t:?}", name(&moc));
        }
        // It is hidden once it is behind the wall, and visible again in front of it.
        draw_clip(&mut moc, &wall(1.0));
        for t in [small, pole, flat] {
            assert_ne!(test_clip(&moc, &t), Visible, "{} {t:?}", name(&moc));
            let front = t.map(|v| v.map(|c| c / 4.0));
            assert_eq!(test_clip(&moc, &front), Visible, "{} {t:?}", name(&moc));
        }
    });
}

#[test]
fn d04_a_triangle_that_pokes_over_a_wall_s_edge_is_visible() {
    // The wall covers the centres of columns 0 to 63 and ends at 63.6. An occludee from 63.2 into column 64, where
    // nothing was drawn, is visible there, whether or not it covers a centre.
    every((256, 128), |mut moc| {
        draw_clip(&mut moc, &[at(63.6, -400.0, 1.0), at(63.6, 528.0, 1.0), at(-900.0, 64.0, 1.0)]);
        let poke = [at(63.2, 63.7, 2.0), at(64.3, 64.0, 2.0), at(63.2, 64.3, 2.0)];
        assert_eq!(test_clip(&moc, &poke), Visible, "{}", name(&moc));
    });
}

#[test]
fn d05_nan_and_infinite_vertices_are_dropped_and_counted() {
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
        every((320, 180), |mut moc| {
            let mut drawn = 0;
            for corner in 0..3 {
                for coordinate in [0, 1, 3] {
                    let mut t = wall(1.0);
                    t[corner][coordinate] = bad;
                    draw_clip(&mut moc, &t);
                    drawn += 1;
                }
            }
            let who = name(&moc);
            assert!(depth(&moc).iter().all(|d| *d < 0.0), "{who} {bad}: something was drawn");
            assert_eq!(moc.test_rect(-1.0, -1.0, 1.0, 1.0, 100.0), Visible, "{who} {bad}");
            assert_eq!(moc.statistics().occluders.num_dropped_triangles, drawn, "{who} {bad}");
            // The valid triangles of the same call are drawn.
            let mut mesh = [wall(1.0); 2].concat();
            mesh[0][0] = bad;
            draw_clip(&mut moc, &mesh);
            assert!(depth(&moc).iter().all(|d| *d > 0.0), "{who} {bad}: the good triangle is missing");
            assert_eq!(moc.test_rect(-1.0, -1.0, 1.0, 1.0, 100.0), Occluded, "{who} {bad}");
            // As an occludee it may be anywhere.
            assert_eq!(test_clip(&moc, &mesh[..3]), Visible, "{who} {bad}");
        });
    }
}

#[test]
fn d06_flat_edges_cover_no_false_pixel_in_large_buffers() {
    let size = (3840, 2160);
    let t = [[-0.916_220_55, 0.454_960_02], [0.813_307_3, 0.454_956_38], [-0.809_384_4, 0.609_509_1]];
    let clip = t.map(|[x, y]: [f32; 2]| [x, y, 0.0, 1.0]);
    let wide = t.map(|[x, y]| [f64::from(x), f64::from(y), 1.0]);
    let exact = Homogeneous::new(&wide, 0.0, size, false).unwrap();
    for &implementation in Implementation::available() {
        let mut moc = object(implementation, UpdateRule::ThreeLayer, YAxis::Down, size);
        draw_clip(&mut moc, &clip);
        for (i, d) in depth(&moc).iter().enumerate() {
            let (column, row) = (i % size.0, i / size.0);
            match exact.place(column, row, 1.0 / 64.0) {
                Place::Inside => assert!(*d >= 0.0, "{}: ({column}, {row}) is missed", name(&moc)),
                Place::Outside => assert!(*d < 0.0, "{}: ({column}, {row}) is false", name(&moc)),
                Place::Border => {}
            }
        }
    }
}

/// A separate generator, so that the cases stay the same whatever else changes.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let a = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let b = (a ^ (a >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        b ^ (b >> 31)
    }

    fn within(&mut self, low: i64, high: i64) -> i64 {
        low + (self.next() % (high - low + 1) as u64) as i64
    }
}

#[test]
fn d07_triangles_that_leave_the_screen_keep_their_edges() {
    let size = (1024, 1024);
    let end = 1024 * 256;
    let exact = oracle::Oracle::new(size.0, size.1);
    let mut numbers = Numbers(7);
    let mut objects: Vec<_> =
        Implementation::available().iter().map(|&i| object(i, UpdateRule::ThreeLayer, YAxis::Down, size)).collect();
    let mut depth = Vec::new();
    for case in 0..75 * objects.len() {
        let t = [(); 3].map(|()| {
            let (x, y) = (numbers.within(-end, 2 * end), numbers.within(-end, 2 * end));
            oracle::Vertex { x, y, z: 0.5f64.powi(numbers.within(0, 6) as i32) }
        });
        // One instruction set per case: other tests compare them with each other.
        let which = case % objects.len();
        let moc = &mut objects[which];
        moc.clear_buffer();
        support::draw(moc, &[t]);
        support::read(moc, &mut depth);
        if let Err(why) = support::compare_one(&t, &depth, &exact) {
            panic!("{}: {why}\n{:?}", name(moc), support::mesh(&[t], size, YAxis::Down).0);
        }
    }
}

#[test]
fn d08_extreme_magnitudes_neither_crash_nor_come_too_near() {
    let mut numbers = Numbers(8);
    every((160, 90), |mut moc| {
        assert_eq!(moc.set_near_clip_plane(0.0), Ok(()));
        for magnitude in [1, 5, 10, 20, 30, 37, 45] {
            for _ in 0..40 {
                let t = [(); 3].map(|()| {
                    let mut number = || {
                        let m = numbers.within(-1000, 1000) as f32 / 1000.0;
                        m * 10f32.powi(numbers.within(-magnitude, magnitude.min(38)) as i32)
                    };
                    [number(), number(), number(), number()]
                });
                moc.clear_buffer();
                draw_clip(&mut moc, &t);
                test_clip(&moc, &t);
                // No point of a triangle in view is nearer than its nearest corner, if all corners are in front.
                let nearest = t.iter().fold(f32::MAX, |n, v| n.min(v[3]));
                let most = if nearest > 0.0 { 1.0 / nearest } else { f32::INFINITY };
                let who = name(&moc);
                assert!(depth(&moc).iter().all(|d| *d < 0.0 || *d <= most), "{who} {t:?}");
            }
        }
    });
}

#[test]
fn d09_merging_is_never_nearer_than_the_truth() {
    let size = (64, 32);
    let mut numbers = Numbers(9);
    every(size, |mut moc| {
        for _ in 0..150 {
            let mut exact = oracle::Oracle::new(size.0, size.1);
            let mut other = object(moc.implementation(), moc.update_rule(), YAxis::Down, size);
            moc.clear_buffer();
            for target in [&mut moc, &mut other] {
                for _ in 0..6 {
                    let t = [(); 3].map(|()| {
                        let (x, y) = (numbers.within(-4096, 20480), numbers.within(-4096, 12288));
                        oracle::Vertex { x, y, z: 0.5f64.powi(numbers.within(0, 6) as i32) }
                    });
                    support::draw(target, &[t]);
                    exact.draw(&t);
                }
            }
            let before = bits(&other);
            moc.merge_buffer(&other).unwrap();
            assert_eq!(support::conservative(&depth(&moc), &exact), Ok(()), "{}", name(&moc));
            assert_eq!(bits(&other), before, "{}: the other buffer changed", name(&moc));
        }
    });
}

#[test]
fn d09_merging_hides_what_either_hid() {
    // Each half of the screen is hidden by a wall in one of the two buffers.
    let half = |sign: f32| [[0.0, -4.0, 0.0, 1.0], [0.0, 4.0, 0.0, 1.0], [8.0 * sign, 0.0, 0.0, 1.0]];
    every((256, 128), |mut moc| {
        let mut other = object(moc.implementation(), moc.update_rule(), YAxis::Down, (256, 128));
        draw_clip(&mut moc, &half(-1.0));
        draw_clip(&mut other, &half(1.0));
        assert_eq!(moc.test_rect(-0.9, -0.9, 0.9, 0.9, 2.0), Visible, "{}", name(&moc));
        moc.merge_buffer(&other).unwrap();
        assert_eq!(moc.test_rect(-0.9, -0.9, 0.9, 0.9, 2.0), Occluded, "{}", name(&moc));
    });
}

#[test]
fn d10_buffers_of_other_sizes_are_refused_and_nothing_changes() {
    every((64, 64), |mut moc| {
        draw_clip(&mut moc, &wall(4.0));
        let before = bits(&moc);
        for size in [(64, 32), (32, 64), (65, 64), (16384, 4)] {
            let mut other = object(moc.implementation(), moc.update_rule(), YAxis::Down, size);
            draw_clip(&mut other, &wall(1.0));
            assert_eq!(moc.merge_buffer(&other), Err(Error::SizeMismatch), "{} {size:?}", name(&moc));
        }
        let other = object(moc.implementation(), moc.update_rule(), YAxis::Up, (64, 64));
        assert_eq!(moc.merge_buffer(&other), Err(Error::SizeMismatch), "{}", name(&moc));
        assert_eq!(bits(&moc), before, "{}", name(&moc));
    });
}

#[test]
fn d10_buffers_of_other_instruction_sets_and_rules_merge() {
    every((100, 50), |mut moc| {
        for &implementation in Implementation::available() {
            for rule in RULES {
                let mut other = object(implementation, rule, YAxis::Down, (100, 50));
                draw_clip(&mut other, &wall(1.0));
                moc.clear_buffer();
                moc.merge_buffer(&other).unwrap();
                assert_eq!(moc.test_rect(-1.0, -1.0, 1.0, 1.0, 2.0), Occluded, "{} from {}", name(&moc), name(&other));
            }
        }
    });
}

#[test]
fn d11_full_lists_take_no_more_and_say_so() {
    const GUARD: f32 = 123.5;
    every((256, 128), |moc| {
        let mut storage = [GUARD; 9 * 5 + 4];
        let mesh = [wall(1.0); 8].concat();
        let indices: Vec<u32> = (0..24).collect();
        let mut lists = [TriList::new(&mut storage[..9 * 5])];
        let vertices = Vertices::clip_space(&mesh);
        let result = moc.bin_triangles(vertices, &indices, &mut lists, 1, 1, &both_sides());
        assert_eq!(result, Err(Error::ListFull), "{}", name(&moc));
        assert_eq!((lists[0].len(), lists[0].capacity()), (5, 5), "{}", name(&moc));
        assert!(storage[45..].iter().all(|f| *f == GUARD), "{}: written past the list", name(&moc));

        let mut none = [TriList::new(&mut [])];
        assert_eq!(moc.bin_triangles(vertices, &indices, &mut none, 1, 1, &both_sides()), Err(Error::ListFull));
    });
}

#[test]
fn d11_bad_bin_counts_are_errors() {
    every((256, 128), |moc| {
        let mesh = wall(1.0);
        let vertices = Vertices::clip_space(&mesh);
        // None, narrower than a tile, lower than a tile, and not matching the number of lists.
        for (w, h) in [(0, 1), (1, 0), (0, 0), (9, 1), (1, 17), (u32::MAX, 1), (u32::MAX, u32::MAX), (65536, 65537)] {
            let mut storage = [0.0; 9];
            let mut lists = [TriList::new(&mut storage)];
            let binned = moc.bin_triangles(vertices, &[0, 1, 2], &mut lists, w, h, &both_sides());
            assert_eq!(binned, Err(Error::InvalidSize), "{} {w} {h}", name(&moc));
            assert!(lists[0].is_empty());
            assert_eq!(moc.compute_bin_size(w, h), Err(Error::InvalidSize), "{} {w} {h}", name(&moc));
        }
        let mut storage = [0.0; 9];
        let mut lists = [TriList::new(&mut storage)];
        assert_eq!(moc.bin_triangles(vertices, &[0, 1, 2], &mut lists, 2, 1, &both_sides()), Err(Error::InvalidSize));
    });
}
