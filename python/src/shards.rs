//! The part of `sscc.batch` in Rust: jobs of one large model, and batches of queries.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList};
use sscc::{CancelToken, CertifyOptions, Error, Progress};

use crate::arguments::count;
use crate::arrays::{floats, table};
use crate::batch::{Batch, checked_entries};
use crate::certificates::Certificates;
use crate::certify::CertifyArguments;
use crate::errors::{kind, refused};
use crate::interrupt::{answer, signals};
use crate::model::Model;
use crate::pool::{CertifiedModel, Pool};

/// The keywords of `Model.certify`, except `progress` and the clearance: clusters compute only certificates of collisions.
const KEYWORDS: [&str; 14] = [
    "epsilon",
    "metric",
    "center",
    "scheme",
    "budget",
    "local_budget",
    "reach",
    "neighbours",
    "weld",
    "ignore_rest",
    "max_exceptions",
    "groups",
    "ignore_groups",
    "threads",
];

fn check_names(keywords: &Bound<'_, PyDict>) -> PyResult<()> {
    for name in keywords.keys() {
        let name: String = name.extract()?;
        if !KEYWORDS.contains(&name.as_str()) {
            return Err(kind(format!("'{name}' is not an option: use one of {}", KEYWORDS.join(", "))));
        }
    }
    Ok(())
}

/// Returns the options of the core for this model from the keywords of `Model.certify`.
fn options(model: &Bound<'_, Model>, keywords: &Bound<'_, PyDict>) -> PyResult<CertifyOptions> {
    check_names(keywords)?;
    let mut found = Vec::with_capacity(KEYWORDS.len());
    for name in KEYWORDS {
        found.push(keywords.get_item(name)?.filter(|any| !any.is_none()));
    }
    let [
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
        groups,
        ignore_groups,
        threads,
    ] = &found[..]
    else {
        return Err(kind("options: unknown keyword; use those of Model.certify"));
    };
    let arguments = CertifyArguments {
        epsilon: epsilon.as_ref(),
        metric: metric.as_ref(),
        center: center.as_ref(),
        scheme: scheme.as_ref(),
        budget: budget.as_ref(),
        local_budget: local_budget.as_ref(),
        reach: reach.as_ref(),
        neighbours: neighbours.as_ref(),
        weld: weld.as_ref(),
        ignore_rest: ignore_rest.as_ref(),
        max_exceptions: max_exceptions.as_ref(),
        clearance: None,
        rings: None,
        groups: groups.as_ref(),
        ignore_groups: ignore_groups.as_ref(),
        threads: threads.as_ref(),
    };
    arguments.options(&model.get().loaded)
}

/// Checks options as `Model.certify` does, without computing anything. Without a model it checks only their names.
#[pyfunction]
pub fn _check_options(model: Option<&Bound<'_, Model>>, keywords: &Bound<'_, PyDict>) -> PyResult<()> {
    match model {
        Some(model) => options(model, keywords).map(|_| ()),
        None => check_names(keywords),
    }
}

/// Runs jobs of one model.
#[pyclass(frozen, module = "sscc._sscc", name = "_ShardWorker")]
pub struct ShardWorker {
    core: sscc::parts::ShardWorker,
}

#[pymethods]
impl ShardWorker {
    #[new]
    fn new(py: Python<'_>, model: &Bound<'_, Model>, keywords: &Bound<'_, PyDict>) -> PyResult<Self> {
        let options = options(model, keywords)?;
        let loaded = Arc::clone(&model.get().loaded);
        let core = answer(py, || sscc::parts::ShardWorker::new(&loaded.model, &options, signals()))?;
        Ok(Self { core: core.map_err(|error| refused(&error, ""))? })
    }

    /// Returns the result of a job, computed on this thread.
    fn run<'py>(&self, py: Python<'py>, job: &[u8]) -> PyResult<Bound<'py, PyBytes>> {
        let result = answer(py, || self.core.run(job, signals()))?;
        Ok(PyBytes::new(py, &result.map_err(|error| refused(&error, ""))?))
    }
}

/// The finished share of the work, as the bits of a float. Ctrl-C cancels the work like queries.
#[derive(Default)]
struct Share(AtomicU64);

impl Progress for Share {
    fn report(&self, done: usize, total: usize) {
        let share = done as f64 / total.max(1) as f64;
        self.0.fetch_max(share.min(1.0).to_bits(), Ordering::Relaxed);
    }

    fn cancel_token(&self) -> Option<&CancelToken> {
        Some(signals())
    }
}

/// Runs `Model.certify` by jobs. `run(jobs, share)` returns the results of a list of jobs; `share` is the finished share of
/// the work.
#[pyfunction]
pub fn _certify_in_shards(
    py: Python<'_>,
    model: &Bound<'_, Model>,
    keywords: &Bound<'_, PyDict>,
    shards: &Bound<'_, PyAny>,
    run: Py<PyAny>,
) -> PyResult<Certificates> {
    let options = options(model, keywords)?;
    let shards = count(Some(shards), "shards", 1..=1 << 20)?.unwrap_or(1);
    let loaded = Arc::clone(&model.get().loaded);
    let mut raised = None;
    let computed = answer(py, || {
        let share = Share::default();
        let mut run_jobs = |jobs: Vec<Vec<u8>>| {
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
            sscc::parts::compute_in_shards(&loaded.model, &options, shards, &mut run_jobs, &share)?;
        Pool::of(CertifiedModel { loaded: Arc::clone(&loaded), certificates })
    })?;
    if let Some(error) = raised {
        return Err(error);
    }
    let pool = computed.map_err(|error| refused(&error, ""))?;
    Ok(Certificates { model: model.clone().unbind(), pool: Arc::new(pool) })
}

/// Returns Q as float64 in C order. The errors are those of `check_many`.
#[pyfunction]
#[allow(non_snake_case)]
pub fn _configurations<'py>(
    certificates: &Certificates,
    Q: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyAny>> {
    let entries = checked_entries(&certificates.pool, &floats(Q, "Q")?)?;
    let rank = certificates.pool.certified.loaded.model.rank();
    table(Q.py(), rank, entries)
}

/// Joins batches into one.
#[pyfunction]
pub fn _joined(batches: Vec<Bound<'_, Batch>>) -> Batch {
    Batch::of(batches.iter().flat_map(|batch| batch.get().answers.clone()).collect())
}

/// Returns the version and the hash of the core's source. Results of equal builds may be mixed.
#[pyfunction]
pub fn _build() -> &'static str {
    sscc::parts::BUILD
}
