//! Standard deviations of the entries of q, from the variances of principal components.

use sscc::Modes;

/// Largest relative difference of a squared length from a variance at which components count as scaled: their files may
/// have single precision.
const TOLERANCE: f64 = 1e-3;

/// Returns the standard deviation of each entry of q. If the squared length of each component is its variance, the
/// components are scaled already: a unit of q is one standard deviation. Else they count as of unit length, so that the
/// variance of an entry of q is that of its component. Variances below 0 come from rounding, and count as 0.
///
/// Returns None if a variance is not finite.
pub(super) fn deviations(variances: &[f64], modes: &Modes) -> Option<Vec<f64>> {
    if variances.iter().any(|variance| !variance.is_finite()) {
        return None;
    }
    let mut squared_lengths = vec![0.0; variances.len()];
    for of_vertex in modes.displacements().chunks_exact(modes.rank()) {
        for (sum, displacement) in squared_lengths.iter_mut().zip(of_vertex) {
            *sum += displacement.length_squared();
        }
    }
    let is_scaled = |(length, variance): (&f64, &f64)| (length - variance).abs() <= TOLERANCE * variance;
    if squared_lengths.iter().zip(variances).all(is_scaled) {
        return Some(vec![1.0; variances.len()]);
    }
    Some(variances.iter().map(|variance| variance.max(0.0).sqrt()).collect())
}
