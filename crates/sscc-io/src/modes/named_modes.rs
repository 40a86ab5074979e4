//! Modes with their names.

use sscc::Modes;

/// Modes, with names if the files have names.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedModes {
    /// The modes.
    pub modes: Modes,
    /// Name of each mode (r), or empty.
    pub names: Vec<String>,
}
