//! Triangle sources: an indexed mesh, a list, the pool's binned triangles. One driver feeds any of them to any sink.

mod binned;
mod chunk;
mod cull;
mod list;
pub(crate) mod mesh;
mod pages;
mod scratch;
pub(crate) mod vertex_reader;

pub(crate) use binned::Binned;
pub(crate) use chunk::IndexRange;
pub(crate) use mesh::{Mesh, MeshTriangles};
pub(crate) use vertex_reader::VertexReader;

use crate::CullingResult;
use crate::buffer::Buffer;
use crate::geometry::Corner;
use crate::raster::{Setup, TriangleQueue};
use crate::simd::Simd;
use crate::sink::{Memory, TriangleSink};
use crate::statistics::Tally;

/// A source of triangles.
pub(crate) trait TriangleSource: Sized {
    /// May the corners of its triangles be in either order? Sources for which this changes tell the stream.
    #[inline(always)]
    fn both_sides(&self) -> bool {
        false
    }

    /// Queues all triangles, in order, and submits them when the queue is full. Returns false if the sink needs no
    /// more.
    fn feed<S: Simd, K: TriangleSink>(self, s: S, stream: &mut Stream<'_, S, K>) -> bool;
}

/// Whether triangles that do not fill a vector are submitted too, or wait for more.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Drain {
    Everything,
    FullVectors,
}

/// The path of a call's triangles from its source to its sink.
pub(crate) struct Stream<'a, S: Simd, K: TriangleSink> {
    setup: Setup<'a, S>,
    pub queue: &'a mut TriangleQueue,
    /// The only triangles of a small call, submitted before those of the queue; this saves a round trip through memory.
    direct: Option<([Corner<S>; 3], S::M)>,
    memory: &'a mut Memory<K::Memory>,
    sink: &'a mut K,
    pub tally: Tally,
    /// Some triangle is front-facing and overlaps the screen.
    pub in_view: bool,
    /// A triangle cannot be projected. The ones before it decide first, so that counts do not depend on the vector
    /// width.
    pub unprojectable: bool,
}

impl<S: Simd, K: TriangleSink> Stream<'_, S, K> {
    pub fn both_sides(&self) -> bool {
        self.setup.both_sides
    }

    /// The queue must be empty.
    pub fn set_both_sides(&mut self, both_sides: bool) {
        debug_assert_eq!(self.queue.len(), 0);
        self.setup.both_sides = both_sides;
    }

    /// Sets the only triangles of a call.
    #[inline(always)]
    pub fn set_direct(&mut self, corners: [Corner<S>; 3], active: S::M) {
        self.direct = Some((corners, active));
    }

    /// Submits queued triangles to the sink. Returns false if it needs no more.
    #[inline(always)]
    pub fn submit(&mut self, drain: Drain) -> bool {
        let s = self.setup.s;
        let len = self.queue.len();
        let end = if drain == Drain::Everything { len } else { len / S::LANES * S::LANES };
        let mut done = 0;
        loop {
            let (corners, active) = match self.direct.take() {
                Some(vector) => vector,
                None if done < end => {
                    let vector = (self.queue.vector(s, done), s.first(end - done));
                    done += S::LANES.min(end - done);
                    vector
                }
                None => break,
            };
            if !self.sink.submit(self.setup, corners, active, self.memory, &mut self.tally) {
                return false;
            }
        }
        self.queue.remove(s, end);
        true
    }
}

/// The driver: feeds all triangles of a source to a sink.
#[inline(always)]
pub(crate) fn drive<S: Simd, Q: TriangleSource, K: TriangleSink>(
    s: S,
    buffer: &Buffer,
    source: Q,
    sink: &mut K,
) -> (CullingResult, Tally) {
    let mut queue = TriangleQueue::uninit();
    let mut memory = Memory::uninit();
    let mut stream = Stream {
        setup: Setup { s, buffer, both_sides: source.both_sides(), scope: sink.scope() },
        queue: TriangleQueue::of(&mut queue),
        direct: None,
        memory: &mut memory,
        sink,
        tally: Tally::default(),
        in_view: false,
        unprojectable: false,
    };
    let finished = source.feed(s, &mut stream) && stream.submit(Drain::Everything);
    let stopped = !finished || stream.unprojectable;
    (stream.sink.result(stream.in_view, stopped), stream.tally)
}
