//! Update rules: how the sub-tiles of a tile record a triangle and how they answer a query. A rule is one file and one
//! line of [`with_rule`].

mod accurate;
mod four_layer;
mod quick;
#[cfg(test)]
mod tests;
mod three_layer;

pub(crate) use accurate::Accurate;
pub(crate) use four_layer::FourLayer;
pub(crate) use quick::Quick;
pub(crate) use three_layer::ThreeLayer;

use crate::simd::Simd;

/// Evaluates an expression with `$R` as the type of an update rule: the only place that distinguishes the rules.
macro_rules! with_rule {
    ($rule:expr, $R:ident => $body:expr) => {
        $crate::buffer::rules::with_rule!(@each $rule, $R => $body; ThreeLayer Quick Accurate FourLayer)
    };
    (@each $rule:expr, $R:ident => $body:expr; $($name:ident)*) => {
        match $rule {
            $($crate::UpdateRule::$name => {
                type $R = $crate::buffer::rules::$name;
                $body
            })*
        }
    };
}
pub(crate) use with_rule;

/// The sub-tiles of a tile, one per lane. `z0` is the reference depth: no pixel is farther. The pixels in `near` are at
/// least as near as `z_near`; the far layer (three- and four-layer rules) and the middle layer (four-layer rule) work
/// the same way. The layers are nested: the near pixels are among the middle ones, and those among the far ones.
pub(crate) struct Planes<S: Simd> {
    pub z0: S::F,
    pub z_near: S::F,
    pub z_mid: S::F,
    pub z_far: S::F,
    pub near: S::I,
    pub mid: S::I,
    pub far: S::I,
}

/// The effect of inserting a triangle, per lane.
pub(crate) struct Inserted<S: Simd> {
    /// The triangle covers a pixel here and is nearer than the reference depth was.
    pub live: S::M,
    /// The reference depth rose.
    pub merged: S::M,
}

/// An update rule.
pub(crate) trait Rule {
    const PLANES: usize;
    /// How many of `layers` there are.
    const LAYERS: usize;
    /// For each layer in front of the reference: the planes of its mask and of its depth. Plane 0 is the reference
    /// depth.
    const LAYER_PLANES: &[(usize, usize)];

    /// A tile into which nothing has been drawn.
    fn empty<S: Simd>(s: S) -> Planes<S>;

    /// # Safety
    /// `PLANES` vectors can be read from `p` on, [`BLOCK`](super::BLOCK) words apart.
    unsafe fn load<S: Simd>(s: S, p: *const u32) -> Planes<S>;

    /// # Safety
    /// As [`Self::load`], but for writing.
    unsafe fn store<S: Simd>(s: S, p: *mut u32, planes: &Planes<S>);

    /// Inserts the pixels `coverage`, each at least as near as `depth`. Afterwards no stored bound is nearer than what
    /// was drawn.
    fn insert<S: Simd>(s: S, planes: &mut Planes<S>, coverage: S::I, depth: S::F) -> Inserted<S>;

    /// Inserts all pixels at `depth` without reading the whole tile, if that depth is nearer than everything in it.
    /// Returns false, having done nothing, if it is not.
    ///
    /// # Safety
    /// As [`Self::store`].
    unsafe fn replace<S: Simd>(s: S, p: *mut u32, depth: S::F) -> bool;

    /// Lanes in which anything at `depth` or farther, in the pixels `touched`, is certainly hidden. Lanes that touch no
    /// pixel count as hidden.
    fn hides<S: Simd>(s: S, planes: &Planes<S>, touched: S::I, depth: S::F) -> S::M;

    /// The layers from far to near, for insertion into another buffer; those beyond `LAYERS` are empty.
    fn layers<S: Simd>(s: S, planes: &Planes<S>) -> [(S::I, S::F); 4];
}

/// Lanes in which `coverage` has a pixel and `depth` is nearer than `z0`.
#[inline(always)]
pub(super) fn live<S: Simd>(s: S, z0: S::F, coverage: S::I, depth: S::F) -> S::M {
    s.and_not_m(s.eq_i(coverage, s.i(0)), s.lt(z0, depth))
}

/// Lanes hidden by a layer: `touched` is a subset of its pixels, and `depth` is farther.
#[inline(always)]
pub(super) fn behind_layer<S: Simd>(s: S, touched: S::I, depth: S::F, mask: S::I, z: S::F) -> S::M {
    s.and_m(s.eq_i(s.and_not(mask, touched), s.i(0)), s.lt(depth, z))
}

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
        unsafe fn replace<S: Simd>(s: S, p: *mut u32, depth: S::F) -> bool {
            // SAFETY: the caller's contract.
            unsafe {
                let (z0, z_near) = (s.load_f(p.cast()), s.load_f(p.add(BLOCK).cast()));
                if !s.all(s.and_m(s.lt(z0, depth), s.lt(z_near, depth))) {
                    return false;
                }
                // The result that the rule would give: the reference covers everything, and the layer is empty.
                let planes = Planes { z0: depth, z_near: Self::left_behind(s, depth), ..Self::empty(s) };
                Self::store(s, p, &planes);
                true
            }
        }

        #[inline(always)]
        fn hides<S: Simd>(s: S, planes: &Planes<S>, touched: S::I, depth: S::F) -> S::M {
            let nothing = s.eq_i(touched, s.i(0));
            let reference = s.or_m(nothing, s.lt(depth, planes.z0));
            s.or_m(reference, $crate::buffer::rules::behind_layer(s, touched, depth, planes.near, planes.z_near))
        }

        #[inline(always)]
        fn layers<S: Simd>(s: S, planes: &Planes<S>) -> [(S::I, S::F); 4] {
            [(s.i(-1), planes.z0), (planes.near, planes.z_near), (s.i(0), planes.z0), (s.i(0), planes.z0)]
        }
    };
}
use two_plane_layout;
