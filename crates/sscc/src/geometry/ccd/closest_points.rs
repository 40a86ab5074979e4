//! The closest points of two moving triangles at one time, and a direction that separates the triangles there.
//!
//! Both are heuristics. [`candidate_direction`](super::candidate_direction) certifies the directions.

use glam::DVec3;

use super::candidate_direction::{CandidateDirection, MovingPair};
use crate::geometry::triangle_triangle::intersect_beyond_limits;
use crate::geometry::{TwoTriangles, nearest_to_origin};

/// The closest points of the two triangles at a time.
pub(super) struct ClosestPoints {
    /// The distance of two of their points, rounded: an upper bound of their distance. 0 if they meet.
    pub(super) distance: f64,
    /// A direction that separates them at that time, if one was found.
    pub(super) direction: Option<CandidateDirection>,
}

impl ClosestPoints {
    pub(super) fn at(pair: &MovingPair, t: f64) -> Self {
        let corners = pair.at(t);
        let differences = corners.differences();
        // Squares of small numbers would underflow.
        let size = differences.iter().fold(0.0_f64, |size, d| size.max(d.abs().max_element()));
        if size == 0.0 {
            return Self { distance: 0.0, direction: None };
        }
        let point = nearest_to_origin(&differences.map(|d| d / size)).point;
        let distance = point.length() * size;
        // The direction between two close points is imprecise; and in flat cases they may not be the closest ones.
        // Either way the gap is then too narrow.
        let between = pair.along(point).filter(|dir| dir.gap(t) > WIDE * distance);
        if between.is_some() {
            return Self { distance, direction: between };
        }
        // No direction separates triangles that meet, and searching one is slow. Relative to a corner, coordinates are
        // up to twice as large as those given.
        let TwoTriangles { a, b } = &corners;
        if with_mutant!(
            intersect_beyond_limits(a, b),
            RelativeCornersLimited,
            crate::intersect_triangle_triangle(a, b)
        ) {
            return Self { distance: 0.0, direction: None };
        }
        Self { distance, direction: find_widest_gap(pair, t, &corners) }
    }
}

/// The direction between the closest points is accepted if its gap is more than this share of the distance.
const WIDE: f64 = 0.75;

/// Returns the direction with the widest gap among all in which features of two triangles can be closest: two vertices,
/// a vertex and an edge, two edges, a vertex and a face. None if none of them separates the triangles. The directions
/// of two edges and of a face are computed from edges, which are long, so that they are as precise for narrow gaps as
/// for wide ones.
#[cold]
fn find_widest_gap(pair: &MovingPair, t: f64, corners: &TwoTriangles) -> Option<CandidateDirection> {
    let TwoTriangles { a, b } = corners;
    let edges = |[p, q, r]: [DVec3; 3]| [q - p, r - q, p - r].map(normalize);
    let (edges_a, edges_b) = (edges(*a), edges(*b));
    // Only the best one is projected at t = 0 and at t = 1.
    let mut best = (0.0, DVec3::ZERO);
    let mut consider = |dir: DVec3| {
        let dir = dir / dir.abs().max_element();
        let [(lower_a, upper_a), (lower_b, upper_b)] = [a, b].map(|triangle| {
            let [p, q, r] = triangle.map(|p| dir.dot(p));
            (p.min(q).min(r), p.max(q).max(r))
        });
        let rounding = pair.rounding(dir);
        // Both are NaN where dir is 0.
        for (gap, dir) in [(lower_b - upper_a, dir), (lower_a - upper_b, -dir)] {
            if gap - rounding > best.0 {
                best = (gap - rounding, dir);
            }
        }
    };
    for [e, f, g] in [edges_a, edges_b] {
        // For a sliver, this takes the normal of the edges whose directions differ most.
        let normals = [e.cross(f), f.cross(g), g.cross(e)];
        let longer = |m: DVec3, n: DVec3| if m.length_squared() < n.length_squared() { n } else { m };
        consider(normals.into_iter().fold(DVec3::ZERO, longer));
    }
    for i in 0..3 {
        for j in 0..3 {
            consider(edges_a[i].cross(edges_b[j]));
            let d = normalize(b[j] - a[i]);
            consider(d);
            // Edge i begins at vertex i.
            for e in [edges_a[i], edges_b[j]] {
                consider(d - e * e.dot(d));
            }
        }
    }
    pair.along(best.1).filter(|candidate| candidate.gap(t) > 0.0)
}

