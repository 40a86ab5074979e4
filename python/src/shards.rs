//! The core's part of `sscc.batch`: jobs of one large model, and queries in chunks.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};
use sscc::{CertifyOptions, Error, Progress};

use crate::arguments::count;
use crate::arrays::{floats, table};
use crate::batch::{Batch, checked_entries};
use crate::certificates::Certificates;
use crate::certify::Typed;
use crate::errors::{kind, refused};
use crate::interrupt::{Signals, answer};
use crate::model::Model;
use crate::pool::{Certified, Pool};

/// The keywords of `Model.certify`, except `progress`.
const NAMES: [&str; 10] = [
    "epsilon",
    "metric",
    "center",
    "scheme",
    "budget",
    "neighbours",
    "weld",
    "ignore_rest",
    "max_exceptions",
    "threads",
];

fn check_names(typed: &Bound<'_, PyDict>) -> PyResult<()> {
    for name in typed.keys() {
        let name: String = name.extract()?;
        if !NAMES.contains(&name.as_str()) {
            return Err(kind(format!("'{name}' is no option: there are {}", NAMES.join(", "))));
        }
    }
    Ok(())
}

/// What was typed as keywords of `certify`, and what it means for this model.
fn options(model: &Bound<'_, Model>, typed: &Bound<'_, PyDict>) -> PyResult<CertifyOptions> {
    check_names(typed)?;
    let mut found = Vec::with_capacity(NAMES.len());
    for name in NAMES {
        found.push(typed.get_item(name)?.filter(|any| !any.is_none()));
    }
    let [epsilon, metric, center, scheme, budget, neighbours, weld, ignore_rest, max_exceptions, threads] =
        &found[..]
    else {
        return Err(kind("options"));
    };
    let typed = Typed {
        epsilon: epsilon.as_ref(),
        metric: metric.as_ref(),
        center: center.as_ref(),
        scheme: scheme.as_ref(),
        budget: budget.as_ref(),
        neighbours: neighbours.as_ref(),
        weld: weld.as_ref(),
        ignore_rest: ignore_rest.as_ref(),
        max_exceptions: max_exceptions.as_ref(),
        threads: threads.as_ref(),
    };
    typed.options(&model.get().loaded)
}

/// Checks options as `Model.certify` does, without computing anything. Without a model it checks only their names.
#[pyfunction]
pub fn _check_options(model: Option<&Bound<'_, Model>>, typed: &Bound<'_, PyDict>) -> PyResult<()> {
    match model {
        Some(model) => options(model, typed).map(|_| ()),
        None => check_names(typed),
    }
}

/// Runs jobs of one model.
#[pyclass(frozen, module = "sscc._sscc", name = "_ShardWorker")]
pub struct ShardWorker {
    core: sscc::ShardWorker,
}

#[pymethods]
impl ShardWorker {
    #[new]
    fn new(py: Python<'_>, model: &Bound<'_, Model>, typed: &Bound<'_, PyDict>) -> PyResult<Self> {
        let options = options(model, typed)?;
        let loaded = Arc::clone(&model.get().loaded);
        let core = answer(py, || sscc::ShardWorker::new(&loaded.model, &options, &Signals))?;
        Ok(Self { core: core.map_err(|error| refused(&error, ""))? })
    }

    /// Returns the result of a job, computed on this thread.
    fn run<'py>(&self, py: Python<'py>, job: &[u8]) -> PyResult<Bound<'py, PyBytes>> {
        let result = answer(py, || self.core.run(job, &Signals))?;
        Ok(PyBytes::new(py, &result.map_err(|error| refused(&error, ""))?))
    }
}

/// The share done, as the bits of a float. Ctrl-C cancels as in queries.
#[derive(Default)]
struct Share(AtomicU64);

impl Progress for Share {
    fn report(&self, done: usize, total: usize) {
        let share = done as f64 / total.max(1) as f64;
        self.0.fetch_max(share.min(1.0).to_bits(), Ordering::Relaxed);
    }

    fn is_cancelled(&self) -> bool {
        Signals.is_cancelled()
    }
}

/// `Model.certify` by jobs. `run(jobs, share)` runs a list of jobs and receives the share done.
#[pyfunction]
pub fn _certify_in_shards(
    py: Python<'_>,
    model: &Bound<'_, Model>,
    typed: &Bound<'_, PyDict>,
    shards: &Bound<'_, PyAny>,
    run: Py<PyAny>,
) -> PyResult<Certificates> {
    let options = options(model, typed)?;
    let shards = count(Some(shards), "shards", 1..=1 << 20)?.unwrap_or(1);
    let loaded = Arc::clone(&model.get().loaded);
    let mut raised = None;
    let computed = answer(py, || {
        let share = Share::default();
        let mut elsewhere = |jobs: Vec<Vec<u8>>| {
            let call = |py: Python<'_>| -> PyResult<Vec<Vec<u8>>> {
                let jobs = PyList::new(py, jobs.iter().map(|job| PyBytes::new(py, job)))?;
                let share = f64::from_bits(share.0.load(Ordering::Relaxed));
                let results = run.bind(py).call1((jobs, share))?;
                let bytes = |any: PyResult<Bound<'_, PyAny>>| -> PyResult<Vec<u8>> {
                    Ok(any?.cast::<PyBytes>()?.as_bytes().to_vec())
                };
                results.try_iter()?.map(bytes).collect()
            };
            Python::attach(call).map_err(|error| {
                raised = Some(error);
                Error::Cancelled
            })
        };
        let certificates =
            sscc::Certificates::compute_in_shards(&loaded.model, &options, shards, &mut elsewhere, &share)?;
        Pool::of(Certified { loaded: Arc::clone(&loaded), certificates })
    })?;
    if let Some(error) = raised {
        return Err(error);
    }
    let pool = computed.map_err(|error| refused(&error, ""))?;
    Ok(Certificates { model: model.clone().unbind(), pool: Arc::new(pool) })
}

/// Returns Q as float64 in C order, with the errors of `check_many`.
#[pyfunction]
#[allow(non_snake_case)]
pub fn _configurations<'py>(
    certificates: &Certificates,
    Q: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let entries = checked_entries(&certificates.pool, &floats(Q, "Q")?)?;
    let rank = certificates.pool.borrow_owner().loaded.model.rank();
    table(Q.py(), rank, entries)
}

/// Joins batches into one.
#[pyfunction]
pub fn _joined(batches: Vec<Bound<'_, Batch>>) -> Batch {
    Batch::of(batches.iter().flat_map(|batch| batch.get().answers.clone()).collect())
}

/// The version and the hash of the core's source. Results of equal builds may be mixed.
#[pyfunction]
pub fn _build() -> &'static str {
    sscc::BUILD
}
