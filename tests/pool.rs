//! The thread pool: the same bits as one thread whatever the threads do, and no order of calls that hangs, loses
//! anything, or lets cleared contents hide anything.
#![cfg(feature = "pool")]

mod scenes;

use std::sync::atomic::{AtomicBool, Ordering};

use glam::{Mat4, Vec3};
use masked_occlusion_culling::{
    BackfaceWinding, ClipSpaceLayout, CullingResult, CullingThreadpool, DrawOptions, Error, MaskedOcclusionCulling,
    ModelSpaceLayout, Settings, ThreadpoolSettings, UpdateRule, Vertices,
};
use scenes::{Numbers, Scene};

fn object(width: u32, height: u32, near: f32, settings: Settings) -> MaskedOcclusionCulling {
    let mut moc = MaskedOcclusionCulling::new(width, height, settings).unwrap();
    moc.set_near_clip_plane(near).unwrap();
    moc
}

fn pixels(moc: &MaskedOcclusionCulling) -> Vec<f32> {
    let (width, height) = moc.resolution();
    let mut depth = vec![0.0; width as usize * height as usize];
    moc.compute_pixel_depth_buffer(&mut depth, false).unwrap();
    depth
}

fn vertices(scene: &Scene) -> Vertices<'_> {
    let space = match scene.matrix {
        Some(matrix) => ModelSpaceLayout::XYZ_PADDED.with_matrix(matrix),
        None => ClipSpaceLayout::XYZW.into(),
    };
    Vertices::new(scene.vertices.as_flattened(), space).unwrap()
}

#[test]
fn scenes_have_the_bits_and_counts_of_one_thread() {
    for scene in scenes::all() {
        for (threads, bins_w, bins_h, max_jobs) in
            [(0, 1, 1, 1), (1, 4, 4, 32), (2, 3, 2, 2), (3, 1, 64, 5), (8, 7, 7, 1), (2, u32::MAX, u32::MAX, 32)]
        {
            let processors = if max_jobs == 5 { 2 } else { threads + 1 };
            let pool = CullingThreadpool::new(
                ThreadpoolSettings::default()
                    .with_threads(threads)
                    .with_bins(bins_w, bins_h)
                    .with_max_jobs(max_jobs)
                    .with_processors(processors),
            )
            .unwrap();
            pool.wake_threads();
            for (width, height) in [(333, 205), (1, 1), (1030, 517)] {
                for statistics in [false, true] {
                    let update_rule = match width {
                        1 => UpdateRule::Quick,
                        333 => UpdateRule::ThreeLayer,
                        _ => UpdateRule::FourLayer,
                    };
                    let settings = Settings::default().with_statistics(statistics).with_update_rule(update_rule);
                    let mut direct = object(width, height, scene.near, settings);
                    pool.set_buffer(object(width, height, scene.near, settings));
                    pool.scope(|scope| {
                        for (k, triangles) in scene.objects.iter().enumerate() {
                            let winding = [BackfaceWinding::Clockwise, BackfaceWinding::None][k % 2];
                            let options = DrawOptions::default().with_winding(winding);
                            scope.render_triangles(vertices(&scene), triangles, &options).unwrap();
                            direct.render_triangles(vertices(&scene), triangles, &options).unwrap();
                        }
                    });
                    let pooled = pool.take_buffer().unwrap();
                    let who = format!("{} {width}x{height}, {threads} threads, {bins_w}x{bins_h} bins", scene.name);
                    assert!(pixels(&pooled) == pixels(&direct), "{who}");
                    assert_eq!(pooled.statistics(), direct.statistics(), "{who}");
                }
            }
        }
    }
}

