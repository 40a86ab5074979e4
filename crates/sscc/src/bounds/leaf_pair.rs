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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bounds::tests::random::Random;
    use crate::{Metric, Modes, ReducedModel, TriMesh};

    /// Triangles of even vertices and of odd ones, and two that are points.
    const FACES: [[u32; 3]; 8] =
        [[0, 2, 4], [2, 4, 6], [8, 2, 0], [1, 3, 5], [9, 7, 3], [11, 5, 7], [10, 10, 10], [13, 13, 13]];

    /// Returns a model far from the origin whose odd vertices are to the right of all even ones. Its modes are affine up
    /// to a fifth.
    fn two_sides(random: &mut Random) -> ScaledModel {
        let (rank, far, apart) = (1 + random.below(8), random.vector() * 5.0, random.power(0.35, 0.9));
        let side = |v: usize| DVec3::X * if v.is_multiple_of(2) { 0.0 } else { apart };
        let p: Vec<DVec3> = (0..14).map(|v| far + random.vector() + side(v)).collect();
        let maps: Vec<[DVec3; 3]> = (0..rank).map(|_| [(); 3].map(|()| random.vector())).collect();
        let mut modes = Vec::new();
        for p in &p {
            for [x, y, z] in &maps {
                modes.push(*x * p.x + *y * p.y + *z * p.z + random.vector() * 0.2);
            }
        }
        let mesh = TriMesh::new(p, FACES.to_vec()).unwrap();
        let modes = Modes::new(rank, modes).unwrap();
        let model = ReducedModel::with_metric(mesh, modes, Metric::identity(rank)).unwrap();
        ScaledModel::new(&model, model.metric(), &vec![0.0; rank])
    }

    /// Returns the triangles of each pair of two leaves.
    fn triangles_of(leaf_a: &[u32], leaf_b: &[u32]) -> Vec<([u32; 3], [u32; 3])> {
        let face = |a: &u32| FACES[*a as usize];
        leaf_a.iter().flat_map(|a| leaf_b.iter().map(move |b| (face(a), face(b)))).collect()
    }

    /// Returns the nine pairs of corners of two triangles.
    fn corners_of(a: [u32; 3], b: [u32; 3]) -> [(u32, u32); 9] {
        std::array::from_fn(|ij| (a[ij / 3], b[ij % 3]))
    }

    /// The bound along a direction is the smallest one of nine pairs of corners, also of triangles that are points.
    #[test]
    fn bounds_along_a_direction_are_those_of_the_corners() {
        let mut positive = 0;
        for case in 0..100 {
            let random = &mut Random::new(case);
            let model = two_sides(random);
            let row_len = model.row_len;
            let mut leaves = LeafPair::new(&model);
            for (leaf_a, leaf_b) in
                [(&[0, 1, 2][..], &[3, 4, 5][..]), (&[6][..], &[4, 3][..]), (&[0, 1][..], &[7][..])]
            {
                leaves.load(leaf_a, leaf_b);
                let dir = scale_direction(DVec3::X + random.vector() * 1.5).unwrap();
                leaves.set_direction(dir);
                let least = model.least_gap(dir);
                for (a, b) in triangles_of(leaf_a, leaf_b) {
                    let bounds = corners_of(a, b).map(|(i, j)| {
                        let gap = dir.dot(model.positions[j as usize] - model.positions[i as usize]);
                        let along = |k: usize, axis: usize| {
                            let at = axis * row_len + k;
                            dir[axis] * (model.modes(j)[at] - model.modes(i)[at])
                        };
                        let projected = (0..row_len).map(|k| along(k, 0) + along(k, 1) + along(k, 2));
                        let rate = projected.map(|rate| rate * rate).sum::<f64>().sqrt();
                        (gap - least.at_rest).max(0.0) / (rate + least.per_norm)
                    });
                    let wanted = bounds.into_iter().fold(f64::INFINITY, f64::min);
                    let bound = leaves.bound_along_direction(a, b);
                    let error = (bound - wanted).abs();
                    assert!(error <= 1e-8 * wanted + 1e-12, "case {case}: {bound:e}, not {wanted:e}");
                    positive += usize::from(wanted > 0.0);
                }
            }
        }
        assert!(positive > 500 && positive < 1200, "{positive}");
    }

    /// One affine map of all vertices serves all pairs. The residuals are those of its gradient, the largest of nine
    /// counts, and near triangles have a bound over a cone of directions.
    #[test]
    fn affine_bounds_are_those_of_the_shared_map() {
        let mut larger = 0;
        for case in 0..100 {
            let random = &mut Random::new(case);
            let model = two_sides(random);
            let row_len = model.row_len;
            let mut leaves = LeafPair::new(&model);
            let (leaf_a, leaf_b) = ([0, 1, 2], [3, 4, 5]);
            leaves.load(&leaf_a, &leaf_b);
            for (a, b) in triangles_of(&leaf_a, &leaf_b) {
                let bound = leaves.bound_by_affine_map(a, b, 0.0);
                assert!(bound > 0.0, "case {case}");
                let difference =
                    |(i, j): (u32, u32)| model.positions[j as usize] - model.positions[i as usize];
                let pairs = corners_of(a, b);
                let gradient = leaves.affine.gradient();
                let squares = pairs.map(|(i, j)| {
                    let d = difference((i, j));
                    let left = |at: usize| {
                        let (axis, k) = (at / row_len, at % row_len);
                        let fitted =
                            (0..3).map(|l| gradient[(3 * axis + l) * row_len + k] * d[l]).sum::<f64>();
                        model.modes(j)[at] - model.modes(i)[at] - fitted
                    };
                    (0..3 * row_len).map(|at| left(at).powi(2)).sum::<f64>()
                });
                let squared_residual = squares.into_iter().fold(0.0, f64::max);
                let differences = pairs.map(difference);
                let dir = scale_direction(nearest_to_origin(&differences).point).unwrap();
                let rest_distance = bound_rest_distance(&differences, dir, &model.rounding);
                for sufficient in [0.0, 1.2 * bound] {
                    let pair = AffinePair { differences: &differences, rest_distance, squared_residual };
                    let searched = if is_near(&differences, rest_distance) { sufficient } else { 0.0 };
                    let wanted = leaves.affine.bound(pair, searched, &model);
                    let found = leaves.bound_by_affine_map(a, b, sufficient);
                    assert!(
                        (found - wanted).abs() <= 1e-9 * wanted,
                        "case {case}: {found:e}, not {wanted:e}"
                    );
                    larger += usize::from(found > bound);
                }
            }
        }
        assert!(larger > 20, "{larger}");
    }
}
