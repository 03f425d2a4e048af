//! Projects vertices by pages: for a chunk whose indices lie in several places, only the pages of sixteen vertices that
//! contain an index.
//!
//! A table gives the slot of each page in the scratch; the corners of the chunk are renumbered accordingly.

use super::scratch::{CHUNK_VERTICES, NOT_LOADED, PAGES, PageTable, Scratch};
use super::vertex_reader::VertexReader;
use crate::geometry::{Camera, project};
use crate::simd::{MAX_LANES, Simd};

/// Vertices per page, as many as the widest vector has lanes.
const PAGE: usize = MAX_LANES;
const PAGE_SHIFT: u32 = PAGE.trailing_zeros();
/// Pages that the scratch holds; the first vertices of the scratch are reserved for the last page of a mesh, see below.
const SLOTS: usize = CHUNK_VERTICES / PAGE;
/// With fewer triangles per page, projecting the vertices one by one is faster.
const TRIANGLES_PER_PAGE: usize = 4;

/// The pages that a chunk uses, in the order of their slots.
struct Named {
    pages: [u16; SLOTS],
    count: usize,
}

/// Renumbers the corners of as many triangles as there is room for, starting at 1, and lists their pages, that of the
/// largest index first. `None` if the indices are too far apart or the triangles too few.
fn renumber(indices: &[u32], least: u32, largest: u32, scratch: &mut Scratch) -> Option<(usize, Named)> {
    let page_of = |index: u32| ((index - least) >> PAGE_SHIFT) as usize;
    if page_of(largest) >= PAGES {
        return None;
    }
    // SAFETY: a reference to a scratch comes from `Scratch::of`.
    let (table, local) = (unsafe { PageTable::of(&mut scratch.table) }, &mut scratch.local);
    let mut named = Named { pages: [0; SLOTS], count: 1 };
    named.pages[0] = page_of(largest) as u16;
    table[page_of(largest)] = 0;
    let mut triangles = 0;
    for (corners, local) in indices.chunks_exact(3).zip(local.chunks_exact_mut(3)) {
        if named.count + 3 > SLOTS {
            break;
        }
        for (&index, local) in corners.iter().zip(local) {
            let slot = &mut table[page_of(index)];
            if *slot == NOT_LOADED {
                *slot = named.count as u16;
                named.pages[named.count] = page_of(index) as u16;
                named.count += 1;
            }
            // One page is reserved before the first slot.
            local.write(((u32::from(*slot) + 1) << PAGE_SHIFT) + ((index - least) & (PAGE as u32 - 1)));
        }
        triangles += 1;
    }
    for &page in &named.pages[..named.count] {
        table[usize::from(page)] = NOT_LOADED;
    }
    (triangles >= TRIANGLES_PER_PAGE * named.count).then_some((triangles, named))
}

/// How many vertices of the page that begins with `first` lie beyond `largest`, which is on it.
fn beyond(first: u32, largest: u32) -> u32 {
    // Not `first + PAGE`, which would overflow for the largest index.
    PAGE as u32 - 1 - (largest - first)
}

impl<S: Simd> VertexReader<S> {
    /// If it pays, projects the pages that the first triangles use and renumbers their corners; returns the number of
    /// these triangles.
    ///
    /// # Safety
    /// The vertices from the least to the largest index, more than a page of them, can be read.
    #[inline(always)]
    pub unsafe fn paged(
        &self,
        camera: &Camera,
        indices: &[u32],
        (least, largest): (u32, u32),
        scratch: &mut Scratch,
    ) -> Option<usize> {
        if ((largest - least) as usize) < PAGE {
            return None;
        }
        let (triangles, named) = renumber(indices, least, largest, scratch)?;
        for slot in 0..named.count {
            let first = least + (u32::from(named.pages[slot]) << PAGE_SHIFT);
            // The page of the largest index may extend past it. It is then projected from further down, and the surplus
            // goes to the space reserved before its slot, which is the first.
            let early = if slot == 0 { beyond(first, largest) } else { 0 };
            let to = (slot + 1) * PAGE - early as usize;
            let mut at = 0;
            while at < PAGE {
                // SAFETY: the caller's contract; every page except the first listed one is followed by another vertex.
                unsafe {
                    let whole = slot != 0 || at + S::LANES < PAGE;
                    let v = project(self.s, camera, self.load(first - early + at as u32, whole));
                    self.s.store_records(scratch.vertex(to + at), v);
                }
                at += S::LANES;
            }
        }
        Some(triangles)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_page_ends_with_the_largest_index() {
        for (first, largest, expected) in
            [(0, 15, 0), (32, 32, 15), (u32::MAX - 15, u32::MAX, 0), (u32::MAX - 3, u32::MAX, 12)]
        {
            assert_eq!(beyond(first, largest), expected, "{first} {largest}");
        }
    }
}
