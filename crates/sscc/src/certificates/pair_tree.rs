//! The pair tree: certified radii of node pairs, stored along the BVTT.
//!
//! With radii of nodes alone, a query opens every two neighbouring siblings that are not certified together, because
//! their AABBs always overlap. The pair tree stores the radius of every node pair below a limit, so a query ends at a
//! pair whose radius it has not reached. The way in which pairs are split ([`Hierarchy::split_above_buckets`]) alone decides
//! which pairs there are, never AABBs: AABBs that are disjoint at rest may overlap later. Below the limit a pair that is not
//! stored is certified. At the limit and beyond, a missing pair proves nothing. The tree has no pairs within buckets.

use crate::hierarchy::{Hierarchy, Node, NodePair};

/// A link's flag: no sibling follows.
const LAST: u32 = 1 << 31;
/// The first bit of a link's index among the siblings.
const WHICH: u32 = 28;
/// The bits of a link that contain the start of the children.
const START: u32 = (1 << WHICH) - 1;

/// The start of the children of a node without stored pairs.
pub(crate) const NO_PAIRS: u32 = u32::MAX;

/// The maximum number of entries: links cannot address more.
pub(crate) const MAX_ENTRIES: usize = START as usize;

/// A node pair that may collide below the limit, in 8 bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PairEntry {
    /// The radius, rounded down ([`to_f32_down`](crate::model::rounding::to_f32_down)).
    pub(crate) radius: f32,
    /// Where its children start, its index among its siblings, and whether it is the last of them.
    link: u32,
}

impl PairEntry {
    pub(crate) fn new(radius: f32, start: usize, which: usize, is_last: bool) -> Self {
        let link = start as u32 | (which as u32) << WHICH | if is_last { LAST } else { 0 };
        Self { radius, link }
    }

    /// Returns where its children start; 0 if it has none, because both nodes are buckets.
    pub(crate) fn start(self) -> u32 {
        self.link & START
    }

    /// Returns its index among all siblings, stored or not: that of the child of the node that is split, or of the pair of
    /// children of one node.
    pub(crate) fn which(self) -> u32 {
        (self.link & !LAST) >> WHICH
    }

    pub(crate) fn is_last(self) -> bool {
        self.link & LAST != 0
    }
}

/// An entry and its index in the tree.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StoredPair {
    pub(crate) index: u32,
    pub(crate) entry: PairEntry,
}

/// Returns the pairs of a node's children with which the tree begins; there are none within a bucket, where traversals end.
pub(crate) fn sibling_pairs(hierarchy: &Hierarchy, n: u32) -> impl Iterator<Item = NodePair> {
    let node = (!hierarchy.is_bucket_below_root(n)).then(|| &hierarchy.nodes()[n as usize]);
    node.into_iter().flat_map(Node::child_pairs)
}

/// The node pairs that may collide below a limit, with their radii.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PairTree {
    limit: f64,
    /// For each node where its pairs of children start; [`NO_PAIRS`] if none is stored.
    starts: Vec<u32>,
    entries: Vec<PairEntry>,
}

impl PairTree {
    /// Returns the limit. Below it, a node pair that is not stored is certified, except within buckets. 0 if no tree
    /// was built.
    pub fn limit(&self) -> f64 {
        self.limit
    }

    /// Returns the number of node pairs stored.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Returns the memory of the node pairs in bytes, 8 for each, as bounded by
    /// [`CertifyOptions::budget`](crate::CertifyOptions::budget).
    pub fn bytes(&self) -> usize {
        size_of_val(self.entries.as_slice())
    }

    /// Whether no node pair is stored.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Returns for each node where its pairs of children start; `u32::MAX` if none is stored, as within buckets.
    pub fn starts(&self) -> &[u32] {
        &self.starts
    }

    /// Returns for each node pair its radius, rounded down, and its link: bits 0 to 27 are the start of its children (0 if it has
    /// none, because both nodes are buckets), bits 28 to 30 its index among the children of its parent, and bit 31 is set if no
    /// sibling follows.
    pub fn entries(&self) -> impl ExactSizeIterator<Item = (f32, u32)> {
        self.entries.iter().map(|entry| (entry.radius, entry.link))
    }

    /// Returns the entry of an index.
    pub(crate) fn entry(&self, index: usize) -> PairEntry {
        self.entries[index]
    }

    pub(crate) fn new(limit: f64, starts: Vec<u32>, entries: Vec<PairEntry>) -> Self {
        Self { limit, starts, entries }
    }

    /// Creates a tree from its parts, as read from a file: radii and links as [`PairTree::entries`] gives them. Whether they are
    /// a tree over the hierarchy is checked by [`CertificateParts`](crate::parts::CertificateParts).
    pub fn from_parts(limit: f64, starts: Vec<u32>, entries: impl IntoIterator<Item = (f32, u32)>) -> Self {
        let entries = entries.into_iter().map(|(radius, link)| PairEntry { radius, link }).collect();
        Self { limit, starts, entries }
    }

    /// Returns the stored siblings from a start on.
    #[inline]
    fn siblings(&self, start: u32) -> impl Iterator<Item = StoredPair> {
        let mut next = if start == NO_PAIRS { None } else { Some(start) };
        std::iter::from_fn(move || {
            let index = next?;
            let entry = self.entries[index as usize];
            next = if entry.is_last() { None } else { Some(index + 1) };
            Some(StoredPair { index, entry })
        })
    }

    /// Returns the stored pairs of a node's children; there are none within buckets.
    #[inline]
    pub(crate) fn of_node(&self, node: u32) -> impl Iterator<Item = StoredPair> {
        self.siblings(self.starts[node as usize])
    }

    /// Returns the stored children of a pair that has some.
    #[inline]
    pub(crate) fn below(&self, index: u32) -> impl Iterator<Item = StoredPair> {
        self.siblings(self.entries[index as usize].start())
    }
}
