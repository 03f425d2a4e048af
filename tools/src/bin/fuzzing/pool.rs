//! The thread pool: its state, the arrays that it may still read, and the results that it may return.
//!
//! After a flush all members must agree, as usual. Before it, a pool may answer a query with any result that was
//! correct at some moment since the last flush or clear: less was drawn then, or a later triangle has replaced a layer
//! that hid more. So if a pool returns OCCLUDED for a rectangle, it is checked against the nearest depth that each
//! pixel had in the meantime.

use std::ptr::{null, null_mut};

use masked_occlusion_culling::capi::*;

use crate::calls::Driver;
use crate::family::{Check, Family, OK, UNTOUCHED, ensure};
use crate::mesh::{self, Mesh};
use crate::objects::NULL_POINTER;

/// Larger buffers are not checked after each call.
const FEW_PIXELS: usize = 100_000;

/// A pool that draws into a member of a family, and its state.
pub struct Pool {
    pub handle: *mut MOC_Threadpool,
    pub member: usize,
    /// Nothing has been submitted since the last flush.
    pub settled: bool,
    pub matrix: Option<[f32; 16]>,
    pub layout: MOC_VertexLayout,
    /// It is queried while it draws.
    pub asks_early: bool,
    /// The nearest depth of each pixel since the last flush or clear; `None` if unknown.
    nearest: Vec<f32>,
}

const PACKED: MOC_VertexLayout = MOC_VertexLayout { stride: 16, offset_y: 4, offset_zw: 12 };

impl Pool {
    pub fn new(handle: *mut MOC_Threadpool, asks_early: bool) -> Self {
        let (matrix, layout) = (None, PACKED);
        Self { handle, member: 0, settled: true, matrix, layout, asks_early, nearest: Vec::new() }
    }

    /// Everything submitted is drawn.
    pub fn flushed(&mut self) {
        self.settled = true;
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        // SAFETY: made by `Driver::stretch`, which lets go of it while its object and all arrays are there.
        unsafe { MOC_ThreadpoolDestroy(self.handle) };
    }
}

