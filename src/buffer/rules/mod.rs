//! Update rules: how the sub-tiles of a tile record a triangle and how they answer a query. A rule is one file and one
//! line of [`with_rule`].

#[cfg(feature = "accurate")]
mod accurate;
#[cfg(feature = "four-layer")]
mod four_layer;
#[cfg(feature = "quick")]
mod quick;
#[cfg(all(test, feature = "quick", feature = "accurate", feature = "four-layer"))]
mod tests;
mod three_layer;
#[cfg(any(feature = "quick", feature = "accurate"))]
mod two_planes;

#[cfg(feature = "accurate")]
pub(crate) use accurate::Accurate;
#[cfg(feature = "four-layer")]
pub(crate) use four_layer::FourLayer;
#[cfg(feature = "quick")]
pub(crate) use quick::Quick;
pub(crate) use three_layer::ThreeLayer;

use crate::simd::Simd;

/// Evaluates an expression with `$R` as the type of an update rule: the only place that distinguishes the rules. No
/// object has a rule whose feature is off.
macro_rules! with_rule {
    ($rule:expr, $R:ident => $body:expr) => {
        $crate::buffer::rules::with_rule!(
            @each $rule, $R => $body;
            ThreeLayer() Quick("quick") Accurate("accurate") FourLayer("four-layer")
        )
    };
    (@each $rule:expr, $R:ident => $body:expr; $($name:ident($($feature:literal)?))*) => {
        match $rule {
            $($(#[cfg(feature = $feature)])?
            $crate::UpdateRule::$name => {
                type $R = $crate::buffer::rules::$name;
                $body
            })*
            #[allow(unreachable_patterns)]
            _ => unreachable!("an update rule whose feature is off"),
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

    /// As [`Self::insert`] with all pixels covered, for which fewer operations suffice.
    #[inline(always)]
    fn insert_all<S: Simd>(s: S, planes: &mut Planes<S>, depth: S::F) -> Inserted<S> {
        Self::insert(s, planes, s.i(-1), depth)
    }

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

/// Lanes hidden by the reference depth, or that touch no pixel.
#[inline(always)]
pub(super) fn behind_reference<S: Simd>(s: S, planes: &Planes<S>, touched: S::I, depth: S::F) -> S::M {
    s.or_m(s.eq_i(touched, s.i(0)), s.lt(depth, planes.z0))
}

/// Lanes hidden by a layer: `touched` is a subset of its pixels, and `depth` is farther.
#[inline(always)]
pub(super) fn behind_layer<S: Simd>(s: S, touched: S::I, depth: S::F, mask: S::I, z: S::F) -> S::M {
    s.and_m(s.eq_i(s.and_not(mask, touched), s.i(0)), s.lt(depth, z))
}
