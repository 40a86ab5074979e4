//! The distance of two triangles.
//!
//! It is 0 exactly if they have a point in common. Otherwise the nearest points are a corner and a point of the other triangle's
//! interior, or points of two edges. Each candidate below is the distance of two computed points of the triangles, so that it is
//! not too small. The smallest candidate is too large by at most a few rounding units of the size, although the formulas lose
//! digits:
//!
//! - For edges at an angle t and a distance h, the point at which the lines are nearest errs along its edge by about
//!   `e = u / t + h u / t^2`. The nearest point of the other edge is computed from this point, so that the distance is about
//!   `sqrt(h^2 + (t e)^2)`: too large by at most u. If the second term of e is large, an end of an edge is as near.
//! - In a needle the formula for a point of the interior is applied again to the part of the vector that it has not removed,
//!   until nothing of that remains. If a needle is thinner than the error, edges are as near.

use glam::DVec3;

use super::triangle_triangle::intersect_triangle_triangle;

/// The error bound of [`distance_triangle_triangle`], as a share of the size of both triangles together.
pub const DISTANCE_ERROR: f64 = 1.0 / (1_u64 << 40) as f64;

/// Returns the distance of two triangles: 0 exactly if they have a point in common, else with an error of at most 2^-40
/// of the largest difference of two of their coordinates along an axis. Coordinates are within
/// [`limits::LARGEST`](crate::limits::LARGEST).
///
/// ```
/// use glam::DVec3;
///
/// let a = [DVec3::ZERO, DVec3::X, DVec3::Y];
/// assert_eq!(sscc::distance_triangle_triangle(&a, &a.map(|p| p + DVec3::Z * 2.0)), 2.0);
/// ```
pub fn distance_triangle_triangle(a: &[DVec3; 3], b: &[DVec3; 3]) -> f64 {
    if with_mutant!(intersect_triangle_triangle(a, b), TouchingApart, false) {
        return 0.0;
    }
    // Computes in units of the size, so that no product overflows or vanishes.
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
    // The distance of triangles that have no point in common is above 0.
    (square.sqrt() * size).max(f64::from_bits(1))
}

/// Passes differences of points of two segments to `take`. One of them is nearly the smallest.
#[inline]
fn segment_to_segment([p, p1]: [DVec3; 2], [q, q1]: [DVec3; 2], take: &mut impl FnMut(DVec3)) {
    let (d, e) = (p1 - p, q1 - q);
    // The differences between an end and the other segment.
    for (end, start, along) in [(p, q, e), (p1, q, e), (q, p, d), (q1, p, d)] {
        let offset = end - start;
        let share = (offset.dot(along) / along.length_squared()).clamp(0.0, 1.0);
        take(if share.is_nan() { offset } else { offset - along * share });
    }
    // The difference between inner points, where the lines are nearest.
    let (normal, between) = (d.cross(e), q - p);
    let nearest = |other: DVec3| between.cross(other).dot(normal) / normal.length_squared();
    let s = nearest(e);
    if (0.0..=1.0).contains(&s) {
        let offset = d * s - between;
        let share =
            with_mutant!(offset.dot(e) / e.length_squared(), LinesUnprojected, nearest(d)).clamp(0.0, 1.0);
        take(if share.is_nan() { offset } else { offset - e * share });
    }
}

/// Returns the difference of a point and the nearest point of a triangle's plane, if that is in the triangle.
#[inline]
fn to_inside(p: DVec3, triangle: &[DVec3; 3]) -> Option<DVec3> {
    // Takes the longest edge, and the vector from it to the third corner.
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
    // Each iteration removes the rest that the one before has left, with an error that is a share of this rest.
    for _ in 0..with_mutant!(3, NeedlesOnce, 1) {
        let more = left.dot(across) / across.length_squared();
        gamma += more;
        beta += left.dot(edge) / edge.length_squared() - more * along;
        left = offset - edge * beta - third * gamma;
    }
    (beta >= 0.0 && gamma >= 0.0 && beta + gamma <= 1.0).then_some(left)
}

#[cfg(test)]
mod tests {
    use num_bigint::BigInt;
    use num_rational::BigRational;
    use num_traits::{One, Signed, ToPrimitive, Zero};
    use sscc_testing::Numbers;

    use super::*;

    /// A point in integer multiples of a common unit.
    type Point = [BigInt; 3];

    /// A numerator and a positive denominator. Unlike a rational number it is not reduced, which would take most of the time.
    type Fraction = (BigInt, BigInt);

