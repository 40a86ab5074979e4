//! `sscc.Certificates`: the certificates of a model, and queries that use them.

use std::sync::Arc;

use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyList, PyType};
use sscc_io::container::{certificates_from_bytes, certificates_to_bytes};
use sscc_io::{read_certificates, write_certificates};
use sscc_tasks::text::{counted, length};

use crate::answer::{Answer, Reduction};
use crate::arguments::{check_ending, count, path};
use crate::arrays::{line, pairs, vector};
use crate::batch::{self, Batch};
use crate::clearance::{self, NearArrays, near_arrays};
use crate::errors::{file, refused, value};
use crate::hierarchy::Hierarchy;
use crate::impacts::Impacts;
use crate::interrupt::{answer, run_detachable};
use crate::kinetic::KineticQuery;
use crate::metric::factor;
use crate::model::Model;
use crate::pool::{CertifiedModel, Pool};
use crate::resolve;
use crate::sweeps::SweepArguments;

#[pyclass(frozen, module = "sscc", name = "Certificates")]
pub struct Certificates {
    pub model: Py<Model>,
    pub pool: Arc<Pool>,
}

impl Certificates {
    fn with(model: &Bound<'_, Model>, certificates: sscc::Certificates, name: &str) -> PyResult<Self> {
        let loaded = Arc::clone(&model.get().loaded);
        let pool = run_detachable(model.py(), move || Pool::of(CertifiedModel { loaded, certificates }))?;
        let pool = pool.map_err(|error| refused(&error, name))?;
        Ok(Self { model: model.clone().unbind(), pool: Arc::new(pool) })
    }

    #[inline]
    fn core(&self) -> &sscc::Certificates {
        &self.pool.certified.certificates
    }

    /// Whether the root's radius alone answers the query. Releasing the GIL would then cost more than the query.
    #[inline]
    fn is_quick(&self, q: &[f64]) -> bool {
        let core = self.core();
        core.clearance().is_none()
            && core.exceptions().is_empty()
            && core.norm(q).is_ok_and(|norm| norm < core.root_radius())
    }
}

#[pymethods]
impl Certificates {
    #[classmethod]
    fn load(
        _class: &Bound<'_, PyType>,
        py: Python<'_>,
        path: &Bound<'_, PyAny>,
        model: &Bound<'_, Model>,
    ) -> PyResult<Self> {
        let path = self::path(path, "path")?;
        let name = path.to_string_lossy().escape_debug().to_string();
        let read = run_detachable(py, move || read_certificates(&path))?.map_err(|error| file(&error))?;
        Self::with(model, read, &name)
    }

    fn save(&self, py: Python<'_>, path: &Bound<'_, PyAny>) -> PyResult<()> {
        let path = self::path(path, "path")?;
        check_ending(&path, ".sscc.safetensors")?;
        py.detach(|| write_certificates(&path, self.core())).map_err(|error| file(&error))
    }

    #[pyo3(signature = (q, limit=None))]
    fn check(
        &self,
        py: Python<'_>,
        q: &Bound<'_, PyAny>,
        limit: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Answer> {
        let q = vector(q, "q")?;
        let limit = match limit {
            Some(limit) => count(Some(limit), "limit", 1..=usize::MAX)?.unwrap_or(usize::MAX),
            None => usize::MAX,
        };
        let run = || {
            self.pool.with_query(|query| {
                let pairs = query.discrete_at_most(&q, limit).map(<[_]>::to_vec)?;
                Ok(Answer::of(pairs, query.statistics()))
            })
        };
        let found = if self.is_quick(&q) { run() } else { answer(py, run)? };
        found.map_err(|error| refused(&error, "q"))
    }

    #[pyo3(signature = (q, clearance, *, rings=None))]
    fn within<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        clearance: &Bound<'py, PyAny>,
        rings: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<NearArrays<'py>> {
        let (q, clearance) = (vector(q, "q")?, clearance::clearance(clearance, rings)?);
        let run = || self.pool.with_query(|query| Ok(query.within(&q, &clearance)?.to_vec()));
        near_arrays(py, &answer(py, run)?.map_err(|error| refused(&error, "q"))?)
    }

