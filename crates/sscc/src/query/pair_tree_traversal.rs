//! The traversal of the certified pair tree: only node pairs whose radius is reached are opened.
//!
//! Traversals end at buckets and pairs of buckets. The larger node is always split first, so every descent reaches
//! exactly one of them (docs/notes/2026-11-23-pair-tree-traversal.md).

use super::certified_traversal::LOOSE_PAIRS;
use super::local_proofs::{LocalProofs, work};
use super::local_tables::LocalTables;
use super::pair_hulls::PairHulls;
use crate::PairTree;
use crate::certificates::StoredPair;
use crate::detect::broad_phase::BroadPhase;
use crate::detect::context::Context;
use crate::detect::hulls::MovedHulls;
use crate::detect::narrow_phase::NarrowPhase;
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

/// So many visits of stored pairs take as long as a pair of buckets that is tested in vain ([`LOOSE_PAIRS`]).
const VISITS_OF_LOOSE_PAIR: usize = 8;

/// The entry of a node.
const NODE: u32 = u32::MAX;

/// Whether `|z|` has reached the radius of a stored pair: equality is no proof. A macro keeps the plain comparison of the
/// release build, see docs/notes/2026-11-23-pair-tree-traversal.md.
macro_rules! is_entry_reached {
    ($entry:expr, $norm:expr) => {
        right_or!(f64::from($entry.radius) <= $norm, TreeRadiusReached, f64::from($entry.radius) < $norm)
    };
}

