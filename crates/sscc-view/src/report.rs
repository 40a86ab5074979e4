//! Reports: the page with all its data in one file.

use serde::Serialize;

use crate::page::with_data;
use crate::{Arrays, Scene};

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
}
