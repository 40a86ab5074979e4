//! The Python object of a model, and meshes from arrays. Its methods are in `model_methods.rs`, which imports the other
//! classes.

use std::sync::Arc;

use glam::DVec3;
use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;
use sscc::{ReducedModel, TriMesh};
use sscc_io::ModelInfo;

use crate::arrays::{floats, integers};
use crate::errors::{refused, room, value};

/// A model and the facts that its file states.
#[derive(Clone)]
pub struct LoadedModel {
    pub model: ReducedModel,
    pub info: ModelInfo,
    pub default_q: Option<Vec<f64>>,
    pub mode_names: Vec<String>,
}

impl LoadedModel {
    /// Returns a model without an initial q and without names of modes.
    pub fn new(model: ReducedModel, info: ModelInfo) -> Self {
        Self { model, info, default_q: None, mode_names: Vec::new() }
    }
}

#[pyclass(frozen, module = "sscc", name = "Model")]
pub struct Model {
    pub loaded: Arc<LoadedModel>,
}

impl Model {
    pub fn of(loaded: LoadedModel) -> Self {
        Self { loaded: Arc::new(loaded) }
    }

    pub fn core(&self) -> &ReducedModel {
        &self.loaded.model
    }
}

/// Returns a mesh from arrays: (V, 3) numbers and (F, 3) integers.
pub fn mesh(vertices: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>) -> PyResult<TriMesh> {
    mesh_of(points(&floats(vertices, "vertices")?, "vertices")?, "vertices", faces)
}

/// Returns a mesh from vertices and faces (F, 3); `name` is the argument of the vertices.
pub fn mesh_of(positions: Vec<DVec3>, name: &str, faces: &Bound<'_, PyAny>) -> PyResult<TriMesh> {
    let faces = face_corners(faces, Some((positions.len(), name)))?;
    TriMesh::new(positions, faces).map_err(|error| match error {
        sscc::Error::NoFaces => refused(&error, "faces"),
        error => refused(&error, name),
    })
}

/// Returns faces from an array (F, 3) of vertex numbers. `vertices` is the number of vertices and the name of their argument,
/// if they are known.
pub fn face_corners(faces: &Bound<'_, PyAny>, vertices: Option<(usize, &str)>) -> PyResult<Vec<[u32; 3]>> {
    let array = integers(faces, "faces")?;
    if array.shape() == [0] {
        return Ok(Vec::new());
    }
    if array.ndim() != 2 || array.shape()[1] != 3 {
        return Err(value(format!("faces has shape {:?}: (F, 3) was expected", array.shape())));
    }
    let mut faces = room(array.shape()[0], "faces")?;
    for (face, corners) in array.as_slice()?.as_chunks::<3>().0.iter().enumerate() {
        let vertex = |v: i64| match (u32::try_from(v), vertices) {
            (Ok(vertex), Some((count, _))) if (vertex as usize) < count => Ok(vertex),
            (Ok(vertex), None) if vertex < u32::MAX => Ok(vertex),
            (_, Some((count, name))) => {
                Err(value(format!("faces[{face}] names vertex {v}: {name} has {count}, counted from 0")))
            }
            (_, None) => Err(value(format!(
                "faces[{face}] names vertex {v}: a number from 0 to 2^32 - 2 was expected"
            ))),
        };
        faces.push([vertex(corners[0])?, vertex(corners[1])?, vertex(corners[2])?]);
    }
    Ok(faces)
}

/// Returns positions from an array (V, 3).
pub fn points(array: &PyReadonlyArrayDyn<'_, f64>, name: &str) -> PyResult<Vec<DVec3>> {
    if array.ndim() != 2 || array.shape()[1] != 3 {
        return Err(value(format!("{name} has shape {:?}: (V, 3) was expected", array.shape())));
    }
    let mut points = room(array.shape()[0], name)?;
    points.extend(array.as_slice()?.as_chunks::<3>().0.iter().map(|p| DVec3::from_array(*p)));
    Ok(points)
}
