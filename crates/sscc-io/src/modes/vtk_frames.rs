//! Frames of a mesh from files of VTK: one grid, a folder of grids, or a `.pvd` collection with times.

use std::path::{Path, PathBuf};

use glam::DVec3;
use sscc::TriMesh;

use super::collection::{TimedFile, is_collection, read_collection};
use crate::file::check_exists;
use crate::solid::vtk::{Displacement, read_surface};
use crate::{FormatError, IoError};

/// The files of the frames.
pub(super) struct VtkFrames {
    files: Vec<PathBuf>,
    /// The time of each frame (s), in a collection.
    pub times: Option<Vec<f64>>,
    displacement: Displacement,
}

impl VtkFrames {
    /// Opens a grid or a collection. `name` is that of the point data that moves the points.
    pub fn open(path: &Path, name: Option<&str>) -> Result<Self, IoError> {
        check_exists(path)?;
        let displacement = Displacement::of_name(name);
        if !is_collection(path) {
            return Ok(Self { files: vec![path.to_owned()], times: None, displacement });
        }
        let (files, times) =
            read_collection(path)?.into_iter().map(|TimedFile { file, time }| (file, time)).unzip();
        Ok(Self { files, times: Some(times), displacement })
    }

    pub fn len(&self) -> usize {
        self.files.len()
    }

    /// Returns the lines about the content of the first frame.
    pub fn warnings(&self) -> Result<Vec<String>, IoError> {
        Ok(read_surface(&self.files[0], &self.displacement)?.1)
    }

    /// Returns the positions of the vertices of a mesh in a frame. `other` names the mesh in messages.
    pub fn read(&self, frame: usize, mesh: &TriMesh, other: &str) -> Result<Vec<DVec3>, IoError> {
        positions_like(&self.files[frame], &self.displacement, mesh, "frame", other)
    }
}

/// Returns the positions of a grid whose surface has the triangles of a mesh: of all points, or only of those on the surface
/// if the mesh has no others, as a model of a solid does.
pub(super) fn positions_like(
    path: &Path,
    displacement: &Displacement,
    mesh: &TriMesh,
    what: &str,
    other: &str,
) -> Result<Vec<DVec3>, IoError> {
    let (surface, _) = read_surface(path, displacement)?;
    let positions = surface.rest_positions();
    if positions.len() == mesh.rest_positions().len() && surface.faces() == mesh.faces() {
        return Ok(positions.to_vec());
    }
    let mut used = vec![false; positions.len()];
    surface.faces().iter().flatten().for_each(|v| used[*v as usize] = true);
    let vertices: Vec<u32> = (0..used.len() as u32).filter(|v| used[*v as usize]).collect();
    let number = |v: u32| vertices.partition_point(|w| *w < v) as u32;
    let is_like = vertices.len() == mesh.rest_positions().len()
        && surface.faces().len() == mesh.faces().len()
        && surface.faces().iter().zip(mesh.faces()).all(|(own, face)| own.map(number) == *face);
    if is_like {
        return Ok(vertices.iter().map(|v| positions[*v as usize]).collect());
    }
    let cause = format!(
        "the surface of this {what} has {} triangles and {} vertices ({} points in all), which are not those of {other} ({} and {}): \
         the cells must be the same in all frames",
        surface.faces().len(),
        vertices.len(),
        positions.len(),
        mesh.faces().len(),
        mesh.rest_positions().len()
    );
    Err(FormatError::whole(cause).of(path))
}
