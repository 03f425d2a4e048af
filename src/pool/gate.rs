//! Access to a pool's object: calls that submit or query take it shared, calls that exchange or resize the object take
//! it exclusively.
//!
//! The object knows the gate of its pool ([`Attachment`](crate::attachment::Attachment)), so that direct queries of the
//! object go through the pool while it draws, and so that neither uses the other after that is gone.

use core::ptr::NonNull;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use super::target::{Bins, Target};
use super::workers::Workers;
use crate::attachment::{Attachment, Pool, Taken};
use crate::source::Mesh;
use crate::{CullingResult, Error, MaskedOcclusionCulling};

pub(super) struct Gate {
    pub workers: Arc<Workers>,
    bins: Bins,
    /// Read-locked to submit or query, write-locked to exchange the target.
    target: RwLock<Option<Arc<Target>>>,
    /// Held around each call while recording, so that the file lists the calls in drawing order.
    recording: Mutex<()>,
}

/// Access to the target, which cannot be exchanged meanwhile.
pub(super) type Pass<'a> = RwLockReadGuard<'a, Option<Arc<Target>>>;

impl Gate {
    pub fn new(workers: Arc<Workers>, bins: Bins) -> Self {
        Self { workers, bins, target: RwLock::new(None), recording: Mutex::new(()) }
    }

    /// Draws what was submitted so far, then switches to this object, or to none. True: the pool owns it.
    ///
    /// # Errors
    /// [`Taken`] if it belongs to another pool; nothing changes.
    ///
    /// # Safety
    /// As [`Target::new`], until another one is set or [`Pool::forget`] is called.
    pub unsafe fn exchange(
        self: &Arc<Self>,
        moc: Option<(NonNull<MaskedOcclusionCulling>, bool)>,
    ) -> Result<(), Taken> {
        let mut gate = self.shut();
        self.workers.flush();
        let new = moc.map(|(moc, owned)| {
            // SAFETY: the caller's contract.
            Arc::new(unsafe { Target::new(moc, owned, self.bins) })
        });
        let pointer = |target: &Option<Arc<Target>>| target.as_ref().map(|target| target.pointer());
        if pointer(&new) != pointer(&gate) {
            if let Some(target) = new.as_ref().filter(|target| !target.is_owned()) {
                target.moc().attachment().attach(self.clone())?;
            }
            detach(&gate);
        }
        self.workers.set_target(new.clone());
        *gate = new;
        Ok(())
    }

    /// Flushes, and returns the object if the pool owns it. An object that it does not own stays attached.
    pub fn take_owned(&self) -> Option<MaskedOcclusionCulling> {
        let mut gate = self.shut();
        if !gate.as_ref()?.is_owned() {
            return None;
        }
        self.workers.flush();
        self.workers.set_target(None);
        Arc::into_inner(gate.take()?)?.into_owned()
    }

    /// Flushes, and detaches the object.
    pub fn close(&self) {
        let mut gate = self.shut();
        self.workers.flush();
        detach(&gate);
        self.workers.set_target(None);
        *gate = None;
    }

    /// Flushes, then applies a change to the object that may alter its size. Meanwhile nothing is in flight and no
    /// thread submits or queries.
    pub fn resize(&self, change: impl FnOnce(&mut MaskedOcclusionCulling) -> Result<(), Error>) -> Result<(), Error> {
        let mut gate = self.shut();
        self.workers.flush();
        let target = gate.as_ref().ok_or(Error::NoObject)?;
        // SAFETY: nothing is in flight, and the write lock keeps threads from submitting or querying.
        change(unsafe { &mut *target.pointer().as_ptr() })?;
        self.cut_again(&mut gate);
        Ok(())
    }

    /// Rebuilds the bins. Nothing may be in flight.
    fn cut_again(&self, gate: &mut Option<Arc<Target>>) {
        self.workers.set_target(None);
        // No other reference exists: threads drop theirs before they report a task as done.
        if let Some(target) = gate.take().and_then(Arc::into_inner) {
            *gate = Some(Arc::new(target.resized(self.bins)));
        }
        self.workers.set_target(gate.clone());
    }

