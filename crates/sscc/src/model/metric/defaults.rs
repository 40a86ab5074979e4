//! Metrics that follow from mesh and modes alone: displacement and mass (paper, section 6).

use glam::DVec3;

use super::kind::MetricKind;
use super::metric::Metric;
use crate::{Error, Modes, TriMesh};

impl Metric {
    /// Returns the displacement metric: it scales each mode by its largest displacement of a vertex that some face uses. A
    /// mode that moves no such vertex has the smallest scale of the others, or 1.
    ///
    /// # Errors
    /// When the modes are for another number of vertices.
    pub fn displacement(mesh: &TriMesh, modes: &Modes) -> Result<Self, Error> {
        modes.check_mesh(mesh)?;
        let mut scales = vec![0.0_f64; modes.rank()];
        for i in mesh.used_vertices() {
            for (scale, u) in scales.iter_mut().zip(modes.of_vertex(i)) {
                *scale = scale.max(length(*u));
            }
        }
        Ok(Self::diagonal(MetricKind::Displacement, fill_zeros(scales)))
    }

    /// Returns the mass metric: it scales each mode by the surface that it moves, `sqrt(sum_i area_i |U_i|^2)`, with
    /// [`vertex_areas`]. A mode that moves no surface has the smallest scale of the others, or 1.
    ///
    /// # Errors
    /// When the modes are for another number of vertices.
    pub fn mass(mesh: &TriMesh, modes: &Modes) -> Result<Self, Error> {
        modes.check_mesh(mesh)?;
        let areas = vertex_areas(mesh);
        let mut squares = vec![0.0_f64; modes.rank()];
        for i in mesh.used_vertices() {
            for (square, u) in squares.iter_mut().zip(modes.of_vertex(i)) {
                let moved = length(*u);
                *square += areas[i as usize] * moved * moved;
            }
        }
        Ok(Self::diagonal(MetricKind::Mass, fill_zeros(squares.into_iter().map(f64::sqrt).collect())))
    }
}

/// Returns for each vertex a third of the area of its faces (model unit squared); 0 for unused vertices.
pub fn vertex_areas(mesh: &TriMesh) -> Vec<f64> {
    let p = mesh.rest_positions();
    let mut areas = vec![0.0; p.len()];
    for face in mesh.faces() {
        let [p0, p1, p2] = face.map(|i| p[i as usize]);
        let area = length((p1 - p0).cross(p2 - p0)) / 2.0;
        for &i in face {
            areas[i as usize] += area / 3.0;
        }
    }
    areas
}

/// Returns the length of a vector without overflow or underflow of the squares.
fn length(x: DVec3) -> f64 {
    let largest = x.abs().max_element();
    if largest == 0.0 { 0.0 } else { largest * (x / largest).length() }
}

/// Replaces scales of 0 (of modes without displacements) by the smallest positive one, or by 1.
fn fill_zeros(mut scales: Vec<f64>) -> Vec<f64> {
    let smallest = scales.iter().copied().filter(|s| *s > 0.0).fold(f64::INFINITY, f64::min);
    let fill = if smallest.is_finite() { smallest } else { 1.0 };
    for scale in scales.iter_mut().filter(|s| **s <= 0.0) {
        *scale = fill;
    }
    scales
}
