//! Random calls on the objects themselves: settings, getters, transforms, and null pointers.

use std::ptr::{null, null_mut};

use masked_occlusion_culling::capi::*;

use crate::calls::Driver;
use crate::family::{Check, OK, ensure};
use crate::hostile;
use crate::memory::{self, Mode};

pub(crate) const NULL_POINTER: i32 = MOC_Status::MOC_STATUS_NULL_POINTER as i32;

impl Driver<'_> {
    /// Checks that the statistics of all members agree, and that no count is negative.
    pub fn check_statistics(&mut self, which: usize) -> Check {
        self.settle(which)?;
        let family = &self.families[which];
        family.all("GetStatistics", |_, moc| {
            let (mut counts, mut dropped) = ([size_of::<MOC_Statistics>() as i64; 10], 0);
            assert_eq!(size_of::<MOC_Statistics>(), size_of_val(&counts));
            // SAFETY: a live object; the struct is its size in 64 bits and nine 64-bit integers.
            let status = unsafe { MOC_GetStatistics(moc, counts.as_mut_ptr().cast()) } as i32;
            // SAFETY: a live object and a valid output pointer.
            let status = status.max(unsafe { MOC_GetDroppedTriangles(moc, &mut dropped) } as i32);
            let status = if counts.iter().any(|c| *c < 0) || dropped < 0 { -1 } else { status };
            if family.asked_early {
                // Triangles and tiles that queries tested.
                counts[8..].fill(0);
            }
            (status, (counts, dropped))
        })?;
        Ok(())
    }

    pub(crate) fn getters(&mut self, which: usize) -> Check {
        self.check_statistics(which)?;
        let family = &self.families[which];
        let (status, (size, near)) = family.all("GetResolution", |_, moc| {
            let (mut width, mut height, mut near) = (0, 0, 0.0);
            // SAFETY: a live object, and places for the answers.
            let status = unsafe {
                MOC_GetNearClipPlane(moc, &mut near);
                MOC_GetResolution(moc, &mut width, &mut height)
            };
            (status as i32, ((width, height), near))
        })?;
        ensure((status == OK) == family.size.is_some(), || format!("GetResolution: status {status}"))?;
        ensure(size == family.size.unwrap_or((0, 0)), || format!("GetResolution: {size:?} for {:?}", family.size))?;
        ensure(near == family.near, || format!("GetNearClipPlane: {near:e} for {:e}", family.near))
    }

    pub(crate) fn transform(&mut self) -> Check {
        let rng = &mut self.rng;
        let count = rng.usize(1..100);
        let layout = hostile::kept_layout(rng, count);
        let len = (count - 1) * layout.stride as usize + layout.offset_y.max(layout.offset_zw) as usize + 4;
        let bytes: Vec<u8> = (0..len).map(|_| rng.u8(..)).collect();
        let (vertices, matrix) = (self.memory.vertices.put(&bytes, true), hostile::matrix(rng));
        let matrix = self.memory.matrix.put(&matrix, true);
        let layout = self.memory.layout.put(&[layout], true);
        let out = self.memory.depth.place(count * 16, rng.bool());
        // SAFETY: `vertices` holds `count` vertices of this layout, `out` has room for as many.
        let status = unsafe { MOC_TransformVertices(matrix, vertices.cast(), out.cast(), count as u32, layout) } as i32;
        ensure(status == OK, || format!("TransformVertices: status {status}"))
    }

    /// Creates objects with arbitrary settings: each is either created completely or refused.
    pub(crate) fn settings(&mut self) -> Check {
        let rng = &mut self.rng;
        let mut settings = MOC_Settings {
            size: size_of::<MOC_Settings>() as u32,
            implementation: hostile::enumeration(rng, &[-1, 0, 1, 2, 3, 16, 4, -2]),
            update_rule: hostile::enumeration(rng, &[0, 1, 2, 3, 4, -1]),
            y_axis: hostile::enumeration(rng, &[0, 1, 2]),
            statistics: hostile::enumeration(rng, &[0, 1, 2]),
            alloc: Some(memory::alloc),
            free: Some(memory::free),
            call_alloc: None,
        };
        match rng.u8(..4) {
            0 => settings.alloc = None,
            1 => settings.free = None,
            _ => {}
        }
        let enums = [-1, 0, 1, 2, 3, 16].contains(&settings.implementation)
            && (0..=3).contains(&settings.update_rule)
            && (0..=1).contains(&settings.y_axis)
            && (0..=1).contains(&settings.statistics);
        let pair = settings.alloc.is_some() == settings.free.is_some();
        let mode = [Mode::Works, Mode::Fails][rng.usize(..2)];
        memory::set_mode(mode);
        let mut moc = std::ptr::dangling_mut();
        // SAFETY: the settings and the place for the object are valid, the callbacks are an allocator.
        let status = unsafe { MOC_Create(&settings, &mut moc) } as i32;
        memory::set_mode(Mode::Works);
        let made = enums && pair && matches!(mode, Mode::Works);
        ensure((status == OK) == made, || format!("Create: status {status}, while it should be made is {made}"))?;
        ensure(moc.is_null() != made, || "Create: the object does not fit the status".into())?;
        // SAFETY: null or an object just made.
        let status = unsafe { MOC_Destroy(moc) } as i32;
        ensure(status == OK, || format!("Destroy: status {status}"))
    }

    /// Passes null for the object, and for each required output.
    pub(crate) fn nulls(&mut self) -> Check {
        let moc = self.families[0].members[0];
        let (mut a, mut b, mut f, mut i) = (0u32, 0u32, 0f32, 0i32);
        // SAFETY: null where the functions say that they refuse it, else live objects and places to write.
        let statuses = unsafe {
            [
                MOC_SetResolution(null_mut(), 8, 8),
                MOC_GetResolution(null(), &mut a, &mut b),
                MOC_ComputeBinWidthHeight(null(), 1, 1, &mut a, &mut b),
                MOC_SetNearClipPlane(null_mut(), 1.0),
                MOC_GetNearClipPlane(null(), &mut f),
                MOC_GetNearClipPlane(moc, null_mut()),
                MOC_ClearBuffer(null_mut()),
                MOC_MergeBuffer(null_mut(), moc),
                MOC_MergeBuffer(moc, null()),
                MOC_MergeBuffers(null_mut(), null(), 0),
                MOC_MergeBuffers(moc, null(), 1),
                MOC_MergeBuffers(moc, &null(), 1),
                MOC_TestRect(null(), 0.0, 0.0, 1.0, 1.0, 1.0, &mut i),
                MOC_TestRect(moc, 0.0, 0.0, 1.0, 1.0, 1.0, null_mut()),
                MOC_RenderTriangles(null_mut(), null(), null(), 0, null(), 1, 0x1f, null(), &mut i),
                MOC_TestTriangles(null(), null(), null(), 0, null(), 1, 0x1f, null(), &mut i),
                MOC_BinTriangles(null(), null(), null(), 0, null_mut(), 1, 1, null(), 1, 0x1f, null(), &mut i),
                MOC_RenderTrilist(null(), null(), null()),
                MOC_RenderTrilist(moc, null(), null()),
                MOC_ComputePixelDepthBuffer(null(), &mut f, 0),
                MOC_GetStatistics(null(), null_mut()),
                MOC_GetStatistics(moc, null_mut()),
                MOC_GetDroppedTriangles(null(), null_mut()),
                MOC_GetDroppedTriangles(moc, null_mut()),
                MOC_GetImplementation(null(), &mut i),
                MOC_GetImplementation(moc, null_mut()),
                MOC_GetUpdateRule(null(), &mut i),
                MOC_TransformVertices(null(), null(), null_mut(), 1, null()),
                MOC_GetAllocFreeCallback(null(), &mut None, &mut None),
                MOC_DefaultSettings(null_mut()),
                MOC_Create(null(), null_mut()),
            ]
        };
        let wrong = statuses.iter().position(|status| *status as i32 != NULL_POINTER);
        ensure(wrong.is_none(), || format!("null pointers: call {wrong:?} does not say so"))?;
        // SAFETY: null is allowed.
        let status = unsafe { MOC_Destroy(null_mut()) } as i32;
        ensure(status == OK, || format!("Destroy(null): status {status}"))
    }
}
