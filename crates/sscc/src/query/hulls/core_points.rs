//! The core points of a node: a few of its points whose convex hull nearly contains all of them.

use glam::DVec3;

use crate::geometry::nearest_within;
use crate::model::rounding::larger_or_nan;

/// Core points of each hull. With 24, hulls separate fewer node pairs; more points hardly make hulls tighter, and take longer
/// (docs/notes/traversal.md#moving-hulls).
pub(super) const CORE_POINTS: usize = 32;

/// Directions in which the first core points are extreme: to the corners, edge midpoints and face centres of a cube, one
/// of each two opposite directions.
const DIRECTIONS: [[f64; 3]; 13] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 0.0, 1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, 1.0],
    [0.0, 1.0, -1.0],
    [1.0, 1.0, 1.0],
    [1.0, 1.0, -1.0],
    [1.0, -1.0, 1.0],
    [1.0, -1.0, -1.0],
];

/// Points are added until all points are this close to the hull, as a share of the largest norm.
const TOLERANCE: f64 = 0.01;

/// The computation of a distance ends once the distance is at most this.
const CLOSE: f64 = TOLERANCE / 2.0;

/// Rounding of a distance, as a share of the largest norm: differences and sums of 32 products of numbers of at most 2, less
/// than 300 eps. Weights are at least 0, and their sum is 1 up to a few eps.
const ROUNDING: f64 = 1e-12;

/// Core points, and how far any point may be from their hull.
pub(super) struct CorePoints {
    /// Single precision; repeated where there are fewer.
    pub(super) points: [[f32; 3]; CORE_POINTS],
    /// An upper bound of the distance of any point from their hull.
    pub(super) distance: f64,
}

/// Chooses core points among points of norm at most 1, at least one. The hull is that of the rounded points.
pub(super) fn choose(points: &[DVec3]) -> CorePoints {
    let mut chosen: Vec<usize> = Vec::with_capacity(CORE_POINTS);
    let add = |chosen: &mut Vec<usize>, i: usize| {
        if chosen.len() < CORE_POINTS && !chosen.contains(&i) {
            chosen.push(i);
        }
    };
    for dir in DIRECTIONS.map(DVec3::from_array) {
        for dir in [dir, -dir] {
            let farthest =
                |best: usize, i: usize| if points[i].dot(dir) > points[best].dot(dir) { i } else { best };
            add(&mut chosen, (0..points.len()).fold(0, farthest));
        }
    }
    // Distances only fall while points are added, so a point that was close stays so.
    let mut far: Vec<(usize, f64)> = (0..points.len()).map(|i| (i, 0.0)).collect();
    let mut close = 0.0_f64;
    loop {
        let hull = hull_of(points, &chosen);
        far.retain_mut(|(i, distance)| {
            *distance = distance_bound(points[*i], &hull);
            // NaN counts as close: it is no longer improved, and makes the bound NaN.
            let is_far = *distance > TOLERANCE;
            if !is_far {
                close = larger_or_nan(close, *distance);
            }
            is_far
        });
        if far.is_empty() || chosen.len() == CORE_POINTS {
            break;
        }
        // The farthest point, and the farthest one on the other side of it.
        let first = far.iter().fold(far[0], |best, x| if x.1 > best.1 { *x } else { best });
        let apart = |x: &(usize, f64)| x.1 * points[x.0].distance_squared(points[first.0]);
        let second = far.iter().fold(first, |best, x| if apart(x) > apart(&best) { *x } else { best });
        let before = chosen.len();
        [first, second].iter().for_each(|x| add(&mut chosen, x.0));
        if chosen.len() == before {
            break;
        }
    }
    let distance = far.iter().fold(close, |most, x| larger_or_nan(most, x.1)) + ROUNDING;
    let all = hull_of(points, &chosen).map(|d| d.as_vec3().to_array());
    CorePoints { points: all, distance }
}

/// Returns the chosen points in single precision; the first one fills the remaining entries.
fn hull_of(points: &[DVec3], chosen: &[usize]) -> [DVec3; CORE_POINTS] {
    std::array::from_fn(|i| points[*chosen.get(i).unwrap_or(&chosen[0])].as_vec3().as_dvec3())
}

/// Returns an upper bound, up to [`ROUNDING`], of the distance of a point from a hull: its distance from one point of the hull.
fn distance_bound(point: DVec3, hull: &[DVec3; CORE_POINTS]) -> f64 {
    let nearest = nearest_within(&hull.map(|d| d - point), CLOSE);
    let weights = nearest.weights.iter().zip(hull);
    weights.map(|(weight, d)| (*d - point) * *weight).sum::<DVec3>().length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_models::Random;

    /// Each point is within the bound of the hull, seen from many directions, and the bound is small for a smooth
    /// shape.
    #[test]
    fn all_points_are_near_the_hull() {
        let random = &mut Random(3);
        for case in 0..60 {
            let count = [1, 2, 3, 7, 40, 300][case % 6];
            let flat =
                [DVec3::ONE, DVec3::new(1.0, 1.0, 0.0), DVec3::X, DVec3::new(1.0, 1e-9, 1e-4)][case % 4];
            let point = |random: &mut Random| {
                let x = random.vector() * flat;
                x / x.length().max(1.0)
            };
            let points: Vec<DVec3> = (0..count).map(|_| point(random)).collect();
            let CorePoints { points: core, distance } = choose(&points);
            for _ in 0..50 {
                let dir = random.vector().normalize();
                let most =
                    core.iter().map(|d| DVec3::from(d.map(f64::from)).dot(dir)).fold(f64::MIN, f64::max);
                assert!(points.iter().all(|x| x.dot(dir) <= most + distance), "case {case}");
            }
            assert!(
                distance < if count <= CORE_POINTS { 1.1 * TOLERANCE } else { 0.35 },
                "case {case}: {distance}"
            );
        }
    }

    /// As many points as a hull has core points, none of which is near the hull of the others, are all core points.
    #[test]
    fn few_points_are_their_own_hull() {
        assert_eq!(choose(&[DVec3::X]).distance, ROUNDING);
        // Points on a spiral around a sphere, in single precision.
        let count = CORE_POINTS as f64;
        let at = |i: usize| {
            let height = 1.0 - (2.0 * i as f64 + 1.0) / count;
            let (sin, cos) = (2.4 * i as f64).sin_cos();
            let x = DVec3::new(cos, sin, 0.0) * (1.0 - height * height).sqrt() + DVec3::Z * height;
            (x * 0.999).as_vec3().as_dvec3()
        };
        let points: Vec<DVec3> = (0..CORE_POINTS).map(at).collect();
        assert_eq!(choose(&points).distance, ROUNDING);
    }
}
