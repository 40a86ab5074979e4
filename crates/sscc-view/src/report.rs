//! Reports: the page with all its data in one file.

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use crate::page::{json_in, with_data, with_json};
use crate::{Arrays, Scene, ViewError};

/// A scene and its numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// What is shown.
    pub scene: Scene,
    /// Its numbers.
    pub arrays: Arrays,
}

impl Report {
    /// One file of HTML that needs no other and asks for none.
    ///
    /// # Errors
    /// Never, for scenes made of text and numbers.
    pub fn html(&self) -> serde_json::Result<String> {
        with_data(self)
    }

    /// The page of this program with the data of a report, and nothing else of that file, whoever wrote it.
    ///
    /// # Errors
    /// When there is no report in it.
    pub fn shown_anew(html: &str) -> Result<String, ViewError> {
        let json = json_in(html).ok_or_else(|| ViewError::NoReport("it has no data".into()))?;
        let _: Shape = serde_json::from_str(json).map_err(|error| ViewError::NoReport(error.to_string()))?;
        Ok(with_json(json))
    }
}

/// What a report has: enough to tell that the text is JSON, of a report, without building any of it.
#[derive(Deserialize)]
struct Shape {
    #[serde(rename = "scene")]
    _scene: IgnoredAny,
    #[serde(rename = "arrays")]
    _arrays: IgnoredAny,
}
