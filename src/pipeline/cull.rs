//! Indices to survivors: most triangles end here, a vector of them at a time.
//!
//! A mesh is taken in chunks whose vertices are in the scratch (see `chunk.rs`).

use super::batch::Batch;
use super::boxes::Look;
use super::chunk::{self, Chunk, Numbering};
use super::clip::{self, Clipped};
use super::last_step::{All, LastStep, take_survivors};
use super::project::{Camera, Reader, SHIFT, bit_where, outcode, project};
use super::scratch::{MAX_LANES, Scratch};
use super::setup::{Purpose, Setup};
use super::survivors::{Corner, ROOM, Survivors};
use super::{Facing, Mesh};
use crate::CullingResult;
use crate::buffer::Buffer;
use crate::simd::Simd;
use crate::statistics::Tally;

/// Farther than this outside of the screen, in 1/256 pixel, a snapped vertex is outside for certain.
const CLEARLY: f32 = 2.0;
/// Relative error of a doubled area in f32, with room: eight roundings.
const AREA_ERROR: f32 = 8.0 / (1 << 24) as f32;

/// With more survivors than this there may be no room for those of another vector of triangles.
const FULL: usize = ROOM - MAX_LANES * clip::MAX_TRIANGLES;

/// Draws, tests or bins a mesh, by its last step.
#[inline(always)]
pub(super) fn mesh<S: Simd, L: LastStep>(
    s: S,
    buffer: &Buffer,
    camera: &Camera,
    mesh: &Mesh<'_>,
    last: &mut L,
) -> (CullingResult, Tally) {
    let camera = &if L::PURPOSE == Purpose::Query { camera.for_queries() } else { *camera };
    let reader = Reader::new(s, mesh.vertices, mesh.matrix);
    let facing = Facing::new(mesh.options.winding, camera);
    let mut memory = Scratch::uninit();
    let scratch = Scratch::of(&mut memory);
    let mut survivors = Survivors::uninit();
    let survivors = Survivors::of(&mut survivors);
    let mut batch = Batch::uninit();
    let look = Look { clip: buffer.all_tiles(), areas: L::PURPOSE == Purpose::Draw };
    let setup = Setup { s, purpose: L::PURPOSE, buffer, both_sides: facing.both, look };
    let triangles = mesh.triangles.len() / 3;
    let mut tally = Tally { processed: triangles as u64, ..Tally::default() };
    let (mut in_view, mut unprojectable) = (false, false);
    let mut direct = None;
    let (mut position, mut chunk) = (0, Chunk::NONE);

    while position < triangles && !unprojectable {
        if position == chunk.end {
            // SAFETY: the pipeline's caller vouches for the vertices.
            chunk = unsafe { chunk::project(s, camera, &reader, mesh.triangles, position, scratch) };
        }
        chunk.prefetch_next(s, mesh.triangles, position);
        let count = S::LANES.min(chunk.end - position);
        // SAFETY: `count` triangles from `position` on are in the mesh and in the scratch.
        let group = unsafe { Group::new(s, mesh.triangles, position, count, chunk.numbering, facing, scratch) };
        let sieve = group.sieve(s, L::PURPOSE, buffer, camera, facing);
        in_view |= sieve.in_view;
        let kept = s.mask_bits(sieve.kept);
        if sieve.irregular == 0 {
            if kept != 0 && triangles <= S::LANES {
                direct = Some((group.corners, sieve.kept));
            } else if kept != 0 {
                // SAFETY: below `FULL` there is room.
                unsafe { survivors.append(s, sieve.kept, &group.corners) };
            }
        } else {
            let mut lanes = [[0.0; MAX_LANES]; 9];
            for k in 0..9 {
                // SAFETY: sixteen floats hold a vector.
                unsafe { s.store_f(lanes[k].as_mut_ptr(), group.corners[k / 3][k % 3]) };
            }
            for lane in 0..count {
                if kept >> lane & 1 == 1 {
                    let corner = |k: usize| [lanes[3 * k][lane], lanes[3 * k + 1][lane], lanes[3 * k + 2][lane]];
                    survivors.push(&[corner(0), corner(1), corner(2)]);
                } else if sieve.irregular >> lane & 1 == 1 {
                    let at = 3 * (position + lane);
                    let corners = [mesh.triangles[at], mesh.triangles[at + 1], mesh.triangles[at + 2]];
                    // SAFETY: the pipeline's caller vouches for the vertices.
                    let (clip, screen) = unsafe { corners_of(s, camera, &reader, corners) };
                    match clip::triangle(L::PURPOSE, camera, &clip, &screen) {
                        Clipped::Nothing => {}
                        Clipped::Dropped => tally.dropped += 1,
                        Clipped::Unprojectable => {
                            unprojectable = true;
                            break;
                        }
                        Clipped::Polygon(polygon) => {
                            in_view |= polygon.emit(L::PURPOSE, camera, facing, survivors);
                        }
                    }
                }
            }
        }
        position += count;
        if survivors.len() > FULL && !take_survivors(setup, survivors, None, All::No, &mut batch, last, &mut tally) {
            return (CullingResult::Visible, tally);
        }
    }
    // What comes before what cannot be projected is compared first, so that the counts do not depend on the lanes.
    if !take_survivors(setup, survivors, direct, All::Yes, &mut batch, last, &mut tally) || unprojectable {
        return (CullingResult::Visible, tally);
    }
    let result = match (in_view && last.found(), L::PURPOSE) {
        (false, _) => CullingResult::ViewCulled,
        (true, Purpose::Query) => CullingResult::Occluded,
        (true, _) => CullingResult::Visible,
    };
    (result, tally)
}

