//! One sequence of calls on two families of objects, and the checks at its end.

use std::collections::VecDeque;
use std::fmt;
use std::mem::replace;

use fastrand::Rng;

use crate::calls::Driver;
use crate::family::{Check, Family, ensure};
use crate::guarded::Guarded;
use crate::memory;

/// The maximum number of meshes in flight in a pool.
const LENT: usize = 48;

/// The arrays that calls read and write, all in guarded memory.
pub struct Memory {
    pub vertices: Guarded,
    pub indices: Guarded,
    pub matrix: Guarded,
    pub layout: Guarded,
    pub scissor: Guarded,
    pub depth: Guarded,
    /// Vertices and indices that a pool may still read, oldest first, and their number.
    lent: VecDeque<[Guarded; 2]>,
    pub lent_count: usize,
    /// For each member of a family: the list structs, and the memory that they point to.
    pub lists: Vec<(Guarded, Guarded)>,
}

impl Memory {
    pub fn new() -> Self {
        Self {
            vertices: Guarded::new(1 << 16),
            indices: Guarded::new(1 << 16),
            matrix: Guarded::new(1 << 12),
            layout: Guarded::new(1 << 12),
            scissor: Guarded::new(1 << 12),
            depth: Guarded::new(1 << 22),
            lent: (0..LENT).map(|_| [Guarded::new(1 << 16), Guarded::new(1 << 16)]).collect(),
            lent_count: 0,
            lists: (0..8).map(|_| (Guarded::new(1 << 12), Guarded::new(1 << 20))).collect(),
        }
    }

    /// Whether every array is in use by a pool, which has to be flushed before the next mesh.
    pub fn all_lent(&self) -> bool {
        self.lent_count == LENT
    }

    /// Leaves the arrays of the last mesh unchanged and takes the least recently used ones.
    pub fn lend(&mut self) {
        if let Some([vertices, indices]) = self.lent.pop_front() {
            let used = [replace(&mut self.vertices, vertices), replace(&mut self.indices, indices)];
            self.lent.push_back(used);
        }
        self.lent_count += 1;
    }
}

/// Counts of what was done so far.
#[derive(Default)]
pub struct Tally {
    pub episodes: u64,
    pub calls: u64,
    /// Those of them made through a thread pool, on one object each.
    pub pooled: u64,
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} episodes, {} calls, {} through a pool", self.episodes, self.calls, self.pooled)
    }
}

/// Runs an episode; the same seed and number give the same calls. If only one is run, it is checked after each call.
pub fn run(seed: u64, number: u64, single: bool, memory: &mut Memory, tally: &mut Tally) -> Check {
    let mut rng = Rng::with_seed(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(number));
    let families = [family(&mut rng)?, family(&mut rng)?];
    let mut driver = Driver { rng, memory, families, pooled: 0 };
    for call in 0..driver.rng.usize(10..80) {
        let which = driver.rng.usize(..2);
        driver.step(which).map_err(|failure| format!("call {call}: {failure}\n{}", driver.families[which]))?;
        if single {
            // Closer to the cause, without changing the calls that follow.
            let rng = driver.rng.clone();
            driver.check_depth(which).map_err(|failure| format!("after call {call}: {failure}"))?;
            driver.rng = rng;
        }
        tally.calls += driver.families[0].members.len() as u64;
    }
    for which in 0..2 {
        driver.check_depth(which)?;
        driver.check_statistics(which)?;
    }
    // In a stretch, all other members are called, too.
    tally.pooled += driver.pooled;
    tally.calls += driver.pooled * driver.families[0].members.len() as u64;
    drop(driver);
    tally.episodes += 1;
    ensure(memory::live_blocks() == 0, || format!("{} blocks of memory were not freed", memory::live_blocks()))
}

fn family(rng: &mut Rng) -> Check<Family> {
    // The same axis more often than not, so that merging is allowed.
    // With statistics, threads draw some of what they otherwise skip.
    Family::new(rng.i32(0..4), i32::from(rng.u8(..4) == 0), rng.bool(), rng.bool())
}
