//! Reports: the page with all its data in one file.

use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use crate::page::{allowing_modules, json_in, with_data, with_json};
use crate::{Arrays, Checks, Scene, ViewError};

/// A report: a scene and its arrays.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// The scene.
    pub scene: Scene,
    /// The arrays that the scene names.
    pub arrays: Arrays,
    /// The data with which the report checks q itself. If None, it shows only recorded results and proofs by the root's radius.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub checks: Option<Checks>,
}

impl Report {
    /// Returns the report as one HTML file, which loads no other file.
    ///
    /// # Errors
    /// If a value cannot be written as JSON. The types of a scene exclude this.
    pub fn html(&self) -> serde_json::Result<String> {
        let html = with_data(self)?;
        Ok(if self.checks.is_some() { allowing_modules(html) } else { html })
    }

    /// Returns this program's page with the data of the report `html`. All other parts of `html` are dropped, since
    /// another program may have written them.
    ///
    /// # Errors
    /// If `html` contains no report, or a report with a program.
    pub fn rebuild(html: &str) -> Result<String, ViewError> {
        let json = json_in(html).ok_or_else(|| ViewError::NotAReport("it has no data".into()))?;
        let keys: ReportKeys =
            serde_json::from_str(json).map_err(|error| ViewError::NotAReport(error.to_string()))?;
        if keys.checks.is_some() {
            let advice = "it has a program to check shapes; open it in a browser if you trust its source";
            return Err(ViewError::NotAReport(advice.into()));
        }
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
    checks: Option<IgnoredAny>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_with_a_program_is_not_rebuilt() {
        let html = |json: &str| with_json(json);
        assert!(Report::rebuild(&html("{\"scene\":{},\"arrays\":{}}")).is_ok());
        assert!(Report::rebuild(&html("{\"scene\":{},\"arrays\":{},\"checks\":null}")).is_ok());
        for json in [
            "{\"scene\":{},\"arrays\":{},\"checks\":{\"script\":\"alert(1)\"}}",
            "{\"scene\":{},\"arrays\":{},\"\\u0063hecks\":{}}",
            "{\"scene\":{},\"arrays\":{},\"checks\":null,\"checks\":{}}",
        ] {
            assert!(Report::rebuild(&html(json)).is_err(), "{json}");
        }
    }

    #[test]
    fn only_reports_that_check_may_run_modules() {
        let scene = Scene::new("a");
        let plain = Report { scene, arrays: Arrays::default(), checks: None }.html().unwrap();
        let allowed = "script-src 'unsafe-inline' 'wasm-unsafe-eval'";
        assert!(!plain.contains("wasm-unsafe-eval'"));
        // The policy of reports, and the policy of the page.
        assert_eq!(allowing_modules(plain).matches(allowed).count(), 2);
    }
}
