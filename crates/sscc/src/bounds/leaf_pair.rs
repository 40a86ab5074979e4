//! Bounds for all triangle pairs between two leaves at once: their vertices share one direction, or one affine map.
//! What costs a sum over the modes is done once for two vertices, not for each of the triangle pairs that they are
//! corners of.

use glam::DVec3;

use super::affine::AffineFit;
use super::separating_direction::{point_bound, rest_distance};
use crate::geometry::nearest_to_origin;
use crate::model::rows::project;
use crate::model::{ScaledModel, direction};

/// The vertices of two leaves (or of one, twice) and what is known between them; owns its memory.
pub(crate) struct LeafPair<'a> {
    model: &'a ScaledModel,
    /// Ascending.
    x: Vec<u32>,
    y: Vec<u32>,
    projections: Vec<f64>,
    /// For each vertex of x and each of y the bound along the last direction.
    along: Vec<f64>,
    affine: AffineFit,
    /// For each vertex of x and each of y the squared difference of residuals; empty until the map is fitted.
    residuals: Vec<f64>,
}

impl<'a> LeafPair<'a> {
    pub(crate) fn new(model: &'a ScaledModel) -> Self {
        Self {
            model,
            x: Vec::new(),
            y: Vec::new(),
            projections: Vec::new(),
            along: Vec::new(),
            affine: AffineFit::new(model.row),
            residuals: Vec::new(),
        }
    }

    /// Takes the triangles of two leaves.
    pub(crate) fn load(&mut self, x: &[u32], y: &[u32]) {
        for (vertices, triangles) in [(&mut self.x, x), (&mut self.y, y)] {
            vertices.clear();
            vertices.extend(triangles.iter().flat_map(|&t| self.model.faces[t as usize]));
            vertices.sort_unstable();
            vertices.dedup();
        }
        self.residuals.clear();
    }

    /// Bounds every pair of vertices along a direction (as made by [`direction`]).
    pub(crate) fn look_along(&mut self, n: DVec3) {
        let (model, row) = (self.model, self.model.row);
        let vertices = self.x.iter().chain(&self.y);
        self.projections.resize((self.x.len() + self.y.len()) * row, 0.0);
        for (&v, out) in vertices.zip(self.projections.chunks_exact_mut(row)) {
            project(model.modes(v), n, out);
        }
        let (of_x, of_y) = self.projections.split_at(self.x.len() * row);
        self.along.clear();
        let errors = (model.error.rest(n), model.error.rate(n));
        for (a, projected_a) in self.x.iter().zip(of_x.chunks_exact(row)) {
            for (b, projected_b) in self.y.iter().zip(of_y.chunks_exact(row)) {
                let gap = n.dot(model.positions[*b as usize] - model.positions[*a as usize]);
                self.along.push(point_bound(gap, projected_a, projected_b, errors));
            }
        }
    }

    /// The bound of two triangles (or hulls of three of the vertices) along the last direction.
    pub(crate) fn along(&self, x: [u32; 3], y: [u32; 3]) -> f64 {
        // No bound is NaN.
        let least = |a: f64, b: f64| if b < a { b } else { a };
        self.corners(x, y).map(|at| self.along[at]).into_iter().fold(f64::INFINITY, least)
    }

    /// The bound of two triangles by one affine map of all vertices. That of a cone of directions, which costs more,
    /// is for triangles so close that a fixed direction is weak.
    pub(crate) fn affine(&mut self, x: [u32; 3], y: [u32; 3], enough: f64) -> f64 {
        let at = |v: u32| self.model.positions[v as usize];
        let differences: [DVec3; 9] = std::array::from_fn(|i| at(y[i % 3]) - at(x[i / 3]));
        let Some(n) = direction(nearest_to_origin(&differences).point) else { return 0.0 };
        let delta = rest_distance(&differences, n, &self.model.error);
        if delta <= 0.0 || (self.residuals.is_empty() && !self.fit()) {
            return 0.0;
        }
        let largest = self.corners(x, y).map(|at| self.residuals[at]).into_iter().fold(0.0, f64::max);
        let enough = if is_near(&differences, delta) { enough } else { 0.0 };
        self.affine.bound(&differences, delta, largest, enough, &self.model.error)
    }

    fn fit(&mut self) -> bool {
        let model = self.model;
        let vertices: Vec<u32> = self.x.iter().chain(&self.y).copied().collect();
        let origin = model.positions[vertices[0] as usize];
        let offsets: Vec<DVec3> = vertices.iter().map(|v| model.positions[*v as usize] - origin).collect();
        let fitted = self.affine.fit(&offsets, |v| model.modes(vertices[v]));
        if fitted {
            for a in 0..self.x.len() {
                for b in 0..self.y.len() {
                    self.residuals.push(self.affine.residual(a, self.x.len() + b));
                }
            }
        }
        fitted
    }

    /// Where the nine pairs of corners are in the tables.
    fn corners(&self, x: [u32; 3], y: [u32; 3]) -> [usize; 9] {
        let place = |vertices: &[u32], v: u32| vertices.partition_point(|w| *w < v);
        let (x, y) = (x.map(|v| place(&self.x, v)), y.map(|v| place(&self.y, v)));
        std::array::from_fn(|i| x[i / 3] * self.y.len() + y[i % 3])
    }
}

/// Whether the distance of two triangles is less than half of what their farthest corners have.
pub(super) fn is_near(differences: &[DVec3; 9], delta: f64) -> bool {
    let farthest = differences.iter().map(|d| d.length_squared()).fold(0.0, f64::max);
    farthest > 4.0 * delta * delta
}
