//! Surface embedded in a lattice of cubes.

use glam::DVec3;
use sscc::{Modes, Progress, TriMesh};
use sscc_solid::{Material, Solid};

use crate::ModesError;
use crate::lattice::{Interpolation, Lattice};

/// Closed surface with the lattice of cubes around it, which carries mass and stiffness.
///
/// The lattice keeps parts separate that are close in space but not along the surface, however narrow the gap. The
/// filled share of each octant scales mass and stiffness of cubes at the surface.
pub struct EmbeddedSurface {
    solid: Solid,
    interpolation: Interpolation,
    spacing: f64,
    is_split: bool,
}

impl EmbeddedSurface {
    /// Creates the lattice with `cells` cubes along the longest side of the surface; None gives about 20,000 cubes in
    /// all. If the surface is open, vertices of equal position are welded.
    ///
    /// # Errors
    /// When the surface is open, not consistently oriented, collides with itself, encloses no volume or has several
    /// pieces, or the number of cubes is too large.
    pub fn new(
        surface: &TriMesh,
        cells: Option<usize>,
        material: Material,
        progress: &dyn Progress,
    ) -> Result<Self, ModesError> {
        let Lattice { vertices, cubes, fill, spacing, interpolation, is_split } =
            Lattice::around(surface, cells, progress)?;
        let solid = Solid::filled(vertices, cubes, fill, material)?;
        Ok(Self { solid, interpolation, spacing, is_split })
    }

    /// Returns the lattice as a solid.
    pub fn solid(&self) -> &Solid {
        &self.solid
    }

    /// Returns the length of an edge of a cube (model unit).
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Whether the surface is closed only with vertices of equal position welded (a file split them along seams).
    /// Certificates then need the same: [`ContactFilter::weld`](sscc::ContactFilter::weld).
    pub fn is_split(&self) -> bool {
        self.is_split
    }

    /// Interpolates modes of the solid to the surface: a vertex moves with its cube (trilinear). Unused vertices do not
    /// move.
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

    /// Returns the vertices of the solid that move a vertex of the surface; fixing them fixes it.
    pub fn holding(&self, vertex: usize) -> impl Iterator<Item = u32> {
        self.interpolation.vertices[vertex].iter().filter(|(_, share)| *share > 0.0).map(|(v, _)| *v)
    }
}
