//! `Certificates.sweep` and `Certificates.intervals`: their arguments, and their results as lists of `sscc.Sweep` and
//! `sscc.Intervals`.

use numpy::{PyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyList, PyString};
use sscc::{ModeRange, Sweep, SweepOutcome, WeightInterval};
use sscc_tasks::{SweepRange, nearest};

use crate::arguments::count;
use crate::arrays::{copied, floats, frozen, pairs, vector};
use crate::errors::{refused, value};
use crate::interrupt::run_borrowing;
use crate::model::LoadedModel;
use crate::pool::{Pool, threads};

/// Default number of samples of each weight.
const SAMPLES: usize = 101;

/// The arguments of sweeps and intervals, except `progress` and `samples`; `None` for an absent argument.
pub struct SweepArguments<'a, 'py> {
    pub range: Option<&'a Bound<'py, PyAny>>,
    pub q: Option<&'a Bound<'py, PyAny>>,
    pub modes: Option<&'a Bound<'py, PyAny>>,
    pub threads: Option<&'a Bound<'py, PyAny>>,
}

impl<'py> SweepArguments<'_, 'py> {
    /// Sweeps the modes. Ctrl-C stops the sweeps.
    pub fn run(
        &self,
        py: Python<'py>,
        pool: &Pool,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyList>> {
        let loaded = &*pool.certified.loaded;
        let (q, modes) = self.ways(py, pool)?;
        let threads = threads(self.threads)?;
        let swept = run_borrowing(py, progress, "sweeping", |progress| {
            pool.first().sweep_modes(&q, &modes, threads, progress)
        })?;
        let sweeps = swept.map_err(|error| refused(&error, "range"))?;
        let class = py.import("sscc._sweep")?.getattr("Sweep")?;
        let made = sweeps.into_iter().map(|sweep| {
            let Sweep { mode, from, to, first_free, first_hit, outcome, .. } = sweep;
            let name = name(loaded, mode);
            let is_usual = matches!(outcome, SweepOutcome::Free | SweepOutcome::Hit);
            let note = (!is_usual).then(|| outcome.to_string());
            let pairs = frozen(pairs(py, &sweep.pairs)?)?;
            class.call1((mode, name, from, to, first_free, first_hit, pairs, note))
        });
        PyList::new(py, made.collect::<PyResult<Vec<_>>>()?)
    }

    /// Finds intervals. Ctrl-C stops the search.
    pub fn intervals(
        &self,
        py: Python<'py>,
        pool: &Pool,
        samples: Option<&Bound<'py, PyAny>>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyList>> {
        let samples = count(samples, "samples", 2..=1 << 20)?.unwrap_or(SAMPLES);
        let (q, modes) = self.ways(py, pool)?;
        let threads = threads(self.threads)?;
        let found = run_borrowing(py, progress, "sweeping", |progress| {
            pool.first().sweep_intervals(&q, &modes, samples, threads, progress)
        })?;
        let found = found.map_err(|error| refused(&error, "range"))?;
        let module = py.import("sscc._sweep")?;
        let [class, interval_class] = [module.getattr("Intervals")?, module.getattr("Interval")?];
        let made = found.into_iter().map(|found| {
            let ModeRange { mode, low, high } = found.range;
            let intervals = found.intervals.iter().map(|interval| {
                let WeightInterval { free_until, from, to, free_from, is_exact, deepest, pairs } = *interval;
                let (depth, at) = (deepest.depth, deepest.weight);
                interval_class.call1((from, to, free_until, free_from, is_exact, pairs, depth, at))
            });
            let intervals = PyList::new(py, intervals.collect::<PyResult<Vec<_>>>()?)?;
            let rows = found.samples.iter().map(|s| vec![s.weight, s.pairs as f64, s.depth]);
            let rows = PyArray2::from_vec2(py, &rows.collect::<Vec<_>>())
                .map_err(|error| value(error.to_string()))?;
            class.call1((
                mode,
                name(&pool.certified.loaded, mode),
                low,
                high,
                intervals,
                frozen(rows.into_any())?,
            ))
        });
        PyList::new(py, made.collect::<PyResult<Vec<_>>>()?)
    }

    /// Returns the q at the start, and the modes to sweep with their ranges.
    fn ways(&self, py: Python<'py>, pool: &Pool) -> PyResult<(Vec<f64>, Vec<ModeRange>)> {
        let certified = &pool.certified;
        let (loaded, center) = (&*certified.loaded, certified.certificates.center());
        let q = self.q.map_or_else(|| Ok(center.to_vec()), |q| vector(q, "q"))?;
        loaded.model.check_coordinates(&q).map_err(|error| refused(&error, "q"))?;
        let ranges = self.ranges(py, loaded, &q)?;
        let modes = self.modes(loaded)?.into_iter().map(|mode| {
            let [low, high] = ranges[mode];
            ModeRange { mode, low, high }
        });
        Ok((q, modes.collect()))
    }

    /// Returns the range of each mode.
    fn ranges(&self, py: Python<'py>, loaded: &LoadedModel, q: &[f64]) -> PyResult<Vec<[f64; 2]>> {
        let Some(range) = self.range else {
            let range = SweepRange::of_modes(&loaded.mode_names, loaded.info.deviations.as_deref());
            return Ok(py.detach(|| range.ends(&loaded.model, q)));
        };
        let array = floats(range, "range")?;
        let entries = copied(&array, "range")?;
        let (rows, []) = entries.as_chunks::<2>() else { return Err(self.shape(array.shape(), q.len())) };
        match array.shape() {
            [2] => Ok(vec![rows[0]; q.len()]),
            [rank, 2] if *rank == q.len() => Ok(rows.to_vec()),
            shape => Err(self.shape(shape, q.len())),
        }
    }

    fn shape(&self, shape: &[usize], rank: usize) -> PyErr {
        value(format!("range has shape {shape:?}: (2,) or ({rank}, 2) was expected"))
    }

    /// Returns the numbers of the modes to sweep.
    fn modes(&self, loaded: &LoadedModel) -> PyResult<Vec<usize>> {
        let rank = loaded.model.rank();
        let Some(modes) = self.modes else { return Ok((0..rank).collect()) };
        let names = &loaded.mode_names;
        let mut numbers = Vec::new();
        for item in modes.try_iter()? {
            let item = item?;
            let Ok(name) = item.cast::<PyString>() else {
                numbers.extend(count(Some(&item), "modes", 0..=rank - 1)?);
                continue;
            };
            let name = name.to_string_lossy();
            let unknown = || match nearest(&name, names.iter().map(String::as_str)) {
                Some(nearest) => {
                    value(format!("modes: no mode has the name {name:?}; the nearest name is {nearest:?}"))
                }
                None => value(format!(
                    "modes: no mode has the name {name:?}: the modes of this model have no names"
                )),
            };
            numbers.push(names.iter().position(|known| *known == *name).ok_or_else(unknown)?);
        }
        Ok(numbers)
    }
}

/// Returns the name of a mode, or its number.
fn name(loaded: &LoadedModel, mode: usize) -> String {
    loaded.mode_names.get(mode).cloned().unwrap_or_else(|| mode.to_string())
}
