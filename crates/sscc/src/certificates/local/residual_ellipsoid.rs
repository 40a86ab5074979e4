//! The ellipsoid of a patch's residuals: an upper triangular W such that `|(E_j - E_i) f| <= s_ij kappa |W f|`.
//!
//! Any W is valid, because `strain_search` finds its ratios. This W approximates the smallest volume for some pairs (Khachiyan's
//! iteration, which is multiplicative). Its entries are upper halves of single-precision numbers, as they are stored.

use super::local_certificates::EllipsoidBlocks;
use crate::model::mode_rows::LANES;
use crate::vectors::{Kernel, Vectors};

/// The number of steps of the iteration.
const STEPS: usize = 2;

/// The number that is added to the diagonal, relative to the trace. It makes W invertible; a motion without residuals still has a
/// small `W f`.
const FLOOR: f64 = 1e-4;

/// The number of columns whose sums are in registers. Rows are padded to whole blocks.
const BLOCK: usize = crate::vectors::LANES;

/// The smallest trace, so that W is in the range of single precision.
const SMALLEST: f64 = 1e-20;

/// An upper triangular matrix, by rows.
#[derive(Clone)]
pub(super) struct ResidualEllipsoid {
    rank: usize,
    row_len: usize,
    rows: Vec<f64>,
    /// The inverse of the matrix, up to rounding.
    inverse: Vec<f64>,
}

/// Fits the ellipsoid to blocks of three rows each. None if numbers are out of range.
pub(super) struct FitEllipsoid<'b> {
    pub(super) blocks: &'b [f64],
    pub(super) rank: usize,
    pub(super) row_len: usize,
}

impl Kernel for FitEllipsoid<'_> {
    type Output = Option<ResidualEllipsoid>;

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) -> Option<ResidualEllipsoid> {
        let Self { blocks, rank, row_len } = self;
        let count = blocks.len() / (3 * row_len);
        let block = |i: usize| &blocks[3 * row_len * i..][..3 * row_len];
        let mut weights = vec![1.0 / count.max(1) as f64; count];
        let mut ellipsoid = ResidualEllipsoid::of_weighted(blocks, &weights, rank, row_len)?;
        let mut image = vec![0.0; 3 * row_len];
        for _ in 0..STEPS {
            for (i, weight) in weights.iter_mut().enumerate() {
                image.copy_from_slice(block(i));
                ellipsoid.divide(&mut image);
                *weight *= image.iter().map(|x| x * x).sum::<f64>();
            }
            let sum: f64 = weights.iter().sum();
            if !sum.is_normal() {
                break;
            }
            weights.iter_mut().for_each(|weight| *weight /= sum);
            ellipsoid = ResidualEllipsoid::of_weighted(blocks, &weights, rank, row_len)?;
        }
        ellipsoid.round()
    }
}

impl ResidualEllipsoid {
    /// Returns the Cholesky factor of the weighted sum of Gram matrices.
    #[inline(always)]
    fn of_weighted(blocks: &[f64], weights: &[f64], rank: usize, row_len: usize) -> Option<Self> {
        let mut rows = vec![0.0; rank * row_len];
        for (block, weight) in blocks.chunks_exact(3 * row_len).zip(weights) {
            let [x, y, z] = [0, 1, 2].map(|c| &block[c * row_len..][..row_len]);
            for i in 0..rank {
                let [a, b, c] = [weight * x[i], weight * y[i], weight * z[i]];
                let start = i / LANES * LANES;
                let out = &mut rows[i * row_len + start..][..row_len - start];
                for (((out, x), y), z) in out.iter_mut().zip(&x[start..]).zip(&y[start..]).zip(&z[start..]) {
                    *out += a * x + b * y + c * z;
                }
            }
        }
        let trace = (0..rank).map(|i| rows[i * row_len + i]).sum::<f64>().max(SMALLEST);
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
        Some(Self { rank, row_len, rows, inverse: Vec::new() }.invert())
    }

    /// Rounds the entries to numbers that can be stored. None if they are out of range.
    #[inline(always)]
    fn round(mut self) -> Option<Self> {
        self.rows.iter_mut().for_each(|x| *x = f64::from(upper_half_number(upper_half(*x as f32))));
        let is_in_range = |x: &f64| x.abs() < 1e15;
        let is_diagonal_normal = (0..self.rank).all(|i| (self.entry(i, i) as f32).is_normal());
        (self.rows.iter().all(is_in_range) && is_diagonal_normal).then(|| self.invert())
    }

