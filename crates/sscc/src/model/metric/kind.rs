//! The kinds of metrics, and their names on the command line and in files.

/// Where the factor of a [`Metric`](crate::Metric) comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MetricKind {
    /// All weights 1.
    Identity,
    /// Each mode by its largest vertex displacement, so that `|z|` is a length (paper, section 6).
    Displacement,
    /// Each mode by the root of `sum_i area_i |U_i|^2`: how much surface it moves (paper, section 6).
    Mass,
    /// Each mode by the strain energy of a unit of it (paper, section 6).
    Energy,
    /// Weights or a matrix from the caller.
    Given,
}

names! { MetricKind, "kind of metric":
    Identity = "identity",
    Displacement = "displacement",
    Mass = "mass",
    Energy = "energy",
    Given = "given",
}
