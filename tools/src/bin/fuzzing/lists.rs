//! Binning into lists of every capacity, and drawing lists with arbitrary contents.

use masked_occlusion_culling::MaskedOcclusionCulling;
use masked_occlusion_culling::capi::*;

use crate::calls::{Driver, check_prediction};
use crate::family::{Check, Family, OCCLUDED, OK, VISIBLE, ensure};
use crate::hostile;
use crate::mesh::{self, Mesh};

const FLOATS: usize = 9;
/// Follows every list but the last, which an inaccessible page follows.
const CANARY: [f32; 4] = [1.5e10; 4];
const LIST_FULL: i32 = MOC_Status::MOC_STATUS_LIST_FULL as i32;

/// The lists of one call, with the same initial contents for every member.
struct Lists {
    capacity: u32,
    count: u32,
    /// Initial contents of each bin.
    data: Vec<Vec<f32>>,
}

impl Driver<'_> {
    /// Bins a mesh, possibly overwrites parts of the lists, and draws them.
    pub(crate) fn bins(&mut self, which: usize) -> Check {
        self.settle(which)?;
        let rng = &mut self.rng;
        let (bins_w, bins_h) = match rng.u8(..12) {
            0 => [(0, 1), (1, 0), (u32::MAX, 1), (1, u32::MAX), (u32::MAX, u32::MAX), (65_536, 65_536)][rng.usize(..6)],
            1..6 => (1, 1),
            _ => (rng.u32(1..5), rng.u32(1..5)),
        };
        let bin_size = bin_size(&self.families[which], bins_w, bins_h)?;
        let count = if bin_size.is_some() { (bins_w * bins_h) as usize } else { 1 };
        let capacity = [0, 1, 7, 60, 200][rng.usize(..5)];
        let mut lists = Lists { capacity, count: if rng.bool() { 0 } else { rng.u32(..=capacity) }, data: Vec::new() };
        lists.data.resize_with(count, || (0..capacity as usize * FLOATS).map(|_| list_float(rng)).collect());
        let mesh = mesh::random(rng, self.memory, &self.families[which]);

        let family = &mut self.families[which];
        let memory = &mut self.memory.lists;
        let mut placed = Vec::new();
        let (status, (answer, _)) = family.all("BinTriangles", |i, moc| {
            let headers = lists.place(&mut memory[i]);
            placed.push(headers);
            let (status, answer) = bin(moc, &mesh, headers, bins_w, bins_h);
            (status, (answer, lists.contents(headers)))
        })?;
        ensure(answer != OCCLUDED, || "BinTriangles answers OCCLUDED".into())?;
        if bin_size.is_some() {
            // A full list is not a refusal: the triangles that fitted are in the lists.
            check_prediction("BinTriangles", &mesh, if status == LIST_FULL { OK } else { status })?;
        } else {
            ensure(status != OK, || "BinTriangles accepts bins that have no size".into())?;
        }
        ensure(status == OK || answer == VISIBLE, || format!("BinTriangles: {answer} with status {status}"))?;
        for (i, headers) in placed.iter().enumerate() {
            ensure(lists.canaries_live(*headers), || format!("BinTriangles of object {i} wrote past a list"))?;
        }
        if self.rng.bool() {
            self.scribble(&placed, &lists);
        }
        match bin_size {
            Some(size) if self.rng.u8(..4) != 0 => self.draw_bins(which, &placed, (bins_w, bins_h), size),
            _ => self.draw_anywhere(which, &placed),
        }
    }

    /// Writes the same hostile numbers into the lists of all members, and triangles where there were none.
    fn scribble(&mut self, placed: &[*mut MOC_TriList], lists: &Lists) {
        for bin in 0..lists.data.len() {
            let full = self.rng.bool();
            let writes = self.rng.usize(..20);
            let places: Vec<(usize, f32)> = (0..writes * usize::from(lists.capacity > 0))
                .map(|_| (self.rng.usize(..lists.capacity as usize * FLOATS), list_float(&mut self.rng)))
                .collect();
            for headers in placed {
                // SAFETY: `headers` are as many lists as there are bins, each with `capacity` triangles.
                unsafe {
                    let list = &mut *headers.add(bin);
                    if full {
                        list.count = list.capacity;
                    }
                    for &(at, value) in &places {
                        list.data.add(at).write(value);
                    }
                }
            }
        }
    }

    /// Draws every bin inside its rectangle; for the first member with two threads at once.
    fn draw_bins(
        &mut self,
        which: usize,
        placed: &[*mut MOC_TriList],
        (bins_w, bins_h): (u32, u32),
        (bin_w, bin_h): (u32, u32),
    ) -> Check {
        let family = &mut self.families[which];
        let (width, height) = family.size.unwrap_or((0, 0));
        let edge = |i: u32, bins: u32, size: u32, end: u32| (if i == bins { end } else { i * size }) as i32;
        let rectangles: Vec<MOC_ScissorRect> = (0..bins_w * bins_h)
            .map(|i| {
                let (x, y) = (i % bins_w, i / bins_w);
                MOC_ScissorRect {
                    min_x: edge(x, bins_w, bin_w, width),
                    min_y: edge(y, bins_h, bin_h, height),
                    max_x: edge(x + 1, bins_w, bin_w, width),
                    max_y: edge(y + 1, bins_h, bin_h, height),
                }
            })
            .collect();
        let threads = self.rng.u8(..4) == 0;
        let (status, ()) = family.all("RenderTrilist", |i, moc| {
            let job = Job { moc, lists: placed[i], rectangles: &rectangles };
            let statuses = if threads && i == 0 {
                std::thread::scope(|scope| {
                    let other = scope.spawn(|| job.draw(1, 2));
                    [job.draw(0, 2), other.join().unwrap_or(-1)]
                })
            } else {
                [job.draw(0, 1), OK]
            };
            (statuses[0].max(statuses[1]), ())
        })?;
        ensure(status == OK, || format!("RenderTrilist in its bin: status {status}"))?;
        family.empty = false;
        Ok(())
    }

    /// Draws a list inside an arbitrary rectangle, and invalid lists.
    fn draw_anywhere(&mut self, which: usize, placed: &[*mut MOC_TriList]) -> Check {
        let rng = &mut self.rng;
        let mut number = || match rng.u8(..6) {
            0 => rng.i32(..),
            1 => [i32::MIN, i32::MAX, -32, 16_384][rng.usize(..4)],
            _ => rng.i32(0..20) * 32,
        };
        let scissor = MOC_ScissorRect { min_x: number(), min_y: number(), max_x: number(), max_y: number() };
        let wrong = rng.u8(..6);
        let whole = rng.bool();
        let scissor =
            if whole { std::ptr::null() } else { self.memory.scissor.put(&[scissor], rng.bool()).cast_const() };
        let family = &mut self.families[which];
        let (status, ()) = family.all("RenderTrilist", |i, moc| {
            // SAFETY: the first list of a member; nobody else uses it. A list that is not kept is refused or
            // not read.
            let status = unsafe {
                let list = placed[i];
                match wrong {
                    0 => (*list).count = (*list).capacity + 1,
                    1 => (*list).data = std::ptr::null_mut(),
                    _ => {}
                }
                MOC_RenderTrilist(moc, list, scissor)
            };
            (status as i32, ())
        })?;
        ensure(status != OK || wrong != 0, || "RenderTrilist: a list longer than its capacity".into())?;
        ensure(status != OK || family.size.is_some(), || "RenderTrilist: no buffer, but OK".into())?;
        family.empty &= status != OK;
        Ok(())
    }
}

