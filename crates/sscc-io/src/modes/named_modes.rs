//! Modes with their names.

use sscc::Modes;

/// Modes, with names where the files have some.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedModes {
    /// The modes.
    pub modes: Modes,
    /// A name for each mode (r), or none.
    pub names: Vec<String>,
}
