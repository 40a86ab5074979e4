//! Elements and their integration points.
//!
//! A tetrahedron has constant gradients and needs one point. A cube (trilinear hexahedron) has 2 x 2 x 2 Gauss points,
//! one in each octant; the filled share of an octant scales the weight of its point. A tetrahedron of second order has
//! the points of `second_order.rs`. Stiffness, forces and polynomials are sums over the same points, so they agree with
//! each other.

use glam::{DMat3, DVec3};

use crate::integration_point::{IntegrationPoint, jacobian};
use crate::{Material, second_order};

/// Corners of the cube from -1 to 1, in the order of a solid's cubes.
const CORNERS: [DVec3; 8] = [
    DVec3::new(-1.0, -1.0, -1.0),
    DVec3::new(1.0, -1.0, -1.0),
    DVec3::new(1.0, 1.0, -1.0),
    DVec3::new(-1.0, 1.0, -1.0),
    DVec3::new(-1.0, -1.0, 1.0),
    DVec3::new(1.0, -1.0, 1.0),
    DVec3::new(1.0, 1.0, 1.0),
    DVec3::new(-1.0, 1.0, 1.0),
];

/// Distance of the Gauss points from the centre, 1 / sqrt(3).
const GAUSS: f64 = 0.577_350_269_189_625_8;

/// Faces of a tetrahedron of positive volume, outward.
pub(crate) const TET_FACES: [[usize; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

/// Faces of a cube, outward.
pub(crate) const CUBE_FACES: [[usize; 4]; 6] =
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];

/// An element of a solid.
#[derive(Clone, Debug)]
pub struct Element<'a> {
    /// Four, eight or ten vertices.
    pub vertices: &'a [u32],
    /// Material.
    pub material: &'a Material,
    points: Vec<IntegrationPoint>,
}

impl<'a> Element<'a> {
    /// Creates a tetrahedron from the positions of its corners.
    pub(crate) fn tet(vertices: &'a [u32; 4], corners: [DVec3; 4], material: &'a Material) -> Self {
        Self { vertices, material, points: vec![tet_point(corners)] }
    }

    /// Creates a tetrahedron of second order from the positions of its nodes.
    pub(crate) fn second_order(vertices: &'a [u32; 10], nodes: &[DVec3; 10], material: &'a Material) -> Self {
        Self { vertices, material, points: second_order::points(nodes) }
    }

    /// Creates a cube from the positions of its corners and the filled share of each octant (at corner k).
    pub(crate) fn cube(
        vertices: &'a [u32; 8],
        corners: &[DVec3; 8],
        fill: &[f64; 8],
        material: &'a Material,
    ) -> Self {
        let mut points: Vec<_> = CORNERS.iter().map(|corner| cube_point(corners, *corner * GAUSS)).collect();
        points.iter_mut().zip(fill).for_each(|(point, fill)| point.volume *= fill);
        Self { vertices, material, points }
    }

    /// Returns the integration points.
    #[inline]
    pub fn points(&self) -> &[IntegrationPoint] {
        &self.points
    }

    /// Returns the consistent mass matrix: integrals of density times the product of two shape functions.
    pub fn masses(&self) -> [[f64; 10]; 10] {
        let mut masses = [[0.0; 10]; 10];
        if let [tet] = self.points() {
            let each = self.material.density() * tet.volume / 20.0;
            for i in 0..4 {
                for j in 0..4 {
                    masses[i][j] = if i == j { 2.0 * each } else { each };
                }
            }
        } else {
            for point in self.points() {
                let mass = self.material.density() * point.volume;
                for i in 0..self.vertices.len() {
                    for j in 0..self.vertices.len() {
                        masses[i][j] += mass * point.shape[i] * point.shape[j];
                    }
                }
            }
        }
        masses
    }
}

/// Integration point of a tetrahedron.
fn tet_point([a, b, c, d]: [DVec3; 4]) -> IntegrationPoint {
    let edges = DMat3::from_cols(b - a, c - a, d - a);
    let inverse = edges.inverse(); // its rows are the gradients of b, c, d
    let rows = inverse.transpose();
    let mut point = IntegrationPoint { volume: edges.determinant() / 6.0, ..IntegrationPoint::default() };
    point.gradients[1..4].copy_from_slice(&[rows.x_axis, rows.y_axis, rows.z_axis]);
    point.gradients[0] = -(rows.x_axis + rows.y_axis + rows.z_axis);
    point.shape[..4].fill(0.25);
    point
}

/// Returns shape functions and their gradients at a point of the cube from -1 to 1.
fn trilinear(at: DVec3) -> ([f64; 8], [DVec3; 8]) {
    let factors = CORNERS.map(|c| DVec3::ONE + c * at);
    let shape = factors.map(|f| f.x * f.y * f.z / 8.0);
    let gradient = |k: usize| {
        let f = factors[k];
        CORNERS[k] * DVec3::new(f.y * f.z, f.x * f.z, f.x * f.y) / 8.0
    };
    (shape, std::array::from_fn(gradient))
}

/// Returns the integration point at a position of the cube from -1 to 1, for an eighth of its volume.
fn cube_point(corners: &[DVec3; 8], at: DVec3) -> IntegrationPoint {
    let (shape, local) = trilinear(at);
    IntegrationPoint::isoparametric(corners, &shape, &local, 1.0)
}

/// Whether a cube is flat or inverted at a corner or a Gauss point.
pub(crate) fn cube_is_inverted(corners: &[DVec3; 8]) -> bool {
    let size = corners.iter().map(|p| p.distance(corners[0])).fold(0.0, f64::max);
    CORNERS.iter().flat_map(|c| [*c, *c * GAUSS]).any(|at| {
        let determinant = jacobian(corners, &trilinear(at).1).determinant();
        // The reference cube has side 2, so the determinant is an eighth of the volume. NaN (an overflow) counts as
        // inverted, too.
        determinant.is_nan() || determinant <= 1e-9 * size * size * size
    })
}
