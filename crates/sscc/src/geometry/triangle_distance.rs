//! The distance of two triangles.
//!
//! It is 0 exactly where they have a point in common. Otherwise the nearest points are a corner and a point of the other triangle's
//! inside, or points of two edges. Each candidate below is the distance of two points of the triangles, as computed, so that it is not too
//! small; the smallest one is not too large, because where the formula for an inside point or for two lines loses its digits, in a needle
//! or between nearly parallel edges, the nearest points of edges and ends are as near. Each loses at most about a unit of the size: with an
//! angle t between edges at a distance h, the lines' formula is wrong by `h (u / t)^2 / 2`, the ends by `t^2 / (2 h)`, and
//! the smaller one of both is at most u / 2.

use glam::DVec3;

use super::triangle_triangle::intersect_triangle_triangle;

/// The error of [`distance_triangle_triangle`], as a share of the size of both triangles together.
pub const DISTANCE_ERROR: f64 = 1.0 / (1_u64 << 40) as f64;

/// The distance of two triangles: 0 exactly where they have a point in common, else within 2^-40 of the largest difference of two
/// of their coordinates along an axis. Coordinates are within [`limits::LARGEST`](crate::limits::LARGEST).
///
/// ```
/// use glam::DVec3;
///
/// let a = [DVec3::ZERO, DVec3::X, DVec3::Y];
/// assert_eq!(sscc::distance_triangle_triangle(&a, &a.map(|p| p + DVec3::Z * 2.0)), 2.0);
/// ```
pub fn distance_triangle_triangle(a: &[DVec3; 3], b: &[DVec3; 3]) -> f64 {
    if intersect_triangle_triangle(a, b) {
        return 0.0;
    }
    // In units of the size, so that no product overflows or vanishes.
    let origin = a[0];
    let differences = [a, b].map(|x| x.map(|x| x - origin));
    let size = differences.as_flattened().iter().fold(0.0_f64, |most, d| most.max(d.abs().max_element()));
    let [a, b] = differences.map(|x| x.map(|d| d / size));
    let mut square = f64::INFINITY;
    let mut take = |x: DVec3| square = square.min(x.length_squared());
    for i in 0..3 {
        for j in 0..3 {
            segment_to_segment([a[i], a[(i + 1) % 3]], [b[j], b[(j + 1) % 3]], &mut take);
        }
        [(a[i], &b), (b[i], &a)].into_iter().filter_map(|(p, t)| to_inside(p, t)).for_each(&mut take);
    }
    // Triangles that have no point in common are some distance apart.
    (square.sqrt() * size).max(f64::from_bits(1))
}

/// Hands differences of points of two segments to `take`, one of which is nearly the smallest.
#[inline]
fn segment_to_segment([p, p1]: [DVec3; 2], [q, q1]: [DVec3; 2], take: &mut impl FnMut(DVec3)) {
    let (d, e) = (p1 - p, q1 - q);
    // From an end to the other segment.
    for (end, start, along) in [(p, q, e), (p1, q, e), (q, p, d), (q1, p, d)] {
        let offset = end - start;
        let share = (offset.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        take(if share.is_nan() { offset } else { offset - along * share });
    }
    // Between the insides: where the lines are nearest.
    let (normal, between) = (d.cross(e), q - p);
    let square = normal.length_squared();
    let [s, t] = [e, d].map(|other| between.cross(other).dot(normal) / square);
    if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
        take(between + e * t - d * s);
    }
}

/// The difference of a point and the nearest one of a triangle's plane, if that is in the triangle.
#[inline]
fn to_inside(p: DVec3, triangle: &[DVec3; 3]) -> Option<DVec3> {
    // The longest edge first, and the way from it to the third corner.
    let length = |i: usize| (triangle[(i + 1) % 3] - triangle[i]).length_squared();
    let first = if length(0) >= length(1) && length(0) >= length(2) {
        0
    } else {
        2 - usize::from(length(1) >= length(2))
    };
    let [a, b, c] = [0, 1, 2].map(|i| triangle[(first + i) % 3]);
    let (edge, third, offset) = (b - a, c - a, p - a);
    let along = third.dot(edge) / edge.length_squared();
    let across = third - edge * along;
    let (mut beta, mut gamma, mut left) = (0.0, 0.0, offset);
    // Twice: the second time only what the first one has left is wrong by a share.
    for _ in 0..2 {
        let more = left.dot(across) / across.length_squared();
        gamma += more;
        beta += left.dot(edge) / edge.length_squared() - more * along;
        left = offset - edge * beta - third * gamma;
    }
    (beta >= 0.0 && gamma >= 0.0 && beta + gamma <= 1.0).then_some(left)
}

#[cfg(test)]
mod tests {
    use num_rational::BigRational;
    use num_traits::{One, Signed, Zero};
    use sscc_testing::Numbers;

    use super::*;

    type Point = [BigRational; 3];

