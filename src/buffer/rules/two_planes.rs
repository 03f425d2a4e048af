//! The memory layout of the rules with one working layer.

/// Loads and stores of the two rules that have one working layer, in `near`.
macro_rules! two_plane_layout {
    () => {
        const PLANES: usize = 3;
        const LAYERS: usize = 2;
        const LAYER_PLANES: &[(usize, usize)] = &[(2, 1)];

        #[inline(always)]
        fn empty<S: Simd>(s: S) -> Planes<S> {
            let (z, none) = (s.f(0.0), s.i(0));
            Planes { z0: z, z_near: z, z_mid: z, z_far: z, near: none, mid: none, far: none }
        }

        #[inline(always)]
        unsafe fn load<S: Simd>(s: S, p: *const u32) -> Planes<S> {
            // SAFETY: the caller's contract.
            let (z0, z_near, near) =
                unsafe { (s.load_f(p.cast()), s.load_f(p.add(BLOCK).cast()), s.load_i(p.add(2 * BLOCK))) };
            Planes { z0, z_near, near, ..Self::empty(s) }
        }

        #[inline(always)]
        unsafe fn store<S: Simd>(s: S, p: *mut u32, planes: &Planes<S>) {
            // SAFETY: the caller's contract.
            unsafe {
                s.store_f(p.cast(), planes.z0);
                s.store_f(p.add(BLOCK).cast(), planes.z_near);
                s.store_i(p.add(2 * BLOCK), planes.near);
            }
        }

        #[inline(always)]
        fn hides<S: Simd>(s: S, planes: &Planes<S>, touched: S::I, depth: S::F) -> S::M {
            let reference = $crate::buffer::rules::behind_reference(s, planes, touched, depth);
            s.or_m(reference, $crate::buffer::rules::behind_layer(s, touched, depth, planes.near, planes.z_near))
        }

        #[inline(always)]
        fn layers<S: Simd>(s: S, planes: &Planes<S>) -> [(S::I, S::F); 4] {
            [(s.i(-1), planes.z0), (planes.near, planes.z_near), (s.i(0), planes.z0), (s.i(0), planes.z0)]
        }
    };
}
pub(super) use two_plane_layout;
