//! The metric of q-space, stored as its diagonal or triangular factor (paper, section 6: the scaling matrix M).

use glam::DVec3;

use super::kind::MetricKind;
use super::triangular::Triangular;
use crate::Error;

/// A metric, given by its factor `S`, diagonal or upper triangular: `M = S'S`, scaled coordinates `z = S q`,
/// scaled modes `A = U S^-1`. The factor itself is stored, not M: the length of q is `|S q|`, never `sqrt(q'Mq)`,
/// which loses half the digits when weights differ much.
#[derive(Clone, Debug, PartialEq)]
pub struct Metric {
    kind: MetricKind,
    pub(super) factor: Factor,
}

/// The factor `S`.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Factor {
    /// One positive number for each mode.
    Diagonal(Vec<f64>),
    /// An upper triangular matrix with a positive diagonal.
    Triangular(Triangular),
}

impl Metric {
    /// Returns the metric whose weights are all 1.
    pub fn identity(rank: usize) -> Self {
        Self::diagonal(MetricKind::Identity, vec![1.0; rank])
    }

    /// Creates a metric with the given factor: `scales[k]` is the root of the weight of mode k.
    ///
    /// # Errors
    /// When there are no scales, or a scale is not positive and finite.
    pub fn from_scales(kind: MetricKind, scales: Vec<f64>) -> Result<Self, Error> {
        if scales.is_empty() {
            return Err(Error::RankZero);
        }
        match scales.iter().position(|s| !(s.is_finite() && *s > 0.0)) {
            Some(index) => Err(Error::MetricWeight { index, value: scales[index] }),
            None => Ok(Self::diagonal(kind, scales)),
        }
    }

    /// Creates a metric with the given weights, the diagonal of `M` (paper, section 4).
    ///
    /// # Errors
    /// When there are no weights, or a weight is not positive and finite.
    pub fn from_weights(kind: MetricKind, weights: &[f64]) -> Result<Self, Error> {
        if let Some(index) = weights.iter().position(|w| !(w.is_finite() && *w > 0.0)) {
            return Err(Error::MetricWeight { index, value: weights[index] });
        }
        Self::from_scales(kind, weights.iter().map(|w| w.sqrt()).collect())
    }

    /// Creates a metric with the given dense matrix `M` (r x r, by rows). Its factor is the transposed Cholesky factor.
    ///
    /// # Errors
    /// When M is not square, not symmetric up to rounding (1e-9) or not positive definite, or as
    /// [`Metric::from_factor`].
    pub fn from_matrix(kind: MetricKind, rank: usize, matrix: &[f64]) -> Result<Self, Error> {
        let factor = Factor::Triangular(Triangular::cholesky(rank, matrix)?);
        Ok(Self { kind, factor })
    }

    /// Creates a metric with the given upper triangular factor `S` (r x r, by rows, zeros below the diagonal).
    ///
    /// # Errors
    /// When there are no modes or more than 1024, the factor is not square or not upper triangular, an entry is beyond
    /// 2^200, a diagonal entry is not positive or below 2^-200, or the factor is nearly singular (condition beyond
    /// about 2e15 / (r + 8), the square of this for M).
    pub fn from_factor(kind: MetricKind, rank: usize, factor: Vec<f64>) -> Result<Self, Error> {
        Ok(Self { kind, factor: Factor::Triangular(Triangular::new(rank, factor)?) })
    }

    pub(super) fn diagonal(kind: MetricKind, scales: Vec<f64>) -> Self {
        Self { kind, factor: Factor::Diagonal(scales) }
    }

    /// Returns the origin of the factor.
    pub fn kind(&self) -> MetricKind {
        self.kind
    }

    /// Returns the number of modes r.
    pub fn rank(&self) -> usize {
        match &self.factor {
            Factor::Diagonal(scales) => scales.len(),
            Factor::Triangular(factor) => factor.rank(),
        }
    }

    /// Returns the diagonal of the factor `S`, one positive number for each mode.
    pub fn scales(&self) -> Vec<f64> {
        match &self.factor {
            Factor::Diagonal(scales) => scales.clone(),
            Factor::Triangular(factor) => factor.diagonal().collect(),
        }
    }

    /// Returns the factor `S` of a dense metric (r x r, by rows); `None` if it is diagonal.
    pub fn dense_factor(&self) -> Option<&[f64]> {
        match &self.factor {
            Factor::Diagonal(_) => None,
            Factor::Triangular(factor) => Some(factor.entries()),
        }
    }

    /// Returns `q = S^-1 z`, rounded to nearest.
    ///
    /// # Errors
    /// When the length of z is not the number of modes.
    pub fn unscaled(&self, z: &[f64]) -> Result<Vec<f64>, Error> {
        self.check_len(z)?;
        Ok(self.unscale(z))
    }

    /// Returns `S^-1 z` as [`Metric::unscaled`], for a z that has one entry for each mode.
    pub(crate) fn unscale(&self, z: &[f64]) -> Vec<f64> {
        match &self.factor {
            Factor::Diagonal(scales) => z.iter().zip(scales).map(|(z, s)| z / s).collect(),
            Factor::Triangular(factor) => factor.solve(z),
        }
    }

    /// Returns `z = S q`, rounded to nearest.
    pub(crate) fn scaled(&self, q: &[f64]) -> Vec<f64> {
        match &self.factor {
            Factor::Diagonal(scales) => q.iter().zip(scales).map(|(q, s)| q * s).collect(),
            Factor::Triangular(factor) => factor.product(q),
        }
    }

    /// Writes the scaled modes of one vertex, `A = U S^-1`, to `out`: one vector for each mode. Errors are within
    /// `gamma_r |A||S||S^-1|`.
    pub(crate) fn scaled_modes(&self, modes: &[DVec3], out: &mut [DVec3]) {
        match &self.factor {
            Factor::Diagonal(scales) => {
                out.iter_mut().zip(modes).zip(scales).for_each(|((a, u), s)| *a = *u / *s);
            }
            Factor::Triangular(factor) => factor.divide(modes, out),
        }
    }

    /// Computes an upper bound of `|A||S||S^-1|`, mode by mode (`|A|` if the factor is diagonal). The error of positions at z
    /// is at most `gamma |z|` times this bound, component by component.
    pub(crate) fn magnitudes(&self, scaled: &[DVec3], out: &mut [DVec3]) {
        match &self.factor {
            Factor::Diagonal(_) => out.iter_mut().zip(scaled).for_each(|(m, a)| *m = a.abs()),
            Factor::Triangular(factor) => with_mutant!(
                factor.magnitudes(scaled, out),
                DenseRateOfModesAlone,
                out.iter_mut().zip(scaled).for_each(|(m, a)| *m = a.abs()),
            ),
        }
    }

    /// Returns `|S e_k|`, the length of a unit of mode k, rounded to nearest.
    pub(crate) fn mode_length(&self, k: usize) -> f64 {
        match &self.factor {
            Factor::Diagonal(scales) => scales[k],
            Factor::Triangular(factor) => factor.column_length(k),
        }
    }
}
