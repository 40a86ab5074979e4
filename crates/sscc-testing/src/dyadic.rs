//! Doubles as integer multiples of a common power of two.

use glam::DVec3;
use num_bigint::BigInt;
use num_traits::Float;

/// A power of two of which all coordinates are multiples.
#[derive(Clone, Copy)]
pub(crate) struct Grid {
    exponent: i32,
}

impl Grid {
    /// Returns the grid of these points.
    pub(crate) fn of(points: &[DVec3]) -> Self {
        let coordinates = points.iter().flat_map(|p| p.to_array());
        Self { exponent: coordinates.filter_map(|x| Some(decode(x)?.1)).min().unwrap_or(0) }
    }

    /// Returns the exponent of the power of two.
    pub(crate) fn exponent(self) -> i32 {
        self.exponent
    }

    /// Returns the number divided by the power of two.
    pub(crate) fn whole(self, x: f64) -> BigInt {
        let Some((odd, exponent)) = decode(x) else { return BigInt::ZERO };
        BigInt::from(odd) << (exponent - self.exponent)
    }
}

/// Returns an odd number and the exponent of the power of two to multiply it with; none for 0.
///
/// # Panics
/// When the number is not finite.
fn decode(x: f64) -> Option<(i64, i32)> {
    assert!(x.is_finite(), "numbers are finite");
    let (mantissa, exponent, sign) = x.integer_decode();
    let zeros = mantissa.trailing_zeros();
    (mantissa != 0)
        .then(|| (i64::from(sign) * (mantissa >> zeros) as i64, i32::from(exponent) + zeros as i32))
}
