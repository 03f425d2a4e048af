//! Stretches of calls in which a thread pool draws into one member of a family, while the others are drawn into
//! directly.

use std::ptr::{null, null_mut};

use masked_occlusion_culling::MaskedOcclusionCulling;
use masked_occlusion_culling::capi::*;

use crate::calls::Driver;
use crate::family::{Check, NO_BUFFER, OK, UNTOUCHED, ensure};
use crate::hostile;
use crate::pool::{EMPTY, Pool};

impl Driver<'_> {
    /// Makes some tens of calls through a pool.
    pub(crate) fn stretch(&mut self, which: usize) -> Check {
        if self.families[which].pool.is_some() || self.families[which].attached {
            return Ok(());
        }
        let rng = &mut self.rng;
        let mut bins = || if rng.u8(..12) == 0 { [u32::MAX, 65_536, 1000][rng.usize(..3)] } else { rng.u32(1..10) };
        let (bins_w, bins_h) = (bins(), bins());
        let (threads, max_jobs) = (rng.u32(..5), if rng.bool() { rng.u32(1..65) } else { rng.u32(1..4) });
        // 0 asks the system; up to 5 threads run on machines with fewer processors, too.
        let processors = rng.u32(..7);
        let mut handle = null_mut();
        // SAFETY: a place for the pool.
        let status = unsafe { MOC_ThreadpoolCreate(threads, bins_w, bins_h, max_jobs, processors, &mut handle) } as i32;
        ensure(status == OK && !handle.is_null(), || format!("ThreadpoolCreate: status {status} for good numbers"))?;
        self.families[which].pool = Some(Pool::new(handle, rng.u8(..3) == 0));
        let about =
            format!("a pool of {threads} threads on {processors} processors, {bins_w}x{bins_h} bins, {max_jobs} jobs");
        let mut done = self.attach(which);
        for k in 0..self.rng.usize(5..50) {
            if done.is_ok() {
                done = self.pool_step(which).map_err(|failure| format!("pooled call {k}: {failure}"));
            }
            self.pooled += 1;
        }
        // Destroying the pool flushes it if nothing else did, also after a failure: the other family may be destroyed
        // before this one.
        if self.rng.bool() {
            done = done.and_then(|()| self.settle(which));
        }
        self.families[which].pool = None;
        self.memory.lent_count = 0;
        let done = done.and_then(|()| self.check_depth(which)).and_then(|_| self.check_statistics(which));
        done.map_err(|failure| format!("{failure}\n{about}"))
    }

    fn pool_step(&mut self, which: usize) -> Check {
        let family = &self.families[which];
        if family.size.is_none() && self.rng.u8(..4) != 0 {
            return self.set_resolution(which).and_then(|()| self.submitted(which, true));
        }
        match self.rng.u8(..100) {
            0..46 => self.render(which).and_then(|()| self.submitted(which, false)),
            46..50 => self.frame(which),
            50..56 => self.clear(which).and_then(|()| self.flushed(which)),
            56..62 => self.merge(which).and_then(|()| self.submitted(which, false)),
            62..74 => {
                if family.pool.as_ref().is_some_and(|pool| !pool.asks_early) {
                    self.settle(which)?;
                }
                if self.rng.bool() { self.test_rect(which) } else { self.test_triangles(which) }
            }
            74..77 => self.set_near(which).and_then(|()| self.flushed(which)),
            77 => self.work_once(which),
            78..86 => self.wake_or_suspend(which),
            86..88 => self.set_transform(which),
            88..91 => self.settle(which),
            91..93 => self.pool_depth(which),
            93..95 => self.set_resolution(which).and_then(|()| self.submitted(which, true)),
            95..97 => self.exchange(which),
            _ => self.directly(which),
        }
    }

    /// Clears, then leaves batches pending.
    fn frame(&mut self, which: usize) -> Check {
        self.wake(which, false)?;
        self.clear(which).and_then(|()| self.flushed(which))?;
        for _ in 0..self.rng.usize(2..16) {
            self.render(which).and_then(|()| self.submitted(which, false))?;
        }
        self.merge(which).and_then(|()| self.submitted(which, false))?;
        self.render(which).and_then(|()| self.submitted(which, false))?;
        let wakes = self.rng.bool();
        self.wake(which, wakes)
    }

    /// Does one piece of the pending work, if there is any.
    fn work_once(&mut self, which: usize) -> Check {
        let Some(pool) = &self.families[which].pool else { return Ok(()) };
        let (mut worked, mut done) = (UNTOUCHED, UNTOUCHED);
        // SAFETY: a live pool and valid output pointers.
        let statuses =
            unsafe { [MOC_ThreadpoolWorkOnce(pool.handle, &mut worked), MOC_ThreadpoolIsDone(pool.handle, &mut done)] };
        let good =
            statuses.iter().all(|&status| status as i32 == OK) && [worked, done].iter().all(|n| [0, 1].contains(n));
        ensure(good, || format!("working once: {statuses:?}, {worked}, {done}"))
    }

    /// Sets the pool's object, and sometimes a near plane after that.
    fn attach(&mut self, which: usize) -> Check {
        let member = self.rng.usize(..self.families[which].members.len());
        let near = if self.rng.bool() { Some(self.rng.f32()) } else { None };
        let family = &mut self.families[which];
        let Some(pool) = &mut family.pool else { return Ok(()) };
        pool.member = member;
        // SAFETY: a live pool and a live object, which outlives the pool.
        let statuses = unsafe {
            let attached = MOC_ThreadpoolSetBuffer(pool.handle, family.members[member]);
            let set = near.map(|near| MOC_ThreadpoolSetNearClipPlane(pool.handle, near));
            [set.unwrap_or(MOC_Status::MOC_STATUS_OK), attached]
        };
        ensure(statuses.iter().all(|&status| status as i32 == OK), || format!("attaching: {statuses:?}"))?;
        if let Some(near) = near {
            // The object gets a near plane set through the pool; otherwise it keeps its own.
            for (_, &moc) in family.members.iter().enumerate().filter(|&(i, _)| i != member) {
                // SAFETY: a live object that nobody else uses.
                unsafe { MOC_SetNearClipPlane(moc, near) };
            }
            family.near = near;
        }
        self.settle(which)?;
        self.wake_or_suspend(which)
    }

    /// Removes the object: every call that needs one is refused.
    fn exchange(&mut self, which: usize) -> Check {
        let (mut answer, mut depth) = (UNTOUCHED, 0.0);
        let Some(pool) = &mut self.families[which].pool else { return Ok(()) };
        let handle = pool.handle;
        // SAFETY: a live pool; all arrays are empty, or are not touched without an object.
        let (status, refused) = unsafe {
            let status = MOC_ThreadpoolSetBuffer(handle, null_mut()) as i32;
            let refused = [
                MOC_ThreadpoolSetResolution(handle, 8, 8),
                MOC_ThreadpoolSetNearClipPlane(handle, 1.0),
                MOC_ThreadpoolClearBuffer(handle),
                MOC_ThreadpoolRenderMesh(handle, &EMPTY),
                MOC_ThreadpoolTestMesh(handle, &EMPTY, &mut answer),
                MOC_ThreadpoolRenderTriangles(handle, null(), null(), 0, 1, 0x1f),
                MOC_ThreadpoolTestRect(handle, 0.0, 0.0, 1.0, 1.0, 1.0, &mut answer),
                MOC_ThreadpoolTestTriangles(handle, null(), null(), 0, 1, 0x1f, &mut answer),
                MOC_ThreadpoolComputePixelDepthBuffer(handle, &mut depth, 0),
                MOC_ThreadpoolMergeBuffers(handle, null(), 0),
            ];
            (status, refused)
        };
        let wrong = refused.iter().position(|&status| status as i32 != NO_BUFFER);
        ensure(status == OK && wrong.is_none(), || format!("a pool without an object: {status}, call {wrong:?}"))?;
        // Everything submitted is drawn by now.
        pool.flushed();
        self.memory.lent_count = 0;
        self.attach(which)
    }

    /// Between a flush and the next call of the pool, any thread may use the object.
    fn directly(&mut self, which: usize) -> Check {
        self.settle(which)?;
        if self.rng.bool() {
            self.step(1 - which)?;
            // It may merge what is drawn here.
            self.settle(1 - which)?;
        } else {
            let pool = self.families[which].pool.take();
            self.families[which].attached = true;
            let done = self.step(which);
            self.families[which].attached = false;
            self.families[which].pool = pool;
            done?;
        }
        self.submitted(which, true)?;
        // Nothing was submitted: the pool gives the same results as the others.
        if let Some(pool) = &mut self.families[which].pool {
            pool.flushed();
        }
        Ok(())
    }

    fn wake_or_suspend(&mut self, which: usize) -> Check {
        let wakes = self.rng.u8(..3) != 0;
        self.wake(which, wakes)
    }

    /// Flushes once or twice, or puts the threads to sleep.
    fn wake(&mut self, which: usize, wakes: bool) -> Check {
        let times = self.rng.u8(1..3);
        let Some(pool) = &self.families[which].pool else { return Ok(()) };
        for _ in 0..times {
            // SAFETY: a live pool.
            let status = unsafe {
                if wakes { MOC_ThreadpoolWakeThreads(pool.handle) } else { MOC_ThreadpoolSuspendThreads(pool.handle) }
            };
            ensure(status as i32 == OK, || format!("waking ({wakes}): status {status:?}"))?;
        }
        // Everything submitted is drawn before the threads sleep.
        if wakes { Ok(()) } else { self.flushed(which) }
    }

    /// Sets a matrix for meshes without their own, and a layout that no mesh has.
    fn set_transform(&mut self, which: usize) -> Check {
        let matrix = if self.rng.bool() { Some(hostile::matrix(&mut self.rng)) } else { None };
        let layout = hostile::layout(&mut self.rng);
        let Some(pool) = &mut self.families[which].pool else { return Ok(()) };
        // SAFETY: a live pool, a layout, and null or a matrix.
        let statuses = unsafe {
            let matrix = matrix.as_ref().map_or(null(), |matrix| matrix.as_ptr());
            [MOC_ThreadpoolSetMatrix(pool.handle, matrix), MOC_ThreadpoolSetVertexLayout(pool.handle, &layout)]
        };
        pool.matrix = matrix;
        let refused = if layout.stride < 0 { MOC_Status::MOC_STATUS_INVALID_LAYOUT } else { MOC_Status::MOC_STATUS_OK };
        if layout.stride >= 0 {
            pool.layout = layout;
        }
        ensure(statuses == [MOC_Status::MOC_STATUS_OK, refused], || format!("matrix and layout: {statuses:?}"))
    }

    /// Reads the depths through the pool, after its own flush.
    fn pool_depth(&mut self, which: usize) -> Check {
        let (flip, family) = (self.rng.i32(..2), &self.families[which]);
        let (width, height) = family.size.unwrap_or((1, 1));
        let (pixels, through) = (width as usize * height as usize, family.through());
        let depth = self.memory.depth.place(pixels * 4, true).cast::<f32>();
        let call = |i: usize, moc: *mut MaskedOcclusionCulling| {
            // SAFETY: a live object that nobody else uses, or the pool that uses it, and room for every pixel.
            unsafe {
                depth.cast::<u8>().write_bytes(0xee, pixels * 4);
                let status = match through(i) {
                    Some(pool) => MOC_ThreadpoolComputePixelDepthBuffer(pool, depth, flip),
                    None => MOC_ComputePixelDepthBuffer(moc, depth, flip),
                };
                let bits = std::slice::from_raw_parts(depth.cast::<u32>(), pixels);
                // Not the depths themselves, which would not fit in a message.
                (status as i32, bits.iter().fold(0u64, |sum, &d| sum.wrapping_mul(0x9e37_79b9).wrapping_add(d.into())))
            }
        };
        family.all("ThreadpoolComputePixelDepthBuffer", call).map(|_| ())
    }
}
