//! Mass properties of a solid.

use glam::{DMat3, DVec3};
use sscc::{Modes, TriMesh};

use crate::{Solid, SolidError};

/// Mass, centre of mass and inertia of a body at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// Mass (density times the model unit cubed).
    pub mass: f64,
    /// Centre of mass (model unit).
    pub center: DVec3,
    /// Inertia tensor about the centre of mass: the integral of `|x|^2 I - x x'` over the mass.
    pub inertia: DMat3,
}

impl MassProperties {
    /// Returns the mass properties of a uniform body within a closed surface whose triangles are oriented outwards. None
    /// if the mass within is not positive and finite.
    pub fn within(surface: &TriMesh, density: f64) -> Option<Self> {
        let p = surface.rest_positions();
        let origin = p[surface.faces()[0][0] as usize];
        let (mut mass, mut moment, mut second) = (0.0, DVec3::ZERO, DMat3::ZERO);
        for face in surface.faces() {
            // The tetrahedron of the triangle and the origin has a signed volume.
            let [a, b, c] = face.map(|v| p[v as usize] - origin);
            let own = density * a.dot(b.cross(c)) / 6.0;
            let sum = a + b + c;
            mass += own;
            moment += sum * (own / 4.0);
            for x in [a, b, c, sum] {
                second += outer(x) * (own / 20.0);
            }
        }
        let is_positive = mass.is_finite() && mass > 0.0;
        is_positive.then(|| Self::of_moments(mass, moment, second, origin))
    }

    /// Returns the mass properties from the integrals of 1, `x` and `x x'` over the mass, for positions relative to
    /// `origin`.
    fn of_moments(mass: f64, moment: DVec3, mut second: DMat3, origin: DVec3) -> Self {
        let center = moment / mass;
        second -= outer(center) * mass;
        second = (second + second.transpose()) * 0.5;
        let trace = second.x_axis.x + second.y_axis.y + second.z_axis.z;
        let inertia = DMat3::from_diagonal(DVec3::splat(trace)) - second;
        Self { mass, center: origin + center, inertia }
    }

    /// Returns the mass properties of the body with all lengths multiplied by `factor`, of the same density.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        let Self { mass, center, inertia } = *self;
        Self { mass: mass * factor.powi(3), center: center * factor, inertia: inertia * factor.powi(5) }
    }
}

/// Returns `x x'`.
fn outer(x: DVec3) -> DMat3 {
    DMat3::from_cols(x * x.x, x * x.y, x * x.z)
}

impl Solid {
    /// Returns the mass properties of the consistent mass matrix, which the modes also use.
    pub fn mass_properties(&self) -> MassProperties {
        let (mut mass, mut moment) = (0.0, DVec3::ZERO);
        let mut second = DMat3::ZERO;
        // Positions relative to a vertex lose less precision if the body is far from the origin.
        let origin = self.vertices()[0];
        for index in 0..self.element_count() {
            let element = self.element(index);
            let x: Vec<DVec3> =
                element.vertices.iter().map(|v| self.vertices()[*v as usize] - origin).collect();
            let masses = element.masses();
            for (a, row) in x.iter().zip(masses) {
                for (b, m) in x.iter().zip(row) {
                    mass += m;
                    moment += *a * m;
                    second += DMat3::from_cols(*a * (m * b.x), *a * (m * b.y), *a * (m * b.z));
                }
            }
        }
        MassProperties::of_moments(mass, moment, second, origin)
    }

    /// Returns the integral of each mode over the mass (r vectors). Its product with an acceleration is the generalised
    /// force of gravity. It is 0 for modes of a free body, which do not move the centre of mass.
    ///
    /// # Errors
    /// When the modes have another number of vertices.
    pub fn mode_moments(&self, modes: &Modes) -> Result<Vec<DVec3>, SolidError> {
        let vertices = self.vertices().len();
        if modes.vertices() != vertices {
            return Err(sscc::Error::VertexCount { modes: modes.vertices(), mesh: vertices }.into());
        }
        let mut moments = vec![DVec3::ZERO; modes.rank()];
        for index in 0..self.element_count() {
            let element = self.element(index);
            for (a, row) in element.vertices.iter().zip(element.masses()) {
                let mass: f64 = row.iter().sum();
                for (moment, u) in moments.iter_mut().zip(modes.of_vertex(*a)) {
                    *moment += *u * mass;
                }
            }
        }
        Ok(moments)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Material, PartialMaterial};

    #[test]
    fn mass_properties_of_a_box_match_closed_forms() {
        let corner = |k: usize| {
            DVec3::new((k & 1) as f64 * 2.0, (k >> 1 & 1) as f64 * 3.0, (k >> 2 & 1) as f64 * 4.0) + 10.0
        };
        let vertices: Vec<DVec3> = (0..8).map(corner).collect();
        let cubes = vec![[0, 1, 3, 2, 4, 5, 7, 6]];
        let tets = [[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];
        let heavy = PartialMaterial { density: Some(5.0), ..PartialMaterial::default() };
        let material = Material::new(&heavy).unwrap();
        for (tets, cubes) in [(vec![], cubes), (tets.to_vec(), vec![])] {
            let solid = Solid::uniform(vertices.clone(), tets, cubes, material).unwrap();
            let found = solid.mass_properties();
            let mass = 5.0 * 24.0;
            assert!((found.mass - mass).abs() < 1e-10);
            assert!((found.center - DVec3::new(11.0, 11.5, 12.0)).length() < 1e-12);
            let expected = DVec3::new(9.0 + 16.0, 4.0 + 16.0, 4.0 + 9.0) * mass / 12.0;
            assert!((found.inertia - DMat3::from_diagonal(expected)).abs_diff_eq(DMat3::ZERO, 1e-9));

            // The boundary encloses the same body, and a body of twice the size has the same density.
            let surface = solid.boundary().unwrap().mesh;
            let within = MassProperties::within(&surface, 5.0).unwrap();
            let near = |a: &MassProperties, b: &MassProperties| {
                (a.mass / b.mass - 1.0).abs() < 1e-12
                    && a.center.abs_diff_eq(b.center, 1e-10)
                    && a.inertia.abs_diff_eq(b.inertia, 1e-10 * b.inertia.x_axis.x)
            };
            assert!(near(&within, &found), "{within:?} {found:?}");
            let twice = surface.rest_positions().iter().map(|p| *p * 2.0).collect();
            let twice = TriMesh::new(twice, surface.faces().to_vec()).unwrap();
            assert!(near(&MassProperties::within(&twice, 5.0).unwrap(), &found.scaled(2.0)));
            let reversed = surface.faces().iter().map(|[a, b, c]| [*a, *c, *b]).collect();
            let reversed = TriMesh::new(surface.rest_positions().to_vec(), reversed).unwrap();
            assert_eq!(MassProperties::within(&reversed, 5.0), None);
        }
    }
}
