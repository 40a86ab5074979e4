//! The kinds of containers, and which versions of them this build reads.

use crate::error::quoted;
use crate::{FormatError, Place};

/// A kind of container.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// The text entry `format` of such files.
    pub format: &'static str,
    /// What a person calls it, with an article.
    pub called: &'static str,
    /// The version that is written, and the newest that is read; from 1.
    pub version: u32,
}

/// A mesh with its modes: `*.model.safetensors`.
pub const MODEL: Kind = Kind { format: "sscc.model", called: "a model file", version: 1 };

/// Certificates of a model: `*.sscc.safetensors`.
/// Version 1 knew no pairs to be ignored, and no other centre, rule or exceptions than none; version 2 no pair tree;
/// that of version 3 went into small nodes, and is not read.
pub const CERTIFICATES: Kind = Kind { format: "sscc.certificates", called: "a certificate file", version: 4 };

impl Kind {
    /// Checks the text entries `format` and `version`; gives the version.
    pub(super) fn check(self, format: &str, version: &str) -> Result<u32, FormatError> {
        if format != self.format {
            let found = match [MODEL, CERTIFICATES].iter().find(|kind| kind.format == format) {
                Some(kind) => kind.called.to_owned(),
                None => format!("a file of the kind {}", quoted(format)),
            };
            return Err(FormatError::whole(format!("this is {found}, {} was expected", self.called)));
        }
        match version.parse::<u32>() {
            Ok(number) if number > self.version => Err(FormatError::whole(format!(
                "written by a newer sscc (format version {number}, this build reads up to {}): update sscc",
                self.version
            ))),
            Ok(number) if number > 0 && number.to_string() == version => Ok(number),
            _ => {
                let cause = format!("{} is no version number", quoted(version));
                Err(FormatError::new(Place::Key("version".into()), cause))
            }
        }
    }
}