    /// Returns the points in multiples of one over a power of two, and that power.
    fn exact(points: &[DVec3]) -> (Vec<Point>, BigInt) {
        let exact = |x: f64| BigRational::from_float(x).unwrap();
        let all = points.iter().flat_map(|p| p.to_array()).map(exact);
        let unit = all.map(|x| x.denom().clone()).max().unwrap();
        let whole = |x: f64| exact(x).numer() * (&unit / exact(x).denom());
        (points.iter().map(|p| p.to_array().map(whole)).collect(), unit)
    }

    fn minus(a: &Point, b: &Point) -> Point {
        std::array::from_fn(|i| &a[i] - &b[i])
    }

    fn dot(a: &Point, b: &Point) -> BigInt {
        a.iter().zip(b).map(|(a, b)| a * b).sum()
    }

    /// Returns the exact square of the distance of the origin from the hull of points, from all corners, edges and faces of the
    /// hull.
    fn exact_square(points: &[Point]) -> Fraction {
        let mut best = (points.iter().map(|p| dot(p, p)).min().unwrap(), BigInt::one());
        let mut take = |numerator: BigInt, denominator: &BigInt| {
            if &numerator * &best.1 < &best.0 * denominator {
                best = (numerator, denominator.clone());
            }
        };
        for (i, p) in points.iter().enumerate() {
            for (j, q) in points[..i].iter().enumerate() {
                let d = minus(q, p);
                let (square, along) = (dot(&d, &d), -dot(p, &d));
                if square.is_zero() {
                    continue;
                }
                // The foot of the perpendicular is at along / square from p to q.
                if !along.is_negative() && along <= square {
                    take(dot(p, p) * &square - &along * &along, &square);
                }
                for r in &points[..j] {
                    let e = minus(r, p);
                    let (de, ee) = (dot(&d, &e), dot(&e, &e));
                    let determinant = &square * &ee - &de * &de;
                    if determinant.is_zero() {
                        continue;
                    }
                    let (x, y) = (&along, -dot(p, &e));
                    let s = x * &ee - &y * &de;
                    let t = &y * &square - x * &de;
                    if !s.is_negative() && !t.is_negative() && &s + &t <= determinant {
                        // The determinant is the square of the normal d x e.
                        let minor = |i: usize, j: usize| &d[i] * &e[j] - &d[j] * &e[i];
                        let height = dot(p, &[minor(1, 2), minor(2, 0), minor(0, 1)]);
                        take(&height * &height, &determinant);
                    }
                }
            }
        }
        best
    }

    /// Checks a distance against exact arithmetic. Returns the share of its error bound that is used, up to a factor of 2. None
    /// if the triangles collide.
    fn check(a: &[DVec3; 3], b: &[DVec3; 3], case: usize) -> Option<f64> {
        let found = distance_triangle_triangle(a, b);
        if intersect_triangle_triangle(a, b) {
            assert_eq!(found, 0.0);
            return None;
        }
        // The distance is that of the origin from all differences.
        let all = [*a, *b];
        let (corners, unit) = exact(all.as_flattened());
        let differences: Vec<Point> = (0..9).map(|i| minus(&corners[3 + i % 3], &corners[i / 3])).collect();
        let (numerator, denominator) = exact_square(&differences);
        let size = (0..3).map(|axis| {
            let of = all.as_flattened().iter().map(|x| x[axis]);
            of.clone().fold(f64::NEG_INFINITY, f64::max) - of.fold(f64::INFINITY, f64::min)
        });
        let error = size.fold(0.0, f64::max) * DISTANCE_ERROR;
        // Compares the square of a number with that of the distance.
        let scaled = &unit * &unit * &denominator;
        let compare = |x: f64| {
            let x = BigRational::from_float(x).unwrap();
            (x.numer() * x.numer() * &scaled).cmp(&(x.denom() * x.denom() * &numerator))
        };
        let is_within = |share: f64| {
            let [below, above] = [found - error * share, found + error * share];
            compare(above).is_ge() && (below < 0.0 || compare(below).is_le())
        };
        let square = || BigRational::new(numerator.clone(), scaled.clone()).to_f64();
        assert!(is_within(1.0), "case {case}: {found} for the square {:?}", square());
        let mut used = 1e-6;
        while !is_within(used) {
            used *= 2.0;
        }
        Some(used)
    }

