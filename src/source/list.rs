//! Triangle lists: already projected, but in memory that the caller can write to.

use core::ops::Range;

use super::{Drain, Stopped, Stream, TriangleSource, Vector};
use crate::bins::{FLOATS_PER_TRIANGLE, TriList};
use crate::float_environment::round_ties_even;
use crate::geometry::camera::{FARTHEST_W, NEAREST_W};
use crate::geometry::{Coverage, Exact};
use crate::raster::TriangleQueue;
use crate::raster::queue::CAPACITY;
use crate::simd::Simd;
use crate::sink::TriangleSink;
use crate::statistics::Tally;

/// The triangles of a list, whose corners were put in order when it was filled.
impl TriangleSource for &TriList<'_> {
    #[inline(always)]
    fn feed<S: Simd, K: TriangleSink>(
        self,
        _: S,
        stream: &mut Stream<'_, S, K>,
        _: &mut Option<Vector<S>>,
    ) -> Result<(), Stopped> {
        stream.tally.processed = self.len() as u64;
        let mut position = 0;
        while position < self.len() {
            let end = self.len().min(position + CAPACITY);
            fetch(self, position..end, stream.queue, &mut stream.tally);
            position = end;
            stream.flush(Drain::Everything)?;
        }
        Ok(())
    }
}

/// Queues the triangles of a list, skipping those that binning cannot have produced.
fn fetch(list: &TriList<'_>, range: Range<usize>, queue: &mut TriangleQueue, tally: &mut Tally) {
    let limit = Exact::GUARD_BAND + (1 << 22) as f32;
    let sound = |&[x, y, z]: &[f32; 3]| {
        let whole = |x: f32| x.abs() <= limit && f64::from(x) == round_ties_even(f64::from(x));
        // Slightly wider than the range of 1/w, because clipping rounds.
        whole(x) && whole(y) && (0.5 / FARTHEST_W..=2.0 / NEAREST_W).contains(&z)
    };
    for triangle in range {
        let corners: [[f32; 3]; 3] = list.get(triangle);
        if corners.iter().all(sound) {
            queue.push(&corners);
        } else {
            tally.dropped += 1;
        }
    }
}

const _: () = assert!(FLOATS_PER_TRIANGLE == 9);
