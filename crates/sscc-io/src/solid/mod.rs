//! Readers for volumetric meshes of tetrahedra and cubes: Medit, VegaFEM, gmsh, TetGen and VTK.
//!
//! All vertices of the file are kept in its order, even unused ones. Elements keep the file's order within their kind,
//! and the order of their corners. Readers check the guarantees of [`VolumeMesh`]: numbers, indices, repeated corners,
//! duplicate elements. They accept inverted, flat or overlapping elements. [`VolumeMesh::solid`] rejects flat elements, and
//! inverted ones unless all tetrahedra are inverted, which it then reverses. It does not detect overlaps.
//!
//! Tetrahedra of second order are read from the files of gmsh and VTK alone. Other elements of higher order, prisms and pyramids are
//! errors: skipping them would leave holes in the body.

mod builder;
pub mod gmsh;
mod listed_faces;
pub mod medit;
mod statements;
#[cfg(test)]
mod surface_tests;
pub mod tetgen;
pub mod vega;
mod volume_or_surface;
pub mod vtk;
mod words;

use std::path::Path;

use sscc_solid::VolumeMesh;

use crate::IoError;
use crate::file::{ending, read_whole, unsupported};

pub use listed_faces::ListedFaces;
pub use volume_or_surface::VolumeOrSurface;

/// Endings that [`read_volume_mesh`] supports.
const SUPPORTED: &str =
    ".mesh (Medit), .veg (VegaFEM), .msh (gmsh), .node and .ele (TetGen), .vtu and .vtk (VTK)";

/// Reads a volumetric mesh. The ending of the file name, in any case, selects the format: `.mesh` ([`medit`]), `.veg`
/// ([`vega`]), `.msh` ([`gmsh`]), `.node` or `.ele` with the other file beside it ([`tetgen`]), `.vtu` or `.vtk` ([`vtk`]).
///
/// # Errors
/// When the ending is none of these, or the file (or one that belongs to it) cannot be read or is malformed; when
/// a coordinate is beyond [`sscc::limits`], an index names no vertex, an element names a vertex twice, is duplicated or
/// is neither a tetrahedron of 4 nodes (in files of gmsh and VTK also 10) nor an 8-node hexahedron, or there is no element.
pub fn read_volume_mesh(path: &Path) -> Result<VolumeMesh, IoError> {
    read_volume_mesh_with_warnings(path).map(|(mesh, _)| mesh)
}

/// As [`read_volume_mesh`], but also returns lines about faces that the file lists and no element has.
///
/// # Errors
/// As [`read_volume_mesh`].
pub fn read_volume_mesh_with_warnings(path: &Path) -> Result<(VolumeMesh, Vec<String>), IoError> {
    read_volume_or_surface(path)?.into_volume().map_err(|error| error.of(path))
}

/// As [`read_volume_mesh`], but for a Medit, gmsh or VTK file without tetrahedra and cubes returns the surface of its faces.
///
/// # Errors
/// As [`read_volume_mesh`], but such a file may have faces in place of elements. Faces of higher order are then an
/// error, except triangles of 6 nodes in files of gmsh and VTK.
pub fn read_volume_or_surface(path: &Path) -> Result<VolumeOrSurface, IoError> {
    let parse = match ending(path).as_str() {
        "mesh" => medit::parse_any,
        "msh" => gmsh::parse_any,
        "vtu" | "vtk" => vtk::parse_any,
        "veg" => return vega::read(path).map(VolumeOrSurface::without_faces),
        "node" | "ele" => return tetgen::read(path).map(VolumeOrSurface::without_faces),
        _ => return Err(unsupported(path, "volumetric mesh", SUPPORTED)),
    };
    parse(&read_whole(path)?).map_err(|error| error.of(path))
}

/// Whether the ending is that of a solid.
pub fn is_solid_name(path: &Path) -> bool {
    matches!(ending(path).as_str(), "mesh" | "veg" | "msh" | "node" | "ele" | "vtu" | "vtk")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ending_selects_the_format() {
        let directory = tempfile::tempdir().unwrap();
        let message = |name: &str| {
            let path = directory.path().join(name);
            std::fs::write(&path, "x\n").unwrap();
            read_volume_mesh(&path).unwrap_err().to_string()
        };
        assert!(message("a.MESH").contains("line 1: a Medit file begins with"));
        assert!(message("a.msh").contains("line 1: a gmsh file begins with"));
        assert!(message("a.veg").contains("line 1: a section"));
        assert!(message("a.stl").contains("unknown kind of volumetric mesh file; supported: .mesh (Medit)"));
        for name in ["b.msh", "b.stl"] {
            let missing = read_volume_mesh(&directory.path().join(name)).unwrap_err().to_string();
            assert!(missing.ends_with(&format!("{name}: not found")), "{missing}");
        }
    }
}
