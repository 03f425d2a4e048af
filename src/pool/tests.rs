//! How many threads a pool starts.

// There are no threads in WebAssembly.
#![cfg(not(target_family = "wasm"))]

use super::{CullingThreadpool, MAX_THREADS};

#[test]
fn there_are_no_more_threads_than_processors_besides_the_callers_but_one_at_least() {
    for (threads, processors, started) in [(0, 8, 0), (1, 1, 1), (1, 8, 1), (8, 0, 1), (8, 1, 1), (8, 2, 1), (8, 5, 4)]
    {
        let pool = CullingThreadpool::with_processors(threads, 4, 4, 32, processors).unwrap();
        assert_eq!(pool.threads.len(), started, "{threads} threads, {processors} processors");
    }
    assert!(CullingThreadpool::with_processors(MAX_THREADS + 1, 4, 4, 32, 2).is_err());
}
