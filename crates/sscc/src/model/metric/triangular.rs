//! The upper triangular factor of a dense metric, and an upper bound of the factor by which its inverse magnifies rounding
//! errors.

use glam::DVec3;

use crate::{Error, limits};

/// The largest number of modes. The factor of more modes takes gigabytes and minutes; reduced models have far fewer.
const MAX_MODES: usize = 1024;

/// A matrix counts as symmetric if no entry differs by more than this from its mirror image, in units of the geometric
/// mean of the two diagonal entries of its row and column. The tolerance is far above the rounding of a matrix that was
/// computed in another order, and far below the error of a wrong matrix.
const ASYMMETRY: f64 = 1e-9;

/// An upper triangular factor S with a positive diagonal.
#[derive(Clone, Debug)]
pub(super) struct Triangular {
    rank: usize,
    /// S by rows, zeros below the diagonal.
    entries: Vec<f64>,
    /// An upper bound of `|S||S^-1|`, by rows.
    growth: Vec<f64>,
}

/// `growth` follows from the entries.
impl PartialEq for Triangular {
    fn eq(&self, other: &Self) -> bool {
        self.entries == other.entries
    }
}

impl Triangular {
    pub(super) fn new(rank: usize, entries: Vec<f64>) -> Result<Self, Error> {
        let wrong = |what: &'static str| Error::MetricMatrix { what };
        if rank == 0 {
            return Err(Error::RankZero);
        }
        if rank > MAX_MODES {
            return Err(wrong("it has more than 1024 rows; use a diagonal one"));
        }
        if entries.len() != rank * rank {
            return Err(wrong("its factor is not square"));
        }
        for (i, row) in entries.chunks_exact(rank).enumerate() {
            if row.iter().any(|s| !s.is_finite() || s.abs() > limits::LARGEST) {
                return Err(wrong("its factor has an entry that is not finite, or beyond 2^200"));
            }
            if row[..i].iter().any(|s| *s != 0.0) {
                return Err(wrong("its factor is not upper triangular"));
            }
            if row[i] < limits::SMALLEST {
                return Err(wrong("its factor has a diagonal entry that is not positive, or below 2^-200"));
            }
        }
        let mut this = Self { rank, entries, growth: Vec::new() };
        this.growth = this
            .growth_bound()
            .ok_or(wrong("it is nearly singular: rounding errors of its inverse are too large"))?;
        Ok(this)
    }

    /// Computes the factor of a symmetric positive definite matrix, `M = S'S`.
    pub(super) fn cholesky(rank: usize, matrix: &[f64]) -> Result<Self, Error> {
        let wrong = |what: &'static str| Error::MetricMatrix { what };
        if rank > MAX_MODES {
            return Err(wrong("it has more than 1024 rows; use a diagonal one"));
        }
        if matrix.len() != rank * rank {
            return Err(wrong("it is not square"));
        }
        let m = |i: usize, j: usize| matrix[i * rank + j];
        let mut s = vec![0.0; rank * rank];
        for i in 0..rank {
            for j in i..rank {
                let unit = (m(i, i).abs() * m(j, j).abs()).sqrt();
                if (m(i, j) - m(j, i)).abs() > ASYMMETRY * unit || !(m(i, j) + m(j, i)).is_finite() {
                    return Err(wrong("it is not symmetric and finite"));
                }
                let sum: f64 = (0..i).map(|k| s[k * rank + i] * s[k * rank + j]).sum();
                let rest = 0.5 * (m(i, j) + m(j, i)) - sum;
                s[i * rank + j] = if i == j { rest.sqrt() } else { rest / s[i * rank + i] };
            }
            let pivot = s[i * rank + i];
            if pivot.is_nan() || pivot <= 0.0 {
                return Err(wrong("it is not positive definite"));
            }
        }
        Self::new(rank, s)
    }

    pub(super) fn rank(&self) -> usize {
        self.rank
    }

    pub(super) fn entries(&self) -> &[f64] {
        &self.entries
    }

    pub(super) fn diagonal(&self) -> impl Iterator<Item = f64> {
        self.entries.iter().copied().step_by(self.rank + 1)
    }

    fn row(&self, i: usize) -> &[f64] {
        &self.entries[i * self.rank..][..self.rank]
    }

    /// Returns the length of column k, rounded to nearest.
    pub(super) fn column_length(&self, k: usize) -> f64 {
        let column = || (0..=k).map(|i| self.entries[i * self.rank + k]);
        let largest = column().fold(0.0_f64, |l, s| l.max(s.abs()));
        largest * column().map(|s| (s / largest) * (s / largest)).sum::<f64>().sqrt()
    }

    /// Returns `S q`, rounded to nearest.
    pub(super) fn product(&self, q: &[f64]) -> Vec<f64> {
        let row = |i: usize| self.row(i)[i..].iter().zip(&q[i..]).map(|(s, x)| s * x).sum();
        (0..self.rank).map(row).collect()
    }

