//! Surface of a lattice: closed, oriented outward, free of self-collisions.

use std::collections::HashMap;

use glam::DVec3;
use sscc::parts::Scope;
use sscc::{ContactFilter, Method, Modes, Neighbours, Progress, Query, ReducedModel, TriMesh};

use crate::ModesError;

/// Closed surface, oriented outward, and its measures.
pub(super) struct Surface {
    /// Faces of the mesh in its order, all reversed if the mesh is oriented inward.
    pub faces: Vec<[u32; 3]>,
    /// Next face at each edge of each face (from corner k to k + 1). The faces at an edge form a ring, nearly always of
    /// two.
    pub across: Vec<[u32; 3]>,
    /// Whether the surface is closed only with vertices of equal position welded; files may split them along seams.
    pub is_split: bool,
    /// Middle of the bounding box (model unit), without unused vertices.
    pub middle: DVec3,
    /// Sides of the bounding box (model unit).
    pub extent: DVec3,
    /// Volume, as a share of the cube of the longest side.
    pub volume: f64,
    /// Area, as a share of the square of the longest side.
    pub area: f64,
    /// Sum of the sides of the bounding boxes of all triangles, as a share of the longest side.
    pub triangle_extents: f64,
    /// Sum of the areas of the projections of all triangles along the three axes, as a share of the square of the
    /// longest side.
    pub triangle_projections: f64,
}

impl Surface {
    /// Checks and measures the surface of a mesh.
    ///
    /// # Errors
    /// When the surface is open, not consistently oriented, or without volume.
    pub fn new(mesh: &TriMesh) -> Result<Self, ModesError> {
        let (across, is_split) = match pair_edges(mesh.faces()) {
            Ok(across) => (across, false),
            Err(open) => (pair_edges(&welded(mesh)).map_err(|_| open)?, true),
        };
        let p = mesh.rest_positions();
        let used = || mesh.faces().iter().flatten().map(|v| p[*v as usize]);
        let low = used().fold(DVec3::INFINITY, DVec3::min);
        let extent = used().fold(DVec3::NEG_INFINITY, DVec3::max) - low;
        let (middle, longest) = (low + 0.5 * extent, extent.max_element());
        // All in the unit of the longest side.
        let (mut volume, mut area) = (0.0, 0.0);
        let (mut triangle_extents, mut triangle_projections) = (0.0, 0.0);
        for face in mesh.faces() {
            let [a, b, c] = face.map(|v| (p[v as usize] - middle) / longest);
            let normal = (b - a).cross(c - a);
            volume += a.dot(b.cross(c)) / 6.0;
            area += normal.length() / 2.0;
            triangle_extents += (a.max(b).max(c) - a.min(b).min(c)).element_sum();
            triangle_projections += normal.abs().element_sum() / 2.0;
        }
        // Volume of a flat surface by rounding.
        let noise = f64::EPSILON * area;
        if extent.min_element() <= 0.0 || volume.is_nan() || volume.abs() <= noise {
            return Err(ModesError::NoVolume);
        }
        let mut faces = mesh.faces().to_vec();
        let mut surface_across = across;
        if volume < 0.0 {
            faces.iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
            surface_across.iter_mut().for_each(|[ab, _, ca]| std::mem::swap(ab, ca));
        }
        Ok(Self {
            faces,
            across: surface_across,
            is_split,
            middle,
            extent,
            volume: volume.abs(),
            area,
            triangle_extents,
            triangle_projections,
        })
    }
}

/// Returns the next face at each edge of each face.
fn pair_edges(faces: &[[u32; 3]]) -> Result<Vec<[u32; 3]>, ModesError> {
    let mut edges = Vec::with_capacity(3 * faces.len());
    for (number, face) in (0_u32..).zip(faces) {
        for k in 0..3 {
            let (from, to) = (face[k], face[(k + 1) % 3]);
            edges.push((from.min(to), from.max(to), number, k as u8, from < to));
        }
    }
    edges.sort_unstable();
    let mut across: Vec<[u32; 3]> = (0..faces.len() as u32).map(|f| [f; 3]).collect();
    for ring in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let (from, to, ..) = ring[0];
        let forward = ring.iter().filter(|edge| edge.4).count();
        // A face that repeats a vertex has an edge of length 0, which is closed.
        if from != to && 2 * forward != ring.len() {
            return Err(ModesError::OpenEdge { from, to, forward, backward: ring.len() - forward });
        }
        for (i, (_, _, face, k, _)) in ring.iter().enumerate() {
            across[*face as usize][*k as usize] = ring[(i + 1) % ring.len()].2;
        }
    }
    Ok(across)
}

/// Returns the faces with each vertex replaced by the first vertex of its position.
fn welded(mesh: &TriMesh) -> Vec<[u32; 3]> {
    let mut first = HashMap::new();
    let classes: Vec<u32> = (0_u32..)
        .zip(mesh.rest_positions())
        // Adding 0 maps -0 to 0.
        .map(|(v, p)| *first.entry((*p + DVec3::ZERO).to_array().map(f64::to_bits)).or_insert(v))
        .collect();
    mesh.faces().iter().map(|face| face.map(|v| classes[v as usize])).collect()
}

/// Checks that triangles without a common vertex do not collide at rest.
///
/// # Errors
/// [`ModesError::CollidesAtRest`] if two collide; when cancelled.
pub(super) fn check_rest(mesh: &TriMesh, is_split: bool, progress: &dyn Progress) -> Result<(), ModesError> {
    // A model needs a mode; any mode is valid at q = 0.
    let modes = Modes::from_matrix(mesh.rest_positions().len(), 1, |_, _| 1.0)?;
    let model = ReducedModel::new(mesh.clone(), modes)?;
    let filter = ContactFilter::new(Neighbours::Exclude).weld(is_split);
    let scope = Scope { filter, ..Scope::of(&model) };
    let mut query = Query::without_certificates(&model, scope, Method::Traditional)?;
    query = query.cancelled_by(progress.cancel_token().cloned());
    match query.first(&[0.0])? {
        Some((a, b)) => Err(ModesError::CollidesAtRest { a, b }),
        None => Ok(()),
    }
}