    #[pyo3(signature = (Q, limit=None, *, threads=None, progress=None))]
    #[allow(non_snake_case)]
    fn check_many(
        &self,
        py: Python<'_>,
        Q: &Bound<'_, PyAny>,
        limit: Option<&Bound<'_, PyAny>>,
        threads: Option<&Bound<'_, PyAny>>,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Batch> {
        batch::check_many(py, &self.pool, Q, limit, threads, progress)
    }

    fn continuous(&self, py: Python<'_>, q0: &Bound<'_, PyAny>, q1: &Bound<'_, PyAny>) -> PyResult<Impacts> {
        let [q0, q1] = [vector(q0, "q0")?, vector(q1, "q1")?];
        let found = answer(py, || {
            self.pool.with_query(|query| {
                let impacts = query.continuous(&q0, &q1)?.to_vec();
                Ok(Impacts::of(&impacts, query.statistics()))
            })
        })?;
        // The core reports the first end that is not a configuration of the model.
        let at_fault =
            if self.model.get().loaded.model.check_coordinates(&q0).is_err() { "q0" } else { "q1" };
        found.map_err(|error| refused(&error, at_fault))
    }

    fn safe_scale(&self, py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<f64> {
        let q = vector(q, "q")?;
        let scale = answer(py, || self.pool.with_query(|query| query.safe_scale(&q)))?;
        scale.map_err(|error| refused(&error, "q"))
    }

    #[pyo3(signature = (range=None, *, q=None, modes=None, threads=None, progress=None))]
    fn sweep<'py>(
        &self,
        py: Python<'py>,
        range: Option<&Bound<'py, PyAny>>,
        q: Option<&Bound<'py, PyAny>>,
        modes: Option<&Bound<'py, PyAny>>,
        threads: Option<&Bound<'py, PyAny>>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyList>> {
        SweepArguments { range, q, modes, threads }.run(py, &self.pool, progress)
    }

