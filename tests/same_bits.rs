//! Buffer, answers and statistics have the same bits on every instruction set and on every architecture: the hashes of
//! generated scenes are equal to each other and to those in this file. For a change that is meant to change the bits,
//! print the new hashes with PRINT_HASHES=1 cargo test --test same_bits -- --nocapture.

mod scenes;

use masked_occlusion_culling::{
    BackfaceWinding, ClipSpaceLayout, DrawOptions, Implementation, MaskedOcclusionCulling, ModelSpaceLayout, Settings,
    Statistics, UpdateRule, Vertices, YAxis,
};
use scenes::Scene;

/// FNV-1a.
struct Hash(u64);

impl Hash {
    fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    fn add(&mut self, value: u64) {
        for byte in value.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    }
}

fn add_statistics(hash: &mut Hash, s: &Statistics) {
    let (o, q) = (&s.occluders, &s.occludees);
    let counts = [
        o.num_processed_triangles,
        o.num_rasterized_triangles,
        o.num_tiles_traversed,
        o.num_tiles_updated,
        o.num_tiles_merged,
        o.num_dropped_triangles,
        q.num_processed_rectangles,
        q.num_processed_triangles,
        q.num_rasterized_triangles,
        q.num_tiles_traversed,
    ];
    counts.iter().for_each(|n| hash.add(*n as u64));
}

/// Hashes of the buffer, of the answers and of the statistics.
fn hashes(scene: &Scene, implementation: Implementation, rule: UpdateRule) -> [u64; 3] {
    let (w, h) = (333, 205);
    let mut all = [Hash::new(), Hash::new(), Hash::new()];
    let [buffer, answers, statistics] = &mut all;
    let space = match scene.matrix {
        Some(matrix) => ModelSpaceLayout::XYZ_PADDED.with_matrix(matrix),
        None => ClipSpaceLayout::XYZW.into(),
    };
    let vertices = Vertices::new(scene.vertices.as_flattened(), space).unwrap();
    let mut depth = vec![0.0; w * h];
    for y_axis in [YAxis::Down, YAxis::Up] {
        for winding in [BackfaceWinding::Clockwise, BackfaceWinding::None] {
            let settings = Settings::default()
                .with_implementation(implementation)
                .with_update_rule(rule)
                .with_y_axis(y_axis)
                .with_statistics(true);
            let mut moc = MaskedOcclusionCulling::new(w as u32, h as u32, settings).unwrap();
            moc.set_near_clip_plane(scene.near).unwrap();
            let options = DrawOptions::default().with_winding(winding);
            for object in &scene.objects {
                let [x0, y0, x1, y1, nearest] = scene.rectangle(object);
                answers.add(moc.test_rect(x0, y0, x1, y1, nearest) as u64);
                answers.add(moc.test_triangles(vertices, object, &options).unwrap() as u64);
                answers.add(moc.render_triangles(vertices, object, &options).unwrap() as u64);
            }
            moc.compute_pixel_depth_buffer(&mut depth, false).unwrap();
            depth.iter().for_each(|d| buffer.add(u64::from(d.to_bits())));
            add_statistics(statistics, &moc.statistics());
        }
    }
    all.map(|h| h.0)
}

const RULES: [UpdateRule; 4] = [UpdateRule::ThreeLayer, UpdateRule::Quick, UpdateRule::Accurate, UpdateRule::FourLayer];

