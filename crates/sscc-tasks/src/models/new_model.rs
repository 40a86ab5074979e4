//! A new model, with facts about its computation.

use serde::Serialize;
use sscc::ReducedModel;
use sscc_io::ModelInfo;

/// A surface with modes.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct NewModel {
    /// The model. Its metric is the strain energy for a solid, else the displacement metric.
    pub model: ReducedModel,
    /// Provenance; for a solid also stiffness, forces and mass, for principal components the deviations of q.
    pub info: ModelInfo,
    /// Size, mass and frequencies of a solid.
    pub solid: Option<SolidFacts>,
    /// Variance of principal components.
    pub components: Option<Components>,
}

/// The size and mass of a solid, and the frequencies of its modes.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidFacts {
    /// Tetrahedra and cubes.
    pub elements: usize,
    /// Coordinates of vertices that are not fixed.
    pub degrees_of_freedom: usize,
    /// Mass (kg).
    pub mass: f64,
    /// Frequency of each mode (Hz).
    pub frequencies: Vec<f64>,
    /// First frequency (Hz) with the same tetrahedra in second order. The difference shows by how much linear tetrahedra are
    /// too stiff. None if it was not computed.
    pub second_order: Option<f64>,
}

/// The variance that principal components explain.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Components {
    /// Number of frames.
    pub frames: usize,
    /// Share of the variance that all modes together explain.
    pub explained: f64,
    /// The standard deviation of the frames along each mode (model unit).
    pub deviations: Vec<f64>,
}
