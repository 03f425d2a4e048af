//! Creating, sizing and destroying an object, and its simple properties.

use std::alloc::Layout;

use super::pointers::{check_out, idle_object_mut, object, read, read_size, with_buffer, write, write_size};
use super::refusal::{Because, Refusal};
use super::status::{MOC_Status, done, guard};
use super::types::{self, MOC_Implementation, MOC_Settings, MOC_UpdateRule, MOC_YAxis};
use crate::{Allocator, MaskedOcclusionCulling, Settings};

const DEFAULTS: MOC_Settings = MOC_Settings {
    size: size_of::<MOC_Settings>() as u32,
    implementation: MOC_Implementation::MOC_AVX512 as i32,
    update_rule: MOC_UpdateRule::MOC_UPDATE_RULE_THREE_LAYER as i32,
    y_axis: MOC_YAxis::MOC_Y_AXIS_DOWN as i32,
    statistics: 0,
    alloc: None,
    free: None,
    call_alloc: None,
};

/// The memory layout of the object itself: aligned like its buffers, with a size that is a multiple of the alignment,
/// so that one callback serves both and may be C11's aligned_alloc.
fn object_layout() -> Result<Layout, MOC_Status> {
    let layout = Layout::new::<MaskedOcclusionCulling>();
    Ok(layout.align_to(64).map_err(|_| MOC_Status::MOC_STATUS_OUT_OF_MEMORY)?.pad_to_align())
}

const SETTINGS_SIZE: Refusal =
    Refusal::new(MOC_Status::MOC_STATUS_INVALID_SIZE, "size is less than sizeof(MOC_Settings)");

/// Writes the default settings to `out`: those that MOC_Create uses if its `settings` are null. The caller sets
/// `out->size` to sizeof(MOC_Settings) before the call; it is not changed.
///
/// Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_INVALID_SIZE for a `size` that is too small, and nothing is written.
///
/// # Safety
/// `out` is null, or can be read and written for the number of bytes given in its `size`.
#[unsafe(export_name = symbol!(MOC_DefaultSettings))]
pub unsafe extern "C" fn MOC_DefaultSettings(out: *mut MOC_Settings) -> MOC_Status {
    guard(|| {
        check_out(out)?;
        // SAFETY: the caller's contract. The size is the first field, and nothing beyond it is read.
        let size = unsafe { read_size(out) }.filter(|&size| size >= size_of::<MOC_Settings>()).ok_or(SETTINGS_SIZE)?;
        // SAFETY: not null, and large enough according to its `size`; the caller's contract.
        unsafe { write(out, MOC_Settings { size: size as u32, ..DEFAULTS }) };
        Ok(())
    })
}

/// Creates an object without a buffer and writes it to `out` (null on errors). It uses the best instruction set that
/// the processor supports and `settings` allow. `settings` are copied; null means the defaults. The caller destroys the
/// object with MOC_Destroy.
///
/// Errors: MOC_STATUS_NULL_POINTER (if `out` is null, or only one of `alloc` and `free`), MOC_STATUS_INVALID_SIZE for a
/// `size` that is too small, MOC_STATUS_INVALID_ENUM, MOC_STATUS_OUT_OF_MEMORY.
///
/// # Safety
/// `settings` is null or can be read for the number of bytes given in its `size`, `out` is null or can be written. The
/// callbacks behave as documented for MOC_AlignedAlloc and MOC_AlignedFree until the object is destroyed.
#[unsafe(export_name = symbol!(MOC_Create))]
pub unsafe extern "C" fn MOC_Create(
    settings: *const MOC_Settings,
    out: *mut *mut MaskedOcclusionCulling,
) -> MOC_Status {
    guard(|| {
        check_out(out)?;
        // SAFETY: not null, and the caller's contract.
        unsafe { write(out, core::ptr::null_mut()) };
        // SAFETY: the caller's contract. The size is the first field, and nothing beyond it is read.
        if unsafe { read_size(settings) }.is_some_and(|size| size < size_of::<MOC_Settings>()) {
            return Err(SETTINGS_SIZE);
        }
        // SAFETY: null, or large enough according to its `size`; the caller's contract.
        let settings = unsafe { read(settings) }.unwrap_or(DEFAULTS);
        let allocator = match (settings.alloc, settings.free) {
            (None, None) => Allocator::SYSTEM,
            // SAFETY: the caller vouches for the callbacks, including `call_alloc`.
            (Some(alloc), Some(free)) => unsafe {
                Allocator::from_callbacks(alloc, free).called_through(settings.call_alloc)
            },
            _ => {
                return Err(Refusal::new(
                    MOC_Status::MOC_STATUS_NULL_POINTER,
                    "alloc and free must both be set or both be null",
                ));
            }
        };
        let settings = Settings {
            implementation: types::implementation(settings.implementation)?,
            update_rule: types::update_rule(settings.update_rule)?,
            y_axis: types::y_axis(settings.y_axis)?,
            allocator,
            statistics: types::flag(settings.statistics, "statistics is neither 0 nor 1")?,
        };
        let moc = MaskedOcclusionCulling::without_buffer(settings)?;
        let place = allocator.allocate(object_layout()?)?.cast::<MaskedOcclusionCulling>().as_ptr();
        // SAFETY: `place` is fresh memory of the object's layout; `out` as above.
        unsafe {
            place.write(moc);
            write(out, place);
        }
        Ok(())
    })
}

