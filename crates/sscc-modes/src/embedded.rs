//! A surface that moves with a solid around it.

use glam::DVec3;
use sscc::{Modes, TriMesh};

use crate::lattice::Lattice;
use crate::{Material, ModesError, Solid};

/// A closed surface and the lattice of cubes around it, which has its mass and stiffness.
///
/// Parts that are close in space but apart along the shape are not glued, however narrow the gap. Cubes at the surface
/// count by the share of each octant that lies inside.
#[derive(Clone, Debug, PartialEq)]
pub struct Embedded {
    solid: Solid,
    /// For each surface vertex, vertices of the solid and their shares; nothing where no triangle uses it.
    shares: Vec<Vec<(u32, f64)>>,
    spacing: f64,
}

impl Embedded {
    /// `cells` cubes along the longest side of the surface; if not given, so many that 10,000 cubes have its volume.
    ///
    /// # Errors
    /// When the surface is open, not oriented alike, meets itself, encloses no volume or is in several pieces, there would be too
    /// many cubes, or the material is outside physical limits.
    pub fn new(surface: &TriMesh, cells: Option<usize>, material: Material) -> Result<Self, ModesError> {
        let Lattice { vertices, cubes, fill, places, spacing } = Lattice::around(surface, cells)?;
        let shares = places.iter().map(|place| match place {
            Some((cube, shares)) => cubes[*cube as usize].into_iter().zip(*shares).filter(|(_, share)| *share > 0.0).collect(),
            None => Vec::new(),
        });
        let shares = shares.collect();
        let elements = cubes.len();
        let solid = Solid::filled(vertices, Vec::new(), cubes, fill, vec![material], vec![0; elements])?;
        Ok(Self { solid, shares, spacing })
    }

    /// The lattice.
    pub fn solid(&self) -> &Solid {
        &self.solid
    }

    /// Length of an edge of a cube (model unit).
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Modes of the solid's vertices as modes of the surface: a vertex moves with its cube (trilinear). Vertices that no
    /// triangle uses do not move.
    ///
    /// # Errors
    /// When the modes are of another number of vertices.
    pub fn on_surface(&self, modes: &Modes) -> Result<Modes, ModesError> {
        let r = modes.rank();
        if modes.displacements().len() != r * self.solid.vertices().len() {
            return Err(ModesError::ElementIndex { index: 0, vertices: self.solid.vertices().len() });
        }
        let mut displacements = vec![DVec3::ZERO; r * self.shares.len()];
        for (to, shares) in displacements.chunks_exact_mut(r).zip(&self.shares) {
            for (vertex, share) in shares {
                let from = &modes.displacements()[*vertex as usize * r..][..r];
                to.iter_mut().zip(from).for_each(|(to, from)| *to += *from * *share);
            }
        }
        Ok(Modes::new(r, displacements)?)
    }

    /// The vertices of the solid that hold a vertex of the surface: fix them, and it is fixed.
    pub fn holding(&self, vertex: usize) -> impl Iterator<Item = u32> {
        self.shares[vertex].iter().map(|(v, _)| *v)
    }
}
