//! Random calls on meshes, rectangles and buffers, and the checks after each.

use fastrand::Rng;
use masked_occlusion_culling::MaskedOcclusionCulling;
use masked_occlusion_culling::capi::*;

use crate::episode::Memory;
use crate::family::{Check, Family, OCCLUDED, OK, UNTOUCHED, VIEW_CULLED, VISIBLE, ensure};
use crate::hostile;
use crate::memory::{self, Mode};
use crate::mesh::Mesh;
use crate::pool;

pub struct Driver<'a> {
    pub rng: Rng,
    pub memory: &'a mut Memory,
    pub families: [Family; 2],
    /// Calls through pools.
    pub pooled: u64,
}

impl Driver<'_> {
    /// Makes one random call on each member of one family.
    pub fn step(&mut self, which: usize) -> Check {
        if self.families[which].size.is_none() && self.rng.u8(..4) != 0 {
            return self.set_resolution(which);
        }
        match self.rng.u8(..100) {
            0..28 => self.render(which),
            28..42 => self.test_triangles(which),
            42..62 => self.test_rect(which),
            62..72 => self.bins(which),
            72..75 => self.clear(which),
            75..82 => self.merge(which),
            82..85 => self.set_resolution(which),
            85..89 => self.set_near(which),
            89..94 => self.check_depth(which).map(|_| ()),
            94..96 => self.transform(),
            96 => self.getters(which),
            97 => match self.rng.u8(..3) {
                0 => self.settings(),
                1 => self.nulls(),
                _ => self.pool_nulls(),
            },
            _ => self.stretch(which),
        }
    }

    pub(crate) fn render(&mut self, which: usize) -> Check {
        // A pool would have to be flushed each time.
        let looks = self.families[which].pool.is_none() && self.rng.u8(..8) == 0;
        let before = if looks { Some(self.check_depth(which)?) } else { None };
        let mesh = self.mesh(which)?;
        let family = &mut self.families[which];
        let through = family.through();
        let (status, answer, _) = family.ask("RenderTriangles", |i, moc| match through(i) {
            Some(pool) => pool::render(pool, &mesh),
            None => render(moc, &mesh),
        })?;
        check_prediction("RenderTriangles", &mesh, status).map_err(|failure| format!("{failure}\n{mesh}"))?;
        if status == OK {
            ensure([VISIBLE, VIEW_CULLED].contains(&answer), || format!("a draw answers {answer}"))?;
            family.empty &= answer == VIEW_CULLED;
            return Ok(());
        }
        ensure(answer == VISIBLE, || format!("a draw that is refused answers {answer}"))?;
        match before {
            Some(before) => {
                let after = self.check_depth(which)?;
                ensure(before == after, || format!("a draw that was refused ({status}) changed the buffer"))
            }
            None => Ok(()),
        }
    }

    pub(crate) fn test_triangles(&mut self, which: usize) -> Check {
        let mesh = self.mesh(which)?;
        // Otherwise the object is queried directly, whatever the pool is doing.
        let by_pool = self.rng.bool();
        let family = &mut self.families[which];
        let through = family.through();
        let (status, answer, pooled) = family.ask("TestTriangles", |i, moc| match through(i) {
            Some(pool) if by_pool => pool::test(pool, &mesh),
            _ => test(moc, &mesh),
        })?;
        check_prediction("TestTriangles", &mesh, status)?;
        check_answer("TestTriangles", family, status, answer)
            .and_then(|()| check_answer("TestTriangles by the pool", family, status, pooled.unwrap_or(answer)))
            .map_err(|failure| format!("{failure}\n{mesh}"))
    }

    pub(crate) fn test_rect(&mut self, which: usize) -> Check {
        let rng = &mut self.rng;
        let [mut x0, mut y0, mut x1, mut y1] = std::array::from_fn(|_| hostile::coordinate(rng));
        if rng.u8(..4) != 0 {
            (x0, x1) = (x0.min(x1), x0.max(x1));
            (y0, y1) = (y0.min(y1), y0.max(y1));
        }
        let w = if rng.u8(..6) == 0 { hostile::float(rng) } else { rng.f32() * 12.0 };
        let by_pool = rng.bool();
        let family = &mut self.families[which];
        let through = family.through();
        let (status, answer, pooled) = family.ask("TestRect", |i, moc| match through(i) {
            Some(pool) if by_pool => pool::rect(pool, [x0, y0, x1, y1], w),
            _ => rect(moc, [x0, y0, x1, y1], w),
        })?;
        ensure((status == OK) == family.size.is_some(), || format!("TestRect: status {status}"))?;
        check_answer("TestRect", family, status, answer)
            .and_then(|()| {
                let unknowable = [x0, y0, x1, y1, w].iter().any(|c| c.is_nan()) || w <= 0.0;
                let answers = [answer, pooled.unwrap_or(answer)];
                ensure(!(unknowable && answers.contains(&OCCLUDED)), || "an unknowable rectangle is OCCLUDED".into())
            })
            .and_then(|()| check_answer("TestRect by the pool", family, status, pooled.unwrap_or(answer)))
            .and_then(|()| match pooled {
                Some(pooled) if (pooled == VIEW_CULLED) != (answer == VIEW_CULLED) => {
                    Err(format!("the pool answers {pooled}, the others {answer}"))
                }
                Some(OCCLUDED) if answer != OCCLUDED => family.was_hidden([x0, y0, x1, y1], w),
                _ => Ok(()),
            })
            .map_err(|failure| format!("{failure}: rectangle {x0:e} {y0:e} {x1:e} {y1:e} w {w:e}"))
    }

    pub(crate) fn clear(&mut self, which: usize) -> Check {
        let family = &mut self.families[which];
        let through = family.through();
        let (status, ()) = family.all("ClearBuffer", |i, moc| {
            // SAFETY: live objects that nobody else uses, or the pool that uses one.
            let status =
                unsafe { through(i).map_or_else(|| MOC_ClearBuffer(moc), |pool| MOC_ThreadpoolClearBuffer(pool)) };
            (status as i32, ())
        })?;
        ensure((status == OK) == family.size.is_some(), || format!("ClearBuffer: status {status}"))?;
        family.empty |= status == OK;
        Ok(())
    }

    /// Merges a few objects: one by one, all at once, or with the pool.
    pub(crate) fn merge(&mut self, which: usize) -> Check {
        let shift = self.rng.usize(..8);
        let count = if self.rng.bool() { 1 } else { self.rng.usize(..4) };
        let itself: Vec<bool> = (0..count).map(|_| self.rng.u8(..12) == 0).collect();
        let (mine, other) = (&self.families[which], &self.families[1 - which]);
        // A partner on another instruction set has the same bits, so the result is the same.
        let partner = |i: usize, k: usize| {
            if itself[k] { mine.members[i] } else { other.members[(i + k + shift) % other.members.len()] }.cast_const()
        };
        let same = mine.size == other.size && mine.y_axis == other.y_axis;
        let fits = mine.size.is_some() && (same || itself.iter().all(|&itself| itself));
        let through = mine.through();
        let (status, ()) = mine.all("MergeBuffers", |i, moc| {
            let partners: Vec<_> = (0..count).map(|k| partner(i, k)).collect();
            let (others, len) = (partners.as_ptr(), count as u32);
            // SAFETY: live objects that nobody else uses; of the other family, none until the pool was flushed.
            let status = unsafe {
                match through(i) {
                    Some(pool) => MOC_ThreadpoolMergeBuffers(pool, others, len),
                    None if count == 1 || fits && count > 0 && i % 2 == 1 => {
                        let each = partners.iter().map(|&partner| MOC_MergeBuffer(moc, partner));
                        each.max_by_key(|&status| status as i32).unwrap_or(MOC_Status::MOC_STATUS_OK)
                    }
                    None => MOC_MergeBuffers(moc, others, len),
                }
            };
            (status as i32, ())
        })?;
        ensure((status == OK) == fits, || {
            format!("MergeBuffers: status {status} for {:?}, {:?}", mine.size, other.size)
        })?;
        if status == OK {
            let empty = mine.empty && (other.empty || itself.iter().all(|&itself| itself));
            self.families[which].empty = empty;
        }
        Ok(())
    }

    pub(crate) fn set_resolution(&mut self, which: usize) -> Check {
        let (width, height) = match self.families[1 - which].size {
            // The size of the other family, so that they can be merged.
            Some(size) if self.rng.bool() => size,
            _ => hostile::resolution(&mut self.rng),
        };
        let mode = [Mode::Works, Mode::Works, Mode::Works, Mode::Fails, Mode::Misaligns][self.rng.usize(..5)];
        memory::set_mode(mode);
        let family = &mut self.families[which];
        let through = family.through();
        let called = family.all("SetResolution", |i, moc| {
            // SAFETY: live objects that nobody else uses, or the pool that uses one.
            let status = unsafe {
                match through(i) {
                    Some(pool) => MOC_ThreadpoolSetResolution(pool, width, height),
                    None => MOC_SetResolution(moc, width, height),
                }
            };
            (status as i32, ())
        });
        memory::set_mode(Mode::Works);
        let (status, ()) = called?;
        let accepted = (1..=16_384).contains(&width) && (1..=16_384).contains(&height);
        let expected = if !accepted {
            MOC_Status::MOC_STATUS_INVALID_SIZE as i32
        } else if family.own_allocator && !matches!(mode, Mode::Works) && family.size != Some((width, height)) {
            MOC_Status::MOC_STATUS_OUT_OF_MEMORY as i32
        } else {
            OK
        };
        ensure(status == expected, || format!("SetResolution({width}, {height}): {status} instead of {expected}"))?;
        if status == OK {
            family.size = Some((width, height));
            family.empty = true;
        }
        Ok(())
    }

    pub(crate) fn set_near(&mut self, which: usize) -> Check {
        let near = if self.rng.bool() { self.rng.f32() } else { hostile::float(&mut self.rng) };
        let family = &mut self.families[which];
        let through = family.through();
        let (status, ()) = family.all("SetNearClipPlane", |i, moc| {
            // SAFETY: live objects that nobody else uses, or the pool that uses one.
            let status = unsafe {
                match through(i) {
                    Some(pool) => MOC_ThreadpoolSetNearClipPlane(pool, near),
                    None => MOC_SetNearClipPlane(moc, near),
                }
            };
            (status as i32, ())
        })?;
        ensure((status == OK) == near.is_finite(), || format!("SetNearClipPlane({near:e}): status {status}"))?;
        if status == OK {
            family.near = near;
        }
        Ok(())
    }

    /// Reads the depth of every pixel, checks it, and returns its bits, first row first.
    pub fn check_depth(&mut self, which: usize) -> Check<Vec<u32>> {
        self.settle(which)?;
        let family = &self.families[which];
        let (width, height) = family.size.unwrap_or((1, 1));
        let pixels = width as usize * height as usize;
        let (flip, checked, at_end) = (self.rng.bool(), self.rng.bool(), self.rng.bool());
        let depth = self.memory.depth.place(pixels * 4, at_end).cast::<f32>();
        let mut first: Vec<f32> = Vec::new();
        let (status, ()) = family.all("ComputePixelDepthBuffer", |i, moc| {
            // SAFETY: a live object; `depth` has room for every pixel, and nobody else uses it.
            let (status, pixels) = unsafe {
                depth.cast::<u8>().write_bytes(0xee, pixels * 4);
                let status = if checked {
                    MOC_ComputePixelDepthBufferChecked(moc, depth, pixels, flip.into())
                } else {
                    MOC_ComputePixelDepthBuffer(moc, depth, flip.into())
                };
                (status as i32, std::slice::from_raw_parts(depth, pixels))
            };
            if i == 0 {
                first = pixels.to_vec();
            }
            let differ = first.iter().zip(pixels).position(|(a, b)| a.to_bits() != b.to_bits());
            if let Some(at) = differ {
                let (x, y) = (at % width as usize, at / width as usize);
                eprintln!("at ({x}, {y}) the first object has {:e}, object {i} {:e}", first[at], pixels[at]);
            }
            // A status that no function returns marks the difference.
            (if differ.is_some() { -1 } else { status }, ())
        })?;
        ensure((status == OK) == family.size.is_some(), || format!("ComputePixelDepthBuffer: status {status}"))?;
        if status != OK {
            return Ok(Vec::new());
        }
        let wrong = first.iter().position(|d| !d.is_finite() || family.empty && *d >= 0.0);
        ensure(wrong.is_none(), || format!("pixel {wrong:?} has depth {:e}", first[wrong.unwrap_or(0)]))?;
        let nearest = first.iter().copied().fold(0.0, f32::max);
        if nearest > 0.0 {
            let w = 0.999 / nearest;
            let (_, answer) = family.all("TestRect", |_, moc| rect(moc, [-1.0, -1.0, 1.0, 1.0], w))?;
            ensure(answer == VISIBLE, || format!("a rectangle nearer than all that was drawn answers {answer}"))?;
        }
        let rows = first.chunks(width as usize);
        let rows: Vec<&[f32]> = if flip { rows.rev().collect() } else { rows.collect() };
        Ok(rows.concat().iter().map(|d| d.to_bits()).collect())
    }
}

