//! Shape: the data that all bodies of one kind share.

use std::sync::Arc;

use glam::DVec3;
use sscc::{Certificates, ReducedModel};
use sscc_solid::{Elasticity, MassProperties};

use crate::{DepthField, DynamicsError, ElasticEnergy};

/// A model with its certificates and the data of its motion, shared by any number of bodies. The modes must be
/// mass-orthonormal; those of free bodies must also be orthogonal to rigid motions. The crate `sscc-modes` computes
/// such modes. Clones share one memory.
#[derive(Clone, Debug)]
pub struct Shape(Arc<Contents>);

#[derive(Clone, Debug)]
struct Contents {
    model: ReducedModel,
    certificates: Certificates,
    elasticity: Elasticity,
    /// The energy of nonlinear forces.
    elastic_energy: Option<Arc<ElasticEnergy>>,
    mass: MassProperties,
    moments: Vec<DVec3>,
    depth: DepthField,
    /// Maximum distance of a vertex from the centre of mass, at rest.
    radius: f64,
    /// Maximum displacement of a vertex by a unit of each mode.
    reach: Vec<f64>,
}

impl Shape {
    /// Creates a shape with zero mode moments. Computes the material depth of the rest pose: see [`DepthField::new`]
    /// for the cost.
    ///
    /// # Errors
    /// When the certificates are of another model or have a clearance, the elasticity has another rank, linear forces
    /// couple modes, or nonlinear forces are not the gradient of an energy.
    pub fn new(
        model: ReducedModel,
        certificates: Certificates,
        elasticity: Elasticity,
        mass: MassProperties,
    ) -> Result<Self, DynamicsError> {
        certificates.check_model(&model)?;
        if certificates.clearance().is_some() {
            return Err(sscc::Error::ClearanceCertificates.into());
        }
        let (r, found) = (model.rank(), elasticity.rank());
        if found != r {
            return Err(DynamicsError::Rank { found, rank: r });
        }
        if matches!(&elasticity, Elasticity::Linear(stiffness) if !stiffness.is_diagonal()) {
            return Err(DynamicsError::Coupled);
        }
        let elastic_energy = match &elasticity {
            Elasticity::Linear(_) => None,
            Elasticity::Nonlinear(forces) => Some(Arc::new(ElasticEnergy::new(forces)?)),
        };
        let depth = DepthField::new(model.mesh());
        let rest = model.mesh().rest_positions();
        let radius = rest.iter().map(|p| p.distance(mass.center)).fold(0.0, f64::max);
        let mut reach = vec![0.0_f64; r];
        for (i, u) in model.modes().displacements().iter().enumerate() {
            reach[i % r] = reach[i % r].max(u.length());
        }
        let moments = vec![DVec3::ZERO; r];
        Ok(Self(Arc::new(Contents {
            model,
            certificates,
            elasticity,
            elastic_energy,
            mass,
            moments,
            depth,
            radius,
            reach,
        })))
    }

    /// Returns the shape with a moment for each mode (r vectors): a uniform acceleration g exerts the generalised force
    /// `moment . g`. Held bodies need it. See [`mode_moments`](sscc_solid::Solid::mode_moments).
    ///
    /// # Errors
    /// When the number of moments is not r.
    pub fn with_moments(mut self, moments: Vec<DVec3>) -> Result<Self, DynamicsError> {
        if moments.len() != self.0.model.rank() {
            return Err(DynamicsError::Rank { found: moments.len(), rank: self.0.model.rank() });
        }
        Arc::make_mut(&mut self.0).moments = moments;
        Ok(self)
    }

    /// Whether two shapes are clones of each other.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }

    /// Returns mesh and modes.
    pub fn model(&self) -> &ReducedModel {
        &self.0.model
    }

    /// Returns the certificates of the model.
    pub fn certificates(&self) -> &Certificates {
        &self.0.certificates
    }

    /// Returns the elastic forces.
    pub fn elasticity(&self) -> &Elasticity {
        &self.0.elasticity
    }

    /// Returns the energy of nonlinear forces; None for linear forces.
    pub fn elastic_energy(&self) -> Option<&Arc<ElasticEnergy>> {
        self.0.elastic_energy.as_ref()
    }

    /// Returns the mass properties at rest.
    pub fn mass(&self) -> &MassProperties {
        &self.0.mass
    }

    /// Returns the integral of each mode over the mass (r vectors); zeros unless [`Shape::with_moments`] has set them.
    pub fn moments(&self) -> &[DVec3] {
        &self.0.moments
    }

    /// Returns the material depth of the rest pose.
    pub fn depth(&self) -> &DepthField {
        &self.0.depth
    }

    /// Returns the maximum distance of a vertex from the centre of mass, at rest (model unit).
    pub fn radius(&self) -> f64 {
        self.0.radius
    }

    /// Returns the maximum displacement of a vertex by a unit of each mode (r numbers, model unit).
    pub fn reach(&self) -> &[f64] {
        &self.0.reach
    }
}
