//! Block Lanczos: the largest eigenvalues of an operator that is symmetric in the inner product of M.
//!
//! Blocks, because single vectors find copies of a repeated eigenvalue only by rounding; full orthogonalisation, twice,
//! because otherwise found vectors come back; thick restarts, so that the basis stays small.

use faer::{Mat, MatRef, Side};

use crate::ModesError;

/// Columns of a block.
pub(super) const BLOCK: usize = 8;

/// A residual of at most this share of its eigenvalue has converged. The eigenvalue itself is then right to the square.
const CONVERGED: f64 = 1e-9;

/// Restarts before giving up. Lattices took 2 to 6.
const RESTARTS: usize = 200;

/// A column shorter than this share of what it was before orthogonalisation is rounding: it lies in the basis.
const LOST: f64 = 1e-11;

/// The operator, and the products that go with it.
pub(super) trait Operator {
    /// The operator applied to all columns, kept out of the space that is to be left alone.
    fn apply(&self, x: MatRef<f64>) -> Mat<f64>;
    /// M times all columns.
    fn mass(&self, x: MatRef<f64>) -> Mat<f64>;
    /// Takes away, M-orthogonally, what lies in the space that is to be left alone.
    fn deflate(&self, x: &mut Mat<f64>);
    /// Notices that the work was cancelled; told the number of values found.
    fn step(&self, found: usize) -> Result<(), ModesError>;
}

/// The largest eigenvalues found, descending, and their M-orthonormal vectors.
pub(super) struct Ritz {
    pub values: Vec<f64>,
    pub vectors: Mat<f64>,
}

/// The `wanted` largest eigenvalues of an operator on vectors of length `size`, which without the space that is left
/// alone has `available` dimensions; `start` are vectors already known (maybe none), beside which a new random block
/// looks for others.
pub(super) fn largest(
    operator: &impl Operator,
    start: Option<Ritz>,
    wanted: usize,
    [size, available]: [usize; 2],
    random: &mut Random,
) -> Result<Ritz, ModesError> {
    let limit = (2 * wanted + 4 * BLOCK).min(available);
    let start = start.unwrap_or(Ritz { values: Vec::new(), vectors: Mat::zeros(size, 0) });
    let mut basis = start.vectors;
    let mut projected = diagonal(&start.values);
    let mut block = random.block(size, BLOCK);
    operator.deflate(&mut block);
    orthonormalise(operator, &mut block, &basis);
    for _ in 0..RESTARTS {
        loop {
            // The last block is the new one; the projection of the operator on it is complete with this step.
            let from = basis.ncols();
            basis = join(&basis, &block);
            let mut next = operator.apply(block.as_ref());
            let coupling = project_out(operator, &mut next, &basis);
            projected = grow(&projected, &coupling, from);
            let mut rest = next;
            let before = rest.clone();
            orthonormalise(operator, &mut rest, &basis);
            // Of the operator's image: what the new block does not hold is rounding.
            let link = rest.transpose() * operator.mass(before.as_ref());
            operator.step(0)?;
            let full = rest.ncols() == 0;
            if full || basis.ncols() + rest.ncols() > limit {
                let ritz = decompose(&basis, &projected)?;
                let tail = ritz.1.as_ref().subrows(from, basis.ncols() - from);
                let residuals = &link * tail;
                let count = wanted.min(ritz.0.len());
                let good = |k: &usize| full || residuals.col(*k).norm_l2() <= CONVERGED * ritz.0[*k].abs();
                let found = (0..count).take_while(good).count();
                operator.step(found)?;
                if found == count {
                    let vectors = &basis * ritz.1.as_ref().subcols(0, count);
                    return Ok(Ritz { values: ritz.0[..count].to_vec(), vectors });
                }
                let keep = (wanted + BLOCK).min(ritz.0.len() - 1).min(limit - BLOCK);
                basis = &basis * ritz.1.as_ref().subcols(0, keep);
                projected = diagonal(&ritz.0[..keep]);
                block = rest;
                break;
            }
            block = rest;
        }
    }
    Err(ModesError::NoEigenvalues)
}

