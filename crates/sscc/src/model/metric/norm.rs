//! The length `|S q|` of q, rounded up.
//!
//! Squares of extreme entries overflow or underflow; only in that case all entries are first divided by the largest one.

use super::metric::{Factor, Metric};
use crate::Error;

/// If the largest number is in this range, squares do not overflow, and their underflow is negligible: the largest
/// square is at least 1e-280, and the others lose at most r 2^-1074.
const SAFE_TO_SQUARE: std::ops::Range<f64> = 1e-140..1e140;

/// The same range for the sum of squares.
const SAFE_SUM: std::ops::Range<f64> = 1e-280..1e280;

impl Metric {
    /// Returns `|S q|`, rounded up: never less than the exact length of the given q. Infinite if it overflows or is NaN. (For
    /// radii about a centre see [`Certificates::norm`](crate::Certificates::norm).)
    ///
    /// # Errors
    /// When the length of q is not the number of modes.
    pub fn norm(&self, q: &[f64]) -> Result<f64, Error> {
        self.check_len(q)?;
        Ok(self.length(q))
    }

    /// Returns the norm as [`Metric::norm`], for a q that has one entry for each mode.
    pub(crate) fn length(&self, q: &[f64]) -> f64 {
        debug_assert_eq!(q.len(), self.rank(), "one number for each mode");
        match &self.factor {
            Factor::Diagonal(scales) => diagonal_norm(scales, q),
            Factor::Triangular(factor) => norm_of(|| factor.products_up(q), q.len()),
        }
    }

    /// Checks the length of q.
    ///
    /// # Errors
    /// When the length of q is not the number of modes.
    pub(crate) fn check_len(&self, q: &[f64]) -> Result<(), Error> {
        let (found, rank) = (q.len(), self.rank());
        if found == rank { Ok(()) } else { Err(Error::CoordinatesLength { found, rank }) }
    }

    /// Returns `|S (q - center)|`, rounded up; `offset` is scratch of r entries. The difference is rounded once,
    /// relative to itself; the 16 units in the last place of [`up`] cover that.
    pub(crate) fn norm_from(&self, q: &[f64], center: &[f64], offset: &mut [f64]) -> f64 {
        offset.iter_mut().zip(q).zip(center).for_each(|((d, q), c)| *d = q - c);
        self.length(offset)
    }
}

/// Returns the factor that rounds up a root of a sum of `count` squares of products.
fn up(count: usize) -> f64 {
    with_mutant!(1.0 + (count as f64 + 16.0) * f64::EPSILON, NormToNearest, 1.0)
}

fn diagonal_norm(scales: &[f64], q: &[f64]) -> f64 {
    // There are four partial sums; [`up`] covers any order of summation.
    let mut lanes = [0.0_f64; 4];
    let (scale_chunks, scale_rest) = scales.as_chunks::<4>();
    let (chunks, rest) = q.as_chunks::<4>();
    for (s, x) in scale_chunks.iter().zip(chunks) {
        for i in 0..4 {
            let z = s[i] * x[i];
            lanes[i] += z * z;
        }
    }
    let last: f64 = scale_rest.iter().zip(rest).map(|(s, x)| (s * x) * (s * x)).sum();
    let sum = (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]) + last;
    if SAFE_SUM.contains(&sum) {
        return sum.sqrt() * up(q.len());
    }
    if sum.is_nan() {
        return f64::INFINITY;
    }
    // A product that underflows is rounded up to the smallest normal number.
    let scaled = |(s, x): (&f64, &f64)| if *x == 0.0 { 0.0 } else { (s * x).abs().max(f64::MIN_POSITIVE) };
    norm_by_largest(scales.iter().zip(q).map(scaled), q.len())
}

/// Returns the norm of non-negative numbers, rounded up. `numbers` may be called twice.
fn norm_of<I: Iterator<Item = f64> + Clone>(numbers: impl Fn() -> I, count: usize) -> f64 {
    let (sum, largest) = numbers().fold((0.0, 0.0_f64), |(sum, l), z| (sum + z * z, l.max(z)));
    if SAFE_TO_SQUARE.contains(&largest) { sum.sqrt() * up(count) } else { norm_by_largest(numbers(), count) }
}

/// Returns the norm if squares would overflow or underflow: all numbers are divided by the largest one.
#[cold]
fn norm_by_largest(numbers: impl Iterator<Item = f64> + Clone, count: usize) -> f64 {
    let largest = numbers.clone().fold(0.0, f64::max);
    if largest == 0.0 || largest == f64::INFINITY {
        return largest;
    }
    let sum: f64 = numbers.map(|z| (z / largest) * (z / largest)).sum();
    largest * sum.sqrt() * up(count)
}

#[cfg(test)]
mod tests {
    use num_rational::BigRational;

    use super::*;
    use crate::MetricKind;

