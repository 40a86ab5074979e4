//! Which pairs of nodes the certified pair tree holds, and their radii.
//!
//! The tree is grown from the pairs of the children of all nodes that are not small, in rounds of ever higher limits: a
//! pair whose lower bound is below the limit is split, two small nodes get a radius, searched without subdivision. What
//! each pair becomes depends on the model alone, so that any number of threads gives the same tree. The budget ends it:
//! then the limit is what the pairs stored are complete for.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::certificates::build::search::Search;
use crate::certificates::build::task::{KnownPair, Solver};
use crate::certificates::pair_tree::{Entry, MOST_ENTRIES, PairTree, roots_of, round_down};
use crate::hierarchy::Hierarchy;
use crate::{Error, Progress};

/// The first limit is this share of the global radius.
const FIRST: f64 = 1.0 / 16.0;

/// Where not even the first limit fits, the next is this many times less, ...
const STEP_DOWN: f64 = 2.0;

/// ... and this share of the global radius the last one tried.
const LAST: f64 = FIRST / 32.0;

/// The next limit is at most this many times the one before: farther away it is not known how the number of pairs
/// grows. Each round bounds most pairs of large nodes again: with steps of 2 certificates took 1.1 times as long.
const LARGEST_STEP: f64 = 4.0;

/// And at least this many times, else the budget is left as it is.
const SMALLEST_STEP: f64 = 1.2;

/// Two small nodes are bounded up to this many times the limit, so that most need not be looked at again in the next
/// round.
const AHEAD: f64 = 2.0;

/// Pairs in the making, for each that the budget allows: most turn out not to be needed. Tests are to run out of room.
const SLACK: usize = if cfg!(test) { 1 } else { 32 };

/// Pairs that one task bounds at the most; what it leaves open is another's, so that threads finish together. Small
/// models, as in tests, have few.
const PORTION: usize = if cfg!(test) { 3 } else { 256 };

/// Between two looks at whether the caller has cancelled; searches look for themselves.
const STEPS: usize = 64;

/// A pair of nodes in the making.
#[derive(Clone, Copy)]
pub(in crate::certificates) struct Grown {
    pub(in crate::certificates) pair: (u32, u32),
    /// Where the pairs that it is split into start, side by side, behind it; or one of the two below.
    pub(in crate::certificates) first: u32,
    /// A lower bound of its radius, at least its parent's.
    pub(in crate::certificates) lower: f32,
}

/// Not split yet; of two small nodes: not bounded, except that they are free up to the lower bound.
pub(in crate::certificates) const OPEN: u32 = 0;
/// Two small nodes whose radius is known.
pub(in crate::certificates) const BOUNDED: u32 = u32::MAX;

impl Grown {
    pub(in crate::certificates) fn new(pair: (u32, u32), lower: f32) -> Self {
        Self { pair, first: OPEN, lower }
    }

    fn is_split(&self) -> bool {
        self.first != OPEN && self.first != BOUNDED
    }
}

/// What is asked of the open pairs of a round.
#[derive(Clone, Copy)]
pub(in crate::certificates) struct Round {
    /// Pairs whose lower bound is below this are split.
    pub(in crate::certificates) limit: f64,
    /// The global radius: more is not asked for.
    pub(in crate::certificates) most: f64,
    /// How many pairs there may be more.
    pub(in crate::certificates) room: usize,
}

/// A pair anew, and behind it pairs below it that are split off, numbered in this list. `used` counts these in all lists
/// of the stage. The list is left unfinished once there is no room for them, and after a [`PORTION`]: what is not bounded
/// yet stays open, with a lower bound below the limit.
pub(in crate::certificates) fn expand(
    pair: Grown,
    Round { limit, most, room }: Round,
    hierarchy: &Hierarchy,
    search: &mut Search<'_>,
    used: &AtomicUsize,
    progress: &dyn Progress,
) -> Vec<Grown> {
    let mut list = vec![pair];
    let mut next = 0;
    while next < list.len().min(PORTION) && used.load(Ordering::Relaxed) <= room {
        if next.is_multiple_of(STEPS) && progress.is_cancelled() {
            break;
        }
        let (n, m) = list[next].pair;
        match hierarchy.split_above_buckets(n, m) {
            None => {
                let cap = (AHEAD * limit).min(most);
                let lower = search.roughly(n, m, cap);
                list[next].first = if lower < cap || cap == most { BOUNDED } else { OPEN };
                list[next].lower = list[next].lower.max(round_down(lower));
            }
            Some(split) => {
                let lower = list[next].lower.max(round_down(search.bound(n, m, limit)));
                list[next].lower = lower;
                if f64::from(lower) < limit {
                    list[next].first = list.len() as u32;
                    used.fetch_add(split.children().len(), Ordering::Relaxed);
                    list.extend(split.pairs().map(|pair| Grown::new(pair, lower)));
                }
            }
        }
        next += 1;
    }
    list
}

