//! Tests every bound against the true minimum, as far as a slow search finds it.

#![allow(clippy::print_stdout)] // statistics for those who tune the bounds

use glam::DVec3;
use sscc_testing::cases;

use super::models::{
    KINDS, ROOM, all_bounds, node_pair_bound, pair_corners, random_pair, reference, scaled_keeping,
};
use super::random::Random;
use crate::bounds::affine_bound::{AffineBound, AffinePair};
use crate::bounds::cone_rate::bound_rate_in_cone;
use crate::bounds::separating_direction::bound_rest_distance;
use crate::bounds::strain::StrainGram;
use crate::bounds::sub_triangle::SubPair;
use crate::bounds::{PairRefiner, PairWitness, RefinementTarget, WitnessList};
use crate::geometry::nearest_to_origin;
use crate::model::{ScaledModel, scale_direction};
use crate::{Metric, MetricKind, Modes, ReducedModel, TriMesh};

#[test]
fn no_bound_exceeds_the_true_minimum() {
    let mut checked = [0; KINDS];
    let mut ratios = Vec::new();
    for case in 0..cases(2600_u64) {
        let random = &mut Random::new(case);
        let kind = case as usize % KINDS;
        let model = random_pair(kind, random);
        let pair = reference(&model, [0, 1]);
        let Some(truth) = pair.true_minimum(4, random) else { continue };
        checked[kind] += 1;
        for (name, bound) in all_bounds(&model, random) {
            assert!(bound <= truth * ROOM, "case {case}, kind {kind}: {name} {bound:e} above {truth:e}");
            if name == "refine" && truth > 0.0 && pair.rank() >= 3 {
                ratios.push((bound / truth, kind));
            }
        }
        let safe = [pair.eq10_safe(), pair.line_estimate_safe(), pair.box_estimate_safe()];
        // The rounding of the reference is not bounded: kinds of pairs in which numbers cancel are left out.
        if ![2, 3, 4, 5, 6, 10, 12].contains(&kind) {
            for (i, bound) in safe.into_iter().enumerate() {
                assert!(
                    bound <= truth * (1.0 + 1e-6),
                    "case {case}: reference {i} {bound:e} above {truth:e}"
                );
            }
        }
    }
    println!("cases with a known minimum, by kind: {checked:?}");
    for kind in 0..KINDS {
        let mut of_kind: Vec<f64> = ratios.iter().filter(|r| r.1 == kind).map(|r| r.0).collect();
        of_kind.sort_by(f64::total_cmp);
        if let (Some(least), Some(median)) = (of_kind.first(), of_kind.get(of_kind.len() / 2)) {
            println!("kind {kind}: {} ratios, least {least:.3}, median {median:.3}", of_kind.len());
        }
    }
    let mut plain: Vec<f64> = ratios.iter().filter(|r| r.1 < 2).map(|r| r.0).collect();
    plain.sort_by(f64::total_cmp);
    assert!(plain[plain.len() / 2] >= 0.8, "median tightness {}", plain[plain.len() / 2]);
}

/// Powers of two times positions and modes change nothing but the exponent of the true minimum: bounds hold
/// near the ends of the range of numbers, where squares overflow or vanish.
#[test]
fn bounds_hold_for_extreme_sizes() {
    for case in 0..cases(900_u64) {
        let random = &mut Random::new(case + 50_000);
        let model = random_pair(case as usize % (KINDS - 1), random);
        let Some(truth) = reference(&model, [0, 1]).true_minimum(3, random) else { continue };
        let (size, speed) = (150 - random.below(1000) as i32, 150 - random.below(300) as i32);
        let (mesh, modes) = (model.mesh(), model.modes());
        let grow = |x: &[DVec3], power: i32| x.iter().map(|x| *x * 2.0_f64.powi(power)).collect::<Vec<_>>();
        let mesh = TriMesh::new(grow(mesh.rest_positions(), size), mesh.faces().to_vec()).unwrap();
        let modes = Modes::new(modes.rank(), grow(modes.displacements(), speed)).unwrap();
        let large = ReducedModel::with_metric(mesh, modes, model.metric().clone()).unwrap();
        let truth =
            truth * 2.0_f64.powi((size - speed) / 2) * 2.0_f64.powi((size - speed) - (size - speed) / 2);
        for (name, bound) in all_bounds(&large, random) {
            assert!(
                bound <= truth * ROOM,
                "case {case}, 2^{size} 2^{speed}: {name} {bound:e} above {truth:e}"
            );
        }
        let bound = node_pair_bound(&large, 1);
        assert!(
            bound <= truth * ROOM,
            "case {case}, 2^{size} 2^{speed}: node pair {bound:e} above {truth:e}"
        );
    }
}

