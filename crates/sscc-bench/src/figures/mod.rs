//! Diagrams of the paper's figures from our certificates. Figure 12 is a plot of the scene `bunny16`.

mod extremal_shapes;
mod metrics_over_modes;
mod radii_of_levels;

use serde::Serialize;

use crate::error::Error;
use crate::record::Means;
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
    /// Figure 14: the same, of quadratic polynomials and of vibrations.
    GeometricModes,
}

/// The numbers of a figure, and its picture. In JSON without the picture.
#[derive(Clone, Debug, Serialize)]
pub struct FigureRecord {
    /// The name of the scenario.
    pub scenario: &'static str,
    /// Its model, and where the shape comes from.
    pub source: String,
    /// A note for people, for example on an embedded shape in place of a file.
    pub note: Option<String>,
    /// The numbers, row by row.
    pub rows: Vec<Means>,
    /// The figure as an SVG element.
    #[serde(skip)]
    pub svg: String,
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