/// Pairs of nodes, each with a lower bound of its radius.
pub(in crate::certificates) struct Frontier {
    /// The smallest radius of those that are bounded, at most the cap.
    pub(in crate::certificates) radius: f64,
    /// Of these only the lower bound is known.
    pub(in crate::certificates) open: Vec<KnownPair>,
    /// Pairs of small nodes whose radius is known, with a larger relative error.
    pub(in crate::certificates) bounded: Vec<KnownPair>,
}

/// Lower bounds of pairs of nodes: of all that may be below a limit.
pub(in crate::certificates) struct Grove {
    grown: Vec<Grown>,
    /// For each node where its pairs of children start, all of them; none within small nodes.
    roots: Vec<u32>,
    /// Radii below this are known.
    reached: f64,
    budget: usize,
}

impl Grove {
    /// Grows the pairs for a tree of at most `budget` entries.
    pub(in crate::certificates) fn grow(
        hierarchy: &Hierarchy,
        global_radius: f64,
        budget: usize,
        solver: &mut dyn Solver,
    ) -> Result<Self, Error> {
        let budget = budget.min(MOST_ENTRIES);
        let mut grove = Self { grown: Vec::new(), roots: Vec::new(), reached: 0.0, budget };
        let mut limit = f64::from(round_down(global_radius * FIRST));
        // Out of the range of single precision there is no tree.
        if budget == 0 || limit <= 0.0 || global_radius > f64::from(f32::MAX) {
            return Ok(grove);
        }
        for n in 0..hierarchy.nodes().len() as u32 {
            grove.roots.push(grove.grown.len() as u32);
            grove.grown.extend(roots_of(hierarchy, n).map(|pair| Grown::new(pair, 0.0)));
        }
        // Places are 32 bits.
        let room = budget.saturating_mul(SLACK).max(2 * grove.grown.len()).min(1 << 31);
        // Beyond this there are too many.
        let mut beyond = f64::INFINITY;
        loop {
            if grove.round(hierarchy, limit, global_radius, room, solver)? {
                grove.reached = limit;
            } else {
                beyond = limit;
            }
            let (next, least) = match grove.next_limit(global_radius) {
                _ if grove.reached == 0.0 => (limit / STEP_DOWN, global_radius * LAST),
                None => break,
                Some(next) => {
                    // Half way, in logarithms, to what had too many.
                    let half_way = f64::from(round_down((grove.reached * beyond).sqrt()));
                    let next = if next < beyond { next } else { half_way };
                    (next, (grove.reached * SMALLEST_STEP).min(global_radius))
                }
            };
            if next < least {
                break;
            }
            limit = next;
        }
        Ok(grove)
    }

    /// Splits and bounds every pair below the limit. False, and nothing changed, where there would be more than `room`.
    fn round(
        &mut self,
        hierarchy: &Hierarchy,
        limit: f64,
        most: f64,
        room: usize,
        solver: &mut dyn Solver,
    ) -> Result<bool, Error> {
        let grown = &mut self.grown;
        let is_open = |pair: &Grown| pair.first == OPEN && f64::from(pair.lower) < limit;
        let (count, mut replaced) = (grown.len(), Vec::new());
        let mut open: Vec<u32> = (0..grown.len() as u32).filter(|at| is_open(&grown[*at as usize])).collect();
        while !open.is_empty() {
            let pairs: Vec<Grown> = open.iter().map(|at| grown[*at as usize]).collect();
            let round = Round { limit, most, room: room.saturating_sub(grown.len()) };
            let Some(lists) = solver.grow(&pairs, round)? else {
                grown.truncate(count);
                replaced.into_iter().for_each(|(at, pair): (u32, Grown)| grown[at as usize] = pair);
                return Ok(false);
            };
            replaced.extend(open.iter().copied().zip(pairs).filter(|(at, _)| (*at as usize) < count));
            let before = grown.len() as u32;
            for (at, list) in open.into_iter().zip(lists) {
                // The pair itself stays where it is, the others follow.
                let offset = grown.len() as u32 - 1;
                let mut moved = list.into_iter().map(|pair| {
                    let first = if pair.is_split() { pair.first + offset } else { pair.first };
                    Grown { first, ..pair }
                });
                if let Some(pair) = moved.next() {
                    grown[at as usize] = pair;
                }
                grown.extend(moved);
            }
            open = (before..grown.len() as u32).filter(|at| is_open(&grown[*at as usize])).collect();
        }
        let is_large = |pair: &Grown| hierarchy.split_above_buckets(pair.pair.0, pair.pair.1).is_some();
        if grown.iter().any(|pair| is_open(pair) && is_large(pair)) {
            return Err(Error::Certificates("a pair of nodes was left open".to_owned()));
        }
        // A pair that is split has the least radius of its children.
        for at in (0..grown.len()).rev() {
            if grown[at].is_split() {
                let children = &grown[children(hierarchy, &grown[at])];
                grown[at].lower = children.iter().map(|pair| pair.lower).fold(f32::INFINITY, f32::min);
            }
        }
        Ok(true)
    }

