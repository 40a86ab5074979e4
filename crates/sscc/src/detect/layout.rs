//! All data of searches that does not depend on q, in the order in which they read it. Searches and their clones share
//! the layout.

use super::bd_tree::BdTree;
use super::buckets::{Buckets, packet_order};
use super::coarse_vertices::CoarseVertices;
use super::node_boundaries::NodeBoundaries;
use super::quantization::Quantization;
use super::vertex_store::VertexStore;
use crate::ReducedModel;
use crate::filter::PairFilter;
use crate::hierarchy::Hierarchy;

/// The parts of a layout that only some searches need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Needs {
    /// BD-tree AABBs of all nodes down to buckets; otherwise only of the root.
    pub(crate) bd_tree: bool,
    /// Quantized vertices, unless each vertex has a list of modes; without them boxes are computed from exact positions.
    pub(crate) coarse: bool,
    /// The boundaries of nodes, for the contour test of normal cones.
    pub(crate) boundaries: bool,
}

impl Needs {
    /// The needs of searches that compute boxes when the traversal visits nodes.
    pub(crate) const LAZY: Self = Self { bd_tree: true, coarse: true, boundaries: false };

    /// The needs of searches that refit all boxes first.
    pub(crate) const REFIT: Self = Self { bd_tree: false, coarse: true, boundaries: false };

    /// The needs of searches that refit all boxes and compute normals, from exact positions.
    pub(crate) const NORMALS: Self = Self { bd_tree: false, coarse: false, boundaries: true };
}

/// Vertices, buckets, and the parts that [`Needs`] names.
#[derive(Default)]
pub(crate) struct Layout {
    pub(crate) vertices: VertexStore,
    pub(crate) quantization: Quantization,
    pub(crate) coarse: CoarseVertices,
    pub(crate) buckets: Buckets,
    pub(crate) bd_tree: BdTree,
    pub(crate) boundaries: NodeBoundaries,
}

impl Layout {
    pub(crate) fn new(
        model: &ReducedModel,
        hierarchy: &Hierarchy,
        filter: &PairFilter,
        needs: Needs,
    ) -> Self {
        let rest = model.mesh().rest_positions();
        let order = packet_order(rest, hierarchy, filter.faces());
        let mut buckets = Buckets::new(&order, hierarchy, filter, rest.len());
        buckets.mask_adjacent(filter);
        let vertices = VertexStore::new(model, buckets.all_vertices());
        buckets.renumber(|v| vertices.index_of(v));
        let is_visited = |n| buckets.of_node(n).is_none_or(|bucket| buckets.node(bucket) == n);
        let quantization = Quantization::new(model, &vertices);
        let bd_tree =
            BdTree::new(model, hierarchy, &quantization, &vertices, |n| needs.bd_tree && is_visited(n));
        let boundaries = if needs.boundaries {
            NodeBoundaries::new(model.mesh(), hierarchy, filter, &vertices, is_visited)
        } else {
            NodeBoundaries::default()
        };
        // The error of coarse positions grows with the factors of all modes. If few modes move each vertex, exact
        // positions take no longer than coarse ones.
        let coarse = if needs.coarse && !vertices.moving_modes().are_listed() {
            CoarseVertices::new(&quantization, &buckets, &vertices)
        } else {
            CoarseVertices::default()
        };
        Self { vertices, quantization, coarse, buckets, bd_tree, boundaries }
    }

    /// Returns the layout for given positions. The order of the hierarchy has the triangles of each bucket packet by packet.
    pub(crate) fn of_positions(vertex_count: usize, hierarchy: &Hierarchy, filter: &PairFilter) -> Self {
        let mut buckets = Buckets::new(hierarchy.order(), hierarchy, filter, vertex_count);
        let vertices = VertexStore::without_modes(vertex_count, buckets.all_vertices());
        buckets.renumber(|v| vertices.index_of(v));
        Self { vertices, buckets, ..Self::default() }
    }
}
