//! Properties of certificates and queries, through the public interface.

use std::sync::{Arc, LazyLock};

use glam::DVec3;
use sscc::parts::{CertificateParts, Hierarchy, Node, PairTree, Scope};
use sscc::{
    Certificates, CertifyOptions, Error, Method, Metric, MetricKind, Modes, Neighbours, Query, ReducedModel,
    TriMesh,
};
use sscc_testing::{cases, threshold};

use crate::common::{
    Random, RandomOptions, after, are_adjacent, at, critical_z, random_choices, random_model, random_options,
};

/// `U / S` vanishes (1e-360), but U is not 0: no radius may be infinite.
#[test]
fn scaled_modes_that_underflow_are_refused() {
    let size = 1e-50;
    let flat = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p * size);
    let above = [DVec3::new(0.2, 0.2, 1e-4), DVec3::new(0.4, 0.2, 1e-4), DVec3::new(0.2, 0.4, 1e-4)]
        .map(|p| p * size);
    let mesh = TriMesh::new([flat, above].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let mut modes = vec![DVec3::ZERO; 6];
    modes[3] = DVec3::Z * -1e-60;
    let modes = Modes::new(1, modes).unwrap();
    let metric = Metric::from_scales(MetricKind::Given, vec![1e300]).unwrap();
    let refused = ReducedModel::with_metric(mesh.clone(), modes.clone(), metric.clone());
    assert!(matches!(refused, Err(Error::MetricRange { .. })));
    let model = ReducedModel::new(mesh, modes).unwrap();
    let options = CertifyOptions::default().metric(metric);
    assert!(matches!(Certificates::compute(&model, &options, &()), Err(Error::MetricRange { .. })));
}

/// Computes certificates with the default epsilon, or with a loose one if that takes too long.
fn certify(model: &ReducedModel, options: &CertifyOptions) -> Option<Certificates> {
    let options = |epsilon| options.clone().epsilon(epsilon).threads(1);
    Certificates::compute(model, &options(0.1), &after(401))
        .or_else(|_| Certificates::compute(model, &options(0.9), &after(401)))
        .or_else(|_| Certificates::compute(model, &options(0.999), &after(401)))
        .ok()
}

/// Returns the budget of the pair tree: only every second model has one, because its computation is slow if pairs need many
/// subdivisions.
fn budget(seed: u64) -> usize {
    if seed.is_multiple_of(2) { 0 } else { 16 }
}

/// A model of more than 20 triangles, free at rest, and its certificates.
static MIDDLING: LazyLock<(ReducedModel, Certificates)> = LazyLock::new(|| {
    (0..)
        .map(random_model)
        .filter(|model| model.mesh().faces().len() > 20 && model.rank() > 1)
        .find_map(|model| {
            let certificates = certify(&model, &CertifyOptions::default());
            let useful = |c: &Certificates| {
                c.root_radius() > 0.0 && c.exceptions().is_empty() && collisions(&model, c) > 5
            };
            certificates.filter(useful).map(|c| (model, c))
        })
        .unwrap()
});

/// Returns the number of colliding ones among 50 random q up to far beyond the root's radius.
fn collisions(model: &ReducedModel, certificates: &Certificates) -> usize {
    let mut query = Query::with_method(model, certificates, Method::Traditional).unwrap();
    random_q(certificates).iter().filter(|q| query.first(q).is_ok_and(|pair| pair.is_some())).count()
}

fn random_q(certificates: &Certificates) -> Vec<Vec<f64>> {
    let random = &mut Random::new(77);
    let mut q = || {
        let size = certificates.root_radius() * random.power(-1.0, 2.0);
        let z: Vec<f64> = certificates.center().iter().map(|_| random.signed() * size).collect();
        at(&certificates.parts().scope, &z)
    };
    (0..50).map(|_| q()).collect()
}

/// Models whose radii are attacked, and (with seeds of their own) those whose answers are compared.
const PROVEN: u64 = 1110;
const COMPARED: u64 = 1250;

