//! Exclusive access to a part of a buffer's tiles.

use super::{Buffer, CLEARED, TileRect, hiz};
use crate::simd::{Simd, store_relaxed};

/// Exclusive access to a rectangle of tiles: while it exists, nobody else writes them. Drawing functions take a region,
/// so they can only draw where they are allowed to.
pub(crate) struct Region<'a> {
    buffer: &'a Buffer,
    tiles: TileRect,
    /// How many tiles have been drawn into since the coarse cells of the region were refreshed; `None` if the region
    /// does not consist of whole cells.
    since_refresh: Option<&'a mut u32>,
}

impl<'a> Region<'a> {
    /// All tiles of a buffer.
    #[inline(always)]
    pub fn whole(buffer: &'a mut Buffer) -> Self {
        let buffer = &*buffer;
        // SAFETY: the word belongs to the buffer, which is borrowed exclusively; nothing else refers to it.
        let since_refresh = unsafe { &mut *buffer.since_refresh() };
        Self { buffer, tiles: buffer.all_tiles(), since_refresh: Some(since_refresh) }
    }

    /// A rectangle of tiles; with `since_refresh`, it starts at a coarse cell boundary and ends at one or at the
    /// buffer's edge.
    ///
    /// # Safety
    /// While the region exists, nobody else writes its tiles (and, with `since_refresh`, its coarse cells). Others may
    /// read `z_min` word by word; anything else that they read of these tiles they must discard.
    #[inline(always)]
    pub unsafe fn new(buffer: &'a Buffer, tiles: TileRect, since_refresh: Option<&'a mut u32>) -> Self {
        Self { buffer, tiles, since_refresh }
    }

    #[inline(always)]
    pub fn buffer(&self) -> &'a Buffer {
        self.buffer
    }

    #[inline(always)]
    pub fn tiles(&self) -> TileRect {
        self.tiles
    }

    /// Whether the region consists of whole coarse cells, which are kept up to date.
    #[inline(always)]
    pub fn has_coarse_level(&self) -> bool {
        self.since_refresh.is_some()
    }

    /// Counts tiles that were drawn into, each of a vector's height.
    #[inline(always)]
    pub fn count_drawn<S: Simd>(&mut self, s: S, tiles: usize) {
        if let Some(since_refresh) = &mut self.since_refresh {
            // SAFETY: by `new` or `whole`, nobody else writes the tiles and cells.
            unsafe { hiz::count_drawn(s, self.buffer, self.tiles, tiles, since_refresh) };
        }
    }

    /// Clears the tiles to infinitely far. The region must consist of whole coarse cells.
    ///
    /// # Panics
    /// If it does not.
    pub fn clear(&mut self) {
        let Self { buffer, tiles, .. } = *self;
        **self.since_refresh.as_mut().expect("a region of whole coarse cells") = 0;
        // In whole blocks: the lower tiles of the last row may be below the screen.
        for y in tiles.y0..tiles.y1.next_multiple_of(2) {
            for x in tiles.x0..tiles.x1 {
                // SAFETY: by `new` or `whole`, nobody else writes the tiles.
                unsafe { store_relaxed(buffer.z_min_of(x, y), CLEARED) };
            }
        }
        // SAFETY: as above, and the region consists of whole cells.
        unsafe { hiz::clear(buffer, tiles) };
    }
}
