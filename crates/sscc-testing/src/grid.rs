//! Coordinates as integer multiples of a common power of two.

use glam::DVec3;
use num_bigint::BigInt;

use crate::dyadic::decode;

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