/// Finds all hits but exceptions at a norm below the tree's limit. `node_radii`: the radii of all nodes.
#[expect(clippy::too_many_arguments, reason = "all of them are read in the innermost loop")]
pub(super) fn traverse_pair_tree<const E: usize, M: VertexMotion<E>, N: NarrowPhase<E>>(
    broad: &mut BroadPhase<E>,
    mut hulls: Option<(&mut MovedHulls<E>, &PairHulls)>,
    mut locals: Option<(&mut LocalProofs<E>, &LocalTables)>,
    PairTreeStack(stack): &mut PairTreeStack,
    context: &Context,
    tree: &PairTree,
    node_radii: &[f64],
    norm: f64,
    motion: &M,
    narrow: &mut N,
) {
    // A search that ends at its first hits may open few nodes.
    let mut can_refit = narrow.hits().is_unlimited() && broad.volumes.closed_buckets() > 0;
    let mut visits = 0;
    // Copied, because most searches end before any node is proven.
    let mut work_before = locals.as_ref().map_or(u64::MAX, |(proofs, _)| proofs.work_before());
    let mut has_proofs = locals.as_ref().is_some_and(|(proofs, _)| proofs.is_complete());
    stack.clear();
    stack.push(Visit { nodes: (0, 0), entry: NODE });
    while let Some(Visit { nodes: (n, m), entry }) = stack.pop() {
        if !broad.count_visit(context, narrow) {
            break;
        }
        visits += 1;
        if can_refit
            && broad.loose_pairs + visits / VISITS_OF_LOOSE_PAIR
                > LOOSE_PAIRS * broad.volumes.closed_buckets()
        {
            broad.volumes.refit(&context.hierarchy, motion);
            can_refit = false;
        }
        if work(visits as u64, broad.counters.box_tests) > work_before
            && let Some((proofs, tables)) = &mut locals
        {
            proofs.prove(tables, &context.hierarchy, node_radii, norm);
            (work_before, has_proofs) = (u64::MAX, true);
        }
        let buckets = &broad.volumes.layout.buckets;
        if entry == NODE {
            if has_proofs && locals.as_ref().is_some_and(|(proofs, tables)| proofs.is_node_proven(tables, n))
            {
                continue;
            }
            broad.counters.opened += 1;
            if let Some(bucket) = buckets.of_node(n) {
                broad.test_bucket(context, bucket, motion, narrow);
                continue;
            }
            let node = context.hierarchy.nodes()[n as usize];
            let is_reached = |child: &u32| {
                let radius = node_radii[*child as usize];
                right_or!(norm >= radius, TreeNodeRadiusReached, norm > radius)
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
        broad.counters.box_tests += 1;
        [n, m].iter().for_each(|n| broad.volumes.update_node(*n, motion));
        if !broad.volumes.node(n).overlaps(broad.volumes.node(m)) {
            continue;
        }
        let buckets = [n, m].map(|n| broad.volumes.layout.buckets.of_node(n));
        // The boxes of open buckets are tighter and cost less.
        let is_open = buckets.iter().all(|b| b.is_some_and(|b| broad.volumes.is_bucket_open(b)));
        if let Some((moved, pairs)) = &mut hulls
            && moved.is_useful()
            && !is_open
            && let Some(at_rest) = pairs.direction(entry)
        {
            broad.counters.hull_tests += 1;
            if moved.are_apart(&pairs.nodes, (n, m), at_rest, broad.volumes.frame(), motion) {
                continue;
            }
        }
        if let [Some(a), Some(b)] = buckets {
            broad.defer_bucket_pair(context, (a, b), motion, narrow);
            continue;
        }
        broad.counters.opened += 1;
        if let Some(split) = context.hierarchy.split_above_buckets(n, m) {
            for StoredPair { index, entry: stored } in tree.below(entry) {
                if is_entry_reached!(stored, norm) {
                    stack.push(Visit { nodes: split.pair(stored.which()), entry: index });
                }
            }
        }
    }
    broad.test_deferred_bucket_pair(context, motion, narrow);
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::detect::narrow_phase::DiscreteHits;
    use crate::detect::vertex_motion::DeformedMotion;
    use crate::{Certificates, CertifyOptions, Method, Modes, Query, ReducedModel, test_models};

    /// A square of 3200 triangles, and two modes that cancel each other: where both coordinates are the same, AABBs of the BD-tree
    /// grow, and the square does not move. The mean of a mode over each triangle is 0, so the hierarchy is that of the positions.
    fn square() -> ReducedModel {
        let mesh = test_models::square(40);
        let colours = [DVec3::new(4.0, 0.0, 0.0), DVec3::new(-2.0, 2.0, 1.0), DVec3::new(-2.0, -2.0, -1.0)];
        let modes = (0..41 * 41).flat_map(|i| {
            let u = colours[(i % 41 + 2 * (i / 41)) % 3];
            [u, -u]
        });
        ReducedModel::new(mesh, Modes::new(2, modes.collect()).unwrap()).unwrap()
    }

    /// Below the limit of a tree that stores all node pairs, at norms that reach the radii of all of them, where no hull separates
    /// nodes.
    #[test]
    fn loose_boxes_are_refitted_before_all_node_pairs_are_opened() {
        let model = square();
        let options =
            CertifyOptions { budget: 1 << 12, local_budget: 0, reach: 16.0, ..CertifyOptions::default() };
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let (tree, node_radii) = (&certificates.parts().pair_tree, &certificates.parts().node_radii);
        let query = Query::new(&model, &certificates).unwrap();
        let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
        let context = &query.context.detect;
        for q in [[10.0, 10.0], [10.0, 9.8]] {
            let norm = certificates.norm(&q);
            assert!(norm < tree.limit() && tree.entries().all(|(radius, _)| f64::from(radius) < norm));
            let motion = DeformedMotion::new([&q[..]], model.check_coordinates(&q).unwrap());
            let [tight, found] = [false, true].map(|is_certified| {
                let mut broad = BroadPhase::new(&context.layout, is_certified, None);
                let mut narrow = DiscreteHits::default();
                broad.begin();
                broad.begin_volumes(context, &motion);
                if is_certified {
                    let mut stack = PairTreeStack::default();
                    traverse_pair_tree(
                        &mut broad,
                        None,
                        None,
                        &mut stack,
                        context,
                        tree,
                        node_radii,
                        norm,
                        &motion,
                        &mut narrow,
                    );
                } else {
                    broad.traverse(context, (0, 0), &motion, &mut narrow);
                }
                narrow.0.list.sort_unstable();
                assert_eq!(narrow.0.list, oracle.discrete(&q).unwrap());
                (broad.counters.opened, broad.loose_pairs, broad.volumes.closed_buckets())
            });
            let ((tight, ..), (opened, loose, closed)) = (tight, found);
            // Without refitting 1,033 against 343, and 108 loose pairs.
            let buckets = context.layout.buckets.count();
            assert!(
                closed == 0 && opened < 2 * tight && loose < buckets,
                "{opened} {tight} {loose} {buckets}"
            );
        }
    }
}
