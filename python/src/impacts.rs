//! `sscc.Impacts`: the colliding pairs of a continuous query, and their times of impact.

use pyo3::prelude::*;
use sscc::{Impact, Pair, Statistics};
use sscc_tasks::text::counted;

use crate::answer::{PickledAnswer, Reduction, pickled, unpickled};
use crate::arrays::{CachedArray, cached, line, pairs};
use crate::errors::{kind, value};

#[pyclass(frozen, module = "sscc", name = "Impacts")]
pub struct Impacts {
    /// The pairs, the norm and the cost.
    answer: sscc::Answer,
    /// The time of impact of each pair.
    times: Vec<f64>,
    pairs_array: CachedArray,
    times_array: CachedArray,
}

impl Impacts {
    pub fn of(impacts: &[Impact], statistics: Statistics) -> Self {
        let pairs: Vec<Pair> = impacts.iter().map(|impact| impact.pair).collect();
        let times = impacts.iter().map(|impact| impact.time).collect();
        Self::from_parts(sscc::Answer { pairs, statistics }, times)
    }

    fn from_parts(answer: sscc::Answer, times: Vec<f64>) -> Self {
        Self { answer, times, pairs_array: CachedArray::new(), times_array: CachedArray::new() }
    }
}

#[pymethods]
impl Impacts {
    #[getter]
    fn pairs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        cached(py, &self.pairs_array, || pairs(py, &self.answer.pairs))
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
        self.answer.statistics.norm
    }

    #[getter]
    fn complete(&self) -> bool {
        self.answer.statistics.complete
    }

    #[getter]
    fn root_certified(&self) -> bool {
        self.answer.statistics.root_certified
    }

    #[getter]
    fn proof(&self) -> &'static str {
        self.answer.statistics.proof.into()
    }

    #[getter]
    fn opened(&self) -> u64 {
        self.answer.statistics.opened
    }

    #[getter]
    fn box_tests(&self) -> u64 {
        self.answer.statistics.box_tests
    }

    #[getter]
    fn triangle_tests(&self) -> u64 {
        self.answer.statistics.triangle_tests
    }

    fn __bool__(&self) -> PyResult<bool> {
        Err(kind("Impacts have no truth value: use .colliding"))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.answer == other.answer && self.times == other.times
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduction<'py, (PickledAnswer<'py>, Vec<f64>)>> {
        Ok((py.import("sscc._sscc")?.getattr("_impacts")?, (pickled(py, &self.answer), self.times.clone())))
    }

    fn __repr__(&self) -> String {
        match self.time_of_impact() {
            None => "<sscc.Impacts: free from q0 to q1>".into(),
            Some(time) => {
                let pairs = counted(self.times.len() as u64, "pair");
                format!("<sscc.Impacts: {pairs}, the first at {time:.4}>")
            }
        }
    }
}

/// Unpickles impacts.
#[pyfunction]
pub fn _impacts(answer: PickledAnswer<'_>, times: Vec<f64>) -> PyResult<Impacts> {
    let answer = unpickled(&answer)?;
    if answer.pairs.len() != times.len() {
        return Err(value("the pickled impacts are damaged: pairs and times differ in number"));
    }
    Ok(Impacts::from_parts(answer, times))
}
