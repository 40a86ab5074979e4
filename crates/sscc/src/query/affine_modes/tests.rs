//! Combinations of modes of shapes with handles, and their bounds.

use sscc_testing::{Dyadic, Numbers, common_denominator};

use super::super::exact_matrix::exact;
use super::*;
use crate::certificates::FactorScales;
use crate::{Modes, ReducedModel, TriMesh};

const HANDLES: usize = 3;
const RANK: usize = 12 * HANDLES;

fn vector(random: &mut Numbers) -> DVec3 {
    DVec3::new(random.signed(), random.signed(), random.signed())
}

/// Returns a cloud of triangles with three handles of twelve modes each, whose weights add up to 1.
fn handles(random: &mut Numbers) -> ReducedModel {
    let positions: Vec<DVec3> = (0..90).map(|_| vector(random)).collect();
    let places = [(); HANDLES].map(|()| vector(random));
    let modes = positions.iter().flat_map(|p| {
        let weights = places.map(|place| (-(*p - place).length_squared()).exp());
        let sum: f64 = weights.iter().sum();
        weights.into_iter().flat_map(move |w| {
            [p.x, p.y, p.z, 1.0].into_iter().flat_map(move |x| DVec3::AXES.map(|axis| axis * (w / sum * x)))
        })
    });
    let modes = Modes::new(RANK, modes.collect()).unwrap();
    let faces = (0..30).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    ReducedModel::new(TriMesh::new(positions, faces).unwrap(), modes).unwrap()
}

/// Returns the q that moves each handle by a map.
fn coordinates(map: impl Fn(usize) -> (DMat3, DVec3)) -> Vec<f64> {
    (0..HANDLES)
        .flat_map(|handle| {
            let (map, shift) = map(handle);
            let map = map - DMat3::IDENTITY;
            [map.x_axis, map.y_axis, map.z_axis, shift].into_iter().flat_map(|column| column.to_array())
        })
        .collect()
}

#[test]
fn affine_motion_of_all_handles_is_subtracted() {
    let random = &mut Numbers(4);
    for _ in 0..20 {
        let model = handles(random);
        let center = [0.0; RANK];
        let patch = PatchModel::new(&model, &center).unwrap();
        let modes = AffineModes::new(&patch).unwrap();
        assert_eq!(modes.combinations.len(), 12);
        let largest = modes.combinations.iter().map(|one| one.residual).fold(0.0, f64::max);
        assert!(largest < 1e-9, "{largest}");
        let sizes = FactorScales::new(&model, &center).unwrap().sizes;
        let factors = |q: Vec<f64>| -> Vec<f64> { q.iter().zip(&sizes).map(|(q, size)| q * size).collect() };
        let sum = |f: &[f64]| f.iter().map(|f| f.abs()).sum::<f64>();
        let turn =
            (DMat3::from_axis_angle(vector(random).normalize(), 3.0 * random.signed()), vector(random));
        let free = |factors: &[f64]| {
            let mut free = AffineFree::default();
            free.set(factors.iter().copied());
            modes.take_from(&mut free);
            free
        };
        let whole = factors(coordinates(|_| turn));
        let left = free(&whole);
        assert!(left.sum() < 1e-8 * sum(&whole), "{} {}", left.sum(), sum(&whole));
        let map = turn.0 - DMat3::IDENTITY;
        assert!(norm(&(left.map - map)) < 1e-8 * norm(&map), "{} {map}", left.map);
        // Motions that bend the shape are not subtracted.
        let bent =
            factors(coordinates(|handle| if handle == 0 { turn } else { (DMat3::IDENTITY, DVec3::ZERO) }));
        assert!(free(&bent).sum() > 0.05 * sum(&bent));
    }
    // There are no combinations for modes without affine motions, or for a shape in one plane.
    let positions: Vec<DVec3> = (0..30).map(|_| vector(random)).collect();
    let faces: Vec<[u32; 3]> = (0..10).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let modes = || Modes::new(2, (0..60).map(|i| DVec3::splat((i as f64).sin())).collect()).unwrap();
    let flat = positions.iter().map(|p| p.with_z(0.0)).collect();
    for positions in [positions.clone(), flat] {
        let model = ReducedModel::new(TriMesh::new(positions, faces.clone()).unwrap(), modes()).unwrap();
        assert!(AffineModes::new(&PatchModel::new(&model, &[0.0; 2]).unwrap()).is_none());
    }
}

