//! Turns the caller's pointers into references and slices, with the checks that can be made.

use super::refusal::{Because, Refusal};
use super::status::MOC_Status;
use crate::MaskedOcclusionCulling;

const NO_OBJECT: Refusal = Refusal::new(MOC_Status::MOC_STATUS_NULL_POINTER, "the object is null");

/// # Safety
/// Null or from `MOC_Create` and not destroyed, and nobody changes the object meanwhile.
pub(super) unsafe fn object<'a>(moc: *const MaskedOcclusionCulling) -> Result<&'a MaskedOcclusionCulling, Refusal> {
    // SAFETY: the caller's contract.
    unsafe { moc.as_ref() }.ok_or(NO_OBJECT)
}

/// # Safety
/// Null or from `MOC_Create` and not destroyed, and nobody else uses the object meanwhile.
pub(super) unsafe fn object_mut<'a>(
    moc: *mut MaskedOcclusionCulling,
) -> Result<&'a mut MaskedOcclusionCulling, Refusal> {
    // SAFETY: the caller's contract.
    unsafe { moc.as_mut() }.ok_or(NO_OBJECT)
}

/// The same for calls that change the object; refused while its pool is drawing into it, since other threads then
/// read it.
///
/// # Safety
/// Null or from `MOC_Create` and not destroyed; nothing else uses the object meanwhile, except a pool that is drawing
/// into it.
#[inline]
pub(super) unsafe fn idle_object_mut<'a>(
    moc: *mut MaskedOcclusionCulling,
) -> Result<&'a mut MaskedOcclusionCulling, Refusal> {
    // SAFETY: the caller's contract. With nothing in flight the pool's threads do not access it, so `&mut` is the only
    // reference.
    unsafe {
        check_idle(object(moc)?)?;
        object_mut(moc)
    }
}

/// Refuses calls that would change or copy the buffer while the object's pool draws into it.
#[inline]
pub(super) fn check_idle(moc: &MaskedOcclusionCulling) -> Result<(), MOC_Status> {
    if moc.attachment().is_busy() { Err(MOC_Status::MOC_STATUS_BUSY) } else { Ok(()) }
}

/// Refuses an object without a buffer.
#[inline]
pub(super) fn with_buffer(moc: &MaskedOcclusionCulling) -> Result<&MaskedOcclusionCulling, MOC_Status> {
    if moc.has_buffer() { Ok(moc) } else { Err(MOC_Status::MOC_STATUS_NO_BUFFER) }
}

/// An array of objects.
///
/// # Safety
/// `objects` is null or can be read for `count` pointers, each null or from `MOC_Create` and not destroyed, and nobody
/// changes the objects meanwhile.
pub(super) unsafe fn objects<'a>(
    objects: *const *const MaskedOcclusionCulling,
    count: u32,
) -> Result<Vec<&'a MaskedOcclusionCulling>, Refusal> {
    // SAFETY: the caller's contract.
    let pointers = unsafe { slice(objects, count as usize) }
        .because(MOC_Status::MOC_STATUS_NULL_POINTER, "the array of other objects is null")?;
    // SAFETY: the caller's contract.
    let object = |&moc: &_| unsafe { object(moc) };
    pointers
        .iter()
        .map(object)
        .collect::<Result<_, _>>()
        .because(MOC_Status::MOC_STATUS_NULL_POINTER, "one of the other objects is null")
}

/// `len` elements from `data`, which may be null when there are none.
///
/// # Safety
/// `data` is null or holds `len` elements that nobody changes for `'a`.
pub(super) unsafe fn slice<'a, T>(data: *const T, len: usize) -> Result<&'a [T], MOC_Status> {
    check_array(data, len)?;
    if len == 0 {
        return Ok(&[]);
    }
    // SAFETY: not null, aligned and not too long, as just checked; the rest is the caller's contract.
    Ok(unsafe { core::slice::from_raw_parts(data, len) })
}

/// As [`slice`], but mutable.
///
/// # Safety
/// `data` is null or holds `len` elements that nobody else uses for `'a`.
pub(super) unsafe fn slice_mut<'a, T>(data: *mut T, len: usize) -> Result<&'a mut [T], MOC_Status> {
    check_array(data, len)?;
    if len == 0 {
        return Ok(&mut []);
    }
    // SAFETY: not null, aligned and not too long, as just checked; the rest is the caller's contract.
    Ok(unsafe { core::slice::from_raw_parts_mut(data, len) })
}

fn check_array<T>(data: *const T, len: usize) -> Result<(), MOC_Status> {
    if len == 0 {
        return Ok(());
    }
    if data.is_null() {
        return Err(MOC_Status::MOC_STATUS_NULL_POINTER);
    }
    if !data.is_aligned() {
        return Err(MOC_Status::MOC_STATUS_INVALID_LAYOUT);
    }
    check_length::<T>(len)
}

/// Refuses more elements than an array can have: with 32-bit pointers, C's counts can exceed that.
pub(super) fn check_length<T>(len: usize) -> Result<(), MOC_Status> {
    match len.checked_mul(size_of::<T>()) {
        Some(bytes) if bytes <= isize::MAX as usize => Ok(()),
        _ => Err(MOC_Status::MOC_STATUS_INVALID_SIZE),
    }
}

/// Reads what a pointer points to, whatever its alignment; `None` if it is null.
///
/// # Safety
/// `data` is null or can be read.
#[inline]
pub(super) unsafe fn read<T: Copy>(data: *const T) -> Option<T> {
    // SAFETY: not null, and the caller's contract.
    if data.is_null() { None } else { Some(unsafe { data.read_unaligned() }) }
}

/// Reads the size with which a struct begins.
///
/// # Safety
/// `data` is null or can be read for four bytes.
#[inline]
pub(super) unsafe fn read_size<T>(data: *const T) -> Option<usize> {
    // SAFETY: the caller's contract.
    unsafe { read(data.cast::<u32>()) }.map(|size| size as usize)
}

/// # Safety
/// `out` can be written.
pub(super) unsafe fn write<T: Copy>(out: *mut T, value: T) {
    // SAFETY: the caller's contract; C does not guarantee the alignment.
    unsafe { out.write_unaligned(value) }
}

/// Refuses a null out pointer.
pub(super) fn check_out<T>(out: *mut T) -> Result<(), Refusal> {
    if out.is_null() {
        Err(Refusal::new(MOC_Status::MOC_STATUS_NULL_POINTER, "the output pointer is null"))
    } else {
        Ok(())
    }
}

/// Writes a width and a height, or 0 by 0 for an error, which is returned.
///
/// # Safety
/// The pointers are null or can be written.
pub(super) unsafe fn write_size(
    width: *mut u32,
    height: *mut u32,
    size: Result<(u32, u32), Refusal>,
) -> Result<(), Refusal> {
    check_out(width)?;
    check_out(height)?;
    let (w, h) = *size.as_ref().unwrap_or(&(0, 0));
    // SAFETY: not null, and the caller's contract.
    unsafe {
        write(width, w);
        write(height, h);
    }
    size.map(|_| ())
}
