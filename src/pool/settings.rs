//! Settings of a pool.

/// Settings of a [`CullingThreadpool`](crate::CullingThreadpool).
pub struct ThreadpoolSettings {
    /// Worker threads of the pool. Fewer are started if there are fewer processors besides the caller's, but at least one: more
    /// would only take turns with the others, and preempt one that holds a bin. 0: the work is done by the calls that flush or
    /// submit, and by `work_once`.
    pub threads: u32,
    /// Columns of bins. There are at most four bins per thread, and none is smaller than 128 by 64 pixels; the screen is
    /// divided into rows first, because threads side by side would write to the same cache lines.
    pub bins_w: u32,
    /// Rows of bins.
    pub bins_h: u32,
    /// How many calls' arrays may still be read when a draw call returns: a program may rotate among one array more without a
    /// flush. Small calls are gathered into batches of at most half as many, so a larger number makes them cheaper.
    pub max_jobs: u32,
    /// Processors available to the pool and its caller; 0: as many as the system reports.
    pub processors: u32,
    /// Number of the engine's own threads that will call `work_once`. It only affects the number of bins.
    pub external_threads: u32,
    /// Prefix of the thread names; the thread's number is appended.
    pub thread_name: String,
    /// Called by each worker thread when it starts, with its number, counted from 0: to set its priority or affinity, or to
    /// register it with a profiler.
    pub on_thread_start: Option<ThreadStart>,
}

/// Called by a worker thread when it starts.
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
