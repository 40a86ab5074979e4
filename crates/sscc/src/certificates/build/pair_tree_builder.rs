//! Builds the pair tree: chooses its node pairs and computes their radii (beyond the paper's section 5.2).
//!
//! The BVTT is built in rounds with increasing limits. A pair with a lower bound below the limit is split; a pair of
//! buckets gets a radius, without subdivision. The result for a pair depends on the model and the options alone; with
//! one shared priority queue it would depend on the order of threads. The rounds end when the budget is used up, or at
//! the farthest radius. All pairs below the last limit are known. Some of their radii are then searched again
//! (`fine_radii.rs`).
//!
//! The outer round adds the pairs beyond the last limit, up to a larger one, with bounds that take less time and may be
//! smaller. Without them queries beyond the last limit would open every two buckets whose AABBs overlap
//! (docs/notes/pair-tree.md#outer-round).

use std::ops::Range;

use super::bvtt::{Bvtt, BvttPair};
use super::executor::{Executor, Stage};
use super::fine_radii::refine_pairs;
use super::frontier::Frontier;
use super::limit_schedule::LimitSchedule;
use super::pair_tree_layout::lay_out;
use super::preparation::Preparation;
use super::split_task::SplitTask;
use super::task::{Task, TaskResult};
use crate::Error;
use crate::certificates::pair_tree::{MAX_ENTRIES, PairTree};
use crate::hierarchy::{Hierarchy, NodePair};

/// The maximum number of node pairs of the BVTT for each entry that the inner budget allows: most pairs are not needed in the
/// end. Tests have a small maximum, so that they reach it.
const PAIRS_PER_ENTRY: usize = if cfg!(test) { 4 } else { 32 };

/// The maximum number of node pairs of the BVTT, whatever the budget: indices have 32 bits.
const MAX_PAIRS: usize = 1 << 31;

/// The rounds before the outer one may use the budget divided by this: the outer round adds two to three times as many entries.
const INNER_DIVISOR: usize = 4;

/// The number of open pairs that a thread takes at once.
const SPLIT_GRAIN: usize = 8;

/// One round of the construction.
#[derive(Clone, Copy)]
struct Round {
    /// Pairs with smaller bounds are split.
    limit: f64,
    is_outer: bool,
    /// The maximum number of pairs of the BVTT.
    max_pairs: usize,
}

/// Lower bounds of node pairs, from which the pair tree is made.
pub(super) struct PairTreeBuilder {
    bvtt: Bvtt,
    /// All pairs with smaller radii are known; 0 if no pair is known.
    pub(super) complete_below: f64,
    /// The maximum number of entries of the tree.
    budget: usize,
}

impl PairTreeBuilder {
    /// Builds the BVTT for a tree of at most `budget` entries.
    pub(super) fn build(
        preparation: &Preparation,
        budget: usize,
        executor: &mut dyn Executor,
    ) -> Result<Self, Error> {
        let hierarchy = &preparation.hierarchy;
        let budget = budget.min(MAX_ENTRIES);
        let mut builder = Self { bvtt: Bvtt::empty(), complete_below: 0.0, budget };
        let inner_budget = (budget / INNER_DIVISOR).max(1);
        let Preparation { global_radius, farthest, .. } = *preparation;
        let schedule = LimitSchedule::new(global_radius, farthest, inner_budget);
        let Some(mut schedule) = schedule.filter(|_| budget > 0) else { return Ok(builder) };
        builder.bvtt = Bvtt::new(hierarchy);
        let max_pairs =
            inner_budget.saturating_mul(PAIRS_PER_ENTRY).max(2 * builder.bvtt.pairs.len()).min(MAX_PAIRS);
        loop {
            let round = Round { limit: schedule.limit(), is_outer: false, max_pairs };
            let has_room = builder.run_round(hierarchy, round, executor)?;
            let pairs = &builder.bvtt.pairs;
            let count_below = |radius: f64| pairs.iter().filter(|p| f64::from(p.lower) < radius).count();
            if !schedule.advance(has_room, count_below) {
                break;
            }
        }
        builder.complete_below = schedule.complete_below();
        refine_pairs(&mut builder.bvtt, builder.complete_below, preparation, executor)?;
        let below = builder.bvtt.pairs.iter().filter(|p| f64::from(p.lower) < builder.complete_below).count();
        let round = Round {
            limit: schedule.outer_limit(below <= budget),
            is_outer: true,
            max_pairs: max_pairs.saturating_mul(2).min(MAX_PAIRS),
        };
        if round.limit > builder.complete_below {
            let has_room = builder.run_round(hierarchy, round, executor)?;
            if with_mutant!(has_room, RefusedOuterRoundComplete, true) {
                builder.complete_below = round.limit;
            }
        }
        Ok(builder)
    }

