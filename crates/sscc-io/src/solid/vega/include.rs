//! Included files of a `.veg` file.

use std::path::{Component, Path, PathBuf};

use sscc_solid::VolumeMesh;

use super::parser::Parser;
use crate::error::{cut, quoted};
use crate::file::{check_exists, read_whole};
use crate::solid::statements::statements;
use crate::{FormatError, IoError, Place};

/// Maximum depth of included files.
const MAX_DEPTH: usize = 8;

/// Maximum number of included files.
const MAX_FILES: usize = 64;

/// Parses a `.veg` file without `*INCLUDE`.
///
/// # Errors
/// When there is an `*INCLUDE`, a section is unknown, out of place, repeated or does not match its count, numbers are not
/// consecutive, or a material is malformed or unknown; else as [`read_volume_mesh`](crate::read_volume_mesh).
pub fn parse(bytes: &[u8]) -> Result<VolumeMesh, FormatError> {
    let mut parser = Parser::default();
    for statement in statements(bytes)? {
        let (line, text) = statement?;
        if included(text).is_some() {
            return Err(FormatError::line(line, "*INCLUDE refers to a file: read this file by its path"));
        }
        parser.statement(text, &Place::Line(line))?;
    }
    parser.finish()
}

/// Reads a `.veg` file and the files that it includes.
///
/// # Errors
/// As [`parse`], except for `*INCLUDE`; also when an included file cannot be read, is not in the folder of the file or
/// below, is included twice, or there are too many. Errors in the content of an included file, and for one that does not
/// exist, name both files. Other errors of reading an included file (it is empty or a folder) name that file alone.
pub fn read(path: &Path) -> Result<VolumeMesh, IoError> {
    let mut reader = Reader { main: path, seen: Vec::new(), parser: Parser::default() };
    reader.feed(&read_whole(path)?, None, 0)?;
    reader.parser.finish().map_err(|error| error.of(path))
}

struct Reader<'a> {
    main: &'a Path,
    /// Names of the files included so far.
    seen: Vec<PathBuf>,
    parser: Parser,
}

impl Reader<'_> {
    /// Parses the lines of the main file, or of an included file of that name.
    fn feed(&mut self, bytes: &[u8], name: Option<&str>, depth: usize) -> Result<(), IoError> {
        let main = self.main;
        let within = |error: FormatError| match (name, error.place()) {
            (None, _) => error.of(main),
            (Some(name), Place::Line(line)) => {
                FormatError::part(at(name, *line), error.cause().clone()).of(main)
            }
            (Some(name), _) => FormatError::part(cut(name, 60), error.to_string()).of(main),
        };
        for statement in statements(bytes).map_err(within)? {
            let (line, text) = statement.map_err(within)?;
            let Some(file) = included(text) else {
                let place = name.map_or(Place::Line(line), |name| Place::Part(at(name, line)));
                self.parser.statement(text, &place).map_err(|error| error.of(main))?;
                continue;
            };
            let path = self.check(file, depth).map_err(|cause| within(FormatError::line(line, cause)))?;
            self.seen.push(path.clone());
            let path = main.parent().unwrap_or(Path::new("")).join(path);
            if check_exists(&path).is_err() {
                let cause = format!("the file includes {}, which does not exist", quoted(file));
                return Err(within(FormatError::line(line, cause)));
            }
            self.feed(&read_whole(&path)?, Some(file), depth + 1)?;
        }
        Ok(())
    }

    /// Returns the path below the main file's folder, or the cause of the error.
    fn check(&self, file: &str, depth: usize) -> Result<PathBuf, String> {
        let path: PathBuf = Path::new(file).components().filter(|c| *c != Component::CurDir).collect();
        let below = path.components().all(|c| matches!(c, Component::Normal(_)));
        if !below || path.as_os_str().is_empty() || file.contains(['\\', ':']) {
            return Err(format!("{} is not a file in the same folder or below", quoted(file)));
        }
        if self.seen.contains(&path) || Some(path.as_os_str()) == self.main.file_name() {
            return Err(format!("{} is included a second time", quoted(file)));
        }
        if depth == MAX_DEPTH || self.seen.len() == MAX_FILES {
            return Err(format!(
                "too many included files: at most {MAX_FILES} are allowed, at a depth of at most {MAX_DEPTH}"
            ));
        }
        Ok(path)
    }
}

fn at(name: &str, line: usize) -> String {
    format!("{}: line {line}", cut(name, 60))
}

/// Returns the file named by an `*INCLUDE`.
fn included(text: &str) -> Option<&str> {
    let name = text.strip_prefix("*INCLUDE")?;
    (name.is_empty() || name.starts_with(|c: char| c.is_ascii_whitespace())).then(|| name.trim_ascii())
}
