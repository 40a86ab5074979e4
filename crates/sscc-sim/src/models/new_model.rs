//! A new model, with the facts that were found while it was made.

use serde::Serialize;
use sscc::ReducedModel;
use sscc_io::ModelInfo;

/// A surface with modes.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct NewModel {
    /// The model; of a solid its metric is the strain energy, else the displacement.
    pub model: ReducedModel,
    /// Provenance; of a solid also the stiffness and the forces.
    pub info: ModelInfo,
    /// Whether vertices are split along seams, so that certificates should weld them.
    pub is_split: bool,
    /// Of a solid: its size and frequencies.
    pub solid: Option<SolidFacts>,
    /// Of principal components: their share of the variance.
    pub components: Option<Components>,
}

/// The size of a solid and the frequencies of its modes.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidFacts {
    /// Tetrahedra and cubes.
    pub elements: usize,
    /// Coordinates of vertices that are not fixed.
    pub degrees_of_freedom: usize,
    /// Of each mode (Hz).
    pub frequencies: Vec<f64>,
}

/// The variance that principal components explain.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Components {
    /// Number of frames.
    pub frames: usize,
    /// The share of the variance that all modes together explain.
    pub explained: f64,
    /// The standard deviation of each mode.
    pub deviations: Vec<f64>,
}
