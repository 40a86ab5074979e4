//! The convex hull of three corners as a triangle, a segment or a point, and on which feature of it a point lies.

use glam::DVec3;

use super::feature::Feature;
use crate::geometry::orientation::orient2d;
use crate::geometry::planar::{AXES, injective_projection, project};

/// The hull of a triangle's corners.
pub(super) struct Hull<'a> {
    pub(super) corners: &'a [DVec3; 3],
    pub(super) shape: Shape,
}

/// The shape that three corners span.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shape {
    /// All corners are equal: corner 0.
    Point,
    /// The corners are collinear: the edge of this number contains them.
    Segment(usize),
    /// The triangle is not degenerate. The projection along this axis is injective on it.
    Triangle { axis: usize },
}

impl<'a> Hull<'a> {
    /// Decides exactly which shape the corners span.
    pub(super) fn of(corners: &'a [DVec3; 3]) -> Self {
        let shape = match injective_projection(corners) {
            Some(axis) => Shape::Triangle { axis },
            None => longest_edge(corners).map_or(Shape::Point, Shape::Segment),
        };
        Self { corners, shape }
    }

    /// Whether the triangle is not degenerate.
    pub(super) fn is_triangle(&self) -> bool {
        matches!(self.shape, Shape::Triangle { .. })
    }

    /// Returns the corners of the hull, each point once.
    pub(super) fn vertices(&self) -> impl Iterator<Item = usize> + use<> {
        let (vertices, count) = match self.shape {
            Shape::Point => ([0; 3], 1),
            Shape::Segment(i) => ([i, (i + 1) % 3, 0], 2),
            Shape::Triangle { .. } => ([0, 1, 2], 3),
        };
        vertices.into_iter().take(count)
    }

    /// Returns the edges of the hull, each segment once.
    pub(super) fn edges(&self) -> std::ops::Range<usize> {
        match self.shape {
            Shape::Point => 0..0,
            Shape::Segment(i) => i..i + 1,
            Shape::Triangle { .. } => 0..3,
        }
    }

    /// Returns the ends of edge i.
    pub(super) fn edge(&self, i: usize) -> [DVec3; 2] {
        [self.corners[i], self.corners[(i + 1) % 3]]
    }

    /// Returns the feature on which a point lies, decided exactly. None for a point off the hull. `side` is the point's side of
    /// the plane through the corners.
    pub(super) fn locate(&self, p: DVec3, side: i8) -> Option<Feature> {
        if side != 0 {
            return None;
        }
        match self.shape {
            Shape::Point => (p == self.corners[0]).then_some(Feature::Vertex(0)),
            Shape::Segment(i) => self.locate_on_segment(p, i),
            Shape::Triangle { axis } => self.locate_in_plane(p, axis),
        }
    }

    fn locate_on_segment(&self, p: DVec3, i: usize) -> Option<Feature> {
        let [start, end] = self.edge(i);
        if p == start || p == end {
            return Some(Feature::Vertex(if p == start { i } else { (i + 1) % 3 } as u8));
        }
        // The lexicographic order of points on a line is that along the line.
        let is_between = lexicographic(start, p) == lexicographic(p, end);
        let is_collinear = || {
            AXES.into_iter()
                .all(|axis| orient2d(project(start, axis), project(end, axis), project(p, axis)) == 0)
        };
        (is_between && is_collinear()).then_some(Feature::Edge(i as u8))
    }

    fn locate_in_plane(&self, p: DVec3, axis: usize) -> Option<Feature> {
        let corners = self.corners.map(|corner| project(corner, axis));
        let p = project(p, axis);
        let inside = orient2d(corners[0], corners[1], corners[2]);
        let turns = [0, 1, 2].map(|i| inside * orient2d(corners[i], corners[(i + 1) % 3], p));
        let on = |i: usize| turns[i] == 0;
        if turns.contains(&-1) {
            return None;
        }
        // Corner i is on the edges i and i - 1.
        let vertex = (0..3).find(|&i| on(i) && on((i + 2) % 3)).map(|i| Feature::Vertex(i as u8));
        let edge = (0..3).find(|&i| on(i)).map(|i| Feature::Edge(i as u8));
        vertex.or(edge).or(Some(Feature::Face))
    }
}

/// Whether p is before q in lexicographic order.
pub(super) fn lexicographic(p: DVec3, q: DVec3) -> bool {
    p.to_array() < q.to_array()
}

/// Returns the edge that contains three collinear corners. None if all are equal.
///
/// The lexicographic order of points on a line is that along the line, so the edge joins the first and the last.
fn longest_edge(corners: &[DVec3; 3]) -> Option<usize> {
    (0..3).find(|&i| {
        let [p, q, r] = [corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]];
        let (first, last) = if lexicographic(p, q) { (p, q) } else { (q, p) };
        first != last && !lexicographic(r, first) && !lexicographic(last, r)
    })
}
