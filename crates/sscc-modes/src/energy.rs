//! Energy metric, and a filter for its weights (paper, section 6).

use sscc::{Metric, MetricKind};

use crate::ModesError;

/// The paper's `ell` for [`filter_eigenvalues`]: filtered weights are at most 100 times the smallest positive
/// eigenvalue.
pub const DEFAULT_ELL: f64 = 100.0;

/// Limits the weights of very stiff modes, which would dominate `|z|` and weaken certificates:
/// `lambda -> (1 / lambda + 1 / (ell lambda_min))^-1`, where `lambda_min` is the smallest positive eigenvalue. Soft modes
/// hardly change (`lambda_min` itself by a factor of `ell / (ell + 1)`), and no result exceeds `ell lambda_min`. The order
/// is preserved, and 0 stays 0. The paper uses [`DEFAULT_ELL`].
///
/// # Errors
/// When an eigenvalue or `ell` is not finite, an eigenvalue is negative, or `ell` is not positive.
pub fn filter_eigenvalues(eigenvalues: &[f64], ell: f64) -> Result<Vec<f64>, ModesError> {
    if !(ell.is_finite() && ell > 0.0) {
        return Err(ModesError::Ell { value: ell });
    }
    let Some(smallest) = smallest_positive(eigenvalues)? else {
        return Ok(vec![0.0; eigenvalues.len()]);
    };
    let ceiling = ell * smallest;
    // The formula with the smaller value factored out, so that no quotient overflows.
    let filter = |x: f64| match (x.min(ceiling), x.max(ceiling)) {
        (small, large) if small > 0.0 => small / (1.0 + small / large),
        _ => 0.0,
    };
    Ok(eigenvalues.iter().map(|x| filter(*x)).collect())
}

/// Returns the diagonal metric `M = Lambda / 2` for modes with a diagonal stiffness: `|z|^2 = q'Mq` is the linear elastic
/// strain energy at q, for q in the coordinates of [`DiagonalModes::modes`](crate::DiagonalModes). With filtered
/// eigenvalues it is smaller for stiff modes.
///
/// A metric needs positive weights. A mode without energy (eigenvalue 0: a rigid motion) therefore gets the smallest
/// weight of the others, or 1 if no mode has energy; `|z|^2` then exceeds the energy for motions with this mode.
/// Certificates hold under any metric.
///
/// # Errors
/// When there are no eigenvalues, or one is negative, not finite, or so small that its half is 0.
pub fn energy_metric(eigenvalues: &[f64]) -> Result<Metric, ModesError> {
    let fill = smallest_positive(eigenvalues)?.map_or(1.0, |smallest| smallest / 2.0);
    let weights: Vec<f64> = eigenvalues.iter().map(|x| if *x > 0.0 { x / 2.0 } else { fill }).collect();
    Ok(Metric::from_weights(MetricKind::Energy, &weights)?)
}

/// Returns the smallest positive eigenvalue; None if all are 0.
///
/// # Errors
/// When one is negative or not finite.
fn smallest_positive(eigenvalues: &[f64]) -> Result<Option<f64>, ModesError> {
    if let Some(index) = eigenvalues.iter().position(|x| !(x.is_finite() && *x >= 0.0)) {
        return Err(ModesError::Eigenvalue { index, value: eigenvalues[index] });
    }
    Ok(eigenvalues.iter().copied().filter(|x| *x > 0.0).reduce(f64::min))
}
