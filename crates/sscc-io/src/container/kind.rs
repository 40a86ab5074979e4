//! Kinds of containers, and the versions of them that can be read.

use crate::error::quoted;
use crate::{FormatError, Place};

/// Kind of a container.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// Text entry `format` of such files.
    pub format: &'static str,
    /// Name in messages, with an article.
    pub called: &'static str,
    /// Version that is written, and newest version that can be read; from 1.
    pub version: u32,
}

/// Mesh with its modes: `*.model.safetensors`. Version 1 has no mass properties, version 2 no standard deviations of q;
/// files without them are still written in the older version.
pub const MODEL: Kind = Kind { format: "sscc.model", called: "a model file", version: 3 };

/// Certificates of a model: `*.sscc.safetensors`. Version 1 has no ignored pairs; its files have the centre 0, the
/// default contact filter and no exceptions. Version 2 has no pair tree. The pair tree of version 3 includes pairs
/// within buckets and is not read. Version 4 has no groups of triangles, version 5 no local certificates, version 7 no
/// clearance; files without them are still written in the older version. Local certificates of version 6 have no flat
/// patches.
pub const CERTIFICATES: Kind = Kind { format: "sscc.certificates", called: "a certificate file", version: 8 };

impl Kind {
    /// Checks the text entries `format` and `version`, and returns the version.
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
                let cause = format!("{} is not a version number: create the file anew", quoted(version));
                Err(FormatError::new(Place::Key("version".into()), cause))
            }
        }
    }
}
