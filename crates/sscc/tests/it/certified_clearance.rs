//! Certificates with a clearance: radii are compared with exact distances, answers with all pairs of triangles.

use std::sync::Arc;

use glam::DVec3;
use num_rational::BigRational;
use sscc::parts::{CertificateParts, Scope};
use sscc::{
    AuditOptions, Certificates, CertifyOptions, Clearance, ContactFilter, Error, KineticQuery, Method,
    Metric, MetricKind, Modes, NearPair, Neighbours, Pair, Proof, Query, ReducedModel, TriMesh, audit,
    distance_triangle_triangle,
};
use sscc_testing::{cases, squared_distance};

use crate::common::{Random, after, at, critical_z, random_choices, random_model, winding_strip};

/// Returns the largest extent of the shape at the centre.
fn size(model: &ReducedModel, center: &[f64]) -> f64 {
    let positions = model.positions(center).unwrap();
    let used = model.mesh().faces().as_flattened().iter().map(|v| positions[*v as usize]);
    let (lower, upper) = used.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, u), x| (l.min(x), u.max(x)));
    (upper - lower).max_element()
}

/// Returns the model number `seed`: of few triangles of any kind, or of several buckets.
fn numbered_model(seed: u64) -> ReducedModel {
    if seed.is_multiple_of(3) { winding_strip(&mut Random::new(seed), seed) } else { random_model(seed) }
}

/// Returns a tiny or large clearance, with rings.
fn random_clearance(random: &mut Random, size: f64) -> Option<Clearance> {
    let clearance = Clearance::new(size * random.power(-6.0, -0.3)).ok()?;
    Some(clearance.beyond_rings([1, 1, 2, 3, 5][random.below(5)]))
}

/// Computes certificates with a clearance; `None` if that takes too long.
fn certify(model: &ReducedModel, options: &CertifyOptions, clearance: Clearance) -> Option<Certificates> {
    let options = |epsilon| options.clone().epsilon(epsilon).clearance(clearance).threads(1);
    [0.1, 0.9, 0.999]
        .into_iter()
        .find_map(|epsilon| Certificates::compute(model, &options(epsilon), &after(401)).ok())
}

/// Returns for each two triangles whether they are within `rings` rings of each other, by steps over common vertices.
fn within_rings(model: &ReducedModel, scope: &Scope, rings: u32) -> Vec<Vec<bool>> {
    let (faces, rest) = (model.mesh().faces(), model.mesh().rest_positions());
    let is_same = |v: u32, w: u32| {
        v == w
            || scope.filter.weld
                && rest[v as usize] == rest[w as usize]
                && model.modes().of_vertex(v) == model.modes().of_vertex(w)
    };
    let touch = |a: usize, b: usize| faces[a].iter().any(|v| faces[b].iter().any(|w| is_same(*v, *w)));
    let count = faces.len();
    let neighbours: Vec<Vec<usize>> =
        (0..count).map(|a| (0..count).filter(|b| touch(a, *b)).collect()).collect();
    (0..count)
        .map(|start| {
            let mut reached = vec![false; count];
            reached[start] = true;
            for _ in 0..rings.max(1) {
                let all: Vec<usize> = (0..count).filter(|t| reached[*t]).collect();
                all.iter().flat_map(|t| &neighbours[*t]).for_each(|t| reached[*t] = true);
            }
            reached
        })
        .collect()
}

/// Returns all pairs that count for a clearance, at any distance.
fn counted_pairs(model: &ReducedModel, scope: &Scope, rings: u32) -> Vec<Pair> {
    let within = within_rings(model, scope, rings);
    let count = within.len() as u32;
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
    let is_counted = |pair: &Pair| {
        let (a, b) = *pair;
        !within[a as usize][b as usize]
            && scope.filter.ignored().binary_search(pair).is_err()
            && scope.filter.groups().is_none_or(|groups| groups.is_pair_counted(a, b))
    };
    pairs.filter(is_counted).collect()
}

fn corners(model: &ReducedModel, positions: &[DVec3], t: u32) -> [DVec3; 3] {
    model.mesh().faces()[t as usize].map(|v| positions[v as usize])
}

