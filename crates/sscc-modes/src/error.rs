//! Why a surface has no modes.

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
    /// The core refused the modes: an entry is out of range.
    #[error(transparent)]
    Core(#[from] sscc::Error),
}
