//! What all bodies of one shape share.

use glam::DVec3;
use sscc::{Certificates, ReducedModel};
use sscc_solid::{Elasticity, MassProperties};

use crate::{DepthField, DynamicsError};

/// A model with its certificates and all that its motion needs, shared by any number of bodies. The modes must be
/// mass-orthonormal, those of free bodies also orthogonal to rigid motions, as `sscc-modes` makes them.
#[derive(Clone, Debug)]
pub struct Shape {
    model: ReducedModel,
    certificates: Certificates,
    elasticity: Elasticity,
    mass: MassProperties,
    moments: Vec<DVec3>,
    depth: DepthField,
    /// The largest distance of a vertex from the centre of mass, at rest.
    radius: f64,
    /// The largest displacement by a unit of each mode.
    reach: Vec<f64>,
}

impl Shape {
    /// A shape that nothing but contacts deforms. Takes a while: it measures the depth of the rest pose everywhere.
    ///
    /// # Errors
    /// When certificates, elasticity and mass are not of this model, or linear forces couple modes.
    pub fn new(
        model: ReducedModel,
        certificates: Certificates,
        elasticity: Elasticity,
        mass: MassProperties,
    ) -> Result<Self, DynamicsError> {
        certificates.check_model(&model)?;
        let (r, found) = (model.rank(), elasticity.rank());
        if found != r {
            return Err(DynamicsError::Rank { found, rank: r });
        }
        if matches!(&elasticity, Elasticity::Linear(stiffness) if !stiffness.is_diagonal()) {
            return Err(DynamicsError::Coupled);
        }
        let depth = DepthField::new(model.mesh());
        let rest = model.mesh().rest_positions();
        let radius = rest.iter().map(|p| p.distance(mass.center)).fold(0.0, f64::max);
        let mut reach = vec![0.0_f64; r];
        for (i, u) in model.modes().displacements().iter().enumerate() {
            reach[i % r] = reach[i % r].max(u.length());
        }
        Ok(Self {
            model,
            certificates,
            elasticity,
            mass,
            moments: vec![DVec3::ZERO; r],
            depth,
            radius,
            reach,
        })
    }

    /// The same shape, whose modes a uniform acceleration g excites by `moment . g` each: for bodies that are held
    /// somewhere. See [`mode_moments`](sscc_solid::Solid::mode_moments).
    ///
    /// # Errors
    /// When there is not one moment for each mode.
    pub fn with_moments(mut self, moments: Vec<DVec3>) -> Result<Self, DynamicsError> {
        if moments.len() != self.model.rank() {
            return Err(DynamicsError::Rank { found: moments.len(), rank: self.model.rank() });
        }
        self.moments = moments;
        Ok(self)
    }

    /// Mesh and modes.
    pub fn model(&self) -> &ReducedModel {
        &self.model
    }

    /// Certificates of the model.
    pub fn certificates(&self) -> &Certificates {
        &self.certificates
    }

    /// Elastic forces.
    pub fn elasticity(&self) -> &Elasticity {
        &self.elasticity
    }

    /// Mass properties at rest.
    pub fn mass(&self) -> &MassProperties {
        &self.mass
    }

    /// The integral of each mode over the mass.
    pub fn moments(&self) -> &[DVec3] {
        &self.moments
    }

    /// How deep a point of the rest pose lies inside.
    pub fn depth(&self) -> &DepthField {
        &self.depth
    }

    /// The largest distance of a vertex from the centre of mass, at rest (model unit).
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The largest displacement of any vertex by a unit of each mode (model unit).
    pub fn reach(&self) -> &[f64] {
        &self.reach
    }
}
