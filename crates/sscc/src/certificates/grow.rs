//! Which pairs of nodes the certified pair tree holds, and their radii.
//!
//! The tree is grown from the pairs of all nodes' children, in rounds of ever higher limits: a pair whose lower bound is
//! below the limit is split, two leaves get the smallest radius of their triangles' pairs. What each pair becomes
//! depends on the model alone, so that any number of threads gives the same tree. The budget ends it: then the limit is what
//! the pairs stored are complete for.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::child_pairs;
use super::pair_tree::{Entry, MOST_ENTRIES, PairTree};
use super::search::Search;
use crate::hierarchy::Hierarchy;
use crate::{Error, Progress};

/// The first limit is this share of the global radius; each is twice the one before.
const FIRST: f64 = 1.0 / 32.0;

/// Pairs in the making, for each that the budget allows: not all of them turn out to be needed.
const SLACK: usize = 4;

/// Where a pair in the making is from.
#[derive(Clone, Copy)]
enum Parent {
    /// Two children of one node.
    Node,
    /// A pair that was split.
    Pair(u32),
}

/// A pair of nodes in the making.
#[derive(Clone, Copy)]
struct Grown {
    pair: (u32, u32),
    parent: Parent,
    which: u8,
    /// A lower bound of its radius; where it is below the limit, of leaves the radius itself.
    lower: f64,
    /// Whether its children are known, or the radius of two leaves.
    done: bool,
}

/// The tree, and the radius of each pair of children of each node where that is below the tree's limit: exact, not rounded.
pub(super) struct Grove {
    pub(super) tree: PairTree,
    /// For each node: `(place among its pairs of children, radius)`.
    pub(super) radii: Vec<Vec<(usize, f64)>>,
}

/// Grows the tree of at most `budget` pairs. `search` makes one searcher for each thread.
pub(super) fn grow<'a>(
    hierarchy: &Hierarchy,
    global_radius: f64,
    budget: usize,
    search: impl Fn() -> Search<'a> + Sync,
    progress: &dyn Progress,
) -> Result<Grove, Error> {
    let budget = budget.min(MOST_ENTRIES);
    let none = Grove { tree: PairTree::default(), radii: vec![Vec::new(); hierarchy.nodes().len()] };
    if budget == 0 || !global_radius.is_finite() {
        return Ok(none);
    }
    let mut grown: Vec<Grown> = Vec::new();
    for node in hierarchy.nodes().iter().filter(|node| !node.is_leaf()) {
        grown.extend(child_pairs(node).enumerate().map(|(which, pair)| Grown {
            pair,
            parent: Parent::Node,
            which: which as u8,
            lower: 0.0,
            done: false,
        }));
    }
    let roots = grown.len();
    let (mut limit, mut reached) = (global_radius * FIRST, 0.0);
    loop {
        let room = budget.saturating_mul(SLACK).max(roots).saturating_sub(grown.len());
        if !round(hierarchy, &mut grown, limit, room, &search, progress)? {
            break;
        }
        reached = limit;
        let stored = grown.iter().filter(|pair| pair.lower < reached).count();
        if reached >= global_radius || stored > budget {
            break;
        }
        limit = (2.0 * limit).min(global_radius);
    }
    if reached == 0.0 {
        return Ok(none);
    }
    Ok(harvest(hierarchy, grown, reached, budget))
}

