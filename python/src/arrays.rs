//! Conversion of arrays. Input: floats of at most 64 bits and integers in any memory and byte order, or lists of
//! numbers. Output: arrays that an object keeps are read-only ([`cached`], [`frozen`]); others are copies.
//!
//! Other threads may write to an array at any time, even while this thread holds the GIL, since NumPy releases it in
//! long loops. So each entry is copied first, and decisions use the copy.

use numpy::ndarray::{Array1, Array2};
use numpy::{
    Element, PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyMemoryError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyFloat, PyInt, PyList, PyTuple};
use sscc::Pair;

use crate::errors::{kind, room, value};

/// The largest integer up to which every integer is a float64.
const MAX_EXACT_INTEGER: i128 = 1 << 53;

/// Returns the floats of an argument in C order; `name` is the argument's. Other threads may write to them: see
/// [`copied`].
pub fn floats<'py>(any: &Bound<'py, PyAny>, name: &str) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
    if let Ok(array) = any.cast_exact::<PyArrayDyn<f64>>()
        && is_plain(array.as_untyped())
    {
        return borrow(array, name);
    }
    let array = numbers(any, name)?;
    let dtype = array.getattr("dtype")?;
    let (letter, size): (char, usize) =
        (dtype.getattr("kind")?.extract()?, dtype.getattr("itemsize")?.extract()?);
    match letter {
        'f' if size <= 8 => {}
        'i' | 'u' if size < 8 => {}
        'i' | 'u' => {
            // The check and the conversion must see the same numbers.
            let copy = array.call_method0("copy")?;
            check_exact(&copy, name)?;
            return borrow(require(&copy, "float64")?.cast::<PyArrayDyn<f64>>()?, name);
        }
        _ => {
            return Err(kind(format!(
                "{name} is an array of {dtype}: float64, float32 or integers were expected"
            )));
        }
    }
    borrow(require(&array, "float64")?.cast::<PyArrayDyn<f64>>()?, name)
}

/// Returns the integers of an argument in C order. Other threads may write to them: see [`copied`].
pub fn integers<'py>(any: &Bound<'py, PyAny>, name: &str) -> PyResult<PyReadonlyArrayDyn<'py, i64>> {
    let array = numbers(any, name)?;
    let dtype = array.getattr("dtype")?;
    let letter: char = dtype.getattr("kind")?.extract()?;
    // An empty list is float64 to NumPy.
    if !matches!(letter, 'i' | 'u') && !is_empty(&array)? {
        return Err(kind(format!("{name} is an array of {dtype}: integers were expected")));
    }
    if letter == 'u' && dtype.getattr("itemsize")?.extract::<usize>()? == 8 && !is_empty(&array)? {
        let max: u64 = array.call_method0("max")?.extract()?;
        i64::try_from(max).map_err(|_| value(format!("{name}: {max} is too large")))?;
    }
    borrow(require(&array, "int64")?.cast::<PyArrayDyn<i64>>()?, name)
}

/// Returns the floats of an argument as a new array, for functions that are written in Python.
#[pyfunction]
pub fn _numbers<'py>(given: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    floats(given, name)?.as_any().call_method0("copy")
}

/// Returns the integers of an argument as a new array, for functions that are written in Python.
#[pyfunction]
pub fn _integers<'py>(given: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    integers(given, name)?.as_any().call_method0("copy")
}

/// Returns a copy of the entries of an array in C order; `name` is the argument's.
pub fn copied(array: &PyReadonlyArrayDyn<'_, f64>, name: &str) -> PyResult<Vec<f64>> {
    let entries = array.as_slice()?;
    let mut copy = room(entries.len(), name)?;
    copy.extend_from_slice(entries);
    Ok(copy)
}

/// Returns a copy of the r numbers of one configuration. The fast case is a contiguous float64 array.
#[inline]
pub fn vector(any: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<f64>> {
    if let Ok(array) = any.cast_exact::<PyArray1<f64>>()
        && let Ok(array) = array.try_readonly()
        && let Ok(entries) = array.as_slice()
    {
        return Ok(entries.to_vec());
    }
    let array = floats(any, name)?;
    if array.ndim() != 1 {
        return Err(value(format!(
            "{name} has shape {:?}: one configuration was expected, one number for each mode",
            array.shape()
        )));
    }
    copied(&array, name)
}

/// Converts an argument by NumPy to an array of numbers without a mask.
fn numbers<'py>(any: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    let py = any.py();
    let numpy = py.import("numpy")?;
    let masked = numpy.getattr("ma")?.getattr("MaskedArray")?;
    check_unmasked(any, name, &masked, 0)?;
    let refused = |error: PyErr| {
        if error.is_instance_of::<PyMemoryError>(py)
            || !error.is_instance_of::<pyo3::exceptions::PyException>(py)
        {
            return error;
        }
        let message = format!("{name}: an array of numbers was expected: {}", error.value(py));
        if error.is_instance_of::<PyValueError>(py) { value(message) } else { kind(message) }
    };
    // NumPy treats an object that has only DLPack as a scalar.
    let convert =
        if any.hasattr("__dlpack__")? && !any.hasattr("__array__")? { "from_dlpack" } else { "asarray" };
    let array = numpy.call_method1(convert, (any,)).map_err(refused)?;
    let letter: char = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if letter == 'O' && has_long_integer(&array)? {
        let message = format!("{name} has an integer of more than 64 bits: integers are exact up to 2^53");
        return Err(value(message));
    }
    if matches!(letter, 'O' | 'U' | 'S' | 'M' | 'm' | 'V') {
        let found = any.get_type().name()?;
        return Err(kind(format!("{name} is a {found}: an array of numbers was expected")));
    }
    // After the conversion the depth of nested lists is known and finite.
    check_unmasked(any, name, &masked, array.getattr("ndim")?.extract()?)?;
    // An empty list is float64 to NumPy, so its type is not checked.
    Ok(array)
}

