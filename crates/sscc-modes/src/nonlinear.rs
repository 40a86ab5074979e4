//! Basis of linear modes and modal derivatives for large deformations (Barbic and James 2005).
//!
//! Linear modes alone do not represent large bends; modal derivatives add the terms of second order. They solve `K d_ij
//! = -(H : x_i) x_j`, where H is the second derivative of the forces. Modes are scaled by their amplitude `q_i = a
//! lambda_1 / lambda_i`, derivatives by `q_i q_j`. The basis consists of the directions of the largest mass. The
//! amplitude a, which the original method does not have, makes the basis independent of units: with it, the first mode
//! moves some vertex by a fifth of the body's diagonal.

use faer::Mat;
use sscc::Progress;

use crate::ModesError;
use crate::body::{Body, m_orthonormal};
use crate::cancel::check_cancelled;
use crate::eigen::LowestModes;
use crate::eigen::tall_matrix::{inner, product};
use crate::elasticity::second_derivatives;

/// Linear modes per mode of the basis: 20 for r = 30, as in the paper's models.
const LINEAR_SHARE: f64 = 2.0 / 3.0;

/// Maximum displacement by the first mode, relative to the body's diagonal.
const AMPLITUDE: f64 = 0.2;

/// Right-hand sides solved at once.
const BATCH: usize = 32;

/// Maximum residual of a derivative, relative to its right-hand side. Derivatives are only directions for the basis: the
/// omitted principal components are much larger.
const RESIDUAL_TOLERANCE: f64 = 1e-4;

/// Maximum number of refinements. One is usual, because each gains a factor of at least 1,000.
const MAX_REFINEMENTS: usize = 30;

/// Computes M-orthonormal columns that span the basis (on free vertices).
pub(crate) fn basis(body: &Body, rank: usize, progress: &dyn Progress) -> Result<Mat<f64>, ModesError> {
    let available = 3 * body.stiffness.rows() - body.rigid.ncols();
    if rank > available {
        return Err(ModesError::TooManyModes { requested: rank, available });
    }
    let linear = linear_count(rank).min(available);
    let lowest = body.lowest(linear, progress)?;
    let derivatives = derivatives(body, &lowest, progress)?;

    let first = body.on_all(lowest.vectors.col_as_slice(0));
    let farthest = first.iter().map(|u| u.length()).fold(0.0, f64::max);
    let amplitude = AMPLITUDE * body.diagonal() / farthest;
    let amplitudes: Vec<f64> =
        lowest.eigenvalues.iter().map(|x| amplitude * lowest.eigenvalues[0] / x).collect();
    let mut all = Mat::zeros(lowest.vectors.nrows(), linear + derivatives.ncols());
    let mut scaled = |to: usize, scale: f64, from: &[f64]| {
        all.col_as_slice_mut(to).iter_mut().zip(from).for_each(|(to, from)| *to = scale * from);
    };
    for (i, q) in amplitudes.iter().enumerate() {
        scaled(i, *q, lowest.vectors.col_as_slice(i));
    }
    let pairs = (0..linear).flat_map(|i| (i..linear).map(move |j| (i, j)));
    for (k, (i, j)) in pairs.enumerate() {
        // The term of second order is q_i q_j d_ij for i < j, and half of it for i = j.
        let share = if i == j { 0.5 } else { 1.0 };
        scaled(linear + k, share * amplitudes[i] * amplitudes[j], derivatives.col_as_slice(k));
    }
    drop(derivatives);
    principal(body, all, rank)
}

/// Returns the number of linear modes; with their derivatives they give at least `rank` directions.
fn linear_count(rank: usize) -> usize {
    ((rank as f64 * LINEAR_SHARE).round() as usize).max(2).min(rank.max(1))
}

/// Computes the modal derivatives of all pairs i <= j, M-orthogonal to rigid motions.
fn derivatives(body: &Body, lowest: &LowestModes, progress: &dyn Progress) -> Result<Mat<f64>, ModesError> {
    let count = lowest.eigenvalues.len();
    let fields: Vec<_> = (0..count).map(|k| body.on_all(lowest.vectors.col_as_slice(k))).collect();
    let pairs: Vec<(usize, usize)> = (0..count).flat_map(|i| (i..count).map(move |j| (i, j))).collect();
    let mut all = Mat::zeros(lowest.vectors.nrows(), pairs.len());
    for (batch, some) in pairs.chunks(BATCH).enumerate() {
        check_cancelled(progress)?;
        let mut right = Mat::zeros(all.nrows(), some.len());
        for (k, force) in second_derivatives(body.solid, &fields, some).iter().enumerate() {
            let force = body.on_free(force);
            right.col_as_slice_mut(k).iter_mut().zip(force).for_each(|(to, f)| *to = -f);
        }
        let solved = solve(body, lowest, right)?;
        all.as_mut().subcols_mut(batch * BATCH, some.len()).copy_from(&solved);
        progress.report(batch * BATCH + some.len(), pairs.len());
    }
    Ok(all)
}

/// Solves `K x = f` without rigid motions, with the factor of `K + s M`: directly in the lowest modes, and by refinement
/// in the rest, where each step gains a factor of `s / (lambda + s)`.
fn solve(body: &Body, lowest: &LowestModes, mut right: Mat<f64>) -> Result<Mat<f64>, ModesError> {
    // Rigid motions have no elastic force, so their part is removed: f - M R R'f.
    if body.rigid.ncols() > 0 {
        let along = inner(body.rigid.as_ref(), right.as_ref());
        let carried = product(body.rigid.as_ref(), along.as_ref());
        right -= body.mass.multiply(carried.as_ref());
    }
    let norm = |x: &Mat<f64>, k: usize| x.col(k).norm_l2();
    let mut x = Mat::zeros(right.nrows(), right.ncols());
    let mut residual = right.clone();
    let mut worst = f64::INFINITY;
    for _ in 0..MAX_REFINEMENTS {
        let mut coefficients = inner(lowest.vectors.as_ref(), residual.as_ref());
        for k in 0..coefficients.ncols() {
            for (c, lambda) in coefficients.col_as_slice_mut(k).iter_mut().zip(&lowest.eigenvalues) {
                *c /= lambda;
            }
        }
        let low = product(lowest.vectors.as_ref(), coefficients.as_ref());
        let mut high = &residual - body.stiffness.multiply(low.as_ref());
        lowest.factor.solve(&mut high)?;
        x += low + high;
        body.without_rigid(&mut x);
        residual = &right - body.stiffness.multiply(x.as_ref());
        if (0..right.ncols()).all(|k| norm(&residual, k) <= RESIDUAL_TOLERANCE * norm(&right, k)) {
            return Ok(x);
        }
        worst = (0..right.ncols()).map(|k| norm(&residual, k) / norm(&right, k)).fold(0.0, f64::max);
    }
    Err(ModesError::Derivatives { residual: worst })
}

/// Returns the `rank` directions of the largest mass in the span of the columns.
fn principal(body: &Body, all: Mat<f64>, rank: usize) -> Result<Mat<f64>, ModesError> {
    let basis = m_orthonormal(&body.mass, all, 1e-15, rank)?;
    match basis.ncols() {
        found if found < rank => Err(ModesError::TooManyModes { requested: rank, available: found }),
        _ => Ok(basis),
    }
}
