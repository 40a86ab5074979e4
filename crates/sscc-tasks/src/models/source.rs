//! The solid for which modes are computed: from a file, with or without a separate surface, or a lattice around a surface.

use std::path::Path;

use glam::DVec3;
use sscc::{Modes, Progress, TriMesh};
use sscc_io::mesh::is_mesh_name;
use sscc_io::{
    IoError, Setting, VolumeOrSurface, read_mesh_with_warnings, read_volume_mesh, read_volume_or_surface,
};
use sscc_modes::EmbeddedSurface;
use sscc_solid::{Boundary, Material, MeshedSolid, PartialMaterial, Solid, VolumeMesh};

use super::material::MaterialOrigin;
use crate::TaskError;
use crate::error::At;
use crate::resize::scaled;

/// A solid with its surface.
pub enum SolidSource {
    /// A lattice around a surface.
    Around {
        /// The surface.
        mesh: TriMesh,
        /// The lattice, and the map from its vertices to those of the surface.
        embedded: EmbeddedSurface,
        /// Origin of its material.
        material: MaterialOrigin,
        /// Lines about content of its file whose meaning is not clear.
        warnings: Vec<String>,
    },
    /// A surface embedded in a solid from another file.
    Within {
        /// The surface.
        mesh: TriMesh,
        /// The solid, and the map from its vertices to those of the surface.
        embedded: EmbeddedSurface,
        /// Vertex of the solid for each vertex of its file; None for vertices of elements that were omitted.
        vertices: Vec<Option<u32>>,
        /// Number of elements that were omitted.
        left_out: usize,
        /// Origin of its material.
        material: MaterialOrigin,
        /// Lines about content of the surface's file whose meaning is not clear.
        warnings: Vec<String>,
    },
    /// A solid from a file, with its boundary.
    Whole {
        /// Its elements, with their vertices in the file.
        meshed: MeshedSolid,
        /// The surface of its elements.
        boundary: Boundary,
        /// Origin of its material.
        material: MaterialOrigin,
        /// Lines about faces of its file that belong to no element.
        warnings: Vec<String>,
    },
}

/// Whether a file has a volumetric mesh, by its extension.
pub fn is_solid(path: &Path) -> bool {
    sscc_io::solid::is_solid_name(path)
}

impl SolidSource {
    /// Builds a lattice around a surface, with `cells` cubes along its longest side. None means about 20,000 cubes in total.
    ///
    /// # Errors
    /// When the surface is open, not consistently oriented or meets itself, encloses no volume or has several pieces;
    /// when the number of cubes is too large or the material is out of range; when `progress` cancels.
    pub fn around(
        mesh: TriMesh,
        cells: Option<usize>,
        material: &PartialMaterial,
        progress: &dyn Progress,
    ) -> Result<Self, TaskError> {
        let embedded = EmbeddedSurface::new(&mesh, cells, Material::new(material)?, progress)?;
        let material = MaterialOrigin::new(material, &[]);
        Ok(Self::Around { mesh, embedded, material, warnings: Vec::new() })
    }

    /// Embeds a surface in a solid, which may be coarser: its vertices move with the elements that contain them, or with
    /// the nearest ones. Numbers of `material` override those of the solid.
    ///
    /// # Errors
    /// When the solid is invalid or has tetrahedra of second order, the material is out of range, a vertex of the
    /// surface is farther from the solid than a tenth of the longest side of the solid, or `progress` cancels.
    pub fn embedded(
        mesh: TriMesh,
        solid: &VolumeMesh,
        material: &PartialMaterial,
        progress: &dyn Progress,
    ) -> Result<Self, TaskError> {
        let MeshedSolid { solid, vertices, stated, outside } = solid.solid(material)?;
        let material = MaterialOrigin::new(material, &stated);
        let embedded = EmbeddedSurface::within(&mesh, solid, progress)?;
        Ok(Self::Within { mesh, embedded, vertices, left_out: outside, material, warnings: Vec::new() })
    }

    /// Creates the source from a solid with its boundary. Numbers of `material` override those of the solid.
    ///
    /// # Errors
    /// When the solid is invalid, or the material is out of range.
    pub fn whole(solid: &VolumeMesh, material: &PartialMaterial) -> Result<Self, TaskError> {
        let meshed = solid.solid(material)?;
        let material = MaterialOrigin::new(material, &meshed.stated);
        let boundary = meshed.solid.boundary()?;
        Ok(Self::Whole { meshed, boundary, material, warnings: Vec::new() })
    }

