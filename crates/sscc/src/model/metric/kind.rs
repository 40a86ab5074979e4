//! The kinds of metrics, and their names on the command line and in files.

/// The origin of the factor of a [`Metric`](crate::Metric).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MetricKind {
    /// All weights are 1.
    Identity,
    /// Each mode is scaled by its largest vertex displacement, so that `|z|` is a length (paper, section 6).
    Displacement,
    /// Each mode is scaled by the root of `sum_i area_i |U_i|^2`, which measures the surface that it moves (paper, section 6).
    Mass,
    /// Each mode is scaled by the root of the strain energy of its unit displacement (paper, section 6).
    Energy,
    /// Weights or a matrix are given by the caller.
    Given,
}

names! { MetricKind, "kind of metric":
    Identity = "identity",
    Displacement = "displacement",
    Mass = "mass",
    Energy = "energy",
    Given = "given",
}
