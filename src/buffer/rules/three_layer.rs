//! The three-layer rule, the default: a reference depth and two nested working layers.
//!
//! A triangle temporarily makes a third layer; of the three, the one whose loss costs the least depth is dropped (the
//! farthest is lost to the reference, a nearer one is merged into the next one behind it). An empty layer is stored as
//! a full one at the reference depth, so there are no special cases.
//!
//! The farthest may go only if its loss is at most the reference's own depth: at most half of its depth. With an empty
//! reference it therefore stays, and a sub-tile fills as soon as its pixels are covered, however many depths there are.

use super::{Inserted, Planes, Rule, behind_layer, behind_reference};
use crate::buffer::BLOCK;
use crate::simd::Simd;

pub(crate) struct ThreeLayer;

impl Rule for ThreeLayer {
    const PLANES: usize = 5;
    const LAYERS: usize = 3;
    const LAYER_PLANES: &[(usize, usize)] = &[(3, 1), (4, 2)];

    #[inline(always)]
    fn empty<S: Simd>(s: S) -> Planes<S> {
        let (z, full) = (s.f(0.0), s.i(-1));
        Planes { z0: z, z_near: z, z_mid: z, z_far: z, near: full, mid: s.i(0), far: full }
    }

    #[inline(always)]
    unsafe fn load<S: Simd>(s: S, p: *const u32) -> Planes<S> {
        // SAFETY: the caller's contract.
        unsafe {
            Planes {
                z0: s.load_f(p.cast()),
                z_near: s.load_f(p.add(BLOCK).cast()),
                z_far: s.load_f(p.add(2 * BLOCK).cast()),
                near: s.load_i(p.add(3 * BLOCK)),
                far: s.load_i(p.add(4 * BLOCK)),
                ..Self::empty(s)
            }
        }
    }

    #[inline(always)]
    unsafe fn store<S: Simd>(s: S, p: *mut u32, planes: &Planes<S>) {
        // SAFETY: the caller's contract.
        unsafe {
            s.store_f(p.cast(), planes.z0);
            s.store_f(p.add(BLOCK).cast(), planes.z_near);
            s.store_f(p.add(2 * BLOCK).cast(), planes.z_far);
            s.store_i(p.add(3 * BLOCK), planes.near);
            s.store_i(p.add(4 * BLOCK), planes.far);
        }
    }

    #[inline(always)]
    fn insert<S: Simd>(s: S, planes: &mut Planes<S>, c: S::I, depth: S::F) -> Inserted<S> {
        let Planes { z0, z_near, z_far, near, far, .. } = *planes;
        // A lane without pixels inserts behind everything, which has no effect; so does a depth behind the reference.
        // Nothing here depends on which lanes are alive: consecutive triangles often meet in the same tile, and the
        // next one has to wait for the values stored here.
        let t = s.select(s.eq_i(c, s.i(0)), s.f(0.0), depth);
        let nearer_than_near = s.lt(z_near, t);
        let nearer_than_far = s.lt(z_far, t);
        // Three candidate layers and their pixels, nearest first.
        let mask_a = s.select_i(nearer_than_near, c, near);
        let mask_b = s.select_i(nearer_than_far, s.or(near, c), far);
        let mask_c = s.or(far, c);
        let z_a = s.max_positive(z_near, t);
        let z_b = s.max_positive(z_far, s.min_positive(z_near, t));
        let z_c = s.min_positive(z_far, t);
        // The loss from dropping each: the depth down to the next layer, or nothing if that has the same pixels.
        let loss_a = s.sub(z_a, z_b);
        let loss_b = s.select(s.eq_i(mask_b, mask_a), s.f(0.0), s.sub(z_b, z_c));
        let loss_c = s.select(s.eq_i(mask_c, mask_b), s.f(0.0), s.sub(z_c, z0));
        let full = s.i(-1);
        let full_c = s.eq_i(mask_c, full);
        let drop_c = s.or_m(full_c, s.le(loss_c, s.min(s.min(loss_a, z0), loss_b)));
        // Against B, the loss of A counts as at most a third of A's depth. Otherwise B would too often be merged into a C
        // far behind it, and its pixels would lose most of their depth.
        let limited_a = s.min(loss_a, s.mul(z_a, s.f(1.0 / 3.0)));
        let drop_a = s.and_not_m(drop_c, s.le(limited_a, loss_b));
        // The nearest full layer: if a layer is full, so are those behind it.
        let nearest_full = s.select(s.eq_i(mask_b, full), z_b, z_c);
        let nearest_full = s.select(s.eq_i(mask_a, full), z_a, nearest_full);
        let risen = s.select(full_c, s.max_positive(z0, nearest_full), z0);
        *planes = Planes {
            z0: risen,
            z_near: s.select(drop_a, z_b, z_a),
            near: s.select_i(drop_a, mask_b, mask_a),
            z_far: s.select(drop_c, z_b, z_c),
            far: s.select_i(drop_c, mask_b, mask_c),
            ..*planes
        };
        Inserted { live: s.lt(z0, t), merged: s.lt(z0, risen) }
    }

    /// The triangle is one of the three candidate layers, and what is behind it is full, so the farthest always becomes
    /// the reference.
    #[inline(always)]
    fn insert_all<S: Simd>(s: S, planes: &mut Planes<S>, t: S::F) -> Inserted<S> {
        let Planes { z0, z_near, z_far, near, far, .. } = *planes;
        let full = s.i(-1);
        *planes = Planes {
            z0: s.max_positive(z0, t),
            z_near: s.max_positive(z_near, t),
            near: s.select_i(s.lt(z_near, t), full, near),
            z_far: s.max_positive(z_far, s.min_positive(z_near, t)),
            far: s.select_i(s.lt(z_far, t), full, far),
            ..*planes
        };
        let nearer = s.lt(z0, t);
        Inserted { live: nearer, merged: nearer }
    }

    #[inline(always)]
    fn hides<S: Simd>(s: S, planes: &Planes<S>, touched: S::I, depth: S::F) -> S::M {
        let reference = behind_reference(s, planes, touched, depth);
        let near = behind_layer(s, touched, depth, planes.near, planes.z_near);
        let far = behind_layer(s, touched, depth, planes.far, planes.z_far);
        s.or_m(reference, s.or_m(near, far))
    }

    #[inline(always)]
    fn layers<S: Simd>(s: S, planes: &Planes<S>) -> [(S::I, S::F); 4] {
        [(s.i(-1), planes.z0), (planes.far, planes.z_far), (planes.near, planes.z_near), (s.i(0), planes.z0)]
    }
}
