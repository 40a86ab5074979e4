//! Exact distance of two moving triangles at one time.

use glam::DVec3;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};
use sscc::MovingTriangle;

use crate::grid::Grid;
use crate::partition::Minors;
use crate::polynomial::Root;

/// A point or a vector, in integer multiples of a power of two.
type Vector = [BigInt; 3];

/// A squared distance as numerator and positive denominator. Unlike a rational number it is not reduced, which is slow.
type Fraction = (BigInt, BigInt);

/// Returns the exact squared distance of two moving triangles at time `t`; 0 if they have a common point.
///
/// # Panics
/// When a corner or `t` is not finite.
pub fn squared_distance(x: &MovingTriangle, y: &MovingTriangle, t: f64) -> BigRational {
    let time = BigRational::from_float(t).expect("times are finite");
    if Minors::new(x, y).meet_at(&Root::at(time), 5) {
        return BigRational::zero();
    }
    let ends = [x.t0, x.t1, y.t0, y.t1];
    let (grid, times) = (Grid::of(ends.as_flattened()), Grid::of(&[DVec3::new(t, 1.0, 0.0)]));
    let at = |triangle: &MovingTriangle| triangle_at(triangle, [grid, times], t);
    let (x, y) = (at(x), at(y));
    let mut minimum: Option<Fraction> = None;
    let mut consider = |squared: Option<Fraction>| {
        if let Some(squared) = squared
            && minimum.as_ref().is_none_or(|minimum| &squared.0 * &minimum.1 < &minimum.0 * &squared.1)
        {
            minimum = Some(squared);
        }
    };
    // One of these pairs of features contains the closest points of disjoint triangles.
    for i in 0..3 {
        consider(vertex_face(&x[i], &y));
        consider(vertex_face(&y[i], &x));
        for j in 0..3 {
            consider(Some((dot(&minus(&x[i], &y[j]), &minus(&x[i], &y[j])), BigInt::one())));
            let edges = [[&x[i], &x[(i + 1) % 3]], [&y[j], &y[(j + 1) % 3]]];
            consider(vertex_edge(&x[i], edges[1]));
            consider(vertex_edge(&y[j], edges[0]));
            consider(edge_edge(edges));
        }
    }
    let (numerator, denominator) = minimum.expect("vertices have a distance");
    let exponent = 2 * (grid.exponent() + times.exponent());
    BigRational::new(numerator << exponent.max(0), denominator << (-exponent).max(0))
}

/// Returns the distance of two moving triangles at time `t`, rounded from the exact square.
pub fn distance(x: &MovingTriangle, y: &MovingTriangle, t: f64) -> f64 {
    let squared = squared_distance(x, y, t);
    // The square of a small number may underflow in f64, so it is first multiplied by a power of four.
    let halvings = squared.denom().bits().saturating_sub(squared.numer().bits()).div_ceil(2);
    let scaled = squared * BigRational::from_integer(BigInt::one() << (2 * halvings));
    let root = scaled.to_f64().expect("a rational number has a double near it").sqrt();
    (0..halvings).fold(root, |root, _| root / 2.0)
}

/// Returns the squared distance to the plane of a face, if the foot of the perpendicular lies within the face.
fn vertex_face(p: &Vector, [a, b, c]: &[Vector; 3]) -> Option<Fraction> {
    let n = cross(&minus(b, a), &minus(c, a));
    let squared = dot(&n, &n);
    if squared.is_zero() {
        return None;
    }
    let inside = [[a, b], [b, c], [c, a]]
        .iter()
        .all(|[from, to]| !dot(&cross(&minus(to, from), &minus(p, from)), &n).is_negative());
    let height = dot(&n, &minus(p, a));
    inside.then(|| (&height * &height, squared))
}

/// Returns the squared distance to the line of an edge, if the foot of the perpendicular lies within the edge.
fn vertex_edge(p: &Vector, [a, b]: [&Vector; 2]) -> Option<Fraction> {
    let (e, d) = (minus(b, a), minus(p, a));
    let (squared, along) = (dot(&e, &e), dot(&e, &d));
    let inside = !squared.is_zero() && !along.is_negative() && along <= squared;
    inside.then(|| (dot(&d, &d) * &squared - &along * &along, squared))
}

/// Returns the squared distance of the lines of two edges, if their closest points lie within both.
fn edge_edge([[a, b], [c, d]]: [[&Vector; 2]; 2]) -> Option<Fraction> {
    let (e, f, r) = (minus(b, a), minus(d, c), minus(c, a));
    let n = cross(&e, &f);
    let squared = dot(&n, &n);
    if squared.is_zero() {
        return None;
    }
    let inside =
        [dot(&cross(&r, &f), &n), dot(&cross(&r, &e), &n)].iter().all(|s| !s.is_negative() && *s <= squared);
    let height = dot(&n, &r);
    inside.then(|| (&height * &height, squared))
}

/// Returns the corners at time `t`, in multiples of the product of both grids' powers of two.
fn triangle_at(triangle: &MovingTriangle, [grid, times]: [Grid; 2], t: f64) -> [Vector; 3] {
    let (t, one) = (times.whole(t), times.whole(1.0));
    std::array::from_fn(|i| {
        let (p, q) = (triangle.t0[i], triangle.t1[i]);
        std::array::from_fn(|k| {
            let (p, q) = (grid.whole(p[k]), grid.whole(q[k]));
            let change = q - &p;
            p * &one + change * &t
        })
    })
}

fn minus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|k| &a[k] - &b[k])
}

fn dot(a: &Vector, b: &Vector) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    let minor = |i: usize, j: usize| &a[i] * &b[j] - &a[j] * &b[i];
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_of_simple_pairs() {
        let face = [DVec3::ZERO, DVec3::X, DVec3::Y];
        let still = |t0: [DVec3; 3]| MovingTriangle { t0, t1: t0 };
        let of = |other: [DVec3; 3]| distance(&still(face), &still(other), 0.5);
        assert_eq!(of(face.map(|p| p + DVec3::Z * 1e-200)), 1e-200);
        assert_eq!(of(face.map(|p| p + DVec3::new(3.0, 0.0, 0.0))), 2.0);
        assert_eq!(of(face.map(|p| p + DVec3::new(4.0, 0.0, 4.0))), 5.0);
        assert_eq!(of(face.map(|p| p + DVec3::new(0.25, 0.25, 0.0))), 0.0);
        // Two crossing edges at a distance, and an edge that pierces the face.
        let [a, b] = [DVec3::new(0.2, -0.5, 3.0), DVec3::new(0.2, 0.5, 3.0)];
        assert_eq!(of([a, b, a + DVec3::Z]), 3.0);
        assert_eq!(
            of([DVec3::new(0.2, 0.2, -1.0), DVec3::new(0.2, 0.2, 1.0), DVec3::new(5.0, 5.0, 1.0)]),
            0.0
        );
        let falling = MovingTriangle { t0: face.map(|p| p + DVec3::Z), t1: face };
        assert_eq!(distance(&still(face), &falling, 0.25), 0.75);
    }
}
