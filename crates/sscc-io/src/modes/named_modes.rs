//! Modes with their names and the standard deviations of q.

use sscc::Modes;

/// Modes, with names and standard deviations if the files have them.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedModes {
    /// The modes.
    pub modes: Modes,
    /// Name of each mode (r), or empty.
    pub names: Vec<String>,
    /// The standard deviation of each entry of q (r), for principal components.
    pub deviations: Option<Vec<f64>>,
}
