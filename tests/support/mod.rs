//! Shared test code: objects of every kind, clip-space vertices with an exact projection, reading back.
#![allow(dead_code, reason = "every test uses a part of it")]

pub mod triangles;

use masked_occlusion_culling::{
    BackfaceWinding, CullingResult, DrawOptions, Implementation, MaskedOcclusionCulling, Settings, UpdateRule,
    Vertices, YAxis,
};
use proptest::test_runner::{Config, RngSeed, TestError, TestRunner};

use crate::oracle::bounds::block_bound;
use crate::oracle::{Oracle, Triangle, UNIT, Vertex, depth_at_pixel, span, useful_depth};

pub const RULES: [UpdateRule; 4] =
    [UpdateRule::ThreeLayer, UpdateRule::Quick, UpdateRule::Accurate, UpdateRule::FourLayer];
pub const AXES: [YAxis; 2] = [YAxis::Down, YAxis::Up];

/// Both sides, all planes.
pub fn both_sides() -> DrawOptions {
    DrawOptions::default().with_winding(BackfaceWinding::None)
}

pub fn object(
    implementation: Implementation,
    rule: UpdateRule,
    axis: YAxis,
    size: (usize, usize),
) -> MaskedOcclusionCulling {
    let settings = Settings::default()
        .with_implementation(implementation)
        .with_update_rule(rule)
        .with_y_axis(axis)
        .with_statistics(true);
    let moc = MaskedOcclusionCulling::new(size.0 as u32, size.1 as u32, settings).unwrap();
    assert_eq!(moc.implementation(), implementation, "an available instruction set is refused");
    moc
}

/// One object with the default rule for each instruction set and row direction.
pub fn objects(size: (usize, usize)) -> Vec<MaskedOcclusionCulling> {
    let all = Implementation::available();
    all.iter().flat_map(|&i| AXES.map(|axis| object(i, UpdateRule::ThreeLayer, axis, size))).collect()
}

/// Identifies the object in failure messages.
pub fn name(moc: &MaskedOcclusionCulling) -> String {
    format!("{:?} {:?} {:?} {:?}", moc.implementation(), moc.update_rule(), moc.y_axis(), moc.resolution())
}

/// The clip-space vertex (x, y, z, w) that lands on `v`. For sizes that are a power of two the projection is exact in
/// f32 within 32,000 pixels; for others the error is less than a third of a unit within 4,096 pixels, so that it still
/// snaps to `v`.
pub fn clip_vertex(v: &Vertex, size: (usize, usize), axis: YAxis) -> [f32; 4] {
    let half = (UNIT / 2) as f64;
    let (half_w, half_h) = (half * size.0 as f64, half * size.1 as f64);
    let w = (1.0 / v.z) as f32;
    let x = ((v.x as f64 - half_w) / half_w) as f32;
    let y = ((v.y as f64 - half_h) / half_h) as f32;
    let y = if axis == YAxis::Up { y } else { -y };
    [x * w, y * w, 0.0, w]
}

/// The clip-space vertices of triangles and their indices.
pub fn mesh(triangles: &[Triangle], size: (usize, usize), axis: YAxis) -> (Vec<[f32; 4]>, Vec<u32>) {
    let vertices: Vec<_> = triangles.iter().flatten().map(|v| clip_vertex(v, size, axis)).collect();
    let indices = (0..vertices.len() as u32).collect();
    (vertices, indices)
}

fn size_of(moc: &MaskedOcclusionCulling) -> (usize, usize) {
    let (w, h) = moc.resolution();
    (w as usize, h as usize)
}

/// Draws both sides of triangles in one call.
pub fn draw(moc: &mut MaskedOcclusionCulling, triangles: &[Triangle]) -> CullingResult {
    let (vertices, indices) = mesh(triangles, size_of(moc), moc.y_axis());
    moc.render_triangles(Vertices::clip_space(&vertices), &indices, &both_sides()).unwrap()
}

/// Tests both sides of triangles in one call.
pub fn test(moc: &MaskedOcclusionCulling, triangles: &[Triangle]) -> CullingResult {
    let (vertices, indices) = mesh(triangles, size_of(moc), moc.y_axis());
    moc.test_triangles(Vertices::clip_space(&vertices), &indices, &both_sides()).unwrap()
}

/// Draws both sides of clip-space vertices, three per triangle.
pub fn draw_clip(moc: &mut MaskedOcclusionCulling, vertices: &[[f32; 4]]) -> CullingResult {
    let indices: Vec<u32> = (0..vertices.len() as u32).collect();
    moc.render_triangles(Vertices::clip_space(vertices), &indices, &both_sides()).unwrap()
}

/// Tests both sides of clip-space vertices, three per triangle.
pub fn test_clip(moc: &MaskedOcclusionCulling, vertices: &[[f32; 4]]) -> CullingResult {
    let indices: Vec<u32> = (0..vertices.len() as u32).collect();
    moc.test_triangles(Vertices::clip_space(vertices), &indices, &both_sides()).unwrap()
}