/// Returns all near pairs at q, by a test of each pair.
fn near_by_brute_force(
    model: &ReducedModel,
    scope: &Scope,
    q: &[f64],
    clearance: &Clearance,
) -> Vec<NearPair> {
    let positions = model.positions(q).unwrap();
    let distance = |(a, b): Pair| {
        distance_triangle_triangle(&corners(model, &positions, a), &corners(model, &positions, b))
    };
    counted_pairs(model, scope, clearance.rings())
        .into_iter()
        .map(|pair| NearPair { pair, distance: distance(pair) })
        .filter(|near| near.distance < clearance.distance())
        .collect()
}

/// Whether two triangles are nearer than a distance, in exact arithmetic.
fn is_nearer(a: &[DVec3; 3], b: &[DVec3; 3], distance: f64) -> bool {
    let still = |t0: [DVec3; 3]| sscc::MovingTriangle { t0, t1: t0 };
    let distance = BigRational::from_float(distance).unwrap();
    squared_distance(&still(*a), &still(*b), 0.5) < &distance * &distance
}

/// Returns the q in the direction of z just inside a radius.
fn just_inside(scope: &Scope, z: &[f64], radius: f64) -> Option<Vec<f64>> {
    let norm = z.iter().map(|x| x * x).sum::<f64>().sqrt();
    if !(norm > 0.0 && norm.is_finite()) {
        return None;
    }
    [0.0, 1e-15, 4e-15, 1.6e-14, 1e-12, 1e-9].into_iter().find_map(|less| {
        let scaled: Vec<f64> = z.iter().map(|x| x / norm * radius * (1.0 - less)).collect();
        let q = at(scope, &scaled);
        let offset: Vec<f64> = q.iter().zip(&scope.center).map(|(q, c)| q - c).collect();
        (scope.metric.norm(&offset).unwrap() < radius).then_some(q)
    })
}

/// Returns the pairs of nodes with radii: nodes with themselves, and pairs of the root's children.
fn claims(parts: &CertificateParts) -> Vec<(u32, u32, f64)> {
    let nodes = parts.hierarchy.nodes();
    let mut claims: Vec<(u32, u32, f64)> =
        parts.node_radii.iter().enumerate().map(|(n, r)| (n as u32, n as u32, *r)).collect();
    let children: Vec<u32> = nodes[0].children().collect();
    let pairs = (0..children.len()).flat_map(|i| (i + 1..children.len()).map(move |j| (i, j)));
    claims.extend(pairs.zip(&parts.root_pair_radii).map(|((i, j), r)| (children[i], children[j], *r)));
    claims
}

#[test]
fn below_radii_no_pair_is_nearer_than_the_clearance() {
    let (mut tested, mut attacked, mut exact) = (0, 0, 0);
    for seed in 0..cases(600_u64) {
        let model = numbered_model(seed);
        let random = &mut Random::new(seed + 9_000_000);
        let options = random_choices(seed, &model).options.budget(if seed % 2 == 0 { 0 } else { 16 });
        let Some(clearance) = random_clearance(random, size(&model, &vec![0.0; model.rank()])) else {
            continue;
        };
        let Some(certificates) = certify(&model, &options, clearance) else { continue };
        tested += 1;
        let parts = certificates.parts();
        let scope = &parts.scope;
        assert_eq!(certificates.clearance(), Some(clearance));
        let counted = counted_pairs(&model, scope, clearance.rings());
        let is_claimed = |pair: &&Pair| scope.exceptions.binary_search(*pair).is_err();
        let counted: Vec<Pair> = counted.iter().filter(is_claimed).copied().collect();
        for (n, m, radius) in claims(parts) {
            if radius <= 0.0 {
                continue;
            }
            let radius = if radius.is_finite() { radius } else { random.power(-2.0, 3.0) };
            let of = |n: u32| {
                let node = &parts.hierarchy.nodes()[n as usize];
                &parts.hierarchy.order()[node.first_triangle as usize..][..node.triangle_count as usize]
            };
            let [x, y] = [n, m].map(of);
            let is_within = |(a, b): &&Pair| x.contains(a) && y.contains(b) || x.contains(b) && y.contains(a);
            let own: Vec<Pair> = counted.iter().filter(is_within).copied().collect();
            for turn in 0..if own.is_empty() { 0 } else { 3 } {
                // The direction is random, or that of the first contact among some pairs.
                let z = match turn {
                    0 => (0..model.rank()).map(|_| random.signed()).collect(),
                    _ => {
                        let length = |z: &Vec<f64>| z.iter().map(|x| x * x).sum::<f64>();
                        let some =
                            (0..own.len().min(12)).map(|_| own[random.below(own.len())]).collect::<Vec<_>>();
                        let critical =
                            some.into_iter().filter_map(|pair| critical_z(&model, scope, pair, random));
                        match critical.min_by(|a, b| length(a).total_cmp(&length(b))) {
                            Some(z) => z,
                            None => continue,
                        }
                    }
                };
                let Some(q) = just_inside(scope, &z, radius) else { continue };
                let Ok(positions) = model.positions(&q) else { continue };
                attacked += 1;
                for &(a, b) in &own {
                    let [t, u] = [a, b].map(|t| corners(&model, &positions, t));
                    let distance = distance_triangle_triangle(&t, &u);
                    assert!(
                        distance >= clearance.distance(),
                        "model {seed}: {a} {b} at {distance:e} of {clearance:?} within {n} {m}, q = {q:?}"
                    );
                    if distance < clearance.distance() * 2.0 {
                        exact += 1;
                        assert!(!is_nearer(&t, &u, clearance.distance()), "model {seed}: {a} {b} {q:?}");
                    }
                }
            }
        }
    }
    assert!(tested > cases(600) / 2 && attacked > tested && exact > 20, "{tested} {attacked} {exact}");
}

