//! The BVH: nodes level by level, their triangles, and the splits of node pairs.

use std::ops::Range;

use super::node::{BUCKET_TRIANGLES, Node};
use super::split::Split;

/// A tree over all triangles: each node's triangles are the disjoint union of its children's. Nodes are
/// stored level by level, the root first, siblings side by side.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hierarchy {
    pub(super) nodes: Vec<Node>,
    pub(super) order: Vec<u32>,
}

impl Hierarchy {
    /// Returns the nodes, level by level, the root first.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Returns all triangles, sorted so that the triangles of each node are contiguous.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// Returns the triangles of a node.
    pub fn triangles(&self, node: &Node) -> &[u32] {
        &self.order[node.first_triangle as usize..][..node.triangle_count as usize]
    }

    /// Returns the vertices of a node's triangles, ascending, each once.
    pub(crate) fn vertices(&self, node: &Node, faces: &[[u32; 3]]) -> Vec<u32> {
        let mut vertices: Vec<u32> = self.triangles(node).iter().flat_map(|&a| faces[a as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices
    }

    /// Returns the range of node indices of each level, beginning with the root.
    pub fn levels(&self) -> Vec<Range<usize>> {
        let mut levels = Vec::new();
        let mut level = 0..1;
        while !level.is_empty() {
            let below: u32 = self.nodes[level.clone()].iter().map(|node| node.child_count).sum();
            levels.push(level.clone());
            level = level.end..level.end + below as usize;
        }
        levels
    }

    /// Whether a node other than the root is a bucket or lies within one. Pairs within it have no certificates; pairs
    /// of the root's children always have certificates.
    pub(crate) fn is_bucket_below_root(&self, n: u32) -> bool {
        n != 0 && self.nodes[n as usize].fits_in_bucket()
    }

    /// Returns for each node whether it lies below a bucket that is not the root.
    pub(crate) fn nodes_within_buckets(&self) -> Vec<bool> {
        let mut within = vec![false; self.nodes.len()];
        let buckets = (0..within.len()).filter(|n| self.is_bucket_below_root(*n as u32));
        for node in buckets.map(|n| &self.nodes[n]) {
            node.children().for_each(|child| within[child as usize] = true);
        }
        within
    }

    /// Splits a node pair: the node with more triangles (the first if equal) is replaced by its children, or the other
    /// node if that is a leaf. `None` if both are leaves.
    #[inline]
    pub(crate) fn split(&self, n: u32, m: u32) -> Option<Split> {
        let (node_n, node_m) = (self.nodes[n as usize], self.nodes[m as usize]);
        if node_n.is_leaf() && node_m.is_leaf() {
            None
        } else if node_m.is_leaf() || (!node_n.is_leaf() && node_n.triangle_count >= node_m.triangle_count) {
            Some(Split::First { node: node_n, m })
        } else {
            Some(Split::Second { n, node: node_m })
        }
    }

    /// Splits a node pair as [`Self::split`], but only down to buckets, as the pair tree does: `None` if both nodes are buckets.
    #[inline]
    pub(crate) fn split_above_buckets(&self, n: u32, m: u32) -> Option<Split> {
        let count = |n: u32| self.nodes[n as usize].triangle_count as usize;
        if count(n).max(count(m)) <= BUCKET_TRIANGLES { None } else { self.split(n, m) }
    }
}