#[test]
fn rest_distance_is_never_too_large() {
    for case in 0..600_u64 {
        let random = &mut Random::new(case + 10_000);
        let model = random_pair(case as usize % KINDS, random);
        let scaled = ScaledModel::new(&model, model.metric(), &vec![0.0; model.rank()]);
        let differences = pair_corners(&scaled).differences();
        let distance = reference(&model, [0, 1]).rest_distance(4, random);
        for dir in [nearest_to_origin(&differences).point, random.vector(), differences.iter().sum()] {
            let Some(dir) = scale_direction(dir) else { continue };
            let bound = bound_rest_distance(&differences, dir, &scaled.rounding);
            assert!(bound <= distance * ROOM, "case {case}: {bound:e} above {distance:e}");
        }
    }
}

/// Compares the rate on a cone with the rate at sampled directions of it.
#[test]
fn cone_rate_is_never_too_small() {
    for case in 0..3000_u64 {
        let random = &mut Random::new(case + 20_000);
        let rank = 1 + random.below(8);
        // Symmetric gradients, some nearly singular, and their Mandel components.
        let flat = if case % 3 == 0 { random.power(-9.0, 0.0) } else { 1.0 };
        let strains: Vec<[f64; 6]> = (0..rank)
            .map(|_| std::array::from_fn(|i| (random.uniform() - 0.5) * if i == 2 { flat } else { 1.0 }))
            .collect();
        let gram: StrainGram =
            std::array::from_fn(|i| std::array::from_fn(|j| strains.iter().map(|s| s[i] * s[j]).sum()));
        let axis = random.vector();
        let width = random.power(-17.0, 0.0);
        let d: [DVec3; 9] = match case % 4 {
            0 => [axis; 9],
            1 => std::array::from_fn(|_| axis * random.power(-3.0, 3.0)),
            _ => std::array::from_fn(|_| (axis + random.vector() * width) * random.power(-1.0, 1.0)),
        };
        let rate_at = |u: DVec3| {
            let root = std::f64::consts::SQRT_2;
            let m = [u.x * u.x, u.y * u.y, u.z * u.z, u.y * u.z * root, u.x * u.z * root, u.x * u.y * root];
            let forms = strains.iter().map(|s| s.iter().zip(m).map(|(s, m)| s * m).sum::<f64>());
            forms.map(|f| f * f).sum::<f64>().sqrt()
        };
        for wanted in [0.0, 0.1, f64::INFINITY] {
            let rate = bound_rate_in_cone(&d, &gram, rank.next_multiple_of(4), wanted, 1e-12);
            for sample in 0..60 {
                let u: DVec3 = if sample < 9 {
                    d[sample]
                } else {
                    d.iter().map(|d| *d * random.uniform().powi(4)).sum()
                };
                let here = rate_at(u.normalize());
                assert!(here <= rate * ROOM, "case {case}: {here:e} above {rate:e}");
            }
        }
    }
}

