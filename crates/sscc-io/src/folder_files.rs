//! Lists the files of a folder, in natural order.

use std::fs;
use std::path::{Path, PathBuf};

use crate::IoError;
use crate::file::read_error;
use crate::natural_order;

/// Returns the files of a folder that `is_wanted`, in the natural order of their names without endings, so `9.obj` comes
/// before `10.obj`, and `walk.obj` before `walk-1.obj`. Folders and hidden files are skipped.
pub(crate) fn list_files(folder: &Path, is_wanted: impl Fn(&Path) -> bool) -> Result<Vec<PathBuf>, IoError> {
    let refused = |cause| read_error(folder, cause);
    let mut paths = Vec::new();
    for entry in fs::read_dir(folder).map_err(refused)? {
        let path = folder.join(entry.map_err(refused)?.file_name());
        if !is_hidden(&path) && is_wanted(&path) && !path.is_dir() {
            paths.push(path);
        }
    }
    // Endings are compared last, so that `walk.obj` comes before `walk-1.obj`.
    fn parts(path: &Path) -> [&[u8]; 2] {
        [path.file_stem(), path.file_name()].map(|part| part.unwrap_or_default().as_encoded_bytes())
    }
    paths.sort_by(|a, b| {
        let ([stem_a, name_a], [stem_b, name_b]) = (parts(a), parts(b));
        natural_order::compare(stem_a, stem_b).then_with(|| natural_order::compare(name_a, name_b))
    });
    Ok(paths)
}

/// Whether the name of a file begins with a dot.
pub(crate) fn is_hidden(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."))
}
