//! Algorithm 1 of the paper: the traversal of the BVTT that opens no node, and no pair of the root's children, whose
//! certificate holds.

use crate::CertificateParts;
use crate::detect::broad_phase::BroadPhase;
use crate::detect::context::Context;
use crate::detect::narrow_phase::NarrowPhase;
use crate::detect::vertex_motion::VertexMotion;

/// Finds all hits but exceptions at a norm.
pub(super) fn traverse_certified<const E: usize, M: VertexMotion<E>, N: NarrowPhase<E>>(
    broad: &mut BroadPhase<E>,
    context: &Context<'_>,
    certificates: &CertificateParts,
    norm: f64,
    motion: &M,
    narrow: &mut N,
) {
    broad.begin_traversal((0, 0), motion);
    while let Some((n, m)) = broad.next_visit(context, narrow) {
        if n != m {
            broad.visit_node_pair(context, (n, m), motion, narrow);
            continue;
        }
        let radius = certificates.node_radii[n as usize];
        let is_certified = right_or!(norm < radius, NodeRadiusReached, norm <= radius);
        if is_certified || !broad.visit_node(context, n, motion, narrow) {
            continue;
        }
        let node = context.hierarchy.nodes()[n as usize];
        for (which, pair) in node.child_pairs().enumerate() {
            // Only the root's children have certificates as pairs.
            let is_within = |radius: f64| right_or!(norm < radius, RootPairRadiusReached, norm <= radius);
            if !(n == 0 && is_within(certificates.root_pair_radii[which])) {
                broad.push_overlapping(n, node.first_child, pair);
            }
        }
    }
    broad.test_deferred_bucket_pair(context, motion, narrow);
}
