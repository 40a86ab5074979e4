//! The data of a figure.

use serde::Serialize;

use crate::record::Means;

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
