//! Merges one buffer into another of the same size, following the 2018 extension of Hasselgren and others, "Masked
//! Software Occlusion Culling", for terrain and foreground drawn separately: the layers of the other tile are inserted
//! like triangles, from far to near.

use super::rules::{Planes, Rule, with_rule};
use super::tile::choose;
use super::{Buffer, ClearState, Region, SUB_TILES, TilePlace, load};
use crate::simd::{self, Job, Level, Simd};

/// Merges buffers into a region of another, one after the other.
///
/// # Safety
/// All buffers have the same size, and nobody draws into the source buffers. The region begins and ends at block
/// boundaries or at the buffer's edge.
pub(crate) unsafe fn merge(level: Level, into: Region<'_>, from: &[&Buffer]) {
    simd::run(level, Merge { into, from });
}

struct Merge<'a> {
    into: Region<'a>,
    from: &'a [&'a Buffer],
}

impl Job for Merge<'_> {
    type Output = ();

    #[inline(always)]
    fn run<T: Simd>(self, s: T) {
        let (into, tiles) = (self.into.buffer(), self.into.tiles());
        // Row by row rather than buffer by buffer, so that the destination row stays in the L1 cache.
        for y in (tiles.y0..tiles.y1).step_by(T::LANES / SUB_TILES) {
            for from in self.from {
                let row = Row { into, from, columns: tiles.x0..tiles.x1, y };
                with_rule!(into.rule(), R => {
                    if into.rule() == from.rule() { row.merge::<T, R, true>(s) } else { row.merge::<T, R, false>(s) }
                });
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
    /// `ALIKE`: the other buffer has the rule `R` too, as it nearly always does.
    #[inline(always)]
    fn merge<T: Simd, R: Rule, const ALIKE: bool>(self, s: T) {
        let Self { into, from, columns, y } = self;
        for x in columns {
            // SAFETY: by the contract of `merge`, it is a tile of both buffers, and where vectors cover a
            // block, `y` is the block's row. The region carries exclusive access. Both buffers were made
            // for their rules.
            unsafe {
                let other = TilePlace::new(from, x, y);
                if ClearState::of::<T>(other).none_drawn() {
                    continue;
                }
                let at = TilePlace::new(into, x, y);
                let mut planes = load::<T, R>(s, into, at, || y);
                let Layered { planes: theirs, layers, count } = if ALIKE {
                    load_layers::<T, R>(s, from, other, y)
                } else {
                    // Chosen per tile, so that the code grows with the number of rules and not with its square.
                    with_rule!(from.rule(), O => load_layers::<T, O>(s, from, other, y))
                };
                // Depths behind the reference have no effect.
                let nearest = s.max_positive(theirs.z0, theirs.z_near);
                if s.all(s.le(nearest, planes.z0)) {
                    continue;
                }
                // If all of the other sub-tile is nearer than everything here, it is copied unchanged. Tested lane by
                // lane, so that the bits do not depend on the number of lanes.
                let taken = s.lt(s.max_positive(planes.z0, planes.z_near), theirs.z0);
                if ALIKE && s.all(taken) {
                    planes = theirs;
                } else {
                    for &(mask, z) in &layers[..count] {
                        R::insert(s, &mut planes, mask, z);
                    }
                    if ALIKE {
                        planes = choose(s, taken, &theirs, &planes);
                    }
                }
                R::store(s, at.planes, &planes);
                s.store_z_min(at.z_min, at.pitch, planes.z0);
            }
        }
    }
}

/// A tile's sub-tiles, and their layers from far to near, of which the rule has `count`.
struct Layered<T: Simd> {
    planes: Planes<T>,
    layers: [(T::I, T::F); 4],
    count: usize,
}

/// # Safety
/// As [`load`]: it is a tile of the buffer, which was made for the rule, and nobody writes it.
#[inline(always)]
unsafe fn load_layers<T: Simd, R: Rule>(s: T, buffer: &Buffer, at: TilePlace, y: u32) -> Layered<T> {
    // SAFETY: the caller's contract.
    let planes = unsafe { load::<T, R>(s, buffer, at, || y) };
    Layered { layers: R::layers(s, &planes), planes, count: R::LAYERS }
}
