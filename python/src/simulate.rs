//! `sscc.simulate`: what is in Rust of it.

use std::path::PathBuf;
use std::sync::{Mutex, TryLockError};

use pyo3::exceptions::{PyOSError, PyRuntimeError};
use pyo3::prelude::*;
use pyo3::types::PyBool;
use sscc_cli::simulate::{Request, simulate, stop};
use sscc_io::IoError;

use crate::arguments::{count, path, switch};
use crate::errors::{file, value};
use crate::interrupt::run_borrowing;
use crate::pool;

/// Stopping one stops all.
static ONLY: Mutex<()> = Mutex::new(());

/// Simulates a scene: its summary (JSON), the folder and the files in it.
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
        steps: count(steps, "steps", 1..=u32::MAX as usize)?.map(|steps| steps as u32),
        restart: switch(restart, "restart")?.unwrap_or(false),
        models: folder(models, "models")?,
        cache: folder(cache, "cache")?,
        threads: pool::threads(threads)?.map(|threads| threads as u32),
    };
    let _only = match ONLY.try_lock() {
        Ok(only) => only,
        // One that panicked has ended.
        Err(TryLockError::Poisoned(only)) => only.into_inner(),
        Err(TryLockError::WouldBlock) => {
            return Err(PyRuntimeError::new_err(
                "another simulation goes on in this process; wait for its end",
            ));
        }
    };
    stop(false);
    let no = PyBool::new(py, false);
    let written = run_borrowing(py, Some(no.as_any()), "simulating", |progress| {
        std::thread::scope(|scope| {
            let work = scope.spawn(|| simulate(request));
            while !work.is_finished() {
                std::thread::sleep(std::time::Duration::from_millis(10));
                if progress.is_cancelled() {
                    stop(true);
                }
            }
            work.join()
        })
    });
    stop(false);
    match written? {
        Ok(Ok(written)) => Ok((written.summary, written.folder, written.files)),
        Ok(Err(error)) => {
            Err(match (error.downcast_ref::<IoError>(), error.downcast_ref::<std::io::Error>()) {
                (Some(error), _) => file(error),
                (None, Some(_)) => PyOSError::new_err(format!("{error:#}")),
                (None, None) => value(format!("{error:#}")),
            })
        }
        Err(panic) => std::panic::resume_unwind(panic),
    }
}
