//! Reads the modes of a mesh from any supported format.

use std::path::Path;

use sscc::TriMesh;

use crate::file::{ending, read_whole};
use crate::modes::{NamedModes, folder, read_modes};
use crate::{IoError, npz};

/// Reads the modes of a mesh, with names and standard deviations if the files have them. Supports the formats of [`read_modes`], a `.npz`
/// archive ([`npz`]) and a folder of target meshes ([`folder`]). `mesh_path` is the file of the mesh.
///
/// # Errors
/// As [`read_modes`], [`npz::parse_modes`] and [`folder::read`].
pub fn read_modes_for(path: &Path, mesh: &TriMesh, mesh_path: &Path) -> Result<NamedModes, IoError> {
    let modes = match ending(path).as_str() {
        _ if path.is_dir() => return folder::read(path, mesh, mesh_path),
        "npz" => return npz::parse_modes(&read_whole(path)?, mesh).map_err(|error| error.of(path)),
        _ => read_modes(path, mesh.rest_positions().len()),
    };
    Ok(NamedModes { modes: modes?, names: Vec::new(), deviations: None })
}
