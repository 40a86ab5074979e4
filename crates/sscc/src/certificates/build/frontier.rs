//! The frontier of the BVTT below some node pairs: the node pairs that are not split.

use std::ops::Range;

use super::bvtt::{Bvtt, PairState};
use super::radius_bound::BoundedNodePair;
use crate::hierarchy::Hierarchy;

/// The pairs of a frontier that may have a radius below a cap, with their lower bounds.
pub(super) struct Frontier {
    /// The smallest radius of the bounded pairs, at most the cap.
    pub(super) radius: f64,
    /// Pairs of which only a lower bound is known.
    pub(super) open: Vec<BoundedNodePair>,
    /// Pairs of buckets that need no further task. Their bounds have the tolerance of the pair tree or a smaller one, except
    /// those of the outer round, which have none.
    pub(super) bounded: Vec<BoundedNodePair>,
}

impl Frontier {
    /// Collects the frontier below the pairs with these indices.
    pub(super) fn below(bvtt: &Bvtt, hierarchy: &Hierarchy, indices: Range<usize>, cap: f64) -> Self {
        let mut frontier = Self { radius: cap, open: Vec::new(), bounded: Vec::new() };
        let mut stack: Vec<usize> = indices.collect();
        while let Some(index) = stack.pop() {
            let pair = &bvtt.pairs[index];
            let known = BoundedNodePair { nodes: pair.nodes, lower: f64::from(pair.lower) };
            if known.lower >= cap {
                continue;
            }
            match pair.state() {
                PairState::Split(_) => stack.extend(bvtt.children(hierarchy, pair)),
                PairState::Open => frontier.open.push(known),
                PairState::Bounded => {
                    frontier.radius = with_mutant!(
                        frontier.radius.min(known.lower),
                        FrontierBoundedForgotten,
                        frontier.radius
                    );
                    frontier.bounded.push(known);
                }
            }
        }
        frontier
    }
}