/// One triangle, with a constant w, that covers the whole screen.
pub fn wall(w: f32) -> [[f32; 4]; 3] {
    [[-w, -w, 0.0, w], [3.0 * w, -w, 0.0, w], [-w, 3.0 * w, 0.0, w]]
}

pub fn depth(moc: &MaskedOcclusionCulling) -> Vec<f32> {
    let mut depth = Vec::new();
    read(moc, &mut depth);
    depth
}

/// Reads the depth of every pixel into a vector that is reused between calls.
pub fn read(moc: &MaskedOcclusionCulling, depth: &mut Vec<f32>) {
    let (w, h) = size_of(moc);
    depth.resize(w * h, f32::NAN);
    moc.compute_pixel_depth_buffer(depth, false).unwrap();
}

/// The bits of every pixel's depth.
pub fn bits(moc: &MaskedOcclusionCulling) -> Vec<u32> {
    depth(moc).iter().map(|d| d.to_bits()).collect()
}

/// Does the value mean that nothing was drawn on the pixel? NaN does not.
pub fn is_empty(depth: f32) -> bool {
    depth < 0.0
}

/// Compares a buffer that holds one triangle with the exact answer: the same pixels, none nearer than the triangle is
/// anywhere in its 8x4 block, none uselessly far.
pub fn compare_one(t: &Triangle, depth: &[f32], oracle: &Oracle) -> Result<(), String> {
    let rows = oracle.rows(t);
    for (row, line) in depth.chunks_exact(oracle.width).enumerate() {
        let span = if rows.contains(&row) { span(t, row, oracle.width) } else { 0..0 };
        let span = if span.is_empty() { 0..0 } else { span };
        if let Some(column) = line[..span.start].iter().position(|d| !is_empty(*d)) {
            return Err(format!("covers ({column}, {row}) falsely"));
        }
        if let Some(column) = line[span.end..].iter().position(|d| !is_empty(*d)) {
            return Err(format!("covers ({}, {row}) falsely", span.end + column));
        }
        // Cached for a whole block, since this is most of the work: its number, and the nearest and the farthest valid
        // depth.
        let mut block = (usize::MAX, 0.0, 0.0);
        for column in span {
            let stored = f64::from(line[column]);
            if is_empty(line[column]) {
                return Err(format!("misses ({column}, {row})"));
            }
            let exact = depth_at_pixel(t, column, row);
            if stored.is_nan() || stored > exact * (1.0 + 1e-15) {
                return Err(format!("({column}, {row}) is too near: {stored:e}, exactly {exact:e}"));
            }
            if block.0 != column / 8 {
                block = (column / 8, block_bound(t, column, row), useful_depth(t, column, row));
            }
            let (_, bound, useful) = block;
            if stored > bound {
                return Err(format!("({column}, {row}) is too near for its block: {stored:e}, at most {bound:e}"));
            }
            if stored < useful {
                return Err(format!("({column}, {row}) is uselessly far: {stored:e}, not even {useful:e}"));
            }
        }
    }
    Ok(())
}

/// Is every pixel of a buffer as far as the exact answer, or farther?
pub fn conservative(depth: &[f32], oracle: &Oracle) -> Result<(), String> {
    for (i, (&stored, &exact)) in depth.iter().zip(&oracle.depth).enumerate() {
        // A pixel on which nothing was drawn holds exactly the negative value that indicates this.
        let right = if exact < 0.0 { stored < 0.0 } else { f64::from(stored) <= exact * (1.0 + 1e-15) };
        if !right {
            let (x, y) = (i % oracle.width, i / oracle.width);
            return Err(format!("({x}, {y}) is too near: {stored:e}, exactly {exact:e}"));
        }
    }
    Ok(())
}

/// How many times the usual number of cases to run: TEST_EFFORT, or 1 if it is not set. Another effort runs different
/// cases.
fn effort() -> u32 {
    std::env::var("TEST_EFFORT").map_or(1, |n| n.parse().expect("TEST_EFFORT is a number"))
}

/// Runs a property on the same cases every time, and shows the smallest failing one.
pub fn check<S: proptest::strategy::Strategy>(
    cases: u32,
    seed: u64,
    strategy: &S,
    property: impl Fn(S::Value) -> Result<(), String>,
) where
    S::Value: std::fmt::Debug,
{
    let config = Config {
        cases: cases * effort(),
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(seed + 1000 * u64::from(effort() - 1)),
        max_shrink_iters: 2000,
        ..Config::default()
    };
    let outcome = TestRunner::new(config)
        .run(strategy, |value| property(value).map_err(proptest::test_runner::TestCaseError::fail));
    match outcome {
        Ok(()) => {}
        Err(TestError::Fail(why, value)) => panic!("{why}\nsmallest case: {value:?}"),
        Err(TestError::Abort(why)) => panic!("gave up: {why}"),
    }
}