/// The audit attacks stored pairs, absent ones and answers.
#[test]
fn audits_find_no_violation() {
    let (mut samples, mut tested) = (0, 0);
    for seed in 0..cases(160_u64) {
        let model = numbered_model(seed + 5000);
        let random = &mut Random::new(seed + 9_100_000);
        let options = random_choices(seed, &model).options.budget(64);
        let Some(clearance) = random_clearance(random, size(&model, &vec![0.0; model.rank()])) else {
            continue;
        };
        let Some(certificates) = certify(&model, &options, clearance) else { continue };
        let report =
            audit(&model, &certificates, &AuditOptions::default().samples(150).threads(1), &()).unwrap();
        assert!(report.violations.is_empty(), "model {seed}, {clearance:?}: {:?}", report.violations);
        (samples, tested) = (samples + report.samples, tested + 1);
    }
    assert!(tested > cases(160) / 2 && samples > 50 * tested, "{tested} {samples}");
}

/// An audit finds radii that are too large.
#[test]
fn audits_find_radii_that_are_too_large() {
    let mut refuted = 0;
    for share in [0.05, 0.1, 0.25, 0.5] {
        let (model, clearance) = (two_plates(), Clearance::new(share).unwrap());
        let certificates = certify(&model, &CertifyOptions::default(), clearance).unwrap();
        let mut parts = certificates.parts().clone();
        parts.pair_tree = Default::default();
        parts.node_radii.iter_mut().for_each(|radius| *radius *= 1.3);
        parts.root_pair_radii.iter_mut().for_each(|radius| *radius *= 1.3);
        let changed = Certificates::try_from(parts).unwrap();
        let report = audit(&model, &changed, &AuditOptions::default().samples(300).threads(1), &()).unwrap();
        refuted += usize::from(report.violations.iter().any(|line| line.contains("are nearer than")));
    }
    assert_eq!(refuted, 4);
}

#[test]
fn near_pairs_are_the_same_with_and_without_certificates() {
    let (mut found, mut by_radius, mut by_search, mut narrow) = (0, 0, 0, 0);
    for seed in 0..cases(240_u64) {
        let model = numbered_model(seed + 7000);
        let random = &mut Random::new(seed + 9_200_000);
        let options = random_choices(seed, &model).options.budget([0, 64][seed as usize % 2]);
        let Some(certified) = random_clearance(random, size(&model, &vec![0.0; model.rank()])) else {
            continue;
        };
        let Some(certificates) = certify(&model, &options, certified) else { continue };
        let scope = &certificates.parts().scope;
        let mut query = Query::new(&model, &certificates).unwrap();
        for turn in 0..8 {
            let z: Vec<f64> = (0..model.rank()).map(|_| random.signed()).collect();
            let root = certificates.root_radius();
            let radius = if root > 0.0 && root.is_finite() {
                root
            } else {
                certificates.global_radius().min(1e3) * 0.1
            };
            let Some(q) = just_inside(scope, &z, radius * random.power(-1.0, 1.0)) else { continue };
            if model.check_coordinates(&q).is_err() {
                continue;
            }
            let share = [1.0, 0.5, 1e-3, 1.5][turn % 4];
            let Ok(clearance) = Clearance::new(certified.distance() * share) else { continue };
            let rings = [certified.rings(), certified.rings() + 1, 1][turn % 3];
            let clearance = clearance.beyond_rings(rings);
            let expected = near_by_brute_force(&model, scope, &q, &clearance);
            let near = query.within(&q, &clearance).unwrap().to_vec();
            assert_eq!(near, expected, "model {seed}, {clearance:?} of {certified:?}, {q:?}");
            found += near.len();
            let covered = share <= 1.0 && rings >= certified.rings();
            let statistics = query.statistics();
            assert!(statistics.complete && (covered || statistics.proof == Proof::Search));
            match statistics.proof {
                Proof::Radius => by_radius += 1,
                _ if covered => by_search += 1,
                _ => narrow += 1,
            }
            assert_eq!(statistics.norm, certificates.norm(&q).unwrap());
        }
    }
    assert!(
        found > 1000 && by_radius > 20 && by_search > 20 && narrow > 20,
        "{found} {by_radius} {by_search} {narrow}"
    );
}

