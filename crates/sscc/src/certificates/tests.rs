//! Tests certificates against brute force: no triangle pair that collides below a limit is certified there.

use glam::DVec3;
use sscc_testing::{cases, threshold};

use super::test_models::ring;
use super::{Digest, StoredPair};
use crate::certificates::PairTree;
use crate::certificates::Scope;
use crate::hierarchy::{Hierarchy, NodePair};
use crate::model::rounding::to_f32_down;
use crate::{
    Certificates, CertifyOptions, Method, Metric, MetricKind, Modes, Pair, Query, ReducedModel, TriMesh,
};

fn certify(model: &ReducedModel, budget: usize) -> Certificates {
    Certificates::compute(model, &CertifyOptions::default().budget(budget), &()).unwrap()
}

/// Returns all triangle pairs that the tree does not certify at this norm: those within a bucket, and those between two nodes
/// with an entry whose radius has been reached, like the radii of its parents.
fn open_pairs(hierarchy: &Hierarchy, tree: &PairTree, norm: f64) -> Vec<Pair> {
    let mut open = Vec::new();
    let mut add = |n: u32, m: u32| {
        let [x, y] = [n, m].map(|n| hierarchy.triangles(&hierarchy.nodes()[n as usize]));
        open.extend(x.iter().flat_map(|a| y.iter().map(|b| (*a.min(b), *a.max(b)))));
    };
    for (n, node) in hierarchy.nodes().iter().enumerate() {
        if node.is_leaf() || hierarchy.is_bucket_below_root(n as u32) {
            add(n as u32, n as u32);
            continue;
        }
        let pairs: Vec<NodePair> = node.child_pairs().collect();
        let mut stack: Vec<(StoredPair, NodePair)> =
            tree.of_node(n as u32).map(|stored| (stored, pairs[stored.entry.which() as usize])).collect();
        while let Some((stored, (n, m))) = stack.pop() {
            if f64::from(stored.entry.radius) > norm {
                continue;
            }
            match hierarchy.split_above_buckets(n, m) {
                None => add(n, m),
                Some(split) => stack
                    .extend(tree.below(stored.index).map(|below| (below, split.pair(below.entry.which())))),
            }
        }
    }
    open.sort_unstable();
    open
}

/// Would fail for a tree that omits pairs because their boxes are disjoint, and for radii or limits above the truth.
#[test]
fn below_the_limit_whatever_collides_is_open() {
    let (mut collided, mut lowered) = (0, 0);
    // These budgets have no room for some rounds that are tried, and the last two have none for the outer round.
    let large = [(8, 2, 600), (9, 3, 450), (1, 4, 500), (3, 6, 700)];
    let small = [(0, 4), (1, 8), (2, 2), (3, 512), (4, 4096), (5, 4), (6, 512), (7, 2)];
    for (case, budget, quads) in
        small.map(|(case, budget)| (case, budget, 120 + 15 * case)).into_iter().chain(large)
    {
        let model = ring(quads, 3 + case % 3, 0.3 + case as f64);
        let certificates = certify(&model, budget);
        assert_eq!(Certificates::try_from(certificates.parts().clone()).err(), None);
        let (hierarchy, tree) = (certificates.hierarchy(), &certificates.parts().pair_tree);
        lowered += usize::from(0.0 < tree.limit() && tree.limit() < certificates.global_radius());
        let mut brute = Query::without_certificates(&model, Scope::of(&model), Method::BruteForce).unwrap();
        for i in 0..cases(if quads < 300 { 120 } else { 10 }) {
            let z: Vec<f64> = (0..model.rank()).map(|k| ((i * (2 * k + 3) + k) as f64 * 0.7).sin()).collect();
            let length = z.iter().map(|z| z * z).sum::<f64>().sqrt();
            // z is just below the limit, or well below it.
            let share = if i % 2 == 0 { 0.999_999 } else { 0.3 + 0.1 * (i % 7) as f64 };
            let z: Vec<f64> = z.iter().map(|z| z / length * tree.limit() * share).collect();
            let q = model.metric().unscale(&z);
            let norm = certificates.norm(&q).unwrap();
            assert!(norm <= tree.limit());
            if norm == tree.limit() {
                continue;
            }
            let open = open_pairs(hierarchy, tree, norm);
            for pair in brute.discrete(&q).unwrap() {
                collided += 1;
                assert!(open.binary_search(pair).is_ok(), "case {case}: {pair:?} at {norm}");
            }
        }
    }
    assert!(collided > threshold(150), "{collided}");
    assert!(lowered >= 2, "{lowered}");
}

