//! Reads an animation from a folder of meshes with the same faces.

use std::fs;
use std::path::{Path, PathBuf};

use glam::DVec3;
use sscc::TriMesh;

use super::folder::{is_member_name, mesh_files, positions_like};
use crate::error::shown_name;
use crate::solid::vtk::{Displacement, is_vtk_name, read_surface};
use crate::{IoError, read_mesh_with_warnings};

/// Frames of an animation.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Frames {
    /// First frame, as a mesh.
    pub mesh: TriMesh,
    /// Positions of all vertices in each frame, including the first one.
    pub positions: Vec<Vec<DVec3>>,
    /// Path of the file of each frame.
    pub paths: Vec<PathBuf>,
    /// Lines about content of the first frame whose meaning is not clear.
    pub warnings: Vec<String>,
}

/// Reads every mesh file and every grid of VTK of a folder, in the natural order of their names without endings, so
/// `9.obj` comes before `10.obj`, and `walk.obj` before `walk-1.obj`. The points of a grid are moved by its
/// displacements. Folders, hidden files and files without a mesh are skipped.
///
/// # Errors
/// When the folder cannot be read, has no mesh or more than 10,000, or has a solid or a glTF file, which cannot be a frame
/// and would be missing; when a mesh cannot be read, has another number of vertices or faces other than those of the first
/// one (a mesh file may have none), or a coordinate that is not finite or beyond [`sscc::limits::LARGEST`].
pub fn read_frames(folder: &Path) -> Result<Frames, IoError> {
    let paths = frame_files(folder, None)?;
    let (mesh, warnings) = read_first(&paths[0])?;
    let first = format!("the first one ({})", shown_name(&paths[0]));
    let mut positions = vec![mesh.rest_positions().to_vec()];
    for path in &paths[1..] {
        positions.push(positions_like(path, &mesh, "frame", &first)?);
    }
    Ok(Frames { mesh, positions, paths, warnings })
}

/// Reads the mesh of the first frame. The mesh of a grid of VTK is its surface, moved by its displacements.
fn read_first(path: &Path) -> Result<(TriMesh, Vec<String>), IoError> {
    if is_vtk_name(path) { read_surface(path, &Displacement::ByName) } else { read_mesh_with_warnings(path) }
}

