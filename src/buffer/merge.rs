//! Folds one buffer into another of the same size, after Hasselgren and others, "Masked Software
//! Occlusion Culling" as extended in 2018 for terrain and foreground drawn apart: the layers of the
//! other tile are taken in like triangles, from far to near.

use super::{Accurate, Buffer, Quick, Rule, ThreeLayer, UNTOUCHED, fresh};
use crate::simd::{self, Job, Simd};
use crate::{Implementation, UpdateRule};

/// The two are of the same size, checked by the caller.
pub(crate) fn merge(implementation: Implementation, into: &mut Buffer, from: &Buffer) {
    assert_eq!((into.width(), into.height()), (from.width(), from.height()));
    simd::run(implementation, Merge { into, from });
}

struct Merge<'a> {
    into: &'a mut Buffer,
    from: &'a Buffer,
}

impl Job for Merge<'_> {
    type Output = ();

    #[inline(always)]
    fn run<T: Simd, W: Simd>(self, s: T, _: W) {
        match self.into.rule() {
            UpdateRule::ThreeLayer => self.into_rule::<T, ThreeLayer>(s),
            UpdateRule::Quick => self.into_rule::<T, Quick>(s),
            UpdateRule::Accurate => self.into_rule::<T, Accurate>(s),
        }
    }
}

impl Merge<'_> {
    #[inline(always)]
    fn into_rule<T: Simd, R: Rule>(self, s: T) {
        match self.from.rule() {
            UpdateRule::ThreeLayer => self.tiles::<T, R, ThreeLayer>(s),
            UpdateRule::Quick => self.tiles::<T, R, Quick>(s),
            UpdateRule::Accurate => self.tiles::<T, R, Accurate>(s),
        }
    }

    #[inline(always)]
    fn tiles<T: Simd, R: Rule, O: Rule>(self, s: T) {
        let tiles = self.into.all_tiles();
        for y in 0..tiles.y1 {
            for x in 0..tiles.x1 {
                let index = (y * tiles.x1 + x) as usize;
                // SAFETY: `index` is a tile of both buffers, which are of one size; `into` is exclusive,
                // `from` is not written while it is borrowed; both were made for their rules.
                unsafe {
                    if *self.from.least().add(index) == UNTOUCHED {
                        continue;
                    }
                    let least = self.into.least().add(index);
                    let mut planes = if *least == UNTOUCHED {
                        fresh::<T, R>(s, self.into.border(x, y))
                    } else {
                        R::load(s, self.into.tile(index))
                    };
                    let layers = O::layers(s, &O::load(s, self.from.tile(index)));
                    for &(mask, z) in &layers[..O::LAYERS] {
                        R::insert(s, &mut planes, mask, z);
                    }
                    R::store(s, self.into.tile(index), &planes);
                    *least = s.least(planes.z0);
                }
            }
        }
    }
}
