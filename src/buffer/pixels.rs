//! The depth of every pixel, for looking at: what the buffer knows at least.

use super::{Accurate, BLOCK, Buffer, Quick, Rule, TILE_HEIGHT, TILE_WIDTH, ThreeLayer, UNTOUCHED};
use crate::UpdateRule;

/// The depth of a pixel into which nothing was drawn.
const NOTHING: f32 = -1.0;

/// Writes width times height depths.
pub(crate) fn write(buffer: &Buffer, depth: &mut [f32], flip_y: bool) {
    let (width, height) = (buffer.width() as usize, buffer.height() as usize);
    assert_eq!(depth.len(), width * height);
    for (row, line) in depth.chunks_exact_mut(width).enumerate() {
        let row = if flip_y { height - 1 - row } else { row };
        let y = (row / TILE_HEIGHT as usize) as u32;
        for (column, pixels) in line.chunks_mut(8).enumerate() {
            let x = (column / (TILE_WIDTH as usize / 8)) as u32;
            let lane = row % TILE_HEIGHT as usize / 4 * 4 + column % 4;
            // SAFETY: it is a tile of the buffer, `lane` a sub-tile of it, and nobody draws while it is
            // borrowed; the planes of an untouched tile may never have been written and are not read.
            let sub_tile = unsafe { (*buffer.least_of(x, y) != UNTOUCHED).then(|| sub_tile(buffer, (x, y), lane)) };
            let Some([(near, z_near), (far, z_far), (_, z0)]) = sub_tile else {
                pixels.fill(NOTHING);
                continue;
            };
            for (x, pixel) in pixels.iter_mut().enumerate() {
                let bit = 1 << (row % 4 * 8 + x);
                let mut z = z0;
                if far & bit != 0 {
                    z = z.max(z_far);
                }
                if near & bit != 0 {
                    z = z.max(z_near);
                }
                *pixel = if z > 0.0 { z } else { NOTHING };
            }
        }
    }
}

/// Near layer, far layer and reference of a sub-tile, the masks first.
///
/// # Safety
/// (x, y) is a tile of the buffer, `lane` is below 8, and nobody writes the tile.
unsafe fn sub_tile(buffer: &Buffer, (x, y): (u32, u32), lane: usize) -> [(u32, f32); 3] {
    // SAFETY: the caller's contract; a tile has as many planes as its rule says.
    let word = |plane: usize| unsafe { *buffer.tile(x, y).add(plane * BLOCK + lane) };
    let z = |plane: usize| f32::from_bits(word(plane));
    const { assert!(ThreeLayer::PLANES == 5 && Quick::PLANES == 3 && Accurate::PLANES == 3) }
    match buffer.rule() {
        UpdateRule::ThreeLayer => [(word(3), z(1)), (word(4), z(2)), (u32::MAX, z(0))],
        UpdateRule::Quick | UpdateRule::Accurate => [(word(2), z(1)), (0, 0.0), (u32::MAX, z(0))],
    }
}
