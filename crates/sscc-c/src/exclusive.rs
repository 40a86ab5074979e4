//! `Exclusive`: state that only one call at a time uses.
#![allow(unsafe_code, reason = "a lock that costs no atomic exchange")]

use std::cell::UnsafeCell;
use std::ops::{Deref, DerefMut};
use std::sync::atomic::{AtomicU8, Ordering};
use std::thread;

use crate::status::{Failure, Result, sscc_status};

const IDLE: u8 = 0;
const IN_USE: u8 = 1;
/// The usage after a call has panicked: the state may be invalid.
const BROKEN: u8 = 2;

/// State that only one call at a time uses. The caller guarantees that calls of several threads do not overlap; calls from a
/// callback within another call are refused.
pub struct Exclusive<T> {
    usage: AtomicU8,
    state: UnsafeCell<T>,
}

/// The state during a call.
pub struct Lock<'a, T>(&'a Exclusive<T>);

impl<T> Exclusive<T> {
    pub fn new(state: T) -> Self {
        Self { usage: AtomicU8::new(IDLE), state: UnsafeCell::new(state) }
    }

    /// Returns the state for one call.
    ///
    /// # Errors
    /// When another call is using it, or has panicked.
    #[inline(always)]
    pub fn lock(&self) -> Result<Lock<'_, T>> {
        // With debug assertions, overlapping calls of several threads are refused, too.
        let usage = if cfg!(debug_assertions) {
            let exchanged = self.usage.compare_exchange(IDLE, IN_USE, Ordering::Acquire, Ordering::Relaxed);
            exchanged.unwrap_or_else(|usage| usage)
        } else {
            let usage = self.usage.load(Ordering::Relaxed);
            if usage == IDLE {
                self.usage.store(IN_USE, Ordering::Relaxed);
            }
            usage
        };
        if usage == IDLE { Ok(Lock(self)) } else { Err(refused(usage)) }
    }

    /// Refuses to free state that a call is using.
    pub fn check_idle(&self) -> Result<()> {
        if self.usage.load(Ordering::Relaxed) == IN_USE { Err(refused(IN_USE)) } else { Ok(()) }
    }
}

#[cold]
fn refused(usage: u8) -> Failure {
    if usage == BROKEN {
        Failure::new(
            sscc_status::Internal,
            "an earlier call with this handle failed by a defect: free the handle",
        )
    } else {
        Failure::new(sscc_status::Busy, "the handle is in use by another call")
    }
}

impl<T> Deref for Lock<'_, T> {
    type Target = T;

    #[inline(always)]
    fn deref(&self) -> &T {
        // SAFETY: this is the only lock, and borrows it.
        unsafe { &*self.0.state.get() }
    }
}

impl<T> DerefMut for Lock<'_, T> {
    #[inline(always)]
    fn deref_mut(&mut self) -> &mut T {
        // SAFETY: this is the only lock, and borrows it alone.
        unsafe { &mut *self.0.state.get() }
    }
}

impl<T> Drop for Lock<'_, T> {
    #[inline(always)]
    fn drop(&mut self) {
        let usage = if thread::panicking() { BROKEN } else { IDLE };
        self.0.usage.store(usage, Ordering::Release);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::status::guard;

    #[test]
    fn a_call_within_a_call_is_refused() {
        let state = Exclusive::new(1);
        let lock = state.lock().unwrap();
        assert_eq!(state.lock().err().unwrap().status, sscc_status::Busy);
        assert_eq!(state.check_idle().unwrap_err().status, sscc_status::Busy);
        drop(lock);
        *state.lock().unwrap() += 1;
        assert_eq!(*state.lock().unwrap(), 2);
    }

    #[test]
    fn after_a_panic_every_call_is_refused() {
        let state = Exclusive::new(1);
        let call = || {
            let _lock = state.lock()?;
            panic!("half done")
        };
        assert_eq!(guard(call), sscc_status::Internal);
        assert_eq!(state.lock().err().unwrap().status, sscc_status::Internal);
        assert!(state.check_idle().is_ok());
    }
}
