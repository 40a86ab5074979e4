//! Vertices, edges and faces of a mesh.

use crate::geometry::Feature;

/// A vertex, edge or face of a mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum MeshFeature {
    /// The vertex of this number.
    Vertex(u32),
    /// The edge between two vertices, the lower number first.
    Edge(u32, u32),
    /// The interior of the triangle of this number.
    Face(u32),
}

impl MeshFeature {
    /// Returns the feature of a triangle as one of the mesh.
    pub(super) fn of(feature: Feature, triangle: u32, corners: [u32; 3]) -> Self {
        match feature {
            Feature::Vertex(i) => Self::Vertex(corners[usize::from(i)]),
            Feature::Edge(i) => {
                let (start, end) = (corners[usize::from(i)], corners[(usize::from(i) + 1) % 3]);
                Self::Edge(start.min(end), start.max(end))
            }
            Feature::Face => Self::Face(triangle),
        }
    }
}
