//! Conversion of errors to Python exceptions that name the argument.

use std::ffi::CString;

use pyo3::exceptions::{
    PyFileNotFoundError, PyMemoryError, PyOSError, PyRuntimeError, PyTypeError, PyUserWarning, PyValueError,
};
use pyo3::prelude::*;
use sscc::Error;
use sscc_io::IoError;
use sscc_sim::SimError;
use sscc_tasks::TaskError;

/// Returns a `ValueError`.
pub fn value(message: impl Into<String>) -> PyErr {
    PyValueError::new_err(message.into())
}

/// Returns a `TypeError`.
pub fn kind(message: impl Into<String>) -> PyErr {
    PyTypeError::new_err(message.into())
}

/// Converts an error of the core. `name`, such as `q1` or `Q[5]`, replaces "q" in the message of an error of
/// coordinates, and precedes any other message except that of a cancellation.
pub fn refused(error: &Error, name: &str) -> PyErr {
    let message = error.to_string();
    match error {
        Error::CoordinatesLength { .. } | Error::CoordinatesValue { .. } | Error::CoordinatesRange => {
            value(format!("{name}{}", message.strip_prefix('q').unwrap_or(&message)))
        }
        // The caller raises the cause of a cancellation instead.
        Error::Cancelled => PyRuntimeError::new_err(message),
        _ if name.is_empty() => value(message),
        _ => value(format!("{name}: {message}")),
    }
}

/// Converts an error of a file.
pub fn file(error: &IoError) -> PyErr {
    let message = error.to_string();
    match error {
        IoError::NotFound { .. } => PyFileNotFoundError::new_err(message),
        IoError::NotAFile { .. } | IoError::System { .. } => PyOSError::new_err(message),
        _ => value(message),
    }
}

/// Converts an error of a task on files.
pub fn refused_task(error: &TaskError) -> PyErr {
    of_cause(Some(error), error.to_string())
}

/// Converts an error of a scene or simulation.
pub fn refused_simulation(error: &SimError) -> PyErr {
    of_cause(error.task(), error.to_string())
}

/// Returns the exception of a message, of the class of its cause.
fn of_cause(cause: Option<&TaskError>, message: String) -> PyErr {
    match cause {
        Some(cause) if cause.is_system() => PyOSError::new_err(message),
        _ => cause.and_then(TaskError::file).map_or_else(|| value(message), file),
    }
}

/// Issues notes as Python warnings.
pub fn warn(py: Python<'_>, notes: &[String]) -> PyResult<()> {
    let category = py.get_type::<PyUserWarning>();
    notes.iter().try_for_each(|note| {
        // The name of a file in a note may contain a NUL byte.
        let note = CString::new(note.replace('\0', " ")).unwrap_or_default();
        PyErr::warn(py, &category, &note, 2)
    })
}

/// Returns an empty vector with space for `count` entries, or a `MemoryError`: a Python argument sets the size.
pub fn room<T>(count: usize, what: &str) -> PyResult<Vec<T>> {
    let mut vec = Vec::new();
    match vec.try_reserve_exact(count) {
        Ok(()) => Ok(vec),
        Err(_) => Err(PyMemoryError::new_err(format!("{what}: {count} entries do not fit into memory"))),
    }
}
