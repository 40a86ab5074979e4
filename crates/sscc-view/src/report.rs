//! Reports: the page with all its data in one file.

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use crate::page::{json_in, with_data, with_json};
use crate::{Arrays, Scene, ViewError};

/// A report: a scene and its arrays.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The scene.
    pub scene: Scene,
    /// The arrays that the scene names.
    pub arrays: Arrays,
}

impl Report {
    /// Returns the report as one HTML file, which loads no other file.
    ///
    /// # Errors
    /// If a value cannot be written as JSON. The types of a scene exclude this.
    pub fn html(&self) -> serde_json::Result<String> {
        with_data(self)
    }

    /// Returns this program's page with the data of the report `html`. All other parts of `html` are dropped, since
    /// another program may have written them.
    ///
    /// # Errors
    /// If `html` contains no report.
    pub fn rebuild(html: &str) -> Result<String, ViewError> {
        let json = json_in(html).ok_or_else(|| ViewError::NotAReport("it has no data".into()))?;
        let _: ReportKeys =
            serde_json::from_str(json).map_err(|error| ViewError::NotAReport(error.to_string()))?;
        Ok(with_json(json))
    }
}

/// The keys of a report. Parsing them checks that a text is the JSON of a report, without building its values.
#[derive(Deserialize)]
struct ReportKeys {
    #[serde(rename = "scene")]
    _scene: IgnoredAny,
    #[serde(rename = "arrays")]
    _arrays: IgnoredAny,
}