/// The corners of one triangle in clip space, and on the screen as the vectors have them.
///
/// # Safety
/// The vertices can be read.
#[inline(always)]
unsafe fn corners_of<S: Simd>(
    s: S,
    camera: &Camera,
    reader: &Reader<S>,
    [a, b, c]: [u32; 3],
) -> ([[f32; 3]; 3], [[f32; 3]; 3]) {
    let mut indices = [c; MAX_LANES];
    (indices[0], indices[1]) = (a, b);
    let mut lanes = [[0.0_f32; MAX_LANES]; 6];
    // SAFETY: the caller's contract; sixteen floats hold a vector.
    unsafe {
        let v = reader.load_each(indices);
        let clip = reader.to_clip([s.load_f(v[0].as_ptr()), s.load_f(v[1].as_ptr()), s.load_f(v[2].as_ptr())]);
        let screen = project(s, camera, clip);
        for k in 0..3 {
            s.store_f(lanes[k].as_mut_ptr(), clip[k]);
            s.store_f(lanes[3 + k].as_mut_ptr(), screen[k]);
        }
    }
    let corner = |first: usize, k: usize| [lanes[first][k], lanes[first + 1][k], lanes[first + 2][k]];
    ([corner(0, 0), corner(0, 1), corner(0, 2)], [corner(3, 0), corner(3, 1), corner(3, 2)])
}

/// A vector of triangles: their corners on the screen, in the order that setup takes if they face the eye.
struct Group<S: Simd> {
    active: S::M,
    corners: [Corner<S>; 3],
}

/// What a vector of triangles comes to.
struct Sieve<S: Simd> {
    /// Some triangle faces the eye and overlaps the screen.
    in_view: bool,
    /// Regular triangles to set up.
    kept: S::M,
    /// Triangles to clip, a bit a lane.
    irregular: u32,
}

impl<S: Simd> Group<S> {
    /// # Safety
    /// Triangles `position` to `position + count` exist and their vertices are in the scratch.
    #[inline(always)]
    unsafe fn new(
        s: S,
        indices: &[u32],
        position: usize,
        count: usize,
        numbering: Numbering,
        facing: Facing,
        scratch: &Scratch,
    ) -> Self {
        let mut padded = core::mem::MaybeUninit::<[u32; 3 * MAX_LANES]>::uninit();
        let (vertices, group) = match numbering {
            Numbering::From(base) => (scratch.vertex_zero(base), &indices[3 * position..3 * (position + count)]),
            Numbering::Local { first } => {
                // SAFETY: the corners of a chunk that is numbered so were written.
                let local = unsafe { scratch.local(3 * (position - first + count)) };
                (scratch.vertex_zero(0), &local[3 * (position - first)..])
            }
        };
        let indices = if count == S::LANES {
            group.as_ptr()
        } else {
            // Lanes beyond the last are of no account, but have to be in the scratch.
            for k in 0..3 {
                let at = k * S::LANES;
                let n = group.len().saturating_sub(at);
                // SAFETY: no more is read than is there; the array holds three vectors.
                unsafe {
                    let index = s.load_filled(group.as_ptr().wrapping_add(at), n, group[0]);
                    s.store_i(padded.as_mut_ptr().cast::<u32>().add(at), index);
                }
            }
            padded.as_ptr().cast()
        };
        let (second, third) = if facing.swap { (2, 1) } else { (1, 2) };
        // SAFETY: the caller's contract: numbers of projected vertices, three a lane.
        let corners = unsafe {
            [
                s.load_records(vertices, indices),
                s.load_records(vertices, indices.add(second)),
                s.load_records(vertices, indices.add(third)),
            ]
        };
        Self { active: s.first(count), corners }
    }

