//! Shapes in the world, and collisions between two of them.
#![allow(unsafe_code, reason = "functions for C")]

use std::ffi::c_void;

use sscc::Pair;
use sscc::glam::{DMat3, DVec3};
use sscc::parts::{Aabb, Pose, PosedShape};

use crate::answer::Answer;
use crate::certificates::sscc_certificates;
use crate::exclusive::Exclusive;
use crate::handle::{Handle, borrow, free, give};
use crate::model::sscc_model;
use crate::pointers::{optional, optional_output, output, output_array, slice};
use crate::status::{Failure, Result, guard, sscc_status};
use crate::types::{sscc_box, sscc_pair, sscc_pose, sscc_visit_fn};

/// A model at some q and pose in the world, to be tested against others. Repeated answers allocate nothing.
pub struct sscc_shape(Exclusive<State>);

/// A shape, the pairs of a search, and its last answer.
#[derive(Clone)]
struct State {
    shape: PosedShape,
    found: Vec<Pair>,
    answer: Answer,
}

impl Handle for sscc_shape {
    const NAME: &'static str = "shape";

    fn check_idle(&self) -> Result<()> {
        self.0.check_idle()
    }
}

/// Creates a shape at q = 0 in its own axes. `certificates` may be NULL; only their hierarchy is used. The shape shares
/// both, which may be freed.
///
/// Errors: SSCC_STATUS_OTHER_MODEL if the certificates are of another model.
///
/// Threads: any.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_shape_new(
    model: *const sscc_model,
    certificates: *const sscc_certificates,
    shape: *mut *mut sscc_shape,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let out = unsafe { output(shape, "shape") }?;
        let model = &unsafe { borrow(model) }?.model;
        let shape = if certificates.is_null() {
            PosedShape::without_certificates(model)?
        } else {
            PosedShape::new(model, &unsafe { borrow(certificates) }?.0)?
        };
        give(sscc_shape(Exclusive::new(State { shape, found: Vec::new(), answer: Answer::default() })), out);
        Ok(())
    })
}

/// Creates a copy for another thread, with the last answer. Copies share the data that does not change.
///
/// Threads: one call at a time for each shape.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_shape_clone(
    shape: *const sscc_shape,
    copy: *mut *mut sscc_shape,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let out = unsafe { output(copy, "copy") }?;
        let state = unsafe { borrow(shape) }?.0.lock()?.clone();
        give(sscc_shape(Exclusive::new(state)), out);
        Ok(())
    })
}

/// Frees a shape. NULL is ignored.
///
/// Errors: SSCC_STATUS_BUSY in a callback of a call with the shape, which is then not freed.
///
/// Threads: one call at a time for each shape.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_shape_free(shape: *mut sscc_shape) -> sscc_status {
    // SAFETY: by the caller's guarantee.
    guard(|| unsafe { free(shape) })
}

/// Deforms the shape by q (`rank` numbers) and moves it by a pose; without a pose (NULL) it is not moved. `bounds` receives a box
/// that contains the shape; it may be NULL.
///
/// Threads: one call at a time for each shape.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_shape_place(
    shape: *mut sscc_shape,
    q: *const f64,
    rank: usize,
    pose: *const sscc_pose,
    bounds: *mut sscc_box,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let state = &mut *unsafe { borrow(shape) }?.0.lock()?;
        state.answer.forget();
        let (q, pose) = unsafe { (slice(q, rank, "q")?, optional(pose, "pose")?) };
        let out = unsafe { optional_output(bounds, "bounds") }?;
        let Aabb { lower, upper } = state.shape.place(q, &pose.map(rust_pose).unwrap_or_default())?;
        if let Some(out) = out {
            out.write(sscc_box { lower: lower.to_array(), upper: upper.to_array() });
        }
        Ok(())
    })
}

fn rust_pose(pose: sscc_pose) -> Pose {
    let rotation = DMat3::from_cols_array(&pose.rotation).transpose();
    Pose { rotation, translation: DVec3::from_array(pose.translation) }
}

/// Finds all pairs (triangle of this shape, triangle of the other one) that collide; `count` receives their number.
/// `shape` stores the answer. `bounds` is a finite AABB that contains all compared shapes, or NULL; it affects only the
/// time. `other` must be a different shape.
///
/// Errors: SSCC_STATUS_OVERLAP for the same shape twice; SSCC_STATUS_ARGUMENT if `bounds` is not finite; SSCC_STATUS_TOO_MANY for
/// more than 67,108,864 pairs.
///
/// Threads: one call at a time for each of both shapes.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_shape_against(
    shape: *mut sscc_shape,
    other: *mut sscc_shape,
    bounds: *const sscc_box,
    count: *mut usize,
) -> sscc_status {
    guard(|| {
        let is_same = shape == other;
        // SAFETY: by the caller's guarantee, here and below.
        let State { shape, found, answer } = &mut *unsafe { borrow(shape) }?.0.lock()?;
        answer.forget();
        if is_same {
            let message = "shape and other are the same: use a copy";
            return Err(Failure::new(sscc_status::Overlap, message));
        }
        let other = &mut unsafe { borrow(other) }?.0.lock()?.shape;
        let (bounds, out) = unsafe { (optional(bounds, "bounds")?, output(count, "count")?) };
        let bounds = bounds.map_or(Ok(Aabb::EMPTY), rust_box)?;
        found.clear();
        shape.colliding(other, bounds, found)?;
        out.write(answer.set_pairs(found));
        Ok(())
    })
}

fn rust_box(bounds: sscc_box) -> Result<Aabb> {
    let [lower, upper] = [bounds.lower, bounds.upper].map(DVec3::from_array);
    if lower.is_finite() && upper.is_finite() {
        return Ok(Aabb { lower, upper });
    }
    Err(Failure::argument("bounds are not finite"))
}

/// Copies the pairs of the last answer, sorted. `capacity` is the number of pairs that fit into the array.
///
/// Errors: SSCC_STATUS_CAPACITY if the answer has more pairs. Then nothing is copied.
///
/// Threads: one call at a time for each shape.
///
/// # Safety
/// As the header states for handles and arrays.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_shape_pairs(
    shape: *const sscc_shape,
    pairs: *mut sscc_pair,
    capacity: usize,
) -> sscc_status {
    guard(|| {
        // SAFETY: by the caller's guarantee, here and below.
        let state = unsafe { borrow(shape) }?.0.lock()?;
        state.answer.copy_pairs(&unsafe { output_array(pairs, capacity, "pairs") }?)
    })
}

/// Calls `visit` with each pair of the last answer, in order. If it returns another value than 0, the visit ends with
/// SSCC_STATUS_CANCELLED. During the visit other calls with this shape are refused with SSCC_STATUS_BUSY.
///
/// Threads: one call at a time for each shape.
///
/// # Safety
/// As the header states for handles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sscc_shape_visit_pairs(
    shape: *const sscc_shape,
    visit: sscc_visit_fn,
    user: *mut c_void,
) -> sscc_status {
    // SAFETY: by the caller's guarantee.
    guard(|| unsafe { borrow(shape) }?.0.lock()?.answer.visit(visit, user))
}
