//! Vertices page by page: of a chunk whose indices lie in several places, the pages of sixteen vertices that it names.
//!
//! A table says for each page where in the scratch it is; the corners of the chunk are renumbered on the way.

use super::scratch::{CHUNK_VERTICES, NOT_LOADED, PAGES, PageTable, Scratch};
use super::vertex_reader::VertexReader;
use crate::geometry::{Camera, project};
use crate::simd::{MAX_LANES, Simd};

/// Vertices of a page, as many as the widest vector has lanes.
const PAGE: usize = MAX_LANES;
const PAGE_SHIFT: u32 = PAGE.trailing_zeros();
/// Pages that the scratch holds; the first vertices of the scratch are room for the last page of a mesh, see below.
const SLOTS: usize = CHUNK_VERTICES / PAGE;
/// With fewer triangles a page the vertices are better projected one by one.
const TRIANGLES_PER_PAGE: usize = 4;

/// Pages that a chunk names, in the order of their slots.
struct Named {
    pages: [u16; SLOTS],
    count: usize,
}

/// Renumbers the corners of as many triangles as there is room for, from 1 up, and lists their pages, that of the
/// largest index first. Nothing: too far apart, or too few triangles.
fn renumber(indices: &[u32], least: u32, largest: u32, scratch: &mut Scratch) -> Option<(usize, Named)> {
    let page_of = |index: u32| ((index - least) >> PAGE_SHIFT) as usize;
    if page_of(largest) >= PAGES {
        return None;
    }
    let (table, local) = (PageTable::of(&mut scratch.table), &mut scratch.local);
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
            // One page of room before the first slot.
            local.write(((u32::from(*slot) + 1) << PAGE_SHIFT) + ((index - least) & (PAGE as u32 - 1)));
        }
        triangles += 1;
    }
    for &page in &named.pages[..named.count] {
        table[usize::from(page)] = NOT_LOADED;
    }
    (triangles >= TRIANGLES_PER_PAGE * named.count).then_some((triangles, named))
}

/// How many vertices the page that begins with `first` has beyond `largest`, which is on it.
fn beyond(first: u32, largest: u32) -> u32 {
    // Not `first + PAGE`, which the largest of all indices overflow.
    PAGE as u32 - 1 - (largest - first)
}

impl<S: Simd> VertexReader<S> {
    /// Projects the pages that the first triangles name, whose number it returns, and renumbers their corners; if that
    /// pays.
    ///
    /// # Safety
    /// The vertices from the least to the largest index, of which there are more than a page, can be read.
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
            // The page of the largest index may reach beyond it: it is projected from further down, and what comes
            // before it goes to the room before its slot, which is the first.
            let early = if slot == 0 { beyond(first, largest) } else { 0 };
            let to = (slot + 1) * PAGE - early as usize;
            let mut at = 0;
            while at < PAGE {
                // SAFETY: the caller's contract; a vertex follows every page but the first named.
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
