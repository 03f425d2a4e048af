//! Areas of 128x64 pixels: the least of their tiles' least depths.
//!
//! A triangle that is too large for its tiles to be looked up one by one, and that is hidden, is found so before its edges
//! are set up. Between two clears a tile's least depth only rises, so that an area may lag behind its tiles: it then lets
//! a hidden triangle through, no more. Areas are therefore brought up to date only after so many tiles were drawn into,
//! and only by whoever has the whole buffer to itself.

use super::Buffer;
use crate::simd::{MAX_LANES, Simd};

pub(crate) const AREA_TILES_W: u32 = 4;
pub(crate) const AREA_TILES_H: u32 = 8;
/// As shifts of a tile's column and row.
pub(crate) const AREA_COLUMN_SHIFT: i32 = 2;
pub(crate) const AREA_ROW_SHIFT: i32 = 3;

/// Room for the tiles of a row of the largest screen, and a vector more.
const ROW: usize = (crate::culling::MAX_SIZE / super::TILE_WIDTH) as usize + 4 * MAX_LANES;

/// Areas in a row and in a column.
pub(super) fn counts(tiles_w: u32, tiles_h: u32) -> (u32, u32) {
    (tiles_w.div_ceil(AREA_TILES_W), tiles_h.div_ceil(AREA_TILES_H))
}

/// Counts that so many more tiles, of a vector's height, were drawn into, and brings the areas up to date when there were
/// enough.
///
/// # Safety
/// Nobody else uses the buffer.
#[inline(always)]
pub(crate) unsafe fn drawn<S: Simd>(s: S, buffer: &Buffer, tiles: usize) {
    // SAFETY: the caller's contract.
    unsafe {
        let sum = *buffer.drawn() + tiles as u32;
        // As often as the work of it is small against that of the tiles: twice or half as often is alike.
        if sum < buffer.tiles_w * buffer.tiles_h / 8 {
            buffer.drawn().write(sum);
            return;
        }
        buffer.drawn().write(0);
        refresh(s, buffer);
    }
}

/// Brings the areas up to date.
///
/// # Safety
/// Nobody else uses the buffer.
#[inline(always)]
unsafe fn refresh<S: Simd>(s: S, buffer: &Buffer) {
    let (tiles_w, tiles_h) = (buffer.tiles_w as usize, buffer.tiles_h);
    let mut row = [f32::MAX; ROW];
    let mut area = buffer.areas();
    for y0 in (0..tiles_h).step_by(AREA_TILES_H as usize) {
        let y1 = (y0 + AREA_TILES_H).min(tiles_h);
        for x in (0..tiles_w).step_by(S::LANES) {
            let mut least = s.f(f32::MAX);
            for y in y0..y1 {
                // SAFETY: a tile of the buffer, and after the last there is room for a vector.
                least = s.min(least, unsafe { s.load_f(buffer.least_of(x as u32, y)) });
            }
            let least = s.select(s.first(tiles_w - x), least, s.f(f32::MAX));
            // SAFETY: the array has room for a vector after the last tile of the widest row.
            unsafe { s.store_f(row.as_mut_ptr().add(x), least) };
        }
        for x in (0..tiles_w).step_by(S::LANES * AREA_TILES_W as usize) {
            // SAFETY: there is room for four vectors in the array, and for one after the last area.
            unsafe {
                let [a, b, c, d] = s.load_quads(row.as_ptr().add(x));
                s.store_f(area.add(x / AREA_TILES_W as usize), s.min(s.min(a, b), s.min(c, d)));
            }
        }
        area = area.wrapping_add(buffer.areas_w as usize);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{self, Job};
    use crate::{Allocator, UpdateRule};

    struct Refresh<'a>(&'a Buffer);

    impl Job for Refresh<'_> {
        type Output = ();

        fn run<S: Simd>(self, s: S) {
            // SAFETY: the test has the buffer to itself.
            unsafe { refresh(s, self.0) }
        }
    }

    #[test]
    fn an_area_is_the_least_of_its_tiles() {
        let mut random = fastrand::Rng::with_seed(1);
        for &implementation in simd::available() {
            for (width, height) in [(1, 1), (33, 9), (1920, 1080), (2050, 70), (16_384, 8), (40, 16_384)] {
                let buffer = Buffer::new(width, height, UpdateRule::Quick, Allocator::default(), false).unwrap();
                let (tiles_w, tiles_h) = (buffer.tiles_w, buffer.tiles_h);
                // SAFETY (of both blocks): tiles and areas of a buffer that nobody else has.
                let least = |x, y| unsafe { *buffer.least_of(x, y) };
                for y in 0..tiles_h {
                    for x in 0..tiles_w {
                        unsafe { buffer.least_of(x, y).write(random.f32()) };
                    }
                }
                simd::run(implementation, Refresh(&buffer));
                let (areas_w, areas_h) = counts(tiles_w, tiles_h);
                for (x, y) in (0..areas_h).flat_map(|y| (0..areas_w).map(move |x| (x, y))) {
                    let columns = AREA_TILES_W * x..(AREA_TILES_W * (x + 1)).min(tiles_w);
                    let rows = AREA_TILES_H * y..(AREA_TILES_H * (y + 1)).min(tiles_h);
                    let expected = rows
                        .flat_map(|y| columns.clone().map(move |x| (x, y)))
                        .map(|(x, y)| least(x, y))
                        .fold(f32::MAX, f32::min);
                    // SAFETY: as above.
                    let area = unsafe { *buffer.areas().add((y * areas_w + x) as usize) };
                    assert_eq!(area, expected, "{implementation:?} {width}x{height} area {x}, {y}");
                }
            }
        }
    }
}
