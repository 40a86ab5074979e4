//! Why a surface or a stiffness gives no modes.

/// No modes could be made. One line, naming the cause.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ModesError {
    /// Every triangle is a segment or a point, so no inner product over the surface exists.
    #[error("the surface has no area: polynomial modes need at least one triangle that is not degenerate")]
    NoArea,
    /// The surface is so far from the origin that its shape is lost in the rounding of its positions.
    #[error(
        "the surface (radius {radius:e}) is too small beside its distance {distance:e} from the origin: move it closer"
    )]
    Lost {
        /// Root mean square distance of the surface from its centroid (model unit).
        radius: f64,
        /// Root mean square distance of the surface from the origin (model unit).
        distance: f64,
    },
    /// An eigenvalue that no stiffness at rest has.
    #[error(
        "eigenvalue {index} (counted from 0) is {value:e}: it must be finite and at least 0; set small negative ones to 0"
    )]
    Eigenvalue {
        /// Its place, from 0.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A filter that would leave nothing.
    #[error("ell is {value:e}: it must be positive and finite; the paper takes 100")]
    Ell {
        /// Its value.
        value: f64,
    },
    /// The core refused the modes or the metric: a number is out of range.
    #[error(transparent)]
    Core(#[from] sscc::Error),
}
