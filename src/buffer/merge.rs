//! Folds one buffer into another of the same size, after Hasselgren and others, "Masked Software
//! Occlusion Culling" as extended in 2018 for terrain and foreground drawn apart: the layers of the
//! other tile are taken in like triangles, from far to near.

use super::{
    Accurate, Buffer, FourLayer, Quick, Rule, SUB_TILES, ThreeLayer, TilePlace, TileRect, Touched, choose, load,
};
use crate::simd::{self, Job, Simd};
use crate::{Implementation, UpdateRule};

/// Folds buffers into another, one after the other, inside of a rectangle of tiles that begins and ends with blocks or at the
/// buffer's end. All are of the same size, checked by the caller.
///
/// # Safety
/// Nobody else uses the rectangle's tiles of `into`, and nobody draws into the others.
pub(crate) unsafe fn merge(implementation: Implementation, into: &Buffer, from: &[&Buffer], clip: TileRect) {
    simd::run(implementation, Merge { into, from, clip });
}

struct Merge<'a> {
    into: &'a Buffer,
    from: &'a [&'a Buffer],
    clip: TileRect,
}

impl Job for Merge<'_> {
    type Output = ();

    #[inline(always)]
    fn run<T: Simd>(self, s: T) {
        // A row of all of them, then the next: what is folded into stays in the first cache.
        for y in (self.clip.y0..self.clip.y1).step_by(T::LANES / SUB_TILES) {
            for from in self.from {
                let row = Row { into: self.into, from, columns: self.clip.x0..self.clip.x1, y };
                match self.into.rule() {
                    UpdateRule::ThreeLayer => row.into_rule::<T, ThreeLayer>(s),
                    UpdateRule::Quick => row.into_rule::<T, Quick>(s),
                    UpdateRule::Accurate => row.into_rule::<T, Accurate>(s),
                    UpdateRule::FourLayer => row.into_rule::<T, FourLayer>(s),
                }
            }
        }
    }
}

/// A row of tiles, of a vector's height.
struct Row<'a> {
    into: &'a Buffer,
    from: &'a Buffer,
    columns: core::ops::Range<u32>,
    y: u32,
}

impl Row<'_> {
    #[inline(always)]
    fn into_rule<T: Simd, R: Rule>(self, s: T) {
        match self.from.rule() {
            UpdateRule::ThreeLayer => self.tiles::<T, R, ThreeLayer>(s),
            UpdateRule::Quick => self.tiles::<T, R, Quick>(s),
            UpdateRule::Accurate => self.tiles::<T, R, Accurate>(s),
            UpdateRule::FourLayer => self.tiles::<T, R, FourLayer>(s),
        }
    }

    #[inline(always)]
    fn tiles<T: Simd, R: Rule, O: Rule>(self, s: T) {
        let Self { into, from, columns, y } = self;
        let alike = into.rule() == from.rule();
        for x in columns {
            // SAFETY: it is a tile of both buffers, which are of one size, and where vectors take a block at once, `y` is
            // the block's; the caller vouches for who else uses them; both were made for their rules.
            unsafe {
                let other = TilePlace::new(from, x, y);
                if Touched::of::<T>(other).none() {
                    continue;
                }
                let at = TilePlace::new(into, x, y);
                let mut planes = load::<T, R>(s, into, at, || y);
                let theirs = load::<T, O>(s, from, other, || y);
                // Depths behind the reference change nothing.
                let nearest = s.max_positive(theirs.z0, theirs.z_near);
                if s.all(s.le(nearest, planes.z0)) {
                    continue;
                }
                // Where all of the other is nearer than all that is here, it stays as it is. Tested lane by lane,
                // so that the bits do not depend on how many lanes there are.
                let taken = s.lt(s.max_positive(planes.z0, planes.z_near), theirs.z0);
                if alike && s.all(taken) {
                    planes = theirs;
                } else {
                    for &(mask, z) in &O::layers(s, &theirs)[..O::LAYERS] {
                        R::insert(s, &mut planes, mask, z);
                    }
                    if alike {
                        planes = choose(s, taken, &theirs, &planes);
                    }
                }
                R::store(s, at.planes, &planes);
                s.store_least(at.least, at.pitch, planes.z0);
            }
        }
    }
}
