//! Mass data of a reduced model.

use glam::DVec3;

use crate::MassProperties;

/// Mass of a body with modes: the data of the solid that its motion needs beside the elastic forces.
#[derive(Clone, Debug, PartialEq)]
pub struct MassData {
    /// Mass, centre of mass and inertia at rest.
    pub properties: MassProperties,
    /// Integral of each mode over the mass (r vectors): see [`Solid::mode_moments`](crate::Solid::mode_moments).
    pub moments: Vec<DVec3>,
    /// Whether vertices of the body are fixed, so that it has no rigid motion.
    pub is_held: bool,
}

impl MassData {
    /// Returns the data of the body with all lengths multiplied by `factor`, of the same density, with mass-orthonormal
    /// modes.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            properties: self.properties.scaled(factor),
            moments: self.moments.iter().map(|moment| *moment * factor.powf(1.5)).collect(),
            is_held: self.is_held,
        }
    }
}
