//! `sscc.Answer`: the result of a query at one q.

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use sscc::{Pair, Proof, Statistics};
use sscc_tasks::text::{counted, length};

use crate::arrays::{CachedArray, cached, pairs};
use crate::errors::{kind, value};

/// The result of `__reduce__`: a function and its arguments.
pub type Reduction<'py, A> = (Bound<'py, PyAny>, A);

/// The pickled form of an answer: pairs (little-endian), norm, and the cost as in [`pickled`]. The first number of the cost
/// is the proof; earlier versions stored there whether the root's radius was the proof.
pub type PickledAnswer<'py> = (Bound<'py, PyBytes>, f64, (u8, bool, u64, u64, u64));

/// The proofs by their pickled numbers.
const PROOFS: [Proof; 3] = [Proof::Search, Proof::Radius, Proof::Local];

#[pyclass(frozen, module = "sscc", name = "Answer")]
pub struct Answer {
    /// The answer of the core.
    pub core: sscc::Answer,
    /// The array of its pairs.
    pub pairs_array: CachedArray,
}

impl Answer {
    #[inline]
    pub fn of(pairs: Vec<Pair>, statistics: Statistics) -> Self {
        Self { core: sscc::Answer { pairs, statistics }, pairs_array: CachedArray::new() }
    }
}

#[pymethods]
impl Answer {
    #[getter]
    fn pairs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        cached(py, &self.pairs_array, || pairs(py, &self.core.pairs))
    }

    #[getter]
    fn colliding(&self) -> bool {
        !self.core.pairs.is_empty()
    }

    #[getter]
    fn count(&self) -> usize {
        self.core.pairs.len()
    }

    #[getter]
    fn norm(&self) -> f64 {
        self.core.statistics.norm
    }

    #[getter]
    fn complete(&self) -> bool {
        self.core.statistics.complete
    }

    #[getter]
    fn root_certified(&self) -> bool {
        self.core.statistics.root_certified
    }

    #[getter]
    fn proof(&self) -> &'static str {
        self.core.statistics.proof.into()
    }

    #[getter]
    fn opened(&self) -> u64 {
        self.core.statistics.opened
    }

    #[getter]
    fn box_tests(&self) -> u64 {
        self.core.statistics.box_tests
    }

    #[getter]
    fn triangle_tests(&self) -> u64 {
        self.core.statistics.triangle_tests
    }

    fn __bool__(&self) -> PyResult<bool> {
        Err(kind("an Answer has no truth value: use .colliding"))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.core == other.core
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduction<'py, (PickledAnswer<'py>,)>> {
        Ok((py.import("sscc._sscc")?.getattr("_answer")?, (pickled(py, &self.core),)))
    }

    fn __repr__(&self) -> String {
        let result = result(self.core.pairs.len(), self.core.statistics.complete);
        format!("<sscc.Answer: {result}, norm {}>", length(self.core.statistics.norm))
    }
}

/// Returns the text for the number of pairs of an answer: a lower bound if a limit stopped the search.
pub fn result(count: usize, is_complete: bool) -> String {
    let pairs = counted(count as u64, "pair");
    match (count, is_complete) {
        (0, _) => "free".into(),
        (_, true) => format!("colliding, {pairs}"),
        (_, false) => format!("colliding, at least {pairs}"),
    }
}

/// Returns the pickled form of an answer.
pub fn pickled<'py>(py: Python<'py>, answer: &sscc::Answer) -> PickledAnswer<'py> {
    let s = &answer.statistics;
    let proof = PROOFS.iter().position(|proof| *proof == s.proof).unwrap_or_default() as u8;
    let cost = (proof, s.complete, s.opened, s.box_tests, s.triangle_tests);
    (pair_bytes(py, &answer.pairs), s.norm, cost)
}

/// Returns pairs as bytes (little-endian).
pub fn pair_bytes<'py>(py: Python<'py>, pairs: &[Pair]) -> Bound<'py, PyBytes> {
    let bytes: Vec<u8> =
        pairs.iter().flat_map(|(i, j)| [i.to_le_bytes(), j.to_le_bytes()]).flatten().collect();
    PyBytes::new(py, &bytes)
}

/// Returns the pairs in bytes of [`pair_bytes`].
///
/// # Errors
/// If the bytes are not a whole number of pairs.
pub fn pairs_of_bytes(bytes: &Bound<'_, PyBytes>) -> PyResult<Vec<Pair>> {
    let (numbers, []) = bytes.as_bytes().as_chunks::<8>() else {
        return Err(value("the pickled answer is damaged: its bytes are not a whole number of pairs"));
    };
    let pair = |[a, b, c, d, e, f, g, h]: &[u8; 8]| {
        (u32::from_le_bytes([*a, *b, *c, *d]), u32::from_le_bytes([*e, *f, *g, *h]))
    };
    Ok(numbers.iter().map(pair).collect())
}

/// Returns the answer of a pickled form.
///
/// # Errors
/// If the bytes are not a whole number of pairs, or the number of the proof is not known.
pub fn unpickled((bytes, norm, cost): &PickledAnswer<'_>) -> PyResult<sscc::Answer> {
    let (proof, complete, opened, box_tests, triangle_tests) = *cost;
    let Some(&proof) = PROOFS.get(usize::from(proof)) else {
        return Err(value("the pickled answer is damaged: its proof is not known"));
    };
    let root_certified = proof != Proof::Search;
    let statistics = Statistics {
        norm: *norm,
        root_certified,
        proof,
        complete,
        opened,
        box_tests,
        triangle_tests,
        ..Statistics::default()
    };
    Ok(sscc::Answer { pairs: pairs_of_bytes(bytes)?, statistics })
}

/// Unpickles answers.
#[pyfunction]
pub fn _answer(answer: PickledAnswer<'_>) -> PyResult<Answer> {
    Ok(Answer { core: unpickled(&answer)?, pairs_array: CachedArray::new() })
}
