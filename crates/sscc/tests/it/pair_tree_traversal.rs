//! Compares queries by the certified pair tree with brute force: pairs that it skips must never count.

use glam::DVec3;
use sscc::parts::{CertificateParts, PairTree};
use sscc::{
    Certificates, CertifyOptions, ContactFilter, Error, Method, Modes, Neighbours, Query, ReducedModel,
    TriMesh,
};
use sscc_testing::cases;

use crate::common::{Random, after, winding_strip};

fn scaled(z: &[f64], size: f64) -> Vec<f64> {
    z.iter().map(|x| x * size).collect()
}

#[test]
fn traversal_agrees_with_brute_force() {
    let (mut below, mut hits, mut beyond, mut with_exceptions, mut partial) = (0, 0, 0, 0, 0);
    // Outside of CI the seeds also contain all combinations of options.
    let seeds = cases(96_u64).min(40);
    for seed in 0..seeds {
        let random = &mut Random::new(seed + 500);
        let model = winding_strip(random, seed);
        let neighbours = [Neighbours::Exclude, Neighbours::IncludeOneVertex][seed as usize % 2];
        let options = CertifyOptions::default()
            .epsilon(0.5)
            .filter(ContactFilter::new(neighbours).weld(seed.is_multiple_of(3)))
            .budget([512, 40, 4][seed as usize / 2 % 3]);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        with_exceptions += usize::from(!certificates.exceptions().is_empty());
        let tree = &certificates.parts().pair_tree;
        let query = |method| Query::with_method(&model, &certificates, method).unwrap();
        let (mut oracle, mut traditional) = (query(Method::BruteForce), query(Method::Traditional));
        let mut certified = query(Method::Certified);
        let radii: Vec<f64> = tree.entries().map(|(radius, _)| f64::from(radius)).collect();
        for case in 0..12 {
            let z: Vec<f64> = (0..model.rank()).map(|_| random.signed()).collect();
            let unit = certificates.norm(&model.metric().unscaled(&z).unwrap()).unwrap();
            let goal = match case {
                0 => tree.limit() * (1.0 - 1e-12),
                1 => tree.limit() * (1.0 + 1e-12),
                2 => tree.limit() * 2.0,
                3..6 if !radii.is_empty() => radii[random.below(radii.len())] * (1.0 + 1e-12),
                _ => tree.limit().max(certificates.root_radius()) * random.uniform(),
            };
            let q = scaled(&model.metric().unscaled(&z).unwrap(), goal / unit);
            let expected = oracle.discrete(&q).unwrap().to_vec();
            assert_eq!(certified.discrete(&q).unwrap(), expected, "model {seed}, case {case}");
            assert_eq!(traditional.discrete(&q).unwrap(), expected, "model {seed}, case {case}");
            let walked = certified.statistics().norm < tree.limit() && !certified.statistics().root_certified;
            below += usize::from(walked);
            beyond += usize::from(certified.statistics().norm >= tree.limit());
            hits += if walked { expected.len() } else { 0 };
            for limit in [1, 3, expected.len().max(1)] {
                let some = certified.discrete_at_most(&q, limit).unwrap();
                assert_eq!(some.len(), limit.min(expected.len()));
                assert!(some.iter().all(|pair| expected.binary_search(pair).is_ok()));
                partial += usize::from(!certified.statistics().complete);
            }
            let other: Vec<f64> = q.iter().map(|x| x + random.signed() * 0.1 * goal / unit).collect();
            let expected = oracle.continuous(&q, &other).unwrap().to_vec();
            assert_eq!(certified.continuous(&q, &other).unwrap(), expected, "model {seed}, case {case}");
            assert_eq!(traditional.continuous(&q, &other).unwrap(), expected, "model {seed}, case {case}");
        }
    }
    let counts = (below, hits, beyond, with_exceptions, partial);
    let least = |all: u64| (all * seeds / 40) as usize;
    assert!(below > least(50) && hits > least(300) && beyond > least(50), "{counts:?}");
    assert!(with_exceptions > least(3) && partial > least(50), "{counts:?}");
}

