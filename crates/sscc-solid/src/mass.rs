//! Mass properties of a solid.

use glam::{DMat3, DVec3};
use sscc::Modes;

use crate::{Solid, SolidError};

/// Mass, centre of mass and inertia of a body at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// Mass.
    pub mass: f64,
    /// Centre of mass (model unit).
    pub center: DVec3,
    /// Inertia tensor about the centre of mass: the integral of `|x|^2 - x x'` over the mass.
    pub inertia: DMat3,
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
        let center = moment / mass;
        let outer = |x: DVec3| DMat3::from_cols(x * x.x, x * x.y, x * x.z);
        second -= outer(center) * mass;
        second = (second + second.transpose()) * 0.5;
        let trace = second.x_axis.x + second.y_axis.y + second.z_axis.z;
        let inertia = DMat3::from_diagonal(DVec3::splat(trace)) - second;
        MassProperties { mass, center: origin + center, inertia }
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
        }
    }
}
