//! The data of a figure.

use serde::Serialize;

use crate::record::Means;

/// The numbers of a figure, and its picture. The JSON omits the picture.
#[derive(Clone, Debug, Serialize)]
pub struct FigureRecord {
    /// The name of the scenario.
    pub scenario: &'static str,
    /// Name of the model, and origin of its shape.
    pub source: String,
    /// A note, for example on an embedded shape in place of a file.
    pub note: Option<String>,
    /// The numbers, row by row.
    pub rows: Vec<Means>,
    /// The figure as an SVG element.
    #[serde(skip)]
    pub svg: String,
}
