//! The part of `sscc.simulate` in Rust: its arguments, and the files that it writes.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;
use sscc::{CancelToken, Progress};
use sscc_sim::{Outputs, Request, SimError, Stage, Watch, simulate};
use sscc_view::simulation_report;

use crate::arguments::{count, path, switch};
use crate::errors::{refused_simulation, warn};
use crate::interrupt::run_borrowing;
use crate::pool;

/// Simulates a scene; returns its summary (JSON), the folder and the files in it.
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
    let (written, notes) = run_borrowing(py, None, "simulating", |progress| {
        let steps = Steps { progress, are_simulated: AtomicBool::new(false), notes: Mutex::default() };
        let written = simulated(&request, &steps);
        (written, steps.notes.into_inner().unwrap_or_else(PoisonError::into_inner))
    })?;
    warn(py, &notes)?;
    written.map_err(|error| refused_simulation(&error))
}

/// Simulates a scene and writes all files.
fn simulated(request: &Request, steps: &Steps<'_>) -> Result<(String, PathBuf, Vec<PathBuf>), SimError> {
    let run = simulate(request, steps)?;
    let mut outputs = Outputs::write(&run);
    outputs.add_report(simulation_report(&run, steps));
    let written = (run.summary.to_json(), run.folder.clone(), outputs.files());
    outputs.finish(run)?;
    Ok(written)
}

/// Reports the progress of steps only, so that the share done never decreases; collects notes.
struct Steps<'a> {
    progress: &'a dyn Progress,
    are_simulated: AtomicBool,
    notes: Mutex<Vec<String>>,
}

impl Progress for Steps<'_> {
    fn report(&self, done: usize, total: usize) {
        if self.are_simulated.load(Ordering::Relaxed) {
            self.progress.report(done, total);
        }
    }

    fn cancel_token(&self) -> Option<&CancelToken> {
        self.progress.cancel_token()
    }
}

impl Watch for Steps<'_> {
    fn begin(&self, stage: Stage) {
        self.are_simulated.store(matches!(stage, Stage::Steps { .. }), Ordering::Relaxed);
    }

    fn note(&self, note: &str) {
        self.notes.lock().unwrap_or_else(PoisonError::into_inner).push(note.into());
    }
}
