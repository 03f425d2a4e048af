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
use crate::simd::{Outlined, Simd};
use crate::sink::{Memory, TriangleSink};
use crate::statistics::Tally;

/// A source of triangles.
pub(crate) trait TriangleSource: Sized {
    /// May the corners of its triangles be in either order? Sources for which this changes tell the stream.
    #[inline(always)]
    fn both_sides(&self) -> bool {
        false
    }

    /// Queues all triangles, in order, and flushes the queue when it is full. The only vector of a small call goes to
    /// `direct` instead, which saves a round trip through memory.
    fn feed<S: Simd, K: TriangleSink>(
        self,
        s: S,
        stream: &mut Stream<'_, S, K>,
        direct: &mut Option<Vector<S>>,
    ) -> Result<(), Stopped>;
}

/// The corners of a vector of triangles, and which lanes hold one.
pub(crate) type Vector<S> = ([Corner<S>; 3], <S as Simd>::M);

/// The sink needs no more triangles.
pub(crate) struct Stopped;

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

    /// Submits queued triangles to the sink.
    #[inline(always)]
    pub fn flush(&mut self, drain: Drain) -> Result<(), Stopped> {
        if self.queue.len() == 0 {
            return Ok(());
        }
        // Outlined: a queue is flushed rarely, and all sources share the code.
        self.setup.s.outlined(Flush { stream: self, drain })
    }

    /// Submits a vector of triangles to the sink.
    #[inline(always)]
    fn submit(&mut self, (corners, active): Vector<S>) -> Result<(), Stopped> {
        if self.sink.submit(self.setup, corners, active, self.memory, &mut self.tally) { Ok(()) } else { Err(Stopped) }
    }
}

struct Flush<'f, 'a, S: Simd, K: TriangleSink> {
    stream: &'f mut Stream<'a, S, K>,
    drain: Drain,
}

impl<S: Simd, K: TriangleSink> Outlined<S> for Flush<'_, '_, S, K> {
    type Output = Result<(), Stopped>;

    #[inline(always)]
    fn run(self, s: S) -> Self::Output {
        let Self { stream, drain } = self;
        let len = stream.queue.len();
        let end = if drain == Drain::Everything { len } else { len / S::LANES * S::LANES };
        let mut done = 0;
        while done < end {
            let vector = (stream.queue.vector(s, done), s.first(end - done));
            done += S::LANES.min(end - done);
            stream.submit(vector)?;
        }
        stream.queue.remove(s, end);
        Ok(())
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
        setup: Setup { s, buffer, both_sides: source.both_sides() },
        queue: TriangleQueue::of(&mut queue),
        memory: &mut memory,
        sink,
        tally: Tally::default(),
        in_view: false,
        unprojectable: false,
    };
    let mut direct = None;
    let stopped = source.feed(s, &mut stream, &mut direct).is_err()
        || match direct {
            Some(vector) => stream.submit(vector),
            None => stream.flush(Drain::Everything),
        }
        .is_err()
        || stream.unprojectable;
    (stream.sink.result(stream.in_view, stopped), stream.tally)
}