    #[inline(always)]
    fn sieve(&self, s: S, purpose: Purpose, buffer: &Buffer, camera: &Camera, facing: Facing) -> Sieve<S> {
        let query = purpose == Purpose::Query;
        let [[x0, y0, _], [x1, y1, _], [x2, y2, _]] = self.corners;
        let is_number = |x: S::F| s.eq(x, x);
        let regular = s.and_m(is_number(x0), s.and_m(is_number(x1), is_number(x2)));
        let mut irregular = s.mask_bits(s.and_not_m(regular, self.active));
        if irregular != 0 {
            irregular &= !self.outside(s, query && camera.near_is_raised, camera);
        }
        let mut kept = s.and_m(self.active, regular);

        let (min_x, max_x) = (s.min(x0, s.min(x1, x2)), s.max(x0, s.max(x1, x2)));
        let (min_y, max_y) = (s.min(y0, s.min(y1, y2)), s.max(y0, s.max(y1, y2)));
        let slack = s.f(if query { CLEARLY } else { 0.0 });
        let end = |half: f32| s.add(s.f(2.0 * half), slack);
        let begin = s.sub(s.f(0.0), slack);
        kept = s.and_m(kept, s.and_m(s.lt(begin, max_x), s.lt(min_x, end(camera.half_width))));
        kept = s.and_m(kept, s.and_m(s.lt(begin, max_y), s.lt(min_y, end(camera.half_height))));

        if !facing.both {
            // Twice the area in f32: what it calls an unclear case, setup decides.
            let (dx1, dy1, dx2, dy2) = (s.sub(x1, x0), s.sub(y1, y0), s.sub(x2, x0), s.sub(y2, y0));
            let (p, q) = (s.mul(dx1, dy2), s.mul(dx2, dy1));
            let mut error = s.mul(s.add(s.abs(p), s.abs(q)), s.f(AREA_ERROR));
            if query {
                // Projection and snapping move the corners against each other.
                let girth = s.add(s.add(s.abs(dx1), s.abs(dy1)), s.add(s.abs(dx2), s.abs(dy2)));
                error = s.add(error, s.mul(s.add(girth, s.f(8.0)), s.f(SHIFT)));
            }
            kept = s.and_m(kept, s.lt(s.sub(q, error), p));
        }
        let in_view = s.mask_bits(kept) != 0;

        if !query {
            // Boxes without a pixel centre on the screen.
            let across = holds_centre(s, min_x, max_x, buffer.width());
            kept = s.and_m(kept, s.and_m(across, holds_centre(s, min_y, max_y, buffer.height())));
        }
        Sieve { in_view, kept, irregular }
    }

    /// Triangles with all corners outside of one plane.
    #[inline(always)]
    fn outside(&self, s: S, keep_near: bool, camera: &Camera) -> u32 {
        let planes = outcode::ALL & if keep_near { !outcode::NEAR } else { !0 };
        let codes = s.and(self.code(s, camera, 0), s.and(self.code(s, camera, 1), self.code(s, camera, 2)));
        let shared = s.and(codes, s.i(planes as i32));
        !s.mask_bits(s.eq_i(shared, s.i(0)))
    }
    /// Outcodes of corner `k`: as marked, or else by its place on the screen.
    #[inline(always)]
    fn code(&self, s: S, camera: &Camera, k: usize) -> S::I {
        let (low_row, high_row) =
            if camera.rows_run_down() { (outcode::ABOVE, outcode::BELOW) } else { (outcode::BELOW, outcode::ABOVE) };
        let [x, y, _] = self.corners[k];
        let across = s.or(
            bit_where(s, s.lt(x, s.f(-CLEARLY)), outcode::LEFT),
            bit_where(s, s.lt(s.f(2.0 * camera.half_width + CLEARLY), x), outcode::RIGHT),
        );
        let down = s.or(
            bit_where(s, s.lt(y, s.f(-CLEARLY)), low_row),
            bit_where(s, s.lt(s.f(2.0 * camera.half_height + CLEARLY), y), high_row),
        );
        s.select_i(s.eq(x, x), s.or(across, down), s.bits(x))
    }
}

/// Does a pixel's centre, of `size` pixels, lie from `min` to before `max`?
#[inline(always)]
fn holds_centre<S: Simd>(s: S, min: S::F, max: S::F, size: u32) -> S::M {
    let first = s.sra::<8>(s.add_i(s.round(min), s.i(127)));
    let end = s.sra::<8>(s.add_i(s.round(max), s.i(127)));
    s.gt_i(s.min_i(end, s.i(size as i32)), s.max_i(first, s.i(0)))
}
