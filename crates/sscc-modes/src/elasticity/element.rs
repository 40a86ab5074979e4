//! Elements, and the points at which they are integrated.
//!
//! A tetrahedron has constant gradients: one point. A cube (trilinear hexahedron) has 2 x 2 x 2 Gauss points, one in
//! each octant; where only a share of an octant is filled, its point counts by that share. Everything that is
//! integrated (stiffness, forces, their polynomials) is a sum over these points, so that all of it speaks of one body.

use glam::{DMat3, DVec3};

use crate::{Material, Solid};

/// The corners of the cube from -1 to 1, in the order of [`Solid::cubes`].
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

/// Distance of the Gauss points from the middle, 1 / sqrt(3).
const GAUSS: f64 = 0.577_350_269_189_625_8;

/// An element of a solid.
pub(crate) struct Element<'a> {
    /// Its vertices: four or eight.
    pub vertices: &'a [u32],
    /// Its material.
    pub material: &'a Material,
    /// Integration points: one or eight.
    points: [Point; 8],
    count: usize,
}

/// A point of integration.
#[derive(Clone, Copy, Default)]
pub(crate) struct Point {
    /// The gradient of each vertex's shape function at the point (1 / length).
    pub gradients: [DVec3; 8],
    /// Each vertex's shape function.
    pub shape: [f64; 8],
    /// The volume that the point stands for.
    pub volume: f64,
}

impl Element<'_> {
    /// The integration points.
    pub fn points(&self) -> &[Point] {
        &self.points[..self.count]
    }

    /// Consistent masses: the integral of density times the product of two shape functions.
    pub fn masses(&self) -> [[f64; 8]; 8] {
        let mut masses = [[0.0; 8]; 8];
        if let [tet] = self.points() {
            let each = self.material.density * tet.volume / 20.0;
            for i in 0..4 {
                for j in 0..4 {
                    masses[i][j] = if i == j { 2.0 * each } else { each };
                }
            }
        } else {
            for point in self.points() {
                let mass = self.material.density * point.volume;
                for i in 0..8 {
                    for j in 0..8 {
                        masses[i][j] += mass * point.shape[i] * point.shape[j];
                    }
                }
            }
        }
        masses
    }
}

impl Solid {
    /// The number of elements.
    pub(crate) fn element_count(&self) -> usize {
        self.tets().len() + self.cubes().len()
    }

    /// An element, tetrahedra first.
    pub(crate) fn element(&self, index: usize) -> Element<'_> {
        let material = self.material(index);
        let mut points = [Point::default(); 8];
        if let Some(tet) = self.tets().get(index) {
            points[0] = tet_point(tet.map(|v| self.vertices()[v as usize]));
            return Element { vertices: tet, material, points, count: 1 };
        }
        let index = index - self.tets().len();
        let cube = &self.cubes()[index];
        let corners = cube.map(|v| self.vertices()[v as usize]);
        for (k, fill) in self.fill()[index].iter().enumerate() {
            points[k] = cube_point(&corners, CORNERS[k] * GAUSS);
            points[k].volume *= fill;
        }
        Element { vertices: cube, material, points, count: 8 }
    }
}

/// The only point of a tetrahedron.
fn tet_point([a, b, c, d]: [DVec3; 4]) -> Point {
    let edges = DMat3::from_cols(b - a, c - a, d - a);
    let inverse = edges.inverse(); // its rows are the gradients of b, c, d
    let rows = inverse.transpose();
    let mut point = Point { volume: edges.determinant() / 6.0, ..Point::default() };
    point.gradients[1..4].copy_from_slice(&[rows.x_axis, rows.y_axis, rows.z_axis]);
    point.gradients[0] = -(rows.x_axis + rows.y_axis + rows.z_axis);
    point.shape[..4].fill(0.25);
    point
}

/// Shape functions of the cube from -1 to 1, and their gradients there.
fn trilinear(at: DVec3) -> ([f64; 8], [DVec3; 8]) {
    let factors = CORNERS.map(|c| DVec3::ONE + c * at);
    let shape = factors.map(|f| f.x * f.y * f.z / 8.0);
    let gradient = |k: usize| {
        let f = factors[k];
        CORNERS[k] * DVec3::new(f.y * f.z, f.x * f.z, f.x * f.y) / 8.0
    };
    (shape, std::array::from_fn(gradient))
}

/// The derivative of position in the cube from -1 to 1.
fn jacobian(corners: &[DVec3; 8], gradients: &[DVec3; 8]) -> DMat3 {
    let column = |axis: usize| corners.iter().zip(gradients).map(|(p, g)| *p * g[axis]).sum();
    DMat3::from_cols(column(0), column(1), column(2))
}

/// The point of a whole cube at a place of the cube from -1 to 1, for an eighth of its volume.
fn cube_point(corners: &[DVec3; 8], at: DVec3) -> Point {
    let (shape, local) = trilinear(at);
    let jacobian = jacobian(corners, &local);
    let to_rest = jacobian.inverse().transpose();
    Point { shape, gradients: local.map(|g| to_rest * g), volume: jacobian.determinant() }
}

/// Whether a cube is flat or inverted at a corner or a Gauss point.
pub(crate) fn cube_is_inverted(corners: &[DVec3; 8]) -> bool {
    let size = corners.iter().map(|p| p.distance(corners[0])).fold(0.0, f64::max);
    CORNERS.iter().flat_map(|c| [*c, *c * GAUSS]).any(|at| {
        let determinant = jacobian(corners, &trilinear(at).1).determinant();
        // In halves of lengths; NaN (an overflow) is inverted, too.
        determinant.is_nan() || determinant <= 1e-9 * size * size * size
    })
}
