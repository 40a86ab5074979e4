//! The rate that suffices for a bound.

use super::*;

/// The rate is sufficient, and one that is larger by a millionth is not.
#[test]
fn slower_rates_are_the_largest_that_suffice() {
    for delta in [1e-9, 0.3, 1.0, 4e5] {
        let terms = AffineTerms { delta, at_rest: 0.1 * delta, slack: 0.2 * delta, rate_rounding: 0.01 };
        // 0.9 delta / ((rate + 0.01) delta + 0.2 delta) = 0.5
        let rate = terms.slower_than(0.5).unwrap();
        assert!((rate - 1.59).abs() < 1e-6, "{delta}: {rate}");
        assert!(terms.bound(rate) >= 0.5 && terms.bound(rate * (1.0 + 1e-6)) < 0.5, "{delta}");
        // The residuals alone are faster.
        assert!(terms.slower_than(5.0).is_none());
    }
}
