//! The time of impact of two moving triangles.

use glam::DVec3;

use super::candidate_direction::MovingPair;
use super::conservative_advancement::advance;
use super::moving_triangle::MovingTriangle;
use super::number::power_of_two;
use crate::geometry::{TwoTriangles, intersect_triangle_triangle};
use crate::limits;

/// Returns the time of impact of two triangles whose corners move linearly. None proves that they have no point in common at any
/// t in [0, 1]. Otherwise the result is a time t with two guarantees:
/// - t is never later than the true time of impact.
/// - At t, their distance is at most `tolerance` times their size, up to 4e-15 of their size for rounding, unless the
///   limit of steps (below) ended the search. Tolerances below 6e-14 count as 6e-14. The size is the largest
///   difference, at either end and in any coordinate, of a corner from the first one of a.
///
/// Triangles are closed hulls of their corners, in any order, degenerate ones included. Touching counts as contact, and
/// so do contacts at t = 0 and t = 1. Both guarantees hold for every size of triangles, down to the smallest denormal
/// numbers. Memory and time are bounded: conservative advancement ends after at most about 10,000 steps (usually one or
/// two). If it reaches this limit, it returns the time reached, which is not later than the first contact, but at which
/// the distance may exceed the tolerance.
///
/// Coordinates must be finite and at most [`limits::LARGEST`] in magnitude (checked in debug builds only;
/// beyond, the answer may be wrong).
///
/// ```
/// use glam::DVec3;
/// use sscc::{MovingTriangle, impact_triangle_triangle};
///
/// let floor = [DVec3::ZERO, DVec3::X, DVec3::Y];
/// let above = floor.map(|p| p + DVec3::Z);
/// let resting = MovingTriangle { t0: floor, t1: floor };
/// let falling = |depth: f64| MovingTriangle { t0: above, t1: above.map(|p| p - DVec3::Z * depth) };
/// let t = impact_triangle_triangle(&resting, &falling(2.0), 1e-9).expect("a contact");
/// assert!(t <= 0.5 && t > 0.5 - 1e-9);
/// assert_eq!(impact_triangle_triangle(&resting, &falling(0.999), 1e-9), None);
/// ```
pub fn impact_triangle_triangle(a: &MovingTriangle, b: &MovingTriangle, tolerance: f64) -> Option<f64> {
    debug_assert!(
        [a, b].iter().all(|triangle| triangle.t0.iter().chain(&triangle.t1).all(|p| limits::contains(*p))),
        "corner out of range: {a:?} {b:?}"
    );
    let pair = MovingPair::new(a, b);
    if is_separated_by_planes(&pair) {
        None
    } else if intersect_triangle_triangle(&a.t0, &b.t0) {
        Some(0.0)
    } else if pair.size() < with_mutant!(MIN_SIZE, SmallPairsNotEnlarged, 0.0) {
        let [a, b] = [a, b].map(|triangle| triangle.scaled(enlargement(pair.size())));
        advance(&a, &b, &MovingPair::new(&a, &b), tolerance)
    } else {
        advance(a, b, &pair, tolerance)
    }
}

/// Pairs smaller than this (2^-100) are scaled by a power of two, which is exact: the rounding bound of
/// gaps contains a constant for underflow, which must be negligible beside the tolerance, and products of up to eight
/// lengths must not underflow.
const MIN_SIZE: f64 = f64::from_bits((1023 - 100) << 52);

/// Returns the power of two that scales a small size to about 1. It is at most 2^800, because all corners may share a
/// large coordinate (up to 2^200), which must not overflow.
fn enlargement(size: f64) -> f64 {
    let exponent = (size.to_bits() >> 52) as i64 - 1023;
    power_of_two((-exponent).min(800))
}

/// Returns the time of impact of a moving vertex and a moving face, like [`impact_triangle_triangle`].
pub fn impact_vertex_face(vertex: [DVec3; 2], face: &MovingTriangle, tolerance: f64) -> Option<f64> {
    impact_triangle_triangle(&MovingTriangle::vertex(vertex[0], vertex[1]), face, tolerance)
}

