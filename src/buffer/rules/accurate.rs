//! The accurate rule, after Andersson, Hasselgren, Akenine-Möller, "Masked Depth Culling for Graphics Hardware", 2015:
//! of the reference, the working layer and the triangle, the two that are closest in depth are merged.

use super::{Inserted, Planes, Rule, live, two_planes::two_plane_layout};
use crate::buffer::BLOCK;
use crate::simd::Simd;

pub(crate) struct Accurate;

impl Rule for Accurate {
    two_plane_layout!();

    #[inline(always)]
    fn insert<S: Simd>(s: S, planes: &mut Planes<S>, c: S::I, depth: S::F) -> Inserted<S> {
        let Planes { z0, z_near: z1, near: mask, .. } = *planes;
        // Pixels of the layer that are already nearer gain nothing.
        let nearer_is_triangle = s.lt(z1, depth);
        let c = s.select_i(nearer_is_triangle, c, s.and_not(mask, c));
        let live = live(s, z0, c, depth);
        // Nothing of the layer remains if the triangle covers it.
        let gone = s.and_m(nearer_is_triangle, s.eq_i(s.and_not(c, mask), s.i(0)));
        let both = s.or(mask, c);
        let farther = s.min(z1, depth);
        // Together they cover everything: the farther one becomes the reference, and the nearer one stays.
        let full = s.and_m(live, s.eq_i(both, s.i(-1)));
        let triangle_to_layer = s.abs(s.sub(depth, z1));
        let layer_to_reference = s.sub(z1, z0);
        // A triangle is never dropped in favour of an empty reference.
        let vacant = s.eq(z0, s.f(0.0));
        let triangle_to_reference = s.select(vacant, s.f(f32::MAX), s.sub(depth, z0));
        let closest =
            s.and_m(s.lt(layer_to_reference, triangle_to_layer), s.le(layer_to_reference, triangle_to_reference));
        let replace = s.or_m(gone, closest);
        let join = s.and_not_m(replace, s.le(triangle_to_layer, triangle_to_reference));
        // Otherwise the triangle is closest to the reference and is dropped.
        let z = s.select(replace, depth, s.select(join, farther, z1));
        let m = s.select_i(replace, c, s.select_i(join, both, mask));
        // A layer that is full by itself leaves nothing in front of it to keep.
        let z_kept = s.max(z1, depth);
        let m_kept = s.select_i(nearer_is_triangle, c, mask);
        let alone = s.eq_i(m_kept, s.i(-1));
        let z_full = s.select(alone, z_kept, farther);
        planes.z0 = s.select(full, z_full, z0);
        planes.z_near = s.select(full, z_kept, s.select(live, z, z1));
        planes.near = s.select_i(full, s.select_i(alone, s.i(0), m_kept), s.select_i(live, m, mask));
        Inserted { live, merged: full }
    }
}
