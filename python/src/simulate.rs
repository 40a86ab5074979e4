//! The part of `sscc.simulate` in Rust: its arguments, and the files that it writes.

use std::path::PathBuf;

use pyo3::prelude::*;
use sscc_sim::{Outputs, Request, SimError, simulate};
use sscc_view::simulation_report;

use crate::arguments::{count, path, switch};
use crate::errors::{refused_simulation, warn};
use crate::interrupt::run_borrowing;
use crate::pool;
use crate::watching::Watching;

/// Simulates a scene; returns its summary (JSON), the folder of the results, and the written files.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn _simulate(
    py: Python<'_>,
    scene: &Bound<'_, PyAny>,
    out: Option<&Bound<'_, PyAny>>,
    steps: Option<&Bound<'_, PyAny>>,
    restart: Option<&Bound<'_, PyAny>>,
    models: Option<&Bound<'_, PyAny>>,
    cache: Option<&Bound<'_, PyAny>>,
    threads: Option<&Bound<'_, PyAny>>,
) -> PyResult<(String, PathBuf, Vec<PathBuf>)> {
    let folder = |any: Option<&Bound<'_, PyAny>>, name: &str| any.map(|any| path(any, name)).transpose();
    let request = Request {
        scene: path(scene, "scene")?,
        out: folder(out, "out")?,
        steps: count(steps, "steps", 1..=u32::MAX as usize)?,
        restart: switch(restart, "restart")?.unwrap_or(false),
        models: folder(models, "models")?,
        cache: folder(cache, "cache")?,
        threads: pool::threads(threads)?,
    };
    let mut notes = Vec::new();
    let written = run_borrowing(py, None, "simulating", |progress| {
        let steps = Watching::steps(progress);
        let written = simulated(&request, &steps);
        notes = steps.notes();
        written
    })?;
    warn(py, &notes)?;
    written.map_err(|error| refused_simulation(&error))
}

/// Simulates a scene and writes all files.
fn simulated(request: &Request, steps: &Watching<'_>) -> Result<(String, PathBuf, Vec<PathBuf>), SimError> {
    let run = simulate(request, steps)?;
    let mut outputs = Outputs::write(&run);
    outputs.add_report(simulation_report(&run, steps));
    let written = (run.summary.to_json(), run.folder.clone(), outputs.files());
    outputs.finish(run)?;
    Ok(written)
}
