//! Kinetic queries, for motions in small steps.
#![allow(unsafe_code, reason = "functions for C")]

use std::ffi::c_void;

use sscc::KineticQuery;

use crate::answer::Answer;
use crate::callbacks::cancel_token;
use crate::certificates::sscc_certificates;
use crate::exclusive::Exclusive;
use crate::handle::{Handle, borrow, free, give};
use crate::model::sscc_model;
use crate::pointers::{output, output_array, slice};
use crate::status::{Result, guard, sscc_status};
use crate::types::{sscc_cancel_fn, sscc_impact, sscc_pair, sscc_statistics, sscc_visit_fn};

/// A kinetic query: it gives the answers of a query, and reuses its work while q moves in small steps. After a warm-up,
/// answers allocate nothing.
pub struct sscc_kinetic(Exclusive<State>);

/// A kinetic query and its last answer.
struct State {
    kinetic: KineticQuery,
    answer: Answer,
}

impl State {
    /// Returns a copy without the token, so that the copy does not need the token's function.
    fn copy(&self) -> Self {
        Self { kinetic: self.kinetic.clone().cancelled_by(None), answer: self.answer.clone() }
    }
}

impl Handle for sscc_kinetic {
    const NAME: &'static str = "kinetic";

    fn check_idle(&self) -> Result<()> {
        self.0.check_idle()
    }
}

/// Creates a kinetic query of a model and its certificates. It shares both, which may be freed.
///
/// Errors: SSCC_STATUS_OTHER_MODEL if the certificates are of another model.
///
/// Threads: any.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_kinetic_new(
    model: *const sscc_model,
    certificates: *const sscc_certificates,
    kinetic: *mut *mut sscc_kinetic,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let out = unsafe { output(kinetic, "kinetic") }?;
        let (model, certificates) = unsafe { (borrow(model)?, borrow(certificates)?) };
        let kinetic = KineticQuery::new(&model.model, &certificates.0)?;
        give(sscc_kinetic(Exclusive::new(State { kinetic, answer: Answer::default() })), out);
        Ok(())
    })
}

/// Creates a copy for another thread, with the last answer. Copies share the data that does not change.
///
/// Threads: one call at a time for each kinetic query.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_kinetic_clone(
    kinetic: *const sscc_kinetic,
    copy: *mut *mut sscc_kinetic,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let out = unsafe { output(copy, "copy") }?;
        let state = unsafe { borrow(kinetic) }?.0.lock()?.copy();
        give(sscc_kinetic(Exclusive::new(state)), out);
        Ok(())
    })
}

/// Frees a kinetic query. NULL is ignored.
///
/// Errors: SSCC_STATUS_BUSY in a callback of a call with the kinetic query, which is then not freed.
///
/// Threads: one call at a time for each kinetic query.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_kinetic_free(kinetic: *mut sscc_kinetic) -> sscc_status {
    // SAFETY: by the caller's guarantee.
    guard(|| unsafe { free(kinetic) })
}

/// Sets a function that later calls check regularly, and that can end them with SSCC_STATUS_CANCELLED; NULL removes it. The function
/// and `user` must remain valid as long as the query has them. A copy has no such function. Set it once, not for each answer: the
/// call copies the state of the query. Short answers may end without a call of the function.
///
/// Threads: one call at a time for each kinetic query.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_kinetic_set_cancel(
    kinetic: *mut sscc_kinetic,
    cancel: sscc_cancel_fn,
    user: *mut c_void,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee.
        let mut state = unsafe { borrow(kinetic) }?.0.lock()?;
        state.kinetic = state.kinetic.clone().cancelled_by(cancel_token(cancel, user));
        Ok(())
    })
}

/// Finds all colliding pairs at q (`rank` numbers); `count` receives their number. 0 pairs prove that the shape is free.
/// sscc_kinetic_pairs copies the pairs.
///
/// Errors: SSCC_STATUS_TOO_MANY for more than 67,108,864 pairs.
///
/// Threads: one call at a time for each kinetic query.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_kinetic_discrete(
    kinetic: *mut sscc_kinetic,
    q: *const f64,
    rank: usize,
    count: *mut usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let state = &mut *unsafe { borrow(kinetic) }?.0.lock()?;
        state.answer.forget();
        let (q, out) = unsafe { (slice(q, rank, "q")?, output(count, "count")?) };
        out.write(state.answer.set_pairs(state.kinetic.discrete(q)?));
        Ok(())
    })
}

/// Finds all pairs that collide while every vertex moves on a straight line from its position at `q_t0` to that at `q_t1` (`rank`
/// numbers each, which may be the same array); `count` receives their number. sscc_kinetic_impacts copies pairs and times.
///
/// Errors: SSCC_STATUS_TOO_MANY for more than 67,108,864 pairs.
///
/// Threads: one call at a time for each kinetic query.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_kinetic_continuous(
    kinetic: *mut sscc_kinetic,
    q_t0: *const f64,
    q_t1: *const f64,
    rank: usize,
    count: *mut usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let state = &mut *unsafe { borrow(kinetic) }?.0.lock()?;
        state.answer.forget();
        let (t0, t1) = unsafe { (slice(q_t0, rank, "q_t0")?, slice(q_t1, rank, "q_t1")?) };
        let out = unsafe { output(count, "count") }?;
        out.write(state.answer.set_impacts(state.kinetic.continuous(t0, t1)?));
        Ok(())
    })
}

/// Copies the pairs of the last answer, sorted. `capacity` is the number of pairs that fit into the array.
///
/// Errors: SSCC_STATUS_CAPACITY if the answer has more pairs. Then nothing is copied.
///
/// Threads: one call at a time for each kinetic query.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_kinetic_pairs(
    kinetic: *const sscc_kinetic,
    pairs: *mut sscc_pair,
    capacity: usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let state = unsafe { borrow(kinetic) }?.0.lock()?;
        state.answer.copy_pairs(&unsafe { output_array(pairs, capacity, "pairs") }?)
    })
}

/// Copies the impacts of the last answer, sorted by pair; a discrete answer has none. `capacity` is the number of impacts that fit
/// into the array.
///
/// Errors: SSCC_STATUS_CAPACITY if the answer has more impacts. Then nothing is copied.
///
/// Threads: one call at a time for each kinetic query.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_kinetic_impacts(
    kinetic: *const sscc_kinetic,
    impacts: *mut sscc_impact,
    capacity: usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let state = unsafe { borrow(kinetic) }?.0.lock()?;
        state.answer.copy_impacts(&unsafe { output_array(impacts, capacity, "impacts") }?)
    })
}

/// Calls `visit` with each pair of the last answer, in order. If it returns another value than 0, the visit ends with
/// SSCC_STATUS_CANCELLED. During the visit other calls with this query are refused with SSCC_STATUS_BUSY.
///
/// Threads: one call at a time for each kinetic query.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_kinetic_visit_pairs(
    kinetic: *const sscc_kinetic,
    visit: sscc_visit_fn,
    user: *mut c_void,
) -> sscc_status {
    // SAFETY: by the caller's guarantee.
    guard(|| unsafe { borrow(kinetic) }?.0.lock()?.answer.visit(visit, user))
}

/// Returns the cost of the last answer, and the kind of its proof, in `statistics`.
///
/// Threads: one call at a time for each kinetic query.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_kinetic_statistics(
    kinetic: *const sscc_kinetic,
    statistics: *mut sscc_statistics,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let out = unsafe { output(statistics, "statistics") }?;
        out.write(unsafe { borrow(kinetic) }?.0.lock()?.kinetic.statistics().into());
        Ok(())
    })
}
