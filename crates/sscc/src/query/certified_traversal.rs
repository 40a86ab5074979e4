//! Algorithm 1 of the paper: the traversal of the BVTT that opens no node, and no pair of the root's children, whose
//! certificate holds.
//!
//! BD-tree AABBs are loose far from rest. Where they have led to many pairs of buckets without a hit, or most buckets stay
//! open despite local certificates, all AABBs are refitted, as the traditional method does, and the traversal continues with those.

use super::local_proofs::{LocalProofs, work};
use super::local_tables::LocalTables;
use crate::certificates::CertificateParts;
use crate::detect::narrow_phase::NarrowPhase;
use crate::detect::search::Search;
use crate::detect::vertex_motion::VertexMotion;

/// All AABBs are refitted once more than this many pairs of buckets were tested without a hit for each bucket that is
/// not open. Such a test takes about a tenth of the time in which a bucket is opened, so a search never loses much more
/// than it can gain, and takes little longer than the traditional method (docs/notes/traversal.md#loose-aabbs).
pub(super) const LOOSE_PAIRS: usize = 2;

/// Finds all hits except exceptions at a norm.
pub(super) fn traverse_certified<const E: usize, M: VertexMotion<E>, N: NarrowPhase<E>>(
    search: &mut Search<'_, 1, E, M, N>,
    mut locals: Option<(&mut LocalProofs<E>, &LocalTables)>,
    certificates: &CertificateParts,
    norm: f64,
) {
    let hierarchy = &search.sides[0].context.hierarchy;
    // A search that ends at its first hits may open few nodes.
    let mut can_refit = search.narrow.hits().is_unlimited() && search.sides[0].volumes.closed_buckets() > 0;
    let mut visits = 0;
    // Copied, because many searches end before any node is proven.
    let mut work_before = locals.as_ref().map_or(u64::MAX, |(proofs, _)| proofs.work_before());
    let mut has_proofs = locals.as_ref().is_some_and(|(proofs, _)| proofs.is_complete());
    search.begin_traversal((0, 0));
    while let Some((n, m)) = search.next_visit() {
        if can_refit && search.state.loose_pairs > LOOSE_PAIRS * search.sides[0].volumes.closed_buckets() {
            search.sides[0].refit();
            can_refit = false;
        }
        visits += 1;
        if work(visits, search.state.counters.box_tests) > work_before
            && let Some((proofs, tables)) = &mut locals
        {
            proofs.prove(tables, hierarchy, &certificates.node_radii, norm);
            (work_before, has_proofs) = (u64::MAX, true);
            if can_refit && proofs.leaves_most_open() {
                search.sides[0].refit();
                can_refit = false;
            }
        }
        if n != m {
            if has_proofs
                && let Some((proofs, tables)) = &mut locals
                && proofs.is_pair_proven(tables, (n, m))
            {
                continue;
            }
            search.visit_node_pair((n, m));
            continue;
        }
        let radius = certificates.node_radii[n as usize];
        let is_certified = with_mutant!(norm < radius, NodeRadiusReached, norm <= radius);
        let is_proven = || locals.as_ref().is_some_and(|(proofs, tables)| proofs.is_node_proven(tables, n));
        if is_certified || has_proofs && is_proven() {
            continue;
        }
        if !search.visit_node(n) {
            continue;
        }
        let node = hierarchy.nodes()[n as usize];
        for (which, pair) in node.child_pairs().enumerate() {
            // Only the root's children have certificates as pairs.
            let is_within = |radius: f64| with_mutant!(norm < radius, RootPairRadiusReached, norm <= radius);
            if !(n == 0 && is_within(certificates.root_pair_radii[which])) {
                search.push_overlapping(n, node.first_child, pair);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::certificates::{FactorScales, LocalBounds, LocalCertificates};
    use crate::detect::broad_phase::BroadPhase;
    use crate::detect::narrow_phase::DiscreteHits;
    use crate::detect::vertex_motion::DeformedMotion;
    use crate::test_models::{self, Random};
    use crate::{Certificates, CertifyOptions, Method, Modes, Query, ReducedModel};

    /// Returns a square of 1800 triangles with two modes that cancel each other: at equal coordinates AABBs of the
    /// BD-tree grow, and the square does not move.
    fn square() -> ReducedModel {
        let (mesh, random) = (test_models::square(30), &mut Random(77));
        let modes = (0..mesh.rest_positions().len()).flat_map(|_| {
            let u = random.vector();
            [u, -u]
        });
        ReducedModel::new(mesh, Modes::new(2, modes.collect()).unwrap()).unwrap()
    }

    #[test]
    fn loose_boxes_are_refitted_before_they_cost_much() {
        let model = square();
        let options = CertifyOptions::default().budget(0);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let query = Query::new(&model, &certificates).unwrap();
        let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
        let context = &query.context;
        let buckets = context.detect.layout.buckets.count();
        for (q, is_loose) in [([4.0, 4.0], true), ([4.0, 3.8], true), ([1e-3, 1e-3], false)] {
            let motion = DeformedMotion::new([&q[..]], model.check_coordinates(&q).unwrap());
            let mut found = [true, false].map(|is_certified| {
                let mut broad = BroadPhase::new(&context.detect.layout, true, None);
                let mut narrow = DiscreteHits::default();
                let mut search = broad.search(&context.detect, &motion, &mut narrow, usize::MAX);
                if is_certified {
                    traverse_certified(
                        &mut search,
                        None,
                        certificates.parts(),
                        certificates.norm(&q).unwrap(),
                    );
                } else {
                    search.traverse((0, 0));
                }
                narrow.0.list.sort_unstable();
                (narrow.0.list, broad.state.loose_pairs, broad.volumes.closed_buckets())
            });
            let [(pairs, loose, closed), (others, loose_without, _)] = &mut found;
            assert_eq!(pairs, oracle.discrete(&q).unwrap());
            assert_eq!(pairs, others);
            if is_loose {
                assert!(*closed == 0 && *loose_without > 8 * buckets, "{loose_without} {buckets}");
                assert!(*loose <= 4 * buckets, "{loose} {buckets}");
            } else {
                assert_eq!(*closed, buckets);
            }
        }
    }

    #[test]
    fn nodes_and_pairs_without_a_proof_are_opened() {
        let model = square();
        let certificates = Certificates::compute(&model, &CertifyOptions::default().budget(0), &()).unwrap();
        let query = Query::new(&model, &certificates).unwrap();
        let context = &query.context;
        let (hierarchy, parts) = (&*context.detect.hierarchy, certificates.parts());
        let nodes = hierarchy.nodes();
        let q = [6.0, 4.0];
        let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
        let all = oracle.discrete(&q).unwrap().to_vec();
        let child_of =
            |t: u32| nodes[0].children().position(|n| hierarchy.triangles(&nodes[n as usize]).contains(&t));
        let within: Vec<_> = all.iter().copied().filter(|(a, b)| child_of(*a) == child_of(*b)).collect();
        assert!(!within.is_empty() && within.len() < all.len());
        // The certificate of the root proves nothing.
        let local = LocalCertificates {
            nodes: vec![0],
            mode_starts: vec![0, 0],
            bounds: vec![LocalBounds { ratio: f64::INFINITY, ..LocalBounds::default() }],
            list_starts: vec![0, 0],
            ..LocalCertificates::default()
        };
        let scales = FactorScales { sizes: vec![1.0; 2], scale: 1.0, reach: 1.0 };
        let tables = LocalTables::new(&Arc::new(local), hierarchy, &[0.0; 2], scales).unwrap();
        let motion = DeformedMotion::new([&q[..]], model.check_coordinates(&q).unwrap());
        let norm = certificates.norm(&q).unwrap();
        for (radius, expected) in [(0.0, &all), (f64::INFINITY, &within)] {
            let parts = CertificateParts {
                node_radii: vec![0.0; nodes.len()],
                root_pair_radii: vec![radius; parts.root_pair_radii.len()],
                ..parts.clone()
            };
            let mut proofs = LocalProofs::<1>::new(&tables);
            assert!(proofs.begin(&tables, &motion));
            proofs.prove(&tables, hierarchy, &parts.node_radii, norm);
            assert!(proofs.is_complete() && !proofs.is_node_proven(&tables, 0));
            let mut broad = BroadPhase::new(&context.detect.layout, true, None);
            let mut narrow = DiscreteHits::default();
            let mut search = broad.search(&context.detect, &motion, &mut narrow, usize::MAX);
            traverse_certified(&mut search, Some((&mut proofs, &tables)), &parts, norm);
            narrow.0.list.sort_unstable();
            assert_eq!(&narrow.0.list, expected, "{radius}");
        }
    }
}
