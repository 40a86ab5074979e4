//! The traversal of the certified pair tree, which opens only node pairs whose radius is reached.
//!
//! Traversals end at buckets and pairs of buckets. The larger node is always split first, so every descent reaches
//! exactly one of them (docs/notes/traversal.md#end-at-buckets).

use super::certified_traversal::LOOSE_PAIRS;
use super::hulls::MovedHulls;
use super::local_proofs::{LocalProofs, work};
use super::local_tables::LocalTables;
use super::pair_hulls::PairHulls;
use crate::certificates::CertificateParts;
use crate::certificates::StoredPair;
use crate::detect::narrow_phase::NarrowPhase;
use crate::detect::search::Search;
use crate::detect::vertex_motion::VertexMotion;
use crate::hierarchy::NodePair;

/// Nodes and node pairs still to be visited.
#[derive(Clone, Default)]
pub(super) struct PairTreeStack(Vec<Visit>);

/// A node `(n, n)` or a node pair `(n, m)` whose radius is reached.
#[derive(Clone, Copy)]
struct Visit {
    nodes: NodePair,
    /// The entry of a node pair in the tree; [`NODE`] for a node.
    entry: u32,
}

/// This many visits of stored pairs take as long as the test of a pair of buckets without a hit ([`LOOSE_PAIRS`]).
const VISITS_OF_LOOSE_PAIR: usize = 8;

/// Visits between two checks whether refitted AABBs or local proofs would now save work: a check at each visit takes 3% of a short
/// search.
const VISITS_OF_CHECK: usize = 8;

/// The value of [`Visit::entry`] for a node.
const NODE: u32 = u32::MAX;

/// Whether `|z|` has reached the radius of a stored pair: the pair is not certified at equality. It is a macro so that the release
/// build has a plain comparison, see docs/notes/traversal.md#end-at-buckets.
macro_rules! is_entry_reached {
    ($entry:expr, $norm:expr) => {
        with_mutant!(f64::from($entry.radius) <= $norm, TreeRadiusReached, f64::from($entry.radius) < $norm)
    };
}