    /// Splits or bounds every pair below the limit. Returns false, with the BVTT unchanged, if it would have too many pairs.
    fn run_round(
        &mut self,
        hierarchy: &Hierarchy,
        Round { limit, is_outer, max_pairs }: Round,
        executor: &mut dyn Executor,
    ) -> Result<bool, Error> {
        let bvtt = &mut self.bvtt;
        let before_round = bvtt.pairs.len();
        let mut replaced: Vec<(usize, BvttPair)> = Vec::new();
        let mut open = open_pairs(bvtt, 0..before_round, limit);
        while !open.is_empty() {
            let task = |index: usize| {
                let BvttPair { nodes, lower, .. } = bvtt.pairs[open[index] as usize];
                Task::Split(SplitTask { nodes, lower, limit, is_outer })
            };
            let stage = Stage {
                count: open.len(),
                task: &task,
                grain: SPLIT_GRAIN,
                max_added_pairs: max_pairs.saturating_sub(bvtt.pairs.len()),
                on_finished: &|_| {},
            };
            let Some(results) = executor.run(&stage)? else {
                bvtt.pairs.truncate(before_round);
                if with_mutant!(true, RefusedRoundNotUndone, false) {
                    replaced.into_iter().for_each(|(index, pair)| bvtt.pairs[index] = pair);
                }
                return Ok(false);
            };
            let of_before = open.iter().map(|index| *index as usize).filter(|index| *index < before_round);
            replaced.extend(of_before.map(|index| (index, bvtt.pairs[index])));
            let before_stage = bvtt.pairs.len();
            for (index, subtree) in open.into_iter().zip(results.into_iter().map(TaskResult::into_subtree)) {
                bvtt.replace(index, subtree?);
            }
            open = open_pairs(bvtt, before_stage..bvtt.pairs.len(), limit);
        }
        let is_large = |(n, m): NodePair| hierarchy.split_above_buckets(n, m).is_some();
        if bvtt.pairs.iter().any(|pair| pair.is_open_below(limit) && is_large(pair.nodes)) {
            return Err(Error::Certificates("a node pair was not processed".to_owned()));
        }
        bvtt.pull_up(hierarchy);
        Ok(true)
    }

    /// Whether no radius is known.
    pub(super) fn is_empty(&self) -> bool {
        self.complete_below == 0.0
    }

    /// Returns the frontier below some pairs of a node's children, as far as it may have a radius below `cap`; `siblings` are
    /// their indices among these pairs. None if there is no BVTT.
    pub(super) fn frontier(
        &self,
        hierarchy: &Hierarchy,
        node: usize,
        siblings: Range<usize>,
        cap: f64,
    ) -> Option<Frontier> {
        let first = self.bvtt.of_node(node)?.start;
        let indices = first + siblings.start..first + siblings.end;
        Some(Frontier::below(&self.bvtt, hierarchy, indices, cap))
    }

    /// Returns the pair tree: all pairs below the limit, as far as the budget allows. The radius of a node or a pair is a lower
    /// bound for all pairs below it.
    pub(super) fn finish(mut self, hierarchy: &Hierarchy, node_radii: &[f64]) -> PairTree {
        if self.is_empty() {
            return PairTree::default();
        }
        self.bvtt.push_down(hierarchy, node_radii);
        lay_out(&self.bvtt, hierarchy, self.complete_below, self.budget)
    }
}

/// Returns the indices of the open pairs that may collide below a limit.
fn open_pairs(bvtt: &Bvtt, indices: Range<usize>, limit: f64) -> Vec<u32> {
    indices.filter(|index| bvtt.pairs[*index].is_open_below(limit)).map(|index| index as u32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CertifyOptions;
    use crate::certificates::build::executor::ThreadExecutor;
    use crate::certificates::test_models::ring;

    /// However small the budget is, the tree has all pairs below its limit, and no more than the budget allows.
    #[test]
    fn the_limit_falls_with_the_budget() {
        let mut lowered = 0;
        for case in 0..3 {
            let model = ring(300, 3, 1.3 + f64::from(case));
            let preparation = Preparation::new(&model, &CertifyOptions::default(), &()).unwrap();
            let hierarchy = &preparation.hierarchy;
            let most = hierarchy.order().len();
            for budget in [1, 2, 7, 40, most / 8, most / 2, most] {
                let mut executor = ThreadExecutor { preparation: &preparation, progress: &() };
                let mut builder = PairTreeBuilder::build(&preparation, most, &mut executor).unwrap();
                builder.budget = budget;
                let (complete_below, pairs) = (builder.complete_below, builder.bvtt.pairs.clone());
                let tree = builder.finish(hierarchy, &vec![0.0; hierarchy.nodes().len()]);
                assert!(tree.len() <= budget && tree.limit() <= complete_below);
                let below = pairs.iter().filter(|pair| f64::from(pair.lower) < tree.limit()).count();
                assert_eq!(tree.len(), below, "case {case}, budget {budget}");
                lowered += usize::from(!tree.is_empty() && tree.limit() < complete_below);
            }
        }
        assert!(lowered >= 6, "{lowered}");
    }

    #[test]
    fn refused_rounds_change_nothing_and_a_full_budget_is_used() {
        let model = ring(300, 3, 1.3);
        let preparation = Preparation::new(&model, &CertifyOptions::default(), &()).unwrap();
        let hierarchy = &preparation.hierarchy;
        let mut executor = ThreadExecutor { preparation: &preparation, progress: &() };
        let new = || PairTreeBuilder { bvtt: Bvtt::new(hierarchy), complete_below: 0.0, budget: 0 };
        let limit = 0.5 * preparation.global_radius;
        let round = |max_pairs| Round { limit, is_outer: false, max_pairs };
        let mut whole = new();
        assert!(whole.run_round(hierarchy, round(usize::MAX), &mut executor).unwrap());
        let before = new().bvtt.pairs;
        let added = whole.bvtt.pairs.len() - before.len();
        assert!(added > 20, "{added}");
        // With one pair too many the last stage is refused, with all the first.
        for less in [1, 2, added / 8, added / 4, added / 2, added] {
            let mut builder = new();
            let max_pairs = before.len() + added - less;
            assert!(!builder.run_round(hierarchy, round(max_pairs), &mut executor).unwrap(), "{less}");
            assert!(builder.bvtt.pairs == before, "{less}");
        }
        let count = whole.bvtt.pairs.iter().filter(|pair| f64::from(pair.lower) < limit).count();
        (whole.complete_below, whole.budget) = (limit, count);
        let tree = whole.finish(hierarchy, &vec![0.0; hierarchy.nodes().len()]);
        assert_eq!((tree.len(), tree.limit()), (count, limit));
    }
}
