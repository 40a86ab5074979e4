//! Readers for triangle meshes: OBJ, OFF, PLY and STL.
//!
//! All vertices of the file are kept in its order, even unused ones, so that modes for the file's vertices fit.
//! A polygon becomes triangles in its place: the fan around its first corner if that triangulates it, else another
//! triangulation.

pub mod obj;
pub mod off;
pub mod ply;
pub mod stl;

use std::path::Path;

use sscc::TriMesh;

use crate::file::{ending, read_whole, unsupported};
use crate::polygons::Soup;
use crate::{FormatError, IoError};

/// Endings that [`read_mesh`] supports.
const SUPPORTED: &str = ".obj, .off, .ply, .stl";

/// Reads a triangle mesh; the ending of the file name, in any case, selects the format.
///
/// # Errors
/// When the ending is none of `.obj`, `.off`, `.ply`, `.stl`, or the file cannot be read or is no such mesh.
pub fn read_mesh(path: &Path) -> Result<TriMesh, IoError> {
    read_soup(path)?.into_mesh().map_err(|error| error.of(path))
}

/// As [`read_mesh`], with lines about content whose meaning is not clear: polygons that are not plane or that cross
/// themselves, binary STL files of an unusual size.
///
/// # Errors
/// As [`read_mesh`].
pub fn read_mesh_with_warnings(path: &Path) -> Result<(TriMesh, Vec<String>), IoError> {
    read_soup(path)?.into_mesh_with_warnings().map_err(|error| error.of(path))
}

/// As [`read_mesh`], but the mesh may have no triangles.
pub(crate) fn read_soup(path: &Path) -> Result<Soup, IoError> {
    let Some(parse) = parser(path) else {
        return Err(unsupported(path, "mesh", SUPPORTED));
    };
    parse(&read_whole(path)?).map_err(|error| error.of(path))
}

/// Whether the ending is that of a mesh file: `.obj`, `.off`, `.ply` or `.stl`.
pub fn is_mesh_name(path: &Path) -> bool {
    parser(path).is_some()
}

type Parser = fn(&[u8]) -> Result<Soup, FormatError>;

fn parser(path: &Path) -> Option<Parser> {
    match ending(path).as_str() {
        "obj" => Some(obj::soup),
        "off" => Some(off::soup),
        "ply" => Some(ply::soup),
        "stl" => Some(stl::soup),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_selects_the_format() {
        let directory = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = directory.path().join(name);
            std::fs::write(&path, text).unwrap();
            path
        };
        let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
        assert_eq!(read_mesh(&write("a.OBJ", obj)).unwrap().faces(), [[0, 1, 2]]);
        let message = |name, text| read_mesh(&write(name, text)).unwrap_err().to_string();
        assert!(message("a.ply", obj).contains("a.ply: line 1: a PLY file begins with 'ply'"));
        assert!(message("a.off", obj).contains("a.off: line 1: an OFF file begins with 'OFF'"));
        assert!(
            message("a.fbx", obj).ends_with("unknown kind of mesh file; supported: .obj, .off, .ply, .stl")
        );
        let missing = read_mesh(&directory.path().join("b.fbx")).unwrap_err().to_string();
        assert!(missing.ends_with("b.fbx: not found"));
        assert!(message("plain", obj).contains("supported: .obj"));
    }
}
