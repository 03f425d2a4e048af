//! The matrix and vertex layout set on a pool. Each thread has its own, so that no thread draws or tests with those
//! that another has just set.

use std::cell::RefCell;
use std::sync::{Arc, Mutex, PoisonError, Weak};

use super::mesh::MeshArguments;
use super::types::MOC_VertexLayout;
use crate::VertexLayout;

#[derive(Clone, Copy, Debug)]
pub(super) struct State {
    pub matrix: Option<[f32; 16]>,
    pub layout: MOC_VertexLayout,
}

impl State {
    /// A mesh with this matrix and layout, to which it holds pointers.
    pub fn mesh(
        &self,
        vertices: *const f32,
        triangles: *const u32,
        n_triangles: i32,
        winding: i32,
        clip_planes: i32,
    ) -> MeshArguments {
        MeshArguments {
            vertices,
            vertex_floats: None,
            triangles,
            n_triangles,
            model_to_clip: self.matrix.as_ref().map_or(core::ptr::null(), |matrix| matrix.as_ptr()),
            winding,
            clip_planes,
            layout: &raw const self.layout,
        }
    }
}

/// The state that was set on a pool.
#[derive(Debug)]
pub(super) struct PoolState {
    /// Set by any thread, most recently: used by threads that have never set anything. Its address identifies the pool.
    last: Arc<Mutex<State>>,
}

thread_local! {
    /// What this thread set, for each pool that still exists.
    static OWN: RefCell<Vec<(Weak<Mutex<State>>, State)>> = const { RefCell::new(Vec::new()) };
}

impl Default for PoolState {
    fn default() -> Self {
        Self { last: Arc::new(Mutex::new(State { matrix: None, layout: VertexLayout::CLIP_SPACE.into() })) }
    }
}

impl PoolState {
    /// The calling thread's state.
    pub fn get(&self) -> State {
        let own = |(pool, state): &(Weak<_>, State)| (Weak::as_ptr(pool) == Arc::as_ptr(&self.last)).then_some(*state);
        // A thread that is ending no longer has one.
        let own = OWN.try_with(|states| states.borrow().iter().find_map(own)).ok().flatten();
        own.unwrap_or_else(|| *self.last.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Changes the calling thread's state.
    pub fn change(&self, change: impl FnOnce(&mut State)) {
        let mut state = self.get();
        change(&mut state);
        let _ = OWN.try_with(|states| {
            let mut states = states.borrow_mut();
            match states.iter_mut().find(|(pool, _)| Weak::as_ptr(pool) == Arc::as_ptr(&self.last)) {
                Some((_, own)) => *own = state,
                None => {
                    states.retain(|(pool, _)| pool.strong_count() > 0);
                    states.push((Arc::downgrade(&self.last), state));
                }
            }
        });
        *self.last.lock().unwrap_or_else(PoisonError::into_inner) = state;
    }
}
