//! Tests both kinds of numbers of polynomial predicates against rational arithmetic.

use num_rational::BigRational;
use num_traits::Signed;

use super::bounded_float::BoundedFloat;
use super::dyadic::Dyadic;
use super::number::{Bounds, Number, power_of_two};

fn rational(x: f64) -> BigRational {
    BigRational::from_float(x).unwrap()
}

/// Returns the value of a [`Dyadic`].
fn value(x: &Dyadic) -> BigRational {
    let two = BigRational::from_integer(2.into());
    BigRational::from_integer(x.mantissa.clone()) * num_traits::Pow::pow(two, x.exponent as i32)
}

/// Random sums and products of random numbers of very different sizes: exact ones equal rational arithmetic,
/// rounded ones differ from it by at most their error bound, and neither has a wrong sign.
#[test]
fn both_kinds_agree_with_rational_arithmetic() {
    let mut state = 1_u64;
    let mut random = |n: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % n
    };
    let double = |random: &mut dyn FnMut(u64) -> u64, widest: i64| {
        let fraction = random(1 << 31) as f64 / (1_u64 << 30) as f64 - 1.0;
        fraction * power_of_two(random(2 * widest as u64 + 1) as i64 - widest)
    };
    let (mut decided, mut open) = (0, 0);
    for case in 0..3_000 {
        let widest = if case % 2 == 0 { 8 } else { 300 };
        let (a, b) = (double(&mut random, widest), double(&mut random, widest));
        let mut numbers =
            (BoundedFloat::difference(a, b), Dyadic::difference(a, b), rational(a) - rational(b));
        for _ in 0..6 {
            let (c, d) = (double(&mut random, widest), double(&mut random, widest));
            let (x, y, z) =
                (BoundedFloat::difference(c, d), Dyadic::difference(c, d), rational(c) - rational(d));
            numbers = match random(5) {
                4 => (numbers.0.minimum(&x), numbers.1.minimum(&y), numbers.2.min(z)),
                0 => (numbers.0.plus(&x), numbers.1.plus(&y), numbers.2 + z),
                1 => (numbers.0.minus(&x), numbers.1.minus(&y), numbers.2 - z),
                2 => (numbers.0.times(&x), numbers.1.times(&y), numbers.2 * z),
                // Only rounding errors remain.
                _ => {
                    let again = numbers.0.times(&x).minus(&x.times(&numbers.0));
                    let exact = numbers.1.times(&y).minus(&y.times(&numbers.1));
                    assert_eq!(exact.is_positive(), Some(false));
                    assert_eq!(again.is_positive(), None);
                    numbers
                }
            };
            let (bounded, dyadic, truth) = &numbers;
            assert_eq!(value(dyadic), *truth);
            if bounded.value.is_finite() && bounded.error.is_finite() {
                assert!((rational(bounded.value) - truth).abs() <= rational(bounded.error), "{bounded:?}");
            }
            assert_eq!(dyadic.is_positive(), Some(truth.is_positive()));
            match bounded.is_positive() {
                Some(sign) => assert_eq!(sign, truth.is_positive()),
                None => open += 1,
            }
            decided += usize::from(bounded.is_positive().is_some());
        }
    }
    assert!(decided > 10_000 && open > 5, "{decided} {open}");
}

/// The minimum of a number that lost its digits in a sum and one that lost none has the larger error, whichever is smaller.
#[test]
fn a_minimum_has_the_larger_error() {
    let (mut lost, mut open) = (0, 0);
    for i in 0..400 {
        let small = f64::from(i) / 64.0 + 1e-3;
        // The rest of a sum with a large number, which is a multiple of 4.
        let large = 2.0_f64.powi(54);
        let sum = |one: f64| BoundedFloat::from_f64(large).plus(&BoundedFloat::from_f64(one));
        let rounded = sum(small).minus(&BoundedFloat::from_f64(large));
        for other in [-2.0, -0.5, 0.0, 0.5, 1.0, 2.0, 3.0, 8.0] {
            let exact = rational(small).min(rational(other));
            for least in [
                rounded.minimum(&BoundedFloat::from_f64(other)),
                BoundedFloat::from_f64(other).minimum(&rounded),
            ] {
                let off = (rational(least.value) - &exact).abs();
                assert!(off <= rational(least.error), "{small} {other}: {least:?}");
                lost += usize::from(off > rational(1e-3));
                match least.is_positive() {
                    Some(sign) => assert_eq!(sign, exact.is_positive()),
                    None => open += 1,
                }
            }
        }
    }
    assert!(lost > 1000 && open > 100, "{lost} {open}");
}

#[test]
fn quotients_by_roots_are_rounded_down() {
    for (n, square, exact) in
        [(3.0, 4.0, 1.5), (5.0, 2.0, 12.5_f64.sqrt()), (-1.0, 4.0, 0.0), (1.0, 0.0, 0.0)]
    {
        let bounded = BoundedFloat::from_f64(n).over_root(&BoundedFloat::from_f64(square));
        let dyadic = Dyadic::from_f64(n).over_root(&Dyadic::from_f64(square));
        for Bounds { lower, upper } in [bounded, dyadic] {
            assert!(lower <= exact && lower >= exact * (1.0 - 1e-14), "{n} / sqrt({square}): {lower}");
            let open = square == 0.0 && upper == f64::INFINITY;
            assert!(
                open || upper >= exact && upper <= exact * (1.0 + 1e-14),
                "{n} / sqrt({square}): {upper}"
            );
        }
    }
    // Tests a number whose square underflows as a double.
    let small = Dyadic::from_f64(1e-290);
    let Bounds { lower: found, .. } = small.times(&small).over_root(&small.times(&small));
    assert!((found / 1e-290 - 1.0).abs() < 1e-14, "{found:e}");
}

/// Rounded directions have the ratios of exact vectors, far beyond the range of doubles and beside zeros, too. They
/// neither overflow nor vanish.
#[test]
fn directions_of_exact_vectors_have_their_ratios() {
    for components in [[3.0, -5.0, 0.25], [0.0, 1e-20, -3e-20], [1e25, 0.0, 7e24], [-1e-15, 0.0, 0.0]] {
        for factor in [1.0, 1e-300, 1e300] {
            let factor = Dyadic::from_f64(factor);
            let vector = components.map(|x| Dyadic::from_f64(x).times(&factor).times(&factor));
            let found = Dyadic::direction(&vector).to_array();
            let largest = |x: [f64; 3]| x.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
            let size = largest(found);
            assert!((1.0..=power_of_two(60)).contains(&size), "{components:?}: {found:?}");
            for (x, y) in found.into_iter().zip(components) {
                assert!((x / size - y / largest(components)).abs() < 1e-15, "{components:?}: {found:?}");
            }
        }
    }
}
