//! The record of one vibration. Scripts rely on its keys.

use serde::Serialize;

use crate::record::Means;

/// Record of one vibration: one line of JSON. Times are means over steps.
#[derive(Clone, Debug, Serialize)]
pub struct KineticRecord {
    /// The name of the scenario.
    pub scenario: &'static str,
    /// Origin of the mesh.
    pub source: String,
    /// Note on a replaced model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// Frequency of the first mode (Hz).
    pub frequency: f64,
    /// The largest displacement in percent of half the diagonal of the AABB.
    pub share: f64,
    /// Triangles of the body.
    pub triangles: usize,
    /// Number of modes of the body.
    pub rank: usize,
    /// Length of a step relative to `|z|`, the mean over blocks.
    pub step: f64,
    /// Steps that were measured.
    pub steps: usize,
    /// Measured steps in which the body collides.
    pub colliding_steps: usize,
    /// Measured steps on which comparators ran.
    pub compared_steps: usize,
    /// Steps in which two exact methods differ.
    pub mismatches: usize,
    /// Mean microseconds of kinetic queries over the steps that collide.
    pub kinetic_us_colliding: Option<f64>,
    /// Mean microseconds by method. Times of comparators are over `compared_steps`, each weighted by its stratum's
    /// share of all steps.
    pub microseconds: Means,
    /// Description of the machine.
    pub machine: String,
}
