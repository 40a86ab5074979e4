//! Bounds all triangle pairs of two leaves at once, along one direction or with one affine map of all their vertices.
//! Sums over the modes are computed once for each vertex pair.

use glam::DVec3;

use super::affine_bound::{AffineBound, AffinePair, is_near};
use super::separating_direction::{bound_points_along, bound_rest_distance};
use crate::geometry::nearest_to_origin;
use crate::model::mode_rows::project;
use crate::model::rounding::larger_or_nan;
use crate::model::{ScaledModel, scale_direction};
use crate::vectors::{InstructionSet, Kernel, Vectors};

/// The vertices of two leaves a and b (or of one, twice) and the bounds of their pairs. Owns its memory.
pub(crate) struct LeafPair<'m> {
    model: &'m ScaledModel,
    instructions: InstructionSet,
    /// Vertices of leaf a, ascending.
    vertices_a: Vec<u32>,
    /// Vertices of leaf b, ascending.
    vertices_b: Vec<u32>,
    projections: Vec<f64>,
    /// For each vertex of a and each of b the bound along the direction.
    direction_bounds: Vec<f64>,
    affine: AffineBound,
    /// For each vertex of a and each of b the squared residual; empty until the map is fitted.
    squared_residuals: Vec<f64>,
}

/// Bounds every pair of vertices along a direction.
struct BoundVertices<'p, 'm> {
    pair: &'p mut LeafPair<'m>,
    dir: DVec3,
}

impl Kernel for BoundVertices<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) {
        let Self { pair: LeafPair { model, vertices_a, vertices_b, projections, direction_bounds, .. }, dir } =
            self;
        let row_len = model.row_len;
        projections.resize((vertices_a.len() + vertices_b.len()) * row_len, 0.0);
        let vertices = vertices_a.iter().chain(&*vertices_b);
        for (&i, out) in vertices.zip(projections.chunks_exact_mut(row_len)) {
            project(model.modes(i), dir, out);
        }
        let (of_a, of_b) = projections.split_at(vertices_a.len() * row_len);
        direction_bounds.clear();
        let least = model.least_gap(dir);
        for (i, projected_i) in vertices_a.iter().zip(of_a.chunks_exact(row_len)) {
            for (j, projected_j) in vertices_b.iter().zip(of_b.chunks_exact(row_len)) {
                let gap = dir.dot(model.positions[*j as usize] - model.positions[*i as usize]);
                direction_bounds.push(bound_points_along(gap, projected_i, projected_j, least));
            }
        }
    }
}

impl<'m> LeafPair<'m> {
    pub(crate) fn new(model: &'m ScaledModel) -> Self {
        Self {
            model,
            instructions: InstructionSet::default(),
            vertices_a: Vec::new(),
            vertices_b: Vec::new(),
            projections: Vec::new(),
            direction_bounds: Vec::new(),
            affine: AffineBound::new(model.row_len),
            squared_residuals: Vec::new(),
        }
    }

    /// Loads the triangles of two leaves.
    pub(crate) fn load(&mut self, leaf_a: &[u32], leaf_b: &[u32]) {
        for (vertices, triangles) in [(&mut self.vertices_a, leaf_a), (&mut self.vertices_b, leaf_b)] {
            vertices.clear();
            vertices.extend(triangles.iter().flat_map(|&a| self.model.faces[a as usize]));
            vertices.sort_unstable();
            vertices.dedup();
        }
        self.squared_residuals.clear();
    }

    /// Bounds every pair of vertices along a direction (from [`scale_direction`]).
    pub(crate) fn set_direction(&mut self, dir: DVec3) {
        self.instructions.run(BoundVertices { pair: self, dir });
    }

    /// Returns the bound of two triangles (or simplices with these vertices) along the direction.
    pub(crate) fn bound_along_direction(&self, a: [u32; 3], b: [u32; 3]) -> f64 {
        // No bound is NaN.
        let smaller = |x: f64, y: f64| if y < x { y } else { x };
        let bounds = self.vertex_pairs(a, b).map(|at| self.direction_bounds[at]);
        bounds.into_iter().fold(f64::INFINITY, smaller)
    }

    /// Returns the bound of two triangles by one affine map of all vertices. The rate is bounded over all directions; if that does
    /// not suffice for triangles so close that a fixed direction is weak, also over a cone of directions, which costs more.
    pub(crate) fn bound_by_affine_map(&mut self, a: [u32; 3], b: [u32; 3], sufficient: f64) -> f64 {
        let at = |i: u32| self.model.positions[i as usize];
        let differences: [DVec3; 9] = std::array::from_fn(|ij| at(b[ij % 3]) - at(a[ij / 3]));
        let Some(dir) = scale_direction(nearest_to_origin(&differences).point) else { return 0.0 };
        let rest_distance = bound_rest_distance(&differences, dir, &self.model.rounding);
        if rest_distance <= self.model.required.at_rest()
            || (self.squared_residuals.is_empty() && !self.fit())
        {
            return 0.0;
        }
        let squared_residuals = self.vertex_pairs(a, b).map(|at| self.squared_residuals[at]);
        let squared_residual = squared_residuals.into_iter().fold(0.0, larger_or_nan);
        let sufficient = if is_near(&differences, rest_distance) { sufficient } else { 0.0 };
        let pair = AffinePair { differences: &differences, rest_distance, squared_residual };
        self.affine.bound(pair, sufficient, self.model)
    }

    fn fit(&mut self) -> bool {
        let model = self.model;
        let vertices: Vec<u32> = self.vertices_a.iter().chain(&self.vertices_b).copied().collect();
        let origin = model.positions[vertices[0] as usize];
        let offsets: Vec<DVec3> = vertices.iter().map(|i| model.positions[*i as usize] - origin).collect();
        let is_fitted = self.affine.fit(&offsets, |index| model.modes(vertices[index]));
        if is_fitted {
            for i in 0..self.vertices_a.len() {
                for j in 0..self.vertices_b.len() {
                    let squared_residual = self.affine.squared_residual(i, self.vertices_a.len() + j);
                    self.squared_residuals.push(squared_residual);
                }
            }
        }
        is_fitted
    }

    /// Returns the indices of the nine pairs of corners in the tables of vertex pairs.
    fn vertex_pairs(&self, a: [u32; 3], b: [u32; 3]) -> [usize; 9] {
        let index = |vertices: &[u32], i: u32| vertices.partition_point(|other| *other < i);
        let (a, b) = (a.map(|i| index(&self.vertices_a, i)), b.map(|j| index(&self.vertices_b, j)));
        std::array::from_fn(|ij| a[ij / 3] * self.vertices_b.len() + b[ij % 3])
    }
}
