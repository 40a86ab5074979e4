//! Parallel products of tall matrices, with a fixed order of sums.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Number of rows per task. Fixed, so that sums do not depend on the number of threads.
const ROWS_PER_TASK: usize = 4096;

/// Returns `a' b` for tall matrices.
pub(crate) fn inner(a: MatRef<f64>, b: MatRef<f64>) -> Mat<f64> {
    if a.nrows() == 0 || a.ncols() == 0 || b.ncols() == 0 {
        return Mat::zeros(a.ncols(), b.ncols());
    }
    let parts: Vec<Mat<f64>> = a
        .par_row_chunks(ROWS_PER_TASK)
        .zip(b.par_row_chunks(ROWS_PER_TASK))
        .map(|(a, b)| {
            let mut part = Mat::zeros(a.ncols(), b.ncols());
            matmul(&mut part, Accum::Replace, a.transpose(), b, 1.0, Par::Seq);
            part
        })
        .collect();
    parts.iter().fold(Mat::zeros(a.ncols(), b.ncols()), |sum, part| sum + part)
}

/// Returns `a b` for tall `a`.
pub(crate) fn product(a: MatRef<f64>, b: MatRef<f64>) -> Mat<f64> {
    let mut product = Mat::zeros(a.nrows(), b.ncols());
    add_product(product.as_mut(), a, b, 1.0);
    product
}

/// Adds `factor a b` to `to`, for tall `a`.
pub(crate) fn add_product(to: MatMut<f64>, a: MatRef<f64>, b: MatRef<f64>, factor: f64) {
    if to.nrows() == 0 || to.ncols() == 0 || a.ncols() == 0 {
        return;
    }
    to.par_row_chunks_mut(ROWS_PER_TASK)
        .zip(a.par_row_chunks(ROWS_PER_TASK))
        .for_each(|(to, a)| matmul(to, Accum::Add, a, b, factor, Par::Seq));
}

/// Pseudo-random numbers between -1 and 1, the same in every run.
pub(super) struct Random(pub u64);

impl Random {
    /// Returns the next number.
    pub fn next(&mut self) -> f64 {
        2.0 * sscc::parts::next_uniform(&mut self.0) - 1.0
    }

    /// Returns a matrix of random numbers.
    pub fn matrix(&mut self, rows: usize, columns: usize) -> Mat<f64> {
        Mat::from_fn(rows, columns, |_, _| self.next())
    }
}
