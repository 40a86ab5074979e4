//! A node of the hierarchy: a range of triangles and a range of children.

use std::ops::Range;

use super::node_pair::NodePair;

/// Children of an inner node: between 2 and this many.
pub(crate) const BRANCHING: usize = 4;

/// A bucket is a node of at most this many triangles that lies within no other such node. Traversals end at buckets.
pub(crate) const BUCKET_TRIANGLES: usize = 64;

/// A packet is a part of a bucket of at most this many triangles, whose AABBs are compared together.
pub(crate) const PACKET_TRIANGLES: usize = 8;

/// A node of the [`Hierarchy`](super::Hierarchy).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Node {
    /// First of its triangles, as an index into [`Hierarchy::order`](super::Hierarchy::order).
    pub first_triangle: u32,
    /// Number of its triangles.
    pub triangle_count: u32,
    /// Index of its first child; the others follow it. 0 for a leaf.
    pub first_child: u32,
    /// Number of children: 0 for a leaf, else 2 to 4.
    pub child_count: u32,
}

impl Node {
    /// A leaf of the triangles `first .. first + count` of [`Hierarchy::order`](super::Hierarchy::order).
    pub(super) fn leaf(first_triangle: u32, triangle_count: u32) -> Self {
        Self { first_triangle, triangle_count, first_child: 0, child_count: 0 }
    }

    /// Whether the node has no children.
    pub fn is_leaf(&self) -> bool {
        self.child_count == 0
    }

    /// Indices of its children.
    pub fn children(&self) -> Range<u32> {
        self.first_child..self.first_child + self.child_count
    }

    /// All pairs of its children, in the order (0, 1), (0, 2), ..., (2, 3).
    pub(crate) fn child_pairs(&self) -> impl Iterator<Item = NodePair> + use<> {
        let children = self.children();
        children.clone().flat_map(move |n| (n + 1..children.end).map(move |m| (n, m)))
    }

    /// Whether the node has at most 64 triangles: it is a bucket or lies within one.
    pub fn fits_in_bucket(&self) -> bool {
        self.triangle_count as usize <= BUCKET_TRIANGLES
    }
}
