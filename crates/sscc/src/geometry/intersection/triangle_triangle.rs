//! The common points of two closed triangles, with all decisions exact.
//!
//! **Which points.** The common points are a convex set, the hull of its corners. A face of an intersection of convex
//! polytopes is the intersection of a face of each. So its corners are exactly the points in which the relative interior
//! of a feature of a (vertex, edge, face) and that of a feature of b have a single point in common: vertices on any
//! feature, edges that cross edges or faces. Each such pair of features is tested by signs of determinants, and
//! no corner occurs twice, because a point is in the relative interior of one feature of each triangle only. A degenerate
//! triangle is a segment or a point, and has the features of that shape.

use glam::DVec3;

use super::corner_order::sort_around;
use super::crossing_point::{cross_edge_edge, cross_edge_face};
use super::feature::{Feature, Intersection, IntersectionPoint};
use super::hull::Hull;
use crate::geometry::orientation::{Plane, is_strictly_one_side, orient2d, orient3d};
use crate::geometry::planar::{injective_projection, project};
use crate::limits;

/// Returns all common points of two closed triangles: none, a point, a segment, or a convex polygon for triangles in one plane.
///
/// There are some exactly if [`intersect_triangle_triangle`](crate::intersect_triangle_triangle) is true, under the same
/// conditions: coordinates (any unit) are finite and at most [`limits::LARGEST`] in magnitude; corners may be in any order; a
/// degenerate triangle is the segment or point that its corners span.
///
/// The kind of the result, the number of corners, their order and the features on which they lie are exact. Positions are
/// rounded. A corner on a vertex has the position of the vertex. A corner on an edge from p to q (on the shorter one where two
/// edges cross) errs in each coordinate x by at most `u |x| + 3 u |q - p|`, with `u = 2^-53` and the same coordinate of `q - p`,
/// or by the smallest denormal number. It is in the AABBs of both features. The position depends on the two features alone:
/// triangles that share them get the same bits (but for the sign of 0).
///
/// If a degenerate triangle is a segment, only its longest edge and the ends of that edge are features.
///
/// A call costs about a microsecond, ten times the test alone. It costs some microseconds for triangles in one plane, for
/// coordinates below 2^-240, and for lines that are parallel up to 2^-40, which need integers.
///
/// ```
/// use glam::DVec3;
/// use sscc::parts::{Feature, Intersection, intersection_triangle_triangle};
///
/// let a = [DVec3::ZERO, DVec3::X, DVec3::Y];
/// let b = [DVec3::new(0.25, 0.25, -1.0), DVec3::new(0.25, 0.25, 1.0), DVec3::new(2.0, 0.25, 1.0)];
/// let Some(Intersection::Segment(ends)) = intersection_triangle_triangle(&a, &b) else { panic!() };
/// assert_eq!(ends[0].features, [Feature::Edge(1), Feature::Face]); // where a's second edge crosses b
/// assert_eq!(ends[0].position, DVec3::new(0.75, 0.25, 0.0));
/// assert_eq!(ends[1].features, [Feature::Face, Feature::Edge(0)]);
/// assert_eq!(ends[1].position, DVec3::new(0.25, 0.25, 0.0));
/// ```
pub fn intersection_triangle_triangle(a: &[DVec3; 3], b: &[DVec3; 3]) -> Option<Intersection> {
    debug_assert!(a.iter().chain(b).all(|p| limits::contains(*p)), "corner out of range: {a:?} {b:?}");
    TrianglePair::of(a, b)?.intersection()
}

/// Two triangles, neither of which is strictly on one side of the other's plane.
pub(super) struct TrianglePair<'a> {
    pub(super) a: Hull<'a>,
    pub(super) b: Hull<'a>,
    /// For each corner of a its side of the plane of b, and for each corner of b its side of the plane of a.
    pub(super) sides: [[i8; 3]; 2],
}

impl<'a> TrianglePair<'a> {
    /// Determines hulls and sides. None if all corners of one triangle are strictly on one side of the other's plane.
    pub(super) fn of(a: &'a [DVec3; 3], b: &'a [DVec3; 3]) -> Option<Self> {
        let sides_of_b = Plane::through(a).sides_unless_separated(b)?;
        let sides_of_a = Plane::through(b).sides_unless_separated(a)?;
        Some(Self { a: Hull::of(a), b: Hull::of(b), sides: [sides_of_a, sides_of_b] })
    }

