//! `sscc.Batch`: the answers for many q.

use numpy::{PyFixedUnicode, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::PyList;
use sscc_tasks::text::{counted, grouped};

use crate::answer::{Answer, PickledAnswer, Reduction, pickled, unpickled};
use crate::arguments::count;
use crate::arrays::{CachedArray, cached, copied, floats, line, table};
use crate::errors::{refused, room, value};
use crate::interrupt::run_borrowing;
use crate::pool::{self, Pool};

#[pyclass(frozen, module = "sscc", name = "Batch")]
pub struct Batch {
    pub answers: Vec<sscc::Answer>,
    /// The arrays of the getters, each at the number that its getter has below.
    arrays: [CachedArray; 10],
}

impl Batch {
    pub fn of(answers: Vec<sscc::Answer>) -> Self {
        Self { answers, arrays: std::array::from_fn(|_| CachedArray::new()) }
    }

    fn column<'py, T: numpy::Element>(
        &self,
        py: Python<'py>,
        column: usize,
        of: impl Fn(&sscc::Answer) -> T,
    ) -> PyResult<Bound<'py, PyAny>> {
        cached(py, &self.arrays[column], || {
            let mut items = room(self.answers.len(), "Batch")?;
            items.extend(self.answers.iter().map(of));
            Ok(line(py, items))
        })
    }
}

#[pymethods]
impl Batch {
    #[getter]
    fn colliding<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, 0, |answer| !answer.pairs.is_empty())
    }

    #[getter]
    fn count<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, 1, |answer| answer.pairs.len() as i64)
    }

    #[getter]
    fn norm<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, 2, |answer| answer.statistics.norm)
    }

    #[getter]
    fn complete<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, 3, |answer| answer.statistics.complete)
    }

    #[getter]
    fn root_certified<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, 4, |answer| answer.statistics.root_certified)
    }

    #[getter]
    fn proof<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, 9, |answer| fixed(answer.statistics.proof.into()))
    }

    #[getter]
    fn opened<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, 5, |answer| answer.statistics.opened)
    }

    #[getter]
    fn triangle_tests<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.column(py, 6, |answer| answer.statistics.triangle_tests)
    }

    #[getter]
    fn pairs<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        cached(py, &self.arrays[7], || {
            let total: usize = self.answers.iter().map(|answer| answer.pairs.len()).sum();
            let mut entries = room(2 * total, "pairs")?;
            let all = self.answers.iter().flat_map(|answer| &answer.pairs);
            entries.extend(all.flat_map(|(i, j)| [*i, *j]));
            table::<u32>(py, 2, entries)
        })
    }

    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        cached(py, &self.arrays[8], || {
            let mut offsets = room(self.answers.len() + 1, "offsets")?;
            offsets.push(0_i64);
            let mut end = 0;
            offsets.extend(self.answers.iter().map(|answer| {
                end += answer.pairs.len() as i64;
                end
            }));
            Ok(line(py, offsets))
        })
    }

    fn __len__(&self) -> usize {
        self.answers.len()
    }

    fn __iter__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let builtins = slf.py().import("builtins")?;
        let indices = builtins.call_method1("range", (slf.get().answers.len(),))?;
        builtins.call_method1("map", (slf.getattr("__getitem__")?, indices))
    }

    fn __getitem__(&self, index: isize) -> PyResult<Answer> {
        let from_start = if index < 0 { index + self.answers.len() as isize } else { index };
        match usize::try_from(from_start).ok().and_then(|index| self.answers.get(index)) {
            Some(answer) => Ok(Answer::of(answer.pairs.clone(), answer.statistics)),
            None => Err(PyIndexError::new_err(format!("the batch has {} answers", self.answers.len()))),
        }
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.answers == other.answers
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduction<'py, (Bound<'py, PyList>,)>> {
        let answers: PyResult<Vec<PickledAnswer<'py>>> =
            self.answers.iter().map(|answer| Ok(pickled(py, answer))).collect();
        Ok((py.import("sscc._sscc")?.getattr("_batch")?, (PyList::new(py, answers?)?,)))
    }

    fn __repr__(&self) -> String {
        let colliding = self.answers.iter().filter(|answer| !answer.pairs.is_empty()).count() as u64;
        format!(
            "<sscc.Batch: {}, {} colliding>",
            counted(self.answers.len() as u64, "answer"),
            grouped(colliding)
        )
    }
}

/// Returns a short ASCII text as an entry of an array.
fn fixed(text: &str) -> PyFixedUnicode<6> {
    let mut entry = [0; 6];
    entry.iter_mut().zip(text.bytes()).for_each(|(entry, byte)| *entry = u32::from(byte));
    entry.into()
}

/// Unpickles batches.
#[pyfunction]
pub fn _batch(answers: Vec<PickledAnswer<'_>>) -> PyResult<Batch> {
    Ok(Batch::of(answers.iter().map(unpickled).collect::<PyResult<_>>()?))
}

/// Returns a copy of the entries of Q (n, r).
pub fn entries(array: &PyReadonlyArrayDyn<'_, f64>, rank: usize) -> PyResult<Vec<f64>> {
    if array.ndim() != 2 || array.shape()[1] != rank {
        let hint = if array.ndim() == 1 { "; for one q use check" } else { "" };
        return Err(value(format!("Q has shape {:?}: (n, {rank}) was expected{hint}", array.shape())));
    }
    copied(array, "Q")
}

/// Returns the rows of the entries of Q.
pub fn rows(entries: &[f64], rank: usize) -> PyResult<Vec<&[f64]>> {
    let mut rows = room(entries.len() / rank, "Q")?;
    rows.extend(entries.chunks_exact(rank));
    Ok(rows)
}

/// Returns a copy of the entries of Q (n, r). An error names the row that is not a configuration of the model.
pub fn checked_entries(pool: &Pool, array: &PyReadonlyArrayDyn<'_, f64>) -> PyResult<Vec<f64>> {
    let model = &pool.certified.loaded.model;
    let entries = entries(array, model.rank())?;
    for (row, q) in entries.chunks_exact(model.rank()).enumerate() {
        model.check_coordinates(q).map_err(|error| refused(&error, &format!("Q[{row}]")))?;
    }
    Ok(entries)
}

/// Answers every row of Q. Errors name the row.
pub fn check_many(
    py: Python<'_>,
    pool: &Pool,
    #[allow(non_snake_case)] Q: &Bound<'_, PyAny>,
    limit: Option<&Bound<'_, PyAny>>,
    threads: Option<&Bound<'_, PyAny>>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Batch> {
    let model = &pool.certified.loaded.model;
    let limit = count(limit, "limit", 1..=usize::MAX)?.unwrap_or(usize::MAX);
    let threads = pool::threads(threads)?;
    let entries = entries(&floats(Q, "Q")?, model.rank())?;
    let rows = rows(&entries, model.rank())?;
    let answers = run_borrowing(py, progress, "checking", |progress| {
        pool.first().batch_at_most(&rows, limit, threads, progress)
    })?;
    let error = match answers {
        Ok(answers) => return Ok(Batch::of(answers)),
        Err(error) => error,
    };
    let at_fault =
        rows.iter().enumerate().find_map(|(row, q)| Some((row, model.check_coordinates(q).err()?)));
    Err(match at_fault {
        Some((row, error)) => refused(&error, &format!("Q[{row}]")),
        None => refused(&error, "Q"),
    })
}
