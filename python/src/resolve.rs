//! `Certificates.resolve` and `Certificates.free_samples`: free configurations near colliding ones.

use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use sscc::{Error, ResolveOptions};

use crate::arguments::switch;
use crate::arrays::{copied, floats, line, table, vector};
use crate::errors::{refused, value};
use crate::interrupt::{answer, run_borrowing};
use crate::pool::{self, Pool};

/// Returns the options of a search: its start, and whether exceptions count.
fn options(
    pool: &Pool,
    start: Option<&Bound<'_, PyAny>>,
    all: Option<&Bound<'_, PyAny>>,
) -> PyResult<ResolveOptions> {
    let start = start.map(|start| vector(start, "start")).transpose()?;
    if let Some(start) = &start {
        let model = &pool.certified.loaded.model;
        model.check_coordinates(start).map_err(|error| refused(&error, "start"))?;
    }
    Ok(ResolveOptions::default().start(start).all(switch(all, "all")?.unwrap_or(false)))
}

/// Returns an error that names the argument at fault: the start if it collides, else the argument `name`.
fn refused_search(error: &Error, name: &str) -> PyErr {
    if *error == Error::ResolveStart { value(format!("start: {error}")) } else { refused(error, name) }
}

/// Returns a `sscc.Resolved`.
pub fn resolve<'py>(
    py: Python<'py>,
    pool: &Pool,
    q: &Bound<'py, PyAny>,
    start: Option<&Bound<'py, PyAny>>,
    all: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let q = vector(q, "q")?;
    let options = options(pool, start, all)?;
    let found = answer(py, || pool.with_query(|query| query.resolve(&q, &options)))?;
    let found = found.map_err(|error| refused_search(&error, "q"))?;
    let class = py.import("sscc._resolve")?.getattr("Resolved")?;
    let is_resolved = found.is_resolved();
    class.call1((is_resolved, found.q.map(|q| line(py, q)), found.change, found.safe_scale_change))
}

/// Returns a `sscc.FreeSamples`.
#[allow(clippy::too_many_arguments)]
pub fn free_samples<'py>(
    py: Python<'py>,
    pool: &Pool,
    draws: &Bound<'py, PyAny>,
    resolve: Option<&Bound<'py, PyAny>>,
    start: Option<&Bound<'py, PyAny>>,
    all: Option<&Bound<'py, PyAny>>,
    threads: Option<&Bound<'py, PyAny>>,
    progress: Option<&Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let model = &pool.certified.loaded.model;
    let rank = model.rank();
    let array = floats(draws, "draws")?;
    if array.ndim() != 2 || array.shape()[1] != rank {
        return Err(value(format!("draws has shape {:?}: (n, {rank}) was expected", array.shape())));
    }
    let entries = copied(&array, "draws")?;
    let rows: Vec<&[f64]> = entries.chunks_exact(rank).collect();
    for (row, q) in rows.iter().enumerate() {
        model.check_coordinates(q).map_err(|error| refused(&error, &format!("draws[{row}]")))?;
    }
    let is_resolving = switch(resolve, "resolve")?.unwrap_or(true);
    if !is_resolving && (start.is_some() || all.is_some()) {
        return Err(value("resolve is False, so start and all have no effect: leave them out"));
    }
    let options = is_resolving.then(|| options(pool, start, all)).transpose()?;
    let threads = pool::threads(threads)?;
    let found = run_borrowing(py, progress, "resolving", |progress| {
        pool.first().free_samples(&rows, options.as_ref(), threads, progress)
    })?;
    let found = found.map_err(|error| refused_search(&error, "draws"))?;
    let class = py.import("sscc._resolve")?.getattr("FreeSamples")?;
    let draws: Vec<i64> = found.draws.iter().map(|draw| *draw as i64).collect();
    let q = table(py, rank, found.q.concat())?;
    class.call1((q, line(py, draws), line(py, found.changes), found.drawn, found.free))
}
