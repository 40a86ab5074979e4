//! Vectors of rational numbers, and the common points of two triangles by clipping.

use glam::DVec3;
use num_rational::BigRational;
use num_traits::{Signed, Zero};

/// A point or a vector.
pub type Vector = [BigRational; 3];

pub fn exact(p: DVec3) -> Vector {
    p.to_array().map(number)
}

/// A finite double.
pub fn number(x: f64) -> BigRational {
    BigRational::from_float(x).unwrap()
}

pub fn minus(u: &Vector, v: &Vector) -> Vector {
    std::array::from_fn(|k| &u[k] - &v[k])
}

pub fn dot(u: &Vector, v: &Vector) -> BigRational {
    &u[0] * &v[0] + &u[1] * &v[1] + &u[2] * &v[2]
}

pub fn cross(u: &Vector, v: &Vector) -> Vector {
    let minor = |i: usize, j: usize| &u[i] * &v[j] - &u[j] * &v[i];
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

pub fn is_zero(v: &Vector) -> bool {
    v.iter().all(Zero::is_zero)
}

/// `p + t (q - p)`.
pub fn between(p: &Vector, q: &Vector, t: &BigRational) -> Vector {
    std::array::from_fn(|k| &p[k] + t * (&q[k] - &p[k]))
}

/// The points x with `normal . (x - origin) >= 0`.
struct HalfSpace {
    normal: Vector,
    origin: Vector,
}

impl HalfSpace {
    fn height(&self, x: &Vector) -> BigRational {
        dot(&self.normal, &minus(x, &self.origin))
    }
}

/// The corners of all common points of two triangles, which may be degenerate, by clipping a by half-spaces whose
/// intersection is b (Sutherland and Hodgman 1974).
pub fn clip(a: &[Vector; 3], b: &[Vector; 3]) -> Vec<Vector> {
    let mut corners = a.to_vec();
    for half_space in half_spaces(b) {
        let mut next = Vec::new();
        for (i, p) in corners.iter().enumerate() {
            let q = &corners[(i + 1) % corners.len()];
            let (at_p, at_q) = (half_space.height(p), half_space.height(q));
            if !at_p.is_negative() {
                next.push(p.clone());
            }
            if at_p.is_positive() && at_q.is_negative() || at_p.is_negative() && at_q.is_positive() {
                next.push(between(p, q, &(&at_p / (&at_p - &at_q))));
            }
        }
        corners = next;
    }
    corners.sort();
    corners.dedup();
    let is_between = |x: &Vector, p: &Vector, q: &Vector| {
        let (u, v) = (minus(p, x), minus(q, x));
        is_zero(&cross(&u, &v)) && dot(&u, &v).is_negative()
    };
    let is_corner = |x: &&Vector| !corners.iter().any(|p| corners.iter().any(|q| is_between(x, p, q)));
    corners.iter().filter(is_corner).cloned().collect()
}

/// Half-spaces whose intersection is the hull of the corners.
fn half_spaces(corners: &[Vector; 3]) -> Vec<HalfSpace> {
    let [a, b, c] = corners;
    let normal = cross(&minus(b, a), &minus(c, a));
    let zero = || -> Vector { std::array::from_fn(|_| BigRational::zero()) };
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(exact);
    let mut all = Vec::new();
    let mut flat = |normal: Vector| {
        all.push(HalfSpace { normal: minus(&zero(), &normal), origin: a.clone() });
        all.push(HalfSpace { normal, origin: a.clone() });
    };
    if !is_zero(&normal) {
        flat(normal.clone());
        for (p, q) in [(a, b), (b, c), (c, a)] {
            all.push(HalfSpace { normal: cross(&normal, &minus(q, p)), origin: p.clone() });
        }
        return all;
    }
    let (first, last) = (corners.iter().min().unwrap(), corners.iter().max().unwrap());
    let along = minus(last, first);
    if is_zero(&along) {
        axes.into_iter().for_each(flat);
        return all;
    }
    axes.iter().for_each(|axis| flat(cross(&along, axis)));
    all.push(HalfSpace { normal: minus(&zero(), &along), origin: last.clone() });
    all.push(HalfSpace { normal: along, origin: first.clone() });
    all
}