/// Returns a cloud of triangles of which one half is the mirror image of the other in the origin, with mirrored modes: residuals of
/// mirrored vertices are opposite.
fn mirrored(random: &mut Numbers) -> ReducedModel {
    let half: Vec<(DVec3, Vec<DVec3>)> =
        (0..45).map(|_| (vector(random), (0..RANK).map(|_| vector(random)).collect())).collect();
    let sides = [1.0, -1.0];
    let positions = sides.iter().flat_map(|side| half.iter().map(move |(p, _)| *p * *side)).collect();
    let modes =
        sides.iter().flat_map(|side| half.iter().flat_map(move |(_, u)| u.iter().map(move |u| *u * *side)));
    let modes = Modes::new(RANK, modes.collect()).unwrap();
    let faces = (0..30).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    ReducedModel::new(TriMesh::new(positions, faces).unwrap(), modes).unwrap()
}

/// The bound holds for any combination and any map; this test takes random combinations with the maps that fit best.
#[test]
fn residuals_of_combinations_are_within_their_bounds() {
    let random = &mut Numbers(9);
    let mut tight = 0.0_f64;
    for case in 0..60 {
        let model = if case % 2 == 0 { handles(random) } else { mirrored(random) };
        let patch = PatchModel::new(&model, &[0.0; RANK]).unwrap();
        let fits = Fits::new(&patch, MOST_FITTED).unwrap();
        let directions: Vec<Vec<f64>> =
            (0..1 + case % 2).map(|_| (0..RANK).map(|_| random.signed()).collect()).collect();
        let modes = AffineModes::with_directions(&patch, &fits, directions);
        let factors: Vec<f64> = (0..RANK).map(|_| random.signed()).collect();
        let mut free = AffineFree::default();
        free.set(factors.iter().copied());
        modes.take_from(&mut free);
        // The displacement of a vertex by the affine part, apart from its map and translation.
        let taken: Vec<f64> = factors.iter().zip(&free.factors).map(|(f, rest)| f - rest).collect();
        let left = |v: u32| {
            let mut moved = DVec3::ZERO;
            patch.for_each_mode(v, |k, u| moved += u * taken[k]);
            moved - free.map * patch.position(v)
        };
        for (i, h) in (0..90).flat_map(|i| (0..i).map(move |h| (i, h))) {
            let residual = (left(i) - left(h)).length();
            assert!(residual <= free.length, "case {case}: {residual} {}", free.length);
            tight = tight.max(residual / free.length);
        }
    }
    assert!(tight > 0.9, "{tight}");
}

/// Residuals of combinations that move the shape by affine maps consist of rounding. The test also has other centres, and a vertex by
/// which no combination was fitted.
#[test]
fn residuals_include_their_rounding() {
    let random = &mut Numbers(21);
    let (mut rounded, mut left_out) = (0, 0);
    for case in 0..12 {
        let mut model = handles(random);
        if case % 3 == 2 {
            // One vertex moves alone. It is not among the 45 vertices by which maps are fitted.
            let mut modes: Vec<DVec3> = (0..90).flat_map(|v| model.modes().of_vertex(v).to_vec()).collect();
            modes[RANK] += DVec3::X * 1e-3;
            let modes = Modes::new(RANK, modes).unwrap();
            model = ReducedModel::new(model.mesh().clone(), modes).unwrap();
        }
        let bend = if case % 2 == 0 { 0.0 } else { 0.3 };
        let center: Vec<f64> = (0..RANK).map(|_| bend * random.signed()).collect();
        let patch = PatchModel::new(&model, &center).unwrap();
        let fits = Fits::new(&patch, 45).unwrap();
        let modes = AffineModes::with_directions(&patch, &fits, fits.null_vectors());
        assert!(modes.combinations.len() >= 12);
        // All lengths are multiplied by the sizes of the modes, so that they contain no quotients.
        let moving: Vec<usize> = (0..RANK).filter(|k| model.mode_displacement_bound(*k, 1.0) > 0.0).collect();
        let sizes: Vec<Dyadic> =
            moving.iter().map(|k| exact(model.mode_displacement_bound(*k, 1.0))).collect();
        let (denominator, others) = common_denominator(&sizes);
        for Combination { factors, map, residual } in &modes.combinations {
            let shift = fits.of(factors).1;
            let bound = exact(*residual) * &denominator;
            let bound = &bound * &bound;
            let mut most = exact(0.0);
            for v in 0..90 {
                let (u, p) = (model.modes().of_vertex(v), patch.position(v));
                let of_axis = |axis: usize| {
                    let moved: Dyadic = moving
                        .iter()
                        .zip(&others)
                        .map(|(k, others)| exact(u[*k][axis]) * exact(factors[*k]) * others)
                        .sum();
                    let mapped: Dyadic = (0..3).map(|c| exact(map.col(c)[axis]) * exact(p[c])).sum();
                    moved - (mapped + exact(shift[axis])) * &denominator
                };
                let square: Dyadic = (0..3).map(of_axis).map(|x| &x * &x).sum();
                most = most.max(square);
            }
            assert!(most <= bound, "case {case}");
            rounded += usize::from(*residual < 1e-9 && most > exact(0.0));
            left_out += usize::from(*residual > 1e-5);
        }
    }
    assert!(rounded > 50 && left_out > 5, "{rounded} {left_out}");
}

