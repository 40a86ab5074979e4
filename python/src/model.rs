//! `sscc.Model`: a mesh and its deformation modes.

use std::sync::Arc;

use glam::DVec3;
use numpy::{PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyString, PyTuple, PyType};
use sscc::{Metric, MetricKind, Modes, ReducedModel, TriMesh};
use sscc_io::container::{model_from_bytes, model_to_bytes};
use sscc_io::npy::Array;
use sscc_io::{LoadOptions, ModelInfo, load_model_with, splits_vertices, write_model};

use crate::answer::Reduced;
use crate::arguments::{check_ending, path};
use crate::arrays::{copied, floats, integers, line, table, vector};
use crate::certify;
use crate::errors::{file, kind, refused, room, value};

/// A model with what is known beside it.
#[derive(Clone)]
pub struct Loaded {
    pub model: ReducedModel,
    pub info: ModelInfo,
    pub default_q: Option<Vec<f64>>,
    pub mode_names: Vec<String>,
    /// Whether its vertices are split along seams, so that certificates weld them if nothing is said.
    pub is_split: bool,
}

impl Loaded {
    /// A model that no file is known of.
    pub fn new(model: ReducedModel, info: ModelInfo, is_split: bool) -> Self {
        Self { model, info, default_q: None, mode_names: Vec::new(), is_split }
    }
}

#[pyclass(frozen, module = "sscc", name = "Model")]
pub struct Model {
    pub loaded: Arc<Loaded>,
}

impl Model {
    pub fn of(loaded: Loaded) -> Self {
        Self { loaded: Arc::new(loaded) }
    }

    fn core(&self) -> &ReducedModel {
        &self.loaded.model
    }
}

#[pymethods]
impl Model {
    #[new]
    #[pyo3(signature = (vertices, faces, modes, metric=None))]
    fn new(
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        modes: &Bound<'_, PyAny>,
        metric: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let mesh = mesh(vertices, faces)?;
        let modes = read_modes(modes, mesh.rest_positions().len())?;
        let model = ReducedModel::new(mesh, modes).map_err(|error| refused(&error, ""))?;
        let model = match read_metric(&model, metric)? {
            Some(metric) => {
                let (mesh, modes) = (model.mesh().clone(), model.modes().clone());
                ReducedModel::with_metric(mesh, modes, metric).map_err(|error| refused(&error, "metric"))?
            }
            None => model,
        };
        Ok(Self::of(Loaded::new(model, ModelInfo::default(), false)))
    }

    #[classmethod]
    #[pyo3(signature = (path, modes=None, *, mesh_name=None))]
    fn load(
        _class: &Bound<'_, PyType>,
        py: Python<'_>,
        path: &Bound<'_, PyAny>,
        modes: Option<&Bound<'_, PyAny>>,
        mesh_name: Option<&str>,
    ) -> PyResult<Self> {
        let path = crate::arguments::path(path, "path")?;
        let modes = modes.map(|modes| crate::arguments::path(modes, "modes")).transpose()?;
        let read = py.detach(|| load_model_with(&path, &LoadOptions::new(modes.as_deref(), mesh_name)));
        let read = read.map_err(|error| file(&error))?;
        Ok(Self::of(Loaded {
            default_q: read.default_q,
            mode_names: read.mode_names,
            ..Loaded::new(read.model, read.info, splits_vertices(&path))
        }))
    }

    fn save(&self, py: Python<'_>, path: &Bound<'_, PyAny>) -> PyResult<()> {
        let path = self::path(path, "path")?;
        check_ending(&path, ".model.safetensors")?;
        let loaded = &self.loaded;
        py.detach(|| write_model(&path, &loaded.model, &loaded.info)).map_err(|error| file(&error))
    }

