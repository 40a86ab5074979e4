//! A TOML file with the line numbers of its values.

use std::fs;
use std::ops::Range;
use std::path::Path;

use toml::de::DeTable;

/// A file below the root of the workspace.
pub struct TomlFile {
    /// Its path, relative to the root.
    pub path: String,
    text: String,
}

impl TomlFile {
    /// Reads the file; the error names it.
    pub fn read(root: &Path, path: &str) -> Result<Self, String> {
        let text = fs::read_to_string(root.join(path)).map_err(|error| format!("{path}: {error}"))?;
        Ok(Self { path: path.to_owned(), text })
    }

    /// Parses the file; the error names file and line.
    pub fn parse(&self) -> Result<DeTable<'_>, String> {
        let parsed = DeTable::parse(&self.text);
        parsed.map(toml::Spanned::into_inner).map_err(|error| {
            let line = self.line(error.span().unwrap_or_default());
            format!("{}:{line}: {}", self.path, error.message())
        })
    }

    /// Returns the line on which a value begins, counted from 1.
    pub fn line(&self, span: Range<usize>) -> usize {
        1 + self.text.bytes().take(span.start).filter(|byte| *byte == b'\n').count()
    }
}
