//! `sscc.Answer`: the result of a query at one q.

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use sscc::{Pair, Statistics};

use crate::arrays::{Cached, cached, pairs};
use crate::errors::{kind, value};

/// The result of `__reduce__`: a function and its arguments.
pub type Reduced<'py, A> = (Bound<'py, PyAny>, A);

/// The pickled form of an answer: pairs (little-endian), norm, and the cost as in [`pickled`].
pub type Pickled<'py> = (Bound<'py, PyBytes>, f64, (bool, bool, u64, u64, u64));

#[pyclass(frozen, module = "sscc", name = "Answer")]
pub struct Answer {
    pub found: sscc::Answer,
    pub array: Cached,
}

impl Answer {
    #[inline]
    pub fn of(pairs: Vec<Pair>, norm: f64, statistics: Statistics) -> Self {
        Self { found: sscc::Answer { pairs, norm, statistics }, array: Cached::new() }
    }
}

#[pymethods]
impl Answer {
    #[getter]
    fn pairs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        cached(py, &self.array, || pairs(py, &self.found.pairs))
    }

    #[getter]
    fn colliding(&self) -> bool {
        !self.found.pairs.is_empty()
    }

    #[getter]
    fn count(&self) -> usize {
        self.found.pairs.len()
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
        Err(kind("an answer is neither true nor false: ask for .colliding"))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.found == other.found
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py, (Pickled<'py>,)>> {
        Ok((py.import("sscc._sscc")?.getattr("_answer")?, (pickled(py, &self.found),)))
    }

    fn __repr__(&self) -> String {
        let norm = self.found.norm;
        match (self.found.pairs.len(), self.found.statistics.complete) {
            (0, _) => format!("<sscc.Answer: free, norm {norm:.4}>"),
            (count, true) => format!("<sscc.Answer: colliding, {count} pairs, norm {norm:.4}>"),
            (count, false) => format!("<sscc.Answer: colliding, at least {count} pairs, norm {norm:.4}>"),
        }
    }
}

/// Returns the pickled form of an answer.
pub fn pickled<'py>(py: Python<'py>, found: &sscc::Answer) -> Pickled<'py> {
    let s = &found.statistics;
    let bytes: Vec<u8> =
        found.pairs.iter().flat_map(|(i, j)| [i.to_le_bytes(), j.to_le_bytes()]).flatten().collect();
    let cost = (s.root_certified, s.complete, s.opened, s.box_tests, s.triangle_tests);
    (PyBytes::new(py, &bytes), found.norm, cost)
}

/// Returns the answer of a pickled form. An error means damaged data.
pub fn unpickled((bytes, norm, cost): &Pickled<'_>) -> PyResult<sscc::Answer> {
    let (root_certified, complete, opened, box_tests, triangle_tests) = *cost;
    let statistics = Statistics { root_certified, complete, opened, box_tests, triangle_tests };
    let (numbers, []) = bytes.as_bytes().as_chunks::<8>() else {
        return Err(value("the pickled answer is damaged"));
    };
    let pair = |[a, b, c, d, e, f, g, h]: &[u8; 8]| {
        (u32::from_le_bytes([*a, *b, *c, *d]), u32::from_le_bytes([*e, *f, *g, *h]))
    };
    Ok(sscc::Answer { pairs: numbers.iter().map(pair).collect(), norm: *norm, statistics })
}

/// Constructor for pickled answers.
#[pyfunction]
pub fn _answer(answer: Pickled<'_>) -> PyResult<Answer> {
    Ok(Answer { found: unpickled(&answer)?, array: Cached::new() })
}