/// By scene, then rule: buffer, answers, statistics.
const GOLDEN: [[[u64; 3]; 4]; 5] = [
    [
        // town
        [0x5bda_5977_c36c_2185, 0xd781_be50_2473_e685, 0xd02e_68bb_e5d6_eb96],
        [0x51d9_9be4_2588_d24d, 0xd210_28c4_2893_4425, 0x11ad_2b3d_34b1_d303],
        [0xfe9a_1eba_91cd_9076, 0xe123_71fc_949c_ce85, 0x002c_b49c_5ca8_0719],
        [0x0173_c368_f21e_3791, 0xd859_dfe8_0688_2425, 0x79a7_7e31_f1cf_7f57],
    ],
    [
        // terrain
        [0xe9d0_9aae_9cd3_3332, 0x0da0_3ec1_9baf_17e5, 0x25e4_6355_ad4e_b987],
        [0xb796_a9ba_bb13_2860, 0x93c1_4b5a_0ae4_57e4, 0x2e3a_d36b_3c45_e41c],
        [0xb19c_d6e8_bb1d_147a, 0xc941_995d_11ff_0d45, 0x63ba_1eab_a86e_d509],
        [0x4ec8_cada_ad4a_82ea, 0x0da0_3ec1_9baf_17e5, 0x25e4_6355_ad4e_b987],
    ],
    [
        // blocks
        [0x88cd_5a4d_f95e_81cc, 0x9661_0878_3e74_21a5, 0x6268_0bea_da6c_869c],
        [0x2e68_32af_21ad_e59d, 0x1602_cffc_ed45_d625, 0xff28_0e55_6827_a7b1],
        [0xa6a1_9a1f_34e0_d751, 0x9661_0878_3e74_21a5, 0xfb01_4595_e618_72aa],
        [0x8c7e_9225_7ccd_8873, 0x9661_0878_3e74_21a5, 0x993c_0c65_d635_4fe3],
    ],
    [
        // soup
        [0xf971_8b67_d2bf_0f95, 0x1cdc_1e65_b531_1c64, 0x7081_bb85_d165_7840],
        [0xe6f5_41d6_ba60_768e, 0x1cdc_1e65_b531_1c64, 0x9e8d_ffdf_05ce_2595],
        [0x31fc_1315_63e6_3100, 0x4b17_30e4_8282_8d25, 0xa6f3_f544_4054_1b70],
        [0x1cc8_c312_b2e1_b8f9, 0x1cdc_1e65_b531_1c64, 0x7081_bb85_d165_7840],
    ],
    [
        // hostile
        [0xce73_88bc_37ab_602a, 0xc20b_9664_5385_8d25, 0xc740_f43c_9ff9_f215],
        [0xbf18_33ee_ecbd_2399, 0xc20b_9664_5385_8d25, 0x1463_b9dd_52eb_03ed],
        [0x186c_d51f_5da1_8dd3, 0xc20b_9664_5385_8d25, 0x7677_e6b5_3fc2_2f84],
        [0xe0b3_5848_68bb_4b62, 0xc20b_9664_5385_8d25, 0xc740_f43c_9ff9_f215],
    ],
];