fn diagonal(values: &[f64]) -> Mat<f64> {
    Mat::from_fn(values.len(), values.len(), |i, j| if i == j { values[i] } else { 0.0 })
}

/// Both matrices side by side.
fn join(a: &Mat<f64>, b: &Mat<f64>) -> Mat<f64> {
    let mut joined = Mat::zeros(a.nrows(), a.ncols() + b.ncols());
    joined.as_mut().subcols_mut(0, a.ncols()).copy_from(a);
    joined.as_mut().subcols_mut(a.ncols(), b.ncols()).copy_from(b);
    joined
}

/// The projected operator with new rows and columns from `from` on.
fn grow(old: &Mat<f64>, coupling: &Mat<f64>, from: usize) -> Mat<f64> {
    let size = coupling.nrows();
    Mat::from_fn(size, size, |i, j| match (i < from, j < from) {
        (true, true) => old[(i, j)],
        (true, false) => coupling[(i, j - from)],
        (false, true) => coupling[(j, i - from)],
        (false, false) => 0.5 * (coupling[(i, j - from)] + coupling[(j, i - from)]),
    })
}

/// Eigenvalues, descending, and vectors of a symmetric matrix.
fn decompose(_basis: &Mat<f64>, projected: &Mat<f64>) -> Result<(Vec<f64>, Mat<f64>), ModesError> {
    let size = projected.nrows();
    let eigen = projected.self_adjoint_eigen(Side::Lower).map_err(|_| ModesError::NoEigenvalues)?;
    let values = (0..size).rev().map(|k| eigen.S()[k]).collect();
    Ok((values, Mat::from_fn(size, size, |i, j| eigen.U()[(i, size - 1 - j)])))
}

/// Takes the basis out of all columns, twice; what was taken, as coefficients of the basis.
fn project_out(operator: &impl Operator, x: &mut Mat<f64>, basis: &Mat<f64>) -> Mat<f64> {
    let mut taken = Mat::zeros(basis.ncols(), x.ncols());
    for _ in 0..2 {
        let coefficients = basis.transpose() * operator.mass(x.as_ref());
        *x -= basis * &coefficients;
        taken += coefficients;
    }
    taken
}

/// Makes the columns M-orthonormal and orthogonal to the basis; columns that depend on others fall away.
fn orthonormalise(operator: &impl Operator, x: &mut Mat<f64>, basis: &Mat<f64>) {
    let norm = |x: &Mat<f64>| -> Vec<f64> {
        let mass = operator.mass(x.as_ref());
        (0..x.ncols()).map(|j| (x.col(j).transpose() * mass.col(j)).max(0.0).sqrt()).collect()
    };
    // Columns of one length, so that none is lost because it is short.
    let first = norm(x);
    for (j, length) in first.iter().enumerate() {
        if *length > 0.0 {
            x.col_mut(j).iter_mut().for_each(|v| *v /= length);
        }
    }
    for _ in 0..3 {
        if x.ncols() == 0 {
            return; // faer decomposes no empty matrix
        }
        operator.deflate(x);
        project_out(operator, x, basis);
        let gram = x.transpose() * operator.mass(x.as_ref());
        let Ok(eigen) = gram.self_adjoint_eigen(Side::Lower) else { return };
        let size = gram.nrows();
        let largest = eigen.S()[size - 1];
        let kept: Vec<usize> =
            (0..size).filter(|k| eigen.S()[*k] > (LOST * LOST).max(1e-14 * largest)).collect();
        let turn = Mat::from_fn(size, kept.len(), |i, j| eigen.U()[(i, kept[j])] / eigen.S()[kept[j]].sqrt());
        *x = &*x * &turn;
    }
}

/// Pseudo-random numbers: the same in every run.
pub(super) struct Random(u64);

impl Random {
    pub fn new() -> Self {
        Self(0x9e37_79b9_7f4a_7c15)
    }

    /// A matrix with entries between -1 and 1.
    pub fn block(&mut self, rows: usize, columns: usize) -> Mat<f64> {
        let mut block = Mat::zeros(rows, columns);
        for j in 0..columns {
            for i in 0..rows {
                self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                block[(i, j)] = (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
            }
        }
        block
    }
}