    fn entry(&self, i: usize, k: usize) -> f64 {
        self.rows[i * self.row_len + k]
    }

    /// Adds the inverse Z, row by row from the last.
    #[inline(always)]
    fn invert(mut self) -> Self {
        let Self { rank, row_len, ref rows, .. } = self;
        let mut inverse = vec![0.0; rank * row_len];
        for i in (0..rank).rev() {
            let w = &rows[i * row_len..][..row_len];
            let (before, after) = inverse.split_at_mut((i + 1) * row_len);
            let row = &mut before[i * row_len..];
            row[i] = 1.0;
            for j in i + 1..rank {
                let start = j / LANES * LANES;
                let other = &after[(j - i - 1) * row_len..][..row_len];
                row[start..].iter_mut().zip(&other[start..]).for_each(|(out, z)| *out -= w[j] * z);
            }
            row.iter_mut().for_each(|x| *x /= w[i]);
        }
        self.inverse = inverse;
        self
    }

    /// Replaces these rows Y, three for each vertex, by `Y Z`, which is close to the rows divided by W ([`Self::defect`]).
    #[inline(always)]
    pub(super) fn divide(&self, rows: &mut [f64]) {
        let row_len = self.row_len;
        for rows in rows.chunks_exact_mut(3 * row_len) {
            // The last columns are computed first, because the columns before them do not depend on them.
            for first in (0..row_len).step_by(BLOCK).rev() {
                let mut sums = [[0.0; BLOCK]; 3];
                for i in 0..self.rank.min(first + BLOCK) {
                    #[expect(clippy::expect_used, reason = "rows are whole blocks")]
                    let z: &[f64; BLOCK] =
                        self.inverse[i * row_len + first..].first_chunk().expect("whole rows");
                    for (c, sums) in sums.iter_mut().enumerate() {
                        let y = rows[c * row_len + i];
                        sums.iter_mut().zip(z).for_each(|(sum, z)| *sum += y * z);
                    }
                }
                for (c, sums) in sums.iter().enumerate() {
                    rows[c * row_len + first..][..BLOCK].copy_from_slice(sums);
                }
            }
        }
    }

    /// Returns an upper bound of `|(Y Z)_computed W - Y| / |Y|` in Frobenius norms: that of `Z W - I`, as computed, and the
    /// rounding of both products, each at most `gamma_r |Z||W|`.
    pub(super) fn defect(&self) -> f64 {
        let Self { rank, row_len, rows, inverse } = self;
        let mut square = 0.0;
        for i in 0..*rank {
            let mut row = vec![0.0; *row_len];
            row[i] = -1.0;
            for j in i..*rank {
                let z = inverse[i * row_len + j];
                row.iter_mut().zip(&rows[j * row_len..][..*row_len]).for_each(|(out, w)| *out += z * w);
            }
            square += row.iter().map(|x| x * x).sum::<f64>();
        }
        let frobenius = |numbers: &[f64]| numbers.iter().map(|x| x * x).sum::<f64>().sqrt();
        let rounding = 4.0 * (*rank as f64 + 4.0) * f64::EPSILON * frobenius(inverse) * frobenius(rows);
        square.sqrt() * (1.0 + 1e-9) + with_mutant!(rounding, LocalImagesExact, 0.0)
    }

    /// Returns the largest norm of a column, rounded up.
    pub(super) fn largest_column(&self) -> f64 {
        let square = |k: usize| (0..=k).map(|i| self.entry(i, k) * self.entry(i, k)).sum::<f64>();
        (0..self.rank).map(square).fold(0.0, f64::max).sqrt() * (1.0 + 1e-12)
    }

    /// Returns the numbers as they are stored, in the layout of [`EllipsoidBlocks`].
    pub(super) fn numbers(&self) -> impl Iterator<Item = u16> {
        let lanes = crate::vectors::LANES;
        EllipsoidBlocks(self.rank).columns().flat_map(move |columns| {
            let first = columns.start;
            columns.flat_map(move |k| {
                (first..first + lanes)
                    .map(move |i| if i < self.rank { upper_half(self.entry(i, k) as f32) } else { 0 })
            })
        })
    }
}

/// Returns the upper half of a finite number, rounded to nearest.
fn upper_half(x: f32) -> u16 {
    let bits = x.to_bits();
    ((bits + 0x7fff + (bits >> 16 & 1)) >> 16) as u16
}

fn upper_half_number(half: u16) -> f32 {
    f32::from_bits(u32::from(half) << 16)
}

#[cfg(test)]
mod tests;
