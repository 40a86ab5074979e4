//! Compares lower bounds of stretches with exact arithmetic.

use glam::DVec3;
use sscc_testing::{Dyadic, Numbers};

use super::super::exact_matrix::{exact, gram, is_above, matrix, of_map};
use super::*;

/// Returns a rotation or a map of any kind.
fn random_map(random: &mut Numbers, case: usize) -> DMat3 {
    let turn = |random: &mut Numbers| {
        DMat3::from_axis_angle((random.vector() + DVec3::X * 1e-3).normalize(), 4.0 * random.signed())
    };
    let stretch = match case % 6 {
        0 => random.vector() * 2.0,
        1 => DVec3::new(1.0, 1.0, random.signed()),
        2 => DVec3::new(1.0, 1.0 + random.power(-16.0, -1.0), random.power(-16.0, 0.0)),
        3 => DVec3::splat(1.0),
        4 => DVec3::new(random.power(-8.0, 8.0), random.power(-8.0, 8.0), random.power(-8.0, 8.0)),
        _ => DVec3::new(1.0, random.signed(), 0.0),
    };
    let size = if case % 4 == 3 { random.power(-60.0, 60.0) } else { 1.0 };
    turn(random) * DMat3::from_diagonal(stretch) * turn(random) * size
}

#[test]
fn eigenvalues_are_lower_bounds() {
    let random = &mut Numbers(1);
    let (mut close, mut stretches) = (0, 0);
    for case in 0..3000 {
        let map = random_map(random, case);
        let symmetric = (map + map.transpose()) * 0.5;
        let least = smallest_eigenvalue(&map);
        let exact_symmetric = of_map(&symmetric);
        assert!(least < f64::INFINITY);
        let size: f64 = symmetric.to_cols_array().iter().map(|x| x.abs()).sum();
        if least > f64::NEG_INFINITY {
            assert!(is_above(&exact_symmetric, &exact(least)), "case {case}: {map}");
            close += usize::from(!is_above(&exact_symmetric, &exact(least + 3e-6 * size)));
        }
        // The singular values of the map itself.
        let stretch = smallest_stretch(&map);
        if stretch > 0.0 {
            assert!(is_above(&gram(&of_map(&map)), &(exact(stretch) * exact(stretch))), "case {case}: {map}");
            stretches += 1;
        }
    }
    assert!(close > 2900 && stretches > 1500, "{close} {stretches}");
    let nan = DMat3::from_diagonal(DVec3::new(1.0, f64::NAN, 1.0));
    let infinite = DMat3::IDENTITY * f64::INFINITY;
    for map in [nan, infinite, DMat3::from_diagonal(DVec3::new(1.0, f64::INFINITY, 1.0))] {
        assert!(smallest_stretch(&map) <= 0.0 && smallest_eigenvalue(&map) == f64::NEG_INFINITY);
        assert!(nearest_rotation(&map).is_none());
    }
    // The closed form loses half of the digits if eigenvalues are equal.
    for case in 0..20_000 {
        let off = random.power(-9.0, -7.0);
        let map = random_map(random, 3) * DMat3::IDENTITY;
        let near = map.transpose() * DMat3::from_diagonal(DVec3::new(1.0, 1.0, 1.0 + off)) * map;
        let near = (near + near.transpose()) * 0.5;
        assert!(is_above(&of_map(&near), &exact(smallest_eigenvalue(&near))), "case {case}: {near}");
    }
}

/// Squares of the numbers underflow: the result of the closed form is useless, and the factorisation decides.
#[test]
fn eigenvalues_of_tiny_matrices_are_lower_bounds() {
    let random = &mut Numbers(7);
    let mut found = 0;
    // Because of underflow, the closed form returns the equal numbers on the diagonal as eigenvalues.
    let off = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.9, 0.0, 0.9, 1.0]);
    assert!(smallest_eigenvalue_of(&(off * 1e-170), 1e-12) < 0.11e-170);
    for case in 0..2000 {
        let map = DMat3::from_cols_array(&[(); 9].map(|()| random.signed())) * random.power(-220.0, -100.0);
        let symmetric =
            map + map.transpose() + DMat3::from_diagonal(map.to_cols_array()[case % 9].abs() * DVec3::ONE);
        let least = smallest_eigenvalue_of(&symmetric, 1e-12);
        if least > f64::NEG_INFINITY {
            assert!(is_above(&of_map(&symmetric), &exact(least)), "case {case}: {symmetric}");
            found += 1;
        }
    }
    assert!(found > 500, "{found}");
}

