//! Arrays and outputs of the caller: checked once, then used without pointers.
#![allow(unsafe_code, reason = "pointers from C")]

use std::ffi::{CStr, c_char};
use std::ops::Range;
use std::path::Path;

use crate::status::{Failure, Result, sscc_status};

/// Memory of the caller for one result.
pub struct Output<T>(*mut T);

impl<T> Output<T> {
    /// Writes the result.
    #[inline(always)]
    pub fn write(self, value: T) {
        // SAFETY: `output` has checked the pointer, and its caller guarantees that it can be written to.
        unsafe { self.0.write(value) }
    }
}

/// Checks the memory of the caller for one result.
///
/// # Errors
/// When the pointer is NULL or misaligned.
///
/// # Safety
/// The pointer is NULL, or may be written to until the end of the call.
#[inline(always)]
pub unsafe fn output<T>(pointer: *mut T, name: &str) -> Result<Output<T>> {
    check(pointer, 1, name)?;
    Ok(Output(pointer))
}

/// Checks the memory for an optional result, for which the caller may pass NULL.
///
/// # Errors
/// When the pointer is misaligned.
///
/// # Safety
/// As for [`output`].
pub unsafe fn optional_output<T>(pointer: *mut T, name: &str) -> Result<Option<Output<T>>> {
    // SAFETY: by the caller's guarantee.
    (!pointer.is_null()).then(|| unsafe { output(pointer, name) }).transpose()
}

/// Reads a struct for which the caller may pass NULL.
///
/// # Errors
/// When the pointer is misaligned.
///
/// # Safety
/// The pointer is NULL, or points to an initialized struct that does not change during the call.
pub unsafe fn optional<T: Copy>(pointer: *const T, name: &str) -> Result<Option<T>> {
    if pointer.is_null() {
        return Ok(None);
    }
    check(pointer, 1, name)?;
    // SAFETY: checked, and by the caller's guarantee.
    Ok(Some(unsafe { pointer.read() }))
}

/// Returns the numbers of an array; NULL is an array without numbers.
///
/// # Errors
/// When the array is NULL although the length is not 0; when it is misaligned, or larger than memory.
///
/// # Safety
/// The array has that many initialized numbers, which do not change during the call.
#[inline(always)]
pub unsafe fn slice<'a, T>(data: *const T, length: usize, name: &str) -> Result<&'a [T]> {
    if !is_valid(data, length) {
        return empty_or_refused(data, length, name);
    }
    // SAFETY: checked, and by the caller's guarantee.
    Ok(unsafe { std::slice::from_raw_parts(data, length) })
}

/// An array for results.
pub struct OutputArray<T> {
    data: *mut T,
    length: usize,
}

/// Checks an array for results; NULL is an array of length 0.
///
/// # Errors
/// As for [`slice`].
///
/// # Safety
/// The array may be written to until the end of the call.
#[inline(always)]
pub unsafe fn output_array<T>(data: *mut T, length: usize, name: &str) -> Result<OutputArray<T>> {
    if !(data.is_null() && length == 0) {
        check(data, length, name)?;
    }
    Ok(OutputArray { data, length })
}

impl<T> OutputArray<T> {
    pub fn length(&self) -> usize {
        self.length
    }

    /// Writes one result.
    #[inline(always)]
    pub fn write(&self, index: usize, value: T) {
        assert!(index < self.length);
        // SAFETY: the element is within the array, which `output_array` has checked and its caller guarantees.
        unsafe { self.data.add(index).write(value) }
    }

    /// Refuses an array that has memory in common with another one, which is read.
    ///
    /// # Errors
    /// When the arrays overlap.
    pub fn check_apart<U>(&self, other: &[U], names: &str) -> Result<()> {
        let own = bytes(self.data.addr(), self.length * size_of::<T>());
        let other = bytes(other.as_ptr().addr(), size_of_val(other));
        if own.start < other.end && other.start < own.end {
            return Err(Failure::new(sscc_status::Overlap, format!("{names} overlap")));
        }
        Ok(())
    }
}

