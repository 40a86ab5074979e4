//! `sscc.DetectorAnswer` and `sscc.DetectorImpacts`: the results of a detector at given positions and between them.
//!
//! The cost of an answer depends on earlier calls, because the detector rebuilds its BVH. So equality compares only pairs,
//! times and completeness.

use std::sync::Arc;

use glam::DVec3;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyBytes, PyList};
use sscc::parts::Penetration;
use sscc::{Answer, Impact, Pair, Statistics};
use sscc_tasks::text::counted;

use crate::answer::{Reduction, pair_bytes, pairs_of_bytes, result};
use crate::arrays::{CachedArray, cached, frozen, line, pairs, table};
use crate::contacts::{Contacts, Curve, PickledContacts};
use crate::errors::{kind, value};
use crate::interrupt::{answer, run};

/// The pickled form of pairs: their bytes, and `complete`, `opened`, `box_tests`, `triangle_tests`, `tree_cost`,
/// `rebuilds`.
pub type PickledFrame<'py> = (Bound<'py, PyBytes>, (bool, u64, u64, u64, f64, u64));

/// The pickled form of an answer: pairs, and their triangles if there are pairs.
pub type PickledAnswer<'py> = (PickledFrame<'py>, Option<PickledContacts<'py>>);

/// An answer of the core, and the triangles of its pairs.
#[derive(Clone)]
pub struct FoundFrame {
    pub frame: Answer,
    /// `None` if there are no pairs.
    contacts: Option<Arc<Contacts>>,
}

impl FoundFrame {
    /// Creates the answer. `contacts` copies the triangles of pairs.
    pub fn of(frame: Answer, contacts: impl FnOnce(&[Pair]) -> Contacts) -> Self {
        let contacts = (!frame.pairs.is_empty()).then(|| Arc::new(contacts(&frame.pairs)));
        Self { frame, contacts }
    }

    /// Returns the pickled form.
    pub fn pickled<'py>(&self, py: Python<'py>) -> PickledAnswer<'py> {
        (pickled(py, &self.frame), self.contacts.as_ref().map(|contacts| contacts.pickled(py)))
    }

    /// Returns the answer of a pickled form.
    ///
    /// # Errors
    /// If the bytes are damaged, or there are pairs without triangles or the reverse.
    pub fn unpickled((frame, contacts): &PickledAnswer<'_>) -> PyResult<Self> {
        let contacts = contacts.as_ref().map(Contacts::unpickled).transpose()?.map(Arc::new);
        let frame = unpickled(frame)?;
        if frame.pairs.is_empty() == contacts.is_some() {
            return Err(value(
                "the pickled answer is damaged: it has pairs without triangles, or the reverse",
            ));
        }
        Ok(Self { frame, contacts })
    }
}

#[pyclass(frozen, module = "sscc", name = "DetectorAnswer")]
pub struct DetectorAnswer {
    found: FoundFrame,
    pairs_array: CachedArray,
}

impl DetectorAnswer {
    pub fn of(found: FoundFrame) -> Self {
        Self { found, pairs_array: CachedArray::new() }
    }

    fn penetrations(&self, py: Python<'_>) -> PyResult<Vec<Penetration>> {
        let Some(contacts) = &self.found.contacts else { return Ok(Vec::new()) };
        answer(py, || contacts.penetrations(&self.found.frame.pairs))?
    }
}

#[pymethods]
impl DetectorAnswer {
    #[getter]
    fn pairs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        cached(py, &self.pairs_array, || pairs(py, &self.found.frame.pairs))
    }

    #[getter]
    fn colliding(&self) -> bool {
        !self.found.frame.pairs.is_empty()
    }

    #[getter]
    fn count(&self) -> usize {
        self.found.frame.pairs.len()
    }

    #[getter]
    fn complete(&self) -> bool {
        self.found.frame.statistics.complete
    }

    #[getter]
    fn opened(&self) -> u64 {
        self.found.frame.statistics.opened
    }

    #[getter]
    fn box_tests(&self) -> u64 {
        self.found.frame.statistics.box_tests
    }

    #[getter]
    fn triangle_tests(&self) -> u64 {
        self.found.frame.statistics.triangle_tests
    }

    #[getter]
    fn tree_cost(&self) -> f64 {
        self.found.frame.statistics.tree_cost
    }

    #[getter]
    fn rebuilds(&self) -> u64 {
        self.found.frame.statistics.rebuilds
    }

    fn curves<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyList>> {
        let curves = match &self.found.contacts {
            Some(contacts) => {
                let (contacts, pairs) = (Arc::clone(contacts), self.found.frame.pairs.clone());
                // Nothing can cancel this work. It runs on another thread, so that Ctrl-C need not wait for its end.
                let silent = PyBool::new(py, false).to_owned().into_any();
                run(py, Some(&silent), "", move |_| contacts.curves(&pairs))??
            }
            None => Vec::new(),
        };
        Curve::to_list(py, curves)
    }

    fn depths<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let depths = self.penetrations(py)?.iter().map(|penetration| penetration.depth).collect();
        frozen(line::<f64>(py, depths))
    }

    fn directions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let directions = self.penetrations(py)?;
        let directions = directions.iter().flat_map(|penetration| DVec3::to_array(&penetration.direction));
        frozen(table::<f64>(py, 3, directions.collect())?)
    }

    fn __bool__(&self) -> PyResult<bool> {
        Err(kind("a DetectorAnswer has no truth value: use .colliding"))
    }

    fn __eq__(&self, other: &Self) -> bool {
        is_same(&self.found.frame, &other.found.frame)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduction<'py, (PickledAnswer<'py>,)>> {
        Ok((py.import("sscc._sscc")?.getattr("_detector_answer")?, (self.found.pickled(py),)))
    }

    fn __repr__(&self) -> String {
        let frame = &self.found.frame;
        format!("<sscc.DetectorAnswer: {}>", result(frame.pairs.len(), frame.statistics.complete))
    }
}

