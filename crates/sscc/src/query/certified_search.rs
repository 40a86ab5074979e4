//! Chooses the traversal at a norm: that of the pair tree if it is complete there, else Algorithm 1 with the certificates of
//! nodes, or without certificates if the method uses none.

use super::certified_traversal::traverse_certified;
use super::context::QueryContext;
use super::hulls::MovedHulls;
use super::local_proofs::LocalProofs;
use super::pair_tree_traversal::{PairTreeStack, traverse_pair_tree};
use crate::Error;
use crate::detect::answer::Proof;
use crate::detect::broad_phase::BroadPhase;
use crate::detect::narrow_phase::NarrowPhase;
use crate::detect::vertex_motion::VertexMotion;

/// The broad phase of a search, with the stack and the moving hulls of the traversal of the pair tree.
#[derive(Clone)]
pub(super) struct CertifiedSearch<const E: usize> {
    pub(super) broad: BroadPhase<E>,
    stack: PairTreeStack,
    hulls: Option<MovedHulls<E>>,
    pub(super) locals: Option<LocalProofs<E>>,
}

/// The pairs that a search finds.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Sought {
    /// All pairs that count.
    All,
    /// All pairs that count, without exceptions, which no certificate covers.
    WithoutExceptions,
}

impl<const E: usize> CertifiedSearch<E> {
    pub(super) fn new(context: &QueryContext) -> Self {
        let layout = &context.detect.layout;
        let broad = BroadPhase::new(layout, context.method.is_lazy(), context.cones());
        let hulls = context.hulls.as_ref().map(|hulls| MovedHulls::new(&hulls.nodes));
        let locals = context.locals.as_deref().map(LocalProofs::new);
        Self { broad, stack: PairTreeStack::default(), hulls, locals }
    }

    /// Finds at most `limit` hits, in no particular order. `norm`: the largest `|z|` of the motion. A certificate holds during a
    /// motion if it holds at start and end, since its region is convex. Returns the kind of proof of the answer, exceptions apart.
    ///
    /// # Errors
    /// When the search was cancelled; then there are no hits.
    pub(super) fn find<M: VertexMotion<E>, N: NarrowPhase<E>>(
        &mut self,
        context: &QueryContext,
        norm: f64,
        motion: &M,
        narrow: &mut N,
        (sought, limit): (Sought, usize),
    ) -> Result<Proof, Error> {
        let Self { broad, stack, hulls, locals } = self;
        let mut search = broad.search(&context.detect, motion, narrow, limit);
        if sought == Sought::All {
            search.test_exceptions();
        }
        if context.is_root_certified(norm) {
            return search.end().map(|()| Proof::Radius);
        }
        let locals = locals.as_mut().zip(context.locals.as_deref());
        let mut locals = locals.filter(|_| norm >= context.local_norm);
        if let Some((proofs, tables)) = &mut locals
            && proofs.begin(tables, motion)
            && proofs.prove_root(tables)
        {
            return search.end().map(|()| Proof::Local);
        }
        match (context.complete_pair_tree(norm), context.used_certificates()) {
            (Some(_), Some(parts)) => {
                let mut hulls = hulls.as_mut().zip(context.hulls.as_deref());
                if let Some((moved, _)) = &mut hulls {
                    moved.begin();
                }
                traverse_pair_tree(&mut search, hulls, locals, stack, parts, norm);
            }
            (_, Some(parts)) => traverse_certified(&mut search, locals, parts, norm),
            (_, None) => search.traverse((0, 0)),
        }
        search.end().map(|()| Proof::Search)
    }
}
