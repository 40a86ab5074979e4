//! What a mesh file holds, before it is known to be a mesh.

use glam::DVec3;
use sscc::TriMesh;

use crate::FormatError;

/// Positions and triangles of a file. Every corner names a position. There may be no triangle: a target shape
/// is one without.
pub(crate) struct Soup {
    pub positions: Vec<DVec3>,
    pub faces: Vec<[u32; 3]>,
}

impl Soup {
    /// The mesh, which has a triangle.
    pub fn into_mesh(self) -> Result<TriMesh, FormatError> {
        Ok(TriMesh::new(self.positions, self.faces)?)
    }
}
