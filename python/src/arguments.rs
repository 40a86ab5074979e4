//! Conversion of scalar arguments: numbers with a range, switches, names, files.

use std::ops::RangeInclusive;
use std::path::PathBuf;

use pyo3::exceptions::PyOverflowError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyString};
use sscc::Neighbours;

use crate::errors::{kind, value};

/// Returns a whole number in a range; `None` for an absent argument.
pub fn count(
    any: Option<&Bound<'_, PyAny>>,
    name: &str,
    range: RangeInclusive<usize>,
) -> PyResult<Option<usize>> {
    let Some(any) = any else { return Ok(None) };
    let (min, max) = (*range.start(), *range.end());
    let expected = || match max {
        usize::MAX => format!("a whole number of at least {min}"),
        _ => format!("a whole number from {min} to {max}"),
    };
    // `__index__` includes NumPy's integers. Booleans have it, too, but are refused.
    let index = any.call_method0("__index__").ok().filter(|_| !any.is_instance_of::<PyBool>());
    let Some(index) = index else {
        return Err(kind(format!("{name} is a {}: {} was expected", any.get_type().name()?, expected())));
    };
    match index.extract::<usize>() {
        Ok(number) if range.contains(&number) => Ok(Some(number)),
        _ => Err(value(format!("{name} is {index}: {} was expected", expected()))),
    }
}

/// Returns a number; `None` for an absent argument.
pub fn number(any: Option<&Bound<'_, PyAny>>, name: &str) -> PyResult<Option<f64>> {
    let Some(any) = any else { return Ok(None) };
    match any.extract::<f64>() {
        Ok(number) if !any.is_instance_of::<PyBool>() => Ok(Some(number)),
        Err(error) if error.is_instance_of::<PyOverflowError>(any.py()) => {
            Err(value(format!("{name} is beyond the range of a float64")))
        }
        _ => Err(kind(format!("{name} is a {}: a number was expected", any.get_type().name()?))),
    }
}

/// Returns a boolean; `None` for an absent argument.
pub fn switch(any: Option<&Bound<'_, PyAny>>, name: &str) -> PyResult<Option<bool>> {
    let Some(any) = any else { return Ok(None) };
    match any.extract::<bool>() {
        Ok(switch) => Ok(Some(switch)),
        Err(_) => Err(kind(format!("{name} is a {}: True or False was expected", any.get_type().name()?))),
    }
}

/// Returns the value of one of several names; `None` for an absent argument.
pub fn choice<T: Copy>(
    any: Option<&Bound<'_, PyAny>>,
    name: &str,
    choices: &[(&str, T)],
) -> PyResult<Option<T>> {
    let Some(any) = any else { return Ok(None) };
    let known = || choices.iter().map(|(known, _)| format!("'{known}'")).collect::<Vec<_>>().join(" or ");
    let Ok(text) = any.cast::<PyString>() else {
        return Err(kind(format!("{name} is a {}: {} was expected", any.get_type().name()?, known())));
    };
    let text = text.to_str()?;
    match choices.iter().find(|(known, _)| *known == text) {
        Some((_, choice)) => Ok(Some(*choice)),
        None => Err(value(format!("{name} is '{}': {} was expected", text.escape_debug(), known()))),
    }
}

/// Returns the values of the argument `neighbours`, by their names.
pub fn neighbours_by_name() -> [(&'static str, Neighbours); 3] {
    [Neighbours::Exclude, Neighbours::IncludeOneVertex, Neighbours::IncludeFolded]
        .map(|rule| (rule.into(), rule))
}

/// Returns the path in a str or os.PathLike.
pub fn path(any: &Bound<'_, PyAny>, name: &str) -> PyResult<PathBuf> {
    any.extract().map_err(|_| {
        kind(format!(
            "{name} is a {}: the name of a file was expected",
            any.get_type().name().map_or_else(|_| "?".into(), |n| n.to_string())
        ))
    })
}

/// Refuses an output file whose name has another ending.
pub fn check_ending(path: &std::path::Path, ending: &str) -> PyResult<()> {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    if name.ends_with(ending) && name.len() > ending.len() {
        return Ok(());
    }
    Err(value(format!(
        "{}: the name of the file must end in {ending}",
        path.to_string_lossy().escape_debug()
    )))
}
