//! Doubles, their sums and their products, exactly.

use std::cmp::Ordering;
use std::iter::Sum;
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

use num_bigint::{BigInt, Sign};
use num_traits::{Float, ToPrimitive};

/// An integer times a power of two. All doubles are such numbers, and so are their sums and products. Unlike fractions, they
/// need no greatest common divisor, which takes most of the time of computations with fractions.
#[derive(Clone, Debug)]
pub struct Dyadic {
    integer: BigInt,
    exponent: i32,
}

impl Dyadic {
    /// Returns the exact value of a double.
    ///
    /// # Panics
    /// When the number is not finite.
    pub fn new(x: f64) -> Self {
        let (odd, exponent) = decode(x).unwrap_or((0, 0));
        Self { integer: odd.into(), exponent }
    }

    /// Returns whether the number is 0.
    pub fn is_zero(&self) -> bool {
        self.integer.sign() == Sign::NoSign
    }

    /// Returns whether the number is above 0.
    pub fn is_positive(&self) -> bool {
        self.integer.sign() == Sign::Plus
    }

    /// Returns whether the number is below 0.
    pub fn is_negative(&self) -> bool {
        self.integer.sign() == Sign::Minus
    }

    /// Returns the absolute value.
    pub fn abs(&self) -> Self {
        if self.is_negative() { -self } else { self.clone() }
    }

    /// Returns the number within one unit in the last place, as a double and the exponent of the power of two to multiply it
    /// with. The double is 0 or of size 1 to 2^64. Numbers beyond the range of doubles can be represented, too.
    pub fn mantissa_and_exponent(&self) -> (f64, i32) {
        if self.is_zero() {
            return (0.0, 0);
        }
        let beyond = self.integer.bits().saturating_sub(64) as i32;
        let leading = (&self.integer >> beyond).to_f64().expect("65 bits are in the range of doubles");
        (leading, beyond + self.exponent)
    }

    /// Returns the number within one unit in the last place.
    pub fn to_f64(&self) -> f64 {
        let (mantissa, exponent) = self.mantissa_and_exponent();
        // The multiplication takes two steps, because powers of two beyond the range of doubles may be needed.
        mantissa * 2.0_f64.powi(exponent / 2) * 2.0_f64.powi(exponent - exponent / 2)
    }

    /// Returns both integers as multiples of the smaller power of two, and its exponent. Zero is a multiple of any.
    fn aligned(&self, other: &Self) -> (BigInt, BigInt, i32) {
        let exponents = [self, other].into_iter().filter(|x| !x.is_zero()).map(|x| x.exponent);
        let exponent = exponents.min().unwrap_or(0);
        let integer = |x: &Self| &x.integer << (x.exponent - exponent).max(0);
        (integer(self), integer(other), exponent)
    }
}

/// Returns the product of all denominators, and for each denominator the product of the others. A sum of quotients over the
/// product has each numerator multiplied with the latter.
pub fn common_denominator(denominators: &[Dyadic]) -> (Dyadic, Vec<Dyadic>) {
    assert!(denominators.iter().all(|x| !x.is_zero()), "a denominator is 0");
    let others = |i: usize| [&denominators[..i], &denominators[i + 1..]].concat();
    let product = |numbers: &[Dyadic]| numbers.iter().fold(Dyadic::new(1.0), |product, x| product * x);
    (product(denominators), (0..denominators.len()).map(|i| product(&others(i))).collect())
}

impl Add for &Dyadic {
    type Output = Dyadic;

