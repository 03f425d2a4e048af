//! What threads wait on, in one place, so that a test can put a model in its stead (`tests/pool_interleavings.rs`).

pub(super) use std::sync::{Arc, Condvar, Mutex, MutexGuard};
