//! The link from an object to the pool that draws into it.
//!
//! An engine may query an object from any thread while its pool draws, and may draw into it directly while the pool has
//! nothing in flight. So the object's counter `turns` is incremented each time its pool becomes busy or idle. A query
//! reads the buffer without a lock and keeps its answer if the count has not changed meanwhile; otherwise it asks the
//! pool, which locks the bins that the query reads. This seqlock costs a query only two loads, where a lock would be
//! measurably slower for a small rectangle.

use core::sync::atomic::{AtomicU32, Ordering, fence};
use std::sync::{Arc, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use crate::CullingResult;
use crate::source::Mesh;

/// A pool as seen by its object.
pub(crate) trait Pool: Send + Sync {
    /// Waits until everything submitted is drawn.
    fn flush(&self);

    /// Flushes, then detaches the object with this attachment.
    fn forget(&self, attachment: &Attachment);

    /// Tests a rectangle against what has been drawn so far; `None` if the pool's object has been exchanged.
    fn test_rect(&self, attachment: &Attachment, edges: [f32; 4], w_min: f32) -> Option<CullingResult>;

    /// Tests a mesh against what has been drawn so far; `None` if the pool's object has been exchanged.
    fn test_mesh(&self, attachment: &Attachment, mesh: &Mesh<'_>) -> Option<CullingResult>;
}

/// The object belongs to another pool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Taken;

/// The pool of an object, if it has one.
#[derive(Default)]
pub(crate) struct Attachment {
    /// Odd while the pool has work in flight.
    turns: AtomicU32,
    pool: RwLock<Option<Arc<dyn Pool>>>,
}

impl Attachment {
    /// Does the pool have work in flight?
    #[inline(always)]
    pub fn is_busy(&self) -> bool {
        self.turns.load(Ordering::Acquire) % 2 == 1
    }

    /// The answer to a query of the buffer, unless the pool had work in flight during it.
    ///
    /// A draw that begins during the query writes what it reads: a race, as in any seqlock whose data is not atomic.
    /// The data is only compared, never used as an address, and the answer is discarded here.
    #[inline(always)]
    pub fn undisturbed<R>(&self, ask: impl FnOnce() -> R) -> Option<R> {
        let before = self.turns.load(Ordering::Acquire);
        if before % 2 == 1 {
            return None;
        }
        let answer = ask();
        // The buffer is read before the count is read again.
        fence(Ordering::Acquire);
        (self.turns.load(Ordering::Relaxed) == before).then_some(answer)
    }

    /// Called when the pool becomes busy or idle, alternately, under the pool's lock.
    pub fn turn(&self) {
        self.turns.fetch_add(1, Ordering::AcqRel);
        // The count is written before the buffer: other threads write the buffer after taking the lock under which this
        // is called.
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

    /// Attaches the object to this pool.
    ///
    /// # Errors
    /// [`Taken`] if it belongs to another pool.
    pub fn attach(&self, pool: Arc<dyn Pool>) -> Result<(), Taken> {
        let mut slot = self.write();
        if slot.is_some() {
            return Err(Taken);
        }
        *slot = Some(pool);
        Ok(())
    }

    /// Detaches the object from its pool.
    pub fn detach(&self) {
        *self.write() = None;
    }

    /// The object is going away: its pool draws everything submitted and then has no object.
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