/// A pair is near for the smallest number above its computed distance, and not for that distance. This attacks the width of AABBs:
/// those of level sheets have exactly that distance.
#[test]
fn near_pairs_are_found_up_to_their_own_distance() {
    let (mut asked, mut exact) = (0, 0);
    for seed in 0..cases(160_u64) {
        let random = &mut Random::new(seed + 9_400_000);
        // Two sheets, level or (in every second model) rotated; the mode lowers the upper one.
        let (gap, at) = (random.power(-3.0, 0.0), random.power(-2.0, 3.0) * random.signed());
        let tilt = if seed % 2 == 0 { 0.0 } else { 0.1 * random.signed() };
        let sheet = |z: f64| {
            (0..60).map(move |i| {
                let (x, y) = (f64::from(i / 2) * 0.1, f64::from(i % 2) * 0.1);
                DVec3::new(x + at, y, z + at + tilt * x)
            })
        };
        let faces = [0_u32, 60].into_iter().flat_map(|first| (first..first + 58).map(|i| [i, i + 1, i + 2]));
        let mesh = TriMesh::new(sheet(0.0).chain(sheet(gap)).collect(), faces.collect()).unwrap();
        let modes = (0..120).map(|v| if v < 60 { DVec3::ZERO } else { -DVec3::Z }).collect();
        let model = ReducedModel::new(mesh, Modes::new(1, modes).unwrap()).unwrap();
        let certified = Clearance::new(0.9 * gap).unwrap().beyond_rings(40);
        let Some(certificates) = certify(&model, &CertifyOptions::default(), certified) else { continue };
        let scope = &certificates.parts().scope;
        let mut query = Query::new(&model, &certificates).unwrap();
        for _ in 0..4 {
            let q = [gap * (0.3 + 0.6 * random.signed().abs())];
            let near = near_by_brute_force(&model, scope, &q, &certified);
            let Some(nearest) = near.iter().map(|pair| pair.distance).min_by(f64::total_cmp) else {
                continue;
            };
            for distance in [nearest, nearest.next_up()] {
                let clearance = Clearance::new(distance).unwrap().beyond_rings(40);
                let expected = near_by_brute_force(&model, scope, &q, &clearance);
                assert_eq!(expected.is_empty(), distance == nearest);
                assert_eq!(
                    query.within(&q, &clearance).unwrap(),
                    expected,
                    "model {seed}, {distance:e}, {q:?}"
                );
                exact += usize::from(!expected.is_empty());
            }
            asked += 1;
        }
    }
    assert!(asked > cases(160) && exact == asked, "{asked} {exact}");
}

