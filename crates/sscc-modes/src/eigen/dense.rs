//! Small eigenproblems, solved as a whole.

use faer::diag::Diag;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::evd::{ComputeEigenvectors, self_adjoint_evd, self_adjoint_evd_scratch};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Mat, MatRef, Par};

use super::tall::inner;
use crate::ModesError;
use crate::sparse::BlockSparse;

/// Eigenvalues, ascending, and orthonormal eigenvectors of a symmetric matrix (its lower triangle). On one thread, so
/// that the order of sums is fixed.
pub(crate) fn symmetric_eigen(matrix: MatRef<f64>) -> Result<(Vec<f64>, Mat<f64>), ModesError> {
    let size = matrix.nrows();
    let mut values = Diag::zeros(size);
    let mut vectors = Mat::zeros(size, size);
    let scratch =
        self_adjoint_evd_scratch::<f64>(size, ComputeEigenvectors::Yes, Par::Seq, Default::default());
    self_adjoint_evd(
        matrix,
        values.as_mut(),
        Some(vectors.as_mut()),
        Par::Seq,
        MemStack::new(&mut MemBuffer::try_new(scratch).map_err(|_| ModesError::Memory)?),
        Default::default(),
    )
    .map_err(|_| ModesError::NoEigenvalues)?;
    Ok(((0..size).map(|k| values[k]).collect(), vectors))
}

/// All eigenvalues of `K x = lambda M x` beside the rigid motions, ascending, and M-orthonormal vectors.
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
    .map_err(|_| ModesError::NoEigenvalues)?;
    // C = L^-1 K L^-T for M = L L'.
    let mut matrix = full(stiffness);
    solve_lower_triangular_in_place(lower.as_ref(), matrix.as_mut(), Par::Seq);
    let mut matrix = matrix.transpose().to_owned();
    solve_lower_triangular_in_place(lower.as_ref(), matrix.as_mut(), Par::Seq);
    // The rigid motions go to the far end of the spectrum, beyond a bound of it: C + top Q Q' for Q = L' R.
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

/// All entries.
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