/// Would fail for radii of nodes above the truth, whatever their origin: below the limit of the tree they come from its
/// construction, above the limit from a search among the pairs that are still open.
#[test]
fn no_node_is_free_where_two_of_its_triangles_collide() {
    let (mut below, mut above) = (0, 0);
    for (case, budget, quads) in [(0, 2, 200), (1, 3, 250), (2, 16, 200), (3, 2, 300), (4, 0, 200)] {
        let model = ring(quads, 3 + case % 3, 0.3 + case as f64);
        let certificates = certify(&model, budget);
        let (hierarchy, limit) = (certificates.hierarchy(), certificates.parts().pair_tree.limit());
        let mut place = vec![0; hierarchy.order().len()];
        hierarchy.order().iter().enumerate().for_each(|(at, t)| place[*t as usize] = at as u32);
        let mut brute = Query::without_certificates(&model, Scope::of(&model), Method::BruteForce).unwrap();
        for i in 0..cases(60) {
            let z: Vec<f64> = (0..model.rank()).map(|k| ((i * (2 * k + 3) + k) as f64 * 0.7).sin()).collect();
            let length = z.iter().map(|z| z * z).sum::<f64>().sqrt();
            let share = (1 + i % 12) as f64 / 12.0 * certificates.global_radius() / length;
            let q = model.metric().unscale(&z.iter().map(|z| z * share).collect::<Vec<_>>());
            let norm = certificates.norm(&q).unwrap();
            *(if norm < limit { &mut below } else { &mut above }) += 1;
            let mut pairs: Vec<[u32; 2]> =
                brute.discrete(&q).unwrap().iter().map(|(a, b)| [*a, *b]).collect();
            pairs.iter_mut().flatten().for_each(|t| *t = place[*t as usize]);
            for (n, node) in hierarchy.nodes().iter().enumerate() {
                let range = node.first_triangle..node.first_triangle + node.triangle_count;
                let collides = pairs.iter().any(|pair| pair.iter().all(|place| range.contains(place)));
                assert!(
                    !collides || certificates.node_radius(n as u32) <= norm,
                    "case {case}: node {n} at {norm}"
                );
            }
        }
    }
    assert!(below > threshold(50) && above > threshold(50), "{below} {above}");
}

/// The radius is 1 whatever its origin: a search of all pairs, the pairs that are open after the construction of the tree, the
/// pairs of its outer round, or those that an earlier round has bounded.
#[test]
fn the_root_radius_is_within_the_tolerance() {
    let limits = [(200, 0), (280, 1), (200, 1), (200, 64)].map(|(quads, budget)| {
        // Two parallel strips at a distance of 1, which the mode closes.
        let positions: Vec<DVec3> = (0..4 * quads)
            .map(|i| DVec3::new((i / 2 % quads) as f64, (i % 2) as f64, (i / (2 * quads)) as f64))
            .collect();
        let faces = (0..4 * quads - 2)
            .filter(|i| i % (2 * quads) < 2 * quads - 2)
            .map(|i| [0, 1, 2].map(|corner| (i + corner) as u32))
            .collect();
        let displacements = positions.iter().map(|p| DVec3::NEG_Z * p.z).collect();
        let mesh = TriMesh::new(positions, faces).unwrap();
        let model = ReducedModel::new(mesh, Modes::new(1, displacements).unwrap()).unwrap();
        let certificates = certify(&model, budget);
        let root = certificates.root_radius();
        assert!((0.9..=1.0).contains(&root), "{budget}: {root}");
        certificates.parts().pair_tree.limit()
    });
    let [none, smaller, outer, larger] = limits;
    assert!(none == 0.0 && 0.0 < smaller && smaller < 0.9, "{limits:?}");
    // The outer round goes to 1.5 times the limit of the rounds before.
    assert!(1.0 < outer && outer < 1.5 * 0.9 && 1.5 < larger, "{limits:?}");
}

