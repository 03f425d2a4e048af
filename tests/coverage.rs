//! Single triangles against the oracle, pixel by pixel: coverage is exact, and depth is never too near and never
//! uselessly far, for every hard kind, at small, common and extreme sizes, on every instruction set, in both row
//! directions.

mod oracle;
mod support;

use std::cell::RefCell;

use masked_occlusion_culling::MaskedOcclusionCulling;
use oracle::{Oracle, Triangle};
use support::triangles::{Kind, of_kind};
use support::{check, clip_vertex, compare_one, draw, name, objects, read};

/// Sizes and the number of cases for each: reading back a larger buffer takes longer.
const SIZES: [((usize, usize), u32); 8] = [
    ((1, 1), 200),
    ((7, 5), 300),
    ((33, 9), 300),
    ((512, 512), 50),
    ((1920, 1080), 5),
    ((4096, 64), 40),
    ((16384, 32), 20),
    ((32, 16384), 20),
];

fn compare(
    moc: &mut MaskedOcclusionCulling,
    t: &Triangle,
    oracle: &Oracle,
    depth: &mut Vec<f32>,
) -> Result<(), String> {
    moc.clear_buffer();
    draw(moc, &[*t]);
    read(moc, depth);
    compare_one(t, depth, oracle).map_err(|why| {
        let clip = t.map(|v| clip_vertex(&v, (oracle.width, oracle.height), moc.y_axis()));
        format!("{}: {why}\nclip space (x, y, z, w): {clip:?}", name(moc))
    })
}

fn exact(kind: Kind) {
    for (i, (size, cases)) in SIZES.into_iter().enumerate() {
        let state = RefCell::new((objects(size), Vec::new()));
        let oracle = Oracle::new(size.0, size.1);
        check(cases, (kind as u64) << 8 | i as u64, &of_kind(kind, size), |t| {
            let (objects, depth) = &mut *state.borrow_mut();
            objects.iter_mut().try_for_each(|moc| compare(moc, &t, &oracle, depth))
        });
    }
}

macro_rules! kinds {
    ($($test:ident: $kind:ident,)*) => {
        $(#[test]
        fn $test() {
            exact(Kind::$kind);
        })*
    };
}

kinds! {
    uniform: Uniform,
    small: Small,
    tiny: Tiny,
    on_pixel_centres: OnCentres,
    on_pixel_corners: OnCorners,
    near_horizontal_slivers: NearHorizontal,
    near_vertical_slivers: NearVertical,
    diagonal_slivers: Diagonal,
    flat_wide_slivers: FlatWide,
    one_edge_horizontal: HorizontalEdge,
    one_edge_vertical: VerticalEdge,
    mixed_scale: MixedScale,
    partly_off_screen: PartlyOff,
    far_off_screen: FarOff,
    wide: Wide,
}

/// The size at which edges with a height of 1/256 pixel overflow in other implementations.
#[test]
fn slivers_at_3840x2160() {
    let size = (3840, 2160);
    let oracle = Oracle::new(size.0, size.1);
    let state = RefCell::new((objects(size), Vec::new()));
    for (seed, kind) in [Kind::FlatWide, Kind::NearHorizontal, Kind::NearVertical].into_iter().enumerate() {
        check(3, seed as u64, &of_kind(kind, size), |t| {
            let (objects, depth) = &mut *state.borrow_mut();
            objects.iter_mut().try_for_each(|moc| compare(moc, &t, &oracle, depth))
        });
    }
}