/// Refuses masked arrays, also in lists and tuples down to this depth: NumPy would drop the mask.
fn check_unmasked(
    any: &Bound<'_, PyAny>,
    name: &str,
    masked: &Bound<'_, PyAny>,
    depth: usize,
) -> PyResult<()> {
    if any.is_exact_instance_of::<PyFloat>() || any.is_exact_instance_of::<PyInt>() {
        return Ok(());
    }
    if any.is_instance(masked)? {
        return Err(kind(format!("{name} is a masked array: fill it first, as by {name}.filled(0)")));
    }
    if depth > 0 && (any.is_instance_of::<PyList>() || any.is_instance_of::<PyTuple>()) {
        for item in any.try_iter()? {
            check_unmasked(&item?, name, masked, depth - 1)?;
        }
    }
    Ok(())
}

/// Whether an array of objects contains an integer beyond NumPy's types.
fn has_long_integer(array: &Bound<'_, PyAny>) -> PyResult<bool> {
    for item in array.getattr("flat")?.try_iter()? {
        let item = item?;
        if item.is_instance_of::<PyInt>() && item.extract::<i64>().is_err() && item.extract::<u64>().is_err()
        {
            return Ok(true);
        }
    }
    Ok(false)
}

fn is_empty(array: &Bound<'_, PyAny>) -> PyResult<bool> {
    Ok(array.getattr("size")?.extract::<usize>()? == 0)
}

/// Refuses integers beyond 2^53, which a float64 may not hold exactly.
fn check_exact(array: &Bound<'_, PyAny>, name: &str) -> PyResult<()> {
    if is_empty(array)? {
        return Ok(());
    }
    let (min, max): (i128, i128) =
        (array.call_method0("min")?.extract()?, array.call_method0("max")?.extract()?);
    let extreme = if min < -MAX_EXACT_INTEGER { min } else { max };
    if extreme.abs() > MAX_EXACT_INTEGER {
        return Err(value(format!("{name}: the integer {extreme} is beyond 2^53: pass it as a float64")));
    }
    Ok(())
}

/// Returns the same numbers contiguous in C order, aligned, in the machine's byte order.
fn require<'py>(array: &Bound<'py, PyAny>, dtype: &str) -> PyResult<Bound<'py, PyAny>> {
    array.py().import("numpy")?.call_method1("require", (array, dtype, ["C", "A", "E"]))
}

fn is_plain(array: &Bound<'_, PyUntypedArray>) -> bool {
    array.is_c_contiguous()
        && array
            .getattr("flags")
            .and_then(|flags| flags.getattr("aligned"))
            .is_ok_and(|is| is.is_truthy().unwrap_or(false))
}

fn borrow<'py, T: Element>(
    array: &Bound<'py, PyArrayDyn<T>>,
    name: &str,
) -> PyResult<PyReadonlyArrayDyn<'py, T>> {
    array
        .try_readonly()
        .map_err(|_| value(format!("{name} is in use by code that may write to it: pass a copy")))
}

/// An array that the first access creates and the object keeps.
pub type CachedArray = PyOnceLock<Py<PyAny>>;

/// Returns the cached array; `make` creates it at the first access. It is read-only.
pub fn cached<'py>(
    py: Python<'py>,
    cell: &CachedArray,
    make: impl FnOnce() -> PyResult<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let array = cell.get_or_try_init(py, || frozen(make()?).map(Bound::unbind))?;
    Ok(array.bind(py).clone())
}

/// Makes an array read-only.
pub fn frozen(array: Bound<'_, PyAny>) -> PyResult<Bound<'_, PyAny>> {
    let flags = PyDict::new(array.py());
    flags.set_item("write", false)?;
    array.call_method("setflags", (), Some(&flags))?;
    Ok(array)
}

/// Returns an array with one axis.
pub fn line<'py, T: Element>(py: Python<'py>, items: Vec<T>) -> Bound<'py, PyAny> {
    PyArray1::from_owned_array(py, Array1::from_vec(items)).into_any()
}

/// Returns an array with this number of columns, from its entries in C order.
pub fn table<'py, T: Element>(py: Python<'py>, columns: usize, items: Vec<T>) -> PyResult<Bound<'py, PyAny>> {
    let rows = items.len() / columns;
    let array = Array2::from_shape_vec((rows, columns), items).map_err(|error| value(error.to_string()))?;
    Ok(PyArray2::from_owned_array(py, array).into_any())
}

/// Returns triangle pairs as an array (n, 2) of uint32.
pub fn pairs<'py>(py: Python<'py>, pairs: &[Pair]) -> PyResult<Bound<'py, PyAny>> {
    let mut entries = room(2 * pairs.len(), "pairs")?;
    entries.extend(pairs.iter().flat_map(|(i, j)| [*i, *j]));
    table::<u32>(py, 2, entries)
}
