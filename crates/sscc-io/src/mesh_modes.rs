//! The modes of a mesh, whatever the form of their files.

use std::path::Path;

use sscc::TriMesh;

use crate::file::{ending, read_whole};
use crate::modes::{NamedModes, folder, read_modes};
use crate::{IoError, npz};

/// Reads the modes of a mesh, with names where the files have some: as [`read_modes`], and also
/// from a `.npz` archive ([`npz`]) or a folder of target meshes ([`folder`]). `mesh_path` is the mesh's own file.
///
/// # Errors
/// As [`read_modes`], [`npz::parse_modes`] and [`folder::read`].
pub fn read_modes_for(path: &Path, mesh: &TriMesh, mesh_path: &Path) -> Result<NamedModes, IoError> {
    let modes = match ending(path).as_str() {
        _ if path.is_dir() => return folder::read(path, mesh, mesh_path),
        "npz" => npz::parse_modes(&read_whole(path)?, mesh).map_err(|error| error.of(path)),
        _ => read_modes(path, mesh.rest_positions().len()),
    };
    Ok(NamedModes { modes: modes?, names: Vec::new() })
}
