//! Recordings match the format to the byte, replay with the same answers and depths, and are rejected if truncated or
//! corrupt.
#![cfg(feature = "recorder")]

use fastrand::Rng;
use masked_occlusion_culling::{
    BackfaceWinding, ClipPlanes, ClipSpaceLayout, CullingResult, CullingThreadpool, DrawOptions, Error,
    MaskedOcclusionCulling, ModelSpaceLayout, RecordedCall, Recording, RecordingError, Settings, ThreadpoolSettings,
    VertexSpace, Vertices,
};
use std::path::{Path, PathBuf};

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }
}

fn object(width: u32, height: u32) -> MaskedOcclusionCulling {
    MaskedOcclusionCulling::new(width, height, Settings::default()).unwrap()
}

fn depths(moc: &MaskedOcclusionCulling) -> Vec<u32> {
    let (width, height) = moc.resolution();
    let mut depth = vec![0.0; (width * height) as usize];
    moc.compute_pixel_depth_buffer(&mut depth, false).unwrap();
    depth.iter().map(|d| d.to_bits()).collect()
}

/// Plays a recording into a new object, and counts the answers that differ from those recorded.
fn replay(recording: &Recording) -> (MaskedOcclusionCulling, usize) {
    let mut moc = object(1, 1);
    let mut differ = 0;
    let count = |call: &RecordedCall, answer: Option<CullingResult>| {
        differ += usize::from(call.result().is_some() && call.result() != answer);
    };
    recording.play(&mut moc, count).unwrap();
    (moc, differ)
}

/// Random triangles in front of the eye, in one of several layouts.
struct RandomMesh {
    data: Vec<f32>,
    space: VertexSpace,
    triangles: Vec<u32>,
    options: DrawOptions,
}

impl RandomMesh {
    fn new(random: &mut Rng) -> Self {
        let count = random.usize(3..40);
        let with_matrix = random.bool();
        let (stride, y, zw, soa) = match random.u8(0..4) {
            0 => (16, 4, if with_matrix { 8 } else { 12 }, false),
            1 => (12, 4, 8, false),
            2 => (40, 20, 8, false),
            _ => (4, 4 * count as i32, 8 * count as i32, true),
        };
        let words = if soa { 3 * count } else { count * stride as usize / 4 };
        let mut data: Vec<f32> = (0..words).map(|_| f32::NAN).collect();
        for v in 0..count {
            let at = v * stride as usize / 4;
            let w = 1.0 + 30.0 * random.f32();
            let side = if with_matrix { 3.0 } else { w };
            data[at] = side * (2.4 * random.f32() - 1.2);
            data[at + y as usize / 4] = side * (2.4 * random.f32() - 1.2);
            data[at + zw as usize / 4] = if with_matrix { -w } else { w };
        }
        // Does not start at the first vertex.
        let low = random.u32(0..count as u32 - 2);
        let triangles = (0..3 * random.usize(0..12)).map(|_| random.u32(low..count as u32)).collect();
        // w is -z, plus a bit.
        let matrix = [1.0, 0.1, 0.0, 0.0, 0.0, 1.5, 0.0, 0.0, 0.0, 0.0, 1.0, -1.0, 0.1, 0.2, 0.0, 0.1];
        let space = match with_matrix {
            true => ModelSpaceLayout::new(stride, y, zw).with_matrix(matrix),
            false => ClipSpaceLayout::new(stride, y, zw).into(),
        };
        let winding = [BackfaceWinding::None, BackfaceWinding::Clockwise, BackfaceWinding::CounterClockwise];
        let options = DrawOptions::default()
            .with_winding(winding[random.usize(0..3)])
            .with_clip_planes(if random.bool() { ClipPlanes::ALL } else { ClipPlanes::NONE });
        Self { data, space, triangles, options }
    }

    fn vertices(&self) -> Vertices<'_> {
        Vertices::new(&self.data, self.space).unwrap()
    }
}