    fn vector(random: &mut Numbers) -> DVec3 {
        DVec3::new(random.signed(), random.signed(), random.signed())
    }

    /// Checks many pairs of triangles, most of which are apart.
    fn check_many(seed: u64, pair: impl Fn(&mut Numbers, usize) -> [[DVec3; 3]; 2]) {
        let random = &mut Numbers(seed);
        let count = if std::env::var_os("SSCC_LONG").is_some() { 20_000 } else { 400 };
        let is_apart = |case: &usize| {
            let [a, b] = pair(random, *case);
            check(&a, &b, *case).is_some()
        };
        let apart = (0..count).filter(is_apart).count();
        assert!(apart > count / 2, "{apart}");
    }

    /// Edges cross at small angles and small distances, in any direction, with the triangles on both sides.
    #[test]
    fn distances_of_nearly_parallel_edges_are_within_their_error() {
        check_many(5, |random, case| {
            let along = vector(random).normalize();
            let normal = along.cross(vector(random)).normalize();
            let (angle, gap) = (random.power(-13.0, -3.0), random.power(-14.0, -5.0));
            let turned = (along + along.cross(normal) * angle) * [1.0, -1.0][case % 2];
            let at = vector(random);
            let a = [at - along, at + along, at - normal + vector(random) * 0.3];
            let at = at + normal * gap + along * (0.5 * random.signed());
            [a, [at - turned, at + turned, at + normal + vector(random) * 0.3]]
        });
    }

    /// Corners are slightly above the interior of needles.
    #[test]
    fn distances_to_the_inside_of_needles_are_within_their_error() {
        check_many(7, |random, case| {
            let along = vector(random).normalize();
            let normal = along.cross(vector(random)).normalize();
            let across = along.cross(normal) * random.power(-13.0, -3.0);
            let needle =
                [DVec3::ZERO, along, along * random.signed().abs() + across].map(|x| x + along * 0.5);
            let middle = (needle[0] + needle[1] + needle[2]) / 3.0;
            let above = middle + (needle[case % 3] - middle) * random.signed().abs();
            let gap = normal * random.power(-14.0, -5.0);
            let far = [(); 2].map(|()| above + normal + vector(random) * 0.3);
            let other = [above + gap, far[0], far[1]];
            if case % 2 == 0 { [needle, other] } else { [other, needle] }
        });
    }

    /// Tests triangles of every kind against exact arithmetic: needles, points, parallel and nearly parallel edges, grids, far
    /// from the origin, huge and tiny.
    #[test]
    fn distances_are_within_their_error() {
        let random = &mut Numbers(3);
        let count = if std::env::var_os("SSCC_LONG").is_some() { 100_000 } else { 240 };
        let (mut apart, mut touching, mut worst) = (0, 0, 0.0_f64);
        for case in 0..count {
            let thin = [1.0, 1e-3, 1e-8, 1e-10, 3e-11, 1e-11, 1e-13, 0.0][case % 8];
            let far = [0.0, 1.0, 1e-6, 10.0, 1e-12][case % 5];
            let scale = [1.0, 1e-150, 1e50, 3e-5][case / 40 % 4];
            let shared = vector(random);
            let triangle = |random: &mut Numbers| {
                let (at, along) = (vector(random), if case % 3 == 0 { shared } else { vector(random) });
                let third = along * random.signed() + vector(random) * thin;
                let corners = [at, at + along + vector(random) * (thin * 1e-3), at + third];
                if case % 7 == 0 { corners.map(|x| (x * 2.0).round()) } else { corners }
            };
            let mut pair = [triangle(random), triangle(random)];
            // Every sixth pair has one centre, so that triangles that are not thin cross.
            let center = |x: &[DVec3; 3]| (x[0] + x[1] + x[2]) / 3.0;
            let shift =
                if case % 6 == 0 { center(&pair[0]) - center(&pair[1]) } else { vector(random) * far };
            pair[1] = pair[1].map(|x| x + shift);
            let origin = if case % 11 == 0 { vector(random) * 1e6 } else { DVec3::ZERO };
            let [a, b] = pair.map(|t| t.map(|x| (x + origin) * scale));
            match check(&a, &b, case) {
                Some(used) => (apart, worst) = (apart + 1, worst.max(used)),
                None => touching += 1,
            }
        }
        assert!(apart > count / 2 && touching > count / 20, "{apart} {touching}");
        assert!(worst < 0.1, "{worst:e} of the error");
    }
}
