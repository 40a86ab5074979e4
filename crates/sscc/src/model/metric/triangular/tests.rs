//! Compares the growth bound of triangular factors with exact arithmetic.

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
