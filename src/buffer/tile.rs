//! Tiles: rectangles of them, where one is in memory, whether it has been drawn into since the last clear, and its
//! contents.

use super::rules::{Planes, Rule};
use super::{Buffer, OUTSIDE, SUB_TILES};
use crate::simd::Simd;

/// A rectangle of tiles, end exclusive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TileRect {
    pub x0: u32,
    pub y0: u32,
    pub x1: u32,
    pub y1: u32,
}

/// The contents of cleared tiles, with the given pixels outside the screen.
///
/// # Safety
/// A vector can be read from the mask.
#[inline(always)]
unsafe fn cleared<S: Simd, R: Rule>(s: S, outside: Option<*const u32>) -> Planes<S> {
    let mut planes = R::empty(s);
    if let Some(outside) = outside {
        // SAFETY: the caller's contract.
        let all_outside = s.eq_i(unsafe { s.load_i(outside) }, s.i(-1));
        planes.z0 = s.select(all_outside, s.f(OUTSIDE), planes.z0);
    }
    planes
}

/// Where a tile is: its column, its planes, its `z_min`, and the offset of those of the tile below. The row is seldom
/// needed and is passed as a function.
#[derive(Clone, Copy)]
pub(crate) struct TilePlace {
    pub x: u32,
    pub planes: *mut u32,
    pub z_min: *mut f32,
    pub pitch: usize,
}

impl TilePlace {
    #[inline(always)]
    pub fn new(buffer: &Buffer, x: u32, y: u32) -> Self {
        let pitch = buffer.tiles_w() as usize;
        Self { x, planes: buffer.tile(x, y), z_min: buffer.z_min_of(x, y), pitch }
    }
}

/// Whether anything has been drawn since the last clear into a tile and, with sixteen lanes, into the tile below
/// (otherwise the same tile again): the bits of their `z_min`, of which only [`CLEARED`](super::CLEARED) is negative.
#[derive(Clone, Copy)]
pub(crate) struct ClearState {
    upper: i32,
    lower: i32,
}

impl ClearState {
    /// # Safety
    /// It is a tile of the buffer, and nobody is drawing into it.
    #[inline(always)]
    pub unsafe fn of<S: Simd>(at: TilePlace) -> Self {
        const { assert!(S::LANES.is_multiple_of(SUB_TILES)) }
        let below = if S::LANES == SUB_TILES { 0 } else { at.pitch };
        // SAFETY: the caller's contract; blocks are whole.
        unsafe { Self { upper: (*at.z_min).to_bits() as i32, lower: (*at.z_min.add(below)).to_bits() as i32 } }
    }

    #[inline(always)]
    pub fn all_drawn(self) -> bool {
        self.upper | self.lower >= 0
    }

    #[inline(always)]
    pub fn none_drawn(self) -> bool {
        self.upper & self.lower < 0
    }
}

/// The contents of a tile or, with sixteen lanes and an even row, of it and the tile below.
///
/// # Safety
/// It is a tile of the buffer, which was made for the rule `R`, and nobody is drawing into it.
#[inline(always)]
pub(crate) unsafe fn load<S: Simd, R: Rule>(s: S, buffer: &Buffer, at: TilePlace, row: impl Fn() -> u32) -> Planes<S> {
    // SAFETY: the caller's contract; blocks are whole.
    unsafe {
        let state = ClearState::of::<S>(at);
        let planes = R::load(s, at.planes);
        if state.all_drawn() {
            return planes;
        }
        let blank = cleared::<S, R>(s, buffer.outside_mask(at.x, row()));
        if state.none_drawn() {
            return blank;
        }
        let first = s.first(SUB_TILES);
        let lanes = if state.lower < 0 { first } else { s.and_not_m(first, s.first(S::LANES)) };
        choose(s, lanes, &planes, &blank)
    }
}

/// The lanes in `m` from one, the others from the other.
#[inline(always)]
pub(super) fn choose<S: Simd>(s: S, m: S::M, a: &Planes<S>, b: &Planes<S>) -> Planes<S> {
    Planes {
        z0: s.select(m, a.z0, b.z0),
        z_near: s.select(m, a.z_near, b.z_near),
        z_mid: s.select(m, a.z_mid, b.z_mid),
        z_far: s.select(m, a.z_far, b.z_far),
        near: s.select_i(m, a.near, b.near),
        mid: s.select_i(m, a.mid, b.mid),
        far: s.select_i(m, a.far, b.far),
    }
}
