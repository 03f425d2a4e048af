//! Single pixels: the depth of each one, for visualisation (the bound that the buffer guarantees), and whether
//! something shows in one.

use super::rules::{Rule, with_rule};
use super::{BLOCK, Buffer, CLEARED, TILE_HEIGHT, TILE_WIDTH};

/// The depth of a pixel into which nothing has been drawn.
const NOTHING: f32 = -1.0;

/// Writes width times height depths.
pub(crate) fn write(buffer: &Buffer, depth: &mut [f32], flip_y: bool) {
    with_rule!(buffer.rule(), R => write_layers::<R>(buffer, depth, flip_y));
}

fn write_layers<R: Rule>(buffer: &Buffer, depth: &mut [f32], flip_y: bool) {
    let (width, height) = (buffer.width() as usize, buffer.height() as usize);
    assert_eq!(depth.len(), width * height);
    for (row, line) in depth.chunks_exact_mut(width).enumerate() {
        let row = if flip_y { height - 1 - row } else { row };
        let y = (row / TILE_HEIGHT as usize) as u32;
        for (column, pixels) in line.chunks_mut(8).enumerate() {
            let x = (column / (TILE_WIDTH as usize / 8)) as u32;
            let lane = row % TILE_HEIGHT as usize / 4 * 4 + column % 4;
            // SAFETY: it is a tile of the buffer. Nobody draws meanwhile: that takes a `&mut` to the
            // object, or a contract with the caller that forbids reading.
            if unsafe { *buffer.z_min_of(x, y) } == CLEARED {
                pixels.fill(NOTHING);
                continue;
            }
            for (x_in, pixel) in pixels.iter_mut().enumerate() {
                // SAFETY: the tile has been drawn into, and `lane` is one of its sub-tiles.
                let z = unsafe { bound::<R>(buffer.tile(x, y), lane, 1 << (row % 4 * 8 + x_in)) };
                *pixel = if z > 0.0 { z } else { NOTHING };
            }
        }
    }
}

/// No pixel of a sub-tile, given by its bit, is farther than this.
///
/// # Safety
/// These are a tile's planes, which the rule `R` wrote; `lane` is one of its sub-tiles.
#[inline(always)]
unsafe fn bound<R: Rule>(planes: *const u32, lane: usize, bit: u32) -> f32 {
    // SAFETY: the caller's contract: there are as many planes as the rule says.
    let word = |plane: usize| unsafe { *planes.add(plane * BLOCK + lane) };
    let mut bound = f32::from_bits(word(0));
    for &(mask, z_layer) in R::LAYER_PLANES {
        let z = if word(mask) & bit != 0 { f32::from_bits(word(z_layer)) } else { 0.0 };
        bound = if z > bound { z } else { bound };
    }
    bound
}

/// Is anything that touches this pixel at `depth`, or nearer, visible as far as the buffer can tell? What it says is what
/// a query of the sub-tile says of any pixels that include this one.
///
/// # Safety
/// It is a pixel of the buffer, and nobody is drawing.
#[inline(always)]
pub(crate) unsafe fn shows(buffer: &Buffer, column: u32, row: u32, depth: f32) -> bool {
    with_rule!(buffer.rule(), R => {
        // SAFETY: the caller's contract; the buffer was made for the rule.
        unsafe { shows_in_layers::<R>(buffer, column, row, depth) }
    })
}

/// # Safety
/// As [`shows`]; the buffer was made for the rule `R`.
#[inline(always)]
unsafe fn shows_in_layers<R: Rule>(buffer: &Buffer, column: u32, row: u32, depth: f32) -> bool {
    let (x, y) = (column / TILE_WIDTH, row / TILE_HEIGHT);
    let lane = (row % TILE_HEIGHT / 4 * 4 + column % TILE_WIDTH / 8) as usize;
    let bit = 1 << (row % 4 * 8 + column % 8);
    // SAFETY: the caller's contract.
    if unsafe { *buffer.z_min_of(x, y) } == CLEARED {
        return true;
    }
    // SAFETY: the tile has been drawn into, and `lane` is one of its sub-tiles.
    unsafe { bound::<R>(buffer.tile(x, y), lane, bit) <= depth }
}
