//! Recipes of models: a shape, a material and a kind of modes.

use sscc::{Metric, MetricKind, ReducedModel};
use sscc_solid::PartialMaterial;

use super::shape::Shape;
use crate::SimError;
use crate::error::At;

/// A free elastic body with modes.
#[derive(Clone, Debug)]
pub struct Recipe {
    /// The name of the model.
    pub name: String,
    /// The shape of its surface or solid.
    pub shape: Shape,
    /// Its modes.
    pub modes: ModesSpec,
    /// Overrides the materials in the file of a solid.
    pub material: PartialMaterial,
    /// Cubes along the longest side of the lattice around a surface; none: the default of the shape.
    pub cells: Option<usize>,
    /// Longest side of the AABB of a surface; none: not scaled.
    pub size: Option<f64>,
    /// The typical amplitude of each mode: the unit in which certificates measure q. None: the model's metric.
    pub amplitudes: Option<Vec<f64>>,
}

/// Modes of a free elastic body.
#[derive(Clone, Copy, Debug)]
pub enum ModesSpec {
    /// This number of natural vibrations.
    Linear(usize),
    /// This number of modes for large deformations.
    Nonlinear(usize),
    /// The 24 quadratic polynomials.
    Polynomial,
}

impl ModesSpec {
    /// Number of modes r.
    pub fn rank(self) -> usize {
        match self {
            Self::Linear(rank) | Self::Nonlinear(rank) => rank,
            Self::Polynomial => 24,
        }
    }
}

/// Cubes along the spring, as in the library's `elastic_spring`.
const SPRING_CELLS: usize = 30;

impl Recipe {
    /// Creates a recipe with the default material, the shape's own size and its default lattice.
    pub fn new(name: impl Into<String>, shape: Shape, modes: ModesSpec) -> Self {
        Self {
            name: name.into(),
            shape,
            modes,
            material: PartialMaterial::default(),
            cells: None,
            size: None,
            amplitudes: None,
        }
    }

    /// Returns the cubes along the longest side of the lattice; None: the default of all surfaces.
    pub(super) fn cells(&self) -> Option<usize> {
        let default = matches!(self.shape, Shape::Spring { .. }).then_some(SPRING_CELLS);
        self.cells.or(default)
    }

    /// Returns the metric for the certificates of its model.
    ///
    /// # Errors
    /// When an amplitude is out of range.
    pub fn metric(&self, model: &ReducedModel) -> Result<Metric, SimError> {
        let Some(amplitudes) = &self.amplitudes else { return Ok(model.metric().clone()) };
        let scales = amplitudes.iter().map(|amplitude| 1.0 / amplitude).collect();
        Metric::from_scales(MetricKind::Given, scales).at(|| format!("{}: amplitudes", self.name))
    }
}
