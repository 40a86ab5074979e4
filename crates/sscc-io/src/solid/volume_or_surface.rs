//! Content of a file of a solid.

use sscc::TriMesh;
use sscc_solid::VolumeMesh;

use super::listed_faces::ListedFaces;
use crate::FormatError;

/// Content of a file of a format for solids.
#[derive(Clone, Debug, PartialEq)]
pub enum VolumeOrSurface {
    /// A volumetric mesh.
    Volume {
        /// The mesh, with all vertices of the file.
        mesh: VolumeMesh,
        /// What the file states about the faces beside the elements.
        faces: ListedFaces,
    },
    /// The faces of a file without tetrahedra and cubes.
    Surface {
        /// The mesh, with all vertices of the file.
        mesh: TriMesh,
        /// Lines about faces whose triangles the file does not determine.
        warnings: Vec<String>,
    },
}

impl VolumeOrSurface {
    /// Returns the content of a file that lists no faces.
    pub(super) fn without_faces(mesh: VolumeMesh) -> Self {
        Self::Volume { mesh, faces: ListedFaces::default() }
    }

    /// Returns the volumetric mesh, and lines about listed faces that belong to no element.
    pub(crate) fn into_volume(self) -> Result<(VolumeMesh, Vec<String>), FormatError> {
        match self {
            Self::Volume { mesh, faces } => {
                let left_out = faces.left_out(&mesh);
                Ok((mesh, left_out))
            }
            Self::Surface { mesh, .. } => {
                let cause = format!(
                    "the mesh has no elements: it is a surface of {} triangles; add tetrahedra or hexahedra",
                    mesh.faces().len()
                );
                Err(FormatError::whole(cause))
            }
        }
    }

    /// Returns the surface, with all vertices of the file, and lines about what it leaves out or adds. The surface of a
    /// volumetric mesh is that of its elements ([`VolumeMesh::surface_mesh`]), then the listed faces that belong to no
    /// element.
    pub(crate) fn into_surface(self) -> Result<(TriMesh, Vec<String>), FormatError> {
        match self {
            Self::Volume { mesh, faces } => surface(&mesh, &faces),
            Self::Surface { mesh, warnings } => Ok((mesh, warnings)),
        }
    }
}

/// Returns the surface of a solid and of the listed faces that belong to no element.
fn surface(solid: &VolumeMesh, faces: &ListedFaces) -> Result<(TriMesh, Vec<String>), FormatError> {
    let of_elements = solid.surface_mesh()?;
    let (free, of_polygons) = faces.free_triangles(solid)?;
    let left_out = solid.tets_left_out();
    let mut warnings = Vec::new();
    if left_out > 0 {
        warnings.push(format!("{left_out} tetrahedra outside the surface of the file are left out"));
    }
    warnings.extend(faces.unread().map(str::to_owned));
    warnings.extend(faces.other_middles(solid));
    if free.is_empty() {
        return Ok((of_elements, warnings));
    }
    let count = free.len();
    warnings.push(format!(
        "{count} triangles of the file belong to no element: they are added after those of the elements"
    ));
    warnings.extend(of_polygons);
    let triangles = [of_elements.faces(), &free[..]].concat();
    Ok((TriMesh::new(of_elements.rest_positions().to_vec(), triangles)?, warnings))
}
