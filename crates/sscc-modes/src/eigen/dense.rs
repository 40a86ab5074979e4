//! Dense solver for small eigenproblems.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Mat, MatRef, Par};

use super::tall_matrix::inner;
use crate::ModesError;
use crate::sparse::BlockSparse;

/// Returns the eigenvalues, ascending, and orthonormal eigenvectors of a symmetric matrix (its lower triangle). Uses one
/// thread, so that the order of sums is fixed.
///
/// From 128 rows on, faer's divide and conquer has an absolute tolerance: off-diagonal entries below about 1e-15 count as
/// 0. The matrix is therefore divided by a power of two near its largest entry, which is exact, and the eigenvalues are
/// multiplied by it.
pub(crate) fn symmetric_eigen(matrix: MatRef<f64>) -> Result<(Vec<f64>, Mat<f64>), ModesError> {
    let size = matrix.nrows();
    let lower = || (0..size).flat_map(|j| (j..size).map(move |i| matrix[(i, j)]));
    if !lower().all(f64::is_finite) {
        return Err(ModesError::OutOfRange);
    }
    let (_, exponent) = libm::frexp(lower().fold(0.0_f64, |m, x| m.max(x.abs())));
    let scaled = Mat::from_fn(size, size, |i, j| libm::ldexp(matrix[(i.max(j), i.min(j))], -exponent));
    let mut values = Diag::zeros(size);
    let mut vectors = Mat::zeros(size, size);
    let scratch =
        self_adjoint_evd_scratch::<f64>(size, ComputeEigenvectors::Yes, Par::Seq, Default::default());
    self_adjoint_evd(
        scaled.as_ref(),
        values.as_mut(),
        Some(vectors.as_mut()),
        Par::Seq,
        MemStack::new(&mut MemBuffer::try_new(scratch).map_err(|_| ModesError::Memory)?),
        Default::default(),
    )
    .map_err(|_| ModesError::NoEigenvalues { rows: size })?;
    Ok(((0..size).map(|k| libm::ldexp(values[k], exponent)).collect(), vectors))
}

/// Returns all eigenvalues of `K x = lambda M x` without rigid motions, ascending, and M-orthonormal vectors.
pub(super) fn all_modes(
    stiffness: &BlockSparse,
    mass: &BlockSparse,
    rigid: MatRef<f64>,
) -> Result<(Vec<f64>, Mat<f64>), ModesError> {
    let size = 3 * mass.rows();
    let mut lower = full(mass);
    let scratch = cholesky_in_place_scratch::<f64>(size, Par::Seq, Default::default());
    let mut memory = MemBuffer::try_new(scratch).map_err(|_| ModesError::Memory)?;
    cholesky_in_place(
        lower.as_mut(),
        Default::default(),
        Par::Seq,
        MemStack::new(&mut memory),
        Default::default(),
    )
    // A mass matrix is positive definite unless its entries overflowed.
    .map_err(|_| ModesError::OutOfRange)?;
    // C = L^-1 K L^-T for M = L L'.
    let mut matrix = full(stiffness);
    solve_lower_triangular_in_place(lower.as_ref(), matrix.as_mut(), Par::Seq);
    let mut matrix = matrix.transpose().to_owned();
    solve_lower_triangular_in_place(lower.as_ref(), matrix.as_mut(), Par::Seq);
    // C + top Q Q' with Q = L' R moves the rigid motions beyond an upper bound of the spectrum.
    let row_sum = |i: usize| (0..size).map(|j| matrix[(i, j)].abs()).sum::<f64>();
    let top = 2.0 * (0..size).map(row_sum).fold(0.0, f64::max);
    let rigid = Mat::from_fn(size, rigid.ncols(), |i, k| {
        (i..size).map(|j| lower[(j, i)] * rigid[(j, k)]).sum::<f64>()
    });
    let projector = inner(rigid.transpose(), rigid.transpose());
    let matrix =
        Mat::from_fn(size, size, |i, j| 0.5 * (matrix[(i, j)] + matrix[(j, i)]) + top * projector[(i, j)]);
    let (values, mut vectors) = symmetric_eigen(matrix.as_ref())?;
    solve_upper_triangular_in_place(lower.transpose(), vectors.as_mut(), Par::Seq);
    let modes = size - rigid.ncols();
    Ok((values[..modes].to_vec(), vectors.as_ref().subcols(0, modes).to_owned()))
}

/// Returns the dense matrix.
pub(super) fn full(matrix: &BlockSparse) -> Mat<f64> {
    let mut full = Mat::zeros(3 * matrix.rows(), 3 * matrix.rows());
    for row in 0..matrix.rows() {
        for (column, block) in matrix.columns(row).iter().zip(matrix.blocks(row)) {
            for (k, entry) in block.iter().enumerate() {
                full[(3 * row + k / 3, 3 * *column as usize + k % 3)] = *entry;
            }
        }
    }
    full
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eigen::lattice::random_matrix;

    /// Returns a symmetric matrix with eigenvalues from about 1 to 1e-6: `X' D X`, X nearly orthogonal.
    fn graded(size: usize) -> Mat<f64> {
        let half = random_matrix(size, size);
        let weighted = Mat::from_fn(size, size, |i, j| half[(i, j)] * 1e-6_f64.powf(i as f64 / size as f64));
        inner(half.as_ref(), weighted.as_ref())
    }

    /// Sizes below and above 128 rows, where faer switches to divide and conquer.
    #[test]
    fn accuracy_does_not_depend_on_the_unit() {
        for size in [5, 127, 200] {
            let matrix = graded(size);
            let (values, vectors) = symmetric_eigen(matrix.as_ref()).unwrap();
            let residual = &matrix * &vectors - Mat::from_fn(size, size, |i, j| vectors[(i, j)] * values[j]);
            assert!(residual.norm_max() < 1e-13 * values[size - 1]);
            for exponent in [-700, -60, -30, 30, 60, 700] {
                let scaled = Mat::from_fn(size, size, |i, j| libm::ldexp(matrix[(i, j)], exponent));
                let (found, of_scaled) = symmetric_eigen(scaled.as_ref()).unwrap();
                assert!(
                    values.iter().zip(&found).all(|(a, b)| libm::ldexp(*a, exponent) == *b),
                    "{exponent}"
                );
                assert!(vectors == of_scaled, "{size} rows, {exponent}");
            }
        }
    }

    #[test]
    fn matrices_that_are_not_finite_are_rejected() {
        for bad in [f64::NAN, f64::INFINITY] {
            let mut matrix = graded(130);
            matrix[(129, 0)] = bad;
            assert_eq!(symmetric_eigen(matrix.as_ref()).err(), Some(ModesError::OutOfRange));
        }
        assert!(symmetric_eigen(Mat::zeros(130, 130).as_ref()).unwrap().0.iter().all(|x| *x == 0.0));
    }
}
