//! A configuration with its norm and its reach.

/// A q that is a configuration of the model.
#[derive(Clone, Copy)]
pub(super) struct Configuration<'q> {
    pub(super) q: &'q [f64],
    /// `|z|` in the metric and about the centre of the scope, rounded up.
    pub(super) norm: f64,
    /// An upper bound of the magnitude of every term of every position.
    pub(super) reach: f64,
}
