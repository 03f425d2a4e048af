//! Compares triangles with a buffer until one may be visible.

use core::marker::PhantomData;

use super::{Memory, TriangleSink, tiles_in, whole_mesh};
use crate::CullingResult;
use crate::buffer::rules::{Rule, with_rule};
use crate::buffer::{Buffer, SUB_TILES, TilePlace, load, pixels};
use crate::geometry::{Conservative, Corner};
use crate::raster::traverse::{Input, Workspace};
use crate::raster::{HizScope, Setup, TileOp, setup, traverse};
use crate::simd::{Outlined, Simd};
use crate::statistics::Tally;

/// Tile rows looked at first: what is visible usually shows there.
const FIRST_LOOK: usize = 2;

/// Compares triangles with a buffer until one may be visible.
pub(crate) struct Query<'a> {
    buffer: &'a Buffer,
    /// Some triangle touched a pixel, or was hidden before its edges were set up, which implies that it is on the
    /// screen.
    found: bool,
}

impl<'a> Query<'a> {
    #[inline(always)]
    pub fn new(buffer: &'a Buffer) -> Self {
        Self { buffer, found: false }
    }

    /// The pixel that contains a point on the screen, in 1/256 pixel.
    #[inline(always)]
    fn pixel(&self, [x, y, _]: [f32; 3]) -> Option<(u32, u32)> {
        let (width, height) = self.buffer.size();
        let (column, row) = ((x as i32) >> 8, (y as i32) >> 8);
        let inside = (0..width as i32).contains(&column) && (0..height as i32).contains(&row);
        inside.then_some((column as u32, row as u32))
    }
}

impl TriangleSink for Query<'_> {
    type Coverage = Conservative;
    type Memory = Workspace;
    const LOOKS_FIRST: bool = true;

    /// A query covers the pixel that contains a corner, and its depth there is no farther than the corner's. So if that
    /// pixel shows the corner, the triangle is visible. Statistics count what set-up finds, and so need it.
    #[inline(always)]
    fn is_decided_by(&self, corner: [f32; 3]) -> bool {
        match self.pixel(corner) {
            // SAFETY: a pixel of the buffer. Nobody is drawing, or the answer is discarded.
            Some((column, row)) if !self.buffer.statistics() => unsafe {
                pixels::shows(self.buffer, column, row, corner[2])
            },
            _ => false,
        }
    }

    /// If every tile of the mesh's bounds hides its nearest vertex, every triangle is hidden, and the one with a corner
    /// on the screen touches a pixel.
    #[inline(always)]
    fn hides_all<S: Simd>(&mut self, s: S, corner: [f32; 3], vertices: &[[f32; 4]]) -> bool {
        if self.buffer.statistics() || self.pixel(corner).is_none() {
            return false;
        }
        // SAFETY: the corner is a vertex. Nobody is drawing, or the answer is discarded.
        if !unsafe { whole_mesh::is_hidden(s, self.buffer, vertices) } {
            return false;
        }
        self.found = true;
        true
    }

    #[inline(always)]
    fn submit<S: Simd>(
        &mut self,
        setup: Setup<'_, S>,
        corners: [Corner<S>; 3],
        active: S::M,
        memory: &mut Memory<Workspace>,
        tally: &mut Tally,
    ) -> bool {
        const { assert!(S::LANES.is_multiple_of(SUB_TILES)) }
        let scope = HizScope { clip: self.buffer.all_tiles(), coarse: false };
        let counts = self.buffer.statistics();
        let alive = &setup::set_up::<S, Conservative>(setup, scope, corners, active, !counts, &mut memory.batch);
        if alive.rasterized == 0 {
            return true;
        }
        let (t, buffer, batch, lists) = (setup.s, self.buffer, &memory.batch, &mut memory.own);
        let clip = scope.clip;
        let mut stopped = None;
        if alive.lanes != 0 {
            let input = Input { buffer, clip, batch, alive, lists };
            let touches;
            (stopped, touches) = with_rule!(buffer.rule(), R => {
                t.outlined(CompareTiles { input, op: Compare::<R>::new(buffer) })
            });
            self.found |= touches;
        }
        self.found |= alive.rasterized != alive.lanes;
        if !self.found && stopped.is_none() {
            // Either hidden tile by tile or touching no pixel: the first touched pixel decides. Which tiles are
            // compared together depends on the instruction set, so being hidden there must not decide it.
            let input = Input { buffer, clip, batch, alive, lists };
            self.found = t.outlined(TouchTiles { input });
        }
        // Triangles after the first one that may be visible do not count, however many a vector holds.
        let counted = alive.rasterized & stopped.map_or(u32::MAX, |lane| (2 << lane) - 1);
        tally.rasterized += u64::from(counted.count_ones());
        if counts {
            // SAFETY: some triangles are rasterized, so set-up stored the batch.
            tally.traversed += unsafe { tiles_in(batch, counted, clip) };
        }
        stopped.is_none()
    }

    #[inline(always)]
    fn result(&self, in_view: bool, stopped: bool) -> CullingResult {
        if stopped {
            CullingResult::Visible
        } else if in_view && self.found {
            CullingResult::Occluded
        } else {
            CullingResult::ViewCulled
        }
    }
}

