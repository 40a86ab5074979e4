//! A plane between two sets of points: the test of one plane, and the search for the plane with the widest gap by the
//! algorithm of Gilbert, Johnson and Keerthi (GJK, 1988).
//!
//! The search may propose any plane: two sets count as separated only if the test of the plane succeeds. The error of the test is
//! part of the radii ([`HullMotion::error`](super::hull_motion::HullMotion)).

use std::ops::Range;

use glam::{DVec3, Vec3, Vec4};

use super::core_points::CORE_POINTS;
use crate::geometry::nearest_to_origin;
use crate::vectors::{Baseline, Kernel, LANES, Vectors};

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
    /// Returns the largest coordinate of any moved point along a direction. No point is moved: the transposed map is applied to
    /// the direction, at the cost of moving one point.
    #[inline(always)]
    pub(super) fn extent<V: Vectors>(&self, vectors: V, dir: Vec3) -> f32 {
        let mut most = f32::NEG_INFINITY;
        for map in with_mutant!(&self.maps[..], HullsAtStart, &self.maps[..1]) {
            most = most.max(extent(vectors, self.points, turned_back(map, dir)));
        }
        most
    }

    /// Returns a point, moved by the first map.
    pub(super) fn point(&self, i: usize) -> Vec3 {
        let point = Vec3::from_array(self.points.each_ref().map(|axis| axis[i])).extend(1.0);
        Vec3::from_array(self.maps[0].map(|row| row.dot(point)))
    }

    /// Returns the moved point that is farthest along a direction at the first configuration.
    fn support(&self, dir: Vec3) -> Vec3 {
        let dir = turned_back(&self.maps[0], dir);
        let extent = extent(Baseline, self.points, dir);
        let [x, y, z] = self.points;
        let along = |i: usize| x[i] * dir.x + dir.w + y[i] * dir.y + z[i] * dir.z;
        self.point((0..CORE_POINTS).find(|i| along(*i) == extent).unwrap_or(0))
    }
}

/// Returns the product of a direction with the transposed matrix of a map, then the shift along the direction.
#[inline(always)]
fn turned_back(map: &AffineMap, dir: Vec3) -> Vec4 {
    map[0] * dir.x + map[1] * dir.y + map[2] * dir.z
}

/// Returns the largest coordinate of any point along a direction, plus the shift. It has no closures, because they would not be
/// compiled for the instruction set of the vectors.
#[inline(always)]
fn extent<V: Vectors>(v: V, [x, y, z]: &Points, turned: Vec4) -> f32 {
    let (dir_x, dir_y, dir_z) = (v.splat(turned.x), v.splat(turned.y), v.splat(turned.z));
    let (shift, mut most) = (v.splat(turned.w), v.splat(f32::NEG_INFINITY));
    for ((x, y), z) in x.as_chunks().0.iter().zip(y.as_chunks().0).zip(z.as_chunks().0) {
        let sum = v.multiply_add(v.load(x), dir_x, shift);
        let sum = v.multiply_add(v.load(y), dir_y, sum);
        most = v.max(v.multiply_add(v.load(z), dir_z, sum), most);
    }
    let [a, b, c, d, e, f, g, h] = v.array(most);
    a.max(b).max(c.max(d)).max(e.max(f).max(g.max(h)))
}

/// Covers the rounding of the test: squares, the squared length and products add at most 8 u, which is 5e-7. The rounding of the
/// sum of radii is covered by the last factor in `MovedHulls::update`, that of the gap by the error in the radii.
const ROUND_UP: f32 = 1.0 + 1e-5;

const _: () = assert!(CORE_POINTS.is_multiple_of(LANES));

/// The range of squared lengths of normals: others are not tested.
const SQUARES: Range<f32> = 1e-6..1e18;

/// The largest number of steps of a search.
const STEPS: usize = 32;

/// A search ends if the distance exceeds the gap by at most this share of the distance.
const TOLERANCE: f32 = 1e-3;

/// Tests whether a plane separates two sets of points by more than a distance, with the first set below the plane.
///
/// The gap along the normal is compared with the distance times the normal's length, both squared. Squares are within the
/// range of numbers: coordinates are below 1e4 and distances above 1e-15, by the bound of their errors
/// ([`HullMotion::error`](super::hull_motion::HullMotion)).
pub(super) struct PlaneTest<'t, const E: usize> {
    pub(super) points: [MovedPoints<'t, E>; 2],
    pub(super) distance: f32,
    /// The normal of the plane, of any length.
    pub(super) normal: Vec3,
}

impl<const E: usize> Kernel for PlaneTest<'_, E> {
    type Output = bool;

    #[inline(always)]
    fn run<V: Vectors>(self, vectors: V) -> bool {
        let Self { points: [a, b], distance, normal } = self;
        let square = normal.length_squared();
        // NaN and infinity fail this test or one of the gap.
        if !with_mutant!(SQUARES.contains(&square), HullNormalOfAnyLength, square > 0.0) {
            return false;
        }
        let gap = -b.extent(vectors, -normal) - a.extent(vectors, normal);
        let reached = distance * distance * with_mutant!(square, HullNormalTakenAsUnit, 1.0);
        let is_wide = gap * gap > reached * with_mutant!(ROUND_UP, HullGapToNearest, 1.0);
        gap > 0.0 && gap.is_finite() && with_mutant!(is_wide, HullsTouch, true)
    }
}

/// Returns the unit normal of the plane with nearly the widest gap between two sets of points, and the gap; `None` if
/// no plane with a gap was found.
pub(super) fn widest_gap(a: &MovedPoints<'_, 1>, b: &MovedPoints<'_, 1>) -> Option<(Vec3, f32)> {
    let middle = |points: &MovedPoints<'_, 1>| (0..CORE_POINTS).map(|i| points.point(i)).sum::<Vec3>();
    let mut normal = unit(middle(b) - middle(a)).unwrap_or(Vec3::X);
    let mut best = None;
    let mut simplex: Vec<DVec3> = Vec::with_capacity(4);
    for _ in 0..STEPS {
        let gap = -b.extent(Baseline, -normal) - a.extent(Baseline, normal);
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

/// Returns the direction at unit length; `None` if the result is not finite.
#[inline]
fn unit(dir: Vec3) -> Option<Vec3> {
    let dir = (dir / dir.abs().max_element()).normalize();
    dir.is_finite().then_some(dir)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The largest component is divided out first, so no square underflows or overflows.
    #[test]
    fn directions_of_any_length_have_a_unit_vector() {
        for length in [1e-37, 1e-20, 1.0, 1e20, 1e37] {
            let dir = unit(Vec3::new(0.6, 0.0, -0.8) * length).unwrap();
            assert!(dir.abs_diff_eq(Vec3::new(0.6, 0.0, -0.8), 1e-6), "{length}: {dir}");
        }
        assert!(unit(Vec3::ZERO).is_none() && unit(Vec3::NAN).is_none());
    }
}
