//! Splits an open node pair of the BVTT, and the pairs below it, while their lower bounds are below a limit.

use super::bvtt::{BvttPair, PairState};
use super::preparation::Preparation;
use super::radius_search::RadiusSearch;
use crate::Progress;
use crate::hierarchy::NodePair;
use crate::model::rounding::to_f32_down;

/// A pair of buckets is bounded up to this many times the limit, so that most need no further search in the next round.
const BUCKET_LOOKAHEAD: f64 = 2.0;

/// In the outer round a pair of buckets is searched if its bound by the nodes alone is below this share of the limit. Moving
/// hulls separate most of the others until close to their radius (docs/notes/pair-tree.md#outer-round).
const OUTER_SEARCH_SHARE: f64 = 0.75;

/// The maximum number of pairs that one task bounds; pairs that are then open become further tasks, so that threads finish
/// together. Tests have small models and a small maximum, so that they leave some pairs open, too.
const MAX_BOUNDED: usize = if cfg!(test) { 3 } else { 256 };

/// The number of pairs between two checks for cancellation; searches check it themselves.
const CANCEL_INTERVAL: usize = 64;

/// An open node pair that may collide below a limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SplitTask {
    pub(crate) nodes: NodePair,
    /// A lower bound of its radius.
    pub(crate) lower: f32,
    /// Pairs with a lower bound below this are split.
    pub(crate) limit: f64,
    /// Whether this is the outer round, the last one, with less precise bounds of pairs of buckets.
    pub(crate) is_outer: bool,
}

/// Splits a pair breadth first. The result begins with the pair itself, and its indices refer to the result. After
/// [`MAX_BOUNDED`] pairs the rest stay open. None if cancelled.
pub(super) fn split(
    task: SplitTask,
    preparation: &Preparation,
    search: &mut RadiusSearch<'_>,
    progress: &dyn Progress,
) -> Option<Vec<BvttPair>> {
    let SplitTask { limit, is_outer, .. } = task;
    let mut subtree = vec![BvttPair::open(task.nodes, task.lower)];
    let mut next = 0;
    while next < subtree.len().min(MAX_BOUNDED) {
        if next.is_multiple_of(CANCEL_INTERVAL) && progress.is_cancelled() {
            return None;
        }
        let nodes @ (n, m) = subtree[next].nodes;
        let first = subtree.len() as u32;
        let pair = &mut subtree[next];
        match preparation.hierarchy.split_above_buckets(n, m) {
            None if is_outer => {
                let mut radius = with_mutant!(search.bound_nodes(nodes, limit), OuterPairUnbounded, limit);
                if radius < OUTER_SEARCH_SHARE * limit {
                    let searched = search.between_without_subdivision(nodes, limit)?.radius;
                    radius = with_mutant!(radius.max(searched), OuterSearchForgotten, limit);
                }
                pair.set_state(PairState::Bounded);
                pair.lower = pair.lower.max(to_f32_down(radius));
            }
            None => {
                let cap = (BUCKET_LOOKAHEAD * limit).min(preparation.farthest_in_round(limit));
                let radius = search.between_without_subdivision(nodes, cap)?.radius;
                // A pair whose search ends at a smaller cap than the farthest radius is searched again in a later
                // round.
                if radius < cap || cap == preparation.farthest {
                    pair.set_state(PairState::Bounded);
                }
                let certified = with_mutant!(
                    radius,
                    CappedPairFreeToTheEnd,
                    if radius < cap { radius } else { preparation.farthest }
                );
                pair.lower = pair.lower.max(to_f32_down(certified));
            }
            Some(split) => {
                let lower = pair.lower.max(to_f32_down(search.bound_nodes(nodes, limit)));
                pair.lower = lower;
                if f64::from(lower) < limit {
                    pair.set_state(PairState::Split(first));
                    subtree.extend(split.pairs().map(|nodes| BvttPair::open(nodes, lower)));
                }
            }
        }
        next += 1;
    }
    Some(subtree)
}