/// Splits and bounds every pair below the limit. False, and nothing changed, where that takes more room.
fn round<'a>(
    hierarchy: &Hierarchy,
    grown: &mut Vec<Grown>,
    limit: f64,
    room: usize,
    search: &(impl Fn() -> Search<'a> + Sync),
    progress: &dyn Progress,
) -> Result<bool, Error> {
    let open: Vec<u32> = (0..grown.len() as u32)
        .filter(|at| !grown[*at as usize].done && grown[*at as usize].lower < limit)
        .collect();
    let used = AtomicUsize::new(0);
    // Each gives its pair anew, and all pairs below it; parents are places in this list.
    let below: Vec<Vec<Grown>> = open
        .par_iter()
        .map_init(search, |search, at| {
            let mut list = vec![grown[*at as usize]];
            let mut next = 0;
            while next < list.len() && !progress.is_cancelled() {
                let Grown { pair: (n, m), lower, .. } = list[next];
                let split = hierarchy.split(n, m);
                let lower = match split {
                    Some(_) => search.bound(n, m, limit).max(lower),
                    None => search.between([(n, m)], limit).max(lower),
                };
                list[next].lower = lower;
                list[next].done = lower < limit;
                if let (Some(split), true) = (split, lower < limit) {
                    if used.fetch_add(split.children().len(), Ordering::Relaxed) > room {
                        break;
                    }
                    list.extend(split.pairs().enumerate().map(|(which, pair)| Grown {
                        pair,
                        parent: Parent::Pair(next as u32),
                        which: which as u8,
                        lower,
                        done: false,
                    }));
                }
                next += 1;
            }
            list
        })
        .collect();
    if progress.is_cancelled() {
        return Err(Error::Cancelled);
    }
    if used.into_inner() > room {
        return Ok(false);
    }
    for (at, list) in open.into_iter().zip(below) {
        // The pair itself stays where it is, the others follow.
        let offset = grown.len() as u32;
        let place = |local: u32| if local == 0 { at } else { offset + local - 1 };
        let mut list = list.into_iter();
        if let Some(first) = list.next() {
            grown[at as usize] = Grown { parent: grown[at as usize].parent, ..first };
        }
        grown.extend(list.map(|pair| match pair.parent {
            Parent::Pair(local) => Grown { parent: Parent::Pair(place(local)), ..pair },
            Parent::Node => pair,
        }));
    }
    Ok(true)
}

/// The tree of all pairs below a limit, which is lowered until they fit the budget.
fn harvest(hierarchy: &Hierarchy, mut grown: Vec<Grown>, reached: f64, budget: usize) -> Grove {
    // Parents come before their children: a pair that was split has the least radius of its children.
    let mut least = vec![f64::INFINITY; grown.len()];
    for at in (0..grown.len()).rev() {
        let split = hierarchy.split(grown[at].pair.0, grown[at].pair.1).is_some();
        if grown[at].done && split {
            grown[at].lower = grown[at].lower.max(least[at]);
        }
        if let Parent::Pair(parent) = grown[at].parent {
            least[parent as usize] = least[parent as usize].min(grown[at].lower);
        }
    }
    let mut limit = reached;
    let mut below: Vec<f64> = grown.iter().map(|pair| pair.lower).filter(|r| *r < limit).collect();
    if below.len() > budget {
        let (_, cut, _) = below.select_nth_unstable_by(budget, f64::total_cmp);
        limit = *cut;
    }
    let stored = |pair: &Grown| pair.lower < limit;
    let mut children: Vec<Vec<u32>> = vec![Vec::new(); grown.len()];
    let mut radii = vec![Vec::new(); hierarchy.nodes().len()];
    let mut starts = vec![u32::MAX; hierarchy.nodes().len()];
    // Lists of siblings, breadth first.
    let mut lists: Vec<Vec<u32>> = Vec::new();
    let mut at = 0;
    let mut total = 0;
    for (n, node) in hierarchy.nodes().iter().enumerate().filter(|(_, node)| !node.is_leaf()) {
        let count = child_pairs(node).count();
        let list: Vec<u32> = (at..at + count as u32).filter(|i| stored(&grown[*i as usize])).collect();
        at += count as u32;
        radii[n] = list.iter().map(|i| &grown[*i as usize]).map(|p| (p.which as usize, p.lower)).collect();
        if !list.is_empty() {
            starts[n] = total;
            total += list.len() as u32;
            lists.push(list);
        }
    }
    for (i, pair) in grown.iter().enumerate().filter(|(_, pair)| stored(pair)) {
        if let Parent::Pair(parent) = pair.parent {
            children[parent as usize].push(i as u32);
        }
    }
    let mut entries = Vec::with_capacity(below.len().min(budget));
    let mut next = 0;
    while next < lists.len() {
        let list = std::mem::take(&mut lists[next]);
        next += 1;
        for (k, i) in list.iter().enumerate() {
            let pair = &grown[*i as usize];
            let below = std::mem::take(&mut children[*i as usize]);
            let start = if below.is_empty() { 0 } else { total };
            entries.push(Entry::new(pair.lower, start as usize, pair.which as usize, k + 1 == list.len()));
            if !below.is_empty() {
                total += below.len() as u32;
                lists.push(below);
            }
        }
    }
    if limit <= 0.0 {
        return Grove { tree: PairTree::default(), radii: vec![Vec::new(); hierarchy.nodes().len()] };
    }
    Grove { tree: PairTree::new(limit, starts, entries), radii }
}
