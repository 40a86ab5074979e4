//! A plane between two sets of points: the test of one plane, and the search for the plane with the widest gap by the
//! algorithm of Gilbert, Johnson and Keerthi (GJK, 1988).
//!
//! Whatever plane is tried, two sets are apart only where the test says so. The error of the test is part of the radii
//! ([`HullMotion::error`](super::hull_motion::HullMotion)).

use std::ops::Range;

use glam::{DVec3, Vec3, Vec4};

use super::core_points::CORE_POINTS;
use crate::geometry::nearest_to_origin;

/// The coordinates of core points along each axis.
pub(super) type Points = [[f32; CORE_POINTS]; 3];

/// An affine map: for each axis the row of the matrix, then the component of the shift.
pub(super) type AffineMap = [Vec4; 3];

/// Points that are moved by an affine map at each of one or two configurations.
pub(super) struct MovedPoints<'t, const E: usize> {
    pub(super) points: &'t Points,
    pub(super) maps: &'t [AffineMap; E],
}

impl<const E: usize> MovedPoints<'_, E> {
    /// The largest coordinate of any moved point along a direction. No point is moved: the transposed map turns the
    /// direction back, at the cost of moving one point.
    #[inline(always)]
    pub(super) fn extent(&self, dir: Vec3) -> f32 {
        let [first, others @ ..] = right_or!(&self.maps[..], HullsAtStart, &self.maps[..1]) else {
            return f32::INFINITY;
        };
        let of_map = |map: &AffineMap| {
            let turned = turned_back(map, dir);
            extent(self.points, turned.truncate()) + turned.w
        };
        others.iter().fold(of_map(first), |most, map| most.max(of_map(map)))
    }

    /// A point, moved by the first map.
    pub(super) fn point(&self, i: usize) -> Vec3 {
        let point = Vec3::from_array(self.points.each_ref().map(|axis| axis[i])).extend(1.0);
        Vec3::from_array(self.maps[0].map(|row| row.dot(point)))
    }

    /// The moved point that is farthest along a direction at the first configuration.
    fn support(&self, dir: Vec3) -> Vec3 {
        let dir = turned_back(&self.maps[0], dir).truncate();
        let extent = extent(self.points, dir);
        let [x, y, z] = self.points;
        let along = |i: usize| x[i] * dir.x + y[i] * dir.y + z[i] * dir.z;
        self.point((0..CORE_POINTS).find(|i| along(*i) == extent).unwrap_or(0))
    }
}

/// The product of a direction with the transposed matrix of a map, then the shift along the direction.
#[inline(always)]
fn turned_back(map: &AffineMap, dir: Vec3) -> Vec4 {
    map[0] * dir.x + map[1] * dir.y + map[2] * dir.z
}

/// Points compared side by side.
const LANES: usize = 8;

/// Covers the rounding of the test: squares, products, a sum, a difference.
const ROUND_UP: f32 = 1.0 + 1e-5;

/// The squares of lengths of normals that are tested.
const SQUARES: Range<f32> = 1e-6..1e18;

/// Steps of a search, and the share of the distance at which it ends.
const STEPS: usize = 32;
const TOLERANCE: f32 = 1e-3;

/// Whether a plane of this normal separates two sets of points by more than `distance`, the first one below.
///
/// The gap along the normal is compared with the distance times the normal's length, both squared. Squares are within the
/// range of numbers: coordinates are below 1e5 and distances above 1e-15, by the bound of their errors
/// ([`HullMotion::error`](super::hull_motion::HullMotion)).
#[inline(always)]
pub(super) fn are_separated<const E: usize>(
    a: &MovedPoints<'_, E>,
    b: &MovedPoints<'_, E>,
    distance: f32,
    normal: Vec3,
) -> bool {
    let square = normal.length_squared();
    // NaN is in no range, and fails the other tests, too.
    if !SQUARES.contains(&square) {
        return false;
    }
    let gap = -b.extent(-normal) - a.extent(normal);
    let is_wide = gap * gap > distance * distance * square * ROUND_UP;
    gap > 0.0 && right_or!(is_wide, HullsTouch, true)
}

/// The unit normal of the plane with the widest gap between two sets of points, and the gap; none where it is 0.
pub(super) fn widest_gap(a: &MovedPoints<'_, 1>, b: &MovedPoints<'_, 1>) -> Option<(Vec3, f32)> {
    let middle = |points: &MovedPoints<'_, 1>| (0..CORE_POINTS).map(|i| points.point(i)).sum::<Vec3>();
    let mut normal = unit(middle(b) - middle(a)).unwrap_or(Vec3::X);
    let mut best = None;
    let mut simplex: Vec<DVec3> = Vec::with_capacity(4);
    for _ in 0..STEPS {
        let gap = -b.extent(-normal) - a.extent(normal);
        if gap > best.map_or(0.0, |(_, gap)| gap) {
            best = Some((normal, gap));
        }
        if simplex.len() == 4 {
            break;
        }
        simplex.push((b.support(-normal) - a.support(normal)).as_dvec3());
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
#[inline(always)]
fn extent(points: &Points, dir: Vec3) -> f32 {
    let mut lanes = [f32::NEG_INFINITY; LANES];
    let [x, y, z] = points.each_ref().map(|axis| axis.as_chunks::<LANES>().0);
    for ((x, y), z) in x.iter().zip(y).zip(z) {
        for i in 0..LANES {
            let along = x[i] * dir.x + y[i] * dir.y + z[i] * dir.z;
            // Without the exact rule for NaN this is one instruction.
            lanes[i] = if along > lanes[i] { along } else { lanes[i] };
        }
    }
    let [a, b, c, d, e, f, g, h] = lanes;
    let max = |a: f32, b: f32| if a > b { a } else { b };
    max(max(max(a, b), max(c, d)), max(max(e, f), max(g, h)))
}
