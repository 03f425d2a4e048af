//! The way to a pool's object: who submits or queries passes the gate, who exchanges or resizes the object shuts it.
//!
//! The object knows the gate of its pool ([`Attachment`](crate::attachment::Attachment)), so that queries of the object itself take
//! the pool's way while the pool draws, and so that neither is used by the other after it went away.

use core::ptr::NonNull;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

use super::crew::Crew;
use super::target::{Bins, Target};
use crate::attachment::{Attachment, Pool};
use crate::pipeline::Mesh;
use crate::{CullingResult, Error, MaskedOcclusionCulling};

pub(super) struct Gate {
    pub crew: Arc<Crew>,
    bins: Bins,
    /// Held for reading by who submits or queries, for writing by who exchanges it.
    target: RwLock<Option<Arc<Target>>>,
    /// Held around each call while calls are recorded, so that the file has them in the order in which they are drawn.
    recording: Mutex<()>,
}

/// The target, held against an exchange.
pub(super) type Pass<'a> = RwLockReadGuard<'a, Option<Arc<Target>>>;

impl Gate {
    pub fn new(crew: Arc<Crew>, bins: Bins) -> Self {
        Self { crew, bins, target: RwLock::new(None), recording: Mutex::new(()) }
    }

    /// Draws into this object from now on, or into none, after what was submitted is drawn. True: it goes with the pool.
    ///
    /// # Errors
    /// [`Error::Busy`] where it belongs to another pool; nothing is changed.
    ///
    /// # Safety
    /// As [`Target::new`], until another one is set or [`Pool::forget`] is called.
    pub unsafe fn exchange(
        self: &Arc<Self>,
        moc: Option<(NonNull<MaskedOcclusionCulling>, bool)>,
    ) -> Result<(), Error> {
        let mut gate = self.shut();
        self.crew.flush();
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
        self.crew.set_target(new.clone());
        *gate = new;
        Ok(())
    }

    /// Flushes, and hands back the object that goes with the pool. One that does not stays.
    pub fn take_owned(&self) -> Option<MaskedOcclusionCulling> {
        let mut gate = self.shut();
        if !gate.as_ref()?.is_owned() {
            return None;
        }
        self.crew.flush();
        self.crew.set_target(None);
        Arc::into_inner(gate.take()?)?.into_owned()
    }

    /// Flushes, and has no object any more.
    pub fn close(&self) {
        let mut gate = self.shut();
        self.crew.flush();
        detach(&gate);
        self.crew.set_target(None);
        *gate = None;
    }

    /// Flushes, and lets something be done to the object that may change its size. Nothing is in flight, and nobody submits or queries.
    pub fn resize(&self, change: impl FnOnce(&mut MaskedOcclusionCulling) -> Result<(), Error>) -> Result<(), Error> {
        let mut gate = self.shut();
        self.crew.flush();
        let target = gate.as_ref().ok_or(Error::NoBuffer)?;
        // SAFETY: nothing is in flight, and nobody submits or queries while the gate is shut.
        change(unsafe { &mut *target.pointer().as_ptr() })?;
        self.cut_again(&mut gate);
        Ok(())
    }

    /// Makes the bins anew. Nothing is in flight.
    fn cut_again(&self, gate: &mut Option<Arc<Target>>) {
        self.crew.set_target(None);
        // Nobody else holds it: threads let go of it before they report what they did.
        if let Some(target) = gate.take().and_then(Arc::into_inner) {
            *gate = Some(Arc::new(target.resized(self.bins)));
        }
        self.crew.set_target(gate.clone());
    }

    /// The target, whose bins fit its object: after a flush its owner may have given it another resolution.
    pub fn pass(&self) -> Pass<'_> {
        loop {
            let pass = self.target.read().unwrap_or_else(PoisonError::into_inner);
            if !pass.as_ref().is_some_and(|target| target.is_outdated()) {
                return pass;
            }
            drop(pass);
            let mut gate = self.shut();
            self.crew.flush();
            self.cut_again(&mut gate);
        }
    }

    /// The target, if it has a buffer.
    pub fn with_buffer<R>(&self, call: impl FnOnce(&Target) -> Result<R, Error>) -> Result<R, Error> {
        let pass = self.pass();
        let target = pass.as_ref().ok_or(Error::NoBuffer)?;
        target.moc().buffer()?;
        call(target)
    }

    fn shut(&self) -> RwLockWriteGuard<'_, Option<Arc<Target>>> {
        self.target.write().unwrap_or_else(PoisonError::into_inner)
    }

    /// While calls are recorded: the right to be the next.
    pub fn recording(&self, target: &Target) -> Option<MutexGuard<'_, ()>> {
        // Whoever has it may work meanwhile, for which it is not needed.
        target.moc().recorder().is_on().then(|| self.recording.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// The object of a target is used again without the pool.
fn detach(target: &Option<Arc<Target>>) {
    if let Some(target) = target
        && !target.is_owned()
    {
        target.moc().attachment().detach();
    }
}

impl Pool for Gate {
    fn flush(&self) {
        self.crew.flush();
    }

    fn forget(&self, attachment: &Attachment) {
        let mut gate = self.shut();
        if !gate.as_ref().is_some_and(|target| core::ptr::eq(target.moc().attachment(), attachment)) {
            return;
        }
        self.crew.flush();
        self.crew.set_target(None);
        *gate = None;
    }

    fn test_rect(&self, edges: [f32; 4], w_min: f32) -> Result<CullingResult, Error> {
        self.with_buffer(|target| {
            let tiles = target.moc().rectangle_tiles(edges)?;
            let recording = self.recording(target);
            // Before: what is asked while something is drawn may be answered otherwise later, and no answer can be held to it.
            let settled = recording.is_some() && self.crew.is_done();
            let result = target.query(tiles, |moc| moc.ask_rect(edges, w_min))?;
            target.moc().recorder().test_rect(settled.then_some(result), edges, w_min);
            Ok(result)
        })
    }

    unsafe fn test_mesh(&self, mesh: &Mesh<'_>) -> Result<CullingResult, Error> {
        self.with_buffer(|target| {
            let recording = self.recording(target);
            // As in `test_rect`.
            let settled = recording.is_some() && self.crew.is_done();
            // SAFETY: the caller's contract: every vertex from the lowest to the highest index can be read.
            let result = target.query(target.all_tiles(), |moc| unsafe { moc.ask_triangles(mesh) })?;
            // SAFETY: as above.
            unsafe { target.moc().recorder().test_triangles(settled.then_some(result), mesh) };
            Ok(result)
        })
    }
}
