//! The terms of the bound, and the rate that suffices for a bound.

use sscc_testing::Dyadic;

use super::*;
use crate::bounds::tests::random::Random;
use crate::bounds::tests::rounding::exact;
use crate::geometry::TwoTriangles;
use crate::{DISTANCE_ERROR, Metric, Modes, ReducedModel, TriMesh};

/// Returns two triangles in scaled coordinates, with these displacements of each corner.
fn scaled_model(p: &[DVec3; 6], rank: usize, displacements: Vec<DVec3>) -> ScaledModel {
    let mesh = TriMesh::new(p.to_vec(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let modes = Modes::new(rank, displacements).unwrap();
    let model = ReducedModel::with_metric(mesh, modes, Metric::identity(rank)).unwrap();
    ScaledModel::new(&model, model.metric(), &vec![0.0; rank])
}

/// The rate is sufficient, and one that is larger by a millionth is not.
#[test]
fn slower_rates_are_the_largest_that_suffice() {
    for delta in [1e-9, 0.3, 1.0, 4e5] {
        let terms = AffineTerms { delta, at_rest: 0.1 * delta, slack: 0.2 * delta, rate_rounding: 0.01 };
        // 0.9 delta / ((rate + 0.01) delta + 0.2 delta) = 0.5
        let rate = terms.slower_than(0.5).unwrap();
        assert!((rate - 1.59).abs() < 1e-6, "{delta}: {rate}");
        assert!(terms.bound(rate) >= 0.5 && terms.bound(rate * (1.0 + 1e-6)) < 0.5, "{delta}");
        // The residuals alone are faster.
        assert!(terms.slower_than(5.0).is_none());
    }
}

/// The bound is at most the exact quotient of its terms, and close to it.
#[test]
fn bounds_of_terms_are_rounded_down() {
    let random = &mut Random::new(1);
    let larger = exact(1.0 + 1e-13);
    for case in 0..1000 {
        let delta = random.power(-9.0, 9.0);
        let terms = AffineTerms {
            delta,
            at_rest: 0.9 * delta * random.uniform(),
            slack: delta * random.power(-9.0, 9.0),
            rate_rounding: random.power(-9.0, 0.0),
        };
        let rate = random.power(-9.0, 9.0);
        let closing = (exact(rate) + exact(terms.rate_rounding)) * exact(delta) + exact(terms.slack);
        let product = exact(terms.bound(rate)) * closing;
        let gap = exact(delta) - exact(terms.at_rest);
        assert!(product <= gap && product * &larger >= gap, "case {case}");
    }
}

/// The terms are the residual with its rounding, the rounding of positions and what a clearance needs, for
/// triangles of any size and modes of any speed.
#[test]
fn terms_hold_residuals_rounding_and_clearance() {
    let agree = |x: f64, y: f64| (x - y).abs() <= 1e-12 * y;
    for case in 0..200 {
        let random = &mut Random::new(case);
        let rank = 1 + random.below(12);
        let [size, speed] = [(); 2].map(|()| random.power(-3.0, 3.0));
        let p: [DVec3; 6] =
            std::array::from_fn(|v| (random.vector() + DVec3::X * if v > 2 { 3.0 } else { 0.0 }) * size);
        let displacements = (0..6 * rank).map(|_| random.vector() * speed).collect();
        let scaled = scaled_model(&p, rank, displacements);
        let scaled = if case % 2 == 0 { scaled } else { scaled.keeping(0.1 * size, DISTANCE_ERROR) };
        let offsets = p.map(|x| x - p[0]);
        let mut affine = AffineBound::new(scaled.row_len);
        assert!(affine.fit(&offsets, |v| scaled.modes(v as u32)));
        let residual = if case % 3 == 0 { 0.0 } else { speed * random.power(-15.0, 0.0) };
        let pair = AffinePair {
            differences: &TwoTriangles { a: [p[0], p[1], p[2]], b: [p[3], p[4], p[5]] }.differences(),
            rest_distance: size,
            squared_residual: residual * residual,
        };
        let terms = affine.terms(&pair, &scaled);
        // The parts, from the definitions.
        let frobenius = affine.gradient().iter().map(|g| g * g).sum::<f64>().sqrt();
        let longest = offsets.iter().map(|d| d.length()).fold(0.0, f64::max);
        let (rounding, required) = (&scaled.rounding, scaled.required.along_unit());
        let [at_rest, per_norm] = [rounding.at_rest(DVec3::ONE), 2.0 * rounding.per_norm(DVec3::ONE)];
        let rounded = residual + (16.0 * f64::EPSILON * longest + 4.0 * at_rest) * frobenius;
        assert!(agree(affine.fit.residual_up(pair.squared_residual, rounding), rounded), "case {case}");
        assert!(agree(terms.slack, rounded + per_norm + required.per_norm), "case {case}: {}", terms.slack);
        assert!(agree(terms.at_rest, at_rest + required.at_rest), "case {case}: {}", terms.at_rest);
        let rate_rounding = 8.0 * f64::EPSILON * frobenius;
        assert!(agree(terms.rate_rounding, rate_rounding), "case {case}: {}", terms.rate_rounding);
        assert_eq!(terms.delta, size);
        // The sum is rounded up.
        let parts = [affine.fit.residual_up(pair.squared_residual, rounding), per_norm, required.per_norm];
        assert!(exact(terms.slack) >= parts.into_iter().map(exact).sum::<Dyadic>(), "case {case}");
    }
}

/// One mode stretches two triangles across the direction from one to the other. Over all directions the rate
/// is 1; over those between the triangles it is at most a third.
#[test]
fn rates_over_a_cone_improve_a_bound_that_does_not_suffice() {
    let p = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [3.0, 0.0], [4.0, 0.0], [3.0, 1.0]]
        .map(|[x, y]| DVec3::new(x, y, 0.0));
    let scaled = scaled_model(&p, 1, p.map(|p| DVec3::Y * p.y).to_vec());
    let pair = PairCorners::of(&scaled, [0, 1, 2], [3, 4, 5]);
    let differences = pair.differences();
    let mut affine = AffineBound::new(scaled.row_len);
    let mut bound = |sufficient| affine.fit_and_bound(&pair, &differences, 2.0, sufficient, &scaled);
    let (over_all, over_cone) = (bound(0.5), bound(2.0));
    assert!(over_all > 0.99 && over_all < 1.01, "{over_all}");
    assert!(over_cone >= 2.0, "{over_cone}");
}

/// Triangles are near if their distance is less than half of that of their farthest corners.
#[test]
fn near_triangles_are_less_than_half_as_far_as_their_corners() {
    let mut differences = [DVec3::X; 9];
    differences[4] = DVec3::new(2.0, -4.0, 4.0);
    for (rest_distance, expected) in [(0.1, true), (1.0, true), (2.9, true), (3.0, false), (3.1, false)] {
        assert_eq!(is_near(&differences, rest_distance), expected, "{rest_distance}");
    }
}