/// Returns the q in the direction of z whose norm is as close below the radius as rounding allows; `None` if there is no
/// such q.
fn just_inside(scope: &Scope, z: &[f64], radius: f64) -> Option<Vec<f64>> {
    let norm = length(z);
    if norm.is_nan() || norm <= 0.0 || norm.is_infinite() {
        return None;
    }
    [0.0, 1e-15, 4e-15, 1.6e-14, 1e-12, 1e-9].into_iter().find_map(|less| {
        let scaled: Vec<f64> = z.iter().map(|x| x / norm * radius * (1.0 - less)).collect();
        let q = at(scope, &scaled);
        let offset: Vec<f64> = q.iter().zip(&scope.center).map(|(q, c)| q - c).collect();
        (scope.metric.norm(&offset).unwrap() < radius).then_some(q)
    })
}

fn length(z: &[f64]) -> f64 {
    z.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn pairs(query: &mut Query, q: &[f64]) -> Option<Vec<(u32, u32)>> {
    query.discrete(q).ok().map(<[_]>::to_vec)
}

#[test]
fn certified_implies_free() {
    let (mut skipped, mut scopes) = (0, [0; 6]);
    let proven = cases(PROVEN);
    for seed in 0..proven {
        let model = random_model(seed);
        let random = &mut Random::new(seed + 1_000_000);
        let options = random_options(seed, &model).budget(budget(seed));
        let Some(certificates) = certify(&model, &options) else {
            skipped += 1;
            continue;
        };
        let parts = certificates.parts();
        let scope = &parts.scope;
        count_scope(scope, &model, &mut scopes);
        let mut oracle = Query::without_certificates(&model, scope.clone(), Method::BruteForce).unwrap();
        let hierarchy = &certificates.parts().hierarchy;
        let nodes = hierarchy.nodes();
        // Pairs of nodes (a node with itself, or two nodes) and their radii.
        let mut claims: Vec<(usize, usize, f64)> =
            parts.node_radii.iter().enumerate().map(|(n, r)| (n, n, *r)).collect();
        let mut next = parts.root_pair_radii.iter();
        for a in nodes[0].children() {
            for b in a + 1..nodes[0].children().end {
                claims.push((a as usize, b as usize, *next.next().unwrap()));
            }
        }
        for (n, m, radius) in claims {
            assert!(radius >= parts.node_radii[0], "model {seed}: {n} {m}");
            for child in nodes[n].children().filter(|_| n == m) {
                assert!(parts.node_radii[child as usize] >= radius, "model {seed}: child {child} of {n}");
            }
            if radius <= 0.0 {
                continue;
            }
            let in_x: Vec<u32> = hierarchy.triangles(&nodes[n]).to_vec();
            let in_y: Vec<u32> = hierarchy.triangles(&nodes[m]).to_vec();
            let mut directions: Vec<Vec<f64>> = Vec::new();
            for _ in 0..4 {
                let faces = (in_x[random.below(in_x.len())], in_y[random.below(in_y.len())]);
                directions.extend(critical_z(&model, scope, faces, random));
            }
            let k = random.below(model.rank());
            for sign in [1.0, -1.0] {
                directions.push((0..model.rank()).map(|j| if j == k { sign } else { 0.0 }).collect());
            }
            directions.push((0..model.rank()).map(|_| random.signed()).collect());
            for z in directions {
                let goal = if radius.is_finite() { radius } else { random.power(-3.0, 6.0) };
                let Some(q) = just_inside(scope, &z, goal) else { continue };
                let Some(found) = pairs(&mut oracle, &q) else { continue };
                let bad = found.iter().find(|pair| {
                    let (i, j) = pair;
                    let claimed =
                        in_x.contains(i) && in_y.contains(j) || in_x.contains(j) && in_y.contains(i);
                    claimed && !scope.exceptions.contains(pair)
                });
                assert!(bad.is_none(), "model {seed}, nodes {n} {m}: {bad:?} below {radius:e}, q = {q:?}");
            }
        }
    }
    assert!(proven - skipped >= threshold(1000), "{skipped} models skipped");
    let few = if proven == PROVEN { 15 } else { 0 };
    assert!(scopes.iter().all(|n| *n > few), "too few of a kind: {scopes:?}");
}

/// Counts the kinds of scopes that were tried.
fn count_scope(scope: &Scope, model: &ReducedModel, counts: &mut [u32; 6]) {
    let kinds = [
        scope.metric.dense_factor().is_some(),
        scope.center.iter().any(|x| *x != 0.0),
        scope.filter.weld && model.mesh().rest_positions().len() > 2 * model.mesh().faces().len(),
        scope.filter.neighbours != Neighbours::Exclude,
        !scope.exceptions.is_empty(),
        !scope.filter.ignored().is_empty(),
    ];
    counts.iter_mut().zip(kinds).for_each(|(count, is)| *count += u32::from(is));
}

/// Compares every method with every kind of contact filter, including one-vertex neighbours and welds, with brute force.
#[test]
fn all_methods_find_the_same_pairs() {
    let (mut skipped, mut included, mut neighbours, mut partial) = (0, 0, 0, 0);
    let compared = cases(COMPARED);
    for seed in PROVEN..PROVEN + compared {
        let model = random_model(seed);
        let random = &mut Random::new(seed + 2_000_000);
        let RandomOptions { options, mut filter, ignore_rest } = random_choices(seed, &model);
        let one_vertex = !seed.is_multiple_of(10);
        filter.neighbours = if one_vertex { Neighbours::IncludeOneVertex } else { Neighbours::Exclude };
        let options = options.budget(budget(seed)).filter(filter);
        let Some(certificates) = certify(&model, &options) else {
            skipped += 1;
            continue;
        };
        included += u32::from(one_vertex);
        let scope = &certificates.parts().scope;
        let mut oracle = Query::without_certificates(&model, scope.clone(), Method::BruteForce).unwrap();
        let mut methods = [Method::Certified, Method::BdTree, Method::Traditional, Method::BruteForce]
            .map(|method| Query::with_method(&model, &certificates, method).unwrap());
        let root = certificates.root_radius();
        let unit = if root > 0.0 && root.is_finite() { root } else { 1.0 };
        let mut asked = Vec::new();
        for sample in 0..14 {
            let mut z: Vec<f64> = (0..model.rank()).map(|_| random.signed()).collect();
            let size = match sample {
                0 => 0.0,
                1 => random.power(-300.0, -160.0),
                2 => {
                    z[random.below(model.rank())] *= 1e9;
                    unit
                }
                3 => 1.0 - 1e-14,
                4 => 1.0 + 1e-14,
                5..8 => unit * random.power(0.0, 0.5),
                8..11 => unit * random.power(0.0, 2.0),
                _ => unit * random.power(-12.0, 3.0),
            };
            let size = if sample == 3 || sample == 4 { size * unit } else { size };
            let norm = length(&z);
            z.iter_mut().for_each(|x| *x = *x / norm * size);
            let q = at(scope, &z);
            let Some(expected) = pairs(&mut oracle, &q) else {
                assert!(methods.iter_mut().all(|m| pairs(m, &q).is_none()), "model {seed}: {q:?}");
                continue;
            };
            assert!(expected.is_sorted() && expected.iter().all(|(i, j)| i < j), "model {seed}");
            neighbours += expected.iter().filter(|(i, j)| are_adjacent(model.mesh(), *i, *j)).count();
            for (i, method) in methods.iter_mut().enumerate() {
                let found = pairs(method, &q);
                assert_eq!(
                    found.as_ref(),
                    Some(&expected),
                    "model {seed}, sample {sample}, method {i}: {q:?}"
                );
                assert!(method.statistics().complete);
                let limit = 1 + random.below(5);
                let some = method.discrete_at_most(&q, limit).unwrap().to_vec();
                let complete = method.statistics().complete;
                assert_eq!(some.len(), limit.min(expected.len()), "model {seed}, method {i}");
                assert!(some.is_sorted() && some.iter().all(|pair| expected.contains(pair)));
                assert!(complete == (some.len() == expected.len()) || some.len() == limit);
                partial += usize::from(!complete);
                assert_eq!(method.first(&q).unwrap().is_some(), !expected.is_empty());
            }
            if sample == 0 && !ignore_rest && scope.center.iter().all(|x| *x == 0.0) {
                assert_eq!(certificates.rest_collisions(), expected.len() as u64, "model {seed}");
            }
            asked.push((q, expected));
        }
        let batch: Vec<&[f64]> = asked.iter().map(|(q, _)| &q[..]).collect();
        let answers = methods[0].batch(&batch, Some(2), &()).unwrap();
        assert!(
            answers.iter().zip(&asked).all(|(answer, (_, pairs))| answer.pairs == *pairs),
            "model {seed}"
        );
    }
    assert!(skipped < compared / 10, "{skipped} models skipped");
    assert!(
        included >= threshold(1000) && neighbours > threshold(1000) && partial > threshold(1000),
        "{included} {neighbours} {partial}"
    );
}

/// Certificates whose hierarchy has fewer triangles than the model must be refused.
#[test]
fn hierarchy_of_another_size_is_refused() {
    let (model, certificates) = &*MIDDLING;
    let mut parts = certificates.parts().clone();
    let leaf = Node { first_triangle: 0, triangle_count: 1, first_child: 0, child_count: 0 };
    parts.hierarchy = Hierarchy::from_parts(vec![leaf], vec![0], 1).unwrap().into();
    parts.node_radii = vec![0.0];
    parts.root_pair_radii = vec![];
    if let Ok(certificates) = Certificates::try_from(parts) {
        assert!(Query::new(model, &certificates).is_err());
    }
}

/// The radius of the root may not exceed that of a pair of its children.
#[test]
fn root_radius_above_a_pair_is_refused() {
    let mut parts = MIDDLING.1.parts().clone();
    parts.root_pair_radii[0] = 0.0;
    assert!(Certificates::try_from(parts).is_err());
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    for seed in 0..cases(15) {
        let model = random_model(seed);
        let all = [1, 2, 3].map(|threads| {
            let options = random_options(seed, &model).threads(threads);
            certify(&model, &options)?;
            let parts = Certificates::compute(&model, &options, &()).unwrap().parts().clone();
            let radii = parts.node_radii.iter().chain(&parts.root_pair_radii).chain([&parts.global_radius]);
            Some((radii.map(|r| r.to_bits()).collect::<Vec<_>>(), parts))
        });
        assert!(all[0] == all[1] && all[0] == all[2], "model {seed}");
    }
}

/// Returns a flat triangle at height `z`, moved up and down by the modes, over or under a resting sheet.
fn sheet_and_triangle(sheet: f64, z: f64, modes: &[f64]) -> ReducedModel {
    let at = |[x, y]: [f64; 2], z: f64| DVec3::new(x, y, z);
    let p = [[0.0, 0.0], [0.25, 0.0], [0.0, 0.25]].map(|xy| at(xy, z));
    let s = [[-1.0, -1.0], [2.0, -1.0], [-1.0, 2.0]].map(|xy| at(xy, sheet));
    let mesh = TriMesh::new([p, s].concat(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let moves = |v: usize| modes.iter().map(move |u| if v < 3 { DVec3::Z * *u } else { DVec3::ZERO });
    let modes = Modes::new(modes.len(), (0..6).flat_map(moves).collect()).unwrap();
    ReducedModel::new(mesh, modes).unwrap()
}

/// The answer is that of the sum `x = p; x += U_k q_k` in the order of k, and of no other order.
#[test]
fn answers_follow_the_order_of_the_sum() {
    let ulp = f64::EPSILON;
    let half = ulp / 2.0;
    let check = |model: &ReducedModel, q: &[f64], expected: bool| {
        let certificates = Certificates::compute(model, &CertifyOptions::default(), &()).unwrap();
        for method in [Method::Certified, Method::BdTree, Method::Traditional, Method::BruteForce] {
            let mut query = Query::with_method(model, &certificates, method).unwrap();
            assert_eq!(!query.discrete(q).unwrap().is_empty(), expected, "{method:?} at {q:?}");
            assert!(
                !expected || query.statistics().norm >= certificates.root_radius(),
                "certified a collision"
            );
        }
    };
    // (1 + half) + half stays 1, 1 + (half + half) reaches the sheet.
    assert_eq!((1.0 + half) + half, 1.0);
    assert_eq!(1.0 + (half + half), 1.0 + ulp);
    check(&sheet_and_triangle(1.0 + ulp, 1.0, &[1.0, 1.0]), &[half, half], false);
    check(&sheet_and_triangle(1.0 + ulp, 1.0, &[1.0]), &[ulp], true);
    // The first mode moves down to the sheet, the second one up by too little; in the opposite order the triangle ends above it.
    assert_eq!(((1.0 + ulp) - ulp) + half, 1.0);
    assert_eq!(((1.0 + ulp) + half) - ulp, 1.0 + ulp);
    check(&sheet_and_triangle(1.0, 1.0 + ulp, &[1.0, 1.0]), &[-ulp, half], true);
    check(&sheet_and_triangle(1.0, 1.0 + ulp, &[1.0, 1.0]), &[half, -ulp], false);
    // With a fused multiply-add the product would be a little more than half.
    let (u, q) = (1.0 + ulp, (1.0 - half) * half);
    assert_eq!(1.0 + u * q, 1.0);
    assert_eq!(u.mul_add(q, 1.0), 1.0 + ulp);
    check(&sheet_and_triangle(1.0 + ulp, 1.0, &[u]), &[q], false);
}

#[test]
fn certificates_of_a_model_that_differs_in_one_bit_are_refused() {
    let (model, certificates) = &*MIDDLING;
    assert!(Query::new(model, certificates).is_ok());
    let (mesh, modes) = (model.mesh(), model.modes());
    let flip = |x: f64| f64::from_bits(x.to_bits() ^ 1);
    let refused = |mesh: TriMesh, modes: Modes| {
        let other = ReducedModel::with_metric(mesh, modes, model.metric().clone()).unwrap();
        matches!(Query::new(&other, certificates), Err(Error::OtherModel { .. }))
    };
    let random = &mut Random::new(3);
    for _ in 0..20 {
        let mut p = mesh.rest_positions().to_vec();
        let (v, c) = (random.below(p.len()), random.below(3));
        p[v][c] = flip(p[v][c]);
        assert!(refused(TriMesh::new(p, mesh.faces().to_vec()).unwrap(), modes.clone()));
        let mut u = modes.displacements().to_vec();
        let (i, c) = (random.below(u.len()), random.below(3));
        u[i][c] = flip(u[i][c]);
        assert!(refused(mesh.clone(), Modes::new(modes.rank(), u).unwrap()));
        let mut faces = mesh.faces().to_vec();
        let t = random.below(faces.len());
        faces[t].swap(0, 1);
        assert!(refused(TriMesh::new(mesh.rest_positions().to_vec(), faces).unwrap(), modes.clone()));
    }
}

#[test]
fn bad_coordinates_are_errors_for_every_method() {
    let (model, certificates) = &*MIDDLING;
    let rank = model.rank();
    for method in [Method::Certified, Method::BdTree, Method::Traditional, Method::BruteForce] {
        let mut query = Query::with_method(model, certificates, method).unwrap();
        for len in [0, rank - 1, rank + 1] {
            assert!(matches!(query.discrete(&vec![0.0; len]), Err(Error::CoordinatesLength { .. })));
        }
        for k in 0..rank {
            let mut q = vec![0.0; rank];
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                q[k] = bad;
                assert!(
                    matches!(query.discrete(&q), Err(Error::CoordinatesValue { index, .. }) if index == k)
                );
            }
        }
        assert!(matches!(query.discrete(&vec![1e300; rank]), Err(Error::CoordinatesRange)));
        assert!(query.discrete(&vec![0.0; rank]).is_ok());
    }
}

#[test]
fn damaged_parts_are_refused() {
    let good = MIDDLING.1.parts().clone();
    assert!(Certificates::try_from(good.clone()).is_ok());
    let refused = |damage: &dyn Fn(&mut CertificateParts)| {
        let mut parts = good.clone();
        damage(&mut parts);
        matches!(Certificates::try_from(parts), Err(Error::Certificates(_)))
    };
    assert!(refused(&|p| p.node_radii.truncate(1)));
    assert!(refused(&|p| p.node_radii.push(1.0)));
    assert!(refused(&|p| p.root_pair_radii.truncate(0)));
    assert!(refused(&|p| p.node_radii[0] = f64::NAN));
    assert!(refused(&|p| p.node_radii[0] = -1.0));
    assert!(refused(&|p| p.node_radii[0] = f64::MAX));
    assert!(refused(&|p| p.root_pair_radii[0] = f64::NAN));
    let mut inner = good.hierarchy.nodes().iter().zip(&good.node_radii);
    let (parent, _) = inner.find(|(node, radius)| node.child_count > 0 && **radius > 0.0).unwrap();
    assert!(refused(&|p| p.node_radii[parent.first_child as usize] = 0.0));
    assert!(refused(&|p| p.global_radius = 0.0));
    assert!(refused(&|p| p.global_radius = f64::NAN));

    let (nodes, order) = (good.hierarchy.nodes().to_vec(), good.hierarchy.order().to_vec());
    let triangles = order.len();
    assert!(Hierarchy::from_parts(nodes.clone(), order.clone(), triangles).is_ok());
    assert!(Hierarchy::from_parts(vec![], order.clone(), triangles).is_err());
    assert!(Hierarchy::from_parts(nodes.clone(), order.clone(), triangles + 1).is_err());
    assert!(Hierarchy::from_parts(nodes[..nodes.len() - 1].to_vec(), order.clone(), triangles).is_err());
    let mut twice = order.clone();
    twice[0] = twice[1];
    assert!(Hierarchy::from_parts(nodes.clone(), twice, triangles).is_err());
    for i in 0..nodes.len() {
        for field in 0..4 {
            for change in [1, u32::MAX, 0x8000_0000] {
                let mut nodes = nodes.clone();
                let node = &mut nodes[i];
                let at = match field {
                    0 => &mut node.first_triangle,
                    1 => &mut node.triangle_count,
                    2 => &mut node.first_child,
                    _ => &mut node.child_count,
                };
                *at = at.wrapping_add(change);
                let answer = Hierarchy::from_parts(nodes, order.clone(), triangles);
                assert!(answer.is_err(), "node {i}, field {field}, change {change}");
            }
        }
    }
}

/// A tree of one leaf, as a file may contain it: accepted up to 64 triangles, with the same answers; refused beyond.
#[test]
fn one_leaf_is_a_tree() {
    let (model, certificates) = &*MIDDLING;
    let parts = certificates.parts();
    let triangles = model.mesh().faces().len();
    let leaf = |count: usize| Node {
        first_triangle: 0,
        triangle_count: count as u32,
        first_child: 0,
        child_count: 0,
    };
    assert!(Hierarchy::from_parts(vec![leaf(65)], (0..65).collect(), 65).is_err());
    assert!(triangles <= 64);
    let hierarchy = Hierarchy::from_parts(vec![leaf(triangles)], (0..triangles as u32).collect(), triangles);
    let flat = Certificates::try_from(CertificateParts {
        hierarchy: hierarchy.unwrap().into(),
        node_radii: vec![certificates.root_radius()],
        root_pair_radii: vec![],
        pair_tree: PairTree::default(),
        local: Arc::default(),
        ..parts.clone()
    })
    .unwrap();
    let mut oracle = Query::without_certificates(model, Scope::of(model), Method::BruteForce).unwrap();
    let mut queries = [Method::Certified, Method::BdTree, Method::Traditional]
        .map(|method| Query::with_method(model, &flat, method).unwrap());
    let mut collided = 0;
    for q in random_q(certificates) {
        let Some(expected) = pairs(&mut oracle, &q) else { continue };
        collided += usize::from(!expected.is_empty());
        for query in &mut queries {
            assert_eq!(query.discrete(&q).unwrap(), expected);
        }
    }
    assert!(collided > 5, "{collided}");
}
