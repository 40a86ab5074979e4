//! The check that a thread computes as all proofs assume: it rounds to nearest, and numbers underflow gradually.
//!
//! A host can change the floating-point mode of a thread: audio threads often flush small numbers to zero. Then rounding
//! bounds are too small, and a difference of two positions may be 0 though they differ. Meshes and queries check the
//! mode when they are made, certificates when they are computed, and detectors, shapes and the
//! searches of queries each time. Only a query that the root's radius answers does not check it: that query stays one
//! comparison.

// Results in memory round twice there, which the check below does not see.
#[cfg(all(target_arch = "x86", not(target_feature = "sse2")))]
compile_error!("sscc needs SSE2: x87 arithmetic rounds twice");

use std::hint::black_box;

use crate::Error;

/// Refuses a thread whose floating-point mode is not that of the proofs. Only one comparison has a subnormal operand, since some
/// processors take much longer for subnormal numbers.
///
/// # Errors
/// [`Error::Arithmetic`].
#[inline]
pub(crate) fn check_arithmetic() -> Result<(), Error> {
    let [one, half_unit, smallest] = black_box([1.0, 0.5 * f64::EPSILON, f64::MIN_POSITIVE]);
    // Computed at run time, in the mode of this thread: `black_box` hides operands and results from the compiler.
    let [tie, above_tie, subnormal] =
        black_box([one + half_unit, one + 1.5 * half_unit, 1.5 * smallest - smallest]);
    check_results(tie, above_tie, subnormal)
}

/// Checks three results: 1 plus half a unit in the last place, 1 plus three quarters of a unit, and half of the smallest normal
/// number. A thread that flushes replaces this half by 0, as the result of the difference or as an operand of the comparison.
#[inline(always)]
fn check_results(tie: f64, above_tie: f64, subnormal: f64) -> Result<(), Error> {
    let is_nearest = with_mutant!(tie == 1.0, UpwardRoundingAccepted, true)
        && with_mutant!(above_tie == 1.0 + f64::EPSILON, DownwardRoundingAccepted, true);
    if !is_nearest {
        return Err(Error::Arithmetic { what: "it does not round to nearest" });
    }
    if with_mutant!(subnormal > 0.0, FlushingAccepted, true) {
        Ok(())
    } else {
        Err(Error::Arithmetic { what: "it flushes small numbers to zero" })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks the results of each rounding mode and of flushing. `crates/sscc-c/tests/it/arithmetic.rs` sets the modes
    /// themselves.
    #[test]
    fn each_wrong_mode_is_recognized_by_its_results() {
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
