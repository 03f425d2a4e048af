//! How many threads a pool starts, and what happens when its scheduler panics.

// WebAssembly has no threads or processes.
#![cfg(not(target_family = "wasm"))]

use std::process::Command;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Duration;

use super::schedule::BREAKS;
use super::{CullingThreadpool, MAX_THREADS, ThreadpoolSettings};
use crate::{DrawOptions, Error, MaskedOcclusionCulling, Settings, Vertices};

fn pool(threads: u32, processors: u32) -> Result<CullingThreadpool, Error> {
    CullingThreadpool::new(ThreadpoolSettings::default().with_threads(threads).with_processors(processors))
}

#[test]
fn there_are_no_more_threads_than_processors_besides_the_callers_but_one_at_least() {
    for (threads, processors, started) in [(0, 8, 0), (1, 1, 1), (1, 8, 1), (8, 1, 1), (8, 2, 1), (8, 5, 4)] {
        let pool = pool(threads, processors).unwrap();
        assert_eq!(pool.thread_count(), started, "{threads} threads, {processors} processors");
    }
    assert!(pool(MAX_THREADS + 1, 2).is_err());
}

/// Makes the scheduler panic while slices are lent to it, in a separate process.
fn break_it(who: &str) {
    let settings = ThreadpoolSettings::default().with_threads(1).with_bins(1, 1).with_processors(2);
    let pool = CullingThreadpool::new(settings).unwrap();
    pool.set_buffer(MaskedOcclusionCulling::new(640, 400, Settings::default()).unwrap());
    let (vertices, triangles) = ([[1.0; 4]; 4], [0, 1, 2]);
    let vertices = Vertices::clip_space(&vertices);
    let caught = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        pool.scope(|scope| {
            scope.render_triangles(vertices, &triangles, &DrawOptions::default()).unwrap();
            BREAKS.store(true, Relaxed);
            if who == "worker" {
                pool.wake_threads();
                // The worker aborts the process meanwhile. The flush below would do so too, and must not mask a worker
                // that does not.
                std::thread::sleep(Duration::from_secs(60));
                println!("the worker did not abort");
                std::process::exit(0);
            }
        });
    }));
    // Must not be reached: the pool would still read the lent slices later.
    println!("came back, unwinding: {}", caught.is_err());
    std::process::exit(0);
}

#[test]
fn a_scheduler_that_panics_ends_the_process() {
    const NAME: &str = "pool::tests::a_scheduler_that_panics_ends_the_process";
    if let Ok(who) = std::env::var("MOC_TEST_BREAKS") {
        break_it(&who);
    }
    for who in ["worker", "flush"] {
        let program = std::env::current_exe().unwrap();
        let mut child = Command::new(program);
        child.args([NAME, "--exact", "--nocapture"]).env("MOC_TEST_BREAKS", who);
        let output = child.output().unwrap();
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success(), "{who}: it returned");
        assert!(errors.contains("broken on purpose") && errors.contains("aborting"), "{who}: {errors}");
    }
}
