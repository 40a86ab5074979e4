//! Reads an animation from a folder of meshes with the same faces.

use std::path::{Path, PathBuf};

use glam::DVec3;
use sscc::TriMesh;

use super::folder::{mesh_files, positions_like};
use crate::{IoError, natural_order, read_mesh};

/// Frames of an animation.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Frames {
    /// First frame, as a mesh.
    pub mesh: TriMesh,
    /// Positions of all vertices in each frame, including the first one.
    pub positions: Vec<Vec<DVec3>>,
    /// File name of each frame.
    pub paths: Vec<PathBuf>,
}

/// Reads every mesh file of a folder, in the natural order of their names, so `9.obj` comes before `10.obj`. Other
/// files, folders and hidden files are skipped.
///
/// # Errors
/// When the folder cannot be read, or has no mesh in it or more than 10,000; when a mesh cannot be read, has another
/// number of vertices or faces other than the first one's (it may have none), or a coordinate that is not finite or too
/// large.
pub fn read_frames(folder: &Path) -> Result<Frames, IoError> {
    let paths = frame_files(folder)?;
    let mesh = read_mesh(&paths[0])?;
    let first = format!("the first one ({})", paths[0].file_name().unwrap_or_default().display());
    let mut positions = vec![mesh.rest_positions().to_vec()];
    for path in &paths[1..] {
        positions.push(positions_like(path, &mesh, "frame", &first)?);
    }
    Ok(Frames { mesh, positions, paths })
}

/// Returns the mesh files of a folder, in natural order; at least one.
pub(super) fn frame_files(folder: &Path) -> Result<Vec<PathBuf>, IoError> {
    let mut paths = mesh_files(folder, None, "frame")?;
    fn name(path: &Path) -> &[u8] {
        path.file_name().unwrap_or_default().as_encoded_bytes()
    }
    paths.sort_by(|a, b| natural_order::compare(name(a), name(b)));
    Ok(paths)
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
    fn errors_name_the_file_that_differs() {
        let directory = tempfile::tempdir().unwrap();
        let folder = directory.path();
        let message = || read_frames(folder).unwrap_err().to_string();
        assert!(message().ends_with("there is no frame mesh in this folder"));
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
