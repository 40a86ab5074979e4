//! Block Lanczos with thick restarts.

use faer::{Mat, MatRef};
use sscc::Progress;

use super::basis::Basis;
use super::dense::symmetric_eigen;
use super::space::Space;
use super::tall_matrix::{Random, inner};
use crate::ModesError;
use crate::cancel::check_cancelled;
use crate::sparse::Cholesky;

/// Number of columns of a block. A block finds all copies of an eigenvalue of at most this multiplicity; cubes have
/// threefold ones. A wide block also reads the factor less often.
pub(super) const BLOCK: usize = 16;

/// Maximum residual of a converged Ritz value, relative to the value. The eigenvalue's own error is about the square.
const RESIDUAL_TOLERANCE: f64 = 1e-10;

/// Maximum number of steps per block of wanted values. About 6 are usual.
const MAX_STEPS_PER_BLOCK: usize = 60;

/// The operator `(K + s M)^-1 M` without rigid motions; its eigenvalues are `1 / (lambda + s)`.
pub(super) struct ShiftInvert<'a> {
    pub space: &'a Space<'a>,
    pub factor: &'a Cholesky,
    /// An eigenvalue of at least this bound ends the search, because the body is a mechanism. The operator would
    /// amplify rounding in its direction, and the others would not converge.
    pub ceiling: f64,
}

/// Eigenvalues, descending, with M-orthonormal vectors.
pub(super) struct RitzPairs {
    pub values: Vec<f64>,
    pub vectors: Mat<f64>,
}

impl ShiftInvert<'_> {
    /// Returns the operator applied to columns x, given `M x`.
    pub fn apply(&self, mut m_x: Mat<f64>) -> Result<Mat<f64>, ModesError> {
        self.factor.solve(&mut m_x)?;
        self.space.deflate(&mut m_x);
        Ok(m_x)
    }
}

/// Computes the `wanted` largest eigenvalues (Wu and Simon 2000, with blocks). Starts from a random block and the known
/// vectors. `progress` counts `shown` of them. Returns inaccurate values without vectors if the first one reaches the
/// ceiling of the operator.
///
/// All coefficients are computed and none is assumed to be 0: the cost is small beside the solves, the basis stays
/// orthonormal to rounding, and a restart equals a step.
pub(super) fn largest(
    operator: &ShiftInvert,
    known: RitzPairs,
    wanted: usize,
    random: &mut Random,
    progress: &dyn Progress,
    shown: usize,
) -> Result<RitzPairs, ModesError> {
    let space = operator.space;
    let capacity = wanted + BLOCK + wanted.max(6 * BLOCK);
    let mut basis = Basis::new(space.size(), capacity);
    let mut projected = Mat::zeros(capacity, capacity);
    basis.extend(known.vectors.as_ref(), space.mass.multiply(known.vectors.as_ref()).as_ref());
    known.values.iter().enumerate().for_each(|(k, value)| projected[(k, k)] = *value);
    drop(known);
    let mut block = random.matrix(space.size(), BLOCK);
    space.deflate(&mut block);
    basis.project_out(&mut block);
    let (mut m_x, _) = space.orthonormalise(&mut block, &basis, random).ok_or(ModesError::OutOfRange)?;
    let (mut converged, mut span) = (0, 1.0);
    for _ in 0..MAX_STEPS_PER_BLOCK * (1 + wanted / BLOCK) {
        check_cancelled(progress)?;
        // The projection is complete on the columns before the block.
        let done = basis.size();
        let size = done + BLOCK;
        basis.extend(block.as_ref(), m_x.as_ref());
        let mut next = operator.apply(m_x)?;
        let coupling = basis.project_out(&mut next);
        extend(&mut projected, &coupling, done);
        let rest;
        (m_x, rest) = space.orthonormalise(&mut next, &basis, random).ok_or(ModesError::OutOfRange)?;
        block = next;
        let full = size + BLOCK > capacity;
        if size >= wanted {
            let (values, rotation) = descending(projected.as_ref().submatrix(0, 0, size, size))?;
            let residuals = &rest * rotation.as_ref().subrows(done, BLOCK);
            // A Ritz value is a lower bound of an eigenvalue, so this one proves that the body is a mechanism.
            if values[0] >= operator.ceiling {
                return Ok(RitzPairs { values, vectors: Mat::zeros(space.size(), 0) });
            }
            let has_converged = |k: &usize| residuals.col(*k).norm_l2() <= RESIDUAL_TOLERANCE * values[*k];
            let found = (0..wanted).take_while(has_converged).count();
            (converged, span) = (found, values[0] / values[wanted - 1]);
            progress.report(found.min(shown), shown);
            if found == wanted {
                let vectors = basis.times(rotation.as_ref().subcols(0, wanted));
                return Ok(RitzPairs { values: values[..wanted].to_vec(), vectors });
            }
            if full {
                let keep = wanted + BLOCK;
                basis.rotate(rotation.as_ref().subcols(0, keep));
                projected.fill(0.0);
                values[..keep].iter().enumerate().for_each(|(k, value)| projected[(k, k)] = *value);
            }
        }
    }
    Err(unconverged(converged, wanted, span))
}