/// Frees the object and its buffer, and ends its recording. If a pool draws into the object, it first draws everything
/// submitted, and has no object afterwards. Null is allowed.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed; nobody uses it any more.
#[unsafe(export_name = symbol!(MOC_Destroy))]
pub unsafe extern "C" fn MOC_Destroy(moc: *mut MaskedOcclusionCulling) -> MOC_Status {
    guard(|| {
        let Some(place) = core::ptr::NonNull::new(moc) else { return Ok(()) };
        // SAFETY: the caller's contract: a live object that nobody else uses. `MOC_Create` took its memory
        // from the same allocator with the same layout.
        unsafe {
            // First, before there is a `&mut`: the pool may draw until this returns.
            place.as_ref().attachment().leave();
            let allocator = place.as_ref().allocator();
            place.drop_in_place();
            allocator.free(place.cast(), object_layout()?);
        }
        Ok(())
    })
}

pub(super) const RESOLUTION: &str = "width and height must be from 1 to 16384";

/// Gives the object a buffer of `width` by `height` pixels, each from 1 to 16384, and clears it. If the size does not
/// change, the buffer is only cleared. Each sub-tile of 8x4 pixels takes 20 bytes (12 with MOC_UPDATE_RULE_QUICK and
/// MOC_UPDATE_RULE_ACCURATE, 28 with MOC_UPDATE_RULE_FOUR_LAYER).
///
/// The buffer may be smaller than the screen: that is faster and culls less. But MOC_OCCLUDED then means hidden at the
/// buffer's pixel centres: a gap between occluders that is narrower than a buffer pixel can disappear in the buffer,
/// and what the screen shows through it is then culled. At 320x180 for a screen of 1920x1080, gaps of up to 5 screen
/// pixels can disappear. docs/guide.md says what to do about it.
///
/// Errors: MOC_STATUS_NULL_POINTER, MOC_STATUS_INVALID_SIZE, MOC_STATUS_OUT_OF_MEMORY, MOC_STATUS_BUSY while a pool is
/// drawing into the object. On an error the object keeps its old buffer.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed; no other thread uses it meanwhile.
#[unsafe(export_name = symbol!(MOC_SetResolution))]
pub unsafe extern "C" fn MOC_SetResolution(moc: *mut MaskedOcclusionCulling, width: u32, height: u32) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| {
        unsafe { idle_object_mut(moc) }?
            .set_resolution(width, height)
            .because(MOC_Status::MOC_STATUS_INVALID_SIZE, RESOLUTION)
    })
}

/// Writes the width and height of the buffer in pixels.
///
/// Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_NO_BUFFER, and 0 by 0 is written.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile. `width`
/// and `height` are null or can be written.
#[unsafe(export_name = symbol!(MOC_GetResolution))]
pub unsafe extern "C" fn MOC_GetResolution(
    moc: *const MaskedOcclusionCulling,
    width: *mut u32,
    height: *mut u32,
) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        let moc = unsafe { object(moc) }?;
        // SAFETY: the caller's contract.
        unsafe { write_size(width, height, with_buffer(moc).map(|moc| moc.resolution()).map_err(Refusal::from)) }
    })
}

pub(super) const BINS: &str = "bins_w or bins_h is 0, or so large that a bin is smaller than 32 by 8 pixels";

