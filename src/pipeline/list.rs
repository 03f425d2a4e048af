//! Triangle lists back into the stream: projected already, but from memory that the caller could write to.

use super::Facing;
use super::batch::Batch;
use super::last_step::{LastStep, take_survivors};
use super::project::{FARTHEST_W, GUARD_BAND, NEAREST_W};
use super::scratch::{CHUNK_VERTICES, Scratch, pack};
use super::setup::Setup;
use crate::bins::{FLOATS_PER_TRIANGLE, TriList};
use crate::buffer::Buffer;
use crate::simd::Simd;
use crate::statistics::Tally;

const CHUNK: usize = CHUNK_VERTICES / 3;

/// Draws the triangles of a list.
#[inline(always)]
pub(super) fn draw<S: Simd, L: LastStep>(s: S, buffer: &Buffer, list: &TriList<'_>, last: &mut L) -> Tally {
    // The corners were put in order when the list was filled.
    let facing = Facing { swap: false, both: false };
    let mut memory = Scratch::uninit();
    let scratch = Scratch::of(&mut memory);
    let mut batch = Batch::new();
    let setup = Setup { s, purpose: L::PURPOSE, buffer, facing, shared: true };
    let mut tally = Tally { processed: list.len() as u64, ..Tally::default() };
    let mut position = 0;
    while position < list.len() {
        let end = list.len().min(position + CHUNK);
        let survivors = fetch(list, position..end, scratch, &mut tally);
        position = end;
        // SAFETY: survivors name vertices just written.
        let more = unsafe { take_survivors(setup, scratch, survivors, &mut batch, last, &mut tally) };
        if !more {
            break;
        }
    }
    tally
}

/// Copies triangles into the scratch, without those that no binning could have made; their number.
fn fetch(list: &TriList<'_>, range: core::ops::Range<usize>, scratch: &mut Scratch, tally: &mut Tally) -> usize {
    let limit = GUARD_BAND + (1 << 22) as f32;
    let sound = |&[x, y, z]: &[f32; 3]| {
        let whole = |x: f32| x.abs() <= limit && x == x.round_ties_even();
        // Just outside of the range of 1/w, for clipping rounds.
        whole(x) && whole(y) && (0.5 / FARTHEST_W..=2.0 / NEAREST_W).contains(&z)
    };
    let mut survivors = 0;
    for triangle in range {
        let corners: [[f32; 3]; 3] = list.get(triangle);
        if corners.iter().all(sound) {
            let first = 3 * survivors;
            for (k, &corner) in corners.iter().enumerate() {
                scratch.set_vertex(first + k, corner);
            }
            let first = first as u32;
            scratch.survivors[survivors].write(pack([first, first + 1, first + 2]));
            survivors += 1;
        } else {
            tally.dropped += 1;
        }
    }
    survivors
}

const _: () = assert!(FLOATS_PER_TRIANGLE == 9);
