//! Indexed meshes: vertices are projected in chunks, their triangles culled a vector at a time, and the few that need
//! clipping are clipped.

use super::chunk::{self, Chunk};
use super::cull::Packet;
use super::scratch::Scratch;
use super::vertex_reader::VertexReader;
use super::{Drain, Stopped, Stream, TriangleSource, Vector};
use crate::DrawOptions;
use crate::geometry::clip::{self, Clipped};
use crate::geometry::{Camera, Coverage, Facing, project};
use crate::raster::queue::CAPACITY;
use crate::simd::{MAX_LANES, Simd};
use crate::sink::TriangleSink;
use crate::vertices::VertexSource;

/// If more triangles than this are queued, there may be no room for another packet's.
const FULL: usize = CAPACITY - MAX_LANES * clip::MAX_TRIANGLES;

/// A mesh of so few vertices may be looked at as a whole first: a box, a simple hull.
const FEW_VERTICES: usize = 24;

/// The triangles of a call, three indices each; their vertices can be read.
#[derive(Clone, Copy)]
pub(crate) struct Mesh<'a> {
    vertices: VertexSource,
    matrix: Option<&'a [f32; 16]>,
    triangles: &'a [u32],
    options: &'a DrawOptions,
}

impl<'a> Mesh<'a> {
    /// # Safety
    /// As long as the mesh exists, every vertex from the lowest to the highest index can be read: its x, y and w
    /// (or z), and in vertices of 12 or 16 bytes with y at 4 and w (or z) at 8 or 12, also what lies in between.
    #[inline(always)]
    pub unsafe fn new(
        vertices: VertexSource,
        matrix: Option<&'a [f32; 16]>,
        triangles: &'a [u32],
        options: &'a DrawOptions,
    ) -> Self {
        Self { vertices, matrix, triangles, options }
    }

    /// From model space to clip space; `None` for vertices in clip space.
    pub fn matrix(&self) -> Option<&'a [f32; 16]> {
        self.matrix
    }

    pub fn vertices(&self) -> VertexSource {
        self.vertices
    }

    pub fn triangles(&self) -> &'a [u32] {
        self.triangles
    }

    pub fn options(&self) -> &'a DrawOptions {
        self.options
    }
}

/// The triangles of a mesh, seen through a camera.
pub(crate) struct MeshTriangles<'a> {
    mesh: &'a Mesh<'a>,
    camera: &'a Camera,
    facing: Facing,
}

impl<'a> MeshTriangles<'a> {
    #[inline(always)]
    pub fn new(mesh: &'a Mesh<'a>, camera: &'a Camera) -> Self {
        Self { mesh, camera, facing: Facing::new(mesh.options.winding, camera) }
    }
}

impl TriangleSource for MeshTriangles<'_> {
    #[inline(always)]
    fn both_sides(&self) -> bool {
        self.facing.both
    }

    #[inline(always)]
    fn feed<S: Simd, K: TriangleSink>(
        self,
        s: S,
        stream: &mut Stream<'_, S, K>,
        direct: &mut Option<Vector<S>>,
    ) -> Result<(), Stopped> {
        let Self { mesh, camera, facing } = self;
        let camera = &camera.with_guard_band(K::Coverage::GUARD_BAND);
        let reader = VertexReader::new(s, mesh.vertices, mesh.matrix);
        let screen = stream.setup.buffer.size();
        let mut memory = Scratch::uninit();
        let scratch = Scratch::of(&mut memory);
        let (mut in_view, mut asked) = (false, false);
        let triangles = mesh.triangles.len() / 3;
        stream.tally.processed = triangles as u64;
        let (mut position, mut chunk) = (0, Chunk::NONE);

        while position < triangles && !stream.unprojectable {
            if position == chunk.end {
                // SAFETY: a mesh's vertices can be read.
                chunk =
                    unsafe { chunk::project::<S, K::Coverage>(s, camera, &reader, mesh.triangles, position, scratch) };
                if chunk.outside {
                    position = chunk.end;
                    continue;
                }
            }
            chunk.prefetch_next(s, mesh.triangles, position);
            let count = S::LANES.min(chunk.end - position);
            // SAFETY: `count` triangles from `position` on are in the mesh, and their vertices are in the scratch.
            let packet = unsafe { Packet::new(s, mesh.triangles, position, count, chunk.numbering, facing, scratch) };
            let culled = packet.cull::<K::Coverage>(s, screen, camera, facing);
            in_view |= culled.in_view;
            let kept = s.mask_bits(culled.kept);
            if K::LOOKS_FIRST && kept != 0 && !asked {
                asked = true;
                // SAFETY: the lane is one of the vector's.
                let corner = unsafe { packet.nearest_corner(s, kept.trailing_zeros() as usize) };
                if stream.sink.is_decided_by(corner) {
                    return Err(Stopped);
                }
                let few = (1..=FEW_VERTICES).contains(&chunk.vertices) && chunk.end == triangles;
                // SAFETY: the chunk's vertices were written.
                if few && stream.sink.hides_all(s, corner, unsafe { scratch.first(chunk.vertices) }) {
                    stream.in_view = true;
                    return Ok(());
                }
            }
            if culled.irregular == 0 {
                if kept != 0 && triangles <= S::LANES {
                    *direct = Some((packet.corners, culled.kept));
                } else if kept != 0 {
                    // SAFETY: below `FULL` there is room.
                    unsafe { stream.queue.append(s, culled.kept, &packet.corners) };
                }
            } else {
                let mut lanes = [[0.0; MAX_LANES]; 9];
                for k in 0..9 {
                    // SAFETY: sixteen floats hold a vector.
                    unsafe { s.store_f(lanes[k].as_mut_ptr(), packet.corners[k / 3][k % 3]) };
                }
                for lane in 0..count {
                    if kept >> lane & 1 == 1 {
                        let corner = |k: usize| [lanes[3 * k][lane], lanes[3 * k + 1][lane], lanes[3 * k + 2][lane]];
                        stream.queue.push(&[corner(0), corner(1), corner(2)]);
                    } else if culled.irregular >> lane & 1 == 1 {
                        let at = 3 * (position + lane);
                        let corners = [mesh.triangles[at], mesh.triangles[at + 1], mesh.triangles[at + 2]];
                        // SAFETY: a mesh's vertices can be read.
                        let (clip, screen) = unsafe { corners_of(s, camera, &reader, corners) };
                        match clip::triangle::<K::Coverage>(camera, &clip, &screen) {
                            Clipped::Nothing => {}
                            Clipped::Dropped => stream.tally.dropped += 1,
                            Clipped::Unprojectable => {
                                stream.unprojectable = true;
                                break;
                            }
                            Clipped::Polygon(polygon) => {
                                let before = stream.queue.len();
                                polygon.emit::<K::Coverage>(camera, facing, |triangle| stream.queue.push(triangle));
                                in_view |= stream.queue.len() > before;
                            }
                        }
                    }
                }
            }
            position += count;
            if stream.queue.len() > FULL {
                stream.flush(Drain::FullVectors)?;
            }
        }
        stream.in_view = in_view;
        Ok(())
    }
}

/// The corners of one triangle in clip space, and on the screen as computed by the vector code.
///
/// # Safety
/// The vertices can be read.
#[inline(always)]
unsafe fn corners_of<S: Simd>(
    s: S,
    camera: &Camera,
    reader: &VertexReader<S>,
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
