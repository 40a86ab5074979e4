//! Detectors: collisions of a mesh at given positions.
#![allow(unsafe_code, reason = "functions for C")]

use std::ffi::c_void;

use sscc::Detector;
use sscc::glam::DVec3;

use crate::answer::Answer;
use crate::callbacks::cancel_token;
use crate::exclusive::Exclusive;
use crate::handle::{Handle, borrow, free, give};
use crate::matrix::{Matrix, sscc_index_matrix, sscc_matrix};
use crate::model;
use crate::options::{contact_filter, sscc_filter};
use crate::pointers::{optional_output, output, output_array};
use crate::status::{Failure, Result, guard, sscc_status};
use crate::types::{sscc_cancel_fn, sscc_impact, sscc_pair, sscc_statistics, sscc_visit_fn};

/// A detector: finds the triangles of a mesh that collide at given positions. Repeated answers allocate nothing.
pub struct sscc_detector(Exclusive<State>);

/// A detector, its last answer, and copies of positions that have gaps in memory.
struct State {
    detector: Detector,
    answer: Answer,
    buffers: [Vec<DVec3>; 4],
}

impl State {
    /// Returns a copy without the token, so that the copy does not need the token's function.
    fn copy(&self) -> Self {
        Self {
            detector: self.detector.clone().cancelled_by(None),
            answer: self.answer.clone(),
            buffers: Default::default(),
        }
    }
}

impl Handle for sscc_detector {
    const NAME: &'static str = "detector";

    fn check_idle(&self) -> Result<()> {
        self.0.check_idle()
    }
}

/// Creates a detector of a mesh (rest positions V x 3, faces F x 3). `filter` is NULL for the default: pairs with a
/// common vertex do not count. The arrays are copied. Rest positions determine the hierarchy and, with SSCC_WELD_ON,
/// which vertices are welded.
///
/// Threads: any.
///
/// # Safety
/// As the header states for arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_detector_new(
    positions: sscc_matrix,
    faces: sscc_index_matrix,
    filter: *const sscc_filter,
    detector: *mut *mut sscc_detector,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let out = unsafe { output(detector, "detector") }?;
        let mesh = unsafe { model::mesh(&positions, &faces) }?;
        let detector = Detector::with_filter(&mesh, &unsafe { contact_filter(filter, &mesh) }?)?;
        let state = State { detector, answer: Answer::default(), buffers: Default::default() };
        give(sscc_detector(Exclusive::new(state)), out);
        Ok(())
    })
}

/// Creates a copy for another thread, with the last answer. Copies share the data that does not change.
///
/// Threads: one call at a time for each detector.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_detector_clone(
    detector: *const sscc_detector,
    copy: *mut *mut sscc_detector,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let out = unsafe { output(copy, "copy") }?;
        let state = unsafe { borrow(detector) }?.0.lock()?.copy();
        give(sscc_detector(Exclusive::new(state)), out);
        Ok(())
    })
}

/// Frees a detector. NULL is ignored.
///
/// Errors: SSCC_STATUS_BUSY in a callback of a call with the detector, which is then not freed.
///
/// Threads: one call at a time for each detector.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_detector_free(detector: *mut sscc_detector) -> sscc_status {
    // SAFETY: by the caller's guarantee.
    guard(|| unsafe { free(detector) })
}

/// Sets a function that later calls check regularly, and that can end them with SSCC_STATUS_CANCELLED; NULL removes it. The function
/// and `user` must remain valid as long as the detector has them. A copy has no such function. Set it once, not for each answer: the
/// call copies the state of the detector. Short answers may end without a call of the function. Calls with two detectors check the
/// function of the first one only.
///
/// Threads: one call at a time for each detector.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_detector_set_cancel(
    detector: *mut sscc_detector,
    cancel: sscc_cancel_fn,
    user: *mut c_void,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee.
        let mut state = unsafe { borrow(detector) }?.0.lock()?;
        state.detector = state.detector.clone().cancelled_by(cancel_token(cancel, user));
        Ok(())
    })
}