/// Returns the time of impact of two moving edges, each given by its ends at times 0 and 1, like [`impact_triangle_triangle`].
pub fn impact_edge_edge(a: [[DVec3; 2]; 2], b: [[DVec3; 2]; 2], tolerance: f64) -> Option<f64> {
    let [a, b] = [a, b].map(|[e_t0, e_t1]| MovingTriangle::edge(e_t0, e_t1));
    impact_triangle_triangle(&a, &b, tolerance)
}

/// Whether the normal of one of the triangles at t = 0.5 separates the two from t = 0 to 1. This decides most pairs.
pub(super) fn is_separated_by_planes(pair: &MovingPair) -> bool {
    let TwoTriangles { a, b } = pair.at(0.5);
    [a, b].into_iter().any(|[p, q, r]| {
        let normal = pair.along((q - p).cross(r - p));
        normal.is_some_and(|dir| dir.separates() || dir.reversed().separates())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A triangle stands on its tip, just above or below a large one whose plane it does not reach: only the normal of
    /// the large one separates them.
    #[test]
    fn planes_of_either_triangle_separate_either_side() {
        let v = DVec3::new;
        let large = [v(-4.0, -3.0, 0.0), v(5.0, -3.0, 0.0), v(0.0, 6.0, 0.0)];
        let standing = [v(0.0, 0.0, 0.1), v(1.0, 0.2, 1.0), v(-1.0, -0.2, 1.2)];
        let moving = |t0: [DVec3; 3]| MovingTriangle { t0, t1: t0.map(|p| p + v(3.0, 2.0, 1.0)) };
        for (drop, separated) in [(0.0, true), (0.2, false)] {
            let standing = standing.map(|p| p - DVec3::Z * drop);
            for other in [standing, standing.map(|p| v(p.x, p.y, -p.z))] {
                for (a, b) in [(large, other), (other, large)] {
                    let found = is_separated_by_planes(&MovingPair::new(&moving(a), &moving(b)));
                    assert_eq!(found, separated, "{a:?} {b:?}");
                }
            }
        }
    }

    #[test]
    fn a_vertex_meets_a_face_and_passes_beside_it() {
        let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let face = MovingTriangle { t0: corners, t1: corners.map(|p| p + DVec3::Z) };
        let falling = |x: f64, to: f64| [DVec3::new(x, 0.25, 2.0), DVec3::new(x, 0.25, to)];
        let t = impact_vertex_face(falling(0.25, 0.0), &face, 1e-9).unwrap();
        assert!(t <= 2.0 / 3.0 && t > 2.0 / 3.0 - 1e-8, "{t}");
        assert_eq!(impact_vertex_face(falling(0.25, 1.001), &face, 1e-9), None);
        assert_eq!(impact_vertex_face(falling(0.8, 0.0), &face, 1e-9), None);
    }

    /// A point falls on a face, or passes from above it to beside it and below its plane, at sizes down to denormal
    /// numbers. Coordinates are exact at all sizes.
    #[test]
    fn times_of_impact_are_the_same_at_every_size() {
        for exponent in [-1060, -1040, -500, -101, -99, 0, 190] {
            let scaled = |x: f64, y: f64, z: f64| {
                DVec3::new(x, y, z) * 2.0_f64.powi(exponent / 2) * 2.0_f64.powi(exponent - exponent / 2)
            };
            let corners = [DVec3::ZERO, scaled(1.0, 0.0, 0.0), scaled(0.0, 1.0, 0.0)];
            let face = MovingTriangle { t0: corners, t1: corners };
            let from = scaled(0.375, 0.375, 0.125);
            let t = impact_vertex_face([from, scaled(0.375, 0.375, -0.125)], &face, 1e-9).unwrap();
            assert!(t <= 0.5 && t > 0.5 - 1e-7, "{t} at 2^{exponent}");
            let beside = impact_vertex_face([from, scaled(3.0, 3.0, -1.0)], &face, 1e-9);
            assert_eq!(beside, None, "2^{exponent}");
        }
    }
}
