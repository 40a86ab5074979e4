//! Points and vectors of exact numbers, and the corners of the common points of two triangles.

use std::cmp::Ordering;

use glam::DVec3;
use sscc_testing::Dyadic;

/// A vector, or a point with the coordinates of a `DVec3`.
pub type Vector = [Dyadic; 3];

/// A point as a vector over a positive weight. It is never reduced, because comparisons need only products.
#[derive(Clone, Debug)]
pub struct Point {
    pub vector: Vector,
    pub weight: Dyadic,
}

impl From<&Vector> for Point {
    fn from(vector: &Vector) -> Self {
        Self { vector: vector.clone(), weight: Dyadic::new(1.0) }
    }
}

impl Point {
    /// Returns the mean of two points with these weights, whose sum is not 0.
    pub fn mean(p: &Vector, q: &Vector, weights: [Dyadic; 2]) -> Self {
        let sum = &weights[0] + &weights[1];
        assert!(!sum.is_zero());
        let [at_p, at_q] = if sum.is_negative() { weights.map(|weight| -weight) } else { weights };
        Self { vector: std::array::from_fn(|k| &at_p * &p[k] + &at_q * &q[k]), weight: sum.abs() }
    }

    /// Returns the difference to another point, times both weights.
    pub fn to(&self, other: &Self) -> Vector {
        std::array::from_fn(|k| &other.vector[k] * &self.weight - &self.vector[k] * &other.weight)
    }

    /// Returns the difference from a point of doubles, times the weight.
    fn offset_from(&self, p: &Vector) -> Vector {
        std::array::from_fn(|k| &self.vector[k] - &p[k] * &self.weight)
    }
}

impl Ord for Point {
    fn cmp(&self, other: &Self) -> Ordering {
        let zero = Dyadic::new(0.0);
        let order = |d: Dyadic| zero.cmp(&d);
        self.to(other).map(order).into_iter().find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
    }
}

impl PartialOrd for Point {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Point {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Point {}

pub fn exact(p: DVec3) -> Vector {
    p.to_array().map(Dyadic::new)
}

pub fn minus(u: &Vector, v: &Vector) -> Vector {
    std::array::from_fn(|k| &u[k] - &v[k])
}

pub fn dot(u: &Vector, v: &Vector) -> Dyadic {
    &u[0] * &v[0] + &u[1] * &v[1] + &u[2] * &v[2]
}

pub fn cross(u: &Vector, v: &Vector) -> Vector {
    [1, 2, 0].map(|i| {
        let j = (i + 1) % 3;
        &u[i] * &v[j] - &u[j] * &v[i]
    })
}

pub fn is_zero(v: &Vector) -> bool {
    v.iter().all(Dyadic::is_zero)
}

/// Whether two vectors are multiples of each other and point in opposite directions.
pub fn are_opposite(u: &Vector, v: &Vector) -> bool {
    dot(u, v).is_negative() && [(0, 1), (1, 2), (2, 0)].iter().all(|&(i, j)| &u[i] * &v[j] == &u[j] * &v[i])
}

/// Whether x is in the convex hull of one, two or three points.
pub fn is_in_hull(x: &Point, hull: &[Vector]) -> bool {
    if let [p, q, r] = hull {
        let normal = cross(&minus(q, p), &minus(r, p));
        if !is_zero(&normal) {
            let is_inside = |(s, t): (&Vector, &Vector)| {
                !dot(&normal, &cross(&minus(t, s), &x.offset_from(s))).is_negative()
            };
            return dot(&normal, &x.offset_from(p)).is_zero()
                && [(p, q), (q, r), (r, p)].into_iter().all(is_inside);
        }
    }
    // A hull without area is the union of the hulls of each two points.
    let offsets: Vec<Vector> = hull.iter().map(|p| x.offset_from(p)).collect();
    offsets.iter().any(is_zero) || offsets.iter().any(|u| offsets.iter().any(|v| are_opposite(u, v)))
}

/// Returns all points at which an edge of one triangle can leave or enter the other one: corners, and single common points of
/// two edges, or of an edge and a plane. They include all corners of the common points of the two triangles.
pub fn candidates(a: &[Vector; 3], b: &[Vector; 3]) -> Vec<Point> {
    let mut found: Vec<Point> = a.iter().chain(b).map(Point::from).collect();
    let edges = |t: &[Vector; 3]| [0, 1, 2].map(|i| [t[i].clone(), t[(i + 1) % 3].clone()]);
    for (s, t) in [(a, b), (b, a)] {
        let normal = cross(&minus(&t[1], &t[0]), &minus(&t[2], &t[0]));
        for [p, q] in edges(s) {
            let [at_p, at_q] = [&p, &q].map(|x| dot(&normal, &minus(x, &t[0])));
            if at_p != at_q {
                found.push(Point::mean(&p, &q, [-at_q, at_p]));
            }
        }
    }
    for [p, q] in edges(a) {
        for [r, s] in edges(b) {
            let (along, other, offset) = (minus(&q, &p), minus(&s, &r), minus(&r, &p));
            let normal = cross(&along, &other);
            if !is_zero(&normal) && dot(&normal, &offset).is_zero() {
                // `p + t (q - p)` with `t normal = offset x other`.
                let part = dot(&cross(&offset, &other), &normal);
                found.push(Point::mean(&p, &q, [dot(&normal, &normal) - &part, part]));
            }
        }
    }
    found
}

/// Returns the corners of the set of common points of two triangles, which may be degenerate, in order: those common points
/// that are not between two others.
pub fn common_corners(a: &[Vector; 3], b: &[Vector; 3]) -> Vec<Point> {
    let mut common = candidates(a, b);
    common.retain(|x| is_in_hull(x, a) && is_in_hull(x, b));
    common.sort();
    common.dedup();
    let is_corner = |x: &&Point| {
        let offsets: Vec<Vector> = common.iter().map(|p| x.to(p)).collect();
        !offsets.iter().enumerate().any(|(i, u)| offsets[..i].iter().any(|v| are_opposite(u, v)))
    };
    common.iter().filter(is_corner).cloned().collect()
}