#[test]
fn what_was_recorded_is_played_with_the_same_answers_and_depths() {
    let folder = Folder::new();
    let mut seen = [0; 4];
    for seed in 0..200 {
        let mut random = Rng::with_seed(seed);
        let mut moc = object(random.u32(1..200), random.u32(1..200));
        moc.set_near_clip_plane(random.f32()).unwrap();
        let path = folder.file("frame.mocrec");
        moc.recorder_start(&path).unwrap();
        let (mut answers, mut calls) = (Vec::new(), 0);
        for _ in 0..random.usize(0..60) {
            calls += 1;
            let mesh = RandomMesh::new(&mut random);
            match random.u8(0..9) {
                0 => moc.clear_buffer(),
                1..=4 => {
                    let answer = moc.render_triangles(mesh.vertices(), &mesh.triangles, &mesh.options);
                    answers.push(answer.unwrap());
                }
                5 | 6 => {
                    let answer = moc.test_triangles(mesh.vertices(), &mesh.triangles, &mesh.options);
                    answers.push(answer.unwrap());
                }
                _ => {
                    let [x, y] = [0, 1].map(|_| 2.0 * random.f32() - 1.2);
                    answers.push(moc.test_rect(x, y, x + 0.2, y + 0.2, 20.0 * random.f32()));
                }
            }
            // A rejected call is not recorded.
            let bad = moc.render_triangles(mesh.vertices(), &[0, 1, u32::MAX], &mesh.options);
            assert_eq!(bad, Err(Error::IndexOutOfRange));
        }
        moc.recorder_stop().unwrap();
        let recording = Recording::load(&path).unwrap();
        assert_eq!(recording.calls.len(), calls);
        assert_eq!(recording.resolution, moc.resolution());
        assert_eq!(recording.near_clip_plane, moc.near_clip_plane());
        let recorded: Vec<_> = recording.calls.iter().filter_map(RecordedCall::result).collect();
        assert_eq!(recorded, answers, "seed {seed}");
        let (again, differ) = replay(&recording);
        assert_eq!((differ, depths(&again)), (0, depths(&moc)), "seed {seed}");
        recorded.iter().for_each(|&answer| seen[answer as usize] += 1);
    }
    assert!(seen[0] > 100 && seen[1] > 20 && seen[3] > 100, "{seen:?}");
}

/// Appends words of a recording written by hand.
fn words(bytes: &mut Vec<u8>, words: &[u32]) {
    bytes.extend(words.iter().flat_map(|word| word.to_le_bytes()));
}

/// A clear, a draw, a rectangle and a query: (bytes of the header, all bytes).
fn by_hand() -> (usize, Vec<u8>) {
    let mut bytes = Vec::new();
    words(&mut bytes, &[0xA701_B600, 0.25f32.to_bits(), 64, 32]);
    let header = bytes.len();
    bytes.push(3);
    // A draw of vertices 5 to 7 of 20 bytes: x, (a gap), w, y, (a gap).
    bytes.push(0);
    words(&mut bytes, &[0, 3, 20]);
    for [x, y, w] in [[-1.0f32, -1.0, 1.0], [1.0, -1.0, 1.0], [0.0, 1.0, 1.0]] {
        words(&mut bytes, &[x.to_bits(), 0, w.to_bits(), y.to_bits(), 0]);
    }
    words(&mut bytes, &[1, 0, 2, 1]);
    bytes.push(0);
    words(&mut bytes, &[0x1f, 0, 20, 12, 8]);
    bytes.push(1);
    words(&mut bytes, &[1]);
    words(&mut bytes, &[-0.1f32, -0.1, 0.1, 0.1, 4.0].map(f32::to_bits));
    // A query with a matrix, and a draw of nothing.
    bytes.push(2);
    words(&mut bytes, &[1, 3, 12]);
    for position in [[-0.1f32, -0.1, 9.0], [0.1, -0.1, 9.0], [0.0, 0.1, 9.0]] {
        words(&mut bytes, &position.map(f32::to_bits));
    }
    words(&mut bytes, &[1, 0, 1, 2]);
    bytes.push(1);
    words(&mut bytes, &MATRIX.map(f32::to_bits));
    words(&mut bytes, &[1, 1, 12, 4, 8]);
    bytes.push(0);
    words(&mut bytes, &[3, 0]);
    bytes.push(0x7f);
    (header, bytes)
}

