//! The contact of two intersecting triangles: common points, normals, penetration depth.

use glam::DVec3;

use super::feature::Intersection;
use super::normal::unit_normal;
use super::penetration::Penetration;
use super::triangle_triangle::TrianglePair;

/// The contact of two intersecting triangles.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TriangleContact {
    pub(crate) intersection: Intersection,
    /// Unit normals of both triangles; 0 for a degenerate one.
    pub(crate) normals: [DVec3; 2],
    pub(crate) penetration: Penetration,
}

impl TriangleContact {
    /// Computes the contact. None if the triangles are disjoint.
    pub(crate) fn of(a: &[DVec3; 3], b: &[DVec3; 3]) -> Option<Self> {
        let pair = TrianglePair::of(a, b)?;
        let intersection = pair.intersection()?;
        let penetration = pair.penetration(&intersection);
        Some(Self { intersection, normals: [unit_normal(&pair.a), unit_normal(&pair.b)], penetration })
    }
}