    #[allow(clippy::too_many_arguments)]
    #[pyo3(signature = (*, epsilon=None, metric=None, center=None, scheme=None, budget=None, neighbours=None, weld=None,
        ignore_rest=None, max_exceptions=None, threads=None, progress=None))]
    fn certify(
        slf: &Bound<'_, Self>,
        epsilon: Option<&Bound<'_, PyAny>>,
        metric: Option<&Bound<'_, PyAny>>,
        center: Option<&Bound<'_, PyAny>>,
        scheme: Option<&Bound<'_, PyAny>>,
        budget: Option<&Bound<'_, PyAny>>,
        neighbours: Option<&Bound<'_, PyAny>>,
        weld: Option<&Bound<'_, PyAny>>,
        ignore_rest: Option<&Bound<'_, PyAny>>,
        max_exceptions: Option<&Bound<'_, PyAny>>,
        threads: Option<&Bound<'_, PyAny>>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<crate::certificates::Certificates> {
        let typed = certify::Typed {
            epsilon,
            metric,
            center,
            scheme,
            budget,
            neighbours,
            weld,
            ignore_rest,
            max_exceptions,
            threads,
        };
        certify::certify(slf, &typed, progress)
    }

    /// Where the vertices are at q.
    fn positions<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let q = vector(q, "q")?;
        let positions = self.core().positions(&q).map_err(|error| refused(&error, "q"))?;
        table(py, 3, positions.iter().flat_map(|p| p.to_array()).collect())
    }

    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        table(py, 3, self.core().mesh().rest_positions().iter().flat_map(|p| p.to_array()).collect())
    }

    #[getter]
    fn faces<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        table(py, 3, self.core().mesh().faces().as_flattened().to_vec())
    }

    #[getter]
    fn modes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let modes = self.core().modes();
        let mut entries = room(3 * modes.displacements().len(), "modes")?;
        for of_vertex in modes.displacements().chunks_exact(modes.rank()) {
            (0..3).for_each(|axis| entries.extend(of_vertex.iter().map(|u| u[axis])));
        }
        table(py, modes.rank(), entries)?.call_method1("reshape", (modes.vertices(), 3, modes.rank()))
    }

    #[getter]
    fn rank(&self) -> usize {
        self.core().rank()
    }

    #[getter]
    fn metric(&self) -> &'static str {
        self.core().metric().kind().name()
    }

    #[getter]
    fn metric_factor<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        factor(py, self.core().metric())
    }

    #[getter]
    fn units(&self) -> &str {
        &self.loaded.info.units
    }

    #[getter]
    fn provenance(&self) -> &str {
        &self.loaded.info.provenance
    }

    #[getter]
    fn mode_names(&self) -> Vec<String> {
        self.loaded.mode_names.clone()
    }

    #[getter]
    fn default_q<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        line(py, self.loaded.default_q.clone().unwrap_or_else(|| vec![0.0; self.core().rank()]))
    }

    #[getter]
    fn stiffness<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(elasticity) = &self.loaded.info.elasticity else { return Ok(None) };
        table(py, self.core().rank(), elasticity.stiffness().entries().to_vec()).map(Some)
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py, Bound<'py, PyTuple>>> {
        let py = slf.py();
        let loaded = &slf.get().loaded;
        let bytes = model_to_bytes(&loaded.model, &loaded.info).map_err(|error| value(error.to_string()))?;
        let arguments = (PyBytes::new(py, &bytes), &loaded.default_q, &loaded.mode_names, loaded.is_split)
            .into_pyobject(py)?;
        Ok((py.import("sscc._sscc")?.getattr("_model")?, arguments))
    }

    fn __repr__(&self) -> String {
        let mesh = self.core().mesh();
        format!(
            "<sscc.Model: {} triangles, {} vertices, {} modes>",
            mesh.faces().len(),
            mesh.rest_positions().len(),
            self.core().rank()
        )
    }
}

/// What a pickled model becomes.
#[pyfunction]
pub fn _model(
    bytes: &[u8],
    default_q: Option<Vec<f64>>,
    mode_names: Vec<String>,
    is_split: bool,
) -> PyResult<Model> {
    let (model, info) = model_from_bytes(bytes).map_err(|error| value(format!("pickled model: {error}")))?;
    Ok(Model::of(Loaded { default_q, mode_names, ..Loaded::new(model, info, is_split) }))
}

/// A mesh from arrays: (V, 3) numbers and (F, 3) integers.
pub fn mesh(vertices: &Bound<'_, PyAny>, faces: &Bound<'_, PyAny>) -> PyResult<TriMesh> {
    mesh_of(points(&floats(vertices, "vertices")?, "vertices")?, "vertices", faces)
}

