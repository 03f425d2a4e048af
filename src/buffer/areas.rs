//! Areas of 128x64 pixels: the least of their tiles' least depths.
//!
//! A triangle that is too large for its tiles to be looked up one by one, and that is hidden, is found so before its edges
//! are set up. Between two clears a tile's least depth only rises, so that an area may lag behind its tiles: it then lets
//! a hidden triangle through, no more. Areas are therefore brought up to date only after so many tiles were drawn into,
//! and only by whoever draws there alone.

use super::{Buffer, TileRect, UNTOUCHED};
use crate::simd::{MAX_LANES, Simd, store_relaxed};

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

/// Nothing was drawn into a rectangle of tiles.
///
/// # Safety
/// As [`refresh`].
pub(super) unsafe fn clear(buffer: &Buffer, clip: TileRect) {
    let (columns, rows) = (
        clip.x0 / AREA_TILES_W..clip.x1.div_ceil(AREA_TILES_W),
        clip.y0 / AREA_TILES_H..clip.y1.div_ceil(AREA_TILES_H),
    );
    for y in rows {
        for x in columns.clone() {
            // SAFETY: the caller's contract.
            unsafe { store_relaxed(buffer.areas().add((y * buffer.areas_w + x) as usize), UNTOUCHED) };
        }
    }
}

/// Counts that so many more tiles, of a vector's height, were drawn into inside of `clip`, and brings its areas up to date
/// when there were enough.
///
/// # Safety
/// As [`refresh`].
#[inline(always)]
pub(crate) unsafe fn drawn<S: Simd>(s: S, buffer: &Buffer, clip: TileRect, tiles: usize, count: &mut u32) {
    *count += tiles as u32;
    // As often as the work of it is small against that of the tiles: twice or half as often is alike.
    if *count >= (clip.x1 - clip.x0) * (clip.y1 - clip.y0) / 8 {
        *count = 0;
        // SAFETY: the caller's contract.
        unsafe { refresh(s, buffer, clip) };
    }
}

