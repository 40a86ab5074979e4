//! Writes shapes (`--pose`) and contact curves (`--curves`).

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Result, bail, ensure};
use glam::DVec3;
use sscc::{Pair, TriMesh};
use sscc_io::{
    LoadedModel, VtkFramesWriter, folder, is_collection, linked_file, split_mesh_name, write_obj_curves,
    write_obj_pose, write_ply_curves, write_ply_pose, write_vtu_pose,
};
use sscc_tasks::{ContactOptions, DetectionAnswer};

use crate::args::Check;
use crate::load;
use crate::output::note;

/// Refuses files that cannot be written or are inputs, such as these meshes, before the first query.
pub fn check(args: &Check, meshes: &[PathBuf]) -> Result<()> {
    let Check { model, certificates, at, motion, options, .. } = args;
    let files = [&model.modes, certificates, &at.trajectory, &motion.frames, &motion.against];
    let more = [&motion.against_frames, &options.metric, &options.groups.group_by];
    // Folders of data sets, too: a new mesh there would be checked in the next run.
    let typed = [&model.path].into_iter().chain(&args.meshes);
    let files = files.into_iter().chain(more).flatten().chain(typed).chain(meshes);
    let named: Vec<PathBuf> = files.map(|file| split_mesh_name(file).0).collect();
    let inputs: Vec<&Path> = named.iter().map(PathBuf::as_path).collect();
    if let Some(report) = &args.report {
        load::check_output(report, ".html", &inputs)?;
    }
    if let Some(frames) = &args.frames_out {
        let ending = match ending(frames) {
            Some("npy") => ".npy",
            Some("pvd") => ".pvd",
            _ => bail!("{}: the name of frames must end in .npy or .pvd", frames.display()),
        };
        load::check_output(frames, ending, &inputs)?;
        if is_collection(frames) {
            VtkFramesWriter::check(frames, &inputs)?;
        }
    }
    for (path, what) in [(&args.pose, "a pose"), (&args.curves, "contact curves")] {
        let Some(path) = path else { continue };
        let ending = match ending(path) {
            Some("ply") => ".ply",
            Some("obj") => ".obj",
            Some("vtu") if what == "a pose" => ".vtu",
            _ if what == "a pose" => {
                bail!("{}: the name of a pose must end in .ply, .obj or .vtu", path.display())
            }
            _ => bail!("{}: the name of {what} must end in .ply or .obj", path.display()),
        };
        load::check_output(path, ending, &inputs)?;
    }
    let is_one = args.pose.as_deref().map(real) == args.curves.as_deref().map(real);
    ensure!(args.pose.is_none() || !is_one, "--pose and --curves name the same file");
    Ok(())
}

/// Returns the path of the file that an output writes, after all links; as it is if the folder does not exist.
fn real(output: &Path) -> PathBuf {
    let file = linked_file(output).unwrap_or_else(|_| output.to_owned());
    match (fs::canonicalize(folder(&file)), file.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => file,
    }
}

/// Returns the data that the queries compute in addition to pairs.
pub fn contacts(args: &Check) -> ContactOptions {
    ContactOptions { depths: args.depths, curves: args.curves.is_some() }
}

/// Writes a mesh at these positions with the triangles of these pairs marked.
pub fn write_pose(path: &Path, mesh: &TriMesh, positions: &[DVec3], pairs: &[Pair]) -> Result<()> {
    let write = match ending(path) {
        Some("ply") => write_ply_pose,
        Some("vtu") => write_vtu_pose,
        _ => write_obj_pose,
    };
    Ok(write(path, mesh, positions, &marks(mesh, pairs))?)
}

/// Returns whether each triangle of a mesh is in one of these pairs.
pub fn marks(mesh: &TriMesh, pairs: &[Pair]) -> Vec<bool> {
    let mut colliding = vec![false; mesh.faces().len()];
    for &(i, j) in pairs {
        colliding[i as usize] = true;
        colliding[j as usize] = true;
    }
    colliding
}

/// Writes the contact curves of an answer about a model, at the place that the file gives the model. With a skin, which has
/// no single transform, they stay in the coordinates of the mesh.
pub fn write_placed_curves(
    path: Option<&Path>,
    found: &DetectionAnswer<'_>,
    loaded: &LoadedModel,
) -> Result<()> {
    let (Some(path), Some(curves)) = (path, found.curves) else { return Ok(()) };
    let Some(placement) = loaded.placement()? else { return write_curves(Some(path), found) };
    let Some(transform) = placement.transform(0) else {
        note("a skin deforms the model: the contact curves are in the coordinates of its mesh");
        return write_curves(Some(path), found);
    };
    let mut placed = curves.clone();
    let points = placed.curves.iter_mut().flat_map(|curve| &mut curve.points);
    points.for_each(|point| point.position = transform.transform_point3(point.position));
    write_curves(Some(path), &DetectionAnswer { curves: Some(&placed), ..*found })
}

/// Writes the contact curves of an answer that has them.
pub fn write_curves(path: Option<&Path>, found: &DetectionAnswer<'_>) -> Result<()> {
    let (Some(path), Some(curves)) = (path, found.curves) else { return Ok(()) };
    let write = if ending(path) == Some("ply") { write_ply_curves } else { write_obj_curves };
    Ok(write(path, curves)?)
}

fn ending(path: &Path) -> Option<&str> {
    path.extension().and_then(OsStr::to_str)
}
