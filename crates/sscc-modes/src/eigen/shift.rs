//! Shift that makes the stiffness of a free body positive definite.

use super::lanczos::{ShiftInvert, estimate_largest};
use super::space::Space;
use super::tall_matrix::Random;
use crate::ModesError;
use crate::sparse::{Analysis, BlockSparse, Cholesky};

/// First shift, relative to the mean eigenvalue. It is far above rounding, which leaves about 1e-15 of the largest
/// eigenvalue in rigid motions, and far below the lowest eigenvalue of a compact body of a million vertices, about 1e-5
/// of the mean one.
const FIRST_SHIFT: f64 = 1e-8;

/// Slender bodies have lower eigenvalues: the shift is then this share of the lowest one.
const SHIFT_SHARE: f64 = 0.1;

/// Lower shifts, as a share of the mean eigenvalue, come near to rounding.
const MIN_SHIFT: f64 = 1e-12;

/// An eigenvalue of at most this share of the mean one belongs to a motion without energy. Rounding leaves about
/// 1e-14; the lowest of slender springs are about 1e-9.
const ZERO_TOLERANCE: f64 = 1e-12;

/// A stiffness made definite.
pub(super) struct ShiftedFactor {
    /// The factor of `K + s M`.
    pub factor: Cholesky,
    /// s.
    pub shift: f64,
}

/// Eigenvalues up to here are 0 but for rounding.
pub(super) fn negligible(stiffness: &BlockSparse, mass: &BlockSparse) -> f64 {
    ZERO_TOLERANCE * stiffness.trace() / mass.trace()
}

/// Factors `K + s M` where the lowest eigenvalue beside the rigid motions is known.
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

/// Factors `K + s M`. Without rigid motions s is 0, unless the body can move all the same.
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
    // Where there is a mechanism, all that remains to do is to count it.
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
