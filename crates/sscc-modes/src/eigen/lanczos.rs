//! Block Lanczos with thick restarts.

use faer::{Mat, MatRef};
use sscc::{Error, Progress};

use super::basis::{Random, Space, add_product, inner};
use super::dense::symmetric_eigen;
use crate::ModesError;
use crate::sparse::Cholesky;

/// Columns of a block. An eigenvalue that is repeated as often, or less, is found at once; cubes have threefold ones,
/// and a wide block makes more of each pass over the factor.
pub(super) const BLOCK: usize = 16;

/// A Ritz value counts when its residual is at most this share of it. The eigenvalue's own error is about the square.
const CONVERGED: f64 = 1e-10;

/// Steps for each block of wanted values, before giving up. About 6 are usual.
const STEPS: usize = 60;

/// `(K + s M)^-1 M` beside the rigid motions: its eigenvalues are `1 / (lambda + s)`.
pub(super) struct Inverse<'a> {
    pub space: &'a Space<'a>,
    pub factor: &'a Cholesky,
    /// An eigenvalue beyond this one ends the search: the body is a mechanism. Rounding in its direction, made large,
    /// would keep the others from converging.
    pub ceiling: f64,
}

/// Eigenvalues, descending, with M-orthonormal vectors.
pub(super) struct Ritz {
    pub values: Vec<f64>,
    pub vectors: Mat<f64>,
}

impl Inverse<'_> {
    /// The operator applied to all columns.
    pub fn apply(&self, x: MatRef<f64>) -> Result<Mat<f64>, ModesError> {
        let mut y = self.space.mass.multiply(x);
        self.factor.solve(&mut y)?;
        self.space.deflate(&mut y);
        Ok(y)
    }
}

/// The `wanted` largest eigenvalues (Wu and Simon 2000, with blocks). Starts from a random block, beside vectors that
/// are already known. `shown` of them are counted to `progress`. Fewer, and rough ones, when the first is beyond the
/// operator's ceiling.
///
/// All coefficients are computed, none is taken for 0: that costs little beside the solves, keeps the basis
/// orthonormal to rounding, and makes a restart as plain as a step.
pub(super) fn largest(
    operator: &Inverse,
    known: Ritz,
    wanted: usize,
    random: &mut Random,
    progress: &dyn Progress,
    shown: usize,
) -> Result<Ritz, ModesError> {
    let space = operator.space;
    let capacity = wanted + BLOCK + wanted.max(6 * BLOCK);
    let mut basis = Mat::zeros(space.size(), capacity);
    let mut projected = Mat::zeros(capacity, capacity);
    // Columns of the basis on which the projection is complete.
    let mut done = known.values.len();
    basis.as_mut().subcols_mut(0, done).copy_from(&known.vectors);
    known.values.iter().enumerate().for_each(|(k, value)| projected[(k, k)] = *value);
    drop(known);
    let mut block = random.matrix(space.size(), BLOCK);
    space.deflate(&mut block);
    space.take_out(&mut block, basis.as_ref().subcols(0, done));
    space
        .orthonormalise(&mut block, basis.as_ref().subcols(0, done), random)
        .ok_or(ModesError::NoEigenvalues)?;
    for _ in 0..STEPS * (1 + wanted / BLOCK) {
        if progress.is_cancelled() {
            return Err(Error::Cancelled.into());
        }
        let size = done + BLOCK;
        basis.as_mut().subcols_mut(done, BLOCK).copy_from(&block);
        let mut next = operator.apply(block.as_ref())?;
        let coupling = space.take_out(&mut next, basis.as_ref().subcols(0, size));
        extend(&mut projected, &coupling, done);
        let rest = space.orthonormalise(&mut next, basis.as_ref().subcols(0, size), random);
        let rest = rest.ok_or(ModesError::NoEigenvalues)?;
        let full = size + BLOCK > capacity;
        if size >= wanted {
            let (values, turn) = descending(projected.as_ref().submatrix(0, 0, size, size))?;
            let residuals = &rest * turn.as_ref().subrows(done, BLOCK);
            // Ritz values are never too large, so this one is a proof.
            if values[0] >= operator.ceiling {
                return Ok(Ritz { values, vectors: Mat::zeros(space.size(), 0) });
            }
            let good = |k: &usize| residuals.col(*k).norm_l2() <= CONVERGED * values[*k];
            let found = (0..wanted).take_while(good).count();
            progress.report(found.min(shown), shown);
            let keep = if found == wanted { wanted } else { wanted + BLOCK };
            if found == wanted || full {
                let mut vectors = Mat::zeros(space.size(), keep);
                let turn = turn.as_ref().subcols(0, keep);
                add_product(vectors.as_mut(), basis.as_ref().subcols(0, size), turn, 1.0);
                if found == wanted {
                    return Ok(Ritz { values: values[..wanted].to_vec(), vectors });
                }
                basis.as_mut().subcols_mut(0, keep).copy_from(&vectors);
                projected.fill(0.0);
                values[..keep].iter().enumerate().for_each(|(k, value)| projected[(k, k)] = *value);
                done = keep;
                block = next;
                continue;
            }
        }
        done = size;
        block = next;
    }
    Err(ModesError::NoEigenvalues)
}

/// The largest eigenvalue, roughly (never too large), by a few steps of the block power method.
pub(super) fn roughly_largest(operator: &Inverse, random: &mut Random) -> Result<f64, ModesError> {
    let space = operator.space;
    let nothing = Mat::zeros(space.size(), 0);
    let mut block = random.matrix(space.size(), BLOCK);
    let mut value = 0.0;
    for _ in 0..3 {
        space.deflate(&mut block);
        space.orthonormalise(&mut block, nothing.as_ref(), random).ok_or(ModesError::NoEigenvalues)?;
        let next = operator.apply(block.as_ref())?;
        let projected = inner(block.as_ref(), space.mass.multiply(next.as_ref()).as_ref());
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

/// Eigenvalues, descending, and their vectors.
fn descending(matrix: MatRef<f64>) -> Result<(Vec<f64>, Mat<f64>), ModesError> {
    let (mut values, vectors) = symmetric_eigen(matrix)?;
    values.reverse();
    Ok((values, vectors.as_ref().reverse_cols().to_owned()))
}
