//! The layout of the pair tree: the pairs of the BVTT below a limit, as lists of siblings, breadth first.

use std::ops::Range;

use super::bvtt::{Bvtt, BvttPair, PairState};
use crate::certificates::pair_tree::{NO_PAIRS, PairEntry, PairTree};
use crate::hierarchy::Hierarchy;

/// Returns the tree of all pairs below a limit: the radius below which all pairs are known, lowered until at most `budget` pairs
/// remain.
pub(super) fn lay_out(bvtt: &Bvtt, hierarchy: &Hierarchy, known_below: f64, budget: usize) -> PairTree {
    let limit = fitting_limit(&bvtt.pairs, known_below, budget);
    if limit <= 0.0 {
        return PairTree::default();
    }
    let mut lists = SiblingLists { bvtt, limit, lists: Vec::new(), total: 0 };
    let mut starts = Vec::with_capacity(hierarchy.nodes().len());
    for n in 0..hierarchy.nodes().len() {
        let list = lists.add(bvtt.of_node(n).unwrap_or_default());
        starts.push(if list.stored > 0 { list.start as u32 } else { NO_PAIRS });
    }
    let mut entries: Vec<PairEntry> = Vec::new();
    let mut next = 0;
    while let Some(indices) = lists.lists.get(next).cloned() {
        let first = indices.start;
        let last = indices.clone().rev().find(|index| is_below(&bvtt.pairs[*index], limit));
        for index in indices.filter(|index| is_below(&bvtt.pairs[*index], limit)) {
            let pair = &bvtt.pairs[index];
            let start = match pair.state() {
                PairState::Split(_) => lists.add(bvtt.children(hierarchy, pair)).start,
                PairState::Open | PairState::Bounded => 0,
            };
            entries.push(PairEntry::new(pair.lower, start, index - first, Some(index) == last));
        }
        next += 1;
    }
    PairTree::new(with_mutant!(limit, TreeLimitNotLowered, known_below), starts, entries)
}

fn is_below(pair: &BvttPair, limit: f64) -> bool {
    f64::from(pair.lower) < limit
}

/// Returns the largest limit, at most the given one, with at most `budget` pairs below it.
fn fitting_limit(pairs: &[BvttPair], limit: f64, budget: usize) -> f64 {
    let mut radii: Vec<f32> = pairs.iter().filter(|p| is_below(p, limit)).map(|p| p.lower).collect();
    if radii.len() <= budget {
        return limit;
    }
    let (_, cut, _) = radii.select_nth_unstable_by(budget, f32::total_cmp);
    f64::from(*cut)
}

/// The lists of siblings that are stored at least in part, in the order in which they are stored.
struct SiblingLists<'a> {
    bvtt: &'a Bvtt,
    limit: f64,
    lists: Vec<Range<usize>>,
    /// The number of entries of all lists.
    total: usize,
}

/// A list of siblings in the tree.
struct SiblingList {
    start: usize,
    /// The number of siblings that are stored.
    stored: usize,
}

impl SiblingLists<'_> {
    fn add(&mut self, indices: Range<usize>) -> SiblingList {
        let stored = self.bvtt.pairs[indices.clone()].iter().filter(|p| is_below(p, self.limit)).count();
        let list = SiblingList { start: self.total, stored };
        if stored > 0 {
            self.total += stored;
            self.lists.push(indices);
        }
        list
    }
}
