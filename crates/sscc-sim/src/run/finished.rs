//! Data of a simulation after its last step. Files and the report are created from them.

use std::path::PathBuf;

use super::history::History;
use super::prepared::PreparedScene;
use super::summary::Summary;
use super::traditional::TraditionalCost;
use crate::error::SimError;
use crate::scenes::Scene;

/// A simulation with all of its states.
pub struct FinishedRun {
    /// The scene.
    pub scene: Scene,
    /// Its models.
    pub prepared: PreparedScene,
    /// Its folder.
    pub folder: PathBuf,
    /// Its states, at least one.
    pub history: History,
    /// Its summary.
    pub summary: Summary,
    /// Costs of the traditional method at some states.
    pub traditional: Vec<TraditionalCost>,
    /// Error that ended the simulation early, if any.
    pub failure: Option<SimError>,
    /// Error of the measurement of the traditional method after a complete simulation, if any.
    pub unmeasured: Option<SimError>,
}

impl FinishedRun {
    /// Returns the time of a state (s).
    pub fn time(&self, state: usize) -> f64 {
        state as f64 * self.scene.step
    }
}
