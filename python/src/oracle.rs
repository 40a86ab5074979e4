//! For tests: when two moving triangles meet, in exact arithmetic.

use glam::DVec3;
use num_traits::ToPrimitive;
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use sscc::MovingTriangle;
use sscc_exact::first_contact;

use crate::arrays::{copied, floats};
use crate::errors::value;

/// The first time in [0, 1] at which two triangles have a point in common, rounded down; None if they never do.
/// Corners (2, 2, 3, 3): of each triangle those at the start and those at the end.
#[pyfunction]
pub fn _first_contact(py: Python<'_>, corners: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    let corners = floats(corners, "corners")?;
    if corners.shape() != [2, 2, 3, 3] {
        return Err(value(format!("corners has shape {:?}: (2, 2, 3, 3) was expected", corners.shape())));
    }
    let numbers = copied(&corners, "corners")?;
    if numbers.iter().any(|x| !x.is_finite()) {
        return Err(value("corners: every entry must be finite"));
    }
    let points: Vec<DVec3> = numbers.as_chunks::<3>().0.iter().map(|p| DVec3::from_array(*p)).collect();
    let triangle = |first: usize| MovingTriangle {
        t0: [points[first], points[first + 1], points[first + 2]],
        t1: [points[first + 3], points[first + 4], points[first + 5]],
    };
    let (x, y) = (triangle(0), triangle(6));
    Ok(py.detach(|| first_contact(&x, &y)).and_then(|root| root.lower().to_f64()))
}
