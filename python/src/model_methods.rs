//! The methods of `sscc.Model`.

use std::sync::Arc;

use glam::DVec3;
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyTuple, PyType};
use sscc::{ContactFilter, Error, Modes, ReducedModel};
use sscc_io::container::{model_from_bytes, model_to_bytes};
use sscc_io::npy::Array;
use sscc_io::{LoadOptions, ModelInfo, load_model_with, write_model};
use sscc_modes::DisplacementFit;
use sscc_tasks::static_answer;
use sscc_tasks::text::{counted, grouped};

use crate::answer::Reduction;
use crate::arguments::{check_ending, path};
use crate::arrays::{floats, frozen, line, table, vector};
use crate::certificates::Certificates;
use crate::certify;
use crate::errors::{file, kind, refused, room, value, warn};
use crate::interrupt::run_detachable;
use crate::metric::{factor, read_metric};
use crate::model::{LoadedModel, Model, mesh, points};

impl Model {
    /// Returns one vector for each vertex from an array (V, 3).
    fn of_vertices(&self, any: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<DVec3>> {
        let (found, vertices) =
            (points(&floats(any, name)?, name)?, self.core().mesh().rest_positions().len());
        if found.len() != vertices {
            return Err(value(format!("{name} has {} rows: the model has {vertices} vertices", found.len())));
        }
        Ok(found)
    }
}

#[pymethods]
impl Model {
    #[new]
    #[pyo3(signature = (vertices, faces, modes, metric=None))]
    fn new(
        py: Python<'_>,
        vertices: &Bound<'_, PyAny>,
        faces: &Bound<'_, PyAny>,
        modes: &Bound<'_, PyAny>,
        metric: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let mesh = mesh(vertices, faces)?;
        let modes = read_modes(modes, mesh.rest_positions().len())?;
        let model = py.detach(|| ReducedModel::new(mesh, modes)).map_err(|error| refused(&error, ""))?;
        let model = match read_metric(&model, metric)? {
            Some(metric) => {
                let with_metric = py.detach(|| {
                    ReducedModel::with_metric(model.mesh().clone(), model.modes().clone(), metric)
                });
                with_metric.map_err(|error| refused(&error, "metric"))?
            }
            None => model,
        };
        Ok(Self::of(LoadedModel::new(model, ModelInfo::default())))
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
        let path = self::path(path, "path")?;
        let modes = modes.map(|modes| self::path(modes, "modes")).transpose()?;
        let (of_worker, mesh_name) = (path.clone(), mesh_name.map(str::to_owned));
        let read = run_detachable(py, move || {
            load_model_with(&of_worker, &LoadOptions::new(modes.as_deref(), mesh_name.as_deref()))
        })?;
        let read = read.map_err(|error| file(&error))?;
        let name = path.to_string_lossy().escape_debug().to_string();
        warn(py, &read.warnings.iter().map(|warning| format!("{name}: {warning}")).collect::<Vec<_>>())?;
        Ok(Self::of(LoadedModel {
            default_q: read.default_q,
            mode_names: read.mode_names,
            ..LoadedModel::new(read.model, read.info)
        }))
    }

    fn save(&self, py: Python<'_>, path: &Bound<'_, PyAny>) -> PyResult<()> {
        let path = self::path(path, "path")?;
        check_ending(&path, ".model.safetensors")?;
        let loaded = &self.loaded;
        py.detach(|| write_model(&path, &loaded.model, &loaded.info)).map_err(|error| file(&error))
    }