    /// Reads a surface and the solid in which it is embedded: see [`SolidSource::embedded`]. All lengths of both are
    /// multiplied by `scale`.
    ///
    /// # Errors
    /// When a file cannot be read or is of another kind, or a scaled coordinate is out of range; also the errors of
    /// [`SolidSource::embedded`].
    pub fn read_within(
        surface: &Path,
        solid: &Path,
        scale: f64,
        material: &PartialMaterial,
        progress: &dyn Progress,
    ) -> Result<Self, TaskError> {
        let (mesh, warnings) = read_embedded(surface)?;
        let mesh = scaled(mesh, scale).in_file(surface)?;
        let file = read_volume_mesh(solid)?.scaled(scale).in_file(solid)?;
        let source = Self::embedded(mesh, &file, material, progress).in_file(solid)?;
        Ok(source.with_warnings(warnings))
    }

    /// Reads a solid, or reads a surface and builds a lattice around it with `resolution` cubes along its longest side. All
    /// lengths of the file are multiplied by `scale`. Numbers of `material` override those of the file.
    ///
    /// # Errors
    /// When the file cannot be read, a scaled coordinate is out of range, or a resolution is given for a solid; also
    /// the errors of [`SolidSource::around`] and [`SolidSource::whole`].
    pub fn read(
        path: &Path,
        resolution: Option<usize>,
        scale: f64,
        material: &PartialMaterial,
        progress: &dyn Progress,
    ) -> Result<Self, TaskError> {
        let surface = |(mesh, warnings): (TriMesh, Vec<String>)| -> Result<Self, TaskError> {
            let mesh = scaled(mesh, scale)?;
            Ok(Self::around(mesh, resolution, material, progress)?.with_warnings(warnings))
        };
        if !is_solid(path) {
            return surface(read_surface(path)?);
        }
        let (file, left_out) = match read_volume_or_surface(path)? {
            VolumeOrSurface::Surface { mesh, warnings } => return surface((mesh, warnings)),
            VolumeOrSurface::Volume { mesh, faces } => {
                let left_out = faces.left_out(&mesh);
                (mesh, left_out)
            }
        };
        if resolution.is_some() {
            let place = Setting::Resolution + " is for surfaces";
            return Err(TaskError::refused(place, "this file has its own elements"));
        }
        Ok(Self::whole(&file.scaled(scale)?, material)?.with_warnings(left_out))
    }

    /// Adds lines about the file of its surface, or about faces that belong to no element.
    #[must_use]
    pub(crate) fn with_warnings(mut self, lines: Vec<String>) -> Self {
        let (Self::Around { warnings, .. } | Self::Within { warnings, .. } | Self::Whole { warnings, .. }) =
            &mut self;
        *warnings = lines;
        self
    }

    /// Returns the solid.
    pub fn solid(&self) -> &Solid {
        match self {
            Self::Around { embedded, .. } | Self::Within { embedded, .. } => embedded.solid(),
            Self::Whole { meshed, .. } => &meshed.solid,
        }
    }

    /// Returns the origin of its material.
    pub fn material(&self) -> &MaterialOrigin {
        match self {
            Self::Around { material, .. } | Self::Within { material, .. } | Self::Whole { material, .. } => {
                material
            }
        }
    }

    /// Returns a note on elements that were omitted, on vertices of the surface outside the solid, on content of the
    /// surface's file whose meaning is not clear, and on faces that belong to no element, if there are any.
    pub fn note(&self) -> Option<String> {
        let (left_out, outside, warnings) = match self {
            Self::Around { warnings, .. } => (0, None, &warnings[..]),
            Self::Within { embedded, left_out, warnings, .. } => {
                (*left_out, embedded.outside(), &warnings[..])
            }
            Self::Whole { meshed, warnings, .. } => (meshed.outside, None, &warnings[..]),
        };
        let left_out = (left_out > 0)
            .then(|| format!("{left_out} tetrahedra outside the surface of the file are left out"));
        let notes: Vec<String> = left_out
            .into_iter()
            .chain(outside.map(ToString::to_string))
            .chain(warnings.iter().cloned())
            .collect();
        (!notes.is_empty()).then(|| notes.join("; "))
    }