#[test]
fn node_pair_bounds_hold_for_all_their_pairs() {
    let mut positive = 0;
    for case in 0..700_u64 {
        let random = &mut Random::new(case + 30_000);
        let rank = if case % 5 == 0 { 1 + random.below(30) } else { 1 + random.below(8) };
        let (count, split) = (2 + random.below(5), 1);
        let split = split + random.below(count - 1);
        let size = random.power(-2.0, 0.0);
        let gap = random.power(-2.0, 1.0);
        let p: Vec<DVec3> = (0..3 * count)
            .map(|v| {
                random.vector() * size
                    + if v < 3 * split { DVec3::ZERO } else { DVec3::X * (gap + 2.0 * size) }
            })
            .collect();
        let offset = if case % 4 == 0 { random.vector() * random.power(0.0, 10.0) } else { DVec3::ZERO };
        let (linear, quadratic) = (random.power(-3.0, 0.0), random.power(-6.0, 0.0));
        let common = if case % 3 == 0 { random.power(0.0, 8.0) } else { 0.0 };
        let flat = if case % 7 == 0 { random.power(-12.0, -1.0) } else { 1.0 };
        let mut columns: Vec<Vec<DVec3>> = Vec::new();
        for _ in 0..rank {
            let (g, t, c) =
                ([(); 3].map(|()| random.vector()), [random.vector(), random.vector()], random.vector());
            columns.push(
                (0..3 * count)
                    .map(|v| {
                        let x = p[v];
                        let moved = t[usize::from(v < 3 * split)]
                            + (g[0] * x.x + g[1] * x.y + g[2] * x.z) * linear
                            + random.vector() * quadratic;
                        moved * DVec3::new(flat, 1.0, 1.0) + c * common
                    })
                    .collect(),
            );
        }
        let displacements = (0..3 * count).flat_map(|v| columns.iter().map(move |c| c[v])).collect();
        let faces = (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let mesh = TriMesh::new(p.iter().map(|p| *p + offset).collect(), faces).unwrap();
        let modes = Modes::new(rank, displacements).unwrap();
        let model = if case % 2 == 0 {
            ReducedModel::new(mesh, modes).unwrap()
        } else {
            let scales = (0..rank).map(|_| random.power(-6.0, 6.0)).collect();
            let metric = Metric::from_scales(MetricKind::Given, scales).unwrap();
            ReducedModel::with_metric(mesh, modes, metric).unwrap()
        };
        let bound = node_pair_bound(&model, split as u32);
        positive += u32::from(bound > 0.0);
        for x in 0..split as u32 {
            for y in split as u32..count as u32 {
                if let Some(truth) = reference(&model, [x, y]).true_minimum(3, random) {
                    assert!(bound <= truth * ROOM, "case {case}, {x} {y}: {bound:e} above {truth:e}");
                }
            }
        }
    }
    assert!(positive > 400, "{positive}");
}

/// Along n = (1, -1, 0) the relative modes nearly cancel: computed from their Gram matrix, the closing rate is exactly 0, which
/// would give an infinite radius. The bound must include the mode of 1e-9 that remains.
#[test]
fn cancelling_modes_keep_node_pair_bounds_finite() {
    let (a, b) = (DVec3::new(1.0, 1.0, 0.0), DVec3::new(1e-9, 0.0, 0.0));
    let n = DVec3::new(1.0, -1.0, 0.0);
    let form = |m: [f64; 3]| n.x * n.x * m[0] + 2.0 * n.x * n.y * m[1] + n.y * n.y * m[2];
    assert_eq!(form([a.x * a.x + b.x * b.x, a.x * a.y + b.x * b.y, a.y * a.y + b.y * b.y]), 0.0);

    let corners = [DVec3::ZERO, DVec3::Z * 0.25, DVec3::new(0.125, 0.125, 0.125)];
    let p = [corners, corners.map(|p| p + n)].concat();
    let displacements = (0..6).flat_map(|v| [a, b].map(|u| if v < 3 { DVec3::ZERO } else { u })).collect();
    let mesh = TriMesh::new(p, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let modes = Modes::new(2, displacements).unwrap();
    let model = ReducedModel::with_metric(mesh, modes, Metric::identity(2)).unwrap();
    // Y = X + n returns to X where z_0 + 1e-9 z_1 = -1 and z_0 = 1.
    let truth = 2e9_f64.hypot(1.0);
    let bound = node_pair_bound(&model, 1);
    assert!(bound > 0.0 && bound <= truth, "{bound:e}");
    for (name, bound) in all_bounds(&model, &mut Random::new(1)) {
        assert!(bound <= truth * ROOM, "{name} {bound:e}");
    }
}

/// Returns two triangles with these modes of each corner, in the Euclidean metric.
fn two_triangles(positions: [DVec3; 6], modes: [&[DVec3]; 6]) -> ReducedModel {
    let mesh = TriMesh::new(positions.to_vec(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let rank = modes[0].len();
    ReducedModel::with_metric(mesh, Modes::new(rank, modes.concat()).unwrap(), Metric::identity(rank))
        .unwrap()
}

/// One mode lowers the upper triangle: the upper bound is the height, less a clearance, whatever the size of
/// the pair.
#[test]
fn rays_find_the_first_contact() {
    for (height, share) in [1e-3, 1.0, 1e3].into_iter().flat_map(|height| [(height, 0.0), (height, 0.5)]) {
        let low = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let [x, y, z] = low.map(|p| p + DVec3::Z * height);
        let (still, down) = ([DVec3::ZERO], [-DVec3::Z]);
        let modes: [&[DVec3]; 6] = [&still, &still, &still, &down, &down, &down];
        let model = two_triangles([low[0], low[1], low[2], x, y, z], modes);
        let scaled = scaled_keeping(&model, share * height);
        let mut target =
            RefinementTarget { cap: f64::INFINITY, upper: f64::INFINITY, epsilon: 1e-3, subdivisions: 4 };
        let lower = PairRefiner::new(&scaled).refine([0, 1, 2], [3, 4, 5], &mut target);
        let truth = height * (1.0 - share);
        assert!(lower <= truth && lower >= truth * (1.0 - 1e-6), "{lower:e} {truth:e}");
        assert!((target.upper / truth - 1.0).abs() < 1e-6, "{:e} {truth:e}", target.upper);
    }
}

/// Quarters have half of the variation.
#[test]
fn the_triangle_whose_modes_vary_more_is_divided() {
    for (first, second) in [(1.0, 2.0), (2.0, 1.0), (1.0, 1.0), (3.0, 2.0)] {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let [x, y, z] = corners.map(|p| p + DVec3::Z);
        let (still, one, two) = ([DVec3::ZERO], [DVec3::X * first], [DVec3::X * second]);
        let modes: [&[DVec3]; 6] = [&still, &one, &still, &still, &two, &still];
        let model = two_triangles([corners[0], corners[1], corners[2], x, y, z], modes);
        let scaled = scaled_keeping(&model, 0.0);
        let pair = pair_corners(&scaled);
        assert_eq!(SubPair::UNDIVIDED.is_first_divided(&pair), first >= second, "{first} {second}");
        let [quarter, ..] = SubPair::UNDIVIDED.subdivide(true);
        assert_eq!(quarter.is_first_divided(&pair), first >= 2.0 * second, "{first} {second}");
        let [quarter, ..] = SubPair::UNDIVIDED.subdivide(false);
        assert_eq!(quarter.is_first_divided(&pair), 2.0 * first >= second, "{first} {second}");
    }
}

/// Along a fixed direction two triangles of one plane that rotates have a bound of 1, by the affine map of some hundred.
#[test]
fn pairs_that_rotate_together_have_an_affine_witness() {
    let positions = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [2.0, 0.0], [3.0, 0.0], [2.0, 1.0]]
        .map(|[x, y]| DVec3::new(x, y, 0.0));
    let modes = positions.map(|p| [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis.cross(p)));
    let model = two_triangles(positions, modes.each_ref().map(|modes| &modes[..]));
    let scaled = scaled_keeping(&model, 0.0);
    let mut list = WitnessList::default();
    assert!(PairRefiner::new(&scaled).prove([0, 1, 2], [3, 4, 5], 10.0, &mut list));
    let [PairWitness::Affine { gradient, .. }] = &list.witnesses[..] else { panic!("{list:?}") };
    // The gradient of a rotation about each axis.
    for (k, c, j) in (0..27).map(|at| (at / 9, at / 3 % 3, at % 3)) {
        let (found, expected) =
            (gradient[(3 * c + j) * scaled.row_len + k], DVec3::AXES[k].cross(DVec3::AXES[j])[c]);
        assert!((found - expected).abs() < 0.01, "mode {k}, {c} {j}: {found}, not {expected}");
    }
}

/// Two thin layers, which modes lift by their height and by a tilt: all of their points meet at a known z. The fit has hardly a
/// gradient across such layers, so the residuals hold how they close.
#[test]
fn residuals_hold_how_thin_layers_close() {
    for (normal, tilt) in (0..9).map(|at| (at / 3, at % 3)).filter(|(normal, tilt)| normal != tilt) {
        let [n, t, w] = [normal, tilt, 3 - normal - tilt].map(|axis| DVec3::AXES[axis]);
        let layer = [DVec3::ZERO, t, w];
        let p = [layer, layer.map(|p| p + n * 0.003)].concat();
        for moving in [0..1, 1..2, 2..3, 3..4, 0..4_usize] {
            let of_vertex = |p: &DVec3| -> [DVec3; 4] {
                let lift = n * (p.dot(n) + p.dot(t));
                std::array::from_fn(|k| if moving.contains(&k) { lift } else { DVec3::ZERO })
            };
            let modes = Modes::new(4, p.iter().flat_map(of_vertex).collect()).unwrap();
            let mesh = TriMesh::new(p.clone(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
            let model = ReducedModel::with_metric(mesh, modes, Metric::identity(4)).unwrap();
            // Both layers are at height -tilt where the sum of the moving coordinates is -1.
            let truth = 1.0 / (moving.len() as f64).sqrt();
            for (name, bound) in all_bounds(&model, &mut Random::new(1)) {
                assert!(
                    bound <= truth * ROOM,
                    "{normal} {tilt} {moving:?}: {name} {bound:e} above {truth:e}"
                );
            }
            let bound = node_pair_bound(&model, 1);
            assert!(bound <= truth * ROOM, "{normal} {tilt} {moving:?}: node pair {bound:e} above {truth:e}");
        }
    }
}

/// A witness of the affine bound has a rate that proves the radius, and a pyramid that contains the directions with a margin for the
/// rounding of corners.
#[test]
fn affine_witnesses_prove_their_radius() {
    let (size, radius) = (1e-3, 0.5);
    let plane = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [2.0, 0.0], [3.0, 0.0], [2.0, 1.0]];
    let p = plane.map(|[x, y]| DVec3::new(1000.0 + x * size, y * size, 0.0));
    // The plane contracts along x: the triangles meet at |z| = 1.
    let modes = Modes::new(1, plane.map(|[x, _]| DVec3::X * (-x * size)).to_vec()).unwrap();
    let mesh = TriMesh::new(p.to_vec(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let model = ReducedModel::with_metric(mesh, modes, Metric::identity(1)).unwrap();
    let scaled = ScaledModel::new(&model, model.metric(), &[0.0]);
    let pair = pair_corners(&scaled);
    let differences = pair.differences();
    let dir = scale_direction(nearest_to_origin(&differences).point).unwrap();
    let rest_distance = bound_rest_distance(&differences, dir, &scaled.rounding);
    let mut affine = AffineBound::new(scaled.row_len);
    let bound = affine.fit_and_bound(&pair, &differences, rest_distance, 0.0, &scaled);
    assert!(bound > 0.9 && bound <= ROOM, "{bound}");
    let residuals = (0..9).map(|ij| affine.squared_residual(ij / 3, 3 + ij % 3));
    let squared_residual = residuals.fold(0.0, f64::max);
    let near = AffinePair { differences: &differences, rest_distance, squared_residual };
    let (rate, pyramid) = affine.witness(near, radius, &scaled).unwrap();
    let closing = rate * rest_distance + squared_residual.sqrt();
    assert!(rest_distance >= radius * closing, "{rate}");
    for (i, u) in pyramid.iter().enumerate() {
        let side = u.cross(pyramid[(i + 1) % 4]).normalize();
        let inside = differences.iter().map(|d| side.dot(d.normalize())).fold(f64::INFINITY, f64::min);
        assert!(inside > 2e-8 && inside < 1e-6, "side {i}: {inside:e}");
        // The rate holds at the edges of the pyramid: along u the plane contracts by u_x^2.
        assert!(u.x * u.x <= rate * 1.001, "{u} {rate}");
    }
    // No rate proves a radius beyond the contact.
    assert!(affine.witness(near, 1.1, &scaled).is_none());
}