/// Finds all colliding pairs at these positions (V x 3); `count` receives their number. 0 pairs prove that the mesh is free.
/// sscc_detector_pairs copies the pairs.
///
/// Errors: SSCC_STATUS_TOO_MANY for more than 67,108,864 pairs.
///
/// Threads: one call at a time for each detector.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_detector_discrete(
    detector: *mut sscc_detector,
    positions: sscc_matrix,
    count: *mut usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let State { detector, answer, buffers } = &mut *unsafe { borrow(detector) }?.0.lock()?;
        answer.forget();
        let out = unsafe { output(count, "count") }?;
        let x = unsafe { Matrix::positions(&positions, "positions") }?;
        out.write(answer.set_pairs(detector.discrete(x.vectors(&mut buffers[0]))?));
        Ok(())
    })
}

/// Finds at most `limit` colliding pairs at these positions (V x 3), for any limit; which ones is not fixed. If the limit ended the
/// search, `complete` of the statistics is 0.
///
/// Threads: one call at a time for each detector.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_detector_discrete_at_most(
    detector: *mut sscc_detector,
    positions: sscc_matrix,
    limit: usize,
    count: *mut usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let State { detector, answer, buffers } = &mut *unsafe { borrow(detector) }?.0.lock()?;
        answer.forget();
        let out = unsafe { output(count, "count") }?;
        let x = unsafe { Matrix::positions(&positions, "positions") }?;
        out.write(answer.set_pairs(detector.discrete_at_most(x.vectors(&mut buffers[0]), limit)?));
        Ok(())
    })
}

/// Finds one colliding pair at these positions (V x 3), and stops there; which one is not fixed. `count` receives 0 or 1, `pair` the
/// pair if there is one; `pair` may be NULL.
///
/// Threads: one call at a time for each detector.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_detector_first(
    detector: *mut sscc_detector,
    positions: sscc_matrix,
    pair: *mut sscc_pair,
    count: *mut usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let State { detector, answer, buffers } = &mut *unsafe { borrow(detector) }?.0.lock()?;
        answer.forget();
        let (pair, out) = unsafe { (optional_output(pair, "pair")?, output(count, "count")?) };
        let x = unsafe { Matrix::positions(&positions, "positions") }?;
        let first = detector.first(x.vectors(&mut buffers[0]))?;
        if let (Some(out), Some(first)) = (pair, first) {
            out.write(first.into());
        }
        out.write(answer.set_first(first));
        Ok(())
    })
}

/// Finds all pairs that collide while every vertex moves on a straight line from its position in `x_t0` to that in `x_t1` (V x 3
/// each); `count` receives their number. sscc_detector_impacts copies pairs and times.
///
/// Errors: SSCC_STATUS_ARGUMENT for a filter with SSCC_NEIGHBOURS_INCLUDE_FOLDED; SSCC_STATUS_TOO_MANY for more than 67,108,864
/// pairs.
///
/// Threads: one call at a time for each detector.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_detector_continuous(
    detector: *mut sscc_detector,
    x_t0: sscc_matrix,
    x_t1: sscc_matrix,
    count: *mut usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let State { detector, answer, buffers: [b0, b1, ..] } =
            &mut *unsafe { borrow(detector) }?.0.lock()?;
        answer.forget();
        let out = unsafe { output(count, "count") }?;
        let x_t0 = unsafe { Matrix::positions(&x_t0, "x_t0") }?;
        let x_t1 = unsafe { Matrix::positions(&x_t1, "x_t1") }?;
        out.write(answer.set_impacts(detector.continuous(x_t0.vectors(b0), x_t1.vectors(b1))?));
        Ok(())
    })
}

/// Finds all pairs (triangle of this mesh at `x`, triangle of the other one at `y`) that collide; `count` receives
/// their number. All such pairs count: the filters of the detectors have no effect. `detector` stores the answer.
/// `other` must be a different detector; for a mesh with itself, use a copy.
///
/// Errors: SSCC_STATUS_OVERLAP for the same detector twice; SSCC_STATUS_TOO_MANY for more than 67,108,864 pairs.
///
/// Threads: one call at a time for each of both detectors.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_detector_against(
    detector: *mut sscc_detector,
    x: sscc_matrix,
    other: *mut sscc_detector,
    y: sscc_matrix,
    count: *mut usize,
) -> sscc_status {
    guard(|| {
        let is_same = detector == other;
        // SAFETY: by the caller's guarantee, here and below.
        let State { detector, answer, buffers: [bx, by, ..] } =
            &mut *unsafe { borrow(detector) }?.0.lock()?;
        answer.forget();
        check_distinct(is_same)?;
        let other = &mut unsafe { borrow(other) }?.0.lock()?.detector;
        let out = unsafe { output(count, "count") }?;
        let (x, y) = unsafe { (Matrix::positions(&x, "x")?, Matrix::positions(&y, "y")?) };
        out.write(answer.set_pairs(detector.against(x.vectors(bx), other, y.vectors(by))?));
        Ok(())
    })
}

