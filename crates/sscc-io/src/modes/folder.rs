//! Reads modes from a folder of target meshes.

use std::fs;
use std::path::{Path, PathBuf};

use glam::DVec3;
use sscc::{Modes, TriMesh, limits};

use super::named_modes::NamedModes;
use super::vtk_frames;
use crate::error::shown_name;
use crate::folder_files::list_files;
use crate::gltf::is_gltf;
use crate::mesh::{is_mesh_name, read_soup};
use crate::solid::is_solid_name;
use crate::solid::tetgen::other_of_pair;
use crate::solid::vtk::{Displacement, is_vtk_name};
use crate::{FormatError, IoError};

/// Maximum number of meshes in a folder.
const MAX_MESHES: usize = 10_000;

/// Endings of the files that are targets or frames.
const ENDINGS: &str = ".obj, .off, .ply, .stl, .vtu or .vtk";

/// Reads the targets of a neutral mesh: every mesh file and every grid of VTK in the folder, ordered by the bytes of
/// their names, so `10.obj` comes before `9.obj`. The points of a grid are moved by its displacements. Mode k is target
/// k minus the neutral mesh, each difference rounded to f64. Names are those of the files, without endings.
///
/// Folders, hidden files, the neutral mesh itself, and files without a mesh are skipped.
///
/// # Errors
/// When the folder cannot be read, has no target or more than 10,000, or has a solid or a glTF file, which cannot be one and
/// would be missing; when a target cannot be read, has another number of vertices, has faces that differ from the neutral
/// ones (a mesh file may have none), or has a coordinate that is not finite or beyond [`limits::LARGEST`].
pub fn read(folder: &Path, neutral: &TriMesh, neutral_path: &Path) -> Result<NamedModes, IoError> {
    let request = |cause: String| IoError::request(folder, cause);
    // The neutral mesh may have another path (links, `..`).
    let mut paths = mesh_files(folder, fs::canonicalize(neutral_path).ok().as_deref(), "target")?;
    paths.sort_by(|a, b| a.as_os_str().as_encoded_bytes().cmp(b.as_os_str().as_encoded_bytes()));
    let rest = neutral.rest_positions();
    let displacements = |path: &PathBuf| {
        let mut positions = positions_like(path, neutral, "target", "the neutral mesh")?;
        positions.iter_mut().zip(rest).for_each(|(moved, rest)| *moved -= rest);
        Ok::<_, IoError>(positions)
    };
    // The file of a target bounds its memory: it contains all vertices.
    let columns = paths.iter().map(displacements).collect::<Result<Vec<_>, _>>()?;
    let vertices = rest.len();
    let by_vertex = (0..vertices).flat_map(|v| columns.iter().map(move |column| column[v])).collect();
    let modes = Modes::new(columns.len(), by_vertex).map_err(|error| request(error.to_string()))?;
    let name = |path: &PathBuf| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(NamedModes { modes, names: paths.iter().map(name).collect(), deviations: None })
}

/// Whether the ending is that of a file with a mesh.
pub(crate) fn has_mesh(path: &Path) -> bool {
    is_mesh_name(path) || is_gltf(path) || is_solid_name(path)
}

/// Whether the ending is that of a target or a frame.
pub(crate) fn is_member_name(path: &Path) -> bool {
    is_mesh_name(path) || is_vtk_name(path)
}

