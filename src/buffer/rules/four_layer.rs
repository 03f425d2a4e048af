//! The four-layer rule: a reference depth and three nested working layers, for scenes in which many surfaces at
//! different depths meet within 8x4 pixels and are drawn unsorted.
//!
//! It works like the three-layer rule with one more layer. A triangle temporarily makes a fourth layer, and one of the
//! four is removed: if together they cover every pixel, the farthest becomes the reference; otherwise the one whose
//! loss costs the least depth goes. The farthest is lost to the reference; a nearer one is merged into the next one
//! behind it, whose pixels already include its own because the masks are nested; one without pixels of its own costs
//! nothing. The farthest may go only if its loss is at most the reference's own depth. An empty layer is stored as a
//! full one at the reference depth, so there are no special cases.
//!
//! It gives sub-tiles more time to fill: with two layers, and often with three, a sub-tile covered by four or more
//! small pieces has to give up depth before it is full. It costs 8 bytes per sub-tile, and two more planes to load and
//! store in each tile drawn into. A fifth layer adds little. Figures are in `docs/rules.md`.

use super::{Inserted, Planes, Rule, behind_layer, behind_reference};
use crate::buffer::BLOCK;
use crate::simd::Simd;

pub(crate) struct FourLayer;

impl Rule for FourLayer {
    const PLANES: usize = 7;
    const LAYERS: usize = 4;
    const LAYER_PLANES: &[(usize, usize)] = &[(4, 1), (5, 2), (6, 3)];

    #[inline(always)]
    fn empty<S: Simd>(s: S) -> Planes<S> {
        let (z, full) = (s.f(0.0), s.i(-1));
        Planes { z0: z, z_near: z, z_mid: z, z_far: z, near: full, mid: full, far: full }
    }

    #[inline(always)]
    unsafe fn load<S: Simd>(s: S, p: *const u32) -> Planes<S> {
        // SAFETY: the caller's contract.
        unsafe {
            Planes {
                z0: s.load_f(p.cast()),
                z_near: s.load_f(p.add(BLOCK).cast()),
                z_mid: s.load_f(p.add(2 * BLOCK).cast()),
                z_far: s.load_f(p.add(3 * BLOCK).cast()),
                near: s.load_i(p.add(4 * BLOCK)),
                mid: s.load_i(p.add(5 * BLOCK)),
                far: s.load_i(p.add(6 * BLOCK)),
            }
        }
    }

    #[inline(always)]
    unsafe fn store<S: Simd>(s: S, p: *mut u32, planes: &Planes<S>) {
        // SAFETY: the caller's contract.
        unsafe {
            s.store_f(p.cast(), planes.z0);
            s.store_f(p.add(BLOCK).cast(), planes.z_near);
            s.store_f(p.add(2 * BLOCK).cast(), planes.z_mid);
            s.store_f(p.add(3 * BLOCK).cast(), planes.z_far);
            s.store_i(p.add(4 * BLOCK), planes.near);
            s.store_i(p.add(5 * BLOCK), planes.mid);
            s.store_i(p.add(6 * BLOCK), planes.far);
        }
    }