/// A box of two triangles, or a fan of slivers, somewhere in clip space; many are hidden.
fn small_mesh(numbers: &mut Numbers) -> (Vec<f32>, Vec<u32>) {
    let (x, y, w) = (numbers.within(-1.2, 1.2), numbers.within(-1.2, 1.2), numbers.within(0.5, 40.0));
    let size = numbers.within(0.01, 0.9);
    let n = 3 + (numbers.next() % 9) as u32;
    let corner = |_| [x + numbers.within(-size, size), y + numbers.within(-size, size), w + numbers.within(-0.4, 9.0)];
    let corners: Vec<[f32; 3]> = (0..n).map(corner).collect();
    let flat = corners.iter().flat_map(|&[x, y, w]| [x * w, y * w, 0.0, w]).collect();
    (flat, (1..n - 1).flat_map(|k| [0, k, k + 1]).collect())
}

/// Thousands of frames of small jobs, with clears, resizes, merges, matrices and near planes in between, alongside one
/// object that is drawn into directly.
fn soak(seed: u64, threads: u32, max_jobs: u32, frames: usize) {
    let mut numbers = Numbers(seed);
    let meshes: Vec<_> = (0..64).map(|_| small_mesh(&mut numbers)).collect();
    let other = {
        let mut other = object(200, 130, 0.1, Settings::default());
        for (flat, triangles) in &meshes[..8] {
            let vertices = Vertices::new(flat, ClipSpaceLayout::XYZW).unwrap();
            other.render_triangles(vertices, triangles, &DrawOptions::default()).unwrap();
        }
        other
    };
    let pool = CullingThreadpool::new(
        ThreadpoolSettings::default().with_threads(threads).with_max_jobs(max_jobs).with_processors(threads + 1),
    )
    .unwrap();
    pool.set_buffer(object(200, 130, 0.1, Settings::default()));
    let mut direct = object(200, 130, 0.1, Settings::default());
    pool.wake_threads();
    for frame in 0..frames {
        pool.scope(|scope| {
            for _ in 0..numbers.next() % 40 {
                match numbers.next() % 64 {
                    0..2 => {
                        pool.clear_buffer().unwrap();
                        direct.clear_buffer();
                    }
                    2 => {
                        // Including a single column of tiles or of coarse cells, which is divided into several rows of
                        // bins.
                        let sizes = [(200, 130), (640, 400), (33, 9), (257, 300), (20, 300), (120, 400)];
                        let (width, height) = sizes[numbers.next() as usize % sizes.len()];
                        pool.set_resolution(width, height).unwrap();
                        direct.set_resolution(width, height).unwrap();
                    }
                    3 => {
                        let near = numbers.within(0.0, 3.0);
                        pool.set_near_clip_plane(near).unwrap();
                        direct.set_near_clip_plane(near).unwrap();
                    }
                    4 => assert_eq!(scope.merge_buffers(&[&other, &other]), direct.merge_buffers(&[&other, &other])),
                    5 => pool.suspend_threads(),
                    6 => pool.wake_threads(),
                    7 => pool.flush(),
                    8 => {
                        // Nothing ever hides a rectangle that is nearer than everything.
                        assert_eq!(pool.test_rect(-0.5, -0.5, 0.5, 0.5, 0.01), Ok(CullingResult::Visible));
                    }
                    _ => {
                        let (flat, triangles) = &meshes[numbers.next() as usize % meshes.len()];
                        let wider = Mat4::from_scale(Vec3::new(numbers.within(0.2, 1.5), 1.0, 1.0));
                        // z of the mesh is 0, and its w is passed as z.
                        let matrix = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 1., 0., 0., 0., 0.];
                        let matrix = Mat4::from_cols_array(&matrix) * wider;
                        let space = match numbers.next().is_multiple_of(2) {
                            true => ModelSpaceLayout::new(16, 4, 12).with_matrix(matrix.to_cols_array()),
                            false => ClipSpaceLayout::XYZW.into(),
                        };
                        let options = DrawOptions::default().with_winding(BackfaceWinding::None);
                        let vertices = Vertices::new(flat, space).unwrap();
                        scope.render_triangles(vertices, triangles, &options).unwrap();
                        direct.render_triangles(vertices, triangles, &options).unwrap();
                    }
                }
            }
        });
        let mut depth = vec![0.0; pixels(&direct).len()];
        pool.compute_pixel_depth_buffer(&mut depth, false).unwrap();
        assert!(depth == pixels(&direct), "seed {seed}, {threads} threads, {max_jobs} jobs, frame {frame}");
        pool.wake_threads();
    }
}

