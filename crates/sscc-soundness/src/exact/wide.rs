//! Integers of fixed width. They compute like big integers, without allocations.
//!
//! A predicate of degree 4 in differences of coordinates is at most `4 (bits + 1) + 8` bits long. [`fits`] states whether
//! this is within the width.

use super::number::Number;

/// A number in two's complement, the lowest word first.
#[derive(Clone, Copy, Debug)]
pub struct Wide<const N: usize>([u64; N]);

/// Whether predicates of degree 4 fit, for coordinates of `bits` bits.
pub fn fits<const N: usize>(bits: i32) -> bool {
    4 * (bits + 1) + 8 < 64 * N as i32
}

impl<const N: usize> Wide<N> {
    /// Returns the number `odd * 2^shift`, which must fit.
    pub fn of(odd: i64, shift: i32) -> Self {
        let (word, bit) = (shift as usize / 64, shift % 64);
        let magnitude = u128::from(odd.unsigned_abs()) << bit;
        let mut words = [0; N];
        words[word] = magnitude as u64;
        let high = (magnitude >> 64) as u64;
        if high != 0 {
            words[word + 1] = high;
        }
        if odd < 0 { Self([0; N]).minus(&Self(words)) } else { Self(words) }
    }
}

impl<const N: usize> Number for Wide<N> {
    #[inline]
    fn plus(&self, other: &Self) -> Self {
        let mut carry = false;
        Self(std::array::from_fn(|i| {
            let (sum, first) = self.0[i].overflowing_add(other.0[i]);
            let (sum, second) = sum.overflowing_add(u64::from(carry));
            carry = first | second;
            sum
        }))
    }

    #[inline]
    fn minus(&self, other: &Self) -> Self {
        let mut borrow = false;
        Self(std::array::from_fn(|i| {
            let (rest, first) = self.0[i].overflowing_sub(other.0[i]);
            let (rest, second) = rest.overflowing_sub(u64::from(borrow));
            borrow = first | second;
            rest
        }))
    }

    #[inline]
    fn times(&self, other: &Self) -> Self {
        let mut words = [0_u64; N];
        for i in 0..N {
            let mut carry = 0_u128;
            for j in 0..N - i {
                let product = u128::from(self.0[i]) * u128::from(other.0[j]);
                let sum = product + u128::from(words[i + j]) + carry;
                words[i + j] = sum as u64;
                carry = sum >> 64;
            }
        }
        Self(words)
    }

    #[inline]
    fn sign(&self) -> Option<i8> {
        Some(match self.0[N - 1] as i64 {
            ..0 => -1,
            _ => i8::from(self.0.iter().any(|word| *word != 0)),
        })
    }
}

#[cfg(test)]
mod tests {
    use num_bigint::{BigInt, Sign};

    use super::*;
    use crate::random::Random;

    fn big<const N: usize>(x: &Wide<N>) -> BigInt {
        let bytes: Vec<u8> = x.0.iter().flat_map(|word| word.to_le_bytes()).collect();
        BigInt::from_signed_bytes_le(&bytes)
    }

    #[test]
    fn fixed_width_integers_compute_like_big_integers() {
        let mut random = Random::new("wide", 1);
        for _ in 0..2000 {
            let mut number = || {
                let (odd, shift) = (random.bits() as i64 >> 10 >> random.below(50), random.below(70) as i32);
                let wide = Wide::<8>::of(odd, shift);
                assert_eq!(big(&wide), BigInt::from(odd) << shift);
                wide
            };
            let (a, b, c) = (number(), number(), number());
            let value = a.times(&b).minus(&c).times(&a.plus(&b)).times(&c);
            let exact = (big(&a) * big(&b) - big(&c)) * (big(&a) + big(&b)) * big(&c);
            assert_eq!(big(&value), exact);
            let sign = match exact.sign() {
                Sign::Minus => -1,
                Sign::NoSign => 0,
                Sign::Plus => 1,
            };
            assert_eq!(value.sign(), Some(sign));
        }
        assert!(fits::<4>(60) && !fits::<4>(61) && fits::<8>(124) && !fits::<8>(125));
    }
}
