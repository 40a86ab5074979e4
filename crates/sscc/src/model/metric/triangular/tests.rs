//! Compares the growth bound of triangular factors with exact arithmetic.

use glam::DVec3;
use num_rational::BigRational;
use num_traits::Signed;

use super::*;

/// The bound is compared with `|S||S^-1|` in exact arithmetic, for factors from well-conditioned to nearly singular.
#[test]
fn growth_is_at_least_the_exact_one() {
    let exact = |x: f64| BigRational::from_float(x).unwrap();
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    let (mut checked, mut largest) = (0, 0.0_f64);
    for case in 0..300 {
        let r = 2 + case % 6;
        let size = 10.0_f64.powf(2.0 * random());
        let mut entries = vec![0.0; r * r];
        for i in 0..r {
            (i..r).for_each(|j| entries[i * r + j] = random() * size);
            entries[i * (r + 1)] = 0.2 + random().abs();
        }
        if r == 4 {
            // One entry of the inverse, and with it one of the product, consists of rounding error only.
            entries[7] = entries[6] * entries[11] / entries[10];
            (entries[2], entries[3]) = (0.0, 0.0);
        }
        let Ok(factor) = Triangular::new(r, entries.clone()) else { continue };
        // Solves S T = I row by row, from the last row on.
        let mut inverse = vec![exact(0.0); r * r];
        for j in 0..r {
            for i in (0..=j).rev() {
                let one = exact(if i == j { 1.0 } else { 0.0 });
                let known: BigRational =
                    (i + 1..=j).map(|k| exact(entries[i * r + k]) * &inverse[k * r + j]).sum();
                inverse[i * r + j] = (one - known) / exact(entries[i * (r + 1)]);
            }
        }
        for i in 0..r {
            for j in 0..r {
                let growth: BigRational =
                    (0..r).map(|k| exact(entries[i * r + k].abs()) * inverse[k * r + j].abs()).sum();
                assert!(exact(factor.growth[i * r + j]) >= growth, "case {case}: {i} {j}");
                largest = largest.max(factor.growth[i * r + j]);
            }
        }
        checked += 1;
    }
    assert!(checked > 200 && largest > 1e9, "{checked} {largest:e}");
}

#[test]
fn bounds_of_known_factors_are_those_of_their_formulas() {
    let unit = f64::EPSILON;
    let near = |found: f64, wanted: f64| (found - wanted).abs() <= 1e-12 * wanted.abs();
    // The inverse [1 -L; 0 1] and the residual 0 are computed exactly; the bound of rounding is 10 units of 2 L + 2.
    let large = 2.0_f64.powi(20);
    let factor = Triangular::new(2, vec![1.0, large, 0.0, 1.0]).unwrap();
    let least = 10.0 * unit * (2.0 * large + 2.0);
    assert!((least..least * (1.0 + 1e-7)).contains(&factor.growth[2]), "{:e} {least:e}", factor.growth[2]);
    // 18 units of the residual, and twice 36.
    let units = (Triangular::new(1, vec![2.0]).unwrap().growth[0] - 1.0) / unit;
    assert!((86.0..=94.0).contains(&units), "{units}");
    // The sum of the row is 20 units of L: 0.08, 0.6, 1.2 and beyond.
    let is_good = |power| Triangular::new(2, vec![1.0, 2.0_f64.powi(power), 0.0, 1.0]).is_ok();
    assert!(is_good(44) && ![47, 48, 60].into_iter().any(is_good));

    let scaled = [DVec3::new(3.0, -2.0, 0.5), DVec3::new(-1.0, 4.0, 0.25)];
    let mut found = [DVec3::ONE; 2];
    factor.magnitudes(&scaled, &mut found);
    for (j, found) in found.into_iter().enumerate() {
        let wanted = scaled[0].abs() * factor.growth[j] + scaled[1].abs() * factor.growth[2 + j];
        assert!((0..3).all(|axis| near(found[axis], wanted[axis])), "{found} {wanted}");
    }

    let entries = vec![1.0, 2.0, 2.0, 0.0, 4.0, 3.0, 0.0, 0.0, 6.0];
    let mut matrix = [1.0, 2.0, 2.0, 2.0, 20.0, 16.0, 2.0, 16.0, 49.0];
    let factor = Triangular::cholesky(3, &matrix).unwrap();
    assert_eq!(factor.entries(), entries);
    assert!(
        factor == Triangular::new(3, entries).unwrap() && factor != Triangular::new(1, vec![1.0]).unwrap()
    );
    let lengths = [0, 1, 2].map(|k| factor.column_length(k));
    assert!(lengths.into_iter().zip([1.0, 20.0_f64.sqrt(), 7.0]).all(|(l, w)| near(l, w)), "{lengths:?}");
    assert_eq!(factor.product(&[1.0, 2.0, 3.0]), [11.0, 17.0, 18.0]);
    matrix[1] = 2.1;
    assert!(Triangular::cholesky(3, &matrix).is_err());
}
