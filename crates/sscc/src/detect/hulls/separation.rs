//! A plane between two sets of points: the test of one plane, and the search for the plane with the widest gap by the
//! algorithm of Gilbert, Johnson and Keerthi (GJK, 1988).
//!
//! Whatever plane is tried, two sets are apart only where the test says so. The error of the test is part of the radii
//! ([`HullMotion::error`](super::hull_motion::HullMotion)).

use glam::{DVec3, Vec3};

use super::core_points::CORE_POINTS;
use crate::geometry::nearest_to_origin;

/// The coordinates of core points along each axis.
pub(super) type Points = [[f32; CORE_POINTS]; 3];

/// Points compared side by side.
const LANES: usize = 8;

/// Covers the rounding of the test: a length, a sum, a product, a difference.
const ROUND_UP: f32 = 1.0 + 1e-5;

/// Steps of a search, and the share of the distance at which it ends.
const STEPS: usize = 32;
const TOLERANCE: f32 = 1e-3;

/// Whether a plane of this normal separates two sets of points by more than `distance`, the first one below. The points
/// of a set are at one configuration or at two.
#[inline]
pub(super) fn are_separated<const E: usize>(
    a: &[Points; E],
    b: &[Points; E],
    distance: f32,
    normal: Vec3,
) -> bool {
    let Some(normal) = unit(normal) else { return false };
    let gap = -extent(b, -normal) - extent(a, normal);
    right_or!(gap > distance * ROUND_UP, HullsTouch, gap > 0.0)
}

/// The unit normal of the plane with the widest gap between two sets of points, and the gap; none where it is 0.
pub(super) fn widest_gap(a: &Points, b: &Points) -> Option<(Vec3, f32)> {
    let middle = |points: &Points| Vec3::from_array(points.map(|axis| axis.iter().sum()));
    let mut normal = unit(middle(b) - middle(a)).unwrap_or(Vec3::X);
    let mut best = None;
    let mut simplex: Vec<DVec3> = Vec::with_capacity(4);
    for _ in 0..STEPS {
        let (from, to) = (extent(&[*a], normal), extent(&[*b], -normal));
        let gap = -to - from;
        if gap > best.map_or(0.0, |(_, gap)| gap) {
            best = Some((normal, gap));
        }
        if simplex.len() == 4 {
            break;
        }
        simplex.push((support(b, -normal, to) - support(a, normal, from)).as_dvec3());
        let corners: [_; 4] = std::array::from_fn(|i| *simplex.get(i).unwrap_or(&simplex[0]));
        let nearest = nearest_to_origin(&corners);
        let mut weights = nearest.weights.iter();
        simplex.retain(|_| weights.next().is_some_and(|weight| *weight > 0.0));
        let distance = nearest.point.length() as f32;
        let Some(next) = unit(nearest.point.as_vec3()).filter(|_| distance - gap > TOLERANCE * distance)
        else {
            break;
        };
        normal = next;
    }
    best
}

/// The direction at unit length; none where that is no number.
#[inline]
fn unit(dir: Vec3) -> Option<Vec3> {
    let dir = (dir / dir.abs().max_element()).normalize();
    dir.is_finite().then_some(dir)
}

/// The largest coordinate of any point along a direction.
#[inline]
fn extent<const E: usize>(points: &[Points; E], dir: Vec3) -> f32 {
    let mut lanes = [f32::NEG_INFINITY; LANES];
    for points in right_or!(&points[..], HullsAtStart, &points[..1]) {
        let [x, y, z] = points.each_ref().map(|axis| axis.as_chunks::<LANES>().0);
        for ((x, y), z) in x.iter().zip(y).zip(z) {
            for i in 0..LANES {
                let along = x[i] * dir.x + y[i] * dir.y + z[i] * dir.z;
                // Without the exact rule for NaN this is one instruction.
                lanes[i] = if along > lanes[i] { along } else { lanes[i] };
            }
        }
    }
    let [a, b, c, d, e, f, g, h] = lanes;
    let max = |a: f32, b: f32| if a > b { a } else { b };
    max(max(max(a, b), max(c, d)), max(max(e, f), max(g, h)))
}

/// A point whose coordinate along a direction is this one.
fn support(points: &Points, dir: Vec3, extent: f32) -> Vec3 {
    let at = |i: usize| Vec3::from_array(points.each_ref().map(|axis| axis[i]));
    let along = |i: usize| points[0][i] * dir.x + points[1][i] * dir.y + points[2][i] * dir.z;
    at((0..CORE_POINTS).find(|i| along(*i) == extent).unwrap_or(0))
}