/// If large displacements cancel, positions and boxes are computed in double precision, and boxes are widened by as much.
#[test]
fn near_pairs_are_found_where_positions_must_be_exact() {
    let strip = |z: f64| (0..300).map(move |i| DVec3::new(f64::from(i / 2) * 0.1, f64::from(i % 2) * 0.1, z));
    let positions: Vec<DVec3> = strip(0.0).chain(strip(1.0)).collect();
    let faces = [0_u32, 300].into_iter().flat_map(|first| (first..first + 298).map(|i| [i, i + 1, i + 2]));
    // The first mode lowers the upper strip; the others move both strips in opposite directions.
    let modes = (0..600).flat_map(|v| [if v < 300 { DVec3::ZERO } else { -DVec3::Z }, DVec3::X, -DVec3::X]);
    let mesh = TriMesh::new(positions, faces.collect()).unwrap();
    let model = ReducedModel::new(mesh, Modes::new(3, modes.collect()).unwrap()).unwrap();
    let clearance = Clearance::new(0.2).unwrap().beyond_rings(8);
    for budget in [0, 64] {
        let options = CertifyOptions::default().clearance(clearance).budget(budget);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let mut query = Query::new(&model, &certificates).unwrap();
        for (lowered, is_near) in [(0.7, false), (0.85, true)] {
            let q = [lowered, 3e4, 3e4];
            let near = query.within(&q, &clearance).unwrap();
            assert_eq!(near, near_by_brute_force(&model, &certificates.parts().scope, &q, &clearance));
            assert_eq!(!near.is_empty(), is_near);
        }
    }
}

/// Returns two triangles one unit apart along a diagonal; one mode moves the second one towards the first, another one both.
fn two_plates() -> ReducedModel {
    let along = DVec3::ONE.normalize();
    let (x, y) = (along.any_orthonormal_vector(), along.cross(along.any_orthonormal_vector()));
    let positions = vec![DVec3::ZERO, x, y, along, along + x, along + y];
    let entry = |v: usize, k: usize| if k == 1 || v > 2 { along * [-1.0, 3.0][k] } else { DVec3::ZERO };
    let modes = (0..6).flat_map(|v| (0..2).map(move |k| entry(v, k))).collect();
    let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let metric = Metric::from_scales(MetricKind::Given, vec![1.0, 1.0]).unwrap();
    ReducedModel::with_metric(mesh, Modes::new(2, modes).unwrap(), metric).unwrap()
}

#[test]
fn a_known_radius_is_reached_and_falls_with_the_clearance() {
    let model = two_plates();
    let mut before = f64::INFINITY;
    for clearance in [0.01, 0.25, 0.5, 0.9, 0.999] {
        let options = CertifyOptions::default().clearance(Clearance::new(clearance).unwrap()).epsilon(1e-6);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let (radius, truth) = (certificates.root_radius(), 1.0 - clearance);
        assert!(radius <= truth && radius > truth * 0.999, "{clearance}: {radius} of {truth}");
        assert!(radius < before);
        before = radius;
        let mut query = Query::new(&model, &certificates).unwrap();
        let clearance = Clearance::new(clearance).unwrap();
        for (share, proof, near) in [(0.999, Proof::Radius, 0), (1.001, Proof::Search, 1)] {
            let q = [truth * share, 0.0];
            assert_eq!(query.within(&q, &clearance).unwrap().len(), near);
            assert_eq!(query.statistics().proof, proof);
        }
    }
}

/// Radii do not increase with the clearance, up to the tolerance of both.
#[test]
fn radii_fall_with_the_clearance() {
    let mut compared = 0;
    for seed in 0..cases(40_u64) {
        let model = winding_strip(&mut Random::new(seed + 40), 1);
        let extent = size(&model, &vec![0.0; model.rank()]);
        let options = CertifyOptions::default().budget(0);
        let radii = [0.0, 1e-6, 1e-3, 0.01, 0.03].map(|share| {
            let clearance = Clearance::new(share * extent).ok().map(|clearance| clearance.beyond_rings(1));
            let certificates =
                Certificates::compute(&model, &options.clone().clearance(clearance).epsilon(0.05), &());
            certificates.ok().filter(|c| c.exceptions().is_empty()).map(|c| c.root_radius())
        });
        for pair in radii.windows(2) {
            if let [Some(smaller), Some(larger)] = pair {
                assert!(*larger <= smaller * 1.06, "{seed}: {radii:?}");
                compared += 1;
            }
        }
    }
    assert!(compared > cases(40) / 4, "{compared}");
}

