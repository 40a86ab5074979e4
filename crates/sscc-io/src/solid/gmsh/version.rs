//! Supported versions of the format.

/// A version: 2.0 to 2.2, or 4.1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Version {
    V2,
    V4,
}
