//! Settings of a pool.

use core::fmt;

/// Settings of a [`CullingThreadpool`](crate::CullingThreadpool).
///
/// ```
/// use masked_occlusion_culling::{CullingThreadpool, ThreadpoolSettings};
///
/// let pool = CullingThreadpool::new(ThreadpoolSettings::default().with_threads(3).with_bins(4, 8))?;
/// # Ok::<(), masked_occlusion_culling::Error>(())
/// ```
#[non_exhaustive]
pub struct ThreadpoolSettings {
    /// Worker threads of the pool. Fewer are started if there are fewer processors besides the caller's, but at
    /// least one: more would only compete with the others and could preempt one that holds a bin. 0: the work is
    /// done by calls that flush or submit, and by `work_once`.
    pub threads: u32,
    /// Columns of bins. There are at most four bins per thread, and none is smaller than 128 by 64 pixels; the
    /// screen is divided into rows first, because threads side by side would write to the same cache lines.
    pub bins_w: u32,
    /// Rows of bins.
    pub bins_h: u32,
    /// How many calls' arrays may still be read when a draw call returns: a program may rotate among one more
    /// array without a flush. Small calls are gathered into batches of at most half as many, so a larger number
    /// makes them cheaper.
    pub max_jobs: u32,
    /// Processors available to the pool and its caller; 0: as many as the system reports.
    pub processors: u32,
    /// Number of the engine's own threads that will call `work_once`. It only affects the number of bins.
    pub external_threads: u32,
    /// Prefix of the thread names; the thread's number is appended.
    pub thread_name: String,
    /// Called by each worker thread when it starts, with its number, counted from 0: to set its priority or
    /// affinity, or to register it with a profiler.
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

impl fmt::Debug for ThreadpoolSettings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ThreadpoolSettings")
            .field("threads", &self.threads)
            .field("bins", &(self.bins_w, self.bins_h))
            .field("max_jobs", &self.max_jobs)
            .field("processors", &self.processors)
            .field("external_threads", &self.external_threads)
            .field("thread_name", &self.thread_name)
            .finish_non_exhaustive()
    }
}

impl ThreadpoolSettings {
    /// These settings with another number of worker threads.
    pub fn with_threads(self, threads: u32) -> Self {
        Self { threads, ..self }
    }

    /// These settings with other columns and rows of bins.
    pub fn with_bins(self, bins_w: u32, bins_h: u32) -> Self {
        Self { bins_w, bins_h, ..self }
    }

    /// These settings with another limit of calls whose arrays may still be read.
    pub fn with_max_jobs(self, max_jobs: u32) -> Self {
        Self { max_jobs, ..self }
    }

    /// These settings with another number of processors.
    pub fn with_processors(self, processors: u32) -> Self {
        Self { processors, ..self }
    }

    /// These settings with another number of the engine's threads that call `work_once`.
    pub fn with_external_threads(self, external_threads: u32) -> Self {
        Self { external_threads, ..self }
    }

    /// These settings with another prefix of the thread names.
    pub fn with_thread_name(self, prefix: impl Into<String>) -> Self {
        Self { thread_name: prefix.into(), ..self }
    }

    /// These settings with a function that each worker thread calls when it starts, with its number.
    pub fn with_thread_start(self, start: impl Fn(u32) + Send + Sync + 'static) -> Self {
        Self { on_thread_start: Some(Box::new(start)), ..self }
    }
}
