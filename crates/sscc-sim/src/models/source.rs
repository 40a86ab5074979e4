//! The solid that modes are computed for: from a file, or a lattice around a surface.

use std::path::Path;

use glam::DVec3;
use sscc::{Modes, Progress, TriMesh};
use sscc_io::{read_mesh, read_volume_mesh};
use sscc_modes::EmbeddedSurface;
use sscc_solid::{Boundary, Material, MeshedSolid, PartialMaterial, Solid};

use super::material::MaterialOrigin;
use crate::SimError;

/// A solid with its surface: from a file, or a lattice around a surface.
pub enum SolidSource {
    /// A lattice around a surface.
    Around {
        /// The surface.
        mesh: TriMesh,
        /// The lattice, and how it moves the surface.
        embedded: EmbeddedSurface,
        /// Where its material comes from.
        material: MaterialOrigin,
    },
    /// A solid from a file, with its boundary.
    Whole {
        /// Its elements, with their vertices in the file.
        meshed: MeshedSolid,
        /// The surface of its elements.
        boundary: Boundary,
        /// Where its material comes from.
        material: MaterialOrigin,
    },
}

/// Whether a file has a volumetric mesh, by its extension.
pub fn is_solid(path: &Path) -> bool {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    ["mesh", "veg", "msh", "node", "ele"].contains(&ending.as_str())
}

impl SolidSource {
    /// Builds a lattice around a surface, with `cells` cubes along its longest side; none: about 20,000 cubes in all.
    ///
    /// # Errors
    /// When the surface is open or meets itself, the material is out of range, or `progress` cancels.
    pub fn around(
        mesh: TriMesh,
        cells: Option<usize>,
        material: &PartialMaterial,
        progress: &dyn Progress,
    ) -> Result<Self, SimError> {
        let embedded = EmbeddedSurface::new(&mesh, cells, Material::new(material)?, progress)?;
        Ok(Self::Around { mesh, embedded, material: MaterialOrigin::new(material, &[]) })
    }

    /// Reads a solid, or a surface and builds a lattice around it with `resolution` cubes along its longest side.
    /// Numbers of `material` override those of the file.
    ///
    /// # Errors
    /// When the file cannot be read, a resolution is given for a solid, a surface is open or meets itself, the material
    /// is out of range, or `progress` cancels.
    pub fn read(
        path: &Path,
        resolution: Option<usize>,
        material: &PartialMaterial,
        progress: &dyn Progress,
    ) -> Result<Self, SimError> {
        if !is_solid(path) {
            return Self::around(read_mesh(path)?, resolution, material, progress);
        }
        let file = read_volume_mesh(path)?;
        if resolution.is_some() {
            return Err(SimError::refused("--resolution is for surfaces", "this file has its own elements"));
        }
        let meshed = file.solid(material)?;
        let material = MaterialOrigin::new(material, &meshed.stated);
        let boundary = meshed.solid.boundary()?;
        Ok(Self::Whole { meshed, boundary, material })
    }

    /// Returns the solid.
    pub fn solid(&self) -> &Solid {
        match self {
            Self::Around { embedded, .. } => embedded.solid(),
            Self::Whole { meshed, .. } => &meshed.solid,
        }
    }

    /// Returns the origin of its material.
    pub fn material(&self) -> &MaterialOrigin {
        match self {
            Self::Around { material, .. } | Self::Whole { material, .. } => material,
        }
    }

    /// Returns a note on elements that were left out, if any.
    pub fn note(&self) -> Option<String> {
        match self {
            Self::Whole { meshed: MeshedSolid { outside, .. }, .. } if *outside > 0 => {
                Some(format!("{outside} tetrahedra outside the surface of the file are left out"))
            }
            _ => None,
        }
    }

    /// Whether vertices of the surface are split along seams.
    pub fn is_split(&self) -> bool {
        matches!(self, Self::Around { embedded, .. } if embedded.is_split())
    }

    /// Whether it is a lattice around a surface.
    pub fn is_embedded(&self) -> bool {
        matches!(self, Self::Around { .. })
    }

    /// Returns the surface.
    pub fn mesh(&self) -> &TriMesh {
        match self {
            Self::Around { mesh, .. } => mesh,
            Self::Whole { boundary, .. } => &boundary.mesh,
        }
    }

    /// Returns the surface alone.
    pub fn into_mesh(self) -> TriMesh {
        match self {
            Self::Around { mesh, .. } => mesh,
            Self::Whole { boundary, .. } => boundary.mesh,
        }
    }

    /// Returns modes of the solid as modes of the surface.
    ///
    /// # Errors
    /// When the modes belong to another solid.
    pub fn on_surface(&self, modes: &Modes) -> Result<Modes, SimError> {
        match self {
            Self::Around { embedded, .. } => Ok(embedded.on_surface(modes)?),
            Self::Whole { boundary, .. } => Ok(boundary.on_surface(modes)?),
        }
    }

    /// Returns the vertices of the solid that move a vertex of the file.
    ///
    /// # Errors
    /// When the file has fewer vertices.
    pub fn holding(&self, number: u32) -> Result<Vec<u32>, SimError> {
        let count = match self {
            Self::Around { mesh, .. } => mesh.rest_positions().len(),
            Self::Whole { meshed, .. } => meshed.vertices.len(),
        };
        if number as usize >= count {
            let cause = format!("the file has {count}");
            return Err(SimError::refused(
                format_args!("there is no vertex {number} (counted from 0)"),
                cause,
            ));
        }
        Ok(match self {
            Self::Around { embedded, .. } => embedded.holding(number as usize).collect(),
            Self::Whole { meshed, .. } => meshed.vertices[number as usize].into_iter().collect(),
        })
    }

    /// The vertices of the solid in a box, and those that hold vertices of the surface there.
    pub fn within(&self, low: DVec3, high: DVec3) -> Vec<u32> {
        let inside = |p: &DVec3| p.cmpge(low).all() && p.cmple(high).all();
        let solid = self.solid().vertices();
        let mut found: Vec<u32> = (0..solid.len() as u32).filter(|v| inside(&solid[*v as usize])).collect();
        if let Self::Around { mesh, embedded, .. } = self {
            let points = mesh.rest_positions();
            (0..points.len()).filter(|v| inside(&points[*v])).for_each(|v| found.extend(embedded.holding(v)));
        }
        found
    }
}
