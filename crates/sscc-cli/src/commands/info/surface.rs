//! Counts, topology and size of a triangle mesh.

use glam::DVec3;
use serde::Serialize;
use sscc::TriMesh;
use sscc::parts::weld_classes_of_positions;

use crate::output::{counted, grouped, length};

#[derive(Serialize)]
pub struct Surface {
    triangles: usize,
    vertices: usize,
    used_vertices: usize,
    #[serde(flatten)]
    topology: Topology,
    /// The mesh with one vertex for all at the same position; absent if all used vertices are at different positions.
    #[serde(skip_serializing_if = "Option::is_none")]
    welded: Option<Welded>,
    /// Whether the format splits vertices, so that only the welded mesh has a meaningful topology.
    #[serde(skip)]
    is_split: bool,
    lower: [f64; 3],
    upper: [f64; 3],
}

/// A mesh whose vertices of equal position are one. Triangles that this flattens to segments and points have no edges.
#[derive(Serialize)]
struct Welded {
    vertices: usize,
    #[serde(flatten)]
    topology: Topology,
}

#[derive(Serialize)]
struct Topology {
    /// Edges of one triangle only: none in a closed mesh.
    boundary_edges: usize,
    /// Edges of more than two triangles.
    non_manifold_edges: usize,
}

impl Surface {
    pub fn of(mesh: &TriMesh) -> Self {
        let used = mesh.used_vertices();
        let points = || used.iter().map(|v| mesh.rest_positions()[*v as usize]);
        Self {
            triangles: mesh.faces().len(),
            vertices: mesh.rest_positions().len(),
            used_vertices: used.len(),
            topology: Topology::of(mesh.faces().iter().copied()),
            welded: Welded::of(mesh),
            is_split: mesh.has_split_vertices(),
            lower: points().reduce(DVec3::min).unwrap_or_default().to_array(),
            upper: points().reduce(DVec3::max).unwrap_or_default().to_array(),
        }
    }

    /// Returns the counts of triangles and vertices, and the topology, as text.
    pub fn form(&self) -> String {
        let [vertices, used] = [self.vertices, self.used_vertices].map(|n| grouped(n as u64));
        let counts =
            format!("{}, {vertices} vertices ({used} used)", counted(self.triangles as u64, "triangle"));
        let form = self.topology.form();
        match &self.welded {
            None => format!("{counts}, {form}"),
            Some(welded) if self.is_split => format!("{counts}, {}", welded.form()),
            Some(welded) => format!("{counts}, {form}; {}", welded.form()),
        }
    }

    pub fn lines(&self) -> Vec<String> {
        vec![
            format!("mesh           {}", self.form()),
            format!("box            {}", size(&self.lower, &self.upper)),
        ]
    }
}

impl Welded {
    fn of(mesh: &TriMesh) -> Option<Self> {
        let classes = weld_classes_of_positions(mesh.rest_positions());
        let used = mesh.used_vertices();
        let mut vertices: Vec<u32> = used.iter().map(|vertex| classes[*vertex as usize]).collect();
        vertices.sort_unstable();
        vertices.dedup();
        let faces = mesh.faces().iter().map(|face| face.map(|vertex| classes[vertex as usize]));
        let is_proper = |&[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
        (vertices.len() < used.len())
            .then(|| Self { vertices: vertices.len(), topology: Topology::of(faces.filter(is_proper)) })
    }

    fn form(&self) -> String {
        let vertices = grouped(self.vertices as u64);
        format!("with equal corners welded {vertices} vertices, {}", self.topology.form())
    }
}

impl Topology {
    fn of(faces: impl Iterator<Item = [u32; 3]>) -> Self {
        let mut edges: Vec<[u32; 2]> =
            faces.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]).map(|[a, b]| [a.min(b), a.max(b)]).collect();
        edges.sort_unstable();
        let triangles_at = || edges.chunk_by(|a, b| a == b).map(<[_]>::len);
        Self {
            boundary_edges: triangles_at().filter(|n| *n == 1).count(),
            non_manifold_edges: triangles_at().filter(|n| *n > 2).count(),
        }
    }

    fn form(&self) -> String {
        let open = match self.boundary_edges {
            0 => "closed".to_owned(),
            n => format!("open ({})", counted(n as u64, "boundary edge")),
        };
        let manifold = match self.non_manifold_edges {
            0 => "manifold".to_owned(),
            n => format!("{} of more than two triangles", counted(n as u64, "edge")),
        };
        format!("{open}, {manifold}")
    }
}

/// Returns the side lengths of an AABB as text.
pub fn size(lower: &[f64; 3], upper: &[f64; 3]) -> String {
    let sides: Vec<String> = lower.iter().zip(upper).map(|(l, u)| length(u - l)).collect();
    sides.join(" x ")
}