/// w is z.
const MATRIX: [f32; 16] = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 1., 0., 0., 0., 0.];

#[test]
fn the_bytes_are_those_of_the_format() {
    let folder = Folder::new();
    let path = folder.file("by_hand.mocrec");
    let mut moc = object(64, 32);
    moc.set_near_clip_plane(0.25).unwrap();
    moc.recorder_start(&path).unwrap();
    moc.clear_buffer();
    let gap = f32::NAN;
    let mut data = [gap; 40];
    for (v, [x, y, w]) in [[-1.0f32, -1.0, 1.0], [1.0, -1.0, 1.0], [0.0, 1.0, 1.0]].into_iter().enumerate() {
        data[5 * (5 + v)..][..5].copy_from_slice(&[x, gap, w, y, gap]);
    }
    let vertices = Vertices::new(&data, ClipSpaceLayout::new(20, 12, 8)).unwrap();
    let both_sides = DrawOptions::default().with_winding(BackfaceWinding::None);
    moc.render_triangles(vertices, &[5, 7, 6], &both_sides).unwrap();
    moc.test_rect(-0.1, -0.1, 0.1, 0.1, 4.0);
    let options = DrawOptions::default().with_clip_planes(ClipPlanes::NEAR);
    let positions = [[-0.1, -0.1, 9.0], [0.1, -0.1, 9.0], [0.0, 0.1, 9.0]];
    let answer = moc.test_triangles(Vertices::model_space(&positions, MATRIX), &[0, 1, 2], &options);
    assert_eq!(answer, Ok(CullingResult::Occluded));
    moc.render_triangles(Vertices::model_space(&[], MATRIX), &[], &options).unwrap();
    moc.recorder_stop().unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), by_hand().1);
    assert_eq!(Recording::load(&path).unwrap().calls.len(), 5);
}

#[test]
fn a_cut_file_is_refused_wherever_it_is_cut() {
    let (_, bytes) = by_hand();
    for len in 0..bytes.len() {
        match Recording::from_bytes(&bytes[..len]) {
            Err(RecordingError::Invalid { offset, .. }) => assert!(offset <= len),
            other => panic!("cut at {len}: {other:?}"),
        }
    }
    // Anything after the end is ignored.
    let longer = [bytes.as_slice(), b"more"].concat();
    assert_eq!(Recording::from_bytes(&longer).unwrap(), Recording::from_bytes(&bytes).unwrap());
}

#[test]
fn counts_are_compared_with_the_file_before_anything_is_made_of_them() {
    let (header, bytes) = by_hand();
    let vertices = header + 1 + 1 + 4;
    for (at, value) in [
        (vertices, i32::MAX),
        (vertices, -1),
        (vertices + 4, i32::MAX),
        (vertices + 4, 0),
        (vertices + 4, -4),
        (vertices + 4, 18),
        (vertices + 8 + 60, i32::MAX),
        (vertices + 8 + 60, -1),
    ] {
        let mut broken = bytes.clone();
        broken[at..at + 4].copy_from_slice(&value.to_le_bytes());
        let error = Recording::from_bytes(&broken).expect_err("a wrong count");
        assert!(matches!(error, RecordingError::Invalid { .. }), "{error}");
    }
}

