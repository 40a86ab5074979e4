//! The check that a thread computes as all proofs assume: it rounds to nearest, and numbers underflow gradually.
//!
//! A host can change the floating-point mode of a thread: audio threads often flush small numbers to zero. Then rounding
//! bounds are too small, and a difference of two positions may be 0 though they differ. Meshes, certificates, queries,
//! detectors and shapes check the mode when they are made, and so does every search; a query that the root's radius answers
//! does not, so that it stays one comparison.

use std::hint::black_box;

use crate::Error;

/// Refuses a thread whose floating-point mode is not that of the proofs. No operand is a subnormal number but that of one
/// comparison, since some processors take much longer for those.
///
/// # Errors
/// [`Error::Arithmetic`].
#[inline]
pub(crate) fn check_arithmetic() -> Result<(), Error> {
    let [one, half_unit, smallest] = black_box([1.0, 0.5 * f64::EPSILON, f64::MIN_POSITIVE]);
    // Computed here and nowhere else, whatever the compiler knows of other modes.
    let [tie, above_tie, subnormal] =
        black_box([one + half_unit, one + 1.5 * half_unit, 1.5 * smallest - smallest]);
    check_results(tie, above_tie, subnormal)
}

/// The check of three results: half a unit and three quarters of a unit in the last place added to 1, and half of the smallest
/// normal number. Zero is flushed either as the result of the difference, or as an operand of the comparison.
#[inline(always)]
fn check_results(tie: f64, above_tie: f64, subnormal: f64) -> Result<(), Error> {
    let is_nearest = right_or!(tie == 1.0, UpwardRoundingAccepted, true)
        && right_or!(above_tie == 1.0 + f64::EPSILON, DownwardRoundingAccepted, true);
    if !is_nearest {
        return Err(Error::Arithmetic { what: "it does not round to nearest" });
    }
    if right_or!(subnormal > 0.0, FlushingAccepted, true) {
        Ok(())
    } else {
        Err(Error::Arithmetic { what: "it flushes small numbers to zero" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The results of each rounding mode, and of flushing. `crates/sscc-c/tests/it/arithmetic.rs` sets the modes themselves.
    #[test]
    fn each_wrong_mode_is_told_by_its_results() {
        let next = 1.0 + f64::EPSILON;
        let half = 0.5 * f64::MIN_POSITIVE;
        assert_eq!(check_results(1.0, next, half), Ok(()));
        assert_eq!(check_arithmetic(), Ok(()));
        let upward = check_results(next, next, half);
        let to_zero_or_downward = check_results(1.0, 1.0, half);
        assert_eq!(upward, Err(Error::Arithmetic { what: "it does not round to nearest" }));
        assert_eq!(to_zero_or_downward, upward);
        let flushed = check_results(1.0, next, 0.0);
        assert_eq!(flushed, Err(Error::Arithmetic { what: "it flushes small numbers to zero" }));
    }
}
