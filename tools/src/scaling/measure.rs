//! Timing: libraries alternate on the same scene; the result is the median of the repeats.

use std::time::{Duration, Instant};

use super::culler::{Culler, frame, hidden};
use super::scene::Scene;
use crate::Result;

/// The result for a library.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub seconds: f64,
    pub repeats: usize,
    /// Number of rectangles behind everything that are hidden; see [`hidden`].
    pub hidden: usize,
}

/// A median of fewer means little; more add nothing.
const REPEATS: (usize, usize) = (5, 1001);

/// Draws the scene with each library alternately, until `limit` has passed.
pub fn measure(
    cullers: &mut [Box<dyn Culler>],
    scene: &Scene,
    (width, height): (u32, u32),
    limit: Duration,
) -> Result<Vec<Sample>> {
    let start = Instant::now();
    for culler in cullers.iter_mut() {
        culler.set_size(width, height)?;
        culler.set_near(scene.near);
        // Not counted: the first frame touches memory that the system has not mapped yet.
        frame(&mut **culler, scene);
    }
    let mut times = vec![Vec::new(); cullers.len()];
    let mut repeats = 0;
    while repeats < REPEATS.0 || repeats < REPEATS.1 && start.elapsed() < limit {
        for (culler, times) in cullers.iter_mut().zip(&mut times) {
            let start = Instant::now();
            frame(&mut **culler, scene);
            times.push(start.elapsed());
        }
        repeats += 1;
    }
    let samples = cullers.iter().zip(times).map(|(culler, times)| Sample {
        seconds: median(times).as_secs_f64(),
        repeats,
        hidden: hidden(&**culler),
    });
    Ok(samples.collect())
}

/// The median; the upper one of the two middle values for an even count.
fn median(mut times: Vec<Duration>) -> Duration {
    times.sort();
    times[times.len() / 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle_one() {
        assert_eq!(median([5, 1, 9, 2, 7].map(Duration::from_secs).to_vec()), Duration::from_secs(5));
        assert_eq!(median(vec![Duration::from_secs(3)]), Duration::from_secs(3));
    }
}
