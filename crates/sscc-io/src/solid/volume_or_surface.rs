//! Content of a file of a solid.

use sscc::TriMesh;
use sscc_solid::VolumeMesh;

use crate::FormatError;

/// Content of a file of a format for solids.
#[derive(Clone, Debug, PartialEq)]
pub enum VolumeOrSurface {
    /// A volumetric mesh.
    Volume(VolumeMesh),
    /// The faces of a file without tetrahedra and cubes.
    Surface {
        /// The mesh, with all vertices of the file.
        mesh: TriMesh,
        /// Lines about faces whose triangles the file does not determine.
        warnings: Vec<String>,
    },
}

impl VolumeOrSurface {
    /// Returns the volumetric mesh.
    pub(crate) fn into_volume(self) -> Result<VolumeMesh, FormatError> {
        match self {
            Self::Volume(mesh) => Ok(mesh),
            Self::Surface { mesh, .. } => {
                let cause = format!(
                    "the mesh has no elements: it is a surface of {} triangles; add tetrahedra or hexahedra",
                    mesh.faces().len()
                );
                Err(FormatError::whole(cause))
            }
        }
    }

    /// Returns the surface, with all vertices of the file. The surface of a volumetric mesh is that of its elements
    /// ([`VolumeMesh::surface_mesh`]).
    pub(crate) fn into_surface(self) -> Result<(TriMesh, Vec<String>), FormatError> {
        match self {
            Self::Volume(mesh) => Ok((mesh.surface_mesh()?, Vec::new())),
            Self::Surface { mesh, warnings } => Ok((mesh, warnings)),
        }
    }
}
