//! Content of a mesh file before the checks of a mesh.

use glam::DVec3;
use sscc::TriMesh;

use crate::FormatError;

/// Positions and triangles of a file, with valid indices. A target shape may have no triangles.
pub(crate) struct Soup {
    pub positions: Vec<DVec3>,
    pub faces: Vec<[u32; 3]>,
}

impl Soup {
    /// Returns the mesh; it must have a triangle.
    pub fn into_mesh(self) -> Result<TriMesh, FormatError> {
        Ok(TriMesh::new(self.positions, self.faces)?)
    }
}
