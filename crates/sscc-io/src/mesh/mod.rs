//! Triangle meshes from files: OBJ, OFF and PLY.
//!
//! Every vertex of the file is kept, in the file's order, used by a face or not, so that modes given for
//! the file's vertices fit. Polygons become fans of triangles around their first corner, in file order.

pub mod obj;
pub mod off;
pub mod ply;
mod polygons;

use std::path::Path;

use sscc::TriMesh;

use crate::IoError;
use crate::file::{ending, read_whole};

/// The endings that [`read_mesh`] knows.
const SUPPORTED: &str = ".obj, .off, .ply";

/// Reads a triangle mesh; the format goes by the file name's ending, in any case.
///
/// # Errors
/// When the ending is none of `.obj`, `.off`, `.ply`, or the file cannot be read or is no such mesh.
pub fn read_mesh(path: &Path) -> Result<TriMesh, IoError> {
    let parse = match ending(path).as_str() {
        "obj" => obj::parse,
        "off" => off::parse,
        "ply" => ply::parse,
        _ => {
            return Err(IoError::Unsupported { path: path.to_owned(), what: "mesh", supported: SUPPORTED });
        }
    };
    parse(&read_whole(path)?).map_err(|error| error.of(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_decides() {
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
        assert!(message("a.fbx", obj).ends_with("unknown kind of mesh file; supported: .obj, .off, .ply"));
        assert!(message("plain", obj).contains("supported: .obj"));
    }
}
