//! A grid of a VTK file before the checks of a solid.

use glam::DVec3;
use sscc::TriMesh;

use super::super::volume_or_surface::VolumeOrSurface;
use super::cells::{self, Cells};
use crate::FormatError;
use crate::error::quoted;

/// Points, cells and displacements of a file.
pub(crate) struct Grid {
    pub(super) points: Vec<DVec3>,
    pub(super) cells: Cells,
    /// Name and vectors of the point data that moves the points.
    pub(super) displacement: Option<(String, Vec<DVec3>)>,
    /// Whether the data has vectors that may be displacements, but were not chosen: see
    /// [`Displacement::is_unclear`](super::Displacement).
    pub(super) is_unclear: bool,
}

impl Grid {
    /// Returns a line that names the point data that moves the points, or that may be meant to.
    pub fn note(&self) -> Option<String> {
        match &self.displacement {
            Some((name, _)) => {
                Some(format!("the point data {} moves the points (FILE# takes them as they are)", quoted(name)))
            }
            None => self.is_unclear.then(|| {
                "the point data 'U' may be displacements or velocities and does not move the points (FILE#U applies it)".into()
            }),
        }
    }

    /// Moves the points by their displacements.
    #[must_use]
    pub fn moved(mut self) -> Self {
        if let Some((_, vectors)) = self.displacement.take() {
            self.points.iter_mut().zip(&vectors).for_each(|(point, vector)| *point += vector);
        }
        self
    }

    /// Returns the solid, or the surface of a file without solid cells, at its points.
    pub fn into_volume_or_surface(self) -> Result<VolumeOrSurface, FormatError> {
        cells::build(self.points, &self.cells)
    }

    /// Returns the surface with all points, with lines about its faces.
    pub fn into_surface(self) -> Result<(TriMesh, Vec<String>), FormatError> {
        self.into_volume_or_surface()?.into_surface()
    }
}
