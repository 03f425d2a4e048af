//! The quick rule: Hasselgren, Andersson, Akenine-Möller, "Masked Software Occlusion Culling", HPG 2016, section 3.2.
//! One working layer; a triangle far in front of it starts a new one.

use super::{Inserted, Planes, Rule, live, two_planes::two_plane_layout};
use crate::buffer::BLOCK;
use crate::simd::Simd;

pub(crate) struct Quick;

impl Rule for Quick {
    two_plane_layout!();

    #[inline(always)]
    fn insert<S: Simd>(s: S, planes: &mut Planes<S>, c: S::I, depth: S::F) -> Inserted<S> {
        let Planes { z0, z_near: z1, near: mask, .. } = *planes;
        let live = live(s, z0, c, depth);
        // A jump in depth means another object, so the layer is replaced. But not while the reference is empty, because
        // then the layer would be lost for nothing.
        let jump = s.lt(s.sub(z1, z0), s.sub(depth, z1));
        let discard = s.and_m(s.lt(s.f(0.0), z0), jump);
        // A triangle that covers everything by itself does not need the layer.
        let alone = s.or_m(s.eq_i(mask, s.i(0)), s.eq_i(c, s.i(-1)));
        let anew = s.or_m(discard, alone);
        let z = s.select(anew, depth, s.min(z1, depth));
        let m = s.select_i(anew, c, s.or(mask, c));
        let full = s.and_m(live, s.eq_i(m, s.i(-1)));
        // A full layer becomes the reference and leaves an empty one.
        planes.z0 = s.select(full, z, z0);
        planes.z_near = s.select(full, s.f(0.0), s.select(live, z, z1));
        planes.near = s.select_i(full, s.i(0), s.select_i(live, m, mask));
        Inserted { live, merged: full }
    }
}