#[test]
fn thousands_of_frames_have_the_bits_of_one_thread() {
    for (seed, threads, max_jobs) in [(1, 0, 1), (2, 1, 1), (3, 2, 32), (4, 2, 1), (5, 3, 2), (6, 7, 4)] {
        soak(seed, threads, max_jobs, 500);
    }
}

/// Runs for POOL_SOAK_SECONDS, from the seed in POOL_SOAK_SEED on; not at all if they are not set.
#[test]
fn a_soak_as_long_as_wanted() {
    let number = |name| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    let Some(seconds) = number("POOL_SOAK_SECONDS") else { return };
    let first = number("POOL_SOAK_SEED").unwrap_or(1) << 16;
    let start = std::time::Instant::now();
    let rounds = (first..).take_while(|_| start.elapsed().as_secs() < seconds);
    for seed in rounds {
        let mut numbers = Numbers(seed);
        soak(seed, (numbers.next() % 9) as u32, [1, 2, 5, 32][numbers.next() as usize % 4], 100);
    }
}

/// A wall over the whole screen.
const WALL: [f32; 16] = [-9., -9., 0., 4., 9., -9., 0., 4., 9., 9., 0., 4., -9., 9., 0., 4.];
const TWO: [u32; 6] = [0, 1, 2, 0, 2, 3];

fn draw_wall(pool: &CullingThreadpool) {
    let vertices = Vertices::new(&WALL, ClipSpaceLayout::XYZW).unwrap();
    // SAFETY: a constant.
    unsafe { pool.render_triangles(vertices, &TWO, &DrawOptions::default().with_winding(BackfaceWinding::None)) }
        .unwrap();
}

#[test]
fn what_was_cleared_hides_nothing_from_then_on() {
    let pool = CullingThreadpool::new(ThreadpoolSettings::default().with_threads(2).with_processors(3)).unwrap();
    pool.set_buffer(object(640, 400, 0.1, Settings::default()));
    pool.wake_threads();
    let behind = |pool: &CullingThreadpool| pool.test_rect(-0.9, -0.9, 0.9, 0.9, 8.0).unwrap();
    for frame in 0..300 {
        draw_wall(&pool);
        pool.flush();
        assert_eq!(behind(&pool), CullingResult::Occluded, "frame {frame}");
        // While suspended, no thread performs the clear before the query.
        if frame % 2 == 0 {
            pool.suspend_threads();
        }
        pool.clear_buffer().unwrap();
        assert_eq!(behind(&pool), CullingResult::Visible, "frame {frame}");
        let wall = Vertices::new(&WALL, ClipSpaceLayout::XYZW).unwrap();
        let options = DrawOptions::default().with_winding(BackfaceWinding::None);
        assert_eq!(pool.test_triangles(wall, &TWO, &options), Ok(CullingResult::Visible), "frame {frame}");
        // Found by the fuzzer: a triangle that passes the corner of the screen, with bounds that the wall hid.
        let passes = [9.6, 7.2, 0.0, 8.0, 7.2, 9.6, 0.0, 8.0, 9.6, 9.6, 0.0, 8.0];
        let passes = Vertices::new(&passes, ClipSpaceLayout::XYZW).unwrap();
        let result = pool.test_triangles(passes, &[0, 1, 2], &options).unwrap();
        assert_ne!(result, CullingResult::Occluded, "frame {frame}");
        pool.flush();
        let result = pool.test_triangles(passes, &[0, 1, 2], &options);
        assert_eq!(result, Ok(CullingResult::ViewCulled), "frame {frame}");
        pool.wake_threads();
    }
}

