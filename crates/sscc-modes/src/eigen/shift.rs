//! Shift that makes the stiffness of a free body positive definite.

use super::lanczos::{ShiftInvert, estimate_largest};
use super::space::Space;
use super::tall_matrix::Random;
use crate::ModesError;
use crate::sparse::{Analysis, BlockSparse, Cholesky};

/// First shift, relative to the mean eigenvalue. It is far above rounding, which gives rigid motions about 1e-15 of the largest
/// eigenvalue, and far below the lowest eigenvalue of a compact body of a million vertices, about 1e-5
/// of the mean one.
const FIRST_SHIFT: f64 = 1e-8;

/// Shift for slender bodies, whose eigenvalues are lower, relative to the lowest eigenvalue.
const SHIFT_SHARE: f64 = 0.1;

/// Minimum shift, relative to the mean eigenvalue; lower shifts are close to rounding.
const MIN_SHIFT: f64 = 1e-12;

/// Maximum eigenvalue of a motion without energy, relative to the mean eigenvalue. Rounding gives about 1e-14; the
/// lowest eigenvalues of slender springs are about 1e-9.
const ZERO_TOLERANCE: f64 = 1e-12;

/// Factor of a shifted stiffness.
pub(super) struct ShiftedFactor {
    /// The factor of `K + s M`.
    pub factor: Cholesky,
    /// The shift s.
    pub shift: f64,
}

/// Returns the eigenvalue up to which eigenvalues are 0 up to rounding.
pub(super) fn negligible(stiffness: &BlockSparse, mass: &BlockSparse) -> f64 {
    ZERO_TOLERANCE * stiffness.trace() / mass.trace()
}

/// Factors `K + s M` if the lowest eigenvalue without rigid motions is known.
pub(super) fn factor_below(
    stiffness: &BlockSparse,
    mass: &BlockSparse,
    analysis: &Analysis,
    rigid: usize,
    lowest: f64,
) -> Result<ShiftedFactor, ModesError> {
    let mean = stiffness.trace() / mass.trace();
    let shift =
        if rigid == 0 { 0.0 } else { (SHIFT_SHARE * lowest).min(FIRST_SHIFT * mean).max(MIN_SHIFT * mean) };
    let factor = analysis.factor(&stiffness.combined(1.0, mass, shift))?;
    Ok(ShiftedFactor { factor, shift })
}

/// Factors `K + s M`. Without rigid motions s is 0, unless K is not positive definite.
pub(super) fn factor_shifted(
    stiffness: &BlockSparse,
    space: &Space,
    analysis: &Analysis,
    rigid: usize,
    random: &mut Random,
) -> Result<ShiftedFactor, ModesError> {
    let mean = stiffness.trace() / space.mass.trace();
    let with = |shift: f64| -> Result<ShiftedFactor, ModesError> {
        let factor = analysis.factor(&stiffness.combined(1.0, space.mass, shift))?;
        Ok(ShiftedFactor { factor, shift })
    };
    if rigid == 0 {
        return match with(0.0) {
            Err(ModesError::NotDefinite { .. }) => with(FIRST_SHIFT * mean),
            result => result,
        };
    }
    let first = with(FIRST_SHIFT * mean)?;
    let operator = ShiftInvert { space, factor: &first.factor, ceiling: f64::INFINITY };
    let largest = estimate_largest(&operator, random)?;
    let lowest = 1.0 / largest - first.shift;
    // A mechanism is only counted, so the first shift is sufficient.
    if first.shift <= lowest || lowest <= negligible(stiffness, space.mass) {
        return Ok(first);
    }
    let shift = (SHIFT_SHARE * lowest).max(MIN_SHIFT * mean);
    drop(first);
    match with(shift) {
        Err(ModesError::NotDefinite { .. }) => with(FIRST_SHIFT * mean),
        result => result,
    }
}
