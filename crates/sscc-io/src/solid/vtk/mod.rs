//! Reader for the grids of VTK: `.vtu` (XML) and legacy `.vtk` files, as solvers, ParaView and meshio write them.
//!
//! The module has its own parser, on `quick-xml`: the crate `vtkio` 0.6.3 reads neither the files of meshio nor the compressed inline
//! arrays of VTK (docs/notes/files-and-page.md). Arrays are ASCII, base64 or raw, inline or appended, of either byte order, plain or
//! compressed by zlib. Sizes that a file states are compared with the bytes that it has, before memory is reserved.
//!
//! Points keep the file's order. Tetrahedra of first and second order and hexahedra (also voxels) are a solid; triangles, strips,
//! quadrilaterals, pixels and polygons are faces.

mod cells;
mod data;
mod displacement;
mod grid;
mod legacy;
mod legacy_numbers;
#[cfg(test)]
mod tests;
mod xml;
mod xml_arrays;

use std::path::Path;

use sscc::TriMesh;
use sscc_solid::VolumeMesh;

use super::volume_or_surface::VolumeOrSurface;
use crate::file::{ending, read_whole};
use crate::{FormatError, IoError};

pub use displacement::Displacement;
pub(crate) use grid::Grid;
pub(crate) use xml::elements;

/// Whether the ending is that of a grid of VTK: `.vtu` or `.vtk`.
pub fn is_vtk_name(path: &Path) -> bool {
    matches!(ending(path).as_str(), "vtu" | "vtk")
}

/// Parses a grid at rest: its points as they are, without a displacement.
///
/// # Errors
/// When the file is malformed, its arrays do not have the lengths that it states, a solid cell is neither a tetrahedron
/// of 4 or 10 nodes nor a hexahedron of 8; else as [`read_volume_mesh`](super::read_volume_mesh).
pub fn parse(bytes: &[u8]) -> Result<VolumeMesh, FormatError> {
    parse_any(bytes)?.into_volume().map(|(mesh, _)| mesh)
}

/// As [`parse`], but for a file without tetrahedra and hexahedra returns the surface of its faces.
///
/// # Errors
/// As [`parse`], but such a file needs no elements; when it has faces of higher order other than triangles of 6 nodes.
pub fn parse_any(bytes: &[u8]) -> Result<VolumeOrSurface, FormatError> {
    parse_grid(bytes, &Displacement::None)?.into_volume_or_surface()
}

/// Parses a grid, with the point data that moves it.
pub(crate) fn parse_grid(bytes: &[u8], displacement: &Displacement) -> Result<Grid, FormatError> {
    match bytes.starts_with(b"# vtk") {
        true => legacy::parse(bytes, displacement),
        false => xml::parse(bytes, displacement),
    }
}

/// Reads the surface of a grid, moved by its displacements, with lines about its content.
pub(crate) fn read_surface(
    path: &Path,
    displacement: &Displacement,
) -> Result<(TriMesh, Vec<String>), IoError> {
    let grid = read_grid(path, displacement)?;
    let note = grid.note();
    let (mesh, mut warnings) = grid.moved().into_surface().map_err(|error| error.of(path))?;
    warnings.extend(note);
    Ok((mesh, warnings))
}

/// Reads a grid, with the point data that moves it.
fn read_grid(path: &Path, displacement: &Displacement) -> Result<Grid, IoError> {
    parse_grid(&read_whole(path)?, displacement).map_err(|error| error.of(path))
}