fn bytes(start: usize, size: usize) -> Range<usize> {
    start..start.saturating_add(size)
}

/// Whether a pointer to `length` numbers is neither NULL nor misaligned, and the numbers fit into memory.
#[inline(always)]
fn is_valid<T>(data: *const T, length: usize) -> bool {
    !data.is_null() && data.is_aligned() && length <= isize::MAX as usize / size_of::<T>().max(1)
}

#[cold]
fn empty_or_refused<'a, T>(data: *const T, length: usize, name: &str) -> Result<&'a [T]> {
    if data.is_null() && length == 0 {
        return Ok(&[]);
    }
    Err(refused(data.is_null(), data.is_aligned(), align_of::<T>(), length, name))
}

/// Refuses a pointer to `length` numbers that is NULL or misaligned, and numbers that do not fit into memory.
#[inline(always)]
pub fn check<T>(data: *const T, length: usize, name: &str) -> Result<()> {
    if is_valid(data, length) {
        return Ok(());
    }
    Err(refused(data.is_null(), data.is_aligned(), align_of::<T>(), length, name))
}

#[cold]
fn refused(is_null: bool, is_aligned: bool, alignment: usize, length: usize, name: &str) -> Failure {
    if is_null {
        Failure::new(sscc_status::Null, format!("{name} is NULL"))
    } else if !is_aligned {
        let message = format!("{name} is misaligned: its address must be a multiple of {alignment}");
        Failure::new(sscc_status::Misaligned, message)
    } else {
        Failure::argument(format!("{name} has length {length}: more than memory"))
    }
}

/// Reads a path, in UTF-8.
///
/// # Errors
/// When the text is NULL or not UTF-8.
///
/// # Safety
/// The pointer is NULL, or a text that ends with 0 and does not change during the call.
pub unsafe fn path<'a>(text: *const c_char, name: &str) -> Result<&'a Path> {
    check(text, 1, name)?;
    // SAFETY: by the caller's guarantee.
    let text = unsafe { CStr::from_ptr(text) }.to_str();
    Ok(Path::new(text.map_err(|_| Failure::argument(format!("{name} is not UTF-8")))?))
}

/// A struct whose first field is its size, so that later versions can add fields. Fields that the caller's version does not have
/// are read as 0.
///
/// # Safety
/// Zeros are a valid value of the type, which begins with a `usize`, has no padding, and holds no references.
pub unsafe trait Versioned: Copy {}

/// Reads a struct that begins with its size; NULL is a struct of zeros.
///
/// # Errors
/// When the pointer is misaligned; when the size is not a multiple of that of a `usize`, is 0, or is larger than 4096;
/// when fields are set that this version does not have.
///
/// # Safety
/// The pointer is NULL, or points to as many initialized bytes as its first field states, which do not change during the call.
pub unsafe fn read_versioned<T: Versioned>(pointer: *const T, name: &str) -> Result<T> {
    let mut value = std::mem::MaybeUninit::<T>::zeroed();
    if !pointer.is_null() {
        check(pointer, 1, name)?;
        // SAFETY: the first field exists, by the caller's guarantee.
        let size = unsafe { pointer.cast::<usize>().read() };
        if !(size_of::<usize>()..=4096).contains(&size) || !size.is_multiple_of(size_of::<usize>()) {
            let message = format!("{name}.size is {size}: set it to sizeof of the struct");
            return Err(Failure::argument(message));
        }
        // SAFETY: this number of bytes exists, by the caller's guarantee.
        let given = unsafe { std::slice::from_raw_parts(pointer.cast::<u8>(), size) };
        let known = size.min(size_of::<T>());
        if given[known..].iter().any(|byte| *byte != 0) {
            let message = format!("{name} has fields that this version of the library does not know");
            return Err(Failure::argument(message));
        }
        // SAFETY: `known` is at most the size of both.
        unsafe { value.as_mut_ptr().cast::<u8>().copy_from_nonoverlapping(given.as_ptr(), known) };
    }
    // SAFETY: zeros and the caller's fields are valid values, by the trait's guarantee.
    Ok(unsafe { value.assume_init() })
}