/// Would fail if a parent had a larger bound than its children and the bound were not pushed down.
#[test]
fn radii_never_fall_towards_the_leaves() {
    let mut checked = 0;
    for (case, budget) in [(0, 64), (1, 64), (2, 512)] {
        let model = ring(240, 4, 1.7 + case as f64);
        let certificates = certify(&model, budget);
        let (hierarchy, tree) = (certificates.hierarchy(), &certificates.parts().pair_tree);
        assert!(tree.len() * 8 <= budget * 480);
        for n in 0..hierarchy.nodes().len() as u32 {
            let of_node = f64::from(to_f32_down(certificates.node_radius(n)));
            let mut stack: Vec<_> = tree.of_node(n).map(|stored| (stored, of_node)).collect();
            while let Some((StoredPair { index, entry }, of_parent)) = stack.pop() {
                let radius = f64::from(entry.radius);
                assert!(of_parent <= radius && radius < tree.limit());
                checked += 1;
                if entry.start() != 0 {
                    stack.extend(tree.below(index).map(|stored| (stored, radius)));
                }
            }
        }
    }
    assert!(checked > 300, "{checked}");
}

#[test]
fn any_number_of_threads_builds_the_same_tree() {
    for (quads, budget) in [(240, 64), (240, 4), (900, 3)].into_iter().take(cases(3)) {
        let model = ring(quads, 4, 0.9);
        let on = |threads| {
            let options = CertifyOptions::default().budget(budget).threads(threads);
            Certificates::compute(&model, &options, &()).unwrap().parts().clone()
        };
        let one = on(1);
        assert!(!one.pair_tree.is_empty());
        assert!(one == on(3));
    }
}

/// Two strips whose distance grows along them; one mode closes it. The tree has no room for all radii, and its limit is that
/// of the outer round: each pair that collides below it is open.
#[test]
fn outer_pairs_are_bounded() {
    let (mut outer, mut collided) = (0, 0);
    for (case, [budget, count]) in [[3, 4000], [3, 6000], [2, 4000]].into_iter().enumerate().take(cases(3)) {
        let along = |i: usize| 4.0 * i as f64 / count as f64;
        let points = |lift: f64| {
            (0..=count).flat_map(move |i| {
                [0.0, 0.05].map(|y| DVec3::new(along(i), y, lift * (0.02 + 0.4 * along(i))))
            })
        };
        let positions: Vec<DVec3> = points(0.0).chain(points(1.0)).collect();
        let squares = (0..2 * count + 1).filter(|i| *i != count).map(|i| 2 * i as u32);
        let faces = squares.flat_map(|i| [[i, i + 1, i + 2], [i + 1, i + 3, i + 2]]).collect();
        let modes = positions.iter().map(|p| if p.z > 0.0 { DVec3::NEG_Z } else { DVec3::ZERO }).collect();
        let mesh = TriMesh::new(positions, faces).unwrap();
        let model =
            ReducedModel::with_metric(mesh, Modes::new(1, modes).unwrap(), Metric::identity(1)).unwrap();
        let certificates = certify(&model, budget);
        let (hierarchy, tree) = (certificates.hierarchy(), &certificates.parts().pair_tree);
        assert!(0.0 < tree.limit() && tree.limit() < certificates.global_radius());
        outer += tree.entries().filter(|(radius, _)| 1.5 * f64::from(*radius) > tree.limit()).count();
        let mut oracle = Query::without_certificates(&model, Scope::of(&model), Method::Traditional).unwrap();
        for i in 0..12 {
            let norm = tree.limit() * (0.999_999 - 0.04 * f64::from(i));
            let open = open_pairs(hierarchy, tree, norm);
            for pair in oracle.discrete(&[norm]).unwrap() {
                collided += 1;
                assert!(open.binary_search(pair).is_ok(), "case {case}: {pair:?} at {norm}");
            }
        }
    }
    assert!(outer > threshold(1000) && collided > threshold(100), "{outer} {collided}");
}