impl Lists {
    /// Lays the lists out in guarded memory.
    fn place(&self, (headers, data): &mut (crate::guarded::Guarded, crate::guarded::Guarded)) -> *mut MOC_TriList {
        let data = data.put(&self.data.join(&CANARY[..]), true);
        let each = self.capacity as usize * FLOATS + CANARY.len();
        let lists: Vec<(u32, u32, usize)> =
            (0..self.data.len()).map(|i| (self.capacity, self.count, data.wrapping_add(i * each) as usize)).collect();
        let headers = headers.place(size_of::<MOC_TriList>() * lists.len(), true).cast::<MOC_TriList>();
        for (i, &(capacity, count, data)) in lists.iter().enumerate() {
            // SAFETY: there is room for all lists, and 16 bytes a list before a page end are aligned.
            unsafe { headers.add(i).write(MOC_TriList { capacity, count, data: data as *mut f32 }) };
        }
        headers
    }

    /// The counts and the bits of all lists.
    fn contents(&self, headers: *const MOC_TriList) -> Vec<u32> {
        let mut contents = Vec::new();
        for i in 0..self.data.len() {
            // SAFETY: `place` made as many lists, each with `capacity` triangles.
            let floats = unsafe {
                let list = &*headers.add(i);
                contents.push(list.count);
                std::slice::from_raw_parts(list.data, self.capacity as usize * FLOATS)
            };
            contents.extend(floats.iter().map(|f| f.to_bits()));
        }
        contents
    }

