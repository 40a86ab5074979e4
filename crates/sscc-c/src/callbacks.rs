//! Progress and cancel callbacks of the caller.

use std::ffi::c_void;
use std::sync::atomic::{AtomicBool, AtomicPtr, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use sscc::{CancelToken, Progress};

use crate::types::{sscc_cancel_fn, sscc_progress_fn};

/// The callbacks of one computation, and whether they have cancelled it. Only one thread at a time calls them.
struct Callbacks {
    progress: sscc_progress_fn,
    cancel: sscc_cancel_fn,
    user: AtomicPtr<c_void>,
    lock: Mutex<()>,
    is_cancelled: AtomicBool,
}

impl Callbacks {
    fn user(&self) -> *mut c_void {
        self.user.load(Ordering::Relaxed)
    }

    /// Records the answer of a callback. A cancelled computation stays cancelled.
    fn set(&self, answer: std::ffi::c_int) {
        if answer != 0 {
            self.is_cancelled.store(true, Ordering::Relaxed);
        }
    }

    fn report(&self, done: usize, total: usize) {
        let Some(progress) = self.progress else { return };
        let _lock = self.lock.lock().unwrap_or_else(PoisonError::into_inner);
        if !self.is_cancelled.load(Ordering::Relaxed) {
            self.set(progress(self.user(), done, total));
        }
    }

    fn is_cancelled(&self) -> bool {
        let has_ended = || self.is_cancelled.load(Ordering::Relaxed);
        if let (Some(cancel), false) = (self.cancel, has_ended()) {
            // While another thread is in a callback, this thread continues its work.
            if let Ok(_lock) = self.lock.try_lock() {
                // Another thread may have cancelled just before.
                if !has_ended() {
                    self.set(cancel(self.user()));
                }
            }
        }
        has_ended()
    }
}

/// Reports the progress of a computation to the caller's callbacks.
pub struct Reporter {
    callbacks: Arc<Callbacks>,
    token: CancelToken,
}

impl Reporter {
    pub fn new(progress: sscc_progress_fn, cancel: sscc_cancel_fn, user: *mut c_void) -> Self {
        let (user, lock) = (AtomicPtr::new(user), Mutex::new(()));
        let is_cancelled = AtomicBool::new(false);
        let callbacks = Arc::new(Callbacks { progress, cancel, user, lock, is_cancelled });
        let token_callbacks = Arc::clone(&callbacks);
        Self { callbacks, token: CancelToken::when(move || token_callbacks.is_cancelled()) }
    }

    /// Whether a callback has cancelled, perhaps too late to have an effect.
    pub fn has_cancelled(&self) -> bool {
        self.callbacks.is_cancelled.load(Ordering::Relaxed)
    }
}

impl Progress for Reporter {
    fn report(&self, done: usize, total: usize) {
        self.callbacks.report(done, total);
    }

    fn cancel_token(&self) -> Option<&CancelToken> {
        Some(&self.token)
    }
}

/// Returns a token that queries check; `None` without a function.
pub fn cancel_token(cancel: sscc_cancel_fn, user: *mut c_void) -> Option<CancelToken> {
    let (cancel, user) = (cancel?, AtomicPtr::new(user));
    Some(CancelToken::when(move || cancel(user.load(Ordering::Relaxed)) != 0))
}