#[pyclass(frozen, module = "sscc", name = "DetectorImpacts")]
pub struct DetectorImpacts {
    /// The pairs and the cost.
    frame: Answer,
    /// The time of impact of each pair.
    times: Vec<f64>,
    pairs_array: CachedArray,
    times_array: CachedArray,
}

impl DetectorImpacts {
    pub fn of(impacts: &[Impact], statistics: Statistics) -> Self {
        let pairs: Vec<Pair> = impacts.iter().map(|impact| impact.pair).collect();
        let times = impacts.iter().map(|impact| impact.time).collect();
        Self::from_parts(Answer { pairs, statistics }, times)
    }

    fn from_parts(frame: Answer, times: Vec<f64>) -> Self {
        Self { frame, times, pairs_array: CachedArray::new(), times_array: CachedArray::new() }
    }
}

#[pymethods]
impl DetectorImpacts {
    #[getter]
    fn pairs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        cached(py, &self.pairs_array, || pairs(py, &self.frame.pairs))
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
    fn complete(&self) -> bool {
        self.frame.statistics.complete
    }

    #[getter]
    fn opened(&self) -> u64 {
        self.frame.statistics.opened
    }

    #[getter]
    fn box_tests(&self) -> u64 {
        self.frame.statistics.box_tests
    }

    #[getter]
    fn triangle_tests(&self) -> u64 {
        self.frame.statistics.triangle_tests
    }

    #[getter]
    fn tree_cost(&self) -> f64 {
        self.frame.statistics.tree_cost
    }

    #[getter]
    fn rebuilds(&self) -> u64 {
        self.frame.statistics.rebuilds
    }

    fn __bool__(&self) -> PyResult<bool> {
        Err(kind("DetectorImpacts have no truth value: use .colliding"))
    }

    fn __eq__(&self, other: &Self) -> bool {
        is_same(&self.frame, &other.frame) && self.times == other.times
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduction<'py, (PickledFrame<'py>, Vec<f64>)>> {
        let make = py.import("sscc._sscc")?.getattr("_detector_impacts")?;
        Ok((make, (pickled(py, &self.frame), self.times.clone())))
    }

    fn __repr__(&self) -> String {
        match self.time_of_impact() {
            None => "<sscc.DetectorImpacts: free from start to end>".into(),
            Some(time) => {
                let pairs = counted(self.times.len() as u64, "pair");
                format!("<sscc.DetectorImpacts: {pairs}, the first at {time:.4}>")
            }
        }
    }
}

/// Whether two answers are equal, apart from their cost.
pub fn is_same(a: &Answer, b: &Answer) -> bool {
    a.pairs == b.pairs && a.statistics.complete == b.statistics.complete
}

/// Returns the pickled form of pairs.
fn pickled<'py>(py: Python<'py>, frame: &Answer) -> PickledFrame<'py> {
    let s = &frame.statistics;
    let cost = (s.complete, s.opened, s.box_tests, s.triangle_tests, s.tree_cost, s.rebuilds);
    (pair_bytes(py, &frame.pairs), cost)
}

/// Returns the pairs of a pickled form.
///
/// # Errors
/// If the bytes are not a whole number of pairs.
fn unpickled((bytes, cost): &PickledFrame<'_>) -> PyResult<Answer> {
    let (complete, opened, box_tests, triangle_tests, tree_cost, rebuilds) = *cost;
    let statistics = Statistics {
        complete,
        opened,
        box_tests,
        triangle_tests,
        tree_cost,
        rebuilds,
        ..Statistics::default()
    };
    Ok(Answer { pairs: pairs_of_bytes(bytes)?, statistics })
}

/// Unpickles answers.
#[pyfunction]
pub fn _detector_answer(answer: PickledAnswer<'_>) -> PyResult<DetectorAnswer> {
    Ok(DetectorAnswer::of(FoundFrame::unpickled(&answer)?))
}

/// Unpickles impacts.
#[pyfunction]
pub fn _detector_impacts(frame: PickledFrame<'_>, times: Vec<f64>) -> PyResult<DetectorImpacts> {
    let frame = unpickled(&frame)?;
    if frame.pairs.len() != times.len() {
        return Err(value("the pickled impacts are damaged: pairs and times differ in number"));
    }
    Ok(DetectorImpacts::from_parts(frame, times))
}
