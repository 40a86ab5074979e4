//! A node of the hierarchy: a range of triangles and a range of children.

use std::ops::Range;

use super::node_pair::NodePair;

/// The largest number of children of an inner node, which has at least 2.
pub(crate) const BRANCHING: usize = 4;

/// A bucket is a node of at most this many triangles that lies within no other such node. Traversals end at buckets.
pub(crate) const BUCKET_TRIANGLES: usize = 64;

/// A packet is a part of a bucket of at most this many triangles, whose AABBs are compared together.
pub(crate) const PACKET_TRIANGLES: usize = 8;

/// A node of the [`Hierarchy`](super::Hierarchy).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Node {
    /// The first triangle of the node, as an index into [`Hierarchy::order`](super::Hierarchy::order).
    pub first_triangle: u32,
    /// The number of triangles of the node.
    pub triangle_count: u32,
    /// The index of the first child; the others follow it. 0 for a leaf.
    pub first_child: u32,
    /// The number of children: 0 for a leaf, otherwise 2 to 4.
    pub child_count: u32,
}

impl Node {
    /// Creates a leaf with the triangles `first .. first + count` of [`Hierarchy::order`](super::Hierarchy::order).
    pub(super) fn leaf(first_triangle: u32, triangle_count: u32) -> Self {
        Self { first_triangle, triangle_count, first_child: 0, child_count: 0 }
    }

    /// Whether the node has no children.
    pub fn is_leaf(&self) -> bool {
        self.child_count == 0
    }

    /// Returns the indices of the node's children.
    pub fn children(&self) -> Range<u32> {
        self.first_child..self.first_child + self.child_count
    }

    /// Returns all pairs of the node's children, in the order (0, 1), (0, 2), ..., (2, 3).
    pub(crate) fn child_pairs(&self) -> impl Iterator<Item = NodePair> + use<> {
        let children = self.children();
        children.clone().flat_map(move |n| (n + 1..children.end).map(move |m| (n, m)))
    }

    /// Whether the node has at most 64 triangles: it is a bucket or lies within one.
    pub fn fits_in_bucket(&self) -> bool {
        self.triangle_count as usize <= BUCKET_TRIANGLES
    }
}
