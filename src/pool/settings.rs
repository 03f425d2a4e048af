//! How a pool is made.

/// Of what a [`CullingThreadpool`](crate::CullingThreadpool) is made.
pub struct ThreadpoolSettings {
    /// Threads of the pool's own. There are fewer where there are fewer processors besides the caller's, but one at least: more would
    /// take turns with the others, and interrupt one that holds a bin. 0: the work is done by who flushes, submits or helps.
    pub threads: u32,
    /// The columns into which the screen is cut. There are no more than four bins per thread, and none is smaller than 128 by 64 pixels;
    /// rows of the screen first, because threads side by side would write to the same cache lines.
    pub bins_w: u32,
    /// The rows.
    pub bins_h: u32,
    /// Calls whose arrays may still be read when a call that draws returns: a program may go round among one array more without a flush.
    /// Small calls are gathered into batches of half as many at most, so that a larger number makes them cheaper.
    pub max_jobs: u32,
    /// Processors that the pool and its caller have; 0: as many as the system says.
    pub processors: u32,
    /// Threads of the engine's own that will call `work_once`. It only says how many bins are worth having.
    pub external_threads: u32,
    /// What the names of the threads begin with; the number of the thread follows.
    pub thread_name: String,
    /// Called by each thread when it starts, with its number from 0 on: for its priority, its affinity, or a profiler.
    pub on_thread_start: Option<ThreadStart>,
}

/// Called by a thread of a pool when it starts.
pub type ThreadStart = Box<dyn Fn(u32) + Send + Sync>;

impl Default for ThreadpoolSettings {
    fn default() -> Self {
        Self {
            threads: 1,
            bins_w: 4,
            bins_h: 4,
            max_jobs: 32,
            processors: 0,
            external_threads: 0,
            thread_name: String::from("culling"),
            on_thread_start: None,
        }
    }
}