    /// Returns the common points.
    pub(super) fn intersection(&self) -> Option<Intersection> {
        let mut corners = Corners::new();
        self.add_vertices(&mut corners);
        self.add_crossings(&mut corners);
        let corners = corners.as_mut_slice();
        sort_around(corners);
        match *corners {
            [] => None,
            [point] => Some(Intersection::Point(point)),
            [p, q] => Some(Intersection::Segment([p, q])),
            _ => Some(Intersection::Polygon(Box::from(&*corners))),
        }
    }

    /// Adds the vertices of each triangle that are on the other.
    fn add_vertices(&self, corners: &mut Corners) {
        for i in self.a.vertices() {
            if let Some(feature) = self.b.locate(self.a.corners[i], self.sides[0][i]) {
                corners.add(self.a.corners[i], [Feature::Vertex(i as u8), feature]);
            }
        }
        for j in self.b.vertices() {
            match self.a.locate(self.b.corners[j], self.sides[1][j]) {
                None | Some(Feature::Vertex(_)) => {}
                Some(feature) => corners.add(self.b.corners[j], [feature, Feature::Vertex(j as u8)]),
            }
        }
    }

    /// Adds the points where edges cross faces or edges.
    fn add_crossings(&self, corners: &mut Corners) {
        let (a, b) = (&self.a, &self.b);
        // Whether the ends of an edge are strictly on the same side.
        let is_apart = |side: usize, i: usize| {
            is_strictly_one_side(&[self.sides[side][i], self.sides[side][(i + 1) % 3]])
        };
        let mut turns = [[0; 3]; 3];
        for i in a.edges() {
            for j in b.edges() {
                let ([p, q], [r, s]) = (a.edge(i), b.edge(j));
                turns[i][j] = orient3d(p, q, r, s);
                let may_cross = turns[i][j] == 0 && !is_apart(0, i) && !is_apart(1, j);
                if may_cross && are_crossing([p, q], [r, s]) {
                    let position = cross_edge_edge([p, q], [r, s]);
                    corners.add(position, [Feature::Edge(i as u8), Feature::Edge(j as u8)]);
                }
            }
        }
        let crosses = |side: usize, i: usize, turns: [i8; 3]| {
            self.sides[side][i] * self.sides[side][(i + 1) % 3] == -1 && is_strictly_one_side(&turns)
        };
        if b.is_triangle() {
            for i in a.edges().filter(|&i| crosses(0, i, turns[i])) {
                corners.add(cross_edge_face(a.edge(i), b.corners), [Feature::Edge(i as u8), Feature::Face]);
            }
        }
        if a.is_triangle() {
            for j in b.edges().filter(|&j| crosses(1, j, turns.map(|row| row[j]))) {
                corners.add(cross_edge_face(b.edge(j), a.corners), [Feature::Face, Feature::Edge(j as u8)]);
            }
        }
    }
}

/// Whether two segments in one plane, neither a point, cross in the interior of both.
///
/// If they do, the corners `p, q, r` are not collinear, and the projection along their axis is injective on the plane.
fn are_crossing([p, q]: [DVec3; 2], [r, s]: [DVec3; 2]) -> bool {
    injective_projection(&[p, q, r]).is_some_and(|axis| {
        let [p, q, r, s] = [p, q, r, s].map(|x| project(x, axis));
        orient2d(p, q, r) * orient2d(p, q, s) == -1 && orient2d(r, s, p) * orient2d(r, s, q) == -1
    })
}

/// The corners found. Two triangles have at most six.
struct Corners {
    corners: [IntersectionPoint; 6],
    count: usize,
}

impl Corners {
    const fn new() -> Self {
        let unused = IntersectionPoint { position: DVec3::ZERO, features: [Feature::Face; 2] };
        Self { corners: [unused; 6], count: 0 }
    }

    fn add(&mut self, position: DVec3, features: [Feature; 2]) {
        self.corners[self.count] = IntersectionPoint { position, features };
        self.count += 1;
    }

    fn as_mut_slice(&mut self) -> &mut [IntersectionPoint] {
        &mut self.corners[..self.count]
    }
}
