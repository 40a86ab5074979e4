//! Lists the files of a folder that have a mesh, and finds files among those of an input.

use std::fs;
use std::path::{Path, PathBuf};

use crate::file::{ending, folder};
use crate::folder_files::{is_hidden, list_files};
use crate::modes::{has_mesh, is_collection, read_collection};
use crate::solid::tetgen::companion;
use crate::{IoError, split_mesh_name};

/// Lists the meshes, solids and glTF files of a folder, in natural order: `9.obj` comes before `10.obj`. It lists a TetGen
/// solid by its `.node` file alone. Other files, among them models with modes, hidden files and folders are skipped.
///
/// # Errors
/// When the folder cannot be read, or has no such file.
pub fn list_mesh_files(folder: &Path) -> Result<Vec<PathBuf>, IoError> {
    let is_second = |path: &Path| ending(path) == "ele" && companion(path, "node").is_file();
    let files = list_files(folder, |path| has_mesh(path) && !is_second(path))?;
    if files.is_empty() {
        let cause = "there is no mesh, solid or glTF file in this folder (folders in it are not searched)";
        return Err(IoError::request(folder, cause));
    }
    Ok(files)
}

/// Whether an input, which may be a file, `FILE#NAME`, a folder or a `.pvd` collection, has a file: it is the input itself, a
/// mesh of the folder, or a file of the collection. `real` is the canonical path of the file ([`std::fs::canonicalize`]); links
/// of the input are followed. An input that cannot be read has no files.
pub fn has_file(input: &Path, real: &Path) -> bool {
    let is_it = |file: &Path| fs::canonicalize(file).is_ok_and(|file| file == real);
    let (input, _) = split_mesh_name(input);
    let is_listed = || list_mesh_files(&input).is_ok_and(|files| files.iter().any(|file| is_it(file)));
    let is_named = || read_collection(&input).is_ok_and(|files| files.iter().any(|named| is_it(&named.file)));
    is_it(&input) || input.is_dir() && is_listed() || is_collection(&input) && is_named()
}

/// Whether an input is the folder of a file that has the name of a mesh. The file need not exist; if it does,
/// [`list_mesh_files`] lists it.
pub fn is_folder_of_mesh(input: &Path, file: &Path) -> bool {
    let is_in = || match [folder(file), input].map(fs::canonicalize) {
        [Ok(of_file), Ok(input)] => of_file == input,
        _ => false,
    };
    has_mesh(file) && !is_hidden(file) && input.is_dir() && is_in()
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

    #[test]
    fn inputs_have_files() {
        let directory = tempfile::tempdir().unwrap();
        let folder = directory.path();
        for name in ["set", "set/more", "b"] {
            std::fs::create_dir(folder.join(name)).unwrap();
        }
        for name in ["a.glb", "set/1.obj", "set/2.vtu", "set/notes.txt", "set/more/3.obj", "b/1.vtu"] {
            std::fs::write(folder.join(name), "").unwrap();
        }
        let collection = "<VTKFile type='Collection'><Collection>\n<DataSet timestep='1' file='b/1.vtu'/>\n\
                          </Collection></VTKFile>";
        std::fs::write(folder.join("b.pvd"), collection).unwrap();
        let has = |input: &str, file: &str| {
            has_file(&folder.join(input), &std::fs::canonicalize(folder.join(file)).unwrap())
        };
        for (input, file) in [
            ("a.glb", "a.glb"),
            ("a.glb#Body", "set/../a.glb"),
            ("set", "set/1.obj"),
            ("set/more/..", "set/2.vtu"),
            ("b.pvd", "b.pvd"),
            ("b.pvd", "b/1.vtu"),
            ("b.pvd#u", "b/1.vtu"),
        ] {
            assert!(has(input, file), "{input} {file}");
        }
        for (input, file) in [
            ("set", "set/notes.txt"),
            ("set", "set/more/3.obj"),
            ("set", "a.glb"),
            ("b.pvd", "set/2.vtu"),
            ("none.pvd", "b/1.vtu"),
            ("none", "a.glb"),
        ] {
            assert!(!has(input, file), "{input} {file}");
        }
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("../a.glb", folder.join("set/link.glb")).unwrap();
            assert!(has("set", "a.glb"), "a link");
        }
    }

    #[test]
    fn folders_of_meshes_that_need_not_exist() {
        let directory = tempfile::tempdir().unwrap();
        let folder = directory.path();
        std::fs::create_dir_all(folder.join("set/more")).unwrap();
        std::fs::write(folder.join("a.obj"), "").unwrap();
        let is_folder = |input: &str, file: &str| is_folder_of_mesh(&folder.join(input), &folder.join(file));
        for (input, file) in
            [("set", "set/new.ply"), ("set/", "set/more/../NEW.OBJ"), ("set/more/..", "set/x.vtu")]
        {
            assert!(is_folder(input, file), "{input} {file}");
        }
        for (input, file) in [
            ("set", "new.ply"),
            ("set", "set/more/new.ply"),
            ("set", "set/.new.ply"),
            ("set", "set/new.npy"),
            ("set", "set/new.pvd"),
            ("set", "none/new.ply"),
            ("a.obj", "b.obj"),
            ("none", "none/b.obj"),
        ] {
            assert!(!is_folder(input, file), "{input} {file}");
        }
    }
}