    #[test]
    fn norms_of_known_vectors_are_rounded_up() {
        let metric = Metric::from_scales(MetricKind::Given, vec![1e6, 1.0, 1e-6]).unwrap();
        // 1e6 * 3e-6 = 3, 4, 0
        let exact = 5.0;
        let norm = metric.length(&[3e-6, 4.0, 0.0]);
        assert!(norm >= exact && norm <= exact * (1.0 + 1e-13), "{norm}");
        assert_eq!(metric.norm_from(&[3e-6, 9.0, 1.0], &[0.0, 5.0, 1.0], &mut [0.0; 3]), norm);
        // S = [1 2; 0 4]: z = (3, 4) at q = (1, 1).
        let dense = Metric::from_factor(MetricKind::Given, 2, vec![1.0, 2.0, 0.0, 4.0]).unwrap();
        let norm = dense.length(&[1.0, 1.0]);
        assert!(norm >= exact && norm <= exact * (1.0 + 1e-13), "{norm}");
        // Products cancel here: the exact sum is 2^-52.
        let tiny = 2.0_f64.powi(-40);
        let factor = vec![1.0, 1.0, 0.0, tiny];
        let dense = Metric::from_factor(MetricKind::Given, 2, factor).unwrap();
        assert!(dense.length(&[1.0 + f64::EPSILON, -1.0]) >= f64::EPSILON);
    }

    /// Returns a generator of fixed pseudo-random numbers in [-1, 1).
    fn random() -> impl FnMut() -> f64 {
        let mut state = 1_u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        }
    }

    /// The norm is compared with the sum of squares in exact arithmetic, with dense factors whose products cancel.
    #[test]
    fn norm_is_at_least_the_exact_one() {
        let exact = |x: f64| BigRational::from_float(x).unwrap();
        let mut random = random();
        let larger = exact(1.0 + 1e-12);
        let mut cancelled = 0;
        for case in 0..1200 {
            let rank = 1 + case % 7;
            let mut q: Vec<f64> = (0..rank).map(|_| random() * 10.0_f64.powf(3.0 * random())).collect();
            let mut factor: Vec<f64> = (0..rank * rank).map(|_| random()).collect();
            for i in 0..rank {
                factor[i * rank..][..i].fill(0.0);
                factor[i * (rank + 1)] = random().abs() + 0.1;
            }
            let is_cancelling = case % 3 == 2 && rank > 1;
            if is_cancelling {
                // All rows are 0 up to rounding, and the last one is hardly larger.
                factor[rank * rank - 1] = 1e-12;
                for i in (0..rank - 1).rev() {
                    let known: f64 = (i + 1..rank).map(|j| factor[i * rank + j] * q[j]).sum();
                    q[i] = -known / factor[i * (rank + 1)];
                }
            }
            let metric = if case % 3 == 0 {
                let scales = (0..rank).map(|i| factor[i * (rank + 1)]).collect();
                (0..rank).for_each(|i| factor[i * rank + i + 1..][..rank - i - 1].fill(0.0));
                Metric::from_scales(MetricKind::Given, scales).unwrap()
            } else {
                match Metric::from_factor(MetricKind::Given, rank, factor.clone()) {
                    Ok(metric) => metric,
                    // The factor is nearly singular.
                    Err(_) => continue,
                }
            };
            let square: BigRational = (0..rank)
                .map(|i| (i..rank).map(|j| exact(factor[i * rank + j]) * exact(q[j])).sum::<BigRational>())
                .map(|row| &row * &row)
                .sum();
            let norm = exact(metric.length(&q));
            cancelled += usize::from(is_cancelling);
            assert!(&norm * &norm >= square, "case {case}: {q:?}");
            assert!(is_cancelling || &norm * &norm <= square * &larger * &larger, "case {case}: {q:?}");
        }
        assert!(cancelled > 100, "{cancelled}");
    }

    #[test]
    fn norm_survives_underflow_and_overflow() {
        let dense = Metric::from_factor(MetricKind::Given, 2, vec![1.0, 0.0, 0.0, 1.0]).unwrap();
        for metric in [Metric::identity(2), dense] {
            for x in [1e-170, 5e-324, 1e-308, 1e170, 1e300] {
                let norm = metric.length(&[x, 0.0]);
                assert!(norm >= x && norm <= 2.0 * x.max(f64::MIN_POSITIVE), "{x:e}: {norm:e}");
            }
            assert_eq!(metric.length(&[0.0, 0.0]), 0.0);
        }
        assert_eq!(Metric::identity(2).length(&[f64::NAN, 1.0]), f64::INFINITY);
        let tiny_scale = Metric::from_scales(MetricKind::Given, vec![1e-200, 1.0]).unwrap();
        assert!(tiny_scale.length(&[1e-200, 0.0]) > 0.0);
    }

    #[test]
    fn norms_of_several_extreme_entries_hold_all_of_them() {
        let dense = |s: f64| Metric::from_factor(MetricKind::Given, 2, vec![s, 0.0, 0.0, 1.0]).unwrap();
        for metric in [Metric::identity(2), dense(1.0)] {
            for x in [1e-250, 1e-170, 1e170, 1e300] {
                let norm = metric.length(&[3.0 * x, 4.0 * x]);
                assert!(norm >= 5.0 * x && norm <= 5.0 * x * (1.0 + 1e-12), "{x:e}: {norm:e}");
            }
            assert!(metric.norm(&[1.0]).is_err() && metric.norm(&[1.0; 3]).is_err());
        }
        // The product underflows, but the coordinate is not 0.
        let norm = dense(2.0_f64.powi(-199)).length(&[1e-300, 0.0]);
        assert!(norm > 0.0 && norm <= 1e-300, "{norm:e}");
        for bad in [0.0, -1.0, f64::INFINITY, f64::NAN] {
            assert!(Metric::from_scales(MetricKind::Given, vec![1.0, bad]).is_err(), "{bad}");
        }
    }
}