#[test]
fn rotations_are_orthogonal() {
    let random = &mut Numbers(2);
    let (mut found, mut good) = (0, 0);
    for case in 0..6000 {
        let map = random_map(random, case);
        let Some(turn) = nearest_rotation(&map) else { continue };
        found += 1;
        let wrong = turn.transpose() * turn - DMat3::IDENTITY;
        let worst = wrong.to_cols_array().iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        assert!(worst < 4e-15, "case {case}: {worst}");
        let stretch = smallest_stretch(&map);
        let size = map.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
        let along = smallest_eigenvalue(&(turn.transpose() * map));
        assert!(along <= stretch + 2e-3 * size, "case {case}: {along} {stretch}");
        good += usize::from(stretch > 1e-3 * size && along > 0.99 * stretch);
    }
    assert!(found > 4000 && good > 2500, "{found} {good}");
    // The columns of these maps are parallel up to rounding.
    let (mut found, mut none) = (0, 0);
    for case in 0..20_000 {
        let (column, row) = (random.vector(), random.vector());
        let of =
            |x: f64, random: &mut Numbers| column * x * (1.0 + random.power(-17.0, -14.0) * random.signed());
        let map = DMat3::from_cols(of(row.x, random), of(row.y, random), of(row.z, random));
        let Some(turn) = nearest_rotation(&map) else {
            none += 1;
            continue;
        };
        found += 1;
        let cosine = turn.x_axis.dot(turn.y_axis).abs();
        assert!(cosine <= ORTHOGONAL, "case {case}: {cosine}");
    }
    assert!(found > 100 && none > 100, "{found} {none}");
}

/// The distance of the two maps from their mean is close to that at which the kind of bound changes.
#[test]
fn stretches_between_two_maps_are_lower_bounds() {
    let random = &mut Numbers(3);
    let (mut short, mut long) = (0, 0);
    for case in 0..600 {
        let near = 1.0 + 0.3 * random.power(-16.0, 0.0) * [1.0, -1.0][case % 2];
        let distance = if case % 3 == 0 { 3.0 * random.signed().abs() } else { SHORT * near };
        let other = DMat3::from_cols_array(&[(); 9].map(|()| random.signed()));
        let half = other * (distance / norm(&other));
        // Maps close to rotations, or any maps.
        let middle = if case % 4 < 2 {
            let turn =
                DMat3::from_axis_angle((random.vector() + DVec3::X * 1e-3).normalize(), random.signed());
            turn + DMat3::from_cols_array(&[(); 9].map(|()| 0.1 * random.signed()))
        } else {
            random_map(random, 4 * case + 1)
        };
        let ends = [middle - half, middle + half];
        let bounds = stretches_between(&ends);
        if bounds == [0.0; 2] {
            continue;
        }
        let is_short = bounds[0].to_bits() == bounds[1].to_bits();
        (short, long) = (short + usize::from(is_short), long + usize::from(!is_short));
        let exact_ends = ends.map(|map| of_map(&map));
        for t in [0.0, 0.25, 0.5, 0.625, 1.0] {
            let mix = |x: Dyadic, y: Dyadic| x * exact(1.0 - t) + y * exact(t);
            let [x, y] = &exact_ends;
            let map = matrix(|i, j| mix(x[i][j].clone(), y[i][j].clone()));
            let least = mix(exact(bounds[0]), exact(bounds[1]));
            assert!(is_above(&gram(&map), &(&least * &least)), "case {case}: {t} of {ends:?}");
        }
    }
    assert!(short > 100 && long > 100, "{short} {long}");
}

#[test]
fn maps_out_of_range_have_no_stretches() {
    let good = DMat3::IDENTITY;
    for out_of_range in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e200, -1e300] {
        let diagonal = DMat3::from_diagonal(DVec3::splat(out_of_range));
        let mut one = good;
        one.y_axis.z = out_of_range;
        for bad in [diagonal, one] {
            for ends in [[bad, good], [good, bad], [bad, bad], [bad, -bad]] {
                assert_eq!(stretches_between(&ends), [0.0; 2], "{ends:?}");
            }
        }
    }
}

/// A quarter turn, whose smallest stretch is lost in the rounding of its square.
#[test]
fn what_is_lost_is_subtracted() {
    let map = DMat3::from_cols_array(&[1e-9, 1.0, 0.0, -1.0, 1e-9, 0.0, 0.0, 0.0, 1e-9]);
    let found = smallest_eigenvalue(&map);
    assert!(found < 1e-9 - 1.4e-14 && found > 1e-9 - 1.6e-14, "{found:e}");
}
