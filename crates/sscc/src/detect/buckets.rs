//! The lowest levels of the hierarchy, made for comparing boxes: clusters of up to eight blocks of up to eight
//! triangles.

use std::ops::Range;

use glam::DVec3;

use crate::TriMesh;
use crate::detect::adjacency::Never;
use crate::detect::packet::LANES;
use crate::filter::PairFilter;
use crate::geometry::Aabb;
use crate::hierarchy::{BUCKET_TRIANGLES, Hierarchy};

/// Nodes of at most this many triangles that are in no other such node are clusters.
pub(crate) const CLUSTER: usize = BUCKET_TRIANGLES;

const _: () = assert!(BUCKET_TRIANGLES == LANES * LANES);

/// What never changes with q about the clusters of a hierarchy.
///
/// A cluster's triangles are not split as the hierarchy does it: its leaves hold 4 triangles on average, less
/// than one comparison takes. Blocks are cut full. On the spring at rest 5,516 pairs of nodes are opened instead of
/// 37,695.
#[derive(Default)]
pub(crate) struct Clusters {
    /// For each node the cluster that it is, or lies in.
    of_node: Vec<Option<u32>>,
    /// For each cluster its node.
    nodes: Vec<u32>,
    /// For each cluster its first block, and the end.
    blocks: Vec<u32>,
    /// For each block the place of its first triangle, and the end.
    places: Vec<u32>,
    /// The triangle at each place, and its vertices, by their places in [`Vertices`](crate::detect::vertices::Vertices).
    triangles: Vec<u32>,
    corners: Vec<[u32; 3]>,
    /// For each cluster where its vertices begin, and the end.
    vertex_starts: Vec<u32>,
    vertices: Vec<u32>,
    /// The pairs of triangles that never count.
    pub(crate) never: Never,
}

impl Clusters {
    pub(crate) fn new(mesh: &TriMesh, hierarchy: &Hierarchy, filter: &PairFilter) -> Self {
        let (faces, p) = (mesh.faces(), mesh.rest_positions());
        let centroid = |t: u32| {
            let [a, b, c] = faces[t as usize].map(|v| p[v as usize] / 3.0);
            a + b + c
        };
        let mut of_node = vec![None; hierarchy.nodes().len()];
        let (mut nodes, mut blocks, mut places, mut triangles) = (vec![], vec![0], vec![0], vec![]);
        let (mut vertex_starts, mut vertices) = (vec![0], vec![]);
        for (n, node) in hierarchy.nodes().iter().enumerate() {
            if of_node[n].is_none() && node.triangle_count as usize <= CLUSTER {
                of_node[n] = Some(nodes.len() as u32);
                nodes.push(n as u32);
                let mut own = hierarchy.triangles(node).to_vec();
                cut(&mut own, &centroid);
                places.extend(
                    (1..=own.len().div_ceil(LANES))
                        .map(|b| triangles.len() as u32 + (b * LANES).min(own.len()) as u32),
                );
                blocks.push(places.len() as u32 - 1);
                triangles.extend(own);
                vertices.extend(hierarchy.vertices(node, faces));
                vertex_starts.push(vertices.len() as u32);
            }
            // Parents come before their children.
            node.children().for_each(|child| of_node[child as usize] = of_node[n]);
        }
        let corners: Vec<[u32; 3]> = triangles.iter().map(|&t| faces[t as usize]).collect();
        let never = Never::new(&places, &triangles, filter);
        Self { of_node, nodes, blocks, places, triangles, corners, vertex_starts, vertices, never }
    }

    /// The cluster that a node is, or lies in; none for a larger node.
    #[inline]
    pub(crate) fn of_node(&self, node: u32) -> Option<u32> {
        self.of_node[node as usize]
    }

    /// How many nodes the hierarchy has.
    pub(crate) fn node_count(&self) -> usize {
        self.of_node.len()
    }

    /// The node of a cluster.
    pub(crate) fn node(&self, cluster: u32) -> u32 {
        self.nodes[cluster as usize]
    }

    /// How many clusters there are.
    pub(crate) fn count(&self) -> usize {
        self.nodes.len()
    }

    /// The blocks of a cluster.
    #[inline]
    pub(crate) fn blocks(&self, cluster: u32) -> Range<usize> {
        self.blocks[cluster as usize] as usize..self.blocks[cluster as usize + 1] as usize
    }

    /// How many blocks there are.
    pub(crate) fn block_count(&self) -> usize {
        self.places.len().saturating_sub(1)
    }

    /// The places of a block's triangles.
    #[inline]
    pub(crate) fn places(&self, block: usize) -> Range<usize> {
        self.places[block] as usize..self.places[block + 1] as usize
    }

    /// The triangle at a place.
    #[inline]
    pub(crate) fn triangle(&self, place: usize) -> u32 {
        self.triangles[place]
    }

    /// The vertices of the triangles at some places.
    #[inline]
    pub(crate) fn corners(&self) -> &[[u32; 3]] {
        &self.corners
    }

    /// The vertices of all clusters, one after the other.
    pub(crate) fn all_vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// Gives each vertex another number.
    pub(crate) fn renumber(&mut self, new: impl Fn(u32) -> u32) {
        self.vertices.iter_mut().chain(self.corners.as_flattened_mut()).for_each(|v| *v = new(*v));
    }

    /// The vertices of a cluster, each once.
    pub(crate) fn vertices(&self, cluster: u32) -> &[u32] {
        let [start, end] = [0, 1].map(|i| self.vertex_starts[cluster as usize + i] as usize);
        &self.vertices[start..end]
    }
}

/// Sorts triangles so that each eight in a row are close together: halves along the longest axis, in whole blocks.
fn cut(triangles: &mut [u32], centroid: &impl Fn(u32) -> DVec3) {
    let blocks = triangles.len().div_ceil(LANES);
    if blocks < 2 {
        return;
    }
    let Aabb { lower, upper } = Aabb::of_points(triangles.iter().map(|&t| centroid(t)));
    let axis = (upper * 0.5 - lower * 0.5).max_position();
    triangles.sort_unstable_by(|&a, &b| centroid(a)[axis].total_cmp(&centroid(b)[axis]).then(a.cmp(&b)));
    let (left, right) = triangles.split_at_mut(blocks / 2 * LANES);
    cut(left, centroid);
    cut(right, centroid);
}
