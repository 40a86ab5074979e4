//! `sscc.DetectorBatch`: the answers of a detector for many frames.

use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::PyList;
use sscc::Answer;
use sscc_tasks::text::{counted, grouped};

use crate::answer::Reduction;
use crate::arrays::{CachedArray, cached, line, table};
use crate::detector_answer::{DetectorAnswer, FoundFrame, PickledAnswer, is_same};
use crate::errors::room;

#[pyclass(frozen, module = "sscc", name = "DetectorBatch")]
pub struct DetectorBatch {
    frames: Vec<FoundFrame>,
    /// The arrays of the getters, in their order below.
    arrays: [CachedArray; 9],
}

impl DetectorBatch {
    pub fn of(frames: Vec<FoundFrame>) -> Self {
        Self { frames, arrays: std::array::from_fn(|_| CachedArray::new()) }
    }

    fn column<'py, T: numpy::Element>(
        &self,
        py: Python<'py>,
        column: usize,
        of: impl Fn(&Answer) -> T,
    ) -> PyResult<Bound<'py, PyAny>> {
        cached(py, &self.arrays[column], || {
            let mut items = room(self.frames.len(), "DetectorBatch")?;
            items.extend(self.frames.iter().map(|found| of(&found.frame)));
            Ok(line(py, items))
        })
    }
}

#[pymethods]
impl DetectorBatch {
    #[getter]
    fn colliding<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, 0, |frame| !frame.pairs.is_empty())
    }

    #[getter]
    fn count<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, 1, |frame| frame.pairs.len() as i64)
    }

    #[getter]
    fn complete<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, 2, |frame| frame.statistics.complete)
    }

    #[getter]
    fn opened<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, 3, |frame| frame.statistics.opened)
    }

    #[getter]
    fn box_tests<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, 4, |frame| frame.statistics.box_tests)
    }

    #[getter]
    fn triangle_tests<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, 5, |frame| frame.statistics.triangle_tests)
    }

    #[getter]
    fn tree_cost<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, 6, |frame| frame.statistics.tree_cost)
    }

    #[getter]
    fn pairs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        cached(py, &self.arrays[7], || {
            let total: usize = self.frames.iter().map(|found| found.frame.pairs.len()).sum();
            let mut entries = room(2 * total, "pairs")?;
            let pairs = self.frames.iter().flat_map(|found| &found.frame.pairs);
            entries.extend(pairs.flat_map(|(i, j)| [*i, *j]));
            table::<u32>(py, 2, entries)
        })
    }

    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        cached(py, &self.arrays[8], || {
            let mut offsets = room(self.frames.len() + 1, "offsets")?;
            offsets.push(0_i64);
            let mut end = 0;
            offsets.extend(self.frames.iter().map(|found| {
                end += found.frame.pairs.len() as i64;
                end
            }));
            Ok(line(py, offsets))
        })
    }

    fn __len__(&self) -> usize {
        self.frames.len()
    }

    fn __iter__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let builtins = slf.py().import("builtins")?;
        let indices = builtins.call_method1("range", (slf.get().frames.len(),))?;
        builtins.call_method1("map", (slf.getattr("__getitem__")?, indices))
    }

    fn __getitem__(&self, index: isize) -> PyResult<DetectorAnswer> {
        let from_start = if index < 0 { index + self.frames.len() as isize } else { index };
        match usize::try_from(from_start).ok().and_then(|index| self.frames.get(index)) {
            Some(found) => Ok(DetectorAnswer::of(found.clone())),
            None => Err(PyIndexError::new_err(format!("the batch has {} answers", self.frames.len()))),
        }
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.frames.len() == other.frames.len()
            && self.frames.iter().zip(&other.frames).all(|(a, b)| is_same(&a.frame, &b.frame))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduction<'py, (Bound<'py, PyList>,)>> {
        let frames: Vec<PickledAnswer<'py>> = self.frames.iter().map(|found| found.pickled(py)).collect();
        Ok((py.import("sscc._sscc")?.getattr("_detector_batch")?, (PyList::new(py, frames)?,)))
    }

    fn __repr__(&self) -> String {
        let colliding = self.frames.iter().filter(|found| !found.frame.pairs.is_empty()).count() as u64;
        let frames = counted(self.frames.len() as u64, "answer");
        format!("<sscc.DetectorBatch: {frames}, {} colliding>", grouped(colliding))
    }
}

/// Unpickles batches.
#[pyfunction]
pub fn _detector_batch(frames: Vec<PickledAnswer<'_>>) -> PyResult<DetectorBatch> {
    Ok(DetectorBatch::of(frames.iter().map(FoundFrame::unpickled).collect::<PyResult<_>>()?))
}
