//! Bounds of the changes of the numbers of local certificates with z, for proofs that hold at all z of a region.

use crate::certificates::{EllipsoidBlocks, FactorScales, LocalCertificates, gradient_len};
use crate::vectors::LANES;

/// Certificates with more modes have a coarser bound, which takes less time.
const MOST_MODES: usize = 64;

/// Covers rounding: eighth powers of singular values that sum up to more than 1e-8 err by less than 1e-12.
const ROUND_UP: f64 = 1.0 + 1e-6;

/// The squares of smaller norms lose digits to underflow.
const SMALLEST: f64 = 1e-140;

/// Upper bounds of changes of the numbers of local certificates for each unit of `|z|`.
#[derive(Clone)]
pub(super) struct RegionRates {
    /// The rate of the sum of the magnitudes of all factors.
    pub(super) sum: f64,
    pub(super) certificates: Vec<CertificateRates>,
}

/// The rates of one certificate. A certificate with infinite rates proves nothing.
#[derive(Clone, Copy)]
pub(super) struct CertificateRates {
    /// The rate of F, in the Frobenius norm.
    pub(super) map: f64,
    /// The rate of `W f`.
    pub(super) strain: f64,
}

impl RegionRates {
    /// Computes the rates in a diagonal metric. `scales`: the factor of the metric for each mode.
    pub(super) fn new(local: &LocalCertificates, factors: &FactorScales, scales: &[f64]) -> Self {
        // A unit of z in mode k changes the factor by this.
        let units: Vec<f64> = factors.sizes.iter().zip(scales).map(|(size, scale)| size / scale).collect();
        let (mut gradients, mut ellipsoids) = (&local.gradients[..], &local.ellipsoids[..]);
        let certificates = local.mode_starts.windows(2).map(|range| {
            let modes = &local.modes[range[0] as usize..range[1] as usize];
            let count = modes.len();
            let units: Vec<f64> = modes.iter().map(|k| units[*k as usize]).collect();
            let (gradient, rest) = gradients.split_at(gradient_len(count));
            gradients = rest;
            let (ellipsoid, rest) = ellipsoids.split_at(EllipsoidBlocks(count).len());
            ellipsoids = rest;
            CertificateRates {
                map: singular_value_bound(&gradient_rows(gradient, &units), count),
                strain: singular_value_bound(&ellipsoid_rows(ellipsoid, &units), count),
            }
        });
        let certificates = certificates.collect();
        Self { sum: norm(&units), certificates }
    }
}

/// Returns nine rows: an entry of G for each mode, times the mode's unit.
fn gradient_rows(gradient: &[f32], units: &[f64]) -> Vec<f64> {
    let count = units.len();
    let entry =
        |e: usize, k: usize| if e < LANES { gradient[LANES * k + e] } else { gradient[LANES * count + k] };
    (0..=LANES).flat_map(|e| (0..count).map(move |k| f64::from(entry(e, k)) * units[k])).collect()
}

/// Returns the rows of W, each column times the mode's unit.
fn ellipsoid_rows(ellipsoid: &[u16], units: &[f64]) -> Vec<f64> {
    let count = units.len();
    let mut rows = vec![0.0; count * count];
    let mut numbers = ellipsoid.chunks_exact(LANES);
    for (block, columns) in EllipsoidBlocks(count).columns().enumerate() {
        for (k, column) in columns.zip(&mut numbers) {
            for (i, half) in (LANES * block..count).zip(column) {
                rows[i * count + k] = f64::from(f32::from_bits(u32::from(*half) << 16)) * units[k];
            }
        }
    }
    rows
}

