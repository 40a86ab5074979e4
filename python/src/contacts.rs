//! The contacts of the pairs of an answer: the curves in which surfaces intersect, and penetration depths.

use glam::DVec3;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyList};
use sscc::parts::{
    Penetration, Surface, contact_curves, contact_curves_between, penetration_triangle_triangle,
};
use sscc::{Error, Pair};

use crate::arrays::{frozen, pairs, table};
use crate::colliding_triangles::CollidingTriangles;
use crate::errors::{refused, value};
use crate::interrupt::signals;

/// The pickled form: the triangles of the first mesh, and of the second if there are two.
pub type PickledContacts<'py> = (Bound<'py, PyBytes>, Option<Bound<'py, PyBytes>>);

/// Number of penetration depths that are computed between two checks of signals.
const DEPTHS_AT_ONCE: usize = 256;

/// The triangles of the pairs of an answer.
#[derive(Clone)]
pub struct Contacts {
    first: CollidingTriangles,
    /// The triangles of the second mesh; `None` for collisions of one mesh with itself.
    second: Option<CollidingTriangles>,
}

/// A mesh at given positions: faces, positions.
pub type Shape<'a> = (&'a [[u32; 3]], &'a [DVec3]);

/// A curve: its points, the pair of each of its segments, and whether it is closed.
pub struct Curve {
    points: Vec<DVec3>,
    pairs: Vec<Pair>,
    is_closed: bool,
}

impl Contacts {
    /// Copies the triangles of these pairs of a mesh.
    pub fn within((faces, positions): Shape<'_>, pairs: &[Pair]) -> Self {
        let numbers = pairs.iter().flat_map(|(i, j)| [*i, *j]);
        Self { first: CollidingTriangles::of(faces, positions, numbers), second: None }
    }

    /// Copies the triangles of these pairs of two meshes.
    pub fn between((faces, x): Shape<'_>, (other_faces, y): Shape<'_>, pairs: &[Pair]) -> Self {
        Self {
            first: CollidingTriangles::of(faces, x, pairs.iter().map(|(i, _)| *i)),
            second: Some(CollidingTriangles::of(other_faces, y, pairs.iter().map(|(_, j)| *j))),
        }
    }

    fn second(&self) -> &CollidingTriangles {
        self.second.as_ref().unwrap_or(&self.first)
    }

    /// Returns the curves in which the surfaces intersect.
    pub fn curves(&self, pairs: &[Pair]) -> PyResult<Vec<Curve>> {
        let (first, second) = (&self.first, self.second());
        let place = |(i, j): &Pair| Some((first.place(*i)?, second.place(*j)?));
        let places: Vec<Pair> = pairs.iter().map(place).collect::<Option<_>>().ok_or_else(damaged)?;
        let (faces, positions) = first.mesh();
        let found = match &self.second {
            None => contact_curves(&faces, &positions, &places),
            Some(second) => {
                let (other_faces, other_positions) = second.mesh();
                let other = Surface { faces: &other_faces, positions: &other_positions };
                contact_curves_between(Surface { faces: &faces, positions: &positions }, other, &places)
            }
        };
        let found = found.map_err(|error| refused(&error, ""))?;
        let number = |contact: &u32| {
            let (i, j) = found.contacts[*contact as usize].pair;
            (first.number(i), second.number(j))
        };
        let curves = found.curves.iter().map(|curve| Curve {
            points: curve.points.iter().map(|point| point.position).collect(),
            pairs: curve.contacts.iter().map(number).collect(),
            is_closed: curve.is_closed,
        });
        Ok(curves.collect())
    }

    /// Returns the smallest translation that separates each pair. A signal handler's exception ends the work.
    pub fn penetrations(&self, pairs: &[Pair]) -> PyResult<Vec<Penetration>> {
        let mut found = Vec::with_capacity(pairs.len());
        for some in pairs.chunks(DEPTHS_AT_ONCE) {
            for (i, j) in some {
                let corners = self.first.corners(*i).zip(self.second().corners(*j));
                let penetration = corners.and_then(|(a, b)| penetration_triangle_triangle(a, b));
                found.push(penetration.ok_or_else(damaged)?);
            }
            if signals().is_cancelled() {
                return Err(refused(&Error::Cancelled, ""));
            }
        }
        Ok(found)
    }

    /// Returns the pickled form.
    pub fn pickled<'py>(&self, py: Python<'py>) -> PickledContacts<'py> {
        (self.first.to_bytes(py), self.second.as_ref().map(|second| second.to_bytes(py)))
    }

    /// Returns the contacts of a pickled form.
    ///
    /// # Errors
    /// If the bytes do not have this form.
    pub fn unpickled((first, second): &PickledContacts<'_>) -> PyResult<Self> {
        let second = second.as_ref().map(CollidingTriangles::from_bytes).transpose()?;
        Ok(Self { first: CollidingTriangles::from_bytes(first)?, second })
    }
}

impl Curve {
    /// Returns `sscc.Curve`s.
    pub fn to_list(py: Python<'_>, curves: Vec<Self>) -> PyResult<Bound<'_, PyList>> {
        let class = py.import("sscc._curve")?.getattr("Curve")?;
        let curve = |Self { points, pairs: of_segments, is_closed }: Self| {
            let points = points.iter().flat_map(DVec3::to_array).collect();
            let arrays = (frozen(table::<f64>(py, 3, points)?)?, frozen(pairs(py, &of_segments)?)?);
            class.call1((arrays.0, arrays.1, is_closed))
        };
        PyList::new(py, curves.into_iter().map(curve).collect::<PyResult<Vec<_>>>()?)
    }
}

fn damaged() -> PyErr {
    value("the pickled answer is damaged: its triangles are not those of its pairs")
}
