//! Lists the files of a folder that have a mesh.

use std::path::{Path, PathBuf};

use crate::IoError;
use crate::file::ending;
use crate::folder_files::list_files;
use crate::gltf::is_gltf;
use crate::mesh::is_mesh_name;
use crate::solid::is_solid_name;
use crate::solid::tetgen::companion;

/// Lists the meshes, solids and glTF files of a folder, in natural order: `9.obj` comes before `10.obj`. It lists a TetGen
/// solid by its `.node` file alone. Other files, among them models with modes, hidden files and folders are skipped.
///
/// # Errors
/// When the folder cannot be read, or has no such file.
pub fn list_mesh_files(folder: &Path) -> Result<Vec<PathBuf>, IoError> {
    let is_second = |path: &Path| ending(path) == "ele" && companion(path, "node").is_file();
    let has_mesh = |path: &Path| is_mesh_name(path) || is_gltf(path) || is_solid_name(path);
    let files = list_files(folder, |path| has_mesh(path) && !is_second(path))?;
    if files.is_empty() {
        let cause = "there is no mesh, solid or glTF file in this folder (folders in it are not searched)";
        return Err(IoError::request(folder, cause));
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_lists_its_meshes_in_natural_order() {
        let directory = tempfile::tempdir().unwrap();
        let folder = directory.path();
        let message = || list_mesh_files(folder).unwrap_err().to_string();
        assert!(message().contains("there is no mesh, solid or glTF file in this folder"), "{}", message());
        for name in
            ["10.obj", "9.STL", "a.node", "a.ele", "b.ele", "c.veg", "d.glb", "notes.txt", ".e.obj", "f.npz"]
        {
            std::fs::write(folder.join(name), "").unwrap();
        }
        std::fs::create_dir(folder.join("g.obj")).unwrap();
        let expected = ["9.STL", "10.obj", "a.node", "b.ele", "c.veg", "d.glb"].map(|name| folder.join(name));
        assert_eq!(list_mesh_files(folder).unwrap(), expected);
        // A pair in capitals is one solid, too.
        for name in ["B.NODE", "B.ELE"] {
            std::fs::write(folder.join(name), "").unwrap();
        }
        let listed = list_mesh_files(folder).unwrap();
        assert!(
            listed.contains(&folder.join("B.NODE")) && !listed.contains(&folder.join("B.ELE")),
            "{listed:?}"
        );
        let missing = list_mesh_files(&folder.join("none")).unwrap_err().to_string();
        assert!(missing.ends_with("none: not found"), "{missing}");
    }
}