/// Returns two sheets of several buckets, at a distance of 1; the upper one is folded, and the mode lowers it.
fn sheets() -> ReducedModel {
    let (n, mut p, mut faces) = (9_u32, Vec::new(), Vec::new());
    for sheet in 0..2 {
        let first = p.len() as u32;
        let height = |i: u32| f64::from(sheet) * (1.0 + 0.5 * f64::from(i / (n + 1) % 2));
        let at = |i: u32| DVec3::new(f64::from(i / (n + 1)), f64::from(i % (n + 1)), height(i));
        p.extend((0..(n + 1) * (n + 1)).map(at));
        for i in 0..n * n {
            let a = first + i / n * (n + 1) + i % n;
            faces.extend([[a, a + 1, a + n + 1], [a + 1, a + n + 2, a + n + 1]]);
        }
    }
    let (vertices, upper) = (p.len(), p.len() / 2);
    let entry = |row: usize, _| if row >= 3 * upper && row % 3 == 2 { -1.0 } else { 0.0 };
    let modes = Modes::from_matrix(vertices, 1, entry).unwrap();
    ReducedModel::new(TriMesh::new(p, faces).unwrap(), modes).unwrap()
}

/// Returns the same certificates with invented radii: 0 for the root, and the same radius for all others; or without any stored pair.
fn with_radii(certificates: &Certificates, radius: f64, limit: f64, stored: bool) -> Certificates {
    let parts = certificates.parts();
    let tree = &parts.pair_tree;
    let pair_tree = if stored {
        let entries = tree.entries().map(|(_, link)| (radius as f32, link)).collect::<Vec<_>>();
        PairTree::from_parts(limit, tree.starts().to_vec(), entries)
    } else {
        PairTree::from_parts(limit, vec![u32::MAX; tree.starts().len()], [])
    };
    let mut node_radii = vec![radius; parts.node_radii.len()];
    node_radii[0] = 0.0;
    Certificates::try_from(CertificateParts {
        node_radii,
        root_pair_radii: vec![0.0; parts.root_pair_radii.len()],
        pair_tree,
        ..parts.clone()
    })
    .unwrap()
}

/// A norm below a radius or the limit is certified, an equal norm is not.
#[test]
fn norms_equal_to_a_radius_are_not_certified() {
    let model = sheets();
    let options = CertifyOptions::default().budget(1 << 16).epsilon(0.5);
    let computed = Certificates::compute(&model, &options, &()).unwrap();
    // A q at which the sheets collide, whose norm is a number in single precision.
    let near = 1.25_f64.to_bits() - 64;
    let norm = |q: f64| computed.norm(&[q]).unwrap();
    let single = |q: &f64| f64::from(norm(*q) as f32) == norm(*q);
    let q = (0..128).map(|i| f64::from_bits(near + i)).find(single).unwrap();
    let norm = norm(q);
    assert!(norm < computed.parts().pair_tree.limit());
    let mut oracle = Query::with_method(&model, &computed, Method::BruteForce).unwrap();
    let expected = oracle.discrete(&[q]).unwrap().len();
    assert!(expected > 100, "{expected}");
    let found = |certificates: &Certificates| {
        let mut query = Query::new(&model, certificates).unwrap();
        let found = query.discrete(&[q]).unwrap().len();
        assert_eq!(query.continuous(&[q], &[q]).unwrap().len(), found);
        found
    };
    let (next, limit) = (f64::from((norm as f32).next_up()), computed.parts().pair_tree.limit());
    assert_eq!(found(&computed), expected);
    assert_eq!(found(&with_radii(&computed, norm, limit, true)), expected);
    assert_eq!(found(&with_radii(&computed, next, limit, true)), 0);
    // Pairs that are not stored are certified only below the limit.
    assert!(found(&with_radii(&computed, next, norm, false)) > 0);
    assert_eq!(found(&with_radii(&computed, next, norm.next_up(), false)), 0);
}

#[test]
fn a_cancelled_query_is_an_error_or_right() {
    let (model, mut random) = (sheets(), Random::new(3));
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let mut query = Query::new(&model, &certificates).unwrap().cancelled_by(after(0));
    let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
    for _ in 0..20 {
        let q = [random.uniform() * 2.0];
        match query.discrete(&q) {
            Ok(pairs) => assert_eq!(pairs, oracle.discrete(&q).unwrap()),
            Err(error) => assert_eq!(error, Error::Cancelled),
        }
    }
}
