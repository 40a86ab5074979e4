//! Natural frequencies of a model with a stiffness.

use std::f64::consts::TAU;

use sscc_solid::Stiffness;

use crate::{ModesError, stiffness_eigenvalues};

/// Maximum magnitude of a negative eigenvalue, relative to the largest entry, that counts as 0, because it may be
/// rounding.
const ZERO_TOLERANCE: f64 = 1e-12;

/// Returns the natural frequencies (Hz) of mass-orthonormal modes: in the order of the modes if the stiffness is
/// diagonal, else ascending.
///
/// # Errors
/// When an eigenvalue is below -1e-12 of the largest entry (the model is not at rest), or the eigenvalues do not
/// converge.
pub fn natural_frequencies(stiffness: &Stiffness) -> Result<Vec<f64>, ModesError> {
    let eigenvalues = match stiffness.is_diagonal() {
        true => stiffness.diagonal().collect(),
        false => stiffness_eigenvalues(stiffness)?,
    };
    roots(&eigenvalues, stiffness).ok_or_else(|| {
        let eigenvalue = eigenvalues.iter().copied().fold(f64::INFINITY, f64::min);
        let largest = eigenvalues.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        ModesError::StiffnessIndefinite { eigenvalue, largest }
    })
}

/// Returns the frequency (Hz) of each mode; None if the stiffness is not diagonal (modes are coupled), or an eigenvalue
/// is below -1e-12 of the largest entry.
pub fn mode_frequencies(stiffness: &Stiffness) -> Option<Vec<f64>> {
    if !stiffness.is_diagonal() {
        return None;
    }
    roots(&stiffness.diagonal().collect::<Vec<_>>(), stiffness)
}

fn roots(eigenvalues: &[f64], stiffness: &Stiffness) -> Option<Vec<f64>> {
    let noise = ZERO_TOLERANCE * stiffness.largest();
    eigenvalues.iter().map(|x| (*x >= -noise).then(|| x.max(0.0).sqrt() / TAU)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frequencies_are_roots_of_eigenvalues() {
        let stiffness = |entries: &[f64]| Stiffness::new(2, entries.to_vec()).unwrap();
        let of = |entries: &[f64]| natural_frequencies(&stiffness(entries));
        let four = (2.0 * TAU) * (2.0 * TAU);
        assert_eq!(of(&[four, 0.0, 1e-14, 0.0]).unwrap(), [2.0, 0.0]);
        assert_eq!(mode_frequencies(&stiffness(&[four, 0.0, 0.0, 0.0])).unwrap(), [2.0, 0.0]);
        assert_eq!(mode_frequencies(&stiffness(&[2.0, -1.0, -1.0, 2.0])), None);
        let dense = of(&[2.0, -1.0, -1.0, 2.0]).unwrap();
        assert!((dense[0] * TAU - 1.0).abs() < 1e-12 && (dense[1] * TAU - 3.0_f64.sqrt()).abs() < 1e-12);
        // Rounding gives the 0 of a rigid motion either sign; the eigenvalues of a buckled body are far below 0.
        assert_eq!(of(&[-1e-14, 0.0, 0.0, 1.0]).unwrap()[0], 0.0);
        let buckled = of(&[1.0, 2.0, 2.0, 1.0]).unwrap_err();
        assert!(matches!(buckled, ModesError::StiffnessIndefinite { .. }), "{buckled}");
        assert!(buckled.to_string().starts_with("the stiffness has the eigenvalue -1"), "{buckled}");
        assert!(matches!(
            of(&[-1.0, 0.0, 0.0, 4.0]),
            Err(ModesError::StiffnessIndefinite { largest: 4.0, .. })
        ));
    }
}