    fn exact(p: DVec3) -> Point {
        p.to_array().map(|x| BigRational::from_float(x).unwrap())
    }

    fn minus(a: &Point, b: &Point) -> Point {
        std::array::from_fn(|i| &a[i] - &b[i])
    }

    fn dot(a: &Point, b: &Point) -> BigRational {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    /// The square of the distance of the origin from the hull of points, by all corners, edges and faces of it: exact.
    fn exact_square(points: &[Point]) -> BigRational {
        let mut best = points.iter().map(|p| dot(p, p)).min().unwrap();
        let inside = |x: &BigRational| !x.is_negative() && *x <= BigRational::one();
        for (i, p) in points.iter().enumerate() {
            for (j, q) in points[..i].iter().enumerate() {
                let d = minus(q, p);
                let square = dot(&d, &d);
                if square.is_zero() {
                    continue;
                }
                let t = -dot(p, &d) / &square;
                if inside(&t) {
                    let at: Point = std::array::from_fn(|c| &p[c] + &d[c] * &t);
                    best = best.min(dot(&at, &at));
                }
                for r in &points[..j] {
                    let e = minus(r, p);
                    let (de, ee) = (dot(&d, &e), dot(&e, &e));
                    let determinant = &square * &ee - &de * &de;
                    if determinant.is_zero() {
                        continue;
                    }
                    let (x, y) = (-dot(p, &d), -dot(p, &e));
                    let s = (&x * &ee - &y * &de) / &determinant;
                    let t = (&y * &square - &x * &de) / &determinant;
                    if !s.is_negative() && !t.is_negative() && &s + &t <= BigRational::one() {
                        let at: Point = std::array::from_fn(|c| &p[c] + &d[c] * &s + &e[c] * &t);
                        best = best.min(dot(&at, &at));
                    }
                }
            }
        }
        best
    }

    /// Triangles of every kind against exact arithmetic: needles, points, parallel and nearly parallel edges, grids, far from the origin,
    /// huge and tiny.
    #[test]
    fn distances_are_within_their_error() {
        let random = &mut Numbers(3);
        let count = if std::env::var_os("SSCC_LONG").is_some() { 100_000 } else { 240 };
        let (mut apart, mut worst) = (0, 0.0_f64);
        for case in 0..count {
            let vector = |random: &mut Numbers| DVec3::new(random.signed(), random.signed(), random.signed());
            let thin = [1.0, 1e-3, 1e-8, 1e-13, 0.0][case % 5];
            let far = [0.0, 1.0, 1e-6, 10.0][case / 5 % 4];
            let scale = [1.0, 1e-150, 1e50, 3e-5][case / 20 % 4];
            let shared = vector(random);
            let triangle = |random: &mut Numbers| {
                let (at, along) = (vector(random), if case % 3 == 0 { shared } else { vector(random) });
                let third = along * random.signed() + vector(random) * thin;
                let corners = [at, at + along + vector(random) * (thin * 1e-3), at + third];
                if case % 7 == 0 { corners.map(|x| (x * 2.0).round()) } else { corners }
            };
            let mut pair = [triangle(random), triangle(random)];
            let shift = vector(random) * far;
            pair[1] = pair[1].map(|x| x + shift);
            let origin = if case % 11 == 0 { vector(random) * 1e6 } else { DVec3::ZERO };
            let [a, b] = pair.map(|t| t.map(|x| (x + origin) * scale));
            let found = distance_triangle_triangle(&a, &b);
            if intersect_triangle_triangle(&a, &b) {
                assert_eq!(found, 0.0);
                continue;
            }
            apart += 1;
            // The distance is that of the origin from all differences.
            let differences: Vec<Point> = (0..9).map(|i| minus(&exact(b[i % 3]), &exact(a[i / 3]))).collect();
            let square = exact_square(&differences);
            let all = [a, b];
            let size = (0..3).map(|axis| {
                let of = all.as_flattened().iter().map(|x| x[axis]);
                of.clone().fold(f64::NEG_INFINITY, f64::max) - of.fold(f64::INFINITY, f64::min)
            });
            let error = size.fold(0.0, f64::max) * DISTANCE_ERROR;
            let [below, above] = [found - error, found + error].map(|x| BigRational::from_float(x).unwrap());
            assert!(&above * &above >= square, "case {case}: {found} is too small");
            assert!(below.is_negative() || &below * &below <= square, "case {case}: {found} is too large");
            // How much of the error is used.
            let fraction = |share: f64| {
                let [below, above] = [found - error * share, found + error * share]
                    .map(|x| BigRational::from_float(x).unwrap());
                &above * &above >= square && (below.is_negative() || &below * &below <= square)
            };
            while !fraction(worst.max(1e-6)) {
                worst = worst.max(1e-6) * 2.0;
            }
        }
        assert!(apart > count / 2, "{apart}");
        assert!(worst < 0.1, "{worst}");
    }
}
