//! Callbacks that count, cancel, and call back into the library.

use std::ffi::{c_int, c_void};
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use sscc_c::*;

use crate::common::{FACES, Handles, TWO, done, faces, made, matrix, refused};
use crate::threads::Strip;

/// The calls of callbacks.
#[derive(Default)]
struct Seen {
    calls: AtomicUsize,
    is_inside: AtomicBool,
    /// The call at which the callback cancels, counted from 1.
    last: usize,
}

impl Seen {
    fn call(user: *mut c_void) -> c_int {
        // SAFETY: the pointer is that of the test.
        let seen = unsafe { &*user.cast::<Self>() };
        assert!(!seen.is_inside.swap(true, Ordering::SeqCst), "two calls at a time");
        let calls = seen.calls.fetch_add(1, Ordering::SeqCst) + 1;
        seen.is_inside.store(false, Ordering::SeqCst);
        c_int::from(calls == seen.last)
    }

    fn user(&self) -> *mut c_void {
        (&raw const *self).cast_mut().cast()
    }

    fn count(&self) -> usize {
        self.calls.load(Ordering::SeqCst)
    }
}

extern "C" fn progress(user: *mut c_void, done: usize, total: usize) -> c_int {
    assert!(done <= total);
    Seen::call(user)
}

extern "C" fn cancel(user: *mut c_void) -> c_int {
    Seen::call(user)
}

// SAFETY: in all calls here arrays have the stated lengths, and handles are live.

#[test]
fn a_computation_reports_and_is_cancelled() {
    let all = Handles::new();
    let compute = |progress, cancel, last| {
        let seen = Seen { last, ..Seen::default() };
        let mut certificates = null_mut();
        let status = unsafe {
            sscc_certificates_compute(all.model, null(), progress, cancel, seen.user(), &mut certificates)
        };
        assert_eq!(status == sscc_status::Ok, !certificates.is_null());
        done(unsafe { sscc_certificates_free(certificates) });
        (status, seen.count())
    };
    let (status, reports) = compute(Some(progress), None, 0);
    assert!(status == sscc_status::Ok && reports > 0);
    let (status, questions) = compute(None, Some(cancel), 0);
    assert!(status == sscc_status::Ok && questions > 0);
    // After a callback has cancelled, no callback is called again, even if the work was done.
    for last in 1..=reports {
        assert_eq!(compute(Some(progress), None, last), (sscc_status::Cancelled, last));
    }
    assert_eq!(compute(None, Some(cancel), 1), (sscc_status::Cancelled, 1));
    refused(compute(Some(progress), Some(cancel), 2).0, sscc_status::Cancelled, "interrupted");
}

#[test]
fn answers_are_cancelled() {
    let strip = Strip::new();
    let (q, x) = ([0.0, 0.0, -200.0], strip.positions(-200.0));
    let (q, x) = (q.as_ptr(), matrix(&x, 3));
    let mut count = 9;
    let n = &raw mut count;
    unsafe {
        let query = made(|out| sscc_query_new(strip.model, strip.certificates, out));
        let stop = Seen { last: 1, ..Seen::default() };
        done(sscc_query_set_cancel(query, Some(cancel), stop.user()));
        refused(sscc_query_discrete(query, q, 3, n), sscc_status::Cancelled, "interrupted");
        assert_eq!((count, stop.count()), (9, 1));
        done(sscc_query_pairs(query, null_mut(), 0));
        // A copy has no callback, and neither has the query after the callback is removed.
        let copy = made(|out| sscc_query_clone(query, out));
        done(sscc_query_discrete(copy, q, 3, n));
        done(sscc_query_free(copy));
        let found = count;
        assert!(found > 20 && stop.count() == 1);
        done(sscc_query_set_cancel(query, None, null_mut()));
        done(sscc_query_discrete(query, q, 3, n));
        assert_eq!((count, stop.count()), (found, 1));
        done(sscc_query_free(query));

        let kinetic = made(|out| sscc_kinetic_new(strip.model, strip.certificates, out));
        let stop = Seen { last: 1, ..Seen::default() };
        done(sscc_kinetic_set_cancel(kinetic, Some(cancel), stop.user()));
        assert_eq!(sscc_kinetic_discrete(kinetic, q, 3, n), sscc_status::Cancelled);
        let copy = made(|out| sscc_kinetic_clone(kinetic, out));
        done(sscc_kinetic_discrete(copy, q, 3, n));
        done(sscc_kinetic_free(copy));
        done(sscc_kinetic_set_cancel(kinetic, None, null_mut()));
        done(sscc_kinetic_discrete(kinetic, q, 3, n));
        assert_eq!((count, stop.count()), (found, 1));
        done(sscc_kinetic_free(kinetic));

        let rest = strip.positions(0.0);
        let detector = made(|out| sscc_detector_new(matrix(&rest, 3), strip.faces(), null(), out));
        let stop = Seen { last: 1, ..Seen::default() };
        done(sscc_detector_set_cancel(detector, Some(cancel), stop.user()));
        assert_eq!(sscc_detector_discrete(detector, x, n), sscc_status::Cancelled);
        let copy = made(|out| sscc_detector_clone(detector, out));
        done(sscc_detector_discrete(copy, x, n));
        done(sscc_detector_free(copy));
        done(sscc_detector_set_cancel(detector, None, null_mut()));
        done(sscc_detector_discrete(detector, x, n));
        assert_eq!((count, stop.count()), (found, 1));
        done(sscc_detector_free(detector));
    }
}

/// Uses the handle of the query which calls this callback.
extern "C" fn use_again(user: *mut c_void, _pair: sscc_pair) -> c_int {
    let query = user.cast::<sscc_query>();
    let mut count = 9;
    unsafe {
        refused(sscc_query_discrete(query, &1.0, 1, &mut count), sscc_status::Busy, "in use by another call");
        refused(sscc_query_pairs(query, null_mut(), 0), sscc_status::Busy, "in use");
        refused(sscc_query_clone(query, &mut null_mut()), sscc_status::Busy, "in use");
        refused(sscc_query_free(query), sscc_status::Busy, "in use");
        // Other handles can be used.
        let detector = made(|out| sscc_detector_new(matrix(&TWO, 3), faces(&FACES), null(), out));
        done(sscc_detector_free(detector));
    }
    0
}

#[test]
fn a_callback_cannot_use_the_handle_of_its_call() {
    let all = Handles::new();
    let mut count = 0;
    unsafe {
        done(sscc_query_discrete(all.query, &1.0, 1, &mut count));
        done(sscc_query_visit_pairs(all.query, Some(use_again), all.query.cast()));
        done(sscc_query_discrete(all.query, &1.0, 1, &mut count));
    }
    assert_eq!(count, 1);
}
