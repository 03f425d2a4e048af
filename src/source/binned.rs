//! Feeds the triangles that the pool binned back into the stream: those that may reach a given bin.

use super::{Drain, Stopped, Stream, TriangleSource, Vector};
use crate::raster::queue::CAPACITY;
use crate::simd::{MAX_LANES, Simd};
use crate::sink::{BinnedTriangles, TriangleSink};

/// The triangles of several calls that may reach a bin, in order.
pub(crate) struct Binned<I> {
    pub triangles: I,
    /// The bin's index among those for which the triangles were binned.
    pub bin: usize,
}

impl<'k, I: Iterator<Item = &'k BinnedTriangles>> TriangleSource for Binned<I> {
    #[inline(always)]
    fn feed<S: Simd, K: TriangleSink>(
        self,
        s: S,
        stream: &mut Stream<'_, S, K>,
        _: &mut Option<Vector<S>>,
    ) -> Result<(), Stopped> {
        for block in self.triangles.flat_map(BinnedTriangles::blocks) {
            if block.both_sides != stream.both_sides() {
                // Sinks of binned triangles accept all of them.
                stream.flush(Drain::Everything)?;
                stream.set_both_sides(block.both_sides);
            }
            for (k, &reach) in block.reach(self.bin).iter().enumerate() {
                if reach == 0 {
                    continue;
                }
                let from = block.vector(k, S::LANES).as_ptr();
                // SAFETY: a vector of triangles is nine vectors of floats.
                let load = |n: usize| unsafe { s.load_f(from.add(n * S::LANES)) };
                let corners = [[load(0), load(1), load(2)], [load(3), load(4), load(5)], [load(6), load(7), load(8)]];
                // SAFETY: there is room, because the queue holds at most its capacity less a vector.
                unsafe { stream.queue.append(s, lanes_of(s, u32::from(reach)), &corners) };
                if stream.queue.len() > CAPACITY - MAX_LANES {
                    stream.flush(Drain::FullVectors)?;
                }
            }
        }
        Ok(())
    }
}

/// A mask of the lanes whose bits are set.
#[inline(always)]
fn lanes_of<S: Simd>(s: S, bits: u32) -> S::M {
    const BITS: [u32; MAX_LANES] = {
        let mut bits = [0; MAX_LANES];
        let mut k = 0;
        while k < MAX_LANES {
            bits[k] = 1 << k;
            k += 1;
        }
        bits
    };
    // SAFETY: the array holds a vector.
    let powers = unsafe { s.load_i(BITS.as_ptr()) };
    s.eq_i(s.and(s.i(bits as i32), powers), powers)
}
