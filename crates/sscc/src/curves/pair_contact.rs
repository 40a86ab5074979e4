//! The contact of a colliding pair of triangles.

use glam::DVec3;

use crate::Pair;
use crate::geometry::{Intersection, TriangleContact};

/// The contact of a colliding pair of triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct PairContact {
    /// The numbers of the two triangles, in the order given.
    pub pair: Pair,
    /// The common points, as computed by [`intersection_triangle_triangle`](crate::parts::intersection_triangle_triangle).
    pub intersection: Intersection,
    /// Unit normals of both triangles, from whose side their corners turn counterclockwise; 0 for a degenerate one.
    pub normals: [DVec3; 2],
    /// The penetration depth (model unit): the length of the smallest translation after which the two only touch; see
    /// [`penetration_triangle_triangle`](crate::parts::penetration_triangle_triangle).
    pub depth: f64,
    /// The direction of this translation for the second triangle, a unit vector; the opposite one for the first.
    pub direction: DVec3,
}

impl PairContact {
    /// Returns the contact of two triangles with these corners. None if they are disjoint.
    pub(super) fn of(pair: Pair, a: &[DVec3; 3], b: &[DVec3; 3]) -> Option<Self> {
        let TriangleContact { intersection, normals, penetration } = TriangleContact::of(a, b)?;
        Some(Self { pair, intersection, normals, depth: penetration.depth, direction: penetration.direction })
    }
}