/// Brings the areas of a rectangle of tiles up to date, which begins with an area and ends with one or at the buffer's end.
///
/// # Safety
/// Nobody else writes its tiles and areas; others may read least depths as words.
#[inline(always)]
unsafe fn refresh<S: Simd>(s: S, buffer: &Buffer, clip: TileRect) {
    debug_assert!(clip.x0.is_multiple_of(AREA_TILES_W) && clip.y0.is_multiple_of(AREA_TILES_H));
    let tiles = (clip.x1 - clip.x0) as usize;
    let areas = tiles.div_ceil(AREA_TILES_W as usize);
    let mut row = [0.0_f32; ROW];
    // What is after the last tile changes no least.
    for x in (tiles.next_multiple_of(S::LANES)..(areas * AREA_TILES_W as usize).next_multiple_of(4 * S::LANES))
        .step_by(S::LANES)
    {
        // SAFETY: the array has room for four vectors after the last tile of the widest row.
        unsafe { s.store_f(row.as_mut_ptr().add(x), s.f(f32::MAX)) };
    }
    for y0 in (clip.y0..clip.y1).step_by(AREA_TILES_H as usize) {
        let y1 = (y0 + AREA_TILES_H).min(clip.y1);
        for x in (0..tiles).step_by(S::LANES) {
            let first = buffer.least_of(clip.x0 + x as u32, y0);
            let of_row = |y: u32| {
                let p = first.wrapping_add((y * buffer.tiles_w) as usize);
                // SAFETY: tiles of the rectangle, and no others: beside them another thread may be writing.
                unsafe {
                    if x + S::LANES <= tiles { s.load_f(p) } else { s.float_of_bits(s.load_some(p.cast(), tiles - x)) }
                }
            };
            let mut least = of_row(0);
            // Most have eight rows, for which nothing is counted.
            if y1 - y0 == AREA_TILES_H {
                for y in 1..AREA_TILES_H {
                    least = s.min(least, of_row(y));
                }
            } else {
                for y in 1..y1 - y0 {
                    least = s.min(least, of_row(y));
                }
            }
            let least = s.select(s.first(tiles - x), least, s.f(f32::MAX));
            // SAFETY: the array has room for a vector after the last tile of the widest row.
            unsafe { s.store_f(row.as_mut_ptr().add(x), least) };
        }
        let to = buffer.areas().wrapping_add((y0 / AREA_TILES_H * buffer.areas_w + clip.x0 / AREA_TILES_W) as usize);
        for k in (0..areas).step_by(S::LANES) {
            let mut least = [0.0; MAX_LANES];
            // SAFETY: there is room for four vectors in the one array, for a vector in the other.
            unsafe {
                let [a, b, c, d] = s.load_quads(row.as_ptr().add(k * AREA_TILES_W as usize));
                s.store_f(least.as_mut_ptr(), s.min(s.min(a, b), s.min(c, d)));
            }
            for (lane, &least) in least[..S::LANES.min(areas - k)].iter().enumerate() {
                // SAFETY: an area of the rectangle.
                unsafe { store_relaxed(to.add(k + lane), least) };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{self, Job};
    use crate::{Allocator, UpdateRule};

    struct Refresh<'a>(&'a Buffer, TileRect);

    impl Job for Refresh<'_> {
        type Output = ();

        fn run<S: Simd>(self, s: S) {
            // SAFETY: the test has the buffer to itself.
            unsafe { refresh(s, self.0, self.1) }
        }
    }

    /// Fills buffers and brings all of their areas up to date, then those of a piece.
    fn check(who: &str, refresh: impl Fn(Refresh<'_>)) {
        let mut random = fastrand::Rng::with_seed(1);
        for (width, height) in [(1, 1), (33, 9), (1920, 1080), (2050, 70), (16_384, 8), (40, 16_384)] {
            let buffer = Buffer::new(width, height, UpdateRule::Quick, Allocator::SYSTEM, false).unwrap();
            let (tiles_w, tiles_h) = (buffer.tiles_w, buffer.tiles_h);
            let (areas_w, areas_h) = counts(tiles_w, tiles_h);
            // SAFETY (of all blocks): tiles and areas of a buffer that nobody else has.
            let least = |x, y| unsafe { *buffer.least_of(x, y) };
            let area = |x: u32, y: u32| buffer.areas().wrapping_add((y * areas_w + x) as usize);
            for (x, y) in (0..tiles_h).flat_map(|y| (0..tiles_w).map(move |x| (x, y))) {
                unsafe { buffer.least_of(x, y).write(random.f32()) };
            }
            // A piece begins with an area and ends with one or at the buffer's end.
            let (x0, y0) = (areas_w / 3, areas_h / 3);
            let (x1, y1) = ((2 * areas_w / 3).max(x0 + 1), areas_h);
            let piece = TileRect {
                x0: AREA_TILES_W * x0,
                y0: AREA_TILES_H * y0,
                x1: (AREA_TILES_W * x1).min(tiles_w),
                y1: tiles_h,
            };
            for (clip, is_inside) in [
                (buffer.all_tiles(), Box::new(|_, _| true) as Box<dyn Fn(u32, u32) -> bool>),
                (piece, Box::new(|x, y| (x0..x1).contains(&x) && (y0..y1).contains(&y))),
            ] {
                for (x, y) in (0..areas_h).flat_map(|y| (0..areas_w).map(move |x| (x, y))) {
                    unsafe { area(x, y).write(UNTOUCHED) };
                }
                refresh(Refresh(&buffer, clip));
                for (x, y) in (0..areas_h).flat_map(|y| (0..areas_w).map(move |x| (x, y))) {
                    let columns = AREA_TILES_W * x..(AREA_TILES_W * (x + 1)).min(tiles_w);
                    let rows = AREA_TILES_H * y..(AREA_TILES_H * (y + 1)).min(tiles_h);
                    let of_tiles = rows
                        .flat_map(|y| columns.clone().map(move |x| (x, y)))
                        .map(|(x, y)| least(x, y))
                        .fold(f32::MAX, f32::min);
                    let expected = if is_inside(x, y) { of_tiles } else { UNTOUCHED };
                    let got = unsafe { *area(x, y) };
                    assert_eq!(got, expected, "{who} {width}x{height} {clip:?} area {x}, {y}");
                }
            }
        }
    }

    #[test]
    fn an_area_is_the_least_of_its_tiles() {
        for &implementation in simd::available() {
            check(&format!("{implementation:?}"), |job| simd::run(implementation, job));
        }
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        if simd::available().contains(&crate::Implementation::Avx2) {
            check("sixteen lanes", |job| {
                simd::with_sixteen_lanes(|| simd::run(crate::Implementation::Avx2, job));
            });
        }
    }
}
