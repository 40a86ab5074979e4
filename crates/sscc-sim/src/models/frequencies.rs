//! The natural frequencies of a model with a stiffness.

use std::f64::consts::TAU;

use sscc_io::Elasticity;
use sscc_modes::symmetric_eigenvalues;

/// A stiffness counts as diagonal where no other entry exceeds this share of the largest, and an eigenvalue as 0 where
/// it is no larger: rounding leaves that much.
const ROUNDING: f64 = 1e-12;

/// Natural frequencies (Hz) of mass-orthonormal modes: of each mode where the stiffness is diagonal, else ascending.
///
/// # Errors
/// When some eigenvalue is negative, as where the model is not at rest, or the eigenvalues are not found. The message
/// says which.
pub fn frequencies(elasticity: &Elasticity) -> Result<Vec<f64>, String> {
    let eigenvalues = match diagonal(elasticity) {
        Some(diagonal) => diagonal,
        None => symmetric_eigenvalues(elasticity.rank(), elasticity.stiffness())
            .map_err(|error| error.to_string())?,
    };
    of(&eigenvalues, elasticity).ok_or_else(|| {
        let least = eigenvalues.iter().copied().fold(f64::INFINITY, f64::min);
        format!("the stiffness has the negative eigenvalue {least:e}")
    })
}

/// The frequency of each mode; none where the stiffness is not diagonal, so that modes swing together.
pub fn frequencies_of_modes(elasticity: &Elasticity) -> Option<Vec<f64>> {
    of(&diagonal(elasticity)?, elasticity)
}

fn diagonal(elasticity: &Elasticity) -> Option<Vec<f64>> {
    let (rank, stiffness) = (elasticity.rank(), elasticity.stiffness());
    let noise = ROUNDING * largest(elasticity);
    let is_off = |(at, x): (usize, &f64)| at % (rank + 1) != 0 && x.abs() > noise;
    let has_off = stiffness.iter().enumerate().any(is_off);
    (!has_off).then(|| stiffness.iter().step_by(rank + 1).copied().collect())
}

fn of(eigenvalues: &[f64], elasticity: &Elasticity) -> Option<Vec<f64>> {
    let noise = ROUNDING * largest(elasticity);
    eigenvalues.iter().map(|x| (*x >= -noise).then(|| x.max(0.0).sqrt() / TAU)).collect()
}

fn largest(elasticity: &Elasticity) -> f64 {
    elasticity.stiffness().iter().fold(0.0, |m, x| m.max(x.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_of_eigenvalues() {
        let of = |stiffness: &[f64]| frequencies(&Elasticity::Linear(stiffness.to_vec()));
        let four = (2.0 * TAU) * (2.0 * TAU);
        assert_eq!(of(&[four, 0.0, 1e-14, 0.0]).unwrap(), [2.0, 0.0]);
        assert_eq!(frequencies_of_modes(&Elasticity::Linear(vec![four, 0.0, 0.0, 0.0])).unwrap(), [2.0, 0.0]);
        assert_eq!(frequencies_of_modes(&Elasticity::Linear(vec![2.0, -1.0, -1.0, 2.0])), None);
        let dense = of(&[2.0, -1.0, -1.0, 2.0]).unwrap();
        assert!((dense[0] * TAU - 1.0).abs() < 1e-12 && (dense[1] * TAU - 3.0_f64.sqrt()).abs() < 1e-12);
        // A rigid motion's 0 is rounded to either side; a buckled body is something else.
        assert_eq!(of(&[-1e-14, 0.0, 0.0, 1.0]).unwrap()[0], 0.0);
        let buckled = of(&[1.0, 2.0, 2.0, 1.0]).unwrap_err();
        assert!(buckled.starts_with("the stiffness has the negative eigenvalue -"), "{buckled}");
    }
}