impl Driver<'_> {
    /// Flushes the pool, if there is one.
    pub(crate) fn settle(&mut self, which: usize) -> Check {
        let Some(pool) = &mut self.families[which].pool else { return Ok(()) };
        // SAFETY: a live pool.
        let status = unsafe { MOC_ThreadpoolFlush(pool.handle) } as i32;
        ensure(status == OK, || format!("ThreadpoolFlush: status {status}"))?;
        self.flushed(which)
    }

    /// A call has flushed the pool: everything is drawn, and the arrays may be overwritten.
    pub(crate) fn flushed(&mut self, which: usize) -> Check {
        self.submitted(which, true)?;
        if let Some(pool) = &mut self.families[which].pool {
            pool.flushed();
            self.memory.lent_count = 0;
        }
        Ok(())
    }

    /// Records that something was submitted. `anew`: earlier contents no longer hide anything, or are drawn.
    pub(crate) fn submitted(&mut self, which: usize, anew: bool) -> Check {
        let Family { members, size, pool, .. } = &mut self.families[which];
        let Some(pool) = pool else { return Ok(()) };
        pool.settled = false;
        let pixels = size.map_or(0, |(width, height)| width as usize * height as usize);
        let before = std::mem::take(&mut pool.nearest);
        let direct = (0..members.len()).find(|&i| i != pool.member);
        let (Some(direct), true) = (direct, pool.asks_early && (1..=FEW_PIXELS).contains(&pixels)) else {
            return Ok(());
        };
        if !anew && before.len() != pixels {
            return Ok(());
        }
        let mut now = vec![0.0; pixels];
        // SAFETY: a live object that nobody else uses, and room for every pixel.
        let status = unsafe { MOC_ComputePixelDepthBuffer(members[direct], now.as_mut_ptr(), 0) } as i32;
        if !anew {
            now.iter_mut().zip(before).for_each(|(now, before)| *now = before.max(*now));
        }
        pool.nearest = now;
        ensure(status == OK, || format!("ComputePixelDepthBuffer: status {status}"))
    }

    /// A mesh whose arrays stay readable as long as the family's pool needs them, and that matches the pool's state.
    pub(crate) fn mesh(&mut self, which: usize) -> Check<Mesh> {
        if self.families[which].pool.is_none() {
            return Ok(mesh::random(&mut self.rng, self.memory, &self.families[which]));
        }
        // Sometimes the arrays are overwritten as soon as that is allowed.
        if self.memory.all_lent() || self.rng.u8(..40) == 0 {
            self.settle(which)?;
        } else {
            self.memory.lend();
        }
        let family = &mut self.families[which];
        let mut mesh = mesh::random(&mut self.rng, self.memory, family);
        while !mesh.whole {
            mesh = mesh::random(&mut self.rng, self.memory, family);
        }
        let Some(pool) = &mut family.pool else { return Ok(mesh) };
        let keeps_matrix = self.rng.u8(..4) == 0;
        if keeps_matrix {
            mesh.matrix = pool.matrix.map_or(null(), |matrix| self.memory.matrix.put(&matrix, true).cast_const());
        }
        let mut statuses = [MOC_Status::MOC_STATUS_OK; 2];
        // SAFETY: null, or a layout and a matrix in guarded memory; a live pool.
        unsafe {
            let layout = mesh.layout.as_ref().copied().unwrap_or(PACKED);
            let numbers = |layout: MOC_VertexLayout| [layout.stride, layout.offset_y, layout.offset_zw];
            if numbers(layout) != numbers(pool.layout) || self.rng.bool() {
                statuses[0] = MOC_ThreadpoolSetVertexLayout(pool.handle, mesh.layout);
                pool.layout = layout;
            }
            if !keeps_matrix {
                statuses[1] = MOC_ThreadpoolSetMatrix(pool.handle, mesh.matrix);
                pool.matrix = mesh.matrix.cast::<[f32; 16]>().as_ref().copied();
            }
        }
        ensure(statuses.iter().all(|&status| status as i32 == OK), || format!("layout and matrix: {statuses:?}"))?;
        Ok(mesh)
    }

    /// Passes null for the pool and for required arguments, and numbers that no pool can have.
    pub(crate) fn pool_nulls(&mut self) -> Check {
        let (mut answer, mut depth, mut pool) = (0, 0.0, null_mut());
        // SAFETY: null where the functions say that they refuse it, else a live pool and places to write.
        unsafe {
            for [threads, bins_w, bins_h, jobs] in
                [[1, 0, 1, 1], [1, 1, 0, 1], [0, 1, 1, 0], [1025, 1, 1, 1], [u32::MAX; 4]]
            {
                pool = std::ptr::dangling_mut();
                let status = MOC_ThreadpoolCreate(threads, bins_w, bins_h, jobs, 0, &mut pool);
                ensure(status == MOC_Status::MOC_STATUS_INVALID_SIZE && pool.is_null(), || {
                    format!("ThreadpoolCreate({threads}, {bins_w}, {bins_h}, {jobs}): status {status:?}")
                })?;
            }
            MOC_ThreadpoolCreate(1, 1, 1, 1, 0, &mut pool);
            let (mut w, mut h) = (0, 0);
            let statuses = [
                MOC_Flush(null()),
                MOC_ThreadpoolCreateFrom(null(), &mut null_mut()),
                MOC_ThreadpoolWorkOnce(null(), &mut answer),
                MOC_ThreadpoolIsDone(null(), &mut answer),
                MOC_ThreadpoolIsDone(pool, null_mut()),
                MOC_ThreadpoolGetThreads(null(), &mut w),
                MOC_ThreadpoolGetBins(null(), &mut w, &mut h),
                MOC_ThreadpoolGetBins(pool, &mut w, null_mut()),
                MOC_ThreadpoolRenderMesh(null(), &EMPTY),
                MOC_ThreadpoolTestMesh(null(), &EMPTY, &mut answer),
                MOC_ThreadpoolTestMesh(null(), null(), &mut answer),
                MOC_ThreadpoolCreate(1, 1, 1, 1, 0, null_mut()),
                MOC_ThreadpoolWakeThreads(null()),
                MOC_ThreadpoolSuspendThreads(null()),
                MOC_ThreadpoolFlush(null()),
                MOC_ThreadpoolSetBuffer(null(), null_mut()),
                MOC_ThreadpoolSetResolution(null(), 8, 8),
                MOC_ThreadpoolSetNearClipPlane(null(), 1.0),
                MOC_ThreadpoolSetMatrix(null(), null()),
                MOC_ThreadpoolSetVertexLayout(null(), null()),
                MOC_ThreadpoolClearBuffer(null()),
                MOC_ThreadpoolRenderTriangles(null(), null(), null(), 0, 1, 0x1f),
                MOC_ThreadpoolTestRect(null(), 0.0, 0.0, 1.0, 1.0, 1.0, &mut answer),
                MOC_ThreadpoolTestRect(pool, 0.0, 0.0, 1.0, 1.0, 1.0, null_mut()),
                MOC_ThreadpoolTestTriangles(null(), null(), null(), 0, 1, 0x1f, &mut answer),
                MOC_ThreadpoolComputePixelDepthBuffer(null(), &mut depth, 0),
                MOC_ThreadpoolComputePixelDepthBuffer(pool, null_mut(), 0),
                MOC_ThreadpoolMergeBuffers(null(), null(), 0),
                MOC_ThreadpoolMergeBuffers(pool, null(), 1),
                MOC_ThreadpoolMergeBuffers(pool, &null(), 1),
            ];
            let ends = [MOC_ThreadpoolDestroy(pool), MOC_ThreadpoolDestroy(null_mut())];
            let wrong = statuses.iter().position(|&status| status as i32 != NULL_POINTER);
            ensure(wrong.is_none(), || format!("null pointers of pools: call {wrong:?} does not say so"))?;
            ensure(ends.iter().all(|&status| status as i32 == OK), || format!("ThreadpoolDestroy: {ends:?}"))
        }
    }
}

