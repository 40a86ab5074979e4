//! Queries at q and between two q.
#![allow(unsafe_code, reason = "functions for C")]

use std::ffi::c_void;

use sscc::Query;

use crate::answer::Answer;
use crate::callbacks::cancel_token;
use crate::certificates::sscc_certificates;
use crate::exclusive::Exclusive;
use crate::handle::{Handle, borrow, free, give};
use crate::model::sscc_model;
use crate::pointers::{optional_output, output, output_array, slice};
use crate::status::{Result, guard, sscc_status};
use crate::types::{sscc_cancel_fn, sscc_impact, sscc_pair, sscc_statistics, sscc_visit_fn};

/// A query: finds the triangles of a model that collide. Repeated answers allocate nothing.
pub struct sscc_query(Exclusive<State>);

/// A query and its last answer.
struct State {
    query: Query,
    answer: Answer,
}

impl State {
    /// Returns a copy without the token, so that the copy does not need the token's function.
    fn copy(&self) -> Self {
        Self { query: self.query.clone().cancelled_by(None), answer: self.answer.clone() }
    }
}

impl Handle for sscc_query {
    const NAME: &'static str = "query";

    fn check_idle(&self) -> Result<()> {
        self.0.check_idle()
    }
}

/// Creates a query of a model and its certificates. It shares both, which may be freed.
///
/// Errors: SSCC_STATUS_OTHER_MODEL if the certificates are of another model.
///
/// Threads: any.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_query_new(
    model: *const sscc_model,
    certificates: *const sscc_certificates,
    query: *mut *mut sscc_query,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let out = unsafe { output(query, "query") }?;
        let (model, certificates) = unsafe { (borrow(model)?, borrow(certificates)?) };
        let query = Query::new(&model.model, &certificates.0)?;
        give(sscc_query(Exclusive::new(State { query, answer: Answer::default() })), out);
        Ok(())
    })
}

/// Creates a copy for another thread, with the last answer. Copies share the data that does not change.
///
/// Threads: one call at a time for each query.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_query_clone(
    query: *const sscc_query,
    copy: *mut *mut sscc_query,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let out = unsafe { output(copy, "copy") }?;
        let state = unsafe { borrow(query) }?.0.lock()?.copy();
        give(sscc_query(Exclusive::new(state)), out);
        Ok(())
    })
}

/// Frees a query. NULL is ignored.
///
/// Errors: SSCC_STATUS_BUSY in a callback of a call with the query, which is then not freed.
///
/// Threads: one call at a time for each query.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_query_free(query: *mut sscc_query) -> sscc_status {
    // SAFETY: by the caller's guarantee.
    guard(|| unsafe { free(query) })
}

/// Sets a function that later calls check regularly, and that can end them with SSCC_STATUS_CANCELLED; NULL removes it. The function
/// and `user` must remain valid as long as the query has them. A copy has no such function. Set it once, not for each answer: the
/// call copies the state of the query. Short answers may end without a call of the function.
///
/// Threads: one call at a time for each query.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_query_set_cancel(
    query: *mut sscc_query,
    cancel: sscc_cancel_fn,
    user: *mut c_void,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee.
        let mut state = unsafe { borrow(query) }?.0.lock()?;
        state.query = state.query.clone().cancelled_by(cancel_token(cancel, user));
        Ok(())
    })
}

/// Finds all colliding pairs at q (`rank` numbers); `count` receives their number. 0 pairs prove that the shape is free.
/// sscc_query_pairs copies the pairs.
///
/// Errors: SSCC_STATUS_TOO_MANY for more than 67,108,864 pairs.
///
/// Threads: one call at a time for each query.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_query_discrete(
    query: *mut sscc_query,
    q: *const f64,
    rank: usize,
    count: *mut usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let state = &mut *unsafe { borrow(query) }?.0.lock()?;
        state.answer.forget();
        let (q, out) = unsafe { (slice(q, rank, "q")?, output(count, "count")?) };
        out.write(state.answer.set_pairs(state.query.discrete(q)?));
        Ok(())
    })
}

/// Finds at most `limit` colliding pairs at q (`rank` numbers); which ones is not fixed. If the limit ended the search,
/// `complete` of the statistics is 0.
///
/// Errors: SSCC_STATUS_TOO_MANY for more than 67,108,864 pairs, if `limit` is larger than this number.
///
/// Threads: one call at a time for each query.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_query_discrete_at_most(
    query: *mut sscc_query,
    q: *const f64,
    rank: usize,
    limit: usize,
    count: *mut usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let state = &mut *unsafe { borrow(query) }?.0.lock()?;
        state.answer.forget();
        let (q, out) = unsafe { (slice(q, rank, "q")?, output(count, "count")?) };
        out.write(state.answer.set_pairs(state.query.discrete_at_most(q, limit)?));
        Ok(())
    })
}