/// Returns the mesh files of a folder without the neutral one (its canonical path), in natural order; at least one. `what`
/// names them in messages.
///
/// # Errors
/// When the folder cannot be read, has no mesh file or more than [`MAX_MESHES`], or has another file with a mesh: without it
/// the sequence would have a gap.
pub(crate) fn mesh_files(folder: &Path, neutral: Option<&Path>, what: &str) -> Result<Vec<PathBuf>, IoError> {
    // A solid of TetGen has two files.
    let second = neutral.and_then(other_of_pair).and_then(|second| fs::canonicalize(second).ok());
    let of_neutral: Vec<&Path> = neutral.into_iter().chain(second.as_deref()).collect();
    let is_neutral = |path: &Path| {
        !of_neutral.is_empty()
            && fs::canonicalize(path).is_ok_and(|path| of_neutral.contains(&path.as_path()))
    };
    let paths = list_files(folder, |path| has_mesh(path) && !is_neutral(path))?;
    let request = |cause: String| Err(IoError::request(folder, cause));
    if let Some(other) = paths.iter().find(|path| !is_member_name(path)) {
        let name = shown_name(other);
        return request(format!("{name} is no {what}: {what}s are {ENDINGS}; convert it or move it away"));
    }
    match paths.len() {
        0 => request(format!("there is no {what} mesh in this folder: {what}s are {ENDINGS}")),
        count if count > MAX_MESHES => {
            request(format!("the folder has {count} {what} meshes: at most {MAX_MESHES} are allowed"))
        }
        _ => Ok(paths),
    }
}