#[test]
fn the_rest_of_factors_is_within_its_error() {
    let random = &mut Numbers(2);
    let mut worst = [0.0_f64; 2];
    for case in 0..40 {
        let model = handles(random);
        let modes = AffineModes::new(&PatchModel::new(&model, &[0.0; RANK]).unwrap()).unwrap();
        let size = [1.0, 1e-200, 1e100, 1e-3][case % 4];
        let factors: Vec<f64> = (0..RANK).map(|_| random.signed() * size).collect();
        let mut free = AffineFree::default();
        free.set(factors.iter().copied());
        modes.take_from(&mut free);
        // Computes the numbers `a_j` again.
        let mut rest = factors.clone();
        let amounts = modes.combinations.iter().map(|one| {
            let a = dot(&rest, &one.factors);
            rest.iter_mut().zip(&one.factors).for_each(|(f, n)| *f -= a * n);
            a
        });
        let amounts: Vec<f64> = amounts.collect();
        assert_eq!(rest, free.factors);
        let mut error = exact(0.0);
        for (k, (f, computed)) in factors.iter().zip(&free.factors).enumerate() {
            let taken = modes.combinations.iter().zip(&amounts);
            let taken: Dyadic = taken.map(|(one, a)| exact(one.factors[k]) * exact(*a)).sum();
            error += (exact(*f) - taken - exact(*computed)).abs();
        }
        let mut map_error = exact(0.0);
        for e in 0..9 {
            let entry = |map: &DMat3| exact(map.to_cols_array()[e]);
            let sum: Dyadic =
                modes.combinations.iter().zip(&amounts).map(|(one, a)| entry(&one.map) * exact(*a)).sum();
            let difference = sum - entry(&free.map);
            map_error += &difference * &difference;
        }
        let bounds = [exact(free.error), exact(free.map_error) * exact(free.map_error)];
        for ((error, bound), worst) in [error, map_error].into_iter().zip(bounds).zip(&mut worst) {
            assert!(error <= bound, "case {case}");
            let [(n, of_n), (d, of_d)] = [error, bound].map(|x| x.mantissa_and_exponent());
            *worst = worst.max(n / d * 2.0_f64.powi(of_n - of_d));
        }
    }
    assert!(worst[0] > 1e-3 && worst[1] > 1e-6, "{worst:?}");
}

#[test]
fn error_bounds_are_those_of_their_terms() {
    let part = |k: usize, n: f64, x: f64, z: f64, residual: f64| {
        let factors = (0..3).map(|i| if i == k { n } else { 0.0 }).collect();
        (factors, DMat3::from_diagonal(DVec3::new(x, 0.0, z)), residual)
    };
    let parts = vec![part(0, 2.0, 3.0, 4.0, 0.1), part(1, 4.0, 6.0, 8.0, 0.2), part(2, 0.5, 0.3, 0.4, 0.3)];
    let mut free = AffineFree::default();
    free.set([3.0, 5.0, 64.0].into_iter());
    AffineModes::of_parts(parts).take_from(&mut free);
    // The amounts are 6, 20 and 32, the norms of the maps 5, 10 and 0.5.
    let unit = 10.0 * f64::EPSILON;
    for (found, least) in [(free.error, 180.0 * unit), (free.map_error, 246.0 * unit), (free.length, 28.4)] {
        assert!(found >= least && found <= least * (1.0 + 1e-9), "{found:e} {least:e}");
    }
    // A combination without residuals: what is left is the rounding bound.
    let p = [[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [-1.0, 1.0, 0.5]].map(DVec3::from);
    let modes = Modes::new(2, p.iter().flat_map(|p| [DVec3::X, DVec3::X * p.x]).collect()).unwrap();
    let mesh = TriMesh::new(p.to_vec(), vec![[0, 1, 2], [1, 2, 3]]).unwrap();
    let model = ReducedModel::new(mesh, modes).unwrap();
    let patch = PatchModel::new(&model, &[0.0; 2]).unwrap();
    let map = DMat3::from_diagonal(DVec3::new(3.0, 0.0, 0.0));
    let found = residual(&patch, &[5.0, 3.0], (map, DVec3::X * 5.0));
    let least = 8.0 * f64::EPSILON * (2.0 + 16.0) * (8.0 + 3.0 + 5.0);
    assert!(found >= least && found < 1.02 * least, "{found:e} {least:e}");
}
