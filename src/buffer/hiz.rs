//! The coarse HiZ level: cells of 128x64 pixels, each holding the least `z_min` of its tiles.
//!
//! It finds hidden triangles that are too large for their tiles to be looked up one by one, before their edges are set
//! up. Between two clears a tile's `z_min` only rises, so a cell may lag behind its tiles: the worst effect is that a
//! hidden triangle gets through. Cells are therefore refreshed only after enough tiles have been drawn into, by the one
//! thread that draws there.

use super::{Buffer, CLEARED, TileRect};
use crate::simd::{MAX_LANES, Simd, store_relaxed};

pub(crate) const COARSE_TILES_W: u32 = 4;
pub(crate) const COARSE_TILES_H: u32 = 8;
/// Shifts of a tile's column and row.
pub(crate) const COARSE_COLUMN_SHIFT: i32 = 2;
pub(crate) const COARSE_ROW_SHIFT: i32 = 3;

/// Room for a row of tiles of the largest screen, plus a vector.
const ROW: usize = (super::MAX_SIZE / super::TILE_WIDTH) as usize + 4 * MAX_LANES;

/// Number of cells in a row and in a column.
pub(super) fn counts(tiles_w: u32, tiles_h: u32) -> (u32, u32) {
    (tiles_w.div_ceil(COARSE_TILES_W), tiles_h.div_ceil(COARSE_TILES_H))
}

/// Does any tile of a row of tiles leave visible what is at `depth` and touches it? The columns begin at `x` and end
/// before `end`. One branch for the whole row, because most rows have no such tile.
///
/// # Safety
/// They are tiles of the buffer, and nobody is drawing.
#[inline(always)]
pub(crate) unsafe fn row_is_open<S: Simd>(s: S, buffer: &Buffer, mut x: u32, end: u32, y: u32, depth: S::F) -> bool {
    // SAFETY: the caller's contract; after the last tile there is room for a vector.
    let open_from = |x: u32| s.le(unsafe { s.load_f(buffer.z_min_of(x, y)) }, depth);
    let mut any = s.first(0);
    while x + S::LANES as u32 <= end {
        any = s.or_m(any, open_from(x));
        x += S::LANES as u32;
    }
    any = s.or_m(any, s.and_m(s.first((end - x) as usize), open_from(x)));
    s.mask_bits(any) != 0
}

/// Marks the cells of a rectangle of tiles as cleared.
///
/// # Safety
/// As [`refresh`].
pub(super) unsafe fn clear(buffer: &Buffer, clip: TileRect) {
    let (columns, rows) = (
        clip.x0 / COARSE_TILES_W..clip.x1.div_ceil(COARSE_TILES_W),
        clip.y0 / COARSE_TILES_H..clip.y1.div_ceil(COARSE_TILES_H),
    );
    for y in rows {
        for x in columns.clone() {
            // SAFETY: the caller's contract.
            unsafe { store_relaxed(buffer.coarse().add((y * buffer.coarse_w + x) as usize), CLEARED) };
        }
    }
}

/// Counts tiles, of a vector's height, that were drawn into within `clip`, and refreshes its cells once there are
/// enough.
///
/// # Safety
/// As [`refresh`].
#[inline(always)]
pub(super) unsafe fn count_drawn<S: Simd>(s: S, buffer: &Buffer, clip: TileRect, tiles: usize, count: &mut u32) {
    *count += tiles as u32;
    // Rare enough to cost little compared with the tiles; twice or half as often makes no measurable difference.
    if *count >= (clip.x1 - clip.x0) * (clip.y1 - clip.y0) / 8 {
        *count = 0;
        // SAFETY: the caller's contract.
        unsafe { refresh(s, buffer, clip) };
    }
}

