//! Values that a program may pass by accident or on purpose.

use fastrand::Rng;
use masked_occlusion_culling::capi::MOC_VertexLayout;

const SPECIAL: [f32; 24] = [
    f32::NAN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    0.0,
    -0.0,
    1.0,
    -1.0,
    f32::MAX,
    f32::MIN,
    f32::MIN_POSITIVE,
    -f32::MIN_POSITIVE,
    f32::from_bits(1),
    f32::from_bits(0x8000_0001),
    1e38,
    -1e38,
    1e-38,
    1e20,
    -1e20,
    1e-20,
    -1e-20,
    16_777_216.0,
    2_147_483_648.0,
    -2_147_483_904.0,
    4_294_967_296.0,
];

/// A classic special value, or any 32 bits.
pub fn float(rng: &mut Rng) -> f32 {
    if rng.bool() { SPECIAL[rng.usize(..SPECIAL.len())] } else { f32::from_bits(rng.u32(..)) }
}

/// Uniform in `-range..range`.
pub fn uniform(rng: &mut Rng, range: f32) -> f32 {
    (rng.f32() * 2.0 - 1.0) * range
}

/// Mostly from -1 to 1 and slightly beyond, sometimes exactly on an edge, sometimes hostile.
pub fn coordinate(rng: &mut Rng) -> f32 {
    match rng.u8(..20) {
        0 => float(rng),
        1 => [-1.0, 1.0, 0.0][rng.usize(..3)],
        2 => uniform(rng, 1000.0),
        3 => uniform(rng, 1e-4),
        _ => uniform(rng, 1.3),
    }
}

/// Mostly a value of the enumeration, sometimes any integer.
pub fn enumeration(rng: &mut Rng, values: &[i32]) -> i32 {
    if rng.u8(..24) == 0 { rng.i32(..) } else { values[rng.usize(..values.len())] }
}

/// How the vertices of a mesh are distributed.
#[derive(Clone, Copy)]
enum Kind {
    Ordinary,
    Wall,
    NearHugging,
    Hostile,
    OnGrid,
    Sliver,
    MixedScale,
}

/// `count` vertices x, y, w (or z) for a buffer of `width` by `height` pixels and a near plane.
pub fn vertices(rng: &mut Rng, count: usize, width: u32, height: u32, near: f32) -> Vec<[f32; 3]> {
    use Kind::{Hostile, MixedScale, NearHugging, OnGrid, Ordinary, Sliver, Wall};
    let kinds = [Ordinary, Ordinary, Wall, NearHugging, Hostile, OnGrid, Sliver, MixedScale];
    let kind = kinds[rng.usize(..kinds.len())];
    // One hostile number in an otherwise valid mesh is the common case in practice.
    let poison = if rng.u8(..6) == 0 { 0.05 } else { 0.0 };
    let (x0, y0) = (uniform(rng, 1.0), uniform(rng, 1.0));
    let spread = [1e-3, 0.02, 0.3, 2.0][rng.usize(..4)];
    let wall = rng.f32() * 3.0 + 0.05;
    (0..count)
        .map(|_| {
            let w = rng.f32() * 9.9 + 0.1;
            let mut v = match kind {
                Ordinary => [(x0 + uniform(rng, spread)) * w, (y0 + uniform(rng, spread)) * w, w],
                // A few of its triangles hide the whole screen.
                Wall => {
                    let mut corner = || if rng.bool() { 20.0 * wall } else { -20.0 * wall };
                    [corner(), corner(), wall]
                }
                NearHugging => {
                    let ulps = rng.i32(-3..4);
                    let w = match rng.u8(..4) {
                        0 => f32::from_bits(near.to_bits().wrapping_add_signed(ulps)),
                        1 => near + uniform(rng, 1e-3),
                        2 => uniform(rng, 1e-30),
                        _ => uniform(rng, 2.0),
                    };
                    [uniform(rng, 1.5), uniform(rng, 1.5), w]
                }
                Hostile => [float(rng), float(rng), float(rng)],
                OnGrid => {
                    // Exact pixel corners and centres, also off screen.
                    let pixel = |rng: &mut Rng, size: u32| {
                        let half_pixels = rng.i32(-8..size as i32 * 2 + 8);
                        half_pixels as f32 / size as f32 - 1.0
                    };
                    [pixel(rng, width), pixel(rng, height), 1.0]
                }
                Sliver => [x0 + uniform(rng, 2.0), y0 + uniform(rng, 1e-5), 1.0 + uniform(rng, 1e-6)],
                MixedScale => {
                    let scale = 10f32.powi(rng.i32(-36..37));
                    let other = 10f32.powi(rng.i32(-36..37));
                    [uniform(rng, scale), uniform(rng, other), rng.f32() * scale]
                }
            };
            if rng.f32() < poison {
                v[rng.usize(..3)] = float(rng);
            }
            v
        })
        .collect()
}

/// A model-to-clip matrix: identity, a projection, strange, or hostile.
pub fn matrix(rng: &mut Rng) -> [f32; 16] {
    let mut m = [0.0; 16];
    match rng.u8(..4) {
        // w = 1 for all: an orthographic view.
        0 => (m[0], m[5], m[10], m[15]) = (1.0, 1.0, 1.0, 1.0),
        // A projection whose w is z.
        1 => (m[0], m[5], m[11]) = (1.0, 1.5, 1.0),
        2 => m = std::array::from_fn(|_| uniform(rng, 1.5)),
        _ => m = std::array::from_fn(|_| if rng.bool() { float(rng) } else { uniform(rng, 2.0) }),
    }
    m
}

/// A valid layout for `count` vertices: the offsets do not overlap.
pub fn kept_layout(rng: &mut Rng, count: usize) -> MOC_VertexLayout {
    let n = count as i32;
    let (stride, offset_y, offset_zw) =
        [(16, 4, 12), (16, 4, 8), (12, 4, 8), (4, 4 * n, 8 * n), (13, 4, 9), (64, 60, 20), (28, 8, 4)][rng.usize(..7)];
    MOC_VertexLayout { stride, offset_y, offset_zw }
}

/// Any layout.
pub fn layout(rng: &mut Rng) -> MOC_VertexLayout {
    let mut number = || match rng.u8(..4) {
        0 => rng.i32(..),
        1 => [i32::MIN, i32::MAX, -4, 0][rng.usize(..4)],
        _ => rng.i32(0..64),
    };
    MOC_VertexLayout { stride: number(), offset_y: number(), offset_zw: number() }
}

/// Mostly small, sometimes as long and narrow as is allowed, sometimes refused.
pub fn resolution(rng: &mut Rng) -> (u32, u32) {
    match rng.u8(..24) {
        0 => (16_384, rng.u32(1..40)),
        1 => (rng.u32(1..40), 16_384),
        2 => (0, rng.u32(..)),
        3 => (rng.u32(16_385..), rng.u32(1..100)),
        4 => (1, 1),
        5..8 => (rng.u32(1..12) * 32, rng.u32(1..40) * 8),
        8..12 => (rng.u32(1..600), rng.u32(1..600)),
        _ => (rng.u32(1..200), rng.u32(1..200)),
    }
}
