//! `sscc.Impacts`: the colliding pairs of a continuous query, and their times of impact.

use pyo3::prelude::*;
use sscc::{Impact, Pair, Statistics};

use crate::answer::{Pickled, Reduced, pickled, unpickled};
use crate::arrays::{Cached, cached, line, pairs};
use crate::errors::{kind, value};

#[pyclass(frozen, module = "sscc", name = "Impacts")]
pub struct Impacts {
    /// The pairs, the norm and the cost.
    found: sscc::Answer,
    times: Vec<f64>,
    pairs_array: Cached,
    times_array: Cached,
}

impl Impacts {
    pub fn of(impacts: &[Impact], norm: f64, statistics: Statistics) -> Self {
        let pairs: Vec<Pair> = impacts.iter().map(|impact| impact.pair).collect();
        let times = impacts.iter().map(|impact| impact.time).collect();
        Self::from_parts(sscc::Answer { pairs, norm, statistics }, times)
    }

    fn from_parts(found: sscc::Answer, times: Vec<f64>) -> Self {
        Self { found, times, pairs_array: Cached::new(), times_array: Cached::new() }
    }
}

#[pymethods]
impl Impacts {
    #[getter]
    fn pairs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        cached(py, &self.pairs_array, || pairs(py, &self.found.pairs))
    }

    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        cached(py, &self.times_array, || Ok(line(py, self.times.clone())))
    }

    #[getter]
    fn time_of_impact(&self) -> Option<f64> {
        self.times.iter().copied().min_by(f64::total_cmp)
    }

    #[getter]
    fn colliding(&self) -> bool {
        !self.times.is_empty()
    }

    #[getter]
    fn count(&self) -> usize {
        self.times.len()
    }

    #[getter]
    fn norm(&self) -> f64 {
        self.found.norm
    }

    #[getter]
    fn complete(&self) -> bool {
        self.found.statistics.complete
    }

    #[getter]
    fn root_certified(&self) -> bool {
        self.found.statistics.root_certified
    }

    #[getter]
    fn opened(&self) -> u64 {
        self.found.statistics.opened
    }

    #[getter]
    fn box_tests(&self) -> u64 {
        self.found.statistics.box_tests
    }

    #[getter]
    fn triangle_tests(&self) -> u64 {
        self.found.statistics.triangle_tests
    }

    fn __bool__(&self) -> PyResult<bool> {
        Err(kind("impacts are neither true nor false: ask for .colliding"))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.found == other.found && self.times == other.times
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py, (Pickled<'py>, Vec<f64>)>> {
        Ok((py.import("sscc._sscc")?.getattr("_impacts")?, (pickled(py, &self.found), self.times.clone())))
    }

    fn __repr__(&self) -> String {
        match self.time_of_impact() {
            None => "<sscc.Impacts: free on the whole way>".into(),
            Some(time) => format!("<sscc.Impacts: {} pairs, the first at {time:.4}>", self.times.len()),
        }
    }
}

/// Constructor for pickled impacts.
#[pyfunction]
pub fn _impacts(found: Pickled<'_>, times: Vec<f64>) -> PyResult<Impacts> {
    let found = unpickled(&found)?;
    if found.pairs.len() != times.len() {
        return Err(value("the pickled impacts are damaged"));
    }
    Ok(Impacts::from_parts(found, times))
}
