//! Intervals of doubles that contain the exact number.
//!
//! A bound that is rounded to nearest is moved by one unit in the last place, so it is never inside. A sum or difference that
//! rounds to 0 is exactly 0 (gradual underflow), and so is a product with 0; a sum with 0 is exact.

use super::number::Number;

/// All numbers from `lower` to `upper`. A bound that overflows is infinite; predicates remain undecided if a bound is NaN.
#[derive(Clone, Copy, Debug)]
pub struct Interval {
    lower: f64,
    upper: f64,
}

impl Interval {
    /// Returns the interval of one number.
    pub fn of(x: f64) -> Self {
        Self { lower: x, upper: x }
    }

    fn is_zero(&self) -> bool {
        self.lower == 0.0 && self.upper == 0.0
    }
}

/// Whether a sum is certain to be exact.
fn is_exact(x: f64, y: f64, sum: f64) -> bool {
    sum == 0.0 || x == 0.0 || y == 0.0
}

fn sum_down(x: f64, y: f64) -> f64 {
    let sum = x + y;
    if is_exact(x, y, sum) { sum } else { sum.next_down() }
}

fn sum_up(x: f64, y: f64) -> f64 {
    let sum = x + y;
    if is_exact(x, y, sum) { sum } else { sum.next_up() }
}

impl Number for Interval {
    fn plus(&self, other: &Self) -> Self {
        Self { lower: sum_down(self.lower, other.lower), upper: sum_up(self.upper, other.upper) }
    }

    fn minus(&self, other: &Self) -> Self {
        Self { lower: sum_down(self.lower, -other.upper), upper: sum_up(self.upper, -other.lower) }
    }

    fn times(&self, other: &Self) -> Self {
        if self.is_zero() || other.is_zero() {
            return Self::of(0.0);
        }
        let (a, b) = (self.lower * other.lower, self.lower * other.upper);
        let (c, d) = (self.upper * other.lower, self.upper * other.upper);
        if (a + b + c + d).is_nan() {
            return Self { lower: f64::NEG_INFINITY, upper: f64::INFINITY };
        }
        Self { lower: a.min(b).min(c.min(d)).next_down(), upper: a.max(b).max(c.max(d)).next_up() }
    }

    fn sign(&self) -> Option<i8> {
        if self.lower > 0.0 {
            Some(1)
        } else if self.upper < 0.0 {
            Some(-1)
        } else if self.is_zero() {
            Some(0)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_enclose_rounding_errors() {
        let [third, one, tiny] = [1.0 / 3.0, 1.0, f64::from_bits(1)].map(Interval::of);
        let sum = third.plus(&third).plus(&third).minus(&one);
        assert_eq!(sum.sign(), None);
        assert_eq!(third.minus(&third).sign(), Some(0));
        assert_eq!(tiny.times(&tiny).sign(), None);
        assert_eq!(tiny.sign(), Some(1));
        let huge = Interval::of(f64::MAX);
        assert_eq!(huge.times(&huge).minus(&huge.times(&huge)).sign(), None);
        assert_eq!(one.minus(&huge).sign(), Some(-1));
    }
}
