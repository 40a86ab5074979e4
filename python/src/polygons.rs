//! Triangulation of the polygons of a mesh from arrays.

use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use sscc_io::triangulate;

use crate::arrays::{floats, integers, table};
use crate::errors::value;
use crate::model::points;

/// Returns the triangles of polygons, (F, 3), and warnings. `place` names the mesh in warnings and in errors of the
/// polygons.
#[pyfunction]
pub fn _triangulated<'py>(
    py: Python<'py>,
    place: &str,
    counts: &Bound<'py, PyAny>,
    corners: &Bound<'py, PyAny>,
    positions: &Bound<'py, PyAny>,
) -> PyResult<(Bound<'py, PyAny>, Vec<String>)> {
    let positions = points(&floats(positions, "positions")?, "positions")?;
    let numbers = |any: &Bound<'py, PyAny>, name: &str| -> PyResult<Vec<u64>> {
        let found = integers(any, name)?;
        if found.ndim() != 1 {
            return Err(value(format!(
                "{place}: {name} has shape {:?}: one axis was expected",
                found.shape()
            )));
        }
        let unsigned = |number: &i64| {
            u64::try_from(*number)
                .map_err(|_| value(format!("{place}: {name} has the negative number {number}")))
        };
        found.as_slice()?.iter().map(unsigned).collect()
    };
    let (counts, corners) = (numbers(counts, "counts")?, numbers(corners, "corners")?);
    let found = py.detach(|| triangulate(positions, &counts, &corners));
    let found = found.map_err(|error| value(format!("{place}: {error}")))?;
    let warnings = found.warnings.iter().map(|text| format!("{place}: {text}")).collect();
    Ok((table(py, 3, found.mesh.faces().as_flattened().to_vec())?, warnings))
}
