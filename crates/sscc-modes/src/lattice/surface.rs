//! A surface that encloses a solid.

use glam::DVec3;
use sscc::{Method, Modes, Query, ReducedModel, Scope, TriMesh};

use crate::ModesError;

/// A closed surface, oriented outward.
pub(super) struct Surface {
    /// Rest positions (model unit).
    pub points: Vec<DVec3>,
    /// Triangles.
    pub faces: Vec<[u32; 3]>,
    /// The faces on the other side of each face's edges (from corner k to the next), with repetitions where more than
    /// two faces share an edge.
    pub neighbours: Vec<Vec<(u8, u32)>>,
    /// The enclosed volume.
    pub volume: f64,
}

impl Surface {
    /// # Errors
    /// When the surface is open, not oriented alike everywhere, encloses nothing, or meets itself.
    pub fn new(mesh: &TriMesh) -> Result<Self, ModesError> {
        let points = mesh.rest_positions().to_vec();
        let mut faces = mesh.faces().to_vec();
        // Each edge, smaller vertex first: whether it runs that way, its face, its place there.
        let mut edges: Vec<(u32, u32, bool, u32, u8)> = Vec::with_capacity(3 * faces.len());
        for (face, corners) in faces.iter().enumerate() {
            for k in 0..3 {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                edges.push((a.min(b), a.max(b), a < b, face as u32, k as u8));
            }
        }
        edges.sort_unstable();
        let mut neighbours = vec![Vec::new(); faces.len()];
        for edge in edges.chunk_by(|x, y| (x.0, x.1) == (y.0, y.1)) {
            let forward = edge.iter().filter(|e| e.2).count();
            let (a, b) = (edge[0].0, edge[0].1);
            match edge.len() {
                _ if 2 * forward == edge.len() => {}
                1 => return Err(ModesError::OpenSurface { edge: [a, b] }),
                _ => return Err(ModesError::EdgeOrientation { edge: [a, b] }),
            }
            for (_, _, _, face, k) in edge {
                let others = edge.iter().filter(|e| e.3 != *face);
                neighbours[*face as usize].extend(others.map(|e| (*k, e.3)));
            }
        }
        let near = faces.first().map_or(DVec3::ZERO, |f| points[f[0] as usize]);
        let volume = |faces: &[[u32; 3]]| -> f64 {
            faces.iter().map(|f| f.map(|v| points[v as usize] - near)).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
        };
        let mut enclosed = volume(&faces);
        if enclosed < 0.0 {
            // Edge k of the turned face is edge 2 - k of the old one.
            faces.iter_mut().for_each(|f| f.swap(1, 2));
            neighbours.iter_mut().flatten().for_each(|(k, _)| *k = 2 - *k);
            enclosed = -enclosed;
        }
        if enclosed.is_nan() || enclosed <= 0.0 {
            return Err(ModesError::NoVolume);
        }
        refuse_collisions(mesh)?;
        Ok(Self { points, faces, neighbours, volume: enclosed })
    }

    /// The corners of a face.
    pub fn corners(&self, face: u32) -> [DVec3; 3] {
        self.faces[face as usize].map(|v| self.points[v as usize])
    }
}

/// # Errors
/// When two triangles without a common vertex meet at rest.
fn refuse_collisions(mesh: &TriMesh) -> Result<(), ModesError> {
    let still = Modes::new(1, vec![DVec3::ZERO; mesh.rest_positions().len()])?;
    let model = ReducedModel::new(mesh.clone(), still)?;
    let mut query = Query::without_certificates(&model, Scope::of(&model), Method::Traditional)?;
    match query.first(&[0.0])? {
        Some((a, b)) => Err(ModesError::SelfIntersecting { faces: [a, b] }),
        None => Ok(()),
    }
}
