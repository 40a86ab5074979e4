//! Tests of rates that nearly vanish along the only direction of a cone.

use super::*;
use crate::bounds::tests::random::Random;

/// All strains nearly leave one direction unchanged: the form of their Gram matrix is then only rounding error.
#[test]
fn rates_that_cancel_are_not_too_small() {
    let root = std::f64::consts::SQRT_2;
    for case in 0..4000 {
        let random = &mut Random::new(case);
        let rank = 1 + random.below(40);
        let u = random.vector().normalize();
        let m = [u.x * u.x, u.y * u.y, u.z * u.z, u.y * u.z * root, u.x * u.z * root, u.x * u.y * root];
        let form = |s: &[f64; 6]| s.iter().zip(m).map(|(s, m)| s * m).sum::<f64>();
        // The share that remains: about the root of the rounding error of the form.
        let left = random.power(-9.5, -7.5);
        let strains: Vec<[f64; 6]> = (0..rank)
            .map(|_| {
                let s: [f64; 6] = std::array::from_fn(|_| random.uniform() - 0.5);
                let along = form(&s);
                std::array::from_fn(|i| s[i] - m[i] * along * (1.0 - left))
            })
            .collect();
        let gram: StrainGram =
            std::array::from_fn(|i| std::array::from_fn(|j| strains.iter().map(|s| s[i] * s[j]).sum()));
        let rate = bound_rate_in_cone(&[u; 9], &gram, rank.next_multiple_of(4), f64::INFINITY, 1e-12);
        let here = strains.iter().map(|s| form(s) * form(s)).sum::<f64>().sqrt();
        // The strains are rounded, too.
        assert!(here <= rate * (1.0 + 1e-6), "case {case}: {here:e} above {rate:e}");
    }
}