    #[inline(always)]
    fn insert<S: Simd>(s: S, planes: &mut Planes<S>, c: S::I, depth: S::F) -> Inserted<S> {
        let Planes { z0, z_near, z_mid, z_far, near, mid, far } = *planes;
        // A lane without pixels inserts behind everything, which has no effect; so does a depth behind the reference.
        let t = s.select(s.eq_i(c, s.i(0)), s.f(0.0), depth);
        let nearer_than_near = s.lt(z_near, t);
        let nearer_than_mid = s.lt(z_mid, t);
        let nearer_than_far = s.lt(z_far, t);
        // Four candidate layers and their pixels, nearest first.
        let mask_a = s.select_i(nearer_than_near, c, near);
        let mask_b = s.select_i(nearer_than_mid, s.or(near, c), mid);
        let mask_c = s.select_i(nearer_than_far, s.or(mid, c), far);
        let mask_d = s.or(far, c);
        let z_a = s.max_positive(z_near, t);
        let z_b = s.max_positive(z_mid, s.min_positive(z_near, t));
        let z_c = s.max_positive(z_far, s.min_positive(z_mid, t));
        let z_d = s.min_positive(z_far, t);
        // The loss from dropping each: the depth down to the next layer, or nothing if that has the same pixels.
        let nothing = s.f(0.0);
        let loss_a = s.sub(z_a, z_b);
        let loss_b = s.select(s.eq_i(mask_b, mask_a), nothing, s.sub(z_b, z_c));
        let loss_c = s.select(s.eq_i(mask_c, mask_b), nothing, s.sub(z_c, z_d));
        let loss_d = s.select(s.eq_i(mask_d, mask_c), nothing, s.sub(z_d, z0));
        let full = s.i(-1);
        let full_d = s.eq_i(mask_d, full);
        let loss_bc = s.min(loss_b, loss_c);
        let keep_d = s.and_not_m(full_d, s.lt(s.min(s.min(loss_a, z0), loss_bc), loss_d));
        let drop_a = s.and_m(keep_d, s.le(loss_a, loss_bc));
        let drop_a_or_b = s.and_m(keep_d, s.le(s.min(loss_a, loss_b), loss_c));
        // The nearest full layer: if a layer is full, so are those behind it.
        let nearest_full = s.select(s.eq_i(mask_c, full), z_c, z_d);
        let nearest_full = s.select(s.eq_i(mask_b, full), z_b, nearest_full);
        let nearest_full = s.select(s.eq_i(mask_a, full), z_a, nearest_full);
        let risen = s.select(full_d, s.max_positive(z0, nearest_full), z0);
        *planes = Planes {
            z0: risen,
            z_near: s.select(drop_a, z_b, z_a),
            near: s.select_i(drop_a, mask_b, mask_a),
            z_mid: s.select(drop_a_or_b, z_c, z_b),
            mid: s.select_i(drop_a_or_b, mask_c, mask_b),
            z_far: s.select(keep_d, z_d, z_c),
            far: s.select_i(keep_d, mask_d, mask_c),
        };
        Inserted { live: s.lt(z0, t), merged: s.lt(z0, risen) }
    }

    /// As for three layers.
    #[inline(always)]
    fn insert_all<S: Simd>(s: S, planes: &mut Planes<S>, t: S::F) -> Inserted<S> {
        let Planes { z0, z_near, z_mid, z_far, near, mid, far } = *planes;
        let full = s.i(-1);
        *planes = Planes {
            z0: s.max_positive(z0, t),
            z_near: s.max_positive(z_near, t),
            near: s.select_i(s.lt(z_near, t), full, near),
            z_mid: s.max_positive(z_mid, s.min_positive(z_near, t)),
            mid: s.select_i(s.lt(z_mid, t), full, mid),
            z_far: s.max_positive(z_far, s.min_positive(z_mid, t)),
            far: s.select_i(s.lt(z_far, t), full, far),
        };
        let nearer = s.lt(z0, t);
        Inserted { live: nearer, merged: nearer }
    }

    #[inline(always)]
    fn hides<S: Simd>(s: S, planes: &Planes<S>, touched: S::I, depth: S::F) -> S::M {
        let reference = behind_reference(s, planes, touched, depth);
        let near = behind_layer(s, touched, depth, planes.near, planes.z_near);
        let mid = behind_layer(s, touched, depth, planes.mid, planes.z_mid);
        let far = behind_layer(s, touched, depth, planes.far, planes.z_far);
        s.or_m(s.or_m(reference, near), s.or_m(mid, far))
    }

    #[inline(always)]
    fn layers<S: Simd>(s: S, planes: &Planes<S>) -> [(S::I, S::F); 4] {
        [(s.i(-1), planes.z0), (planes.far, planes.z_far), (planes.mid, planes.z_mid), (planes.near, planes.z_near)]
    }
}