#[test]
fn what_is_broken_is_refused_or_can_be_played() {
    let (_, bytes) = by_hand();
    let (mut refused, mut played) = (0, 0);
    let mut random = Rng::with_seed(7);
    for _ in 0..20_000 {
        let mut broken = bytes.clone();
        for _ in 0..random.usize(1..4) {
            let at = random.usize(0..broken.len());
            broken[at] = if random.bool() { random.u8(..) } else { broken[at] ^ 1 << random.u8(0..8) };
        }
        match Recording::from_bytes(&broken) {
            // A large buffer takes long and reveals nothing.
            Ok(recording) if recording.resolution.0 * recording.resolution.1 > 1 << 20 => {}
            Ok(recording) => {
                replay(&recording);
                played += 1;
            }
            Err(RecordingError::Invalid { .. }) => refused += 1,
            Err(other) => panic!("{other}"),
        }
    }
    assert!(refused > 2000 && played > 2000, "{refused} {played}");
}

#[test]
fn starting_and_stopping_at_any_time_is_defined() {
    let folder = Folder::new();
    let (a, b) = (folder.file("a.mocrec"), folder.file("b.mocrec"));
    let mut moc = object(16, 16);
    moc.recorder_stop().unwrap();
    assert!(matches!(moc.recorder_start(folder.file("no/such/folder")), Err(RecordingError::File(_))));
    moc.recorder_start(&a).unwrap();
    assert!(matches!(moc.recorder_start(&b), Err(RecordingError::Busy)));
    assert!(!b.exists());
    moc.clear_buffer();
    // Setting the same size only clears; setting the same near plane changes nothing.
    moc.set_resolution(16, 16).unwrap();
    moc.set_near_clip_plane(0.0).unwrap();
    moc.recorder_stop().unwrap();
    moc.clear_buffer();
    moc.recorder_stop().unwrap();
    assert_eq!(Recording::load(&a).unwrap().calls, [RecordedCall::ClearBuffer, RecordedCall::ClearBuffer]);

    // The header is not written before the first call, so the settings can still change.
    moc.recorder_start(&a).unwrap();
    moc.set_near_clip_plane(0.125).unwrap();
    moc.set_resolution(24, 8).unwrap();
    moc.recorder_stop().unwrap();
    let recording = Recording::load(&a).unwrap();
    assert_eq!((recording.near_clip_plane, recording.resolution), (0.125, (24, 8)));
    assert_eq!(recording.calls, [RecordedCall::ClearBuffer]);
    moc.recorder_start(&a).unwrap();
    moc.recorder_stop().unwrap();
    assert_eq!(Recording::load(&a).unwrap().calls, []);

    let ends: [fn(&mut MaskedOcclusionCulling); 3] = [
        |moc| moc.set_resolution(17, 16).unwrap(),
        |moc| moc.set_near_clip_plane(0.5).unwrap(),
        |moc| drop(core::mem::replace(moc, object(16, 16))),
    ];
    for end in ends {
        moc = object(16, 16);
        moc.recorder_start(&b).unwrap();
        moc.clear_buffer();
        end(&mut moc);
        moc.clear_buffer();
        assert_eq!(Recording::load(&b).unwrap().calls, [RecordedCall::ClearBuffer]);
        moc.recorder_stop().unwrap();
    }
}

#[test]
fn a_file_that_cannot_be_read_or_is_none_says_so() {
    let folder = Folder::new();
    assert!(matches!(Recording::load(folder.file("none")), Err(RecordingError::File(_))));
    assert!(matches!(Recording::load(folder.0.path()), Err(RecordingError::File(_))));
    for text in ["", "mocrec", "a text that is longer than the header of a recording is"] {
        let path = folder.file("text");
        std::fs::write(&path, text).unwrap();
        let error = Recording::load(&path).expect_err("no recording");
        assert_eq!(error.to_string(), "not a recording: it does not begin with a recording's signature");
    }
}