/// Returns the unit vector of any vector but 0, however small.
fn normalize(v: DVec3) -> DVec3 {
    (v / v.abs().max_element()).normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::ccd::moving_triangle::MovingTriangle;
    use crate::geometry::distance_triangle_triangle;
    use crate::test_models::Random;

    /// Edges cross at a distance of 1e-12, so that the direction between the closest points is far too imprecise. Each edge of both
    /// triangles is the crossing one in turn.
    #[test]
    fn narrow_gaps_between_crossing_edges_are_found() {
        let v = DVec3::new;
        let below = [v(-1.0, -0.3, 0.0), v(1.1, 0.4, 0.0), v(0.2, 0.1, -1.0)];
        let above = [v(-0.3, 0.9, 1e-12), v(0.4, -0.8, 1e-12), v(0.1, -0.2, 1.0)];
        let rests = |mut corners: [DVec3; 3], by: usize| {
            corners.rotate_left(by);
            MovingTriangle { t0: corners, t1: corners }
        };
        for (i, j) in (0..9).map(|ij| (ij / 3, ij % 3)) {
            let pair = MovingPair::new(&rests(below, i), &rests(above, j));
            let direction = ClosestPoints::at(&pair, 0.0).direction;
            assert!(direction.is_some_and(|dir| dir.gap(0.0) > 0.9e-12), "edges {i} and {j}");
        }
    }

    /// Two points, and two copies of a triangle, are as far apart as they were moved, at every size and time.
    #[test]
    fn distances_are_those_at_the_time() {
        let random = &mut Random(7);
        for case in 0..300 {
            let size = 2.0_f64.powi([-200, 0, 60][case % 3]);
            let mut vector = || random.vector() * size;
            let corners = if case % 2 == 0 { [vector(); 3] } else { [vector(), vector(), vector()] };
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or(DVec3::Z);
            // Of a triangle the distance is that of its plane.
            let way = |by: DVec3| if case % 2 == 0 { by } else { normal * by.x.abs() };
            let [from, to] = [way(vector()), way(vector())];
            let a = MovingTriangle { t0: corners, t1: corners };
            let b = MovingTriangle { t0: corners.map(|p| p + from), t1: corners.map(|p| p + to) };
            for t in [0.0, 0.25, 0.75, 1.0] {
                let found = ClosestPoints::at(&MovingPair::new(&a, &b), t);
                let exact = (from + (to - from) * t).length();
                let message = format!("case {case} at {t}: {} {exact}", found.distance);
                assert!((found.distance - exact).abs() <= 1e-9 * size, "{message}");
                assert!(
                    exact < 1e-3 * size || found.direction.is_some_and(|dir| dir.gap(t) > 0.7 * exact),
                    "{message}"
                );
            }
        }
    }

    /// The widest gap is at least the distance: the direction between the closest points, whose largest component is
    /// 1, is among those that are searched, whichever features are closest.
    #[test]
    fn the_widest_gap_is_no_narrower_than_the_distance() {
        let random = &mut Random(13);
        let mut apart = 0;
        for case in 0..600 {
            let size = 2.0_f64.powi([-300, 0, 60][case % 3]);
            let place = random.vector() * 2.5;
            let mut corners = |by: DVec3| [(); 3].map(|()| (random.vector() + by) * size);
            let (a, b) = (corners(DVec3::ZERO), corners(place));
            let distance = distance_triangle_triangle(&a, &b);
            if distance < 0.01 * size {
                continue;
            }
            apart += 1;
            let [rests_a, rests_b] = [a, b].map(|corners| MovingTriangle { t0: corners, t1: corners });
            let pair = MovingPair::new(&rests_a, &rests_b);
            let gap = find_widest_gap(&pair, 0.5, &pair.at(0.5)).unwrap().gap(0.5);
            let share = gap / distance;
            assert!((1.0 - 1e-9..=3.0_f64.sqrt() + 1e-9).contains(&share), "case {case}: {gap} {distance}");
        }
        assert!(apart > 200, "{apart}");
    }
}
