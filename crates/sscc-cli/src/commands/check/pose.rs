//! Writes a shape as a mesh file (`--pose`).

use std::ffi::OsStr;
use std::path::Path;

use anyhow::{Result, bail};
use glam::DVec3;
use sscc::{Pair, TriMesh};
use sscc_io::{write_obj_pose, write_ply_pose};

use crate::{args, load};

/// Refuses a file that cannot be written, before the query.
pub fn check(path: &Path, model: &args::Model) -> Result<()> {
    let ending = match ending(path) {
        Some("ply") => ".ply",
        Some("obj") => ".obj",
        _ => bail!("{}: the name of a pose must end in .ply or .obj", path.display()),
    };
    let inputs: Vec<&Path> =
        [Some(model.path.as_path()), model.modes.as_deref()].into_iter().flatten().collect();
    load::check_output(path, ending, &inputs)
}

/// Writes a mesh at these positions with the triangles of these pairs marked.
pub fn write(path: &Path, mesh: &TriMesh, positions: &[DVec3], pairs: &[Pair]) -> Result<()> {
    let mut colliding = vec![false; mesh.faces().len()];
    for &(i, j) in pairs {
        colliding[i as usize] = true;
        colliding[j as usize] = true;
    }
    let write = if ending(path) == Some("ply") { write_ply_pose } else { write_obj_pose };
    Ok(write(path, mesh, positions, &colliding)?)
}

fn ending(path: &Path) -> Option<&str> {
    path.extension().and_then(OsStr::to_str)
}