#[test]
fn every_instruction_set_gives_the_golden_bits() {
    let print = std::env::var_os("PRINT_HASHES").is_some();
    println!("on {:?}", Implementation::available());
    let mut wrong = Vec::new();
    for (scene, golden) in scenes::all().iter().zip(&GOLDEN) {
        for (rule, golden) in RULES.into_iter().zip(golden) {
            for (i, &implementation) in Implementation::available().iter().enumerate() {
                let got = hashes(scene, implementation, rule);
                if print && i == 0 {
                    let row = got.map(|h| {
                        let part = |shift: u32| (h >> shift) & 0xffff;
                        format!("{:#06x}_{:04x}_{:04x}_{:04x}", part(48), part(32), part(16), part(0))
                    });
                    println!("        [{}], // {} {rule:?}", row.join(", "), scene.name);
                }
                for (part, what) in ["buffer", "answers", "statistics"].into_iter().enumerate() {
                    if got[part] != golden[part] {
                        wrong.push(format!("{} {rule:?} {implementation:?}: {what} {:#018x}", scene.name, got[part]));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "other hashes than those in this file:\n{}", wrong.join("\n"));
}

/// If the hashes differ, shows where, pixel by pixel: the first object that is drawn differently on two instruction
/// sets.
#[test]
fn every_instruction_set_agrees_after_every_object() {
    let (w, h) = (160, 90);
    for scene in scenes::all() {
        for rule in RULES {
            let space = match scene.matrix {
                Some(matrix) => ModelSpaceLayout::XYZ_PADDED.with_matrix(matrix),
                None => ClipSpaceLayout::XYZW.into(),
            };
            let vertices = Vertices::new(scene.vertices.as_flattened(), space).unwrap();
            let options = DrawOptions::default();
            let mut objects: Vec<_> = Implementation::available()
                .iter()
                .map(|&implementation| {
                    let settings = Settings::default()
                        .with_implementation(implementation)
                        .with_update_rule(rule)
                        .with_statistics(true);
                    let mut moc = MaskedOcclusionCulling::new(w, h, settings).unwrap();
                    moc.set_near_clip_plane(scene.near).unwrap();
                    moc
                })
                .collect();
            let mut buffers = vec![vec![0.0f32; (w * h) as usize]; objects.len()];
            for (i, object) in scene.objects.iter().enumerate() {
                let [x0, y0, x1, y1, nearest] = scene.rectangle(object);
                let answers = objects.iter().map(|moc| {
                    let rectangle = moc.test_rect(x0, y0, x1, y1, nearest);
                    (rectangle, moc.test_triangles(vertices, object, &options).unwrap())
                });
                let answers: Vec<_> = answers.collect();
                assert!(answers.iter().all(|a| *a == answers[0]), "{} {rule:?}, object {i}: {answers:?}", scene.name);
                for (moc, depth) in objects.iter_mut().zip(&mut buffers) {
                    moc.render_triangles(vertices, object, &options).unwrap();
                    moc.compute_pixel_depth_buffer(depth, false).unwrap();
                }
                for (moc, depth) in objects.iter().zip(&buffers).skip(1) {
                    let differs = |(a, b): (&f32, &f32)| a.to_bits() != b.to_bits();
                    if let Some(p) = depth.iter().zip(&buffers[0]).position(differs) {
                        panic!(
                            "{} {rule:?}, object {i}: ({}, {}) is {:e} with {:?}, {:e} with {:?}",
                            scene.name,
                            p % w as usize,
                            p / w as usize,
                            depth[p],
                            moc.implementation(),
                            buffers[0][p],
                            objects[0].implementation()
                        );
                    }
                    let who = moc.implementation();
                    assert_eq!(
                        moc.statistics(),
                        objects[0].statistics(),
                        "{} {rule:?} {who:?}, object {i}",
                        scene.name
                    );
                }
            }
        }
    }
}

/// Triangles as wide as large screens, many per call: more tiles than the kernel's lists hold at a time.
#[test]
fn every_instruction_set_agrees_on_wide_triangles() {
    for (w, h) in [(1920, 1080), (5000, 300), (300, 5000), (2560, 1440)] {
        let mut bits = 0x2545_f491_4f6c_dd1d_u64;
        let mut random = || {
            bits ^= bits << 13;
            bits ^= bits >> 7;
            bits ^= bits << 17;
            (bits >> 40) as f32 / (1 << 24) as f32
        };
        // A wall of two triangles, then others in front of and behind it, from corner to corner.
        let mut vertices = vec![];
        for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
            vertices.push([x * 10.0, y * 10.0, 0.0, 10.0]);
        }
        for _ in 0..3 * 60 {
            let z = 2.0 + 18.0 * random();
            vertices.push([(2.2 * random() - 1.1) * z, (2.2 * random() - 1.1) * z, 0.0, z]);
        }
        let indices: Vec<u32> = (0..vertices.len() as u32).collect();
        let options = DrawOptions::default().with_winding(BackfaceWinding::None);
        for rule in RULES {
            let mut first: Option<Vec<u32>> = None;
            for &implementation in Implementation::available() {
                let settings = Settings::default().with_implementation(implementation).with_update_rule(rule);
                let mut moc = MaskedOcclusionCulling::new(w, h, settings).unwrap();
                moc.render_triangles(Vertices::clip_space(&vertices), &indices, &options).unwrap();
                let mut depth = vec![0.0; (w * h) as usize];
                moc.compute_pixel_depth_buffer(&mut depth, false).unwrap();
                let who = format!("{implementation:?} {rule:?} {w}x{h}");
                let hole = depth.iter().position(|d| *d < 0.0999);
                assert_eq!(hole, None, "{who}");
                let depth: Vec<u32> = depth.iter().map(|d| d.to_bits()).collect();
                match &first {
                    None => first = Some(depth),
                    Some(first) => assert!(*first == depth, "{who}"),
                }
            }
        }
    }
}
