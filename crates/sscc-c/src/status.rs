//! Outcomes of calls: status codes, the message of the last failure of each thread, and the barrier for panics.

use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CString, c_char};
use std::ops::Deref;
use std::panic::{AssertUnwindSafe, catch_unwind};

use sscc::Error;
use sscc_io::IoError;

/// The outcome of a call. Later versions may add values.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum sscc_status {
    /// The call succeeded.
    Ok = 0,
    /// A callback ended the call.
    Cancelled = 1,
    /// A pointer that must not be NULL is NULL.
    Null = 2,
    /// An address is not a multiple of the alignment of its type.
    Misaligned = 3,
    /// Two arrays overlap, elements of a matrix overlap or are interleaved, or two handles that must differ are the same.
    Overlap = 4,
    /// An argument is invalid, such as a wrong length or a number out of range; or the floating-point mode of the
    /// thread is not that of the proofs.
    Argument = 5,
    /// The pointer is not a live handle of this type. Only libraries with debug assertions detect this.
    Handle = 6,
    /// The handle is in use: by the function that called the callback; with debug assertions also by another thread.
    Busy = 7,
    /// The array is too small for the answer.
    Capacity = 8,
    /// The certificates are of another model.
    OtherModel = 9,
    /// There are more colliding pairs than an answer or certificates can contain, or too many pairs to ignore.
    TooMany = 10,
    /// A file cannot be read or written, or its content is malformed.
    File = 11,
    /// A defect of this library occurred; free the handles of the call.
    Internal = 12,
}

/// The reason why a call failed. It is a pointer, so that a result is one word, which a successful call returns in a register.
#[derive(Debug)]
pub struct Failure(Box<Cause>);

/// The content of a failure.
#[derive(Debug)]
pub struct Cause {
    pub status: sscc_status,
    pub message: String,
}

impl Deref for Failure {
    type Target = Cause;

    fn deref(&self) -> &Cause {
        &self.0
    }
}

pub type Result<T> = std::result::Result<T, Failure>;

impl Failure {
    pub fn new(status: sscc_status, message: impl Into<String>) -> Self {
        Self(Box::new(Cause { status, message: message.into() }))
    }

    pub fn argument(message: impl Into<String>) -> Self {
        Self::new(sscc_status::Argument, message)
    }

    /// Returns the failure of a call that a callback has ended.
    pub fn cancelled() -> Self {
        Error::Cancelled.into()
    }

    fn panicked(payload: &(dyn Any + Send)) -> Self {
        let text = payload.downcast_ref::<&str>().copied();
        let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("panic");
        Self::new(sscc_status::Internal, format!("a defect of sscc, please report it: {text}"))
    }
}

impl From<Error> for Failure {
    #[cold]
    #[inline(never)]
    fn from(error: Error) -> Self {
        let status = match error {
            Error::Cancelled => sscc_status::Cancelled,
            Error::OtherModel { .. } => sscc_status::OtherModel,
            Error::TooManyPairs { .. } | Error::TooManyCollisions { .. } | Error::TooManyIgnored { .. } => {
                sscc_status::TooMany
            }
            _ => sscc_status::Argument,
        };
        Self::new(status, error.to_string())
    }
}

impl From<IoError> for Failure {
    fn from(error: IoError) -> Self {
        Self::new(sscc_status::File, error.to_string())
    }
}

thread_local! {
    /// The message of the last call of this thread that failed.
    static MESSAGE: RefCell<Option<CString>> = const { RefCell::new(None) };
}

/// Runs a call, and stores the message of its failure. A panic is also a failure.
#[inline(always)]
pub fn guard(call: impl FnOnce() -> Result<()>) -> sscc_status {
    // The failure is stored within the barrier for panics, so that only a number is returned from it.
    let call = || match call() {
        Ok(()) => sscc_status::Ok,
        Err(failure) => store(failure),
    };
    match catch_unwind(AssertUnwindSafe(call)) {
        Ok(status) => status,
        Err(payload) => store_panic(payload),
    }
}

#[cold]
fn store_panic(payload: Box<dyn Any + Send>) -> sscc_status {
    store(Failure::panicked(&*payload))
}

#[cold]
#[inline(never)]
fn store(failure: Failure) -> sscc_status {
    let text = failure.message.replace(['\0', '\n', '\r'], " ");
    // While a thread ends, its message no longer exists.
    let _ = MESSAGE.try_with(|message| message.replace(CString::new(text).ok()));
    failure.status
}

/// Returns the message of the last failed call of this thread, one line in UTF-8; empty if no call has failed. It is valid until
/// the next failure of a call in this thread.
///
/// Threads: any; each has its own message.
#[allow(unsafe_code, reason = "the name is exported")]
#[unsafe(no_mangle)]
pub extern "C" fn sscc_error_message() -> *const c_char {
    let of_text = |text: &CString| text.as_ptr();
    MESSAGE
        .try_with(|message| message.borrow().as_ref().map_or(c"".as_ptr(), of_text))
        .unwrap_or(c"".as_ptr())
}

#[cfg(test)]
#[allow(unsafe_code)]
mod tests {
    use std::ffi::CStr;

    use super::*;

    #[test]
    fn a_panic_becomes_a_status_and_a_message() {
        assert_eq!(guard(|| Ok(())), sscc_status::Ok);
        assert_eq!(guard(|| panic!("vertex {}", 7)), sscc_status::Internal);
        // SAFETY: the message is valid until the next failure.
        let message = unsafe { CStr::from_ptr(sscc_error_message()) };
        assert_eq!(message.to_str(), Ok("a defect of sscc, please report it: vertex 7"));
    }

    #[test]
    fn errors_of_the_core_have_a_status() {
        let too_many = [
            Error::TooManyPairs { most: 1 },
            Error::TooManyCollisions { most: 1 },
            Error::TooManyIgnored { most: 1, rings: 2 },
        ];
        for error in too_many {
            assert_eq!(Failure::from(error).status, sscc_status::TooMany);
        }
        assert_eq!(Failure::from(Error::Cancelled).status, sscc_status::Cancelled);
        assert_eq!(Failure::from(Error::NoFaces).status, sscc_status::Argument);
    }

    #[test]
    fn zeros_in_messages_are_replaced() {
        assert_eq!(guard(|| Err(Failure::argument("a\0b"))), sscc_status::Argument);
        // SAFETY: as above.
        assert_eq!(unsafe { CStr::from_ptr(sscc_error_message()) }, c"a b");
    }
}
