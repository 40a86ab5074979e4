//! Conversion of given positions, frames and contact filters.

use std::collections::BTreeSet;

use glam::DVec3;
use numpy::PyUntypedArrayMethods;
use pyo3::prelude::*;
use pyo3::types::PyString;
use sscc::{ContactFilter, Error, Pair, limits};

use crate::arguments::{choice, neighbours_by_name};
use crate::arrays::{floats, integers};
use crate::errors::{kind, refused, room, value};
use crate::model::points;

/// Positions, and the argument that they come from.
pub struct NamedPositions {
    pub name: &'static str,
    pub points: Vec<DVec3>,
}

impl NamedPositions {
    /// Returns a copy of the positions in an array (V, 3).
    pub fn of(any: &Bound<'_, PyAny>, name: &'static str) -> PyResult<Self> {
        Ok(Self { name, points: points(&floats(any, name)?, name)? })
    }

    /// Returns the exception if these positions are not of a mesh of `vertices` vertices, or are out of range; else
    /// `None`.
    pub fn fault(&self, vertices: usize) -> Option<PyErr> {
        fault(&self.points, vertices).map(|error| refused(&error, self.name))
    }
}

/// Returns the first reason why the core refuses positions; `None` if it accepts them.
pub fn fault(positions: &[DVec3], vertices: usize) -> Option<Error> {
    if positions.len() != vertices {
        return Some(Error::PositionCount { found: positions.len(), vertices });
    }
    let vertex = positions.iter().position(|x| !limits::contains(*x))?;
    Some(Error::Position { vertex, position: positions[vertex].to_array() })
}

/// Frames (T, V, 3).
pub struct Frames {
    points: Vec<DVec3>,
    count: usize,
    vertices: usize,
}

impl Frames {
    /// Returns a copy of the frames in an array. `vertices` is the number of vertices, if it is known.
    pub fn of(any: &Bound<'_, PyAny>, vertices: Option<usize>) -> PyResult<Self> {
        let array = floats(any, "frames")?;
        let shape = array.shape();
        if shape.len() != 3 || shape[2] != 3 || vertices.is_some_and(|vertices| shape[1] != vertices) {
            let expected = vertices.map_or("V".into(), |vertices| vertices.to_string());
            let hint = if shape.len() == 2 { "; for one frame use check" } else { "" };
            return Err(value(format!("frames has shape {shape:?}: (T, {expected}, 3) was expected{hint}")));
        }
        // The slices of frames without vertices would need memory without any input.
        if shape[0] > 0 && shape[1] == 0 {
            return Err(value(format!("frames has shape {shape:?}: at least one vertex was expected")));
        }
        let entries = array.as_slice()?;
        let mut points = room(entries.len() / 3, "frames")?;
        points.extend(entries.as_chunks::<3>().0.iter().map(|x| DVec3::from_array(*x)));
        Ok(Self { points, count: shape[0], vertices: shape[1] })
    }

    /// Returns the positions of each frame.
    pub fn slices(&self) -> PyResult<Vec<&[DVec3]>> {
        let mut slices = room(self.count, "frames")?;
        slices.extend((0..self.count).map(|t| &self.points[t * self.vertices..(t + 1) * self.vertices]));
        Ok(slices)
    }
}

/// The argument `weld`.
pub enum Weld {
    Off,
    /// Vertices of equal rest position are welded.
    ByPosition,
    /// Vertices of the same class are welded. Classes are numbered from 0 without gaps.
    Classes(Vec<u32>),
}

impl Weld {
    pub fn of(any: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let Some(any) = any else { return Ok(Self::Off) };
        if let Ok(is_on) = any.extract::<bool>() {
            return Ok(if is_on { Self::ByPosition } else { Self::Off });
        }
        let expected = "True, False or (V,) integers were expected";
        if any.is_instance_of::<PyString>() {
            return Err(kind(format!("weld is a {}: {expected}", any.get_type().name()?)));
        }
        let array = integers(any, "weld")?;
        if array.ndim() != 1 {
            return Err(value(format!("weld has shape {:?}: {expected}", array.shape())));
        }
        let given = array.as_slice()?.to_vec();
        let classes = any.py().detach(|| {
            let mut sorted = given.clone();
            sorted.sort_unstable();
            sorted.dedup();
            let class = |number: &i64| sorted.partition_point(|other| other < number) as u32;
            given.iter().map(class).collect()
        });
        Ok(Self::Classes(classes))
    }
}

/// Returns the filter of the arguments `neighbours` and `ignored`, for a mesh of this number of faces. It welds equal
/// positions if `weld` is [`Weld::ByPosition`].
pub fn contact_filter(
    neighbours: Option<&Bound<'_, PyAny>>,
    weld: &Weld,
    ignored: Option<&Bound<'_, PyAny>>,
    faces: usize,
) -> PyResult<ContactFilter> {
    let choices = neighbours_by_name();
    let neighbours = choice(neighbours, "neighbours", &choices)?.unwrap_or_default();
    let filter = ContactFilter::new(neighbours).weld(matches!(weld, Weld::ByPosition));
    let Some(ignored) = ignored else { return Ok(filter) };
    Ok(filter.ignoring(triangle_pairs(ignored, faces)?))
}

/// Returns the pairs of triangles in an array (n, 2).
fn triangle_pairs(any: &Bound<'_, PyAny>, faces: usize) -> PyResult<BTreeSet<Pair>> {
    let array = integers(any, "ignored")?;
    if array.shape() == [0] {
        return Ok(BTreeSet::new());
    }
    if array.ndim() != 2 || array.shape()[1] != 2 {
        return Err(value(format!("ignored has shape {:?}: (n, 2) was expected", array.shape())));
    }
    let pair = |(row, pair): (usize, &[i64; 2])| -> PyResult<Pair> {
        let triangle = |t: i64| match u32::try_from(t) {
            Ok(triangle) if (triangle as usize) < faces => Ok(triangle),
            _ => Err(value(format!("ignored[{row}] names triangle {t}: faces has {faces}, counted from 0"))),
        };
        Ok((triangle(pair[0])?, triangle(pair[1])?))
    };
    array.as_slice()?.as_chunks::<2>().0.iter().enumerate().map(pair).collect()
}