#[test]
fn several_threads_submit_and_query_at_once() {
    let pool =
        CullingThreadpool::new(ThreadpoolSettings::default().with_threads(2).with_max_jobs(4).with_processors(3))
            .unwrap();
    pool.set_buffer(object(640, 400, 0.1, Settings::default().with_statistics(true)));
    pool.wake_threads();
    let scene = &scenes::all()[0];
    let ends = AtomicBool::new(false);
    std::thread::scope(|threads| {
        let submit = || {
            for _ in 0..50 {
                pool.scope(|scope| {
                    for triangles in &scene.objects {
                        let options = DrawOptions::default().with_winding(BackfaceWinding::None);
                        scope.render_triangles(vertices(scene), triangles, &options).unwrap();
                    }
                });
            }
        };
        let submitters = [threads.spawn(submit), threads.spawn(submit)];
        threads.spawn(|| {
            while !ends.load(Ordering::Relaxed) {
                assert_eq!(pool.test_rect(-0.5, -0.5, 0.5, 0.5, 0.01), Ok(CullingResult::Visible));
                assert_eq!(pool.test_rect(1.5, 0.0, 2.0, 1.0, 1.0), Ok(CullingResult::ViewCulled));
            }
        });
        submitters.into_iter().for_each(|thread| thread.join().unwrap());
        ends.store(true, Ordering::Relaxed);
    });
    let triangles: usize = scene.objects.iter().map(|object| object.len() / 3).sum();
    let statistics = pool.statistics().unwrap();
    assert_eq!(statistics.occluders.num_processed_triangles, 100 * triangles as i64);
}

#[test]
fn every_order_of_calls_is_defined() {
    let pool = CullingThreadpool::new(
        ThreadpoolSettings::default().with_threads(3).with_bins(2, 2).with_max_jobs(2).with_processors(4),
    )
    .unwrap();
    // Without an object.
    pool.flush();
    assert_eq!(pool.clear_buffer(), Err(Error::NoObject));
    assert_eq!(pool.test_rect(0.0, 0.0, 1.0, 1.0, 1.0), Err(Error::NoObject));
    assert_eq!(pool.set_resolution(64, 64), Err(Error::NoObject));
    assert!(pool.take_buffer().is_none());
    pool.wake_threads();
    pool.wake_threads();
    // Its size is changed through the pool.
    pool.set_buffer(object(1, 1, 0.0, Settings::default()));
    pool.set_resolution(640, 400).unwrap();
    assert_eq!(pool.set_resolution(0, 400), Err(Error::InvalidSize));
    assert_eq!(pool.set_near_clip_plane(f32::NAN), Err(Error::InvalidNumber));
    pool.suspend_threads();
    pool.suspend_threads();
    // More than there is room for, while no other thread works.
    for _ in 0..1000 {
        draw_wall(&pool);
        pool.clear_buffer().unwrap();
    }
    draw_wall(&pool);
    pool.flush();
    assert_eq!(pool.test_rect(-0.9, -0.9, 0.9, 0.9, 8.0), Ok(CullingResult::Occluded));
    // A near plane beyond the wall.
    pool.set_near_clip_plane(5.0).unwrap();
    pool.clear_buffer().unwrap();
    draw_wall(&pool);
    pool.flush();
    assert_eq!(pool.test_rect(-0.9, -0.9, 0.9, 0.9, 8.0), Ok(CullingResult::Visible));
    // Dropped with work in flight, awake.
    pool.wake_threads();
    for _ in 0..100 {
        draw_wall(&pool);
    }
    drop(pool);
    for none in [
        ThreadpoolSettings::default().with_bins(0, 1),
        ThreadpoolSettings::default().with_bins(1, 0),
        ThreadpoolSettings::default().with_max_jobs(0),
    ] {
        assert_eq!(CullingThreadpool::new(none).err(), Some(Error::InvalidSize));
    }
}
