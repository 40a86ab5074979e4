//! Arguments and results of queries for distances.

use pyo3::prelude::*;
use sscc::{Clearance, NearPair};

use crate::arguments::{count, number};
use crate::arrays::{frozen, line, pairs};
use crate::errors::{refused, value};

/// Pairs (n, 2) and their distances (n,).
pub type NearArrays<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// The nearest pair: distance, triangles.
pub type Nearest = Option<(f64, (u32, u32))>;

/// Number of connected components that are inside, and number of all components.
pub type Enclosed = (usize, usize);

/// Returns the clearance in the arguments.
pub fn clearance(distance: &Bound<'_, PyAny>, rings: Option<&Bound<'_, PyAny>>) -> PyResult<Clearance> {
    let Some(distance) = number(Some(distance), "clearance")? else {
        return Err(value("clearance is None: a distance was expected"));
    };
    let clearance = Clearance::new(distance).map_err(|error| refused(&error, ""))?;
    Ok(clearance.beyond_rings(rings_of(rings)?))
}

/// Returns the number of rings in the argument, by default 1.
pub fn rings_of(rings: Option<&Bound<'_, PyAny>>) -> PyResult<u32> {
    Ok(count(rings, "rings", 1..=1000)?.map_or(1, |rings| rings as u32))
}

/// Returns near pairs as arrays.
pub fn near_arrays<'py>(py: Python<'py>, near: &[NearPair]) -> PyResult<NearArrays<'py>> {
    let list: Vec<_> = near.iter().map(|near| near.pair).collect();
    let distances = near.iter().map(|near| near.distance).collect();
    Ok((frozen(pairs(py, &list)?)?, frozen(line::<f64>(py, distances))?))
}

/// Returns the nearest pair.
pub fn nearest(near: Option<NearPair>) -> Nearest {
    near.map(|near| (near.distance, near.pair))
}
