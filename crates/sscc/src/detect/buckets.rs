//! Buckets: the largest nodes of at most 64 triangles, at which traversals end. Each is cut into up to eight packets of up
//! to eight triangles.

use std::ops::Range;
use std::sync::OnceLock;

use glam::DVec3;

use super::aabb8::LANES;
use super::adjacency_masks::AdjacencyMasks;
use crate::filter::PairFilter;
use crate::geometry::Aabb;
use crate::hierarchy::{BUCKET_TRIANGLES, Hierarchy, Node, PACKET_TRIANGLES};

const _: () = assert!(PACKET_TRIANGLES == LANES && BUCKET_TRIANGLES == LANES * LANES);

/// The data of the buckets of a hierarchy that do not depend on q.
///
/// A bucket is cut into full packets, not into the leaves of the hierarchy, which fill only half of a packet
/// (docs/notes/broad-phase.md#packets).
#[derive(Default)]
pub(crate) struct Buckets {
    /// For each node the bucket that it is, or that contains it.
    of_node: Vec<Option<u32>>,
    /// For each bucket its node.
    nodes: Vec<u32>,
    /// For each bucket its first packet, then the end.
    packets: Vec<u32>,
    /// For each packet its first slot, then the end.
    slots: Vec<u32>,
    /// The triangle in each slot.
    triangles: Vec<u32>,
    /// For each slot the vertices of its triangle, by their indices in the [`VertexStore`](super::vertex_store::VertexStore).
    corners: Vec<[u32; 3]>,
    /// For each slot the vertex classes of its triangle.
    classes: Vec<[u32; 3]>,
    /// For each bucket its first vertex, then the end.
    vertex_starts: Vec<u32>,
    /// The vertices of all buckets, bucket after bucket.
    vertices: Vec<u32>,
    /// The triangle pairs that never count, once they have been computed.
    adjacency: OnceLock<AdjacencyMasks>,
}

impl Buckets {
    /// Cuts the nodes into buckets and packets. `order`: the triangles in the order of the hierarchy, those of each bucket
    /// packet by packet. `vertex_count`: the number of vertices of the mesh.
    pub(crate) fn new(
        order: &[u32],
        hierarchy: &Hierarchy,
        filter: &PairFilter,
        vertex_count: usize,
    ) -> Self {
        let faces = filter.faces();
        let mut last_bucket = vec![u32::MAX; vertex_count];
        let mut of_node = vec![None; hierarchy.nodes().len()];
        let (mut nodes, mut packets, mut slots) = (vec![], vec![0], vec![0]);
        let mut triangles = Vec::with_capacity(order.len());
        let (mut vertex_starts, mut vertices) = (vec![0], vec![]);
        for (n, node) in hierarchy.nodes().iter().enumerate() {
            if of_node[n].is_none() && node.triangle_count as usize <= BUCKET_TRIANGLES {
                of_node[n] = Some(nodes.len() as u32);
                nodes.push(n as u32);
                let own = &order[node.first_triangle as usize..][..node.triangle_count as usize];
                slots.extend(
                    (1..=own.len().div_ceil(LANES))
                        .map(|b| triangles.len() as u32 + (b * LANES).min(own.len()) as u32),
                );
                packets.push(slots.len() as u32 - 1);
                let first_vertex = vertices.len();
                for &t in own {
                    triangles.push(t);
                    for v in faces[t as usize] {
                        if std::mem::replace(&mut last_bucket[v as usize], nodes.len() as u32)
                            != nodes.len() as u32
                        {
                            vertices.push(v);
                        }
                    }
                }
                vertices[first_vertex..].sort_unstable();
                vertex_starts.push(vertices.len() as u32);
            }
            // Parents come before their children.
            node.children().for_each(|child| of_node[child as usize] = of_node[n]);
        }
        let corners: Vec<[u32; 3]> = triangles.iter().map(|&t| faces[t as usize]).collect();
        let classes = triangles.iter().map(|&t| filter.vertex_classes(t)).collect();
        let adjacency = OnceLock::new();
        Self {
            of_node,
            nodes,
            packets,
            slots,
            triangles,
            corners,
            classes,
            vertex_starts,
            vertices,
            adjacency,
        }
    }

    /// Computes the masks of adjacent triangles, unless they have been computed. This takes as long as four searches, and saves
    /// nearly half the time of each later one (docs/notes/queries.md#one-shot-detector).
    pub(crate) fn mask_adjacent(&self, filter: &PairFilter) {
        let masks = || AdjacencyMasks::new(&self.packets, &self.slots, &self.triangles, filter);
        self.adjacency.get_or_init(masks);
    }

    /// Whether triangles of two buckets, the first before the second, may share a vertex class. True if masks have not been
    /// computed.
    #[inline]
    pub(crate) fn can_share_vertex(&self, first: u32, second: u32) -> bool {
        self.adjacency.get().is_none_or(|masks| masks.can_share_vertex(first, second))
    }

    /// Returns the pairs of two packets that need no test, see [`AdjacencyMasks::masked_pairs`], and whether they include the
    /// pairs of adjacent triangles.
    #[inline]
    pub(crate) fn masked_pairs(&self, first: usize, second: usize) -> (u64, bool) {
        match self.adjacency.get() {
            Some(masks) => (masks.masked_pairs(first, second), true),
            None => (AdjacencyMasks::masked_without(first, second), false),
        }
    }

