//! Recipes of models: a shape, a material and a kind of modes.

use sscc::{Metric, MetricKind, ReducedModel};
use sscc_solid::PartialMaterial;

use super::shape::Shape;
use crate::TaskError;
use crate::error::At;
use crate::models::Fix;
use crate::resize::Resize;

/// The recipe of an elastic body with modes.
#[derive(Clone, Debug)]
pub struct Recipe {
    /// The name of the model.
    pub name: String,
    /// The shape of its surface or solid.
    pub shape: Shape,
    /// Its modes.
    pub modes: ModesSpec,
    /// The material of a lattice around a surface, with defaults for absent numbers. Its numbers override those in the
    /// file of a solid.
    pub material: PartialMaterial,
    /// Number of cubes along the longest side of the lattice around a surface. None means the default of the shape.
    pub cells: Option<usize>,
    /// Size of the body; the default is that of its files.
    pub resize: Resize,
    /// Vertices that do not move. None means a free body.
    pub fix: Option<Fix>,
    /// The typical amplitude of each mode: the unit in which certificates measure q. None means the model's metric.
    pub amplitudes: Option<Vec<f64>>,
}

/// Modes of an elastic body.
#[derive(Clone, Copy, Debug)]
pub enum ModesSpec {
    /// This number of natural vibrations.
    Linear(usize),
    /// This number of modes for large deformations.
    Nonlinear(usize),
    /// The 24 quadratic polynomials, fewer for small solids.
    Polynomial,
    /// The modes of a model file.
    Given,
}

impl ModesSpec {
    /// Returns the number of modes r; None if it is known only with the model: for a file with modes, and for polynomial modes, of
    /// which there are at most 24.
    pub fn rank(self) -> Option<usize> {
        match self {
            Self::Linear(rank) | Self::Nonlinear(rank) => Some(rank),
            Self::Polynomial | Self::Given => None,
        }
    }
}

/// Number of cubes along the longest side of the spring, as in `elastic_spring` of `sscc-modes`.
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
            resize: Resize::default(),
            fix: None,
            amplitudes: None,
        }
    }

    /// Returns the number of cubes along the longest side of the lattice; None means the default of all surfaces.
    pub(super) fn cells(&self) -> Option<usize> {
        let default = matches!(self.shape, Shape::Spring { .. }).then_some(SPRING_CELLS);
        self.cells.or(default)
    }

    /// Returns the metric for the certificates of its model.
    ///
    /// # Errors
    /// When there is not one amplitude for each mode, or one is out of range.
    pub fn metric(&self, model: &ReducedModel) -> Result<Metric, TaskError> {
        let Some(amplitudes) = &self.amplitudes else { return Ok(model.metric().clone()) };
        if amplitudes.len() != model.rank() {
            let cause = format!("{} numbers for {} modes", amplitudes.len(), model.rank());
            return Err(TaskError::refused(format_args!("{}: amplitudes", self.name), cause));
        }
        let scales = amplitudes.iter().map(|amplitude| 1.0 / amplitude).collect();
        Metric::from_scales(MetricKind::Given, scales).at(|| format!("{}: amplitudes", self.name))
    }
}