/// Returns the mesh files of a folder, in natural order; at least one. The mesh that the frames move is no gap among them, if it
/// cannot be a frame.
pub(super) fn frame_files(folder: &Path, moved: Option<&Path>) -> Result<Vec<PathBuf>, IoError> {
    let moved = moved.filter(|path| !is_member_name(path)).and_then(|path| fs::canonicalize(path).ok());
    mesh_files(folder, moved.as_deref(), "frame")
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

    #[test]
    fn frames_are_read_in_the_order_of_their_names() {
        let directory = tempfile::tempdir().unwrap();
        let folder = directory.path();
        let put = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
        put("b.obj", FRAME);
        put("a.off", "OFF\n3 1 0\n0 0 0\n1 2 0\n0 1 0\n3 0 1 2\n");
        put("c10.obj", "v 0 0 0\nv 3 0 0\nv 0 1 0\n");
        put("c9.obj", "v 0 0 0\nv 2 0 0\nv 0 1 0\n");
        put("notes.txt", "x");
        let frames = read_frames(folder).unwrap();
        assert_eq!(frames.mesh.faces(), [[0, 1, 2]]);
        let second: Vec<DVec3> = frames.positions.iter().map(|frame| frame[1]).collect();
        assert_eq!(second, [DVec3::new(1.0, 2.0, 0.0), DVec3::X, DVec3::X * 2.0, DVec3::X * 3.0]);
        assert_eq!(frames.paths, ["a.off", "b.obj", "c9.obj", "c10.obj"].map(|name| folder.join(name)));
    }

    #[test]
    fn usual_numbering_schemes_are_in_order() {
        let schemes: [&[&str]; 10] = [
            &["walk.obj", "walk-1.obj", "walk-2.obj", "walk-10.obj"],
            &["frame_1.obj", "frame_2.obj", "frame_9.obj", "frame_10.obj", "frame_100.obj"],
            &["001.obj", "002.obj", "010.obj", "100.obj"],
            &["a.obj", "a-1.obj", "a-2.obj", "a-11.obj"],
            &["a.obj", "a(1).obj", "a(2).obj", "a(10).obj"],
            &["a.obj", "a (1).obj", "a (2).obj", "a (10).obj"],
            &["a.obj", "a.1.obj", "a.2.obj", "a.10.obj", "a.010.obj.obj"],
            &["Walk_1.obj", "walk_2.OBJ", "WALK_10.obj", "walk_11.obj"],
            &["a1.obj", "a1.off", "a2.obj", "b1.obj"],
            &["mesh 1 of 20.obj", "mesh 2 of 20.obj", "mesh 12 of 20.obj"],
        ];
        for names in schemes {
            let directory = tempfile::tempdir().unwrap();
            names.iter().rev().for_each(|name| std::fs::write(directory.path().join(name), FRAME).unwrap());
            let found: Vec<String> = frame_files(directory.path(), None)
                .unwrap()
                .iter()
                .map(|path| path.file_name().unwrap().to_string_lossy().into_owned())
                .collect();
            assert_eq!(found, names);
        }
    }

    /// The mesh that the frames move can be in their folder: a solid there is no gap, and one that can be a frame is one.
    #[test]
    fn the_moved_mesh_in_the_folder_is_no_gap() {
        let directory = tempfile::tempdir().unwrap();
        let at = |name: &str| directory.path().join(name);
        ["1.obj", "2.obj", "rest.msh"].iter().for_each(|name| fs::write(at(name), FRAME).unwrap());
        let count =
            |moved: Option<&str>| frame_files(directory.path(), moved.map(at).as_deref()).map(|f| f.len());
        assert_eq!(count(Some("rest.msh")).unwrap(), 2);
        assert_eq!(count(Some("../none.msh")).unwrap_err().to_string(), count(None).unwrap_err().to_string());
        assert!(count(None).unwrap_err().to_string().contains("rest.msh is no frame"));
        fs::remove_file(at("rest.msh")).unwrap();
        assert_eq!(count(Some("1.obj")).unwrap(), 2);
    }

    /// A frame has the triangles of the first frame, even if the fan of a polygon would triangulate it in this frame.
    #[test]
    fn frames_keep_the_triangles_of_the_first_one() {
        let directory = tempfile::tempdir().unwrap();
        let frame =
            |notch: &str| format!("v 0 0 0\nv 4 0 0\nv 4 4 0\nv {notch} 0\nv 0 4 0\nf 1 2 3 4 5\nf 1 2 3\n");
        std::fs::write(directory.path().join("1.obj"), frame("2 1")).unwrap();
        std::fs::write(directory.path().join("2.obj"), frame("2 5")).unwrap();
        let frames = read_frames(directory.path()).unwrap();
        assert_eq!(frames.positions[1][3], DVec3::new(2.0, 5.0, 0.0));
        let other = frame("2 5").replace("f 1 2 3 4 5", "f 1 2 3 5 4");
        std::fs::write(directory.path().join("2.obj"), other).unwrap();
        let message = read_frames(directory.path()).unwrap_err().to_string();
        assert!(message.contains("2.obj: triangle 0 (counted from 0) of this frame differs"), "{message}");
    }

    #[test]
    fn errors_name_the_file_that_differs() {
        let directory = tempfile::tempdir().unwrap();
        let folder = directory.path();
        let message = || read_frames(folder).unwrap_err().to_string();
        let none = "there is no frame mesh in this folder: frames are .obj, .off, .ply, .stl, .vtu or .vtk";
        assert!(message().ends_with(none), "{}", message());
        std::fs::write(folder.join("a.obj"), FRAME).unwrap();
        let with = |text: &str| {
            std::fs::write(folder.join("b.obj"), text).unwrap();
            message()
        };
        let more = with(&format!("{FRAME}v 0 0 0\n"));
        assert!(more.ends_with("b.obj: this frame has 4 vertices, the first one (a.obj) has 3"), "{more}");
        let reordered = with(&FRAME.replace("f 1 2 3", "f 2 3 1"));
        assert!(
            reordered.contains("b.obj: triangle 0 (counted from 0) of this frame differs from the first")
        );
        assert!(with("v 1").contains("b.obj: line 1: "));
        std::fs::write(folder.join("a.obj"), "v 0 0 0\n").unwrap();
        assert!(message().ends_with("a.obj: the mesh has no triangles"), "{}", message());
        assert!(read_frames(&folder.join("c")).unwrap_err().to_string().ends_with("c: not found"));
    }
}
