//! Small dense matrices (row-major) and modes for tests.

use glam::DVec3;
use sscc::Modes;
use sscc_solid::Stiffness;

use super::common::Random;

/// Returns the product of two n x n matrices.
pub fn product(n: usize, a: &[f64], b: &[f64]) -> Vec<f64> {
    let mut c = vec![0.0; n * n];
    for i in 0..n {
        for k in 0..n {
            for j in 0..n {
                c[i * n + j] += a[i * n + k] * b[k * n + j];
            }
        }
    }
    c
}

/// Returns the transpose of an n x n matrix.
pub fn transpose(n: usize, a: &[f64]) -> Vec<f64> {
    (0..n * n).map(|at| a[at % n * n + at / n]).collect()
}

/// Returns `A x`.
pub fn times(a: &[f64], x: &[f64]) -> Vec<f64> {
    a.chunks_exact(x.len()).map(|row| dot(row, x)).collect()
}

/// Returns `x . y`.
pub fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

/// Returns the largest difference of entries; NaN counts as infinite.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let entry = |(a, b): (&f64, &f64)| if (a - b).is_nan() { f64::INFINITY } else { (a - b).abs() };
    a.iter().zip(b).map(entry).fold(0.0, f64::max)
}

/// Returns the diagonal matrix.
pub fn diagonal(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    (0..n * n).map(|at| if at / n == at % n { values[at / n] } else { 0.0 }).collect()
}

/// Returns a symmetric matrix with these eigenvalues and random eigenvectors (four random reflections).
pub fn with_spectrum(random: &mut Random, eigenvalues: &[f64]) -> Vec<f64> {
    let n = eigenvalues.len();
    let mut a = diagonal(eigenvalues);
    for _ in 0..4 {
        let v = numbers(random, n);
        let scale = 2.0 / dot(&v, &v);
        let entry = |at: usize| f64::from(u8::from(at / n == at % n)) - scale * v[at / n] * v[at % n];
        let reflection: Vec<f64> = (0..n * n).map(entry).collect();
        a = product(n, &reflection, &product(n, &a, &reflection));
    }
    a.iter().zip(&transpose(n, &a)).map(|(x, y)| (x + y) / 2.0).collect()
}

/// Returns a stiffness with these entries.
pub fn stiffness(rank: usize, entries: &[f64]) -> Stiffness {
    Stiffness::new(rank, entries.to_vec()).expect("the entries of a stiffness")
}

/// Returns random numbers between -1 and 1.
pub fn numbers(random: &mut Random, count: usize) -> Vec<f64> {
    (0..count).map(|_| random.number()).collect()
}

/// Returns random modes.
pub fn random_modes(random: &mut Random, vertices: usize, rank: usize) -> Modes {
    let displacements: Vec<DVec3> = (0..vertices * rank).map(|_| random.vector()).collect();
    Modes::new(rank, displacements).expect("random modes are valid")
}
