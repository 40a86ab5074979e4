//! When two moving triangles first meet.

use glam::DVec3;

use super::MovingTriangle;
use super::closest::Closest;
use super::separation::Separation;
use crate::{intersect_triangle_triangle, limits};

/// Intervals of time tried at the most; what is free until then is proven, the rest counts as contact. Of the published
/// queries that planes do not settle, at tolerances from 0 to 1e-3, three in four take one or two, the longest 83; of the
/// first 70,000 in `tests/continuous.rs`, most of them motions as large as the triangles, 368 took all.
const STEPS: usize = 512;

/// Steps shorter than this are beyond what t can tell.
const SHORTEST: f64 = f64::EPSILON / 16.0;

/// The time of impact of two triangles whose corners move linearly: none if they provably have no point in
/// common at any time t in [0, 1]; else a time t such that
/// - they have none before: t is never later than the true time of impact, and
/// - at t they are at most `tolerance` times their size apart, or too close for `f64` to tell them apart: about
///   1e-13 of their size. That is the largest difference, at either end and in any coordinate, of a corner from
///   the first one of x.
///
/// Triangles are closed hulls of their corners, in any order, degenerate ones included; touching counts, also
/// throughout, and so does whatever meets at an end. Time and memory are bounded for any input: should 512 steps not
/// be enough, the answer is the time until which they were.
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
pub fn impact_triangle_triangle(x: &MovingTriangle, y: &MovingTriangle, tolerance: f64) -> Option<f64> {
    debug_assert!(
        [x, y].iter().all(|m| m.t0.iter().chain(&m.t1).all(|p| limits::contains(*p))),
        "corner out of range: {x:?} {y:?}"
    );
    let pair = Separation::new(x, y);
    if planes_separate(&pair) {
        None
    } else if intersect_triangle_triangle(&x.t0, &y.t0) {
        Some(0.0)
    } else {
        advance(&pair, tolerance * pair.size())
    }
}

/// The time of impact of a moving vertex and a moving face: as [`impact_triangle_triangle`].
pub fn impact_vertex_face(vertex: [DVec3; 2], face: &MovingTriangle, tolerance: f64) -> Option<f64> {
    impact_triangle_triangle(&MovingTriangle::vertex(vertex[0], vertex[1]), face, tolerance)
}

/// The time of impact of two moving edges, each given by its ends at times 0 and 1: as [`impact_triangle_triangle`].
pub fn impact_edge_edge(a: [[DVec3; 2]; 2], b: [[DVec3; 2]; 2], tolerance: f64) -> Option<f64> {
    let [a, b] = [a, b].map(|[e_t0, e_t1]| MovingTriangle::edge(e_t0, e_t1));
    impact_triangle_triangle(&a, &b, tolerance)
}

/// Whether one of the planes, as they are half way, separates the two all the time: settles most pairs.
fn planes_separate(pair: &Separation) -> bool {
    let (x, y) = pair.at(0.5);
    [x, y].into_iter().any(|[a, b, c]| {
        let along = pair.along((b - a).cross(c - a));
        along.is_some_and(|n| n.separates() || n.reversed().separates())
    })
}

/// Conservative advancement from t = 0: each step is proven free by a direction, fixed or turning.
///
/// Towards a contact the fixed direction of the closest points converges as Newton's method does; along a narrow
/// gap that turns only the turning one makes headway, which is tried where the fixed one does not bring them much closer.
fn advance(pair: &Separation, tolerance: f64) -> Option<f64> {
    let (mut t, mut step) = (0.0, 1.0);
    let mut here = Closest::at(pair, t);
    let mut converges = true;
    for _ in 0..STEPS {
        let direction = match here {
            Closest { distance, direction: Some(direction) } if distance > tolerance => direction,
            _ => return Some(t),
        };
        let until = direction.separates_until(t);
        if until >= 1.0 {
            return None;
        }
        if !converges {
            let next = f64::min(t + step, 1.0);
            if next > t {
                let there = Closest::at(pair, next);
                if there.direction.is_some_and(|to| direction.separates_turning(t, &to, next)) {
                    if next >= 1.0 {
                        return None;
                    }
                    (t, here) = (next, there);
                    step *= 2.0;
                    continue;
                }
            }
            step *= 0.5;
            if until > t {
                step = step.min(AHEAD * (until - t));
            }
            if step < SHORTEST {
                break;
            }
        }
        converges = false;
        if until > t {
            t = until;
            let distance = here.distance;
            here = Closest::at(pair, t);
            converges = here.distance < CONVERGES * distance;
        }
    }
    Some(t)
}

/// Where the turning direction fails, it is tried next for this many times what the fixed one gained.
const AHEAD: f64 = 4.0;

/// The fixed direction converges while each step leaves less than this share of the distance. Trying a turning one at
/// each step, too, a query of the dragon at 10% evaluated 1.7 times as many closest points.
const CONVERGES: f64 = 0.25;