/// Finds all hits except exceptions at a norm below the tree's limit.
pub(super) fn traverse_pair_tree<const E: usize, M: VertexMotion<E>, N: NarrowPhase<E>>(
    search: &mut Search<'_, 1, E, M, N>,
    mut hulls: Option<(&mut MovedHulls<E>, &PairHulls)>,
    mut locals: Option<(&mut LocalProofs<E>, &LocalTables)>,
    PairTreeStack(stack): &mut PairTreeStack,
    CertificateParts { pair_tree: tree, node_radii, .. }: &CertificateParts,
    norm: f64,
) {
    let hierarchy = &search.sides[0].context.hierarchy;
    // A search that ends at its first hits may open few nodes.
    let mut can_refit = search.narrow.hits().is_unlimited() && search.sides[0].volumes.closed_buckets() > 0;
    let mut visits = 0_usize;
    // Copied, because most searches end before any node is proven.
    let mut work_before = locals.as_ref().map_or(u64::MAX, |(proofs, _)| proofs.work_before());
    let mut has_proofs = locals.as_ref().is_some_and(|(proofs, _)| proofs.is_complete());
    stack.clear();
    stack.push(Visit { nodes: (0, 0), entry: NODE });
    while let Some(Visit { nodes: (n, m), entry }) = stack.pop() {
        if !search.count_visit() {
            break;
        }
        visits += 1;
        if visits.is_multiple_of(VISITS_OF_CHECK) {
            if can_refit
                && search.state.loose_pairs + visits / VISITS_OF_LOOSE_PAIR
                    > LOOSE_PAIRS * search.sides[0].volumes.closed_buckets()
            {
                search.sides[0].refit();
                can_refit = false;
            }
            if work(visits as u64, search.state.counters.box_tests) > work_before
                && let Some((proofs, tables)) = &mut locals
            {
                proofs.prove(tables, hierarchy, node_radii, norm);
                (work_before, has_proofs) = (u64::MAX, true);
            }
        }
        if entry == NODE {
            if has_proofs && locals.as_ref().is_some_and(|(proofs, tables)| proofs.is_node_proven(tables, n))
            {
                continue;
            }
            search.state.counters.opened += 1;
            if let Some(bucket) = search.sides[0].bucket(n) {
                search.test_bucket(bucket);
                continue;
            }
            let node = hierarchy.nodes()[n as usize];
            let is_reached = |child: &u32| {
                let radius = node_radii[*child as usize];
                with_mutant!(norm >= radius, TreeNodeRadiusReached, norm > radius)
            };
            let children = node.children().filter(is_reached);
            stack.extend(children.map(|child| Visit { nodes: (child, child), entry: NODE }));
            let mut pairs = node.child_pairs().enumerate();
            for StoredPair { index, entry: stored } in tree.of_node(n) {
                if let Some((_, nodes)) = pairs.find(|(which, _)| *which == stored.which() as usize)
                    && is_entry_reached!(stored, norm)
                {
                    stack.push(Visit { nodes, entry: index });
                }
            }
            continue;
        }
        if has_proofs
            && let Some((proofs, tables)) = &mut locals
            && proofs.is_pair_proven(tables, (n, m))
        {
            continue;
        }
        search.state.counters.box_tests += 1;
        let [side] = &mut search.sides;
        [n, m].iter().for_each(|n| side.update_node(*n));
        if !side.volumes.node(n).overlaps(side.volumes.node(m)) {
            continue;
        }
        let buckets = [n, m].map(|n| side.bucket(n));
        // The boxes of open buckets are tighter and cost less.
        let is_open = buckets.iter().all(|b| b.is_some_and(|b| side.volumes.is_bucket_open(b)));
        if let Some((moved, pairs)) = &mut hulls
            && moved.is_useful()
            && !is_open
            && let Some(at_rest) = pairs.direction(entry)
        {
            search.state.counters.hull_tests += 1;
            if moved.are_apart(&pairs.nodes, (n, m), at_rest, side.volumes.frame(), side.motion) {
                continue;
            }
        }
        if let [Some(a), Some(b)] = buckets {
            search.test_bucket_pair((a, b));
            continue;
        }
        search.state.counters.opened += 1;
        if let Some(split) = hierarchy.split_above_buckets(n, m) {
            for StoredPair { index, entry: stored } in tree.below(entry) {
                if is_entry_reached!(stored, norm) {
                    stack.push(Visit { nodes: split.pair(stored.which()), entry: index });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::detect::broad_phase::BroadPhase;
    use crate::detect::narrow_phase::DiscreteHits;
    use crate::detect::vertex_motion::DeformedMotion;
    use crate::{Certificates, CertifyOptions, Method, Modes, Query, ReducedModel, test_models};

    /// Returns a square of 3200 triangles with two modes that cancel each other: at equal coordinates AABBs of the BD-tree grow, and
    /// the square does not move. The mean of a mode over each triangle is 0, so the hierarchy is that of the positions.
    fn square() -> ReducedModel {
        let mesh = test_models::square(40);
        let colours = [DVec3::new(4.0, 0.0, 0.0), DVec3::new(-2.0, 2.0, 1.0), DVec3::new(-2.0, -2.0, -1.0)];
        let modes = (0..41 * 41).flat_map(|i| {
            let u = colours[(i % 41 + 2 * (i / 41)) % 3];
            [u, -u]
        });
        ReducedModel::new(mesh, Modes::new(2, modes.collect()).unwrap()).unwrap()
    }

    /// The norms are below the limit of a tree that stores all node pairs, and reach the radii of all of them; no hull separates
    /// nodes.
    #[test]
    fn loose_boxes_are_refitted_before_all_node_pairs_are_opened() {
        let model = square();
        let options = CertifyOptions::default().budget(1 << 12).local_budget(0).reach(16.0);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let tree = &certificates.parts().pair_tree;
        let query = Query::new(&model, &certificates).unwrap();
        let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
        let context = &query.context.detect;
        for q in [[10.0, 10.0], [10.0, 9.8]] {
            let norm = certificates.norm(&q).unwrap();
            assert!(norm < tree.limit() && tree.entries().all(|(radius, _)| f64::from(radius) < norm));
            let motion = DeformedMotion::new([&q[..]], model.check_coordinates(&q).unwrap());
            let [tight, found] = [false, true].map(|is_certified| {
                let mut broad = BroadPhase::new(&context.layout, is_certified, None);
                let mut narrow = DiscreteHits::default();
                let mut search = broad.search(context, &motion, &mut narrow, usize::MAX);
                if is_certified {
                    let mut stack = PairTreeStack::default();
                    traverse_pair_tree(&mut search, None, None, &mut stack, certificates.parts(), norm);
                } else {
                    search.traverse((0, 0));
                }
                narrow.0.list.sort_unstable();
                assert_eq!(narrow.0.list, oracle.discrete(&q).unwrap());
                (broad.state.counters.opened, broad.state.loose_pairs, broad.volumes.closed_buckets())
            });
            let ((tight, ..), (opened, loose, closed)) = (tight, found);
            // Without refitting, 1,033 nodes are opened in place of 343, and there are 108 loose pairs.
            let buckets = context.layout.buckets.count();
            assert!(
                closed == 0 && opened < 2 * tight && loose < buckets,
                "{opened} {tight} {loose} {buckets}"
            );
        }
    }
}