/// Refreshes the cells of a rectangle of tiles that starts at a cell boundary and ends at one or at the buffer's edge.
///
/// # Safety
/// Nobody else writes its tiles and cells; others may read `z_min` word by word.
#[inline(always)]
unsafe fn refresh<S: Simd>(s: S, buffer: &Buffer, clip: TileRect) {
    debug_assert!(clip.x0.is_multiple_of(COARSE_TILES_W) && clip.y0.is_multiple_of(COARSE_TILES_H));
    let tiles = (clip.x1 - clip.x0) as usize;
    let cells = tiles.div_ceil(COARSE_TILES_W as usize);
    let mut row = [0.0_f32; ROW];
    // Past the last tile: infinitely near, so that these never are the least.
    for x in (tiles.next_multiple_of(S::LANES)..(cells * COARSE_TILES_W as usize).next_multiple_of(4 * S::LANES))
        .step_by(S::LANES)
    {
        // SAFETY: the array has room for four vectors after the last tile of the widest row.
        unsafe { s.store_f(row.as_mut_ptr().add(x), s.f(f32::MAX)) };
    }
    for y0 in (clip.y0..clip.y1).step_by(COARSE_TILES_H as usize) {
        let y1 = (y0 + COARSE_TILES_H).min(clip.y1);
        for x in (0..tiles).step_by(S::LANES) {
            let first = buffer.z_min_of(clip.x0 + x as u32, y0);
            let of_row = |y: u32| {
                let p = first.wrapping_add((y * buffer.tiles_w) as usize);
                // SAFETY: only tiles of the rectangle are read; next to it another thread may be writing.
                unsafe {
                    if x + S::LANES <= tiles { s.load_f(p) } else { s.float_of_bits(s.load_some(p.cast(), tiles - x)) }
                }
            };
            let mut least = of_row(0);
            // Most cells have eight rows: unrolled.
            if y1 - y0 == COARSE_TILES_H {
                for y in 1..COARSE_TILES_H {
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
        let to =
            buffer.coarse().wrapping_add((y0 / COARSE_TILES_H * buffer.coarse_w + clip.x0 / COARSE_TILES_W) as usize);
        for k in (0..cells).step_by(S::LANES) {
            let mut least = [0.0; MAX_LANES];
            // SAFETY: one array has room for four vectors, the other for one.
            unsafe {
                let [a, b, c, d] = s.load_quads(row.as_ptr().add(k * COARSE_TILES_W as usize));
                s.store_f(least.as_mut_ptr(), s.min(s.min(a, b), s.min(c, d)));
            }
            for (lane, &least) in least[..S::LANES.min(cells - k)].iter().enumerate() {
                // SAFETY: this is a cell of the rectangle.
                unsafe { store_relaxed(to.add(k + lane), least) };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{self, Job, Level};
    use crate::{Allocator, UpdateRule};

    struct Refresh<'a>(&'a Buffer, TileRect);

    impl Job for Refresh<'_> {
        type Output = ();

        fn run<S: Simd>(self, s: S) {
            // SAFETY: the test has the buffer to itself.
            unsafe { refresh(s, self.0, self.1) }
        }
    }

    /// Fills buffers and refreshes all of their cells, then those of a part.
    fn check(who: &str, refresh: impl Fn(Refresh<'_>)) {
        let mut random = fastrand::Rng::with_seed(1);
        for (width, height) in [(1, 1), (33, 9), (1920, 1080), (2050, 70), (16_384, 8), (40, 16_384)] {
            let buffer = Buffer::new(width, height, UpdateRule::ThreeLayer, Allocator::SYSTEM, false).unwrap();
            let (tiles_w, tiles_h) = (buffer.tiles_w, buffer.tiles_h);
            let (coarse_w, coarse_h) = counts(tiles_w, tiles_h);
            // SAFETY (of all blocks): tiles and cells of a buffer that nobody else accesses.
            let z_min = |x, y| unsafe { *buffer.z_min_of(x, y) };
            let cell = |x: u32, y: u32| buffer.coarse().wrapping_add((y * coarse_w + x) as usize);
            for (x, y) in (0..tiles_h).flat_map(|y| (0..tiles_w).map(move |x| (x, y))) {
                unsafe { buffer.z_min_of(x, y).write(random.f32()) };
            }
            // A part starts at a cell boundary and ends at one or at the buffer's edge.
            let (x0, y0) = (coarse_w / 3, coarse_h / 3);
            let (x1, y1) = ((2 * coarse_w / 3).max(x0 + 1), coarse_h);
            let piece = TileRect {
                x0: COARSE_TILES_W * x0,
                y0: COARSE_TILES_H * y0,
                x1: (COARSE_TILES_W * x1).min(tiles_w),
                y1: tiles_h,
            };
            for (clip, is_inside) in [
                (buffer.all_tiles(), Box::new(|_, _| true) as Box<dyn Fn(u32, u32) -> bool>),
                (piece, Box::new(|x, y| (x0..x1).contains(&x) && (y0..y1).contains(&y))),
            ] {
                for (x, y) in (0..coarse_h).flat_map(|y| (0..coarse_w).map(move |x| (x, y))) {
                    unsafe { cell(x, y).write(CLEARED) };
                }
                refresh(Refresh(&buffer, clip));
                for (x, y) in (0..coarse_h).flat_map(|y| (0..coarse_w).map(move |x| (x, y))) {
                    let columns = COARSE_TILES_W * x..(COARSE_TILES_W * (x + 1)).min(tiles_w);
                    let rows = COARSE_TILES_H * y..(COARSE_TILES_H * (y + 1)).min(tiles_h);
                    let of_tiles = rows
                        .flat_map(|y| columns.clone().map(move |x| (x, y)))
                        .map(|(x, y)| z_min(x, y))
                        .fold(f32::MAX, f32::min);
                    let expected = if is_inside(x, y) { of_tiles } else { CLEARED };
                    let got = unsafe { *cell(x, y) };
                    assert_eq!(got, expected, "{who} {width}x{height} {clip:?} cell {x}, {y}");
                }
            }
        }
    }

    #[test]
    fn a_coarse_cell_is_the_least_of_its_tiles() {
        for level in Level::all() {
            check(&format!("{level:?}"), |job| simd::run(level, job));
        }
        #[cfg(all(any(target_arch = "x86", target_arch = "x86_64"), feature = "avx2"))]
        if let Some(avx2) = Level::of(crate::Implementation::Avx2) {
            check("sixteen lanes", |job| simd::with_sixteen_lanes(|| simd::run(avx2, job)));
        }
    }
}