impl Family {
    /// Whether a pool could return OCCLUDED for a rectangle: each pixel whose centre is inside was at least as near at
    /// some moment.
    pub fn was_hidden(&self, [x0, y0, x1, y1]: [f32; 4], w: f32) -> Check {
        let (Some((width, height)), Some(pool)) = (self.size, &self.pool) else { return Ok(()) };
        if pool.nearest.is_empty() {
            return Ok(());
        }
        let centres = |from: f32, to: f32, size: u32| {
            let at = |x: f32| ((f64::from(x.clamp(-1.0, 1.0)) * 0.5 + 0.5) * f64::from(size) - 0.5).ceil() as usize;
            at(from)..at(to)
        };
        let (row0, row1) = if self.y_axis == 0 { (-y1, -y0) } else { (y0, y1) };
        for (x, y) in centres(row0, row1, height).flat_map(|y| centres(x0, x1, width).map(move |x| (x, y))) {
            let nearest = pool.nearest[y * width as usize + x];
            ensure(f64::from(nearest) * f64::from(w) > 0.999, || {
                format!(
                    "the pool says OCCLUDED, the others VISIBLE, and pixel ({x}, {y}) was never nearer than {nearest:e}"
                )
            })?;
        }
        Ok(())
    }
}

/// No triangles.
pub const EMPTY: MOC_Mesh = MOC_Mesh {
    size: size_of::<MOC_Mesh>() as u32,
    index_size: 0,
    vertices: null(),
    indices: null(),
    vertex_count: 0,
    triangle_count: 0,
    model_to_clip: null(),
    layout: null(),
    winding: 1,
    clip_planes: 0x1f,
};

/// The mesh as a struct; a null layout means the same as in the other functions.
fn described(m: &Mesh) -> MOC_Mesh {
    MOC_Mesh {
        vertices: m.vertices,
        indices: m.triangles.cast(),
        vertex_count: MOC_UNCHECKED,
        triangle_count: m.n_triangles as u32,
        model_to_clip: m.matrix,
        layout: if m.layout.is_null() { &PACKED } else { m.layout },
        winding: m.winding,
        clip_planes: m.clip_planes,
        ..EMPTY
    }
}

/// Draws a mesh with its matrix and layout either set on the pool or passed with the call. There is no result.
pub fn render(pool: *const MOC_Threadpool, m: &Mesh) -> (i32, i32) {
    let (n, winding, planes) = (m.n_triangles, m.winding, m.clip_planes);
    // SAFETY: a live pool; each pointer is null or valid, and the arrays stay as they are until it was flushed.
    let status = unsafe {
        if n % 2 == 0 {
            MOC_ThreadpoolRenderTriangles(pool, m.vertices, m.triangles, n, winding, planes)
        } else {
            MOC_ThreadpoolRenderMesh(pool, &described(m))
        }
    };
    (status as i32, UNTOUCHED)
}

/// Tests a mesh in the same way.
pub fn test(pool: *const MOC_Threadpool, m: &Mesh) -> (i32, i32) {
    let mut answer = UNTOUCHED;
    let (n, winding, planes) = (m.n_triangles, m.winding, m.clip_planes);
    // SAFETY: as in `render`.
    let status = unsafe {
        if n % 2 == 0 {
            MOC_ThreadpoolTestTriangles(pool, m.vertices, m.triangles, n, winding, planes, &mut answer)
        } else {
            MOC_ThreadpoolTestMesh(pool, &described(m), &mut answer)
        }
    };
    (status as i32, answer)
}

pub fn rect(pool: *const MOC_Threadpool, [x0, y0, x1, y1]: [f32; 4], w: f32) -> (i32, i32) {
    let mut answer = UNTOUCHED;
    // SAFETY: a live pool, and a place for the answer.
    let status = unsafe { MOC_ThreadpoolTestRect(pool, x0, y0, x1, y1, w, &mut answer) };
    (status as i32, answer)
}
