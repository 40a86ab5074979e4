//! Handles: objects that C owns.
#![allow(unsafe_code, reason = "pointers from C")]

use crate::live;
use crate::pointers::Output;
use crate::status::{Failure, Result, sscc_status};

/// An object that C owns by a pointer.
pub trait Handle: Sized {
    /// The name of the type in messages.
    const NAME: &'static str;

    /// Returns an error during a call that uses the object, which must not be freed then.
    fn check_idle(&self) -> Result<()> {
        Ok(())
    }
}

/// Passes ownership of an object to C.
pub fn give<T: Handle>(object: T, out: Output<*mut T>) {
    let pointer = Box::into_raw(Box::new(object));
    live::add(pointer.addr(), T::NAME);
    out.write(pointer);
}

/// Returns the object of a handle.
///
/// # Errors
/// When the handle is NULL; with debug assertions, when it is not a live handle of the type.
///
/// # Safety
/// The pointer is NULL or a live handle that [`give`] made, and it is not freed while the object is used.
#[inline(always)]
pub unsafe fn borrow<'a, T: Handle>(handle: *const T) -> Result<&'a T> {
    if handle.is_null() {
        return Err(missing(T::NAME));
    }
    live::check(handle.addr(), T::NAME)?;
    // SAFETY: by the caller's guarantee the object exists.
    Ok(unsafe { &*handle })
}

#[cold]
fn missing(name: &str) -> Failure {
    Failure::new(sscc_status::Null, format!("{name} is NULL"))
}

/// Frees the object of a handle; NULL is ignored.
///
/// # Errors
/// When a call is using the handle; with debug assertions, when it is not a live handle of the type.
///
/// # Safety
/// The pointer is NULL or a live handle that [`give`] made, and it is not used any more.
pub unsafe fn free<T: Handle>(handle: *mut T) -> Result<()> {
    if handle.is_null() {
        return Ok(());
    }
    // SAFETY: by the caller's guarantee.
    unsafe { borrow(handle) }?.check_idle()?;
    live::remove(handle.addr());
    // SAFETY: `give` made the pointer of a box, which is given back once.
    drop(unsafe { Box::from_raw(handle) });
    Ok(())
}