    /// A limit for the next round with which the budget should just be used up; none where that is so already.
    fn next_limit(&self, global_radius: f64) -> Option<f64> {
        let below = |limit: f64| self.grown.iter().filter(|p| f64::from(p.lower) < limit).count() as f64;
        let (stored, before) = (below(self.reached), below(self.reached / 2.0));
        let room = self.budget as f64 / stored.max(1.0);
        if self.reached >= global_radius || room < 1.1 {
            return None;
        }
        // As if the number of pairs grew as a power of the limit.
        let power = (stored.max(1.0) / before.max(1.0)).log2().max(1.0);
        let step = (1.1 * room).powf(1.0 / power).min(LARGEST_STEP);
        let next = f64::from(round_down(self.reached * step)).min(global_radius);
        (next > self.reached).then_some(next)
    }

    /// Whether no limit was reached, so that no radius is known.
    pub(in crate::certificates) fn is_empty(&self) -> bool {
        self.reached == 0.0
    }

    /// What is known of some pairs of a node's children (`which`: their places among these): pairs of nodes that make
    /// them up, as far as they may be below `cap`. None within small nodes, and where nothing was grown.
    pub(in crate::certificates) fn frontier(
        &self,
        hierarchy: &Hierarchy,
        node: u32,
        which: std::ops::Range<usize>,
        cap: f64,
    ) -> Option<Frontier> {
        let first = *self.roots.get(node as usize)? as usize;
        let mut frontier = Frontier { radius: cap, open: Vec::new(), bounded: Vec::new() };
        let mut stack: Vec<usize> = (first + which.start..first + which.end).collect();
        while let Some(at) = stack.pop() {
            let pair = &self.grown[at];
            let lower = f64::from(pair.lower);
            if lower >= cap {
            } else if pair.is_split() {
                stack.extend(children(hierarchy, pair));
            } else if pair.first == BOUNDED {
                frontier.radius = frontier.radius.min(lower);
                frontier.bounded.push((pair.pair, lower));
            } else {
                frontier.open.push((pair.pair, lower));
            }
        }
        Some(frontier)
    }

    /// The tree of all pairs below a limit, which is lowered until they fit the budget.
    pub(in crate::certificates) fn harvest(mut self, hierarchy: &Hierarchy, node_radii: &[f64]) -> PairTree {
        if self.reached == 0.0 {
            return PairTree::default();
        }
        // What is known of a node or a pair as a whole holds for all pairs below it.
        for n in 0..hierarchy.nodes().len() {
            let first = self.roots[n] as usize;
            let radius = round_down(node_radii[n]);
            for pair in &mut self.grown[first..first + roots_of(hierarchy, n as u32).count()] {
                pair.lower = pair.lower.max(radius);
            }
        }
        for at in 0..self.grown.len() {
            let pair = self.grown[at];
            if pair.is_split() {
                for child in &mut self.grown[children(hierarchy, &pair)] {
                    child.lower = child.lower.max(pair.lower);
                }
            }
        }
        let mut limit = self.reached;
        let below = |pair: &Grown, limit: f64| f64::from(pair.lower) < limit;
        let mut radii: Vec<f32> = self.grown.iter().filter(|p| below(p, limit)).map(|p| p.lower).collect();
        if radii.len() > self.budget {
            let (_, cut, _) = radii.select_nth_unstable_by(self.budget, f32::total_cmp);
            limit = f64::from(*cut);
        }
        if limit <= 0.0 {
            return PairTree::default();
        }
        // Lists of siblings, breadth first.
        let mut lists: Vec<std::ops::Range<usize>> = Vec::new();
        let mut starts = Vec::with_capacity(hierarchy.nodes().len());
        let mut total = 0;
        let mut add = |lists: &mut Vec<_>, list: std::ops::Range<usize>| {
            let stored = self.grown[list.clone()].iter().filter(|p| below(p, limit)).count();
            let start = total;
            if stored > 0 {
                total += stored;
                lists.push(list);
            }
            (start, stored)
        };
        for n in 0..hierarchy.nodes().len() {
            let first = self.roots[n] as usize;
            let (start, stored) = add(&mut lists, first..first + roots_of(hierarchy, n as u32).count());
            starts.push(if stored > 0 { start as u32 } else { u32::MAX });
        }
        let mut entries: Vec<Entry> = Vec::with_capacity(radii.len().min(self.budget));
        let mut next = 0;
        while next < lists.len() {
            let list = lists[next].clone();
            let last = list.clone().rev().find(|at| below(&self.grown[*at], limit));
            for at in list.clone().filter(|at| below(&self.grown[*at], limit)) {
                let pair = &self.grown[at];
                let start = if pair.is_split() { add(&mut lists, children(hierarchy, pair)).0 } else { 0 };
                entries.push(Entry::new(pair.lower, start, at - list.start, Some(at) == last));
            }
            next += 1;
        }
        PairTree::new(limit, starts, entries)
    }
}

/// The places of the pairs that a pair is split into.
fn children(hierarchy: &Hierarchy, pair: &Grown) -> std::ops::Range<usize> {
    let count =
        hierarchy.split_above_buckets(pair.pair.0, pair.pair.1).map_or(0, |split| split.children().len());
    pair.first as usize..pair.first as usize + count
}

#[cfg(test)]
pub(in crate::certificates) mod tests;
