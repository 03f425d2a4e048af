//! Objects with the same settings on every instruction set, which must all behave the same.

use std::ptr::null_mut;

use masked_occlusion_culling::MaskedOcclusionCulling;
use masked_occlusion_culling::capi::*;

use crate::memory;
use crate::pool::Pool;

pub const OK: i32 = MOC_Status::MOC_STATUS_OK as i32;
pub const VISIBLE: i32 = MOC_CullingResult::MOC_VISIBLE as i32;
pub const OCCLUDED: i32 = MOC_CullingResult::MOC_OCCLUDED as i32;
pub const VIEW_CULLED: i32 = MOC_CullingResult::MOC_VIEW_CULLED as i32;

pub const NO_BUFFER: i32 = MOC_Status::MOC_STATUS_NO_BUFFER as i32;
/// The result of a call that left its result unchanged, or that has none.
pub const UNTOUCHED: i32 = 77;

/// A description of the failure.
pub type Check<T = ()> = Result<T, String>;

pub fn ensure(holds: bool, what: impl FnOnce() -> String) -> Check {
    if holds { Ok(()) } else { Err(what()) }
}

/// One object for each instruction set of this processor.
pub struct Family {
    pub members: Vec<*mut MaskedOcclusionCulling>,
    pub size: Option<(u32, u32)>,
    pub near: f32,
    pub update_rule: i32,
    pub y_axis: i32,
    pub own_allocator: bool,
    /// Nothing has been drawn since the last clear.
    pub empty: bool,
    /// While a pool draws into one member.
    pub pool: Option<Pool>,
    /// A member belongs to a pool but is currently used directly: no other pool may have it.
    pub attached: bool,
    /// A pool was queried while it was drawing: how much its member tested depends on what was drawn by then.
    pub asked_early: bool,
}

impl Family {
    pub fn new(update_rule: i32, y_axis: i32, own_allocator: bool, statistics: bool) -> Check<Self> {
        let mut family = Self {
            members: Vec::new(),
            size: None,
            near: 0.0,
            update_rule,
            y_axis,
            own_allocator,
            empty: true,
            pool: None,
            attached: false,
            asked_early: false,
        };
        let mut seen = Vec::new();
        for implementation in [-1, 0, 1, 2, 3, 16] {
            let (alloc, free): (MOC_AlignedAlloc, MOC_AlignedFree) =
                if own_allocator { (Some(memory::alloc), Some(memory::free)) } else { (None, None) };
            let settings = MOC_Settings {
                size: size_of::<MOC_Settings>() as u32,
                implementation,
                update_rule,
                y_axis,
                statistics: statistics.into(),
                alloc,
                free,
                call_alloc: None,
            };
            let (mut moc, mut used) = (null_mut(), 0);
            // SAFETY: the settings and the place for the object are valid, the callbacks are an allocator.
            let status = unsafe { MOC_Create(&settings, &mut moc) } as i32;
            ensure(status == OK && !moc.is_null(), || format!("MOC_Create: status {status} for good settings"))?;
            family.members.push(moc);
            // SAFETY: an object just made, and a valid place.
            let status = unsafe { MOC_GetImplementation(moc, &mut used) } as i32;
            ensure(status == OK, || format!("MOC_GetImplementation: status {status}"))?;
            if seen.contains(&used) {
                family.members.pop();
                // SAFETY: an object just created, which is not used after this.
                unsafe { MOC_Destroy(moc) };
            }
            seen.push(used);
        }
        Ok(family)
    }

    /// Makes the same call on every member; the results must agree. A call returns its status first.
    pub fn all<T: PartialEq + std::fmt::Debug>(
        &self,
        name: &str,
        mut call: impl FnMut(usize, *mut MaskedOcclusionCulling) -> (i32, T),
    ) -> Check<(i32, T)> {
        let mut first: Option<(i32, T)> = None;
        for (i, &moc) in self.members.iter().enumerate() {
            let got = call(i, moc);
            // Statuses after that of an internal error belong to recordings, which are not made here.
            ensure((OK..MOC_Status::MOC_STATUS_INTERNAL as i32).contains(&got.0), || {
                format!("{name}: status {} from object {i}", got.0)
            })?;
            match &first {
                None => first = Some(got),
                Some(first) => ensure(*first == got, || {
                    format!("{name}: the first object gives {first:?}, object {i} {got:?} (status, answer)")
                })?,
            }
        }
        first.ok_or_else(|| "a family without members".into())
    }

    /// The pool through which a member must be called.
    pub fn through(&self) -> impl Fn(usize) -> Option<*const MOC_Threadpool> + Copy + use<> {
        let pool = self.pool.as_ref().map(|pool| (pool.member, pool.handle.cast_const()));
        move |i| pool.filter(|&(member, _)| member == i).map(|(_, handle)| handle)
    }

    /// As `all`, for draws and queries; also returns the pool's result, if there is one. It may reflect an earlier
    /// state, so it need not agree until the pool is flushed: hidden then and visible now, or the reverse.
    pub fn ask(
        &mut self,
        name: &str,
        mut call: impl FnMut(usize, *mut MaskedOcclusionCulling) -> (i32, i32),
    ) -> Check<(i32, i32, Option<i32>)> {
        let member = self.pool.as_ref().map(|pool| pool.member);
        let mut answers = Vec::new();
        let (status, ()) = self.all(name, |i, moc| {
            let (status, answer) = call(i, moc);
            answers.push(answer);
            // A pool checks for the buffer first, an object last.
            let late = member.is_some_and(|member| member != i) && self.size.is_none() && status != OK;
            (if late { NO_BUFFER } else { status }, ())
        })?;
        let early = self.pool.as_ref().is_some_and(|pool| !pool.settled);
        let pooled = member.map(|member| answers[member]).filter(|&answer| answer != UNTOUCHED);
        let direct = (0..answers.len()).find(|&i| Some(i) != member).or(member).map_or(UNTOUCHED, |i| answers[i]);
        let same = |i: usize| Some(i) == member || answers[i] == direct;
        ensure((0..answers.len()).all(same), || format!("{name}: answers {answers:?}, pooled is {member:?}"))?;
        // For triangles that touch no pixel but whose bounding boxes are hidden, VIEW_CULLED may also become OCCLUDED.
        let hidden = |answer| [answer, direct].contains(&OCCLUDED);
        let allowed = |answer| answer == direct || early && hidden(answer);
        ensure(pooled.is_none_or(allowed), || format!("{name}: the pool answers {pooled:?}, the others {direct}"))?;
        self.asked_early |= early && pooled.is_some();
        Ok((status, direct, pooled))
    }
}

impl std::fmt::Display for Family {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { size, near, update_rule, y_axis, empty, .. } = self;
        write!(f, "size {size:?}, near {near:e}, rule {update_rule}, y axis {y_axis}, empty {empty}")
    }
}

impl Drop for Family {
    fn drop(&mut self) {
        for &moc in &self.members {
            // SAFETY: created in `new`, destroyed only here.
            unsafe { MOC_Destroy(moc) };
        }
    }
}
