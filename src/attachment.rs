//! What an object knows of the pool that draws into it.
//!
//! An engine may query an object while its pool draws, from any thread, and may draw into it directly while the pool has nothing
//! in flight. So the object counts, in `turns`, how often its pool began and ended to have something in flight. A query reads
//! the buffer without a lock and keeps its answer where no turn was taken meanwhile; otherwise it asks the pool, which locks
//! what the query reads. A seqlock costs a query two loads, where a lock would double the time of a small rectangle.

use core::sync::atomic::{AtomicU32, Ordering, fence};
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use crate::pipeline::Mesh;
use crate::{CullingResult, Error};

/// A pool, as its object sees it.
pub(crate) trait Pool: Send + Sync {
    /// Waits until everything that was submitted is drawn.
    fn flush(&self);

    /// Forgets the object with this attachment after a flush.
    fn forget(&self, attachment: &Attachment);

    /// Tests a rectangle against what is drawn by now.
    fn test_rect(&self, edges: [f32; 4], w_min: f32) -> Result<CullingResult, Error>;

    /// Tests a mesh against what is drawn by now.
    ///
    /// # Safety
    /// Every vertex from the lowest to the highest index can be read.
    unsafe fn test_mesh(&self, mesh: &Mesh<'_>) -> Result<CullingResult, Error>;
}

/// The pool of an object, if it has one.
#[derive(Default)]
pub(crate) struct Attachment {
    /// Odd while the pool has something in flight.
    turns: AtomicU32,
    pool: RwLock<Option<Arc<dyn Pool>>>,
}

impl Attachment {
    /// Has the pool something in flight?
    #[inline(always)]
    pub fn is_busy(&self) -> bool {
        self.turns.load(Ordering::Acquire) % 2 == 1
    }

    /// Refuses what would change or read the buffer beside the pool.
    #[inline(always)]
    pub fn check_idle(&self) -> Result<(), Error> {
        if self.is_busy() { Err(Error::Busy) } else { Ok(()) }
    }

    /// The answer to a query of the buffer, unless the pool had something in flight meanwhile.
    ///
    /// A draw that begins meanwhile writes what the query reads: a race, as of any seqlock whose data is not atomic. What is read is
    /// compared and never used as an address, and the answer is dropped here.
    #[inline(always)]
    pub fn undisturbed<R>(&self, ask: impl FnOnce() -> R) -> Option<R> {
        let before = self.turns.load(Ordering::Acquire);
        if before % 2 == 1 {
            return None;
        }
        let answer = ask();
        // The buffer is read before the count is.
        fence(Ordering::Acquire);
        (self.turns.load(Ordering::Relaxed) == before).then_some(answer)
    }

    /// The pool has something in flight from now on, or nothing any more. Called in turn, under a lock of the pool.
    pub fn turn(&self) {
        self.turns.fetch_add(1, Ordering::AcqRel);
        // The count is written before the buffer is, which other threads do after they took the lock under which this is called.
        fence(Ordering::Release);
    }

    fn read(&self) -> RwLockReadGuard<'_, Option<Arc<dyn Pool>>> {
        self.pool.read().unwrap_or_else(PoisonError::into_inner)
    }

    fn write(&self) -> RwLockWriteGuard<'_, Option<Arc<dyn Pool>>> {
        self.pool.write().unwrap_or_else(PoisonError::into_inner)
    }

    /// The pool that draws into the object.
    pub fn pool(&self) -> Option<Arc<dyn Pool>> {
        self.read().clone()
    }

    /// Belongs to this pool from now on.
    ///
    /// # Errors
    /// [`Error::Busy`] where it belongs to another one.
    pub fn attach(&self, pool: Arc<dyn Pool>) -> Result<(), Error> {
        let mut slot = self.write();
        if slot.is_some() {
            return Err(Error::Busy);
        }
        *slot = Some(pool);
        Ok(())
    }

    /// Belongs to no pool any more.
    pub fn detach(&self) {
        *self.write() = None;
    }

    /// The object goes away: its pool draws what was submitted and has no object any more.
    pub fn leave(&self) {
        if let Some(pool) = self.pool() {
            pool.forget(self);
            self.detach();
        }
    }
}

impl Drop for Attachment {
    fn drop(&mut self) {
        self.leave();
    }
}