    #[pyo3(signature = (range=None, *, samples=None, q=None, modes=None, threads=None, progress=None))]
    #[allow(clippy::too_many_arguments)]
    fn intervals<'py>(
        &self,
        py: Python<'py>,
        range: Option<&Bound<'py, PyAny>>,
        samples: Option<&Bound<'py, PyAny>>,
        q: Option<&Bound<'py, PyAny>>,
        modes: Option<&Bound<'py, PyAny>>,
        threads: Option<&Bound<'py, PyAny>>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyList>> {
        SweepArguments { range, q, modes, threads }.intervals(py, &self.pool, samples, progress)
    }

    #[pyo3(signature = (q, start=None, *, all=None))]
    fn resolve<'py>(
        &self,
        py: Python<'py>,
        q: &Bound<'py, PyAny>,
        start: Option<&Bound<'py, PyAny>>,
        all: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        resolve::resolve(py, &self.pool, q, start, all)
    }

    #[pyo3(signature = (draws, *, resolve=None, start=None, all=None, threads=None, progress=None))]
    #[allow(clippy::too_many_arguments)]
    fn free_samples<'py>(
        &self,
        py: Python<'py>,
        draws: &Bound<'py, PyAny>,
        resolve: Option<&Bound<'py, PyAny>>,
        start: Option<&Bound<'py, PyAny>>,
        all: Option<&Bound<'py, PyAny>>,
        threads: Option<&Bound<'py, PyAny>>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        resolve::free_samples(py, &self.pool, draws, resolve, start, all, threads, progress)
    }

    fn clamp<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let q = vector(q, "q")?;
        let clamped = self.core().clamp(&q).map_err(|error| refused(&error, "q"))?;
        Ok(clamped.map(|clamped| line(py, clamped)))
    }

    fn norm(&self, q: &Bound<'_, PyAny>) -> PyResult<f64> {
        let q = vector(q, "q")?;
        self.model.get().loaded.model.check_coordinates(&q).map_err(|error| refused(&error, "q"))?;
        self.core().norm(&q).map_err(|error| refused(&error, "q"))
    }

    fn radius(&self, node: &Bound<'_, PyAny>) -> PyResult<f64> {
        let nodes = self.core().parts().hierarchy.nodes().len();
        let node = count(Some(node), "node", 0..=nodes - 1)?.unwrap_or_default();
        Ok(self.core().parts().node_radii[node])
    }

    fn kinetic(&self, py: Python<'_>) -> PyResult<KineticQuery> {
        let pool = Arc::clone(&self.pool);
        py.detach(|| KineticQuery::of(pool)).map_err(|error| refused(&error, ""))
    }

    #[getter]
    fn model(&self, py: Python<'_>) -> Py<Model> {
        self.model.clone_ref(py)
    }

    #[getter]
    fn root_radius(&self) -> f64 {
        self.core().root_radius()
    }

    #[getter]
    fn global_radius(&self) -> f64 {
        self.core().global_radius()
    }

    #[getter]
    fn epsilon(&self) -> f64 {
        self.core().parts().epsilon
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
    fn center<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        line(py, self.core().center().to_vec())
    }

    #[getter]
    fn neighbours(&self) -> &'static str {
        self.core().filter().neighbours.into()
    }

    #[getter]
    fn weld(&self) -> bool {
        self.core().filter().weld
    }

    #[getter]
    fn ignored<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pairs(py, self.core().filter().ignored())
    }

    #[getter]
    fn exceptions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pairs(py, self.core().exceptions())
    }

    #[getter]
    fn clearance(&self) -> Option<f64> {
        self.core().clearance().map(|clearance| clearance.distance())
    }

    #[getter]
    fn rings(&self) -> Option<u32> {
        self.core().clearance().map(|clearance| clearance.rings())
    }

    #[getter]
    fn rest_collisions(&self) -> u64 {
        self.core().rest_collisions()
    }

    #[getter]
    fn nodes(&self) -> usize {
        self.core().parts().hierarchy.nodes().len()
    }

    #[getter]
    fn pairs(&self) -> usize {
        self.core().parts().root_pair_radii.len() + self.core().parts().pair_tree.len()
    }

    #[getter]
    fn pair_limit(&self) -> f64 {
        self.core().parts().pair_tree.limit()
    }

    #[getter]
    fn local_certificates(&self) -> usize {
        self.core().parts().local.nodes.len()
    }

    #[getter]
    fn digest(&self) -> String {
        self.core().parts().digest.0.iter().map(|byte| format!("{byte:02x}")).collect()
    }

    #[getter]
    fn hierarchy(&self) -> Hierarchy {
        Hierarchy::of(Arc::clone(&self.pool))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduction<'py, (Bound<'py, PyBytes>, Py<Model>)>> {
        let bytes = py.detach(|| certificates_to_bytes(self.core()));
        let bytes = bytes.map_err(|error| value(error.to_string()))?;
        let make = py.import("sscc._sscc")?.getattr("_certificates")?;
        Ok((make, (PyBytes::new(py, &bytes), self.model.clone_ref(py))))
    }

    fn __repr__(&self) -> String {
        format!(
            "<sscc.Certificates: root radius {}, {}, {}, metric {}>",
            length(self.root_radius()),
            counted(self.nodes() as u64, "node"),
            counted(self.pairs() as u64, "node pair"),
            self.metric()
        )
    }
}

/// Unpickles certificates.
#[pyfunction]
pub fn _certificates(bytes: &[u8], model: &Bound<'_, Model>) -> PyResult<Certificates> {
    let name = "pickled certificates";
    let read = model.py().detach(|| certificates_from_bytes(bytes));
    Certificates::with(model, read.map_err(|error| value(format!("{name}: {error}")))?, name)
}
