//! Paths that name one of several meshes of a file: `FILE#NAME`.

use std::path::{Path, PathBuf};

use crate::IoError;
use crate::error::quoted;
use crate::gltf::is_gltf;

/// Splits `FILE#NAME` into the file and the name of one of its meshes. A path has no name if it is that of an
/// existing file, or if no part before a `#` is a file or has the ending of a glTF file.
pub fn split_mesh_name(path: &Path) -> (PathBuf, Option<String>) {
    let whole = || (path.to_owned(), None);
    let Some(text) = path.to_str().filter(|_| !path.exists()) else { return whole() };
    let mut splits = text.match_indices('#').map(|(at, _)| (Path::new(&text[..at]), &text[at + 1..]));
    match splits.find(|(file, _)| is_gltf(file) || file.is_file()) {
        Some((file, name)) => (file.to_owned(), Some(name.to_owned())),
        None => whole(),
    }
}

/// Returns the file of a path, and the name of the mesh in the path or beside it.
pub(crate) fn named_file(path: &Path, mesh_name: Option<&str>) -> Result<(PathBuf, Option<String>), IoError> {
    match (split_mesh_name(path), mesh_name) {
        ((file, None), name) => Ok((file, name.map(str::to_owned))),
        (named, None) => Ok(named),
        (_, Some(name)) => {
            let cause =
                format!("the mesh is named twice, here and by the name {}: leave one out", quoted(name));
            Err(IoError::request(path, cause))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_follow_the_file() {
        let directory = tempfile::tempdir().unwrap();
        let path = |name: &str| directory.path().join(name);
        for file in ["a.obj", "b#1.glb", "c#2"] {
            std::fs::write(path(file), "").unwrap();
        }
        for (typed, file, name) in [
            ("a.obj", "a.obj", None),
            ("a.obj#Body", "a.obj", Some("Body")),
            ("missing.GLB#Body#2", "missing.GLB", Some("Body#2")),
            ("x.vrm##3", "x.vrm", Some("#3")),
            ("x.gltf#", "x.gltf", Some("")),
            ("b#1.glb", "b#1.glb", None),
            ("b#1.glb#Hat", "b#1.glb", Some("Hat")),
            ("c#2#Hat", "c#2", Some("Hat")),
            ("missing.obj#Body", "missing.obj#Body", None),
        ] {
            let expected = (path(file), name.map(str::to_owned));
            assert_eq!(split_mesh_name(&path(typed)), expected, "{typed}");
        }
    }
}