/// Returns an upper bound of the largest singular value of a matrix of rows of this length; infinite if an entry is not finite.
/// The eighth power of the singular value is at most the trace of the fourth power of the Gram matrix.
fn singular_value_bound(rows: &[f64], len: usize) -> f64 {
    let frobenius = norm(rows);
    if with_mutant!(
        !(frobenius > SMALLEST && frobenius < f64::INFINITY),
        RegionRatesUnderflow,
        frobenius == 0.0
    ) {
        return if rows.iter().all(|x| *x == 0.0) { 0.0 } else { f64::INFINITY };
    }
    if len > MOST_MODES {
        return frobenius;
    }
    // Scales all entries to magnitudes of at most 1.
    let rows: Vec<f64> = rows.iter().map(|x| x / frobenius).collect();
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    // The Gram matrix of the rows has the same eigenvalues as that of the columns, apart from zeros.
    let gram = |rows: &[f64], len: usize| -> Vec<f64> {
        rows.chunks_exact(len).flat_map(|x| rows.chunks_exact(len).map(move |y| dot(x, y))).collect()
    };
    let square = gram(&rows, len);
    let size = rows.len() / len;
    // It is symmetric: its square is the Gram matrix of its rows.
    let fourth = gram(&square, size);
    let trace = fourth.iter().map(|x| x * x).sum::<f64>();
    trace.sqrt().sqrt().sqrt() * frobenius * ROUND_UP
}

/// Returns the Euclidean norm, rounded up.
fn norm(numbers: &[f64]) -> f64 {
    numbers.iter().map(|x| x * x).sum::<f64>().sqrt() * ROUND_UP
}

#[cfg(test)]
mod tests {
    use sscc_testing::Numbers;

    use super::*;

    /// The matrices are wide or tall, of rank one or more, with large, small and out-of-range entries.
    #[test]
    fn singular_values_are_bounded() {
        let random = &mut Numbers(8);
        let mut close = 0;
        let shapes = [(9, 1), (9, 8), (9, 64), (9, 65), (1, 1), (8, 8), (9, 9), (64, 64), (65, 65)];
        for (case, (size, len)) in shapes.into_iter().cycle().take(90).enumerate() {
            let scale = random.power(-100.0, 100.0);
            let mut rows = vec![0.0; size * len];
            for _ in 0..1 + random.below(3) {
                let x: Vec<f64> = (0..size).map(|_| random.signed()).collect();
                let y: Vec<f64> = (0..len).map(|_| random.signed()).collect();
                for (row, x) in rows.chunks_mut(len).zip(&x) {
                    row.iter_mut().zip(&y).for_each(|(out, y)| *out += x * y * scale);
                }
            }
            // The power iteration approximates the largest singular value from below.
            let mut way: Vec<f64> = (0..len).map(|_| random.signed()).collect();
            let mut longest = 0.0;
            for _ in 0..300 {
                let length = norm(&way);
                let of_row = |row: &[f64]| row.iter().zip(&way).map(|(a, x)| a / scale * (x / length)).sum();
                let image: Vec<f64> = rows.chunks(len).map(of_row).collect();
                longest = norm(&image) / ROUND_UP * (1.0 - 1e-9) * scale;
                let back = |k: usize| rows.chunks(len).zip(&image).map(|(row, y)| row[k] / scale * y).sum();
                way = (0..len).map(back).collect();
            }
            let bound = singular_value_bound(&rows, len);
            assert!(longest <= bound, "case {case}: {longest} {bound}");
            close += usize::from(bound < 1.2 * longest);
        }
        assert!(close > 60, "{close}");
        assert_eq!(singular_value_bound(&[], 0), 0.0);
        assert_eq!(singular_value_bound(&[0.0; 18], 2), 0.0);
        for out_of_range in [1e-150, 1e200, f64::INFINITY, f64::NAN] {
            assert_eq!(singular_value_bound(&[out_of_range; 18], 2), f64::INFINITY);
        }
    }

    #[test]
    fn rows_are_the_entries_of_each_mode_and_norms_are_rounded_up() {
        let gradient: Vec<f32> = (0..32).map(|i| i as f32).collect();
        let units = [1.0, 2.0, 4.0];
        let entry = |e: usize, k: usize| if e < 8 { 8 * k + e } else { 24 + k };
        let expected: Vec<f64> =
            (0..9).flat_map(|e| (0..3).map(move |k| entry(e, k) as f64 * units[k])).collect();
        assert_eq!(gradient_rows(&gradient, &units), expected);
        for bound in [norm(&[3.0, 4.0]), singular_value_bound(&[3.0, 4.0], 1)] {
            assert!((5.0..5.0 * (1.0 + 3e-6)).contains(&bound), "{bound}");
        }
    }
}