/// Finds all pairs (triangle of this mesh, triangle of the other one) that collide while every vertex of both moves on a straight
/// line; otherwise as sscc_detector_against. sscc_detector_impacts copies pairs and times.
///
/// Errors: as sscc_detector_against.
///
/// Threads: one call at a time for each of both detectors.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_detector_continuous_against(
    detector: *mut sscc_detector,
    x_t0: sscc_matrix,
    x_t1: sscc_matrix,
    other: *mut sscc_detector,
    y_t0: sscc_matrix,
    y_t1: sscc_matrix,
    count: *mut usize,
) -> sscc_status {
    guard(|| {
        let is_same = detector == other;
        // SAFETY: by the caller's guarantee, here and below.
        let State { detector, answer, buffers } = &mut *unsafe { borrow(detector) }?.0.lock()?;
        answer.forget();
        check_distinct(is_same)?;
        let other = &mut unsafe { borrow(other) }?.0.lock()?.detector;
        let out = unsafe { output(count, "count") }?;
        let (x0, x1) = unsafe { (Matrix::positions(&x_t0, "x_t0")?, Matrix::positions(&x_t1, "x_t1")?) };
        let (y0, y1) = unsafe { (Matrix::positions(&y_t0, "y_t0")?, Matrix::positions(&y_t1, "y_t1")?) };
        let [b0, b1, b2, b3] = buffers;
        let (x, y) = ([x0.vectors(b0), x1.vectors(b1)], [y0.vectors(b2), y1.vectors(b3)]);
        out.write(answer.set_impacts(detector.continuous_against(x, other, y)?));
        Ok(())
    })
}

fn check_distinct(is_same: bool) -> Result<()> {
    if is_same {
        let message = "detector and other are the same: use a copy";
        return Err(Failure::new(sscc_status::Overlap, message));
    }
    Ok(())
}

/// Copies the pairs of the last answer, sorted. `capacity` is the number of pairs that fit into the array.
///
/// Errors: SSCC_STATUS_CAPACITY if the answer has more pairs. Then nothing is copied.
///
/// Threads: one call at a time for each detector.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_detector_pairs(
    detector: *const sscc_detector,
    pairs: *mut sscc_pair,
    capacity: usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let state = unsafe { borrow(detector) }?.0.lock()?;
        state.answer.copy_pairs(&unsafe { output_array(pairs, capacity, "pairs") }?)
    })
}

/// Copies the impacts of the last answer, sorted by pair; a discrete answer has none. `capacity` is the number of impacts that fit
/// into the array.
///
/// Errors: SSCC_STATUS_CAPACITY if the answer has more impacts. Then nothing is copied.
///
/// Threads: one call at a time for each detector.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_detector_impacts(
    detector: *const sscc_detector,
    impacts: *mut sscc_impact,
    capacity: usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let state = unsafe { borrow(detector) }?.0.lock()?;
        state.answer.copy_impacts(&unsafe { output_array(impacts, capacity, "impacts") }?)
    })
}

/// Calls `visit` with each pair of the last answer, in order. If it returns another value than 0, the visit ends with
/// SSCC_STATUS_CANCELLED. During the visit other calls with this detector are refused with SSCC_STATUS_BUSY.
///
/// Threads: one call at a time for each detector.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_detector_visit_pairs(
    detector: *const sscc_detector,
    visit: sscc_visit_fn,
    user: *mut c_void,
) -> sscc_status {
    // SAFETY: by the caller's guarantee.
    guard(|| unsafe { borrow(detector) }?.0.lock()?.answer.visit(visit, user))
}

/// Returns the cost of the last answer, and the kind of its proof, in `statistics`.
///
/// Threads: one call at a time for each detector.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_detector_statistics(
    detector: *const sscc_detector,
    statistics: *mut sscc_statistics,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let out = unsafe { output(statistics, "statistics") }?;
        out.write(unsafe { borrow(detector) }?.0.lock()?.detector.statistics().into());
        Ok(())
    })
}
