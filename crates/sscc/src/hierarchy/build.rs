//! The construction of the hierarchy, top down by k-means (paper, section 3).

use super::cluster_features::cluster_features;
use super::hierarchy::Hierarchy;
use super::k_means::cluster;
use super::node::Node;
use crate::{Metric, ReducedModel};

/// Nodes of at most this many triangles are leaves (docs/notes/broad-phase.md#hierarchy).
const LEAF_TRIANGLES: usize = 8;

impl Hierarchy {
    /// Clusters the triangles of a model, with modes scaled by `metric`. The same input results in the same hierarchy
    /// on every machine.
    pub fn build(model: &ReducedModel, metric: &Metric) -> Self {
        let features = cluster_features(model, metric);
        let mut order: Vec<u32> = (0..features.len() as u32).collect();
        let mut nodes = vec![Node::leaf(0, order.len() as u32)];
        let mut next = 0;
        while next < nodes.len() {
            let Node { first_triangle, triangle_count, .. } = nodes[next];
            if triangle_count as usize > LEAF_TRIANGLES {
                let triangles = &mut order[first_triangle as usize..][..triangle_count as usize];
                let sizes = cluster(&features, triangles);
                nodes[next].first_child = nodes.len() as u32;
                nodes[next].child_count = sizes.len() as u32;
                let mut first = first_triangle;
                for size in sizes {
                    nodes.push(Node::leaf(first, size));
                    first += size;
                }
            }
            next += 1;
        }
        Self { nodes, order }
    }
}
