//! Conversion of metrics from Python arguments, and of their factors to arrays.

use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use pyo3::types::PyString;
use sscc::parts::check_metric;
use sscc::{Metric, MetricKind, ReducedModel};

use crate::arrays::{copied, floats, line, table};
use crate::errors::{refused, value};

/// Returns the metric of an argument: a name, weights (r) or a matrix (r, r); `None` for an absent argument.
pub fn read_metric(model: &ReducedModel, metric: Option<&Bound<'_, PyAny>>) -> PyResult<Option<Metric>> {
    let Some(any) = metric else { return Ok(None) };
    let (py, rank) = (any.py(), model.rank());
    let made = if let Ok(name) = any.cast::<PyString>() {
        match name.to_str()? {
            "displacement" => py.detach(|| Metric::displacement(model.mesh(), model.modes())),
            "mass" => py.detach(|| Metric::mass(model.mesh(), model.modes())),
            "identity" => Ok(Metric::identity(rank)),
            "energy" if model.metric().kind() == MetricKind::Energy => Ok(model.metric().clone()),
            "energy" => {
                return Err(value(format!(
                    "metric: the model's own is '{}', not 'energy': a model with a stiffness has it, such as one \
                     from sscc.modes.linear",
                    model.metric().kind()
                )));
            }
            other => {
                return Err(value(format!(
                    "metric is '{}': 'energy', 'displacement', 'mass', 'identity', weights (r,) or a matrix (r, r) \
                     was expected",
                    other.escape_debug()
                )));
            }
        }
    } else {
        let array = floats(any, "metric")?;
        let entries = &copied(&array, "metric")?;
        match *array.shape() {
            [n] if n == rank => Metric::from_weights(MetricKind::Given, entries),
            [n, m] if (n, m) == (rank, rank) => Metric::from_matrix(MetricKind::Given, rank, entries),
            _ => {
                let shape = array.shape();
                return Err(value(format!(
                    "metric has shape {shape:?}: ({rank},) or ({rank}, {rank}) was expected"
                )));
            }
        }
    };
    let checked =
        py.detach(|| made.and_then(|made| check_metric(&made, model.mesh(), model.modes()).map(|()| made)));
    Ok(Some(checked.map_err(|error| refused(&error, "metric"))?))
}

/// Returns the factor S of `|z| = |S q|`: (r) if it is diagonal, else (r, r).
pub fn factor<'py>(py: Python<'py>, metric: &Metric) -> PyResult<Bound<'py, PyAny>> {
    match metric.dense_factor() {
        Some(factor) => table(py, metric.rank(), factor.to_vec()),
        None => Ok(line(py, metric.scales())),
    }
}