/// Compares triangles: gives the lane at which one may be visible, and whether any pixel was touched.
struct CompareTiles<'a, O> {
    input: Input<'a>,
    op: O,
}

impl<T: Simd, R: Rule> Outlined<T> for CompareTiles<'_, Compare<'_, R>> {
    type Output = (Option<u32>, bool);

    #[inline(always)]
    fn run(self, t: T) -> Self::Output {
        let Self { input, mut op } = self;
        // SAFETY: `Query` made the input from triangles that it set up; the clip is the whole buffer, and
        // nothing is written.
        (unsafe { traverse(t, input, &mut op) }, op.touches)
    }
}

/// Does any triangle touch a pixel?
struct TouchTiles<'a> {
    input: Input<'a>,
}

impl<T: Simd> Outlined<T> for TouchTiles<'_> {
    type Output = bool;

    #[inline(always)]
    fn run(self, t: T) -> bool {
        // SAFETY: as for `CompareTiles`.
        unsafe { traverse(t, self.input, &mut Touch) }.is_some()
    }
}

/// Stops at the first tile with a touched pixel.
struct Touch;

impl<T: Simd> TileOp<T> for Touch {
    const PLANES: usize = 0;
    const FIRST_TILE_ROWS: usize = FIRST_LOOK;
    type Coverage = Conservative;

    /// All tiles.
    #[inline(always)]
    fn is_candidate(t: T, z_min: T::F, _: T::F) -> T::M {
        t.eq(z_min, z_min)
    }

    #[inline(always)]
    unsafe fn tile(&mut self, t: T, _: TilePlace, _: impl Fn() -> u32, covered: T::I, _: T::F) -> bool {
        nothing(t, covered)
    }

    #[inline(always)]
    unsafe fn whole_tile(&mut self, _: T, _: TilePlace, _: impl Fn() -> u32, _: T::F) -> bool {
        false
    }
}

/// Is no pixel covered?
#[inline(always)]
fn nothing<T: Simd>(t: T, covered: T::I) -> bool {
    t.all(t.eq_i(covered, t.i(0)))
}

/// Stops at the first tile in which something may be visible.
struct Compare<'a, R> {
    buffer: &'a Buffer,
    /// Some pixel was touched.
    touches: bool,
    rule: PhantomData<R>,
}

impl<'a, R> Compare<'a, R> {
    #[inline(always)]
    fn new(buffer: &'a Buffer) -> Self {
        Self { buffer, touches: false, rule: PhantomData }
    }
}

impl<T: Simd, R: Rule> TileOp<T> for Compare<'_, R> {
    const PLANES: usize = R::PLANES;
    const FIRST_TILE_ROWS: usize = FIRST_LOOK;
    type Coverage = Conservative;

    #[inline(always)]
    unsafe fn tile(&mut self, t: T, at: TilePlace, row: impl Fn() -> u32, covered: T::I, depth: T::F) -> bool {
        self.touches |= !nothing(t, covered);
        // SAFETY: the caller's contract; the buffer was made for the rule `R`.
        let hidden = unsafe { R::hides(t, &load::<T, R>(t, self.buffer, at, row), covered, depth) };
        t.all(hidden)
    }

    #[inline(always)]
    unsafe fn whole_tile(&mut self, t: T, at: TilePlace, row: impl Fn() -> u32, depth: T::F) -> bool {
        // SAFETY: the caller's contract.
        unsafe { self.tile(t, at, row, t.i(-1), depth) }
    }
}
