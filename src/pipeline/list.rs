//! Triangle lists back into the stream: projected already, but from memory that the caller could write to.

use super::batch::Batch;
use super::boxes::Look;
use super::last_step::{All, LastStep, take_survivors};
use super::project::{FARTHEST_W, GUARD_BAND, NEAREST_W};
use super::setup::Setup;
use super::survivors::{ROOM, Survivors};
use crate::bins::{FLOATS_PER_TRIANGLE, TriList};
use crate::buffer::{Buffer, TileRect};
use crate::float_environment::round_ties_even;
use crate::simd::Simd;
use crate::statistics::Tally;

/// Draws the triangles of a list.
#[inline(always)]
pub(super) fn draw<S: Simd, L: LastStep>(
    s: S,
    buffer: &Buffer,
    list: &TriList<'_>,
    clip: TileRect,
    last: &mut L,
) -> Tally {
    let mut survivors = Survivors::uninit();
    let survivors = Survivors::of(&mut survivors);
    let mut batch = Batch::uninit();
    // The corners were put in order when the list was filled.
    let look = Look { clip, areas: false };
    let setup = Setup { s, purpose: L::PURPOSE, buffer, both_sides: false, look };
    let mut tally = Tally { processed: list.len() as u64, ..Tally::default() };
    let mut position = 0;
    while position < list.len() {
        let end = list.len().min(position + ROOM);
        fetch(list, position..end, survivors, &mut tally);
        position = end;
        if !take_survivors(setup, survivors, None, All::Yes, &mut batch, last, &mut tally) {
            break;
        }
    }
    tally
}

/// Takes triangles out of the list, without those that no binning could have made.
fn fetch(list: &TriList<'_>, range: core::ops::Range<usize>, survivors: &mut Survivors, tally: &mut Tally) {
    let limit = GUARD_BAND + (1 << 22) as f32;
    let sound = |&[x, y, z]: &[f32; 3]| {
        let whole = |x: f32| x.abs() <= limit && f64::from(x) == round_ties_even(f64::from(x));
        // Just outside of the range of 1/w, for clipping rounds.
        whole(x) && whole(y) && (0.5 / FARTHEST_W..=2.0 / NEAREST_W).contains(&z)
    };
    for triangle in range {
        let corners: [[f32; 3]; 3] = list.get(triangle);
        if corners.iter().all(sound) {
            survivors.push(&corners);
        } else {
            tally.dropped += 1;
        }
    }
}

const _: () = assert!(FLOATS_PER_TRIANGLE == 9);