/// Pairs nearer than the clearance at the centre, and those at exactly that distance, are exceptions: no radius covers them, and
/// answers contain them where they are near.
#[test]
fn near_pairs_of_the_centre_are_exceptions() {
    let at = |x: f64, z: f64| [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + DVec3::X * x + DVec3::Z * z);
    // Three groups of two plates, with distances less than, exactly, and more than 0.5.
    let heights = [0.0, 0.3, 0.0, 0.5, 0.0, 0.8];
    let positions =
        heights.iter().enumerate().map(|(i, z)| at(10.0 * (i / 2) as f64, *z)).collect::<Vec<_>>().concat();
    let faces = (0..6).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let modes = (0..18).map(|v| if v / 3 % 2 == 1 { DVec3::Z } else { DVec3::ZERO }).collect();
    let model =
        ReducedModel::new(TriMesh::new(positions, faces).unwrap(), Modes::new(1, modes).unwrap()).unwrap();
    let clearance = Clearance::new(0.5).unwrap();
    let options = CertifyOptions::default().clearance(clearance).epsilon(1e-3);
    let certificates = Certificates::compute(&model, &options, &()).unwrap();
    assert_eq!(certificates.exceptions(), [(0, 1), (2, 3)]);
    // The distance of the last two plates is 0.5 after 0.3, in units of the metric.
    let scale = certificates.norm(&[1.0]).unwrap();
    let radius = certificates.root_radius() / scale;
    assert!(radius <= 0.3 && radius > 0.299, "{radius}");
    let mut query = Query::new(&model, &certificates).unwrap();
    for (q, expected) in [
        (0.0, vec![(0, 1)]),
        (-0.1, vec![(0, 1), (2, 3)]),
        (0.25, vec![]),
        (-0.35, vec![(0, 1), (2, 3), (4, 5)]),
    ] {
        let near: Vec<Pair> = query.within(&[q], &clearance).unwrap().iter().map(|near| near.pair).collect();
        assert_eq!(near, expected, "{q}");
    }
    // If no exceptions are allowed, their radius is 0.
    let none = Certificates::compute(&model, &options.max_exceptions(0), &()).unwrap();
    assert!(none.exceptions().is_empty() && none.root_radius() == 0.0);
    assert_eq!(Query::new(&model, &none).unwrap().within(&[0.0], &clearance).unwrap().len(), 1);
}

/// Returns a strip whose end rotates through its beginning, so that all pairs that can collide are within the rings, and another part
/// far away.
fn folding_strip() -> ReducedModel {
    let mut positions: Vec<DVec3> =
        (0..10).map(|i| DVec3::new(f64::from(i / 2), f64::from(i % 2), 0.0)).collect();
    let mut faces: Vec<[u32; 3]> = (0..8).map(|i| [i, i + 1, i + 2]).collect();
    positions.extend([DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + DVec3::Y * 100.0));
    faces.push([10, 11, 12]);
    let turn = |i: usize| match i / 2 {
        3 => DVec3::new(-1.5, 0.0, 1.0),
        4 => DVec3::new(-3.5, 0.0, -1.0),
        _ => DVec3::ZERO,
    };
    let modes = (0..13).map(turn).collect();
    ReducedModel::new(TriMesh::new(positions, faces).unwrap(), Modes::new(1, modes).unwrap()).unwrap()
}

/// Triangles within the rings may collide below the radii, so queries of collisions are answered without the certificates.
#[test]
fn certificates_with_a_clearance_prove_nothing_about_collisions() {
    let model = folding_strip();
    let clearance = Clearance::new(0.01).unwrap().beyond_rings(20);
    for method in [Method::Certified, Method::Traditional] {
        let certificates =
            Certificates::compute(&model, &CertifyOptions::default().clearance(clearance), &()).unwrap();
        // The pairs that count are far apart.
        assert!(certificates.root_radius() > certificates.norm(&[1.2]).unwrap());
        let mut query = Query::with_method(&model, &certificates, method).unwrap();
        let mut oracle = Query::without_certificates(&model, Scope::of(&model), Method::BruteForce).unwrap();
        let mut kinetic = KineticQuery::new(&model, &certificates).unwrap();
        let mut colliding = 0;
        for step in 0..40 {
            let q = [1.2 * f64::from(step) / 40.0];
            let expected = oracle.discrete(&q).unwrap().to_vec();
            colliding += usize::from(!expected.is_empty());
            assert_eq!(query.discrete(&q).unwrap(), expected, "{q:?}");
            assert_eq!(kinetic.discrete(&q).unwrap(), expected, "{q:?}");
            assert_eq!(query.batch(&[q], Some(1), &()).unwrap()[0].pairs, expected, "{q:?}");
            let swept = !query.continuous(&[0.0], &q).unwrap().is_empty();
            assert!(swept || expected.is_empty(), "{q:?}");
            assert!(expected.is_empty() || query.safe_scale(&q).unwrap() < 1.0, "{q:?}");
            assert!(query.within(&q, &clearance).unwrap().is_empty());
        }
        assert!(colliding > 5, "{colliding}");
        assert_eq!(certificates.clamp(&[0.01]).unwrap(), None);
    }
}