pub(crate) fn check_prediction(name: &str, mesh: &Mesh, status: i32) -> Check {
    match mesh.refused {
        Some(refused) => ensure((status != OK) == refused, || format!("{name}: status {status}, refused is {refused}")),
        None => Ok(()),
    }
}

fn check_answer(name: &str, family: &Family, status: i32, answer: i32) -> Check {
    let allowed: &[i32] = if status == OK { &[VISIBLE, OCCLUDED, VIEW_CULLED] } else { &[VISIBLE] };
    ensure(allowed.contains(&answer), || format!("{name} answers {answer} with status {status}"))?;
    ensure(!(family.empty && answer == OCCLUDED), || format!("{name}: OCCLUDED by an empty buffer"))
}

fn rect(moc: *const MaskedOcclusionCulling, [x0, y0, x1, y1]: [f32; 4], w: f32) -> (i32, i32) {
    let mut answer = UNTOUCHED;
    // SAFETY: a live object that nobody else uses, or null.
    let status = unsafe { MOC_TestRect(moc, x0, y0, x1, y1, w, &mut answer) };
    (status as i32, answer)
}

/// Draws a mesh with the entry point that it is meant for.
fn render(moc: *mut MaskedOcclusionCulling, m: &Mesh) -> (i32, i32) {
    let mut answer = UNTOUCHED;
    // SAFETY: a live object; each pointer is null or valid, and if the length of the vertices is not passed, the layout
    // fits the array and every index is in range.
    let status = unsafe {
        if m.checked {
            MOC_RenderTrianglesChecked(
                moc,
                m.vertices,
                m.vertex_floats,
                m.triangles,
                m.n_triangles,
                m.matrix,
                m.winding,
                m.clip_planes,
                m.layout,
                &mut answer,
            )
        } else {
            MOC_RenderTriangles(
                moc,
                m.vertices,
                m.triangles,
                m.n_triangles,
                m.matrix,
                m.winding,
                m.clip_planes,
                m.layout,
                &mut answer,
            )
        }
    };
    (status as i32, answer)
}

/// Tests a mesh in the same way.
fn test(moc: *const MaskedOcclusionCulling, m: &Mesh) -> (i32, i32) {
    let mut answer = UNTOUCHED;
    // SAFETY: as in `render`.
    let status = unsafe {
        if m.checked {
            MOC_TestTrianglesChecked(
                moc,
                m.vertices,
                m.vertex_floats,
                m.triangles,
                m.n_triangles,
                m.matrix,
                m.winding,
                m.clip_planes,
                m.layout,
                &mut answer,
            )
        } else {
            MOC_TestTriangles(
                moc,
                m.vertices,
                m.triangles,
                m.n_triangles,
                m.matrix,
                m.winding,
                m.clip_planes,
                m.layout,
                &mut answer,
            )
        }
    };
    (status as i32, answer)
}
