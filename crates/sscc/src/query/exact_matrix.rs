//! For tests: 3 x 3 matrices of exact numbers.

use glam::DMat3;
use sscc_testing::Dyadic;

pub(super) type Matrix = [[Dyadic; 3]; 3];

pub(super) fn exact(x: f64) -> Dyadic {
    Dyadic::new(x)
}

pub(super) fn matrix(of: impl Fn(usize, usize) -> Dyadic) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| of(i, j)))
}

pub(super) fn of_map(map: &DMat3) -> Matrix {
    matrix(|i, j| exact(map.col(j)[i]))
}

/// Whether a symmetric matrix less a multiple of the identity is positive definite.
pub(super) fn is_above(a: &Matrix, least: &Dyadic) -> bool {
    let m = matrix(|i, j| if i == j { &a[i][j] - least } else { a[i][j].clone() });
    let two = &m[0][0] * &m[1][1] - &m[0][1] * &m[1][0];
    let minor = |i: usize, j: usize| &m[1][i] * &m[2][j] - &m[1][j] * &m[2][i];
    let three = &m[0][0] * minor(1, 2) - &m[0][1] * minor(0, 2) + &m[0][2] * minor(0, 1);
    m[0][0].is_positive() && two.is_positive() && three.is_positive()
}

pub(super) fn gram(f: &Matrix) -> Matrix {
    matrix(|i, j| (0..3).map(|k| &f[k][i] * &f[k][j]).sum())
}
