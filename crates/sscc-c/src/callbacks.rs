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

#[cfg(test)]
mod tests {
    use std::ffi::c_int;
    use std::hint::spin_loop;
    use std::ptr::null_mut;
    use std::sync::Barrier;
    use std::sync::atomic::AtomicUsize;
    use std::thread;
    use std::time::Duration;

    use super::*;

    /// Some threads ask at the same time, again and again. The first answer cancels, so that there is no second call.
    #[test]
    fn a_function_that_has_cancelled_is_not_called_again() {
        static CALLS: AtomicUsize = AtomicUsize::new(0);
        extern "C" fn cancel(_user: *mut c_void) -> c_int {
            CALLS.fetch_add(1, Ordering::SeqCst);
            1
        }
        const THREADS: usize = 4;
        for round in 0..2000 {
            CALLS.store(0, Ordering::SeqCst);
            let reporter = Reporter::new(None, Some(cancel), null_mut());
            let start = Barrier::new(THREADS);
            thread::scope(|scope| {
                for _ in 0..THREADS {
                    scope.spawn(|| {
                        start.wait();
                        while !reporter.is_cancelled() {
                            spin_loop();
                        }
                    });
                }
            });
            assert_eq!(CALLS.load(Ordering::SeqCst), 1, "round {round}");
            assert!(reporter.has_cancelled());
        }
    }

    /// A report waits for the call of another thread, and is not passed on if that call cancels.
    #[test]
    fn a_report_during_a_call_that_cancels_is_not_passed_on() {
        static REPORTS: AtomicUsize = AtomicUsize::new(0);
        static IS_INSIDE: AtomicBool = AtomicBool::new(false);
        extern "C" fn progress(_user: *mut c_void, _done: usize, _total: usize) -> c_int {
            REPORTS.fetch_add(1, Ordering::SeqCst);
            0
        }
        extern "C" fn cancel(_user: *mut c_void) -> c_int {
            IS_INSIDE.store(true, Ordering::SeqCst);
            // Meanwhile the other thread begins its report.
            thread::sleep(Duration::from_millis(50));
            1
        }
        let reporter = Reporter::new(Some(progress), Some(cancel), null_mut());
        thread::scope(|scope| {
            scope.spawn(|| assert!(reporter.is_cancelled()));
            while !IS_INSIDE.load(Ordering::SeqCst) {
                thread::yield_now();
            }
            reporter.report(1, 2);
        });
        assert_eq!(REPORTS.load(Ordering::SeqCst), 0);
        assert!(reporter.has_cancelled());
    }
}