/// Writes the size in pixels of a bin when the buffer is divided into `bins_w` by `bins_h` bins: the buffer's width
/// divided by `bins_w`, rounded down to a multiple of 32, and its height divided by `bins_h`, rounded down to a
/// multiple of 8. The last column and row of bins extend to the buffer's edge.
///
/// Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_NO_BUFFER; MOC_STATUS_INVALID_SIZE if a bin count is 0 or bins would be
/// smaller than 32 by 8. After the last two, 0 by 0 is written.
///
/// # Safety
/// As MOC_GetResolution.
#[unsafe(export_name = symbol!(MOC_ComputeBinWidthHeight))]
pub unsafe extern "C" fn MOC_ComputeBinWidthHeight(
    moc: *const MaskedOcclusionCulling,
    bins_w: u32,
    bins_h: u32,
    width: *mut u32,
    height: *mut u32,
) -> MOC_Status {
    guard(|| {
        // SAFETY: the caller's contract.
        let moc = unsafe { object(moc) }?;
        let size = with_buffer(moc)
            .map_err(Refusal::from)
            .and_then(|moc| moc.compute_bin_size(bins_w, bins_h).because(MOC_Status::MOC_STATUS_INVALID_SIZE, BINS));
        // SAFETY: the caller's contract.
        unsafe { write_size(width, height, size) }
    })
}

pub(super) const NEAR: &str = "the near plane is NaN or infinite";

/// Sets the near plane, in clip-space w, for calls whose clip planes include MOC_CLIP_PLANE_NEAR: geometry nearer than
/// the plane is clipped. With 0, the default, or any value below 2^-30, only geometry behind the eye is clipped, and
/// occludees that reach behind it count as visible; so passing the camera's own near plane culls more.
///
/// Errors: MOC_STATUS_NULL_POINTER; MOC_STATUS_INVALID_NUMBER for NaN or an infinity, in which case the plane does not
/// change.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed; no other thread uses it meanwhile.
#[unsafe(export_name = symbol!(MOC_SetNearClipPlane))]
pub unsafe extern "C" fn MOC_SetNearClipPlane(moc: *mut MaskedOcclusionCulling, near_w: f32) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| unsafe { object(moc) }?.set_near_shared(near_w).because(MOC_Status::MOC_STATUS_INVALID_NUMBER, NEAR))
}

/// Writes the near plane, in clip-space w.
///
/// Errors: MOC_STATUS_NULL_POINTER.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed, and no other thread changes it meanwhile. `out` is
/// null or can be written.
#[unsafe(export_name = symbol!(MOC_GetNearClipPlane))]
pub unsafe extern "C" fn MOC_GetNearClipPlane(moc: *const MaskedOcclusionCulling, out: *mut f32) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| unsafe { get(moc, out, MaskedOcclusionCulling::near_clip_plane) })
}

/// Writes the MOC_Implementation that the object uses, which never changes.
///
/// Errors: MOC_STATUS_NULL_POINTER.
///
/// # Safety
/// As MOC_GetNearClipPlane.
#[unsafe(export_name = symbol!(MOC_GetImplementation))]
pub unsafe extern "C" fn MOC_GetImplementation(moc: *const MaskedOcclusionCulling, out: *mut i32) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| unsafe { get(moc, out, |m| m.implementation() as i32) })
}

/// Writes the MOC_UpdateRule that the object uses, which never changes.
///
/// Errors: MOC_STATUS_NULL_POINTER.
///
/// # Safety
/// As MOC_GetNearClipPlane.
#[unsafe(export_name = symbol!(MOC_GetUpdateRule))]
pub unsafe extern "C" fn MOC_GetUpdateRule(moc: *const MaskedOcclusionCulling, out: *mut i32) -> MOC_Status {
    // SAFETY: the caller's contract.
    guard(|| unsafe { get(moc, out, |m| m.update_rule() as i32) })
}

/// # Safety
/// `moc` as for [`object`]; `out` is null or can be written.
unsafe fn get<T: Copy>(
    moc: *const MaskedOcclusionCulling,
    out: *mut T,
    property: impl FnOnce(&MaskedOcclusionCulling) -> T,
) -> Result<(), Refusal> {
    // SAFETY: the caller's contract.
    let moc = unsafe { object(moc) }?;
    check_out(out)?;
    // SAFETY: not null, and the caller's contract.
    unsafe { write(out, property(moc)) };
    Ok(())
}

/// Waits until the pool that draws into the object, if any, has drawn everything submitted: afterwards the object may
/// be used directly as long as no thread calls the pool.
///
/// Errors: MOC_STATUS_NULL_POINTER.
///
/// # Safety
/// `moc` is null or from MOC_Create and not destroyed.
#[unsafe(export_name = symbol!(MOC_Flush))]
pub unsafe extern "C" fn MOC_Flush(moc: *const MaskedOcclusionCulling) -> MOC_Status {
    // The C++ class calls this before each direct draw.
    // SAFETY: the caller's contract.
    if unsafe { moc.as_ref() }.is_some_and(|moc| !moc.attachment().is_busy()) {
        return done();
    }
    guard(|| {
        // SAFETY: the caller's contract.
        unsafe { object(moc) }?.flush();
        Ok(())
    })
}
