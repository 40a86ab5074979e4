//! The BVTT under construction: node pairs with lower bounds of their radii, from which the pair tree is made.
//!
//! It starts with the pairs of children of every node above the buckets. [`Hierarchy::split_above_buckets`] alone
//! decides how a pair is split, so a pair stores only the index of its first child pair; the others follow it.

use std::ops::Range;

use crate::certificates::pair_tree::sibling_pairs;
use crate::hierarchy::{Hierarchy, NodePair};
use crate::model::rounding::to_f32_down;

/// A node pair in 16 bytes, because a large model has millions of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BvttPair {
    pub(crate) nodes: NodePair,
    /// A lower bound of its radius, at least its parent's.
    pub(crate) lower: f32,
    /// [`OPEN`], [`BOUNDED`], or the index of its first child pair.
    link: u32,
}

const OPEN: u32 = 0;
const BOUNDED: u32 = u32::MAX;

/// The state of a node pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PairState {
    /// Not split; only the lower bound is known.
    Open,
    /// A pair of buckets that needs no further task: its lower bound was searched, or comes from the two nodes alone, which only
    /// the outer round allows.
    Bounded,
    /// Split into pairs, with the index of the first of them.
    Split(u32),
}

impl BvttPair {
    pub(crate) fn open(nodes: NodePair, lower: f32) -> Self {
        Self { nodes, lower, link: OPEN }
    }

    pub(crate) fn state(&self) -> PairState {
        match self.link {
            OPEN => PairState::Open,
            BOUNDED => PairState::Bounded,
            first => PairState::Split(first),
        }
    }

    pub(crate) fn set_state(&mut self, state: PairState) {
        self.link = match state {
            PairState::Open => OPEN,
            PairState::Bounded => BOUNDED,
            PairState::Split(first) => first,
        };
    }

    /// Whether the pair is open and may collide below a limit.
    pub(crate) fn is_open_below(&self, limit: f64) -> bool {
        self.link == OPEN && f64::from(self.lower) < limit
    }
}

/// All node pairs so far; parents come before their children.
pub(super) struct Bvtt {
    pub(super) pairs: Vec<BvttPair>,
    /// For each node the index of its first pair of children, and one end index.
    starts: Vec<u32>,
}

impl Bvtt {
    /// Creates an empty BVTT, without any known lower bound.
    pub(super) fn empty() -> Self {
        Self { pairs: Vec::new(), starts: Vec::new() }
    }

    /// Creates a BVTT of the pairs of children of each node, all open.
    pub(super) fn new(hierarchy: &Hierarchy) -> Self {
        let mut bvtt = Self { pairs: Vec::new(), starts: vec![0] };
        for n in 0..hierarchy.nodes().len() as u32 {
            bvtt.pairs.extend(sibling_pairs(hierarchy, n).map(|nodes| BvttPair::open(nodes, 0.0)));
            bvtt.starts.push(bvtt.pairs.len() as u32);
        }
        bvtt
    }

    /// Returns the indices of the pairs of a node's children. None if the BVTT is empty.
    pub(super) fn of_node(&self, n: usize) -> Option<Range<usize>> {
        Some(*self.starts.get(n)? as usize..*self.starts.get(n + 1)? as usize)
    }

    /// Returns the indices of the pairs that a pair is split into.
    pub(super) fn children(&self, hierarchy: &Hierarchy, pair: &BvttPair) -> Range<usize> {
        let PairState::Split(first) = pair.state() else { return 0..0 };
        let (n, m) = pair.nodes;
        let count = hierarchy.split_above_buckets(n, m).map_or(0, |split| split.children().len());
        first as usize..first as usize + count
    }

    /// Replaces an open pair by a subtree. The root takes its index; the other pairs are appended.
    pub(super) fn replace(&mut self, index: u32, subtree: Vec<BvttPair>) {
        // The root keeps the index of the pair; the others, numbered from 1 in the subtree, follow all pairs.
        let offset = self.pairs.len() as u32 - 1;
        let mut moved = subtree.into_iter().map(|mut pair| {
            if let PairState::Split(first) = pair.state() {
                pair.set_state(PairState::Split(first + offset));
            }
            pair
        });
        if let Some(pair) = moved.next() {
            self.pairs[index as usize] = pair;
        }
        self.pairs.extend(moved);
    }

    /// Gives each pair that is split the smallest lower bound of its children.
    pub(super) fn pull_up(&mut self, hierarchy: &Hierarchy) {
        for index in (0..self.pairs.len()).rev() {
            let pair = self.pairs[index];
            if let PairState::Split(_) = pair.state() {
                let children = &self.pairs[self.children(hierarchy, &pair)];
                let count = with_mutant!(children.len(), ParentOfFirstChild, 1);
                self.pairs[index].lower =
                    children[..count].iter().map(|child| child.lower).fold(f32::INFINITY, f32::min);
            }
        }
    }

    /// Gives each pair at least the radius of the node that contains it, and at least the lower bound of its parent.
    pub(super) fn push_down(&mut self, hierarchy: &Hierarchy, node_radii: &[f64]) {
        for (n, radius) in node_radii.iter().enumerate() {
            let radius = to_f32_down(*radius);
            let indices = self.of_node(n).unwrap_or_default();
            for pair in &mut self.pairs[indices] {
                pair.lower = pair.lower.max(radius);
            }
        }
        for index in 0..self.pairs.len() {
            let parent = self.pairs[index];
            let children = self.children(hierarchy, &parent);
            for child in &mut self.pairs[children] {
                child.lower = child.lower.max(parent.lower);
            }
        }
    }
}
