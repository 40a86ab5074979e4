//! Chooses the traversal at a norm: of the pair tree if it is complete there, else Algorithm 1 with the certificates of
//! nodes, else without certificates. Where Algorithm 1 would open most buckets, all AABBs are refitted first.

use super::certified_traversal::traverse_certified;
use super::context::QueryContext;
use super::local_proofs::LocalProofs;
use super::pair_tree_traversal::{PairTreeStack, traverse_pair_tree};
use crate::detect::broad_phase::BroadPhase;
use crate::detect::hulls::MovedHulls;
use crate::detect::narrow_phase::NarrowPhase;
use crate::detect::vertex_motion::VertexMotion;

/// The broad phase of a search, and what the traversal of the pair tree needs: its stack and moving hulls.
#[derive(Clone)]
pub(super) struct CertifiedSearch<const E: usize> {
    pub(super) broad: BroadPhase<E>,
    stack: PairTreeStack,
    hulls: Option<MovedHulls<E>>,
    pub(super) locals: Option<LocalProofs<E>>,
}

impl<const E: usize> CertifiedSearch<E> {
    pub(super) fn new(context: &QueryContext) -> Self {
        let layout = &context.detect.layout;
        let broad = BroadPhase::new(layout, context.method.is_lazy(), context.cones());
        let hulls = context.hulls.as_ref().map(|hulls| MovedHulls::new(&hulls.nodes));
        let locals = context.locals.as_deref().map(LocalProofs::new);
        Self { broad, stack: PairTreeStack::default(), hulls, locals }
    }

    /// Finds all hits but exceptions. `norm`: the largest `|z|` of the motion. A certificate holds during a motion if it
    /// holds at start and end, since its region is convex. Returns whether the root's local certificate proved the shape free.
    pub(super) fn find<M: VertexMotion<E>, N: NarrowPhase<E>>(
        &mut self,
        context: &QueryContext,
        norm: f64,
        motion: &M,
        narrow: &mut N,
    ) -> bool {
        let locals = self.locals.as_mut().zip(context.locals.as_deref());
        let mut locals = locals.filter(|_| norm >= context.local_norm);
        if let Some((proofs, tables)) = &mut locals
            && proofs.begin(tables, motion)
            && proofs.prove_root(tables)
        {
            return true;
        }
        match (context.complete_pair_tree(norm), context.used_certificates()) {
            (Some(tree), Some(parts)) => {
                let radii = &parts.node_radii;
                let mut hulls = self.hulls.as_mut().zip(context.hulls.as_deref());
                if let Some((moved, _)) = &mut hulls {
                    moved.begin();
                }
                traverse_pair_tree(
                    &mut self.broad,
                    hulls,
                    locals,
                    &mut self.stack,
                    &context.detect,
                    tree,
                    radii,
                    norm,
                    motion,
                    narrow,
                );
            }
            (_, Some(parts)) => {
                // A search that ends at its first hits may open few nodes.
                if norm >= context.refit_norm && narrow.hits().is_unlimited() {
                    let is_mostly_open = locals.as_mut().is_none_or(|(proofs, tables)| {
                        proofs.prove(tables, &context.detect.hierarchy, &parts.node_radii, norm);
                        proofs.is_mostly_open()
                    });
                    if is_mostly_open {
                        self.broad.volumes.refit(&context.detect.hierarchy, motion);
                    }
                }
                traverse_certified(&mut self.broad, locals, &context.detect, parts, norm, motion, narrow);
            }
            (_, None) => self.broad.traverse(&context.detect, (0, 0), motion, narrow),
        }
        false
    }
}