/// One mode stretches two strips, and lowers the upper one: they meet at q = 0.2, everywhere at once. Each node above the
/// buckets is a part of both strips.
#[test]
fn nodes_above_buckets_are_no_freer_than_their_triangles() {
    let quads = 150;
    let along = |i: usize| 2.0 * i as f64 / quads as f64 - 1.0;
    let strip = |z: f64| (0..=quads).flat_map(move |i| [0.0, 0.02].map(|y| DVec3::new(along(i), y, z)));
    let positions: Vec<DVec3> = strip(0.0).chain(strip(0.002)).collect();
    let squares = (0..2 * quads + 1).filter(|i| *i != quads).map(|i| 2 * i as u32);
    let faces = squares.flat_map(|i| [[i, i + 1, i + 2], [i + 1, i + 3, i + 2]]).collect();
    let modes = positions.iter().map(|p| DVec3::new(p.x, 0.0, if p.z > 0.0 { -0.01 } else { 0.0 })).collect();
    let mesh = TriMesh::new(positions, faces).unwrap();
    let model = ReducedModel::with_metric(mesh, Modes::new(1, modes).unwrap(), Metric::identity(1)).unwrap();
    let options = CertifyOptions::default().budget(4096).local_budget(0);
    let certificates = Certificates::compute(&model, &options, &()).unwrap();
    let parts = certificates.parts();
    assert!(parts.pair_tree.limit() > 0.25, "{}", parts.pair_tree.limit());
    let nodes = parts.hierarchy.nodes().iter().zip(&parts.node_radii);
    let above: Vec<f64> = nodes.filter(|(node, _)| !node.fits_in_bucket()).map(|(_, r)| *r).collect();
    assert!(above.len() > 3 && above.iter().all(|radius| (0.15..=0.2).contains(radius)), "{above:?}");
}

/// Also where no coordinate of the centre is 0.
#[test]
fn norms_clamps_and_digests_depend_on_the_centre() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let positions = [corners, corners.map(|p| p + DVec3::Z)].concat();
    let moves = |v: usize| if v < 3 { [DVec3::ZERO; 2] } else { [DVec3::NEG_Z, DVec3::X] };
    let modes = Modes::new(2, (0..6).flat_map(moves).collect()).unwrap();
    let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let model = ReducedModel::with_metric(mesh, modes, Metric::identity(2)).unwrap();
    let plain = Scope::of(&model);
    let about = |center: [f64; 2]| Scope { center: center.to_vec(), ..plain.clone() };
    for center in [[0.0, 0.0], [0.5, 0.0], [0.25, 0.5]] {
        let norm = about(center).norm(&[center[0] + 3.0, center[1] + 4.0]);
        assert!((5.0..5.0 + 1e-12).contains(&norm), "{center:?}: {norm}");
        assert_eq!(about(center).norm(&center), 0.0);
    }
    let options = CertifyOptions::default().center(vec![0.25, 0.5]).budget(0).local_budget(0);
    let certificates = Certificates::compute(&model, &options, &()).unwrap();
    let (q, root) = ([5.25, -7.5], certificates.root_radius());
    assert!((0.6..=0.75).contains(&root), "{root}");
    let (share, inside) = (root / certificates.norm(&q).unwrap(), certificates.clamp(&q).unwrap().unwrap());
    for ((x, q), c) in inside.iter().zip(q).zip([0.25, 0.5]) {
        assert!((x - (c + (q - c) * share)).abs() <= 1e-12, "{inside:?}");
    }
    let ignoring = |pair| Scope { filter: plain.filter.clone().ignoring([pair]), ..plain.clone() };
    let except = |pair| Scope { exceptions: vec![pair], ..plain.clone() };
    let dense = |s| Scope {
        metric: Metric::from_factor(MetricKind::Given, 2, vec![1.0, s, 0.0, 1.0]).unwrap(),
        ..plain.clone()
    };
    let scopes = [
        plain.clone(),
        about([0.1, 0.2]),
        about([0.2, 0.1]),
        ignoring((0, 1)),
        ignoring((0, 2)),
        except((0, 1)),
        except((0, 2)),
        dense(0.5),
        dense(0.25),
    ];
    let digests = scopes.map(|scope| Digest::of(&model, &scope));
    for (i, digest) in digests.iter().enumerate() {
        assert!(!digests[..i].contains(digest), "{i}");
    }
}
