//! Tests of forms and pyramids, and of rates that nearly vanish along the only direction of a cone.

use glam::DMat3;
use sscc_testing::Dyadic;

use super::*;
use crate::bounds::tests::random::Random;
use crate::bounds::tests::rounding::exact;

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

/// Forms are the squared norms, over the modes, of `u'S v` with the symmetric parts S of their gradients.
#[test]
fn forms_are_those_of_symmetric_parts() {
    let root = std::f64::consts::SQRT_2;
    for case in 0..300 {
        let random = &mut Random::new(case);
        let symmetric: Vec<DMat3> = (0..1 + random.below(8))
            .map(|_| DMat3::from_cols(random.vector(), random.vector(), random.vector()))
            .map(|g| (g + g.transpose()) * 0.5)
            .collect();
        let strains: Vec<[f64; 6]> = symmetric
            .iter()
            .map(|s| {
                let shears = [s.y_axis.z, s.x_axis.z, s.x_axis.y].map(|shear| shear * root);
                [s.x_axis.x, s.y_axis.y, s.z_axis.z, shears[0], shears[1], shears[2]]
            })
            .collect();
        let gram: StrainGram =
            std::array::from_fn(|i| std::array::from_fn(|j| strains.iter().map(|s| s[i] * s[j]).sum()));
        let forms = Forms { gram: &gram, rounding: 0.0 };
        let (u, v) = (random.vector().normalize(), random.vector().normalize());
        let square = |u: DVec3, v: DVec3| symmetric.iter().map(|s| u.dot(*s * v).powi(2)).sum::<f64>();
        let room = 1e-12 * (0..6).map(|i| gram[i][i]).sum::<f64>();
        assert!((forms.square(u, v) - square(u, v)).abs() <= room, "case {case}");
        assert!((forms.evaluate(u).powi(2) - square(u, u)).abs() <= room, "case {case}");
    }
}

/// The bound of a cone is at least the exact quotients of its directions, and close to the largest one, even
/// without the rounding bound of forms: where all terms are positive, its own factors cover their rounding.
#[test]
fn bounds_of_cones_are_rounded_up() {
    for case in 0..200 {
        let random = &mut Random::new(case);
        // One mode stretches along the axes, mostly along z. Its Gram matrix is exact.
        let strain = DVec3::new((1 + random.below(64)) as f64, (1 + random.below(64)) as f64, 256.0) / 256.0;
        let mut gram = [[0.0; 6]; 6];
        for (i, j) in (0..9).map(|ij| (ij / 3, ij % 3)) {
            gram[i][j] = strain[i] * strain[j];
        }
        // A single direction; or a wide cone, whose largest quotient is that of two directions.
        let height = 0.4 + 0.2 * random.uniform();
        let u = if case % 2 == 0 {
            [DVec3::new(1.0, height, random.uniform()).normalize(); 3]
        } else {
            [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, height).normalize())
        };
        let bound = Forms { gram: &gram, rounding: 0.0 }.bound(&u);
        let mut largest = 0.0_f64;
        for (u, v) in (0..3).flat_map(|i| (i..3).map(move |j| (u[i], u[j]))) {
            let sum = |of: &dyn Fn(usize) -> Dyadic| -> Dyadic { (0..3).map(of).sum() };
            let cosine = sum(&|c| exact(u[c]) * exact(v[c]));
            let form = sum(&|c| exact(strain[c]) * exact(u[c]) * exact(v[c]));
            assert!(exact(bound) * cosine >= form, "case {case}: {bound}");
            largest = largest.max(u.dot(strain * v) / u.dot(v));
        }
        assert!(bound <= largest * (1.0 + 1e-12), "case {case}: {bound} {largest}");
    }
}

/// All directions are on the inner side of the four planes of a pyramid, by the margin at height 1, and on
/// each side one of them is not farther inside.
#[test]
fn pyramids_enclose_their_directions() {
    let margin = 1e-3;
    for case in 0..500 {
        let random = &mut Random::new(case);
        let axis = random.vector().normalize();
        let width = if case % 5 == 0 { 0.0 } else { random.power(-6.0, -0.6) };
        let d: [DVec3; 9] =
            std::array::from_fn(|_| (axis + random.vector() * width) * random.power(-3.0, 3.0));
        let pyramid = enclose_in_pyramid(&d, margin).unwrap();
        for (i, u) in pyramid.iter().enumerate() {
            assert!((u.length() - 1.0).abs() < 1e-12, "case {case}: {u}");
            let side = u.cross(pyramid[(i + 1) % 4]).normalize();
            let inside = d.iter().map(|d| side.dot(d.normalize())).fold(f64::INFINITY, f64::min);
            // Directions are within 60 degrees of the axis.
            assert!(
                inside >= 0.1 * margin && inside <= margin * (1.0 + 1e-6),
                "case {case}, side {i}: {inside:e}"
            );
        }
    }
}

/// A pyramid around directions that do not lie well within a half-space would not contain them.
#[test]
fn directions_beyond_a_half_space_have_no_rate() {
    let gram: StrainGram = std::array::from_fn(|i| std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }));
    let rate = |d: &[DVec3; 9], gram: &StrainGram| bound_rate_in_cone(d, gram, 4, 0.0, PYRAMID_MARGIN);
    for (height, fits) in [(-0.5, false), (0.0, false), (0.04, false), (0.06, true)] {
        // Two directions on opposite sides of the others, which are the mean.
        let mut d = [DVec3::Z; 9];
        let across = f64::sqrt(1.0 - height * height);
        (d[2], d[7]) = (DVec3::new(across, 0.0, height), DVec3::new(-across, 0.0, height));
        assert_eq!(enclose_in_pyramid(&d, PYRAMID_MARGIN).is_some(), fits, "{height}");
        assert!(fits || rate(&d, &gram) == f64::INFINITY, "{height}");
    }
    let narrow = [DVec3::new(0.6, 0.0, 0.8); 9];
    assert!((rate(&narrow, &gram) - 1.0).abs() < 1e-9);
    for x in [f64::NAN, f64::INFINITY] {
        let mut d = narrow;
        d[5].y = x;
        assert_eq!(rate(&d, &gram), f64::INFINITY, "{x}");
        let mut gram = gram;
        gram[3][3] = x;
        assert_eq!(rate(&narrow, &gram), f64::INFINITY, "{x}");
    }
}