    fn canaries_live(&self, headers: *const MOC_TriList) -> bool {
        (1..self.data.len()).all(|i| {
            // SAFETY: behind every list but the last lies a canary.
            let canary = unsafe { (*headers.add(i)).data.sub(CANARY.len()).cast::<[f32; CANARY.len()]>().read() };
            canary == CANARY
        })
    }
}

/// Draws all bins of one object.
struct Job<'a> {
    moc: *const MaskedOcclusionCulling,
    lists: *const MOC_TriList,
    rectangles: &'a [MOC_ScissorRect],
}

// SAFETY: the object may be drawn to from several threads on disjoint rectangles; the lists are only read.
unsafe impl Sync for Job<'_> {}

impl Job<'_> {
    /// Draws every `step`th bin from `first` on; returns the worst status.
    fn draw(&self, first: usize, step: usize) -> i32 {
        let mut worst = OK;
        for i in (first..self.rectangles.len()).step_by(step) {
            // SAFETY: a live object, as many lists as rectangles, and the rectangles of bins are disjoint.
            let status = unsafe { MOC_RenderTrilist(self.moc, self.lists.add(i), &self.rectangles[i]) };
            worst = worst.max(status as i32);
        }
        worst
    }
}

/// The bin size according to the members; `None` if there is none.
fn bin_size(family: &Family, bins_w: u32, bins_h: u32) -> Check<Option<(u32, u32)>> {
    let (status, size) = family.all("ComputeBinWidthHeight", |_, moc| {
        let (mut width, mut height) = (0, 0);
        // SAFETY: a live object, and places for the answers.
        let status = unsafe { MOC_ComputeBinWidthHeight(moc, bins_w, bins_h, &mut width, &mut height) };
        (status as i32, (width, height))
    })?;
    Ok((status == OK).then_some(size))
}

/// A plausible coordinate for a list, in 1/256 pixels, or a hostile one.
fn list_float(rng: &mut fastrand::Rng) -> f32 {
    match rng.u8(..4) {
        0 => hostile::float(rng),
        1 => rng.f32(),
        _ => rng.i32(-100_000..300_000) as f32,
    }
}

fn bin(moc: *const MaskedOcclusionCulling, m: &Mesh, lists: *mut MOC_TriList, w: u32, h: u32) -> (i32, i32) {
    let mut answer = 77;
    // SAFETY: a live object; each pointer is null or valid, and where the length of the vertices is not told,
    // the layout is kept and every index is in range. There is a list for every bin, where the bins have a size.
    let status = unsafe {
        if m.checked {
            MOC_BinTrianglesChecked(
                moc,
                m.vertices,
                m.vertex_floats,
                m.triangles,
                m.n_triangles,
                lists,
                w,
                h,
                m.matrix,
                m.winding,
                m.clip_planes,
                m.layout,
                &mut answer,
            )
        } else {
            MOC_BinTriangles(
                moc,
                m.vertices,
                m.triangles,
                m.n_triangles,
                lists,
                w,
                h,
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
