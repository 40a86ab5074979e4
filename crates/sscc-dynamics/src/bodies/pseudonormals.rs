//! Pseudonormals of a surface, which give the sign of a distance (Baerentzen and Aanaes 2005).

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;
use sscc::TriMesh;

use crate::nearest_point::Feature;

/// Pseudonormals of faces, edges and vertices. The pseudonormal of an edge is the sum over its faces; that of a vertex is the
/// sum over its faces weighted by angle.
pub(crate) struct Pseudonormals {
    faces: Vec<DVec3>,
    /// Welded vertices of each face.
    classes: Vec<[u32; 3]>,
    edges: BTreeMap<(u32, u32), DVec3>,
    vertices: Vec<DVec3>,
    /// Whether an even number of faces meets at each edge. Otherwise the surface has no inside.
    pub is_closed: bool,
}

impl Pseudonormals {
    /// Computes the pseudonormals of a mesh. Vertices of equal position are welded.
    pub fn new(mesh: &TriMesh) -> Self {
        let p = mesh.rest_positions();
        let mut order: Vec<u32> = (0..p.len() as u32).collect();
        let key = |v: u32| p[v as usize].to_array().map(|x| x + 0.0);
        let compare = |a: &u32, b: &u32| {
            let (x, y) = (key(*a), key(*b));
            (0..3).map(|n| x[n].total_cmp(&y[n])).find(|o| o.is_ne()).unwrap_or(a.cmp(b))
        };
        order.sort_unstable_by(compare);
        let mut class: Vec<u32> = (0..p.len() as u32).collect();
        for pair in order.windows(2) {
            if key(pair[0]) == key(pair[1]) {
                class[pair[1] as usize] = class[pair[0] as usize];
            }
        }
        let classes: Vec<[u32; 3]> =
            mesh.faces().iter().map(|face| face.map(|v| class[v as usize])).collect();
        let mut faces = Vec::with_capacity(classes.len());
        let (mut edges, mut vertices) = (BTreeMap::new(), vec![DVec3::ZERO; p.len()]);
        let mut odd_edges = BTreeSet::new();
        for face in &classes {
            let x = face.map(|v| p[v as usize]);
            let normal = (x[1] - x[0]).cross(x[2] - x[0]).normalize_or_zero();
            for n in 0..3 {
                let [a, b, c] = [x[n], x[(n + 1) % 3], x[(n + 2) % 3]];
                let [u, v] = [b - a, c - a];
                vertices[face[n] as usize] += normal * libm::atan2(u.cross(v).length(), u.dot(v));
                let edge = edge(face[n], face[(n + 1) % 3]);
                *edges.entry(edge).or_insert(DVec3::ZERO) += normal;
                if !odd_edges.remove(&edge) {
                    odd_edges.insert(edge);
                }
            }
            faces.push(normal);
        }
        Self { faces, classes, edges, vertices, is_closed: odd_edges.is_empty() }
    }

    /// Returns the pseudonormal (not normalized) of a feature of a triangle.
    pub fn of(&self, triangle: u32, feature: Feature) -> DVec3 {
        let face = self.classes[triangle as usize];
        match feature {
            Feature::Face => self.faces[triangle as usize],
            Feature::Edge(n) => self.edges[&edge(face[n], face[(n + 1) % 3])],
            Feature::Vertex(n) => self.vertices[face[n] as usize],
        }
    }
}

/// Returns the key of an edge: its vertices, ascending.
fn edge(a: u32, b: u32) -> (u32, u32) {
    (a.min(b), a.max(b))
}