/// Returns the positions of a mesh with the same number of vertices, and the same faces or none.
pub(crate) fn positions_like(
    path: &Path,
    model: &TriMesh,
    what: &str,
    other: &str,
) -> Result<Vec<DVec3>, IoError> {
    if is_vtk_name(path) {
        return vtk_frames::positions_like(path, &Displacement::ByName, model, what, other);
    }
    let read = read_soup(path)?;
    let refused = |cause: String| Err(FormatError::whole(cause).of(path));
    let (found, expected) = (read.positions.len(), model.rest_positions().len());
    if found != expected {
        return refused(format!("this {what} has {found} vertices, {other} has {expected}"));
    }
    // The triangles of the model are kept even if a polygon would be cut in another way at the positions of this mesh.
    if !read.fans.is_empty()
        && let Err(face) = read.has_polygons_of(model.faces())
    {
        let (found, expected) = (read.fans.len(), model.faces().len());
        let cause = if found == expected {
            format!("triangle {face} (counted from 0) of this {what}")
        } else {
            format!("the number of triangles, {found} for {expected},")
        };
        return refused(format!("{cause} differs from {other}: are the vertices in the same order?"));
    }
    if let Some(vertex) = read.positions.iter().position(|p| !limits::contains(*p)) {
        return refused(format!("vertex {vertex} (counted from 0) is not finite, or too large"));
    }
    Ok(read.positions)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NEUTRAL: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

    #[test]
    fn targets_are_modes_in_the_order_of_their_names() {
        let directory = tempfile::tempdir().unwrap();
        let folder = directory.path();
        let put = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
        put("neutral.obj", NEUTRAL);
        put("b.obj", &NEUTRAL.replace("v 1 0 0", "v 1 0 3"));
        put("B.off", "OFF\n3 1 0\n0 0 0\n1 2 0\n0 1 0\n3 0 1 2\n");
        put("10.obj", "v 0 0 0\nv 2 0 0\nv 0 1 0\n");
        put("readme.txt", "x");
        put(".hidden.obj", "x");
        fs::create_dir(folder.join("folder.obj")).unwrap();
        let path = folder.join("neutral.obj");
        let mesh = crate::read_mesh(&path).unwrap();
        let NamedModes { modes, names, .. } = read(folder, &mesh, &path).unwrap();
        assert_eq!(names, ["10", "B", "b"]);
        assert_eq!(modes.of_vertex(0), [DVec3::ZERO; 3]);
        assert_eq!(modes.of_vertex(1), [DVec3::X, DVec3::Y * 2.0, DVec3::Z * 3.0]);

        // In another folder the neutral mesh is an ordinary target.
        let NamedModes { modes, names, .. } = read(folder, &mesh, Path::new("elsewhere.obj")).unwrap();
        assert_eq!((modes.rank(), names[3].as_str()), (4, "neutral"));
    }

    #[test]
    fn errors_name_the_file_that_differs() {
        let directory = tempfile::tempdir().unwrap();
        let folder = directory.path();
        let mesh = crate::mesh::obj::parse(NEUTRAL.as_bytes()).unwrap();
        let message = || read(folder, &mesh, Path::new("none")).unwrap_err().to_string();
        let none = "there is no target mesh in this folder: targets are .obj, .off, .ply, .stl, .vtu or .vtk";
        assert!(message().ends_with(none), "{}", message());
        fs::write(folder.join("a.obj"), NEUTRAL).unwrap();
        let with = |text: &str| {
            fs::write(folder.join("b.obj"), text).unwrap();
            message()
        };
        let more = with(&format!("{NEUTRAL}v 0 0 0\n"));
        assert!(more.ends_with("b.obj: this target has 4 vertices, the neutral mesh has 3"), "{more}");
        let reordered = with(&NEUTRAL.replace("f 1 2 3", "f 2 3 1"));
        assert!(
            reordered.contains("b.obj: triangle 0 (counted from 0) of this target differs"),
            "{reordered}"
        );
        assert!(with(&format!("{NEUTRAL}f 1 2 3\n")).contains("number of triangles, 2 for 1, differs"));
        assert!(with(&NEUTRAL.replace("v 1", "v 1e70")).contains("b.obj: vertex 1 (counted from 0)"));
        assert!(with("v 1").contains("b.obj: line 1: "));
        let missing = read(&folder.join("c"), &mesh, Path::new("none")).unwrap_err().to_string();
        assert!(missing.ends_with("c: not found"));
    }

    #[test]
    fn other_files_with_a_mesh_are_refused() {
        for other in ["2.glb", "2.GLTF", "2.vrm", "2.mesh", "2.msh", "2.veg", "2.node", "2.ele"] {
            let directory = tempfile::tempdir().unwrap();
            let folder = directory.path();
            fs::write(folder.join(other), "").unwrap();
            let cause = |what: &str| {
                format!(
                    "{other} is no {what}: {what}s are .obj, .off, .ply, .stl, .vtu or .vtk; convert it or move it away"
                )
            };
            let message = |what: &str| mesh_files(folder, None, what).unwrap_err().to_string();
            assert!(message("frame").ends_with(&cause("frame")), "{}", message("frame"));
            for name in ["1.obj", "3.obj"] {
                fs::write(folder.join(name), NEUTRAL).unwrap();
            }
            assert!(message("frame").ends_with(&cause("frame")), "{}", message("frame"));
            let mesh = crate::mesh::obj::parse(NEUTRAL.as_bytes()).unwrap();
            let of_targets = read(folder, &mesh, &folder.join("1.obj")).unwrap_err().to_string();
            assert!(of_targets.ends_with(&cause("target")), "{of_targets}");
        }
    }

    #[test]
    fn files_without_a_mesh_lie_beside_targets() {
        let directory = tempfile::tempdir().unwrap();
        let folder = directory.path();
        fs::write(folder.join("a.obj"), NEUTRAL).unwrap();
        for name in [
            "a.mtl",
            "a.png",
            "a.txt",
            "a.npy",
            "a.npz",
            "a.pc2",
            "a.pvd",
            "a.bin",
            "a.model.safetensors",
            "a.sscc.safetensors",
            ".b.glb",
            "mesh",
        ] {
            fs::write(folder.join(name), "x").unwrap();
        }
        fs::create_dir(folder.join("c.glb")).unwrap();
        assert_eq!(mesh_files(folder, None, "frame").unwrap(), [folder.join("a.obj")]);
    }

    /// A solid may be the neutral mesh of targets beside it; TetGen writes two files.
    #[test]
    fn the_neutral_mesh_may_be_a_solid() {
        for files in [&["n.mesh"][..], &["n.node", "n.ele"], &["n.ele", "n.NODE"]] {
            let directory = tempfile::tempdir().unwrap();
            let folder = directory.path();
            for name in files.iter().chain(&["a.obj"]) {
                fs::write(folder.join(name), NEUTRAL).unwrap();
            }
            let mesh = crate::mesh::obj::parse(NEUTRAL.as_bytes()).unwrap();
            let NamedModes { names, .. } = read(folder, &mesh, &folder.join(files[0])).unwrap();
            assert_eq!(names, ["a"], "{files:?}");
            let elsewhere = read(folder, &mesh, Path::new("elsewhere.node")).unwrap_err().to_string();
            assert!(elsewhere.contains(" is no target: "), "{elsewhere}");
        }
    }
}