    /// Whether the surface is embedded: in a lattice or another solid.
    pub fn is_embedded(&self) -> bool {
        !matches!(self, Self::Whole { .. })
    }

    /// Returns the surface.
    pub fn mesh(&self) -> &TriMesh {
        match self {
            Self::Around { mesh, .. } | Self::Within { mesh, .. } => mesh,
            Self::Whole { boundary, .. } => &boundary.mesh,
        }
    }

    /// Returns the surface. If it is closed only when equal vertices are welded, it is a mesh with split vertices.
    pub fn into_mesh(self) -> TriMesh {
        match self {
            Self::Around { mesh, embedded, .. } if embedded.is_split() => mesh.with_split_vertices(),
            Self::Around { mesh, .. } | Self::Within { mesh, .. } => mesh,
            Self::Whole { boundary, .. } => boundary.mesh,
        }
    }

    /// Returns modes of the solid as modes of the surface.
    ///
    /// # Errors
    /// When the modes belong to another solid.
    pub fn on_surface(&self, modes: &Modes) -> Result<Modes, TaskError> {
        match self {
            Self::Around { embedded, .. } | Self::Within { embedded, .. } => Ok(embedded.on_surface(modes)?),
            Self::Whole { boundary, .. } => Ok(boundary.on_surface(modes)?),
        }
    }

    /// Returns the vertices of the solid that move the vertex with this number: for a lattice, a vertex of the
    /// surface's file; otherwise one of the solid's file.
    ///
    /// # Errors
    /// When the file has fewer vertices.
    pub fn holding(&self, number: u32) -> Result<Vec<u32>, TaskError> {
        let missing = |count: usize| {
            let place = format!("there is no vertex {number} (counted from 0)");
            TaskError::refused(place, format!("the file has {count}"))
        };
        let at = number as usize;
        match self {
            Self::Around { mesh, embedded, .. } => {
                let count = mesh.rest_positions().len();
                if at < count { Ok(embedded.holding(at).collect()) } else { Err(missing(count)) }
            }
            Self::Within { vertices, .. } | Self::Whole { meshed: MeshedSolid { vertices, .. }, .. } => {
                let known = vertices.get(at).ok_or_else(|| missing(vertices.len()))?;
                Ok(known.iter().copied().collect())
            }
        }
    }

    /// Returns the vertices of the solid in a box, and the vertices that move vertices of the surface in the box.
    pub fn within(&self, low: DVec3, high: DVec3) -> Vec<u32> {
        let inside = |p: &DVec3| p.cmpge(low).all() && p.cmple(high).all();
        let solid = self.solid().vertices();
        let mut found: Vec<u32> = (0..solid.len() as u32).filter(|v| inside(&solid[*v as usize])).collect();
        if let Self::Around { mesh, embedded, .. } | Self::Within { mesh, embedded, .. } = self {
            let points = mesh.rest_positions();
            (0..points.len()).filter(|v| inside(&points[*v])).for_each(|v| found.extend(embedded.holding(v)));
        }
        found
    }
}

/// Reads a surface that is to be embedded in a solid.
///
/// # Errors
/// When the file is a solid itself, or cannot be read.
pub(crate) fn read_embedded(path: &Path) -> Result<(TriMesh, Vec<String>), TaskError> {
    if is_solid(path) {
        let cause = "only a surface (.obj, .off, .ply, .stl) can be embedded in another solid";
        return Err(TaskError::refused("it is a solid itself", cause));
    }
    Ok(read_mesh_with_warnings(path)?)
}

/// Reads a surface for modes, with lines about content of its file whose meaning is not clear.
///
/// # Errors
/// When the file extension is not that of a mesh file; also the errors of [`sscc_io::read_mesh`].
pub fn read_surface(path: &Path) -> Result<(TriMesh, Vec<String>), IoError> {
    if path.exists() && !is_mesh_name(path) {
        let (what, supported) = (
            "surface or solid",
            ".obj, .off, .ply, .stl; solids: .mesh, .veg, .msh, .node, .ele, .vtu, .vtk",
        );
        return Err(IoError::Unsupported { path: path.to_owned(), what, supported });
    }
    read_mesh_with_warnings(path)
}