/// Returns the cause of a failed iteration. `span` is the ratio of the largest to the smallest wanted value. Rounding
/// causes up to EPSILON of the largest in each residual, which may exceed the tolerance of the smallest: see
/// `docs/notes/modes.md#lanczos`.
fn unconverged(converged: usize, wanted: usize, span: f64) -> ModesError {
    let is_rounding = f64::EPSILON * span >= RESIDUAL_TOLERANCE;
    ModesError::Unconverged { converged, wanted, ratio: span.sqrt(), is_rounding }
}

/// Returns a lower bound of the largest eigenvalue, by a few steps of the block power method.
pub(super) fn estimate_largest(operator: &ShiftInvert, random: &mut Random) -> Result<f64, ModesError> {
    let space = operator.space;
    let empty = Basis::new(space.size(), 0);
    let mut block = random.matrix(space.size(), BLOCK);
    let mut value = 0.0;
    for _ in 0..3 {
        space.deflate(&mut block);
        let (m_x, _) = space.orthonormalise(&mut block, &empty, random).ok_or(ModesError::OutOfRange)?;
        let next = operator.apply(m_x.clone())?;
        let projected = inner(m_x.as_ref(), next.as_ref());
        value = descending(projected.as_ref())?.0[0];
        block = next;
    }
    Ok(value)
}

/// Writes the columns from `done` on into a projected operator, and their mirror images.
fn extend(projected: &mut Mat<f64>, coupling: &Mat<f64>, done: usize) {
    for j in 0..coupling.ncols() {
        for i in 0..done + coupling.ncols() {
            let entry = match i < done {
                true => coupling[(i, j)],
                false => 0.5 * (coupling[(i, j)] + coupling[(done + j, i - done)]),
            };
            projected[(i, done + j)] = entry;
            projected[(done + j, i)] = entry;
        }
    }
}

/// Returns the eigenvalues, descending, and their vectors.
fn descending(matrix: MatRef<f64>) -> Result<(Vec<f64>, Mat<f64>), ModesError> {
    let (mut values, vectors) = symmetric_eigen(matrix)?;
    values.reverse();
    Ok((values, vectors.as_ref().reverse_cols().to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_message_names_rounding_only_if_it_can_be_the_cause() {
        let rounded = unconverged(175, 258, 1.4e8).to_string();
        let cause = "175 of 258 vibrations converged: the highest frequency is about 11832 times the lowest";
        assert!(rounded.starts_with(cause) && rounded.ends_with("request fewer modes"), "{rounded}");
        let unknown = unconverged(3, 28, 1e3).to_string();
        assert!(
            unknown.starts_with("3 of 28 vibrations converged within") && !unknown.contains("round"),
            "{unknown}"
        );
    }
}