    /// Whether the triangles in two slots share a vertex class.
    #[inline]
    pub(crate) fn has_shared_vertex(&self, slots: [usize; 2]) -> bool {
        let ([a, b, c], other) = (self.classes[slots[0]], self.classes[slots[1]]);
        // The fold has no branches, because most triangles whose boxes overlap share a vertex, but not always by the
        // same corners.
        other.into_iter().fold(false, |shared, x| shared | (x == a) | (x == b) | (x == c))
    }

    /// Returns the bucket that a node is, or that contains it; `None` for a larger node.
    #[inline]
    pub(crate) fn of_node(&self, node: u32) -> Option<u32> {
        self.of_node[node as usize]
    }

    /// Returns the number of nodes of the hierarchy.
    pub(crate) fn node_count(&self) -> usize {
        self.of_node.len()
    }

    /// Returns the end of the indices of nodes that traversals visit: buckets and larger nodes.
    pub(crate) fn visited_node_count(&self) -> usize {
        let is_visited = |n: u32| self.of_node(n).is_none_or(|bucket| self.node(bucket) == n);
        (0..self.of_node.len() as u32).rev().find(|n| is_visited(*n)).map_or(0, |last| last as usize + 1)
    }

    /// Returns the node of a bucket.
    pub(crate) fn node(&self, bucket: u32) -> u32 {
        self.nodes[bucket as usize]
    }

    /// Returns the node of each bucket.
    pub(crate) fn nodes(&self) -> impl Iterator<Item = u32> {
        self.nodes.iter().copied()
    }

    /// Returns the number of buckets.
    pub(crate) fn count(&self) -> usize {
        self.nodes.len()
    }

    /// Returns the packets of a bucket.
    #[inline]
    pub(crate) fn packets(&self, bucket: u32) -> Range<usize> {
        self.packets[bucket as usize] as usize..self.packets[bucket as usize + 1] as usize
    }

    /// Returns the number of packets.
    pub(crate) fn packet_count(&self) -> usize {
        self.slots.len().saturating_sub(1)
    }

    /// Returns the slots of a packet.
    #[inline]
    pub(crate) fn slots(&self, packet: usize) -> Range<usize> {
        self.slots[packet] as usize..self.slots[packet + 1] as usize
    }

    /// Returns the triangle in a slot.
    #[inline]
    pub(crate) fn triangle(&self, slot: usize) -> u32 {
        self.triangles[slot]
    }

    /// Returns for each slot the vertices of its triangle.
    #[inline]
    pub(crate) fn corners(&self) -> &[[u32; 3]] {
        &self.corners
    }

    /// Returns the vertices of all buckets, bucket after bucket.
    pub(crate) fn all_vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// Replaces the index of each vertex.
    pub(crate) fn renumber(&mut self, new: impl Fn(u32) -> u32) {
        self.vertices.iter_mut().chain(self.corners.as_flattened_mut()).for_each(|v| *v = new(*v));
    }

    /// Returns the vertices of a bucket, each once.
    pub(crate) fn vertices(&self, bucket: u32) -> &[u32] {
        let [start, end] = [0, 1].map(|i| self.vertex_starts[bucket as usize + i] as usize);
        &self.vertices[start..end]
    }
}

/// Returns the triangles in the order of the hierarchy, those of each bucket packet by packet. `positions`: those of all vertices
/// at some configuration.
pub(crate) fn packet_order(positions: &[DVec3], hierarchy: &Hierarchy, faces: &[[u32; 3]]) -> Vec<u32> {
    let centroid = |t: u32| {
        let [a, b, c] = faces[t as usize].map(|v| positions[v as usize] / 3.0);
        (a + b + c, t)
    };
    let mut order = hierarchy.order().to_vec();
    let nodes = hierarchy.nodes();
    let mut largest = vec![0];
    while let Some(n) = largest.pop() {
        let node: &Node = &nodes[n as usize];
        if node.triangle_count as usize > BUCKET_TRIANGLES {
            largest.extend(node.children());
            continue;
        }
        let own = &mut order[node.first_triangle as usize..][..node.triangle_count as usize];
        let mut triangles: Vec<(DVec3, u32)> = own.iter().map(|&t| centroid(t)).collect();
        cut(&mut triangles);
        own.iter_mut().zip(triangles).for_each(|(slot, (_, t))| *slot = t);
    }
    order
}

/// Sorts triangles so that each eight consecutive ones are close together, by halves along the longest axis, in whole packets.
fn cut(triangles: &mut [(DVec3, u32)]) {
    let packets = triangles.len().div_ceil(LANES);
    if packets < 2 {
        return;
    }
    let Aabb { lower, upper } = Aabb::of_points(triangles.iter().map(|(centroid, _)| *centroid));
    let axis = (upper * 0.5 - lower * 0.5).max_position();
    triangles.sort_unstable_by(|(x, a), (y, b)| x[axis].total_cmp(&y[axis]).then(a.cmp(b)));
    let (left, right) = triangles.split_at_mut(packets / 2 * LANES);
    cut(left);
    cut(right);
}
