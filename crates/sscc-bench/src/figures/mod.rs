//! Diagrams of the paper's figures from our certificates. Figure 12 is a plot of the scene `bunny16`.

mod extremal_shapes;
mod figure_record;
mod metrics_over_modes;
mod mode_displacements;
mod radii_of_levels;

pub use figure_record::FigureRecord;

use crate::error::Error;
use crate::setup::Setup;

/// A figure of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Figure {
    /// Figure 7: the median radius of each level of the hierarchy.
    RadiiOfLevels,
    /// Figure 9: the root's radius over the number of modes, under two metrics.
    MetricsOverModes,
    /// Figure 11: the shapes at the root's radius along the first modes.
    ExtremalShapes,
    /// Figure 14: the shapes at the root's radius along the first modes, for quadratic polynomials and for vibrations.
    GeometricModes,
}

impl Figure {
    /// Makes the figure.
    ///
    /// # Errors
    /// When the model cannot be read or made, the cache cannot be written to, or the work is cancelled.
    pub fn make(self, setup: &Setup<'_>) -> Result<FigureRecord, Error> {
        match self {
            Self::RadiiOfLevels => radii_of_levels::make(setup),
            Self::MetricsOverModes => metrics_over_modes::make(setup),
            Self::ExtremalShapes => extremal_shapes::of_vibrations(setup),
            Self::GeometricModes => extremal_shapes::of_polynomials(setup),
        }
    }
}
