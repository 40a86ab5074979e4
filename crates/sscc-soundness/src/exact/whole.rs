//! Big integers. Coordinates are in units of a power of two of which all are multiples. Signs do not depend on the unit.

use num_bigint::{BigInt, Sign};

use super::number::Number;
use super::point::Point;
use super::wide::Wide;

/// A number in units of a [`Unit`], or of one of its powers.
#[derive(Clone, Debug)]
pub struct Whole(BigInt);

/// The exponent of the unit of some coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Unit(i32);

/// Returns the number as `whole * 2^exponent`, with an odd integer `whole`; None for 0. Panics if it is not finite.
fn split(x: f64) -> Option<(i64, i32)> {
    assert!(x.is_finite(), "coordinates are finite");
    if x == 0.0 {
        return None;
    }
    let bits = x.to_bits();
    let (field, fraction) = ((bits >> 52 & 0x7ff) as i32, (bits & ((1 << 52) - 1)) as i64);
    let (magnitude, exponent) =
        if field == 0 { (fraction, -1074) } else { (fraction | 1 << 52, field - 1075) };
    let zeros = magnitude.trailing_zeros();
    let odd = magnitude >> zeros;
    Some((if x < 0.0 { -odd } else { odd }, exponent + zeros as i32))
}

impl Unit {
    /// Returns the largest unit of which all coordinates are multiples.
    pub fn of<'p>(points: impl IntoIterator<Item = &'p Point>) -> Self {
        let exponents = points.into_iter().flatten().filter_map(|x| Some(split(*x)?.1));
        Self(exponents.min().unwrap_or(0))
    }

    /// Returns the bits of the largest coordinate in this unit.
    pub fn bits<'p>(self, points: impl IntoIterator<Item = &'p Point>) -> i32 {
        let sizes = points.into_iter().flatten().filter_map(|x| {
            let (odd, exponent) = split(*x)?;
            Some(exponent - self.0 + 64 - odd.unsigned_abs().leading_zeros() as i32)
        });
        sizes.max().unwrap_or(0)
    }

    /// Returns a coordinate in this unit, of fixed width. It must fit.
    pub fn wide<const N: usize>(self, x: f64) -> Wide<N> {
        let (odd, exponent) = split(x).unwrap_or((0, self.0));
        Wide::of(odd, exponent - self.0)
    }

    /// Returns a coordinate in this unit.
    pub fn whole(self, x: f64) -> Whole {
        Whole(split(x).map_or(BigInt::ZERO, |(odd, exponent)| BigInt::from(odd) << (exponent - self.0)))
    }
}

impl Number for Whole {
    fn plus(&self, other: &Self) -> Self {
        Self(&self.0 + &other.0)
    }

    fn minus(&self, other: &Self) -> Self {
        Self(&self.0 - &other.0)
    }

    fn times(&self, other: &Self) -> Self {
        Self(&self.0 * &other.0)
    }

    fn sign(&self) -> Option<i8> {
        Some(match self.0.sign() {
            Sign::Minus => -1,
            Sign::NoSign => 0,
            Sign::Plus => 1,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_exact_multiples() {
        let points = [[3.0, -0.25, 1e-310], [0.0, f64::from_bits(1), 1e60]];
        let unit = Unit::of(&points);
        for x in points.into_iter().flatten() {
            let sign = unit.whole(x).minus(&unit.whole(x.next_up())).sign();
            // The next double is a multiple of the smallest denormal number, too.
            assert_eq!(sign, Some(-1), "{x}");
            assert_eq!(unit.whole(x).minus(&unit.whole(x)).sign(), Some(0));
        }
        assert_eq!(split(6.0), Some((3, 1)));
        assert_eq!(split(-0.0), None);
    }
}