    /// Computes `S^-1 z` by back substitution, rounded to nearest.
    pub(super) fn solve(&self, z: &[f64]) -> Vec<f64> {
        let mut q = z.to_vec();
        for i in (0..self.rank).rev() {
            let row = self.row(i);
            let known: f64 = (i + 1..self.rank).map(|j| row[j] * q[j]).sum();
            q[i] = (q[i] - known) / row[i];
        }
        q
    }

    /// Computes `A = U S^-1` by forward substitution: `A_k = (U_k - sum_j A_j S_jk) / S_kk`. The backward error of a
    /// triangular solve is at most `gamma_r |A||S|`, so the error of A is at most that times `|S^-1|`.
    pub(super) fn divide(&self, modes: &[DVec3], out: &mut [DVec3]) {
        out.copy_from_slice(modes);
        for j in 0..self.rank {
            let row = self.row(j);
            out[j] /= row[j];
            let a = out[j];
            for k in j + 1..self.rank {
                out[k] -= a * row[k];
            }
        }
    }

    /// Computes an upper bound of `|A||S||S^-1|`.
    pub(super) fn magnitudes(&self, scaled: &[DVec3], out: &mut [DVec3]) {
        out.fill(DVec3::ZERO);
        for (a, row) in scaled.iter().zip(self.growth.chunks_exact(self.rank)) {
            out.iter_mut().zip(row).for_each(|(m, g)| *m += a.abs() * *g);
        }
    }

    /// Returns an upper bound of `|S q|_i` for each row i.
    pub(super) fn products_up(&self, q: &[f64]) -> impl Iterator<Item = f64> + Clone {
        let gamma = with_mutant!((self.rank as f64 + 8.0) * f64::EPSILON, DenseProductsExact, 0.0);
        (0..self.rank).map(move |i| {
            let products = self.row(i)[i..].iter().zip(&q[i..]).map(|(s, x)| s * x);
            let (sum, size) = products.fold((0.0_f64, 0.0_f64), |(sum, size), p| (sum + p, size + p.abs()));
            let moves = self.row(i)[i..].iter().zip(&q[i..]).any(|(s, x)| *s != 0.0 && *x != 0.0);
            // The bound of a sum that overflows is infinite; products that underflow count as the smallest normal number.
            let bound = sum.abs() + gamma * size + if moves { f64::MIN_POSITIVE } else { 0.0 };
            if bound.is_nan() { f64::INFINITY } else { bound }
        })
    }

    /// Returns an upper bound of `|S||S^-1|`; `None` if S is so nearly singular that the computed inverse proves nothing.
    ///
    /// With a computed inverse T and `R = I - S T`: `S^-1 = T (I - R)^-1`, so where the row sums of `|R|` are at most
    /// `rho < 1`, `|S^-1| <= |T| + rho / (1 - rho) times the row sums of |T|`.
    fn growth_bound(&self) -> Option<Vec<f64>> {
        let r = self.rank;
        let mut inverse = vec![0.0; r * r];
        let mut unit = vec![0.0; r];
        for j in 0..r {
            unit.fill(0.0);
            unit[j] = 1.0;
            let column = self.solve(&unit);
            (0..r).for_each(|i| inverse[i * r + j] = column[i]);
        }
        let gamma = (r as f64 + 8.0) * f64::EPSILON;
        let mut rho = 0.0_f64;
        for i in 0..r {
            let mut row = 0.0;
            for j in i..r {
                let products = (i..=j).map(|k| self.row(i)[k] * inverse[k * r + j]);
                let (sum, size) = products.fold((0.0, 0.0_f64), |(s, a), p| (s + p, a + p.abs()));
                let one = if i == j { 1.0 } else { 0.0 };
                row += (one - sum).abs() + gamma * (size + one);
            }
            rho = rho.max(row);
        }
        if rho.is_nan() || rho > 0.5 {
            return None;
        }
        let up = 1.0 + 4.0 * gamma;
        let excess = with_mutant!(rho / (1.0 - rho) * up, DenseInverseExact, 0.0);
        for row in inverse.chunks_exact_mut(r) {
            let sum: f64 = row.iter().map(|t| t.abs()).sum();
            row.iter_mut().for_each(|t| *t = (t.abs() + excess * sum) * up);
        }
        let mut growth = vec![0.0; r * r];
        for i in 0..r {
            for (k, s) in self.row(i).iter().enumerate().skip(i) {
                let inverse_row = &inverse[k * r..][..r];
                let out = &mut growth[i * r..][..r];
                out.iter_mut().zip(inverse_row).for_each(|(g, t)| *g += s.abs() * t * up);
            }
        }
        growth.iter().all(|g| g.is_finite()).then_some(growth)
    }
}

#[cfg(test)]
mod tests;
