//! Random triangles of every kind known to be hard, on the 1/256-pixel grid, with w a power of two.

use proptest::prelude::*;

use crate::oracle::{Triangle, UNIT, Vertex};

/// A kind of triangle, for a screen of some size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Uniform,
    Small,
    Tiny,
    OnCentres,
    OnCorners,
    NearHorizontal,
    NearVertical,
    Diagonal,
    FlatWide,
    HorizontalEdge,
    VerticalEdge,
    MixedScale,
    PartlyOff,
    FarOff,
    /// Corners on the screen and up to 240,000 pixels from it, where f32 can still represent every eighth unit.
    Wide,
}

/// How far from the middle of the screen, in units, a vertex may be for its projection to be exact.
fn reach(size: usize) -> i64 {
    if size.is_power_of_two() { 32_000 * UNIT - UNIT / 2 * size as i64 } else { 4_096 * UNIT }
}

fn three(
    x: impl Strategy<Value = i64> + Clone,
    y: impl Strategy<Value = i64> + Clone,
) -> impl Strategy<Value = [(i64, i64); 3]> {
    let point = (x, y);
    [point.clone(), point.clone(), point]
}

/// Corners of a kind, not yet limited to that distance.
fn corners(kind: Kind, (w, h): (usize, usize)) -> BoxedStrategy<[(i64, i64); 3]> {
    let (w, h) = (w as i64, h as i64);
    let (mx, my) = (w * UNIT, h * UNIT);
    let around = |d: i64, e: i64| {
        ((0..=mx, 0..=my), three(-d..=d, -e..=e)).prop_map(|((a, b), p)| p.map(|(x, y)| (a + x, b + y))).boxed()
    };
    match kind {
        Kind::Uniform => three(0..=mx, 0..=my).boxed(),
        Kind::Small => around(2000, 2000),
        Kind::Tiny => around(300, 300),
        Kind::OnCentres => {
            three(0..w, 0..h).prop_map(|p| p.map(|(x, y)| (x * UNIT + UNIT / 2, y * UNIT + UNIT / 2))).boxed()
        }
        Kind::OnCorners => three(0..=w, 0..=h).prop_map(|p| p.map(|(x, y)| (x * UNIT, y * UNIT))).boxed(),
        Kind::NearHorizontal => {
            (0..=my, three(0..=mx, -3..=3i64)).prop_map(|(b, p)| p.map(|(x, y)| (x, b + y))).boxed()
        }
        Kind::NearVertical => (0..=mx, three(-3..=3i64, 0..=my)).prop_map(|(a, p)| p.map(|(x, y)| (a + x, y))).boxed(),
        Kind::Diagonal => (three(0..=mx, 0..=my), 0..=1024i64, -2..=2i64, -2..=2i64)
            .prop_map(|([a, b, _], f, dx, dy)| {
                let between = |a: i64, b: i64| a + (b - a) * f / 1024;
                [a, b, (between(a.0, b.0) + dx, between(a.1, b.1) + dy)]
            })
            .boxed(),
        Kind::FlatWide => ((0..=mx / 8, mx - mx / 8..=mx, 0..=mx), 0..=my, 1..=40i64, -200..=200i64)
            .prop_map(|((x0, x1, x2), y, d, e)| [(x0, y), (x1, y + d), (x2, y + e)])
            .boxed(),
        Kind::HorizontalEdge => (three(0..=mx, 0..=my), 0..3usize)
            .prop_map(|(mut p, k)| {
                p[k].1 = p[(k + 1) % 3].1;
                p
            })
            .boxed(),
        Kind::VerticalEdge => (three(0..=mx, 0..=my), 0..3usize)
            .prop_map(|(mut p, k)| {
                p[k].0 = p[(k + 1) % 3].0;
                p
            })
            .boxed(),
        Kind::MixedScale => {
            let offset = || prop_oneof![-4..=4i64, -300..=300i64, -4000..=4000i64, -4 * mx..=4 * mx];
            let step = (offset(), offset());
            ((0..=mx, 0..=my), step.clone(), step)
                .prop_map(|(a, p, q)| [a, (a.0 + p.0, a.1 + p.1), (a.0 + q.0, a.1 + q.1)])
                .boxed()
        }
        Kind::PartlyOff => three(-mx..=2 * mx, -my..=2 * my).boxed(),
        Kind::Wide => {
            let axis = |size: i64| {
                let far = (-240_000 * UNIT / 8..=240_000 * UNIT / 8).prop_map(|v| v * 8);
                prop_oneof![2 => 0..=size, 3 => far].boxed()
            };
            three(axis(mx), axis(my)).boxed()
        }
        Kind::FarOff => three(-32_000 * UNIT..=32_000 * UNIT, -32_000 * UNIT..=32_000 * UNIT).boxed(),
    }
}

/// Triangles of a kind on a screen of `size`, each vertex with its own w from 1 to 64.
pub fn of_kind(kind: Kind, size: (usize, usize)) -> BoxedStrategy<Triangle> {
    let keep = move |v: i64, size: usize| {
        let (middle, reach) = (UNIT / 2 * size as i64, reach(size));
        let wide = kind == Kind::Wide && size.is_power_of_two();
        if wide { v } else { v.clamp(middle - reach, middle + reach) }
    };
    (corners(kind, size), [0..=6i32, 0..=6, 0..=6])
        .prop_map(move |(p, k)| {
            let vertex = |i: usize| Vertex { x: keep(p[i].0, size.0), y: keep(p[i].1, size.1), z: (0.5f64).powi(k[i]) };
            [vertex(0), vertex(1), vertex(2)]
        })
        .boxed()
}

/// Triangles of any kind.
pub fn of_any_kind(size: (usize, usize)) -> BoxedStrategy<Triangle> {
    use Kind::*;
    let kinds = [
        Uniform,
        Small,
        Tiny,
        OnCentres,
        OnCorners,
        NearHorizontal,
        NearVertical,
        Diagonal,
        FlatWide,
        MixedScale,
        PartlyOff,
    ];
    proptest::strategy::Union::new(kinds.map(|kind| of_kind(kind, size))).boxed()
}
