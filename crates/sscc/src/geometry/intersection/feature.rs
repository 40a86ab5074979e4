//! The common points of two triangles, and the features of both on which each lies.

use glam::DVec3;

/// The part of a triangle whose relative interior contains a point. Numbers count within the triangle, from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Feature {
    /// A corner.
    Vertex(u8),
    /// The open edge from corner i to corner `(i + 1) % 3`.
    Edge(u8),
    /// The interior.
    Face,
}

impl Feature {
    /// Whether the feature is part of the closed edge i.
    pub(super) fn is_on_edge(self, i: usize) -> bool {
        match self {
            Self::Vertex(vertex) => usize::from(vertex) == i || usize::from(vertex) == (i + 1) % 3,
            Self::Edge(edge) => usize::from(edge) == i,
            Self::Face => false,
        }
    }
}

/// A corner of the set of common points of two triangles: a common point of one feature of each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntersectionPoint {
    /// The point (model unit), rounded; see [`intersection_triangle_triangle`](crate::parts::intersection_triangle_triangle).
    pub position: DVec3,
    /// The feature of each triangle on which the exact point lies. It is the only common point of these two features.
    pub features: [Feature; 2],
}

/// All common points of two triangles: the convex hull of one to six corners.
#[derive(Clone, Debug, PartialEq)]
pub enum Intersection {
    /// A single point.
    Point(IntersectionPoint),
    /// A segment, by its ends.
    Segment([IntersectionPoint; 2]),
    /// A convex polygon of three to six corners, in order around it (either way): triangles in one plane.
    Polygon(Box<[IntersectionPoint]>),
}

impl Intersection {
    /// Returns the corners: one, two, or three to six.
    pub fn points(&self) -> &[IntersectionPoint] {
        match self {
            Self::Point(point) => std::slice::from_ref(point),
            Self::Segment(ends) => ends,
            Self::Polygon(corners) => corners,
        }
    }
}
