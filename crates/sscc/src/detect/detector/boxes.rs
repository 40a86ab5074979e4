//! A mesh at given positions, with boxes in double precision.

use glam::DVec3;

use crate::detect::context::Context;
use crate::geometry::Aabb;

/// A mesh at given positions, with the boxes of all nodes.
pub(super) struct Boxes<'x> {
    pub context: &'x Context,
    positions: &'x [DVec3],
    pub of_nodes: Vec<Aabb>,
}

impl<'x> Boxes<'x> {
    pub fn new(context: &'x Context, positions: &'x [DVec3]) -> Self {
        let (hierarchy, faces) = (&context.hierarchy, context.filter.faces());
        let mut of_nodes = vec![Aabb::EMPTY; hierarchy.nodes().len()];
        // Children have higher numbers.
        for (n, node) in hierarchy.nodes().iter().enumerate().rev() {
            of_nodes[n] = if node.is_leaf() {
                let corners = hierarchy.triangles(node).iter().flat_map(|t| faces[*t as usize]);
                Aabb::of_points(corners.map(|v| positions[v as usize]))
            } else {
                node.children().fold(Aabb::EMPTY, |all, child| all.union(&of_nodes[child as usize]))
            };
        }
        Self { context, positions, of_nodes }
    }

    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.context.filter.faces()[triangle as usize].map(|v| self.positions[v as usize])
    }

    /// Returns the children of a node, or the node itself if it is a leaf.
    pub fn parts(&self, n: u32) -> std::ops::Range<u32> {
        let node = &self.context.hierarchy.nodes()[n as usize];
        if node.is_leaf() { n..n + 1 } else { node.children() }
    }

    pub fn triangles(&self, n: u32) -> &[u32] {
        let hierarchy = &self.context.hierarchy;
        hierarchy.triangles(&hierarchy.nodes()[n as usize])
    }

    pub fn is_leaf(&self, n: u32) -> bool {
        self.context.hierarchy.nodes()[n as usize].is_leaf()
    }
}