/// A mesh of these vertices, which come from the argument `name`, and faces (F, 3).
pub fn mesh_of(positions: Vec<DVec3>, name: &str, faces: &Bound<'_, PyAny>) -> PyResult<TriMesh> {
    let corners = integers(faces, "faces")?;
    if corners.ndim() != 2 || corners.shape()[1] != 3 {
        return Err(value(format!("faces has shape {:?}: (F, 3) was expected", corners.shape())));
    }
    let count = positions.len();
    let mut faces = room(corners.shape()[0], "faces")?;
    for (face, corners) in corners.as_slice()?.as_chunks::<3>().0.iter().enumerate() {
        let vertex = |v: i64| match u32::try_from(v) {
            Ok(vertex) if v < count as i64 => Ok(vertex),
            _ => Err(value(format!("faces[{face}] names vertex {v}: {name} has {count}, counted from 0"))),
        };
        faces.push([vertex(corners[0])?, vertex(corners[1])?, vertex(corners[2])?]);
    }
    TriMesh::new(positions, faces).map_err(|error| match error {
        sscc::Error::NoFaces => refused(&error, "faces"),
        error => refused(&error, name),
    })
}

/// Positions from an array (V, 3).
pub fn points(array: &PyReadonlyArrayDyn<'_, f64>, name: &str) -> PyResult<Vec<DVec3>> {
    if array.ndim() != 2 || array.shape()[1] != 3 {
        return Err(value(format!("{name} has shape {:?}: (V, 3) was expected", array.shape())));
    }
    let mut points = room(array.shape()[0], name)?;
    points.extend(array.as_slice()?.as_chunks::<3>().0.iter().map(|p| DVec3::from_array(*p)));
    Ok(points)
}

/// Modes for so many vertices, in one of the shapes that the command takes.
fn read_modes(modes: &Bound<'_, PyAny>, vertices: usize) -> PyResult<Modes> {
    let array = floats(modes, "modes")?;
    let entries = array.as_slice()?;
    // As much again will be needed.
    let mut copy = room::<f64>(2 * entries.len(), "modes")?;
    copy.extend_from_slice(entries);
    let array = Array::from_c_order(array.shape(), copy).ok_or_else(|| kind("modes changed its shape"))?;
    sscc_io::modes::array::from_array(&array, vertices).map_err(|error| value(format!("modes: {error}")))
}

/// The metric that was asked for, if any: a name, weights (r) or a matrix (r, r).
pub fn read_metric(model: &ReducedModel, metric: Option<&Bound<'_, PyAny>>) -> PyResult<Option<Metric>> {
    let Some(any) = metric else { return Ok(None) };
    let rank = model.rank();
    let made = if let Ok(name) = any.cast::<PyString>() {
        match name.to_str()? {
            "displacement" => Metric::displacement(model.mesh(), model.modes()),
            "mass" => Metric::mass(model.mesh(), model.modes()),
            "identity" => Metric::identity(rank),
            "energy" if model.metric().kind() == MetricKind::Energy => model.metric().clone(),
            "energy" => {
                return Err(value(format!(
                    "metric: the model's own is '{}', not 'energy': that of a model with its stiffness, such as \
                     sscc.modes.linear makes",
                    model.metric().kind().name()
                )));
            }
            other => {
                return Err(value(format!(
                    "metric is '{}': 'energy', 'displacement', 'mass', 'identity', weights (r,) or a matrix (r, r) \
                     was expected",
                    other.escape_debug()
                )));
            }
        }
    } else {
        let array = floats(any, "metric")?;
        let entries = &copied(&array, "metric")?;
        let made = match *array.shape() {
            [n] if n == rank => Metric::from_weights(MetricKind::Given, entries),
            [n, m] if (n, m) == (rank, rank) => Metric::from_matrix(MetricKind::Given, rank, entries),
            _ => {
                let shape = array.shape();
                return Err(value(format!(
                    "metric has shape {shape:?}: ({rank},) or ({rank}, {rank}) was expected"
                )));
            }
        };
        made.map_err(|error| refused(&error, "metric"))?
    };
    made.check(model.mesh(), model.modes()).map_err(|error| refused(&error, "metric"))?;
    Ok(Some(made))
}

/// The factor S of `|z| = |S q|`: (r) where it is diagonal, else (r, r).
pub fn factor<'py>(py: Python<'py>, metric: &Metric) -> PyResult<Bound<'py, PyAny>> {
    match metric.dense_factor() {
        Some(factor) => table(py, metric.rank(), factor.to_vec()),
        None => Ok(line(py, metric.scales())),
    }
}