    fn add(self, other: Self) -> Dyadic {
        let (a, b, exponent) = self.aligned(other);
        Dyadic { integer: a + b, exponent }
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;

    fn sub(self, other: Self) -> Dyadic {
        let (a, b, exponent) = self.aligned(other);
        Dyadic { integer: a - b, exponent }
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;

    fn mul(self, other: Self) -> Dyadic {
        Dyadic { integer: &self.integer * &other.integer, exponent: self.exponent + other.exponent }
    }
}

impl Neg for &Dyadic {
    type Output = Dyadic;

    fn neg(self) -> Dyadic {
        Dyadic { integer: -&self.integer, exponent: self.exponent }
    }
}

impl Neg for Dyadic {
    type Output = Self;

    fn neg(self) -> Self {
        -&self
    }
}

/// Implements operators for values by those for references.
macro_rules! by_value {
    ($($Operator:ident $operator:ident),*) => {$(
        impl $Operator for Dyadic {
            type Output = Self;

            fn $operator(self, other: Self) -> Self {
                (&self).$operator(&other)
            }
        }

        impl $Operator<&Self> for Dyadic {
            type Output = Self;

            fn $operator(self, other: &Self) -> Self {
                (&self).$operator(other)
            }
        }

        impl $Operator<Dyadic> for &Dyadic {
            type Output = Dyadic;

            fn $operator(self, other: Dyadic) -> Dyadic {
                self.$operator(&other)
            }
        }
    )*};
}

by_value!(Add add, Sub sub, Mul mul);

impl AddAssign for Dyadic {
    fn add_assign(&mut self, other: Self) {
        *self = &*self + &other;
    }
}

impl Sum for Dyadic {
    fn sum<I: Iterator<Item = Self>>(numbers: I) -> Self {
        numbers.fold(Self::new(0.0), |sum, x| sum + x)
    }
}

impl Ord for Dyadic {
    fn cmp(&self, other: &Self) -> Ordering {
        let (a, b, _) = self.aligned(other);
        a.cmp(&b)
    }
}

impl PartialOrd for Dyadic {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Dyadic {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Dyadic {}

/// Returns an odd number and the exponent of the power of two to multiply it with; None for 0.
///
/// # Panics
/// When the number is not finite.
pub(crate) fn decode(x: f64) -> Option<(i64, i32)> {
    assert!(x.is_finite(), "numbers are finite");
    let (mantissa, exponent, sign) = x.integer_decode();
    let zeros = mantissa.trailing_zeros();
    (mantissa != 0)
        .then(|| (i64::from(sign) * (mantissa >> zeros) as i64, i32::from(exponent) + zeros as i32))
}

#[cfg(test)]
mod tests {
    use num_rational::BigRational;
    use num_traits::{Signed, Zero};

    use super::*;
    use crate::Numbers;

    fn fraction(x: &Dyadic) -> BigRational {
        let two = BigRational::from_integer(2.into());
        BigRational::from_integer(x.integer.clone()) * num_traits::Pow::pow(two, x.exponent)
    }

    #[test]
    fn numbers_are_those_of_fractions() {
        let random = &mut Numbers(1);
        let double = |random: &mut Numbers| match random.below(8) {
            0 => 0.0,
            1 => f64::from_bits(1 + random.below(1000) as u64),
            2 => random.below(9) as f64 - 4.0,
            _ => random.signed() * random.power(-300.0, 300.0),
        };
        for _ in 0..2000 {
            let [a, b, c] = [(); 3].map(|()| double(random));
            let [x, y, z] = [a, b, c].map(Dyadic::new);
            let [p, q, r] = [a, b, c].map(|x| BigRational::from_float(x).unwrap());
            assert_eq!([fraction(&x), fraction(&y)], [p.clone(), q.clone()]);
            let (value, exact) = ((&x * &y - &z) * (&x + &z) + -&y, (&p * &q - &r) * (&p + &r) - &q);
            assert_eq!(fraction(&value), exact);
            assert_eq!(fraction(&value.abs()), exact.abs());
            let signs = [value.is_negative(), value.is_zero(), value.is_positive()];
            assert_eq!(signs, [exact.is_negative(), exact.is_zero(), exact.is_positive()]);
            let again = (&x + &z) * (&y * &x - &z) - &y;
            assert_eq!(
                (x.cmp(&y), value.cmp(&z), value.cmp(&again)),
                (p.cmp(&q), exact.cmp(&r), Ordering::Equal)
            );
            assert_eq!(x.to_f64(), a);
            let near = exact.to_f64().unwrap();
            let is_near = |found: f64| [near, near.next_up(), near.next_down()].contains(&found);
            assert!(is_near(value.to_f64()), "{} {near}", value.to_f64());
        }
    }
}