    #[allow(clippy::too_many_arguments)]
    #[pyo3(signature = (*, epsilon=None, metric=None, center=None, scheme=None, budget=None, local_budget=None, reach=None,
        neighbours=None, weld=None, ignore_rest=None, max_exceptions=None, clearance=None, rings=None, groups=None, ignore_groups=None,
        threads=None, progress=None))]
    fn certify(
        slf: &Bound<'_, Self>,
        epsilon: Option<&Bound<'_, PyAny>>,
        metric: Option<&Bound<'_, PyAny>>,
        center: Option<&Bound<'_, PyAny>>,
        scheme: Option<&Bound<'_, PyAny>>,
        budget: Option<&Bound<'_, PyAny>>,
        local_budget: Option<&Bound<'_, PyAny>>,
        reach: Option<&Bound<'_, PyAny>>,
        neighbours: Option<&Bound<'_, PyAny>>,
        weld: Option<&Bound<'_, PyAny>>,
        ignore_rest: Option<&Bound<'_, PyAny>>,
        max_exceptions: Option<&Bound<'_, PyAny>>,
        clearance: Option<&Bound<'_, PyAny>>,
        rings: Option<&Bound<'_, PyAny>>,
        groups: Option<&Bound<'_, PyAny>>,
        ignore_groups: Option<&Bound<'_, PyAny>>,
        threads: Option<&Bound<'_, PyAny>>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Certificates> {
        let arguments = certify::CertifyArguments {
            epsilon,
            metric,
            center,
            scheme,
            budget,
            local_budget,
            reach,
            neighbours,
            weld,
            ignore_rest,
            max_exceptions,
            clearance,
            rings,
            groups,
            ignore_groups,
            threads,
        };
        certify::certify(slf, &arguments, progress)
    }

    /// Returns the vertices at q, (V, 3): the positions that all queries test, bit for bit.
    fn positions<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let q = vector(q, "q")?;
        let positions = py.detach(|| -> Result<Vec<f64>, Error> {
            Ok(self.core().positions(&q)?.iter().flat_map(|p| p.to_array()).collect())
        });
        table(py, 3, positions.map_err(|error| refused(&error, "q"))?)
    }

    /// Returns the q of forces on the vertices and of gravity.
    #[pyo3(name = "static", signature = (forces, *, gravity=None))]
    fn static_configuration<'py>(
        &self,
        py: Python<'py>,
        forces: &Bound<'py, PyAny>,
        gravity: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let forces: Vec<_> = (0..).zip(self.of_vertices(forces, "forces")?).collect();
        let gravity = gravity.map(|gravity| vector(gravity, "gravity")).transpose()?;
        let gravity = match gravity.as_deref() {
            None => None,
            Some([x, y, z]) => Some(DVec3::new(*x, *y, *z)),
            Some(other) => {
                return Err(value(format!("gravity has {} numbers: 3 were expected", other.len())));
            }
        };
        let loaded = Arc::clone(&self.loaded);
        let found = run_detachable(py, move || static_answer(&loaded.model, &loaded.info, &forces, gravity))?;
        Ok(line(py, found.map_err(|error| value(error.to_string()))?.q))
    }

    /// Returns the q whose shape is nearest to positions, and the share of the displacements that remains.
    fn fit<'py>(&self, py: Python<'py>, positions: &Bound<'py, PyAny>) -> PyResult<(Bound<'py, PyAny>, f64)> {
        let mut displacements = self.of_vertices(positions, "positions")?;
        let loaded = Arc::clone(&self.loaded);
        let found = run_detachable(py, move || {
            let rest_positions = loaded.model.mesh().rest_positions();
            displacements.iter_mut().zip(rest_positions).for_each(|(x, rest)| *x -= *rest);
            DisplacementFit::new(loaded.model.modes())?.fit(&displacements)
        })?;
        let found = found.map_err(|error| value(format!("positions: {error}")))?;
        Ok((line(py, found.q), found.residual))
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
        py.detach(|| {
            for of_vertex in modes.displacements().chunks_exact(modes.rank()) {
                (0..3).for_each(|axis| entries.extend(of_vertex.iter().map(|u| u[axis])));
            }
        });
        table(py, modes.rank(), entries)?.call_method1("reshape", (modes.vertices(), 3, modes.rank()))
    }

    #[getter]
    fn rank(&self) -> usize {
        self.core().rank()
    }

    #[getter]
    fn metric(&self) -> &'static str {
        self.core().metric().kind().into()
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

    #[getter]
    fn deviations<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        self.loaded.info.deviations.clone().map(|deviations| frozen(line(py, deviations))).transpose()
    }

    #[getter]
    fn weld(&self) -> bool {
        ContactFilter::of(self.core().mesh()).weld
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduction<'py, Bound<'py, PyTuple>>> {
        let py = slf.py();
        let loaded = &slf.get().loaded;
        let bytes = py.detach(|| model_to_bytes(&loaded.model, &loaded.info));
        let bytes = bytes.map_err(|error| value(error.to_string()))?;
        let is_split = loaded.model.mesh().has_split_vertices();
        let arguments =
            (PyBytes::new(py, &bytes), &loaded.default_q, &loaded.mode_names, is_split).into_pyobject(py)?;
        Ok((py.import("sscc._sscc")?.getattr("_model")?, arguments))
    }

    fn __repr__(&self) -> String {
        let mesh = self.core().mesh();
        format!(
            "<sscc.Model: {}, {} vertices, {}>",
            counted(mesh.faces().len() as u64, "triangle"),
            grouped(mesh.rest_positions().len() as u64),
            counted(self.core().rank() as u64, "mode")
        )
    }
}

/// Unpickles models.
#[pyfunction]
pub fn _model(
    py: Python<'_>,
    bytes: &[u8],
    default_q: Option<Vec<f64>>,
    mode_names: Vec<String>,
    is_split: bool,
) -> PyResult<Model> {
    let read = py.detach(|| model_from_bytes(bytes));
    let (model, info) = read.map_err(|error| value(format!("pickled model: {error}")))?;
    let model = if is_split {
        let split = py.detach(|| {
            let (mesh, metric) = (model.mesh().clone().with_split_vertices(), model.metric().clone());
            ReducedModel::with_metric(mesh, model.modes().clone(), metric)
        });
        split.map_err(|error| refused(&error, "pickled model"))?
    } else {
        model
    };
    Ok(Model::of(LoadedModel { default_q, mode_names, ..LoadedModel::new(model, info) }))
}

/// Returns modes for this number of vertices from an array in one of the shapes that the command accepts.
fn read_modes(modes: &Bound<'_, PyAny>, vertices: usize) -> PyResult<Modes> {
    let array = floats(modes, "modes")?;
    let entries = array.as_slice()?;
    // The conversion needs a second copy.
    let mut copy = room::<f64>(2 * entries.len(), "modes")?;
    copy.extend_from_slice(entries);
    let array = Array::from_c_order(array.shape(), copy).ok_or_else(|| kind("modes changed its shape"))?;
    let read = modes.py().detach(|| sscc_io::modes::array::from_array(&array, vertices));
    read.map_err(|error| value(format!("modes: {error}")))
}