/// Clearance and rings are parts of the scope: for other values the radii may be wrong.
#[test]
fn another_clearance_is_refused() {
    let model = two_plates();
    let clearance = Clearance::new(0.25).unwrap();
    let options = CertifyOptions::default().clearance(clearance);
    let certificates = Certificates::compute(&model, &options, &()).unwrap();
    for other in [None, Some(Clearance::new(0.5).unwrap()), Some(clearance.beyond_rings(2))] {
        let mut parts = certificates.parts().clone();
        Arc::make_mut(&mut parts.scope).clearance = other;
        let changed = Certificates::try_from(parts).unwrap();
        assert!(matches!(changed.check_model(&model), Err(Error::OtherModel { .. })), "{other:?}");
    }
    // A query uses certificates up to their clearance, and for at least as many rings.
    let beyond =
        Certificates::compute(&model, &options.clone().clearance(clearance.beyond_rings(3)), &()).unwrap();
    for (asked, rings, proof) in [
        (0.25, 3, Proof::Radius),
        (0.1, 4, Proof::Radius),
        (0.2500001, 3, Proof::Search),
        (0.25, 2, Proof::Search),
    ] {
        let mut query = Query::new(&model, &beyond).unwrap();
        let asked = Clearance::new(asked).unwrap().beyond_rings(rings);
        assert!(query.within(&[0.1, 0.1], &asked).unwrap().is_empty());
        assert_eq!(query.statistics().proof, proof, "{asked:?}");
    }
    let plain = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    assert_eq!(plain.clearance(), None);
    let mut query = Query::new(&model, &plain).unwrap();
    assert!(query.within(&[0.1, 0.1], &clearance).unwrap().is_empty());
    assert_eq!(query.statistics().proof, Proof::Search);
    // Triangles with a common vertex need not keep the clearance, for any contact filter.
    let filter = ContactFilter::new(Neighbours::IncludeOneVertex);
    let included = Certificates::compute(&model, &options.filter(filter), &()).unwrap();
    assert_eq!(included.root_radius(), certificates.root_radius());
    assert!(certificates.parts().local.nodes.is_empty());
}

/// Certificates that several processes compute are the same.
#[test]
fn clearances_are_certified_in_shards() {
    for model in [two_plates(), winding_strip(&mut Random::new(4), 4)] {
        let clearance = Clearance::new(0.01).unwrap().beyond_rings(3);
        let options = CertifyOptions::default().clearance(clearance);
        let alone = Certificates::compute(&model, &options, &()).unwrap();
        let worker = sscc::parts::ShardWorker::new(&model, &options, &()).unwrap();
        let mut run = |jobs: Vec<Vec<u8>>| jobs.iter().map(|job| worker.run(job, &())).collect();
        let shared = sscc::parts::compute_in_shards(&model, &options, 3, &mut run, &()).unwrap();
        assert_eq!(shared, alone);
        // Jobs of another clearance are refused.
        let other = options.clearance(clearance.beyond_rings(2));
        assert!(sscc::parts::compute_in_shards(&model, &other, 3, &mut run, &()).is_err());
    }
}

#[test]
fn exceptions_are_near_in_large_units() {
    let at =
        |x: f64, z: f64| [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| (p + DVec3::X * x + DVec3::Z * z) * 100.0);
    let positions = [at(0.0, 0.0), at(0.0, 0.3), at(10.0, 0.0), at(10.0, 0.8)].concat();
    let faces = (0..4).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let modes = (0..12).map(|v| if v / 3 % 2 == 1 { DVec3::Z } else { DVec3::ZERO }).collect();
    let mesh = TriMesh::new(positions, faces).unwrap();
    let model = ReducedModel::new(mesh, Modes::new(1, modes).unwrap()).unwrap();
    let clearance = Clearance::new(50.0).unwrap();
    let options = CertifyOptions::default().clearance(clearance);
    let certificates = Certificates::compute(&model, &options, &()).unwrap();
    assert_eq!(certificates.exceptions(), [(0, 1)]);
    let mut query = Query::new(&model, &certificates).unwrap();
    let near: Vec<Pair> = query.within(&[0.0], &clearance).unwrap().iter().map(|near| near.pair).collect();
    assert_eq!(near, [(0, 1)]);
}