/// Finds one colliding pair at q (`rank` numbers), and stops there; which one is not fixed. `count` receives 0 or 1, `pair` the pair
/// if there is one; `pair` may be NULL.
///
/// Threads: one call at a time for each query.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_query_first(
    query: *mut sscc_query,
    q: *const f64,
    rank: usize,
    pair: *mut sscc_pair,
    count: *mut usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let state = &mut *unsafe { borrow(query) }?.0.lock()?;
        state.answer.forget();
        let (q, out) = unsafe { (slice(q, rank, "q")?, output(count, "count")?) };
        let pair = unsafe { optional_output(pair, "pair") }?;
        let first = state.query.first(q)?;
        if let (Some(out), Some(first)) = (pair, first) {
            out.write(first.into());
        }
        out.write(state.answer.set_first(first));
        Ok(())
    })
}

/// Finds all pairs that collide while every vertex moves on a straight line from its position at `q_t0` to that at `q_t1` (`rank`
/// numbers each, which may be the same array); `count` receives their number. sscc_query_impacts copies pairs and times.
///
/// Errors: SSCC_STATUS_TOO_MANY for more than 67,108,864 pairs.
///
/// Threads: one call at a time for each query.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_query_continuous(
    query: *mut sscc_query,
    q_t0: *const f64,
    q_t1: *const f64,
    rank: usize,
    count: *mut usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let state = &mut *unsafe { borrow(query) }?.0.lock()?;
        state.answer.forget();
        let (t0, t1) = unsafe { (slice(q_t0, rank, "q_t0")?, slice(q_t1, rank, "q_t1")?) };
        let out = unsafe { output(count, "count") }?;
        out.write(state.answer.set_impacts(state.query.continuous(t0, t1)?));
        Ok(())
    })
}

/// Computes a scale s such that the shape is proven free at `center + t (q - center)` for all t in [0, s], with q of `rank` numbers.
/// It is 0 if the shape collides at the centre, else infinite if q is the centre or the global radius, up to which radii are
/// computed, is infinite. It is at most the scale at which |z| reaches that radius. It takes longer than an answer, and allocates.
///
/// Threads: one call at a time for each query.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_query_safe_scale(
    query: *mut sscc_query,
    q: *const f64,
    rank: usize,
    scale: *mut f64,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let state = &mut *unsafe { borrow(query) }?.0.lock()?;
        state.answer.forget();
        let (q, out) = unsafe { (slice(q, rank, "q")?, output(scale, "scale")?) };
        out.write(state.query.safe_scale(q)?);
        Ok(())
    })
}

/// Copies the pairs of the last answer, sorted. `capacity` is the number of pairs that fit into the array.
///
/// Errors: SSCC_STATUS_CAPACITY if the answer has more pairs. Then nothing is copied.
///
/// Threads: one call at a time for each query.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_query_pairs(
    query: *const sscc_query,
    pairs: *mut sscc_pair,
    capacity: usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let state = unsafe { borrow(query) }?.0.lock()?;
        state.answer.copy_pairs(&unsafe { output_array(pairs, capacity, "pairs") }?)
    })
}

/// Copies the impacts of the last answer, sorted by pair; a discrete answer has none. `capacity` is the number of impacts that fit
/// into the array.
///
/// Errors: SSCC_STATUS_CAPACITY if the answer has more impacts. Then nothing is copied.
///
/// Threads: one call at a time for each query.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_query_impacts(
    query: *const sscc_query,
    impacts: *mut sscc_impact,
    capacity: usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let state = unsafe { borrow(query) }?.0.lock()?;
        state.answer.copy_impacts(&unsafe { output_array(impacts, capacity, "impacts") }?)
    })
}

/// Calls `visit` with each pair of the last answer, in order. If it returns another value than 0, the visit ends with
/// SSCC_STATUS_CANCELLED. During the visit other calls with this query are refused with SSCC_STATUS_BUSY.
///
/// Threads: one call at a time for each query.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_query_visit_pairs(
    query: *const sscc_query,
    visit: sscc_visit_fn,
    user: *mut c_void,
) -> sscc_status {
    // SAFETY: by the caller's guarantee.
    guard(|| unsafe { borrow(query) }?.0.lock()?.answer.visit(visit, user))
}

/// Returns the cost of the last answer, and the kind of its proof, in `statistics`.
///
/// Threads: one call at a time for each query.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_query_statistics(
    query: *const sscc_query,
    statistics: *mut sscc_statistics,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let out = unsafe { output(statistics, "statistics") }?;
        out.write(unsafe { borrow(query) }?.0.lock()?.query.statistics().into());
        Ok(())
    })
}
