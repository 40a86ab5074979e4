//! The ellipsoid of a patch's residuals: an upper triangular W such that `|(E_j - E_i) f| <= s_ij kappa |W f|`.
//!
//! Any W serves: `strain_bound` finds its kappa. The one here is that of the smallest volume for some pairs (Khachiyan's
//! iteration, which is multiplicative), rounded to single precision.

use crate::model::mode_rows::LANES;

/// Steps of the iteration.
const STEPS: usize = 6;

/// What is added to the diagonal, relative to the trace: W is invertible, and a motion that leaves no residual still has a small
/// `W f`.
const FLOOR: f64 = 1e-9;

/// The smallest trace: W is in the range of single precision.
const SMALLEST: f64 = 1e-20;

/// An upper triangular matrix, by rows.
#[derive(Clone)]
pub(super) struct ResidualEllipsoid {
    rank: usize,
    row_len: usize,
    rows: Vec<f64>,
}

impl ResidualEllipsoid {
    /// The ellipsoid of blocks of three rows each; none where numbers are out of range.
    pub(super) fn around(blocks: &[f64], rank: usize, row_len: usize) -> Option<Self> {
        let blocks: Vec<&[f64]> = blocks.chunks_exact(3 * row_len).collect();
        let mut weights = vec![1.0 / blocks.len().max(1) as f64; blocks.len()];
        let mut ellipsoid = Self::of_weighted(&blocks, &weights, rank, row_len)?;
        let mut image = vec![0.0; 3 * row_len];
        for _ in 0..STEPS {
            for (block, weight) in blocks.iter().zip(&mut weights) {
                image.copy_from_slice(block);
                ellipsoid.divide(&mut image);
                *weight *= image.iter().map(|x| x * x).sum::<f64>();
            }
            let sum: f64 = weights.iter().sum();
            if !sum.is_normal() {
                break;
            }
            weights.iter_mut().for_each(|weight| *weight /= sum);
            ellipsoid = Self::of_weighted(&blocks, &weights, rank, row_len)?;
        }
        ellipsoid.round()
    }

    /// The Cholesky factor of the weighted sum of Gram matrices.
    fn of_weighted(blocks: &[&[f64]], weights: &[f64], rank: usize, row_len: usize) -> Option<Self> {
        let mut gram = vec![0.0; rank * row_len];
        for (block, weight) in blocks.iter().zip(weights) {
            for row in block.chunks_exact(row_len) {
                for i in 0..rank {
                    let factor = weight * row[i];
                    let start = i / LANES * LANES;
                    let out = &mut gram[i * row_len + start..][..row_len - start];
                    out.iter_mut().zip(&row[start..]).for_each(|(out, x)| *out += factor * x);
                }
            }
        }
        let trace = (0..rank).map(|i| gram[i * row_len + i]).sum::<f64>().max(SMALLEST);
        let mut rows = gram;
        for i in 0..rank {
            rows[i * row_len + i] += FLOOR * trace;
        }
        for i in 0..rank {
            let (done, rest) = rows.split_at_mut((i + 1) * row_len);
            let row = &mut done[i * row_len..];
            let pivot = row[i].sqrt();
            if !pivot.is_normal() {
                return None;
            }
            row.iter_mut().for_each(|x| *x /= pivot);
            row[..i].fill(0.0);
            for k in i + 1..rank {
                let factor = row[k];
                let start = k / LANES * LANES;
                let out = &mut rest[(k - i - 1) * row_len + start..][..row_len - start];
                out.iter_mut().zip(&row[start..]).for_each(|(out, x)| *out -= factor * x);
            }
        }
        for i in 0..rank {
            rows[i * row_len..][..i].fill(0.0);
        }
        Some(Self { rank, row_len, rows })
    }

    /// The same with entries in single precision.
    fn round(mut self) -> Option<Self> {
        self.rows.iter_mut().for_each(|x| *x = f64::from(*x as f32));
        let is_in_range = |x: &f64| x.abs() < 1e15;
        let is_diagonal_normal = (0..self.rank).all(|i| (self.entry(i, i) as f32).is_normal());
        (self.rows.iter().all(is_in_range) && is_diagonal_normal).then_some(self)
    }

    pub(super) fn entry(&self, i: usize, k: usize) -> f64 {
        self.rows[i * self.row_len + k]
    }

    /// `Y` with `Y W` equal to these three rows, in their place. The error is that of substitution: `Y W` differs by at most
    /// `gamma_r |Y||W|`, entry by entry (Higham, *Accuracy and Stability*, theorem 8.5).
    #[inline(always)]
    pub(super) fn divide(&self, rows: &mut [f64]) {
        let row_len = self.row_len;
        for out in rows.chunks_exact_mut(row_len) {
            for i in 0..self.rank {
                let w = &self.rows[i * row_len..][..row_len];
                let y = out[i] / w[i];
                out[i] = y;
                let start = (i + 1) / LANES * LANES;
                // Entries left of the diagonal are zero.
                for (out, w) in out[start..].iter_mut().zip(&w[start..]).skip(i + 1 - start) {
                    *out -= y * w;
                }
            }
        }
    }

    /// The largest norm of a column, rounded up.
    pub(super) fn largest_column(&self) -> f64 {
        let square = |k: usize| (0..=k).map(|i| self.entry(i, k) * self.entry(i, k)).sum::<f64>();
        (0..self.rank).map(square).fold(0.0, f64::max).sqrt() * (1.0 + 1e-12)
    }
}