/// Stride 0: all vertices are the same one, and there may be more of them than the format can count.
#[cfg(feature = "capi")]
#[test]
fn a_mesh_that_is_too_large_for_the_format_ends_a_recording_that_stays_whole() {
    use masked_occlusion_culling::capi;

    let folder = Folder::new();
    let path = folder.file("large.mocrec");
    let moc = &mut object(16, 16);
    moc.recorder_start(&path).unwrap();
    moc.clear_buffer();
    let (vertex, triangle) = ([0.0f32, 0.0, 0.0, 1.0], [0, 1, u32::MAX]);
    let layout = capi::MOC_VertexLayout { stride: 0, offset_y: 4, offset_zw: 12 };
    // SAFETY: a live object; every index refers to the only vertex.
    let status = unsafe {
        let (vertex, triangle) = (vertex.as_ptr(), triangle.as_ptr());
        capi::MOC_RecordRenderTriangles(moc, vertex, triangle, 1, core::ptr::null(), 0, 0x1f, &layout, -1)
    };
    assert_eq!(status, capi::MOC_Status::MOC_STATUS_OK);
    moc.clear_buffer();
    assert!(matches!(moc.recorder_stop(), Err(RecordingError::File(_))));
    assert_eq!(Recording::load(&path).unwrap().calls, [RecordedCall::ClearBuffer]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_told_when_the_recording_ends() {
    let mut moc = object(16, 16);
    moc.recorder_start("/dev/full").unwrap();
    let mut random = Rng::with_seed(1);
    for _ in 0..300 {
        let mesh = RandomMesh::new(&mut random);
        moc.render_triangles(mesh.vertices(), &mesh.triangles, &mesh.options).unwrap();
    }
    assert!(matches!(moc.recorder_stop(), Err(RecordingError::File(_))));
    // The error was reported; there is nothing left to stop.
    moc.recorder_stop().unwrap();
}

#[test]
fn what_a_pool_is_told_is_recorded_in_order() {
    let folder = Folder::new();
    for seed in 0..30 {
        let mut random = Rng::with_seed(seed);
        let path = folder.file("pool.mocrec");
        let moc = object(200, 150);
        moc.recorder_start(&path).unwrap();
        let pool = CullingThreadpool::new(
            ThreadpoolSettings::default().with_threads(random.u32(0..3)).with_max_jobs(8).with_processors(3),
        )
        .unwrap();
        pool.set_buffer(moc);
        pool.wake_threads();
        let meshes: Vec<_> = (0..20).map(|_| RandomMesh::new(&mut random)).collect();
        pool.clear_buffer().unwrap();
        for (k, mesh) in meshes.iter().enumerate() {
            // SAFETY: the meshes live until the flush.
            unsafe { pool.render_triangles(mesh.vertices(), &mesh.triangles, &mesh.options) }.unwrap();
            if k % 5 == 4 {
                // While drawing is in progress the answer may differ from a later one, so it is not recorded as
                // certain.
                pool.test_rect(-0.5, -0.5, 0.0, 0.0, 9.0).unwrap();
            }
        }
        pool.flush();
        pool.test_triangles(meshes[0].vertices(), &meshes[0].triangles, &meshes[0].options).unwrap();
        let moc = pool.take_buffer().unwrap();
        moc.recorder_stop().unwrap();
        let recording = Recording::load(&path).unwrap();
        assert_eq!(recording.calls.len(), 1 + 20 + 4 + 1);
        assert!(recording.calls[25].result().is_some());
        let (again, differ) = replay(&recording);
        assert_eq!((differ, depths(&again)), (0, depths(&moc)), "seed {seed}");
    }
}

/// A query during drawing is not recorded as certain, however soon afterwards the drawing is finished.
#[test]
fn no_answer_of_a_pool_is_recorded_that_may_be_another_one_later() {
    let folder = Folder::new();
    let mut random = Rng::with_seed(3);
    let path = folder.file("pool.mocrec");
    let wall = [[-9.0f32, -9.0, 0.0, 3.0], [9.0, -9.0, 0.0, 3.0], [0.0, 9.0, 0.0, 3.0]];
    let (corners, asked) = ([0, 1, 2], [0, 1, 2].repeat(2000));
    let behind = wall.map(|[x, y, z, _]| [x / 9.0, y / 9.0, z, 9.0]);
    let both_sides = DrawOptions::default().with_winding(BackfaceWinding::None);
    let pool = CullingThreadpool::new(ThreadpoolSettings::default().with_threads(1).with_max_jobs(8)).unwrap();
    pool.wake_threads();
    // Without this precaution one in a few hundred would fail.
    for _ in 0..1000 {
        let moc = object(300, 200);
        moc.recorder_start(&path).unwrap();
        pool.set_buffer(moc);
        pool.clear_buffer().unwrap();
        let meshes: Vec<_> = (0..random.usize(0..40)).map(|_| RandomMesh::new(&mut random)).collect();
        // SAFETY: the meshes live until the object is returned, which flushes.
        unsafe {
            for mesh in &meshes {
                pool.render_triangles(mesh.vertices(), &mesh.triangles, &mesh.options).unwrap();
            }
            pool.render_triangles(Vertices::clip_space(&wall), &corners, &both_sides).unwrap();
        }
        pool.test_triangles(Vertices::clip_space(&behind), &asked, &both_sides).unwrap();
        let moc = pool.take_buffer().unwrap();
        moc.recorder_stop().unwrap();
        assert_eq!(replay(&Recording::load(&path).unwrap()).1, 0);
    }
}

/// Whatever the interleaving of threads, the file lists their calls in drawing order.
#[test]
fn what_several_threads_submit_is_recorded_as_it_is_drawn() {
    let folder = Folder::new();
    let path = folder.file("threads.mocrec");
    let wall = [[-9.0f32, -9.0, 0.0, 3.0], [9.0, -9.0, 0.0, 3.0], [0.0, 9.0, 0.0, 3.0]];
    let both_sides = DrawOptions::default().with_winding(BackfaceWinding::None);
    // Without this precaution one in a few thousand would fail.
    for _ in 0..2000 {
        let moc = object(64, 64);
        moc.recorder_start(&path).unwrap();
        let pool =
            CullingThreadpool::new(ThreadpoolSettings::default().with_threads(0).with_bins(1, 1).with_max_jobs(100))
                .unwrap();
        pool.set_buffer(moc);
        pool.clear_buffer().unwrap();
        std::thread::scope(|threads| {
            threads.spawn(|| {
                for _ in 0..10 {
                    // SAFETY: all of it lives until the object is returned, which flushes.
                    unsafe { pool.render_triangles(Vertices::clip_space(&wall), &[0, 1, 2], &both_sides) }.unwrap();
                }
            });
            threads.spawn(|| (0..10).for_each(|_| pool.clear_buffer().unwrap()));
        });
        let moc = pool.take_buffer().unwrap();
        moc.recorder_stop().unwrap();
        let recording = Recording::load(&path).unwrap();
        assert_eq!(recording.calls.len(), 21);
        assert_eq!(depths(&replay(&recording).0), depths(&moc));
    }
}

/// A call may occupy a single byte of the file, and must not need so much memory that a small file exhausts it.
#[test]
fn what_a_file_takes_in_memory_is_bounded() {
    assert!(size_of::<RecordedCall>() <= 32, "{}", size_of::<RecordedCall>());
    let (header, bytes) = by_hand();
    let mut clears = bytes[..header].to_vec();
    clears.resize(header + (1 << 20), 3);
    clears.push(0x7f);
    assert_eq!(Recording::from_bytes(&clears).unwrap().calls.len(), 1 << 20);
}

/// Frames recorded by Intel's library, if available.
#[test]
fn recordings_of_others_play_with_their_answers() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/recordings");
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    let mut played = 0;
    for path in
        entries.map(|entry| entry.unwrap().path()).filter(|path| path.extension().is_some_and(|e| e == "mocrec"))
    {
        let recording = Recording::load(&path).unwrap();
        let (_, differ) = replay(&recording);
        assert_eq!(differ, 0, "{} of {} calls", path.display(), recording.calls.len());
        played += 1;
    }
    assert!(played > 0);
}
