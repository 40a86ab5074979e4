//! The target of a `.pvd` collection. Only the files of an earlier collection may be replaced.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use crate::error::quoted;
use crate::file::{check_target, folder, not_written};
use crate::modes::{is_collection, read_collection};
use crate::{IoError, split_mesh_name};

/// The files of a collection.
pub(crate) struct Target {
    pub path: PathBuf,
    /// Folder of its files.
    pub folder: PathBuf,
    /// Name of the folder.
    pub name: String,
}

impl Target {
    /// # Errors
    /// When the name is no text, or does not end in `.pvd`.
    pub fn new(path: &Path) -> Result<Self, IoError> {
        let folder = path.with_extension("");
        let name = folder.file_name().and_then(|name| name.to_str()).filter(|_| is_collection(path));
        let Some(name) = name.map(str::to_owned) else {
            return Err(IoError::request(
                path,
                "the name of a collection must be text in UTF-8 and end in .pvd",
            ));
        };
        Ok(Self { path: path.to_owned(), folder, name })
    }

    /// Returns an error if the collection cannot be written, if its folder is no folder or has anything but the files of
    /// an earlier collection, or if that collection cannot be read: other files would be lost.
    pub fn check(&self) -> Result<(), IoError> {
        check_target(&self.path)?;
        let refused = |cause| not_written(&self.folder, cause);
        match fs::symlink_metadata(&self.folder) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
            Err(error) => return Err(refused(error)),
            Ok(found) if found.is_dir() => {}
            Ok(_) => {
                let cause = "is not a folder, which the files of the collection need: move it away, or choose another name";
                return Err(IoError::request(&self.folder, cause));
            }
        }
        let read = match read_collection(&self.path) {
            Err(IoError::NotFound { .. }) => Ok(Vec::new()),
            read => read,
        };
        for entry in fs::read_dir(&self.folder).map_err(refused)? {
            let entry = entry.map_err(refused)?;
            let name = entry.file_name();
            let file = folder(&self.path).join(&self.name).join(&name);
            let named = match &read {
                Ok(named) => named,
                Err(error) => {
                    let cause = format!(
                        "contains {}, and the collection cannot be read ({error}): move both away, or choose another name",
                        quoted(&name.to_string_lossy())
                    );
                    return Err(IoError::request(&self.folder, cause));
                }
            };
            let is_own = entry.file_type().is_ok_and(|kind| kind.is_file())
                && self.is_frame_name(&name.to_string_lossy())
                && named.iter().any(|named| named.file == file);
            if !is_own {
                let cause = format!(
                    "contains {}, which is not a file of an earlier collection {}: move it away, or choose another name",
                    quoted(&name.to_string_lossy()),
                    quoted(&format!("{}.pvd", self.name))
                );
                return Err(IoError::request(&self.folder, cause));
            }
        }
        Ok(())
    }

    fn is_frame_name(&self, name: &str) -> bool {
        let number = name.strip_prefix(&self.name).and_then(|rest| rest.strip_prefix('_'));
        let number = number.and_then(|rest| rest.strip_suffix(".vtu"));
        number.is_some_and(|digits| digits.len() >= 6 && digits.bytes().all(|byte| byte.is_ascii_digit()))
    }

    /// Whether an input is in the folder, or names files in it.
    pub fn has_files_of(&self, input: &Path) -> bool {
        let Ok(folder) = fs::canonicalize(&self.folder) else { return false };
        let is_within = |file: &Path| fs::canonicalize(file).is_ok_and(|file| file.starts_with(&folder));
        let (file, _) = split_mesh_name(input);
        let names =
            || read_collection(&file).is_ok_and(|files| files.iter().any(|named| is_within(&named.file)));
        is_within(&file) || is_collection(&file) && names()
    }
}
