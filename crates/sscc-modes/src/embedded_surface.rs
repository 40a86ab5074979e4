//! Surface embedded in a solid: a lattice of cubes around it, or a given solid.

use glam::DVec3;
use sscc::{Modes, Progress, TriMesh};
use sscc_solid::{Material, Solid};

use crate::embedding::embed;
use crate::interpolation::Interpolation;
use crate::lattice::Lattice;
use crate::{ModesError, Outside};

/// Surface with the solid that moves it and carries mass and stiffness: a lattice of cubes around a closed surface, or a
/// given solid.
///
/// The lattice keeps parts separate that are close in space but not along the surface, however narrow the gap. The
/// filled share of each octant scales mass and stiffness of cubes at the surface.
pub struct EmbeddedSurface {
    solid: Solid,
    interpolation: Interpolation,
    spacing: Option<f64>,
    is_split: bool,
    outside: Option<Outside>,
}

impl EmbeddedSurface {
    /// Creates the lattice with `cells` cubes along the longest side of the surface; None gives about 20,000 cubes in
    /// all, or fewer if triangles meet too many cells. If the surface is open, vertices of equal position are welded.
    ///
    /// # Errors
    /// When the surface is open, not consistently oriented, collides with itself, encloses no volume or has several
    /// pieces; when `cells` is 0 or there are too many cubes; when the work is cancelled.
    pub fn new(
        surface: &TriMesh,
        cells: Option<usize>,
        material: Material,
        progress: &dyn Progress,
    ) -> Result<Self, ModesError> {
        let Lattice { vertices, cubes, fill, spacing, interpolation, is_split } =
            Lattice::around(surface, cells, progress)?;
        let solid = Solid::filled(vertices, cubes, fill, material)?;
        Ok(Self { solid, interpolation, spacing: Some(spacing), is_split, outside: None })
    }

    /// Embeds any surface in a solid, which may be coarser: a vertex moves with the element that contains it, or with the
    /// nearest one. The solid may have gaps and overlaps; a vertex in several parts moves with that of its neighbours.
    ///
    /// # Errors
    /// When the solid has tetrahedra of second order, a vertex is farther from the solid than a tenth of the longest side of the
    /// solid, or the work is cancelled.
    pub fn within(surface: &TriMesh, solid: Solid, progress: &dyn Progress) -> Result<Self, ModesError> {
        if !solid.tets10().is_empty() {
            return Err(ModesError::EmbeddedInSecondOrder);
        }
        let (interpolation, outside) = embed(&solid, surface, progress)?;
        let outside = Some(outside).filter(|outside| outside.count > 0);
        Ok(Self { solid, interpolation, spacing: None, is_split: false, outside })
    }

    /// Returns the vertices outside the solid; None if there are none.
    pub fn outside(&self) -> Option<&Outside> {
        self.outside.as_ref()
    }

    /// Returns the solid.
    pub fn solid(&self) -> &Solid {
        &self.solid
    }

    /// Returns the length of an edge of a cube of the lattice (model unit); None for a given solid.
    pub fn spacing(&self) -> Option<f64> {
        self.spacing
    }

    /// Whether the surface is closed only with vertices of equal position welded (a file split them along seams).
    /// Certificates then need the same: [`ContactFilter::weld`](sscc::ContactFilter::weld).
    pub fn is_split(&self) -> bool {
        self.is_split
    }

    /// Interpolates modes of the solid to the surface: a vertex moves with its element (barycentric or trilinear).
    /// Unused vertices do not move.
    ///
    /// # Errors
    /// When the modes have another number of vertices.
    pub fn on_surface(&self, modes: &Modes) -> Result<Modes, ModesError> {
        let r = modes.rank();
        let (found, vertices) = (modes.vertices(), self.solid.vertices().len());
        if found != vertices {
            return Err(sscc::Error::VertexCount { modes: found, mesh: vertices }.into());
        }
        let field =
            |k: usize| -> Vec<DVec3> { modes.displacements().iter().skip(k).step_by(r).copied().collect() };
        let columns: Vec<Vec<DVec3>> = (0..r).map(|k| self.interpolation.apply(&field(k))).collect();
        let vertices = self.interpolation.vertices.len();
        let displacements = (0..vertices).flat_map(|v| columns.iter().map(move |column| column[v])).collect();
        Ok(Modes::new(r, displacements)?)
    }

    /// Returns the vertices of the solid that move a vertex of the surface. If they are fixed, so is this vertex.
    pub fn holding(&self, vertex: usize) -> impl Iterator<Item = u32> {
        self.interpolation.vertices[vertex].iter().filter(|(_, share)| *share != 0.0).map(|(v, _)| *v)
    }
}