    /// The target, with bins that fit its object: the owner may have changed the resolution after a flush.
    pub fn pass(&self) -> Pass<'_> {
        loop {
            let pass = self.target.read().unwrap_or_else(PoisonError::into_inner);
            if !pass.as_ref().is_some_and(|target| target.is_outdated()) {
                return pass;
            }
            drop(pass);
            let mut gate = self.shut();
            self.workers.flush();
            self.cut_again(&mut gate);
        }
    }

    /// The target, if its object has a buffer; only objects of the C interface may have none.
    ///
    /// # Errors
    /// [`Error::NoObject`], and any error of the call.
    pub fn with_buffer<R, E: From<Error>>(&self, call: impl FnOnce(&Target) -> Result<R, E>) -> Result<R, E> {
        let pass = self.pass();
        let target = pass.as_ref().filter(|target| target.moc().has_buffer()).ok_or(Error::NoObject)?;
        call(target)
    }

    /// The target, if its object is the one with this attachment.
    fn with_object_of<R>(&self, attachment: &Attachment, call: impl FnOnce(&Target) -> R) -> Option<R> {
        let pass = self.pass();
        let target = pass.as_ref().filter(|target| core::ptr::eq(target.moc().attachment(), attachment))?;
        Some(call(target))
    }

    /// Tests a rectangle against what has been drawn so far.
    pub fn rect(&self, target: &Target, edges: [f32; 4], w_min: f32) -> CullingResult {
        let tiles = target.moc().rectangle_tiles(edges);
        let recording = self.recording(target);
        // Checked before the query: an answer given while work is in flight depends on timing, so a replay cannot be
        // compared with it.
        let settled = recording.is_some() && self.workers.is_done();
        let result = target.query(tiles, |moc| moc.ask_rect(edges, w_min));
        target.moc().recorder().test_rect(settled.then_some(result), edges, w_min);
        result
    }

    /// Tests a mesh against what has been drawn so far.
    pub fn mesh(&self, target: &Target, mesh: &Mesh<'_>) -> CullingResult {
        let recording = self.recording(target);
        // As in `rect`.
        let settled = recording.is_some() && self.workers.is_done();
        let result = target.query(target.all_tiles(), |moc| moc.ask_triangles(mesh));
        target.moc().recorder().test_triangles(settled.then_some(result), mesh);
        result
    }

    fn shut(&self) -> RwLockWriteGuard<'_, Option<Arc<Target>>> {
        self.target.write().unwrap_or_else(PoisonError::into_inner)
    }

    /// The recording lock, while calls are recorded.
    pub fn recording(&self, target: &Target) -> Option<MutexGuard<'_, ()>> {
        // The holder may do pool work meanwhile, which does not need this lock.
        target.moc().recorder().is_on().then(|| self.recording.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Returns the target's object to direct use.
fn detach(target: &Option<Arc<Target>>) {
    if let Some(target) = target
        && !target.is_owned()
    {
        target.moc().attachment().detach();
    }
}

impl Pool for Gate {
    fn flush(&self) {
        self.workers.flush();
    }

    fn forget(&self, attachment: &Attachment) {
        let mut gate = self.shut();
        if !gate.as_ref().is_some_and(|target| core::ptr::eq(target.moc().attachment(), attachment)) {
            return;
        }
        self.workers.flush();
        self.workers.set_target(None);
        *gate = None;
    }

    fn test_rect(&self, attachment: &Attachment, edges: [f32; 4], w_min: f32) -> Option<CullingResult> {
        self.with_object_of(attachment, |target| self.rect(target, edges, w_min))
    }

    fn test_mesh(&self, attachment: &Attachment, mesh: &Mesh<'_>) -> Option<CullingResult> {
        self.with_object_of(attachment, |target| self.mesh(target, mesh))
    }
}
