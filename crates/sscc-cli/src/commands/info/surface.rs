//! Counts, topology and size of a triangle mesh.

use glam::DVec3;
use serde::Serialize;
use sscc::TriMesh;

use crate::output::{grouped, length};

#[derive(Serialize)]
pub struct Surface {
    triangles: usize,
    vertices: usize,
    used_vertices: usize,
    /// Edges of one triangle only: none in a closed mesh.
    boundary_edges: usize,
    /// Edges of more than two triangles.
    non_manifold_edges: usize,
    lower: [f64; 3],
    upper: [f64; 3],
}

impl Surface {
    pub fn of(mesh: &TriMesh) -> Self {
        let used = mesh.used_vertices();
        let points = || used.iter().map(|v| mesh.rest_positions()[*v as usize]);
        let mut edges: Vec<[u32; 2]> = mesh
            .faces()
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        edges.sort_unstable();
        let triangles_at = || edges.chunk_by(|a, b| a == b).map(<[_]>::len);
        Self {
            triangles: mesh.faces().len(),
            vertices: mesh.rest_positions().len(),
            used_vertices: used.len(),
            boundary_edges: triangles_at().filter(|n| *n == 1).count(),
            non_manifold_edges: triangles_at().filter(|n| *n > 2).count(),
            lower: points().reduce(DVec3::min).unwrap_or_default().to_array(),
            upper: points().reduce(DVec3::max).unwrap_or_default().to_array(),
        }
    }

    /// The counts of triangles and vertices, and the topology, as text.
    pub fn form(&self) -> String {
        let [triangles, vertices, used] =
            [self.triangles, self.vertices, self.used_vertices].map(|n| grouped(n as u64));
        let form = match (self.boundary_edges, self.non_manifold_edges) {
            (0, 0) => "closed, manifold".to_owned(),
            (0, n) => format!("closed, {n} edges of more than two triangles"),
            (b, 0) => format!("open ({b} boundary edges), manifold"),
            (b, n) => format!("open ({b} boundary edges), {n} edges of more than two triangles"),
        };
        format!("{triangles} triangles, {vertices} vertices ({used} used), {form}")
    }

    pub fn lines(&self) -> Vec<String> {
        vec![
            format!("mesh           {}", self.form()),
            format!("box            {}", size(&self.lower, &self.upper)),
        ]
    }
}

/// The side lengths of an AABB as text.
pub fn size(lower: &[f64; 3], upper: &[f64; 3]) -> String {
    let sides: Vec<String> = lower.iter().zip(upper).map(|(l, u)| length(u - l)).collect();
    sides.join(" x ")
}
