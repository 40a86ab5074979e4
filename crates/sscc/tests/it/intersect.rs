//! Compares the triangle test with a naive oracle of another kind: slow, exact linear programming.

use glam::DVec3;
use num_bigint::BigInt;
use num_traits::{Float, Num};
use sscc::{intersect_triangle_triangle, limits};
use sscc_testing::{cases, threshold};

use crate::{intersection, penetration};

type Triangle = [DVec3; 3];

/// The six orders of three corners.
const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

/// Whether there are weights `l, m >= 0` with `sum l = sum m = 1` and `sum l_i a_i = sum m_j b_j`, for
/// corners with whole coordinates.
///
/// Phase one of the simplex method in exact numbers: from one artificial variable for each equation, it
/// minimises their sum, which becomes 0 exactly if the equations have a solution. Bland's rule (the lowest
/// index enters, the lowest leaves) prevents cycles. All entries are whole numbers over one common
/// denominator, the last pivot, by which every step divides without remainder (fraction-free elimination).
fn oracle<T: Num + PartialOrd + Clone>(a: &[[T; 3]; 3], b: &[[T; 3]; 3]) -> bool {
    const VARIABLES: usize = 6;
    let (zero, one) = (T::zero, T::one);
    // Columns: l (3), m (3), right-hand side.
    let mut rows: Vec<Vec<T>> = (0..3)
        .map(|k| {
            let mut row: Vec<T> = a.iter().map(|p| p[k].clone()).collect();
            row.extend(b.iter().map(|p| zero() - p[k].clone()));
            row.push(zero());
            row
        })
        .collect();
    rows.push(vec![one(), one(), one(), zero(), zero(), zero(), one()]);
    rows.push(vec![zero(), zero(), zero(), one(), one(), one(), one()]);
    // The sum of the artificial variables, as a function of the others; they may never come back.
    let mut sum: Vec<T> =
        (0..=VARIABLES).map(|j| rows.iter().fold(zero(), |s, row| s + row[j].clone())).collect();
    let mut basis: Vec<usize> = (0..rows.len()).map(|i| VARIABLES + i).collect();
    let mut denominator = one();
    loop {
        if sum[VARIABLES].is_zero() {
            return true;
        }
        let Some(enter) = (0..VARIABLES).find(|j| sum[*j] > zero()) else {
            return false;
        };
        // The row with the least ratio of right-hand side to entry.
        let mut leave = None;
        for i in (0..rows.len()).filter(|i| rows[*i][enter] > zero()) {
            let better = leave.is_none_or(|best: usize| {
                let left = rows[i][VARIABLES].clone() * rows[best][enter].clone();
                let right = rows[best][VARIABLES].clone() * rows[i][enter].clone();
                left < right || left == right && basis[i] < basis[best]
            });
            leave = if better { Some(i) } else { leave };
        }
        let leave = leave.expect("a sum of nonnegative numbers has a least value");
        basis[leave] = enter;
        let row = rows[leave].clone();
        let pivot = row[enter].clone();
        let others = rows.iter_mut().enumerate().filter(|(i, _)| *i != leave).map(|(_, other)| other);
        for other in others.chain([&mut sum]) {
            let factor = other[enter].clone();
            for (x, y) in other.iter_mut().zip(&row) {
                *x = (pivot.clone() * x.clone() - factor.clone() * y.clone()) / denominator.clone();
            }
        }
        denominator = pivot;
    }
}

/// Calls the oracle with the exact values of the coordinates, all times 2^1075.
fn intersect_exactly(a: &Triangle, b: &Triangle) -> bool {
    let whole = |x: f64| {
        let (mantissa, exponent, sign) = x.integer_decode();
        BigInt::from(i64::from(sign) * mantissa as i64) << (i32::from(exponent) + 1075)
    };
    let mut triangles = [a, b].map(|t| t.map(|p| p.to_array().map(whole)));
    // Removes common factors of 2, which only take time.
    let coordinates = || triangles.iter().flatten().flatten();
    let shift = coordinates().filter_map(BigInt::trailing_zeros).min().unwrap_or(0);
    for x in triangles.iter_mut().flatten().flatten() {
        *x >>= shift;
    }
    oracle(&triangles[0], &triangles[1])
}

/// Calls the oracle with whole coordinates up to a hundred, which is fast.
fn intersect_whole(a: &Triangle, b: &Triangle) -> bool {
    let whole = |t: &Triangle| t.map(|p| p.to_array().map(|x| x as i128));
    oracle(&whole(a), &whole(b))
}

/// Calls the tested function, and asserts that the answer is the same for both orders of the triangles and all orders of corners.
fn intersect(a: &Triangle, b: &Triangle) -> bool {
    let found = intersect_triangle_triangle(a, b);
    for order_a in ORDERS {
        for order_b in ORDERS {
            let (a, b) = (order_a.map(|i| a[i]), order_b.map(|i| b[i]));
            assert_eq!(intersect_triangle_triangle(&a, &b), found, "{a:?} {b:?}");
            assert_eq!(intersect_triangle_triangle(&b, &a), found, "{b:?} {a:?}");
        }
    }
    found
}

/// Asserts that the answer is the oracle's.
#[track_caller]
fn check(a: &Triangle, b: &Triangle) -> bool {
    let found = intersect(a, b);
    assert_eq!(found, intersect_exactly(a, b), "{a:?} {b:?}");
    intersection::check(a, b);
    penetration::check(a, b);
    found
}

/// A small generator of pseudo-random numbers (a mixed Weyl sequence), the same in every run.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut x = self.0;
        for shift in [32, 29, 32] {
            x = (x ^ (x >> shift)).wrapping_mul(0xd6e8_feb8_6659_fd93);
        }
        x ^ (x >> 32)
    }

    /// Returns a whole number in `0..count`.
    fn below(&mut self, count: u64) -> u64 {
        ((u128::from(self.bits()) * u128::from(count)) >> 64) as u64
    }

    /// Returns a whole number in `-size..=size`.
    fn whole(&mut self, size: u64) -> f64 {
        self.below(2 * size + 1) as f64 - size as f64
    }

    /// Returns a number in `-1..1`, a multiple of 2^-52.
    fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Returns a triangle with corners from a generator of coordinates.
    fn triangle(&mut self, mut coordinate: impl FnMut(&mut Self) -> f64) -> Triangle {
        std::array::from_fn(|_| DVec3::from_array(std::array::from_fn(|_| coordinate(self))))
    }

    /// Returns a triangle with whole coordinates in `-size..=size`.
    fn whole_triangle(&mut self, size: u64) -> Triangle {
        self.triangle(|random| random.whole(size))
    }

    /// Returns a point with whole coordinates in `-size..=size`.
    fn whole_point(&mut self, size: u64) -> DVec3 {
        DVec3::new(self.whole(size), self.whole(size), self.whole(size))
    }

    /// Returns weights of three corners: whole numbers of sum 8, so that they divide exactly.
    fn weights(&mut self) -> [f64; 3] {
        let first = self.below(9);
        let second = self.below(9 - first);
        [first as f64 / 8.0, second as f64 / 8.0, (8 - first - second) as f64 / 8.0]
    }
}

/// Returns the point with the given weights; exact if the corners have few digits and the weights are eighths.
fn point(triangle: &Triangle, weights: [f64; 3]) -> DVec3 {
    triangle[0] * weights[0] + triangle[1] * weights[1] + triangle[2] * weights[2]
}

/// Returns the point itself, and its neighbours along an axis.
fn neighbours(p: DVec3, axis: usize) -> [DVec3; 3] {
    let at = |x: f64| {
        let mut moved = p;
        moved[axis] = x;
        moved
    };
    [p, at(p[axis].next_up()), at(p[axis].next_down())]
}

/// Returns `2^exponent`, also if it is subnormal.
fn power_of_two(exponent: i32) -> f64 {
    if exponent >= -1022 {
        f64::from_bits(((1023 + exponent) as u64) << 52)
    } else {
        f64::from_bits(1 << (1074 + exponent))
    }
}

/// Returns the triangle multiplied by a factor, rounded unless the factor is a power of two.
fn scaled(triangle: &Triangle, factor: f64) -> Triangle {
    triangle.map(|p| p * factor)
}

/// Exponents of factors for which whole coordinates below 2^6 stay exact, from subnormal numbers to the largest allowed ones.
const POWERS: [i32; 12] = [-1074, -1060, -1022, -700, -350, -300, -287, -245, -240, -238, 100, 193];

/// Factors that need rounding: those for which the crate `robust` alone is wrong, and near the largest allowed factor.
const FACTORS: [f64; 6] = [1e-320, 1e-300, 1e-110, 1e-73, 3e-72, 1e58];

#[test]
fn oracle_is_right_in_plain_cases() {
    let a = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let at = |x, y, z| DVec3::new(x, y, z);
    let through = [at(0.25, 0.25, -1.0), at(0.25, 0.25, 1.0), at(5.0, 5.0, 0.0)];
    let beside = [at(1.0, 0.25, -1.0), at(1.0, 0.25, 1.0), at(5.0, 5.0, 0.0)];
    let at_corner = [at(1.0, 0.0, 0.0), at(2.0, 0.0, 1.0), at(2.0, 0.0, 2.0)];
    for (b, expected) in [(through, true), (beside, false), (at_corner, true), (a, true)] {
        assert_eq!(intersect_exactly(&a, &b), expected);
        assert_eq!(intersect_whole(&scaled(&a, 4.0), &scaled(&b, 4.0)), expected);
        assert_eq!(intersect(&a, &b), expected);
    }
    let points = [DVec3::ONE; 3];
    assert!(check(&points, &points));
    assert!(!check(&points, &[DVec3::X; 3]));
}

#[test]
fn tiny_whole_coordinates() {
    let mut random = Random(1);
    let mut count = [0; 2];
    for i in 0..cases(40_000) {
        // Coordinates from 0..=1 (nearly all triangles touch or are degenerate) to 0..=3; some triangles are in one plane.
        let largest = 2 + i % 3;
        let flat = i % 7 == 0;
        let mut coordinate = |random: &mut Random| random.below(largest) as f64;
        let (mut a, mut b) = (random.triangle(&mut coordinate), random.triangle(&mut coordinate));
        if flat {
            for p in a.iter_mut().chain(&mut b) {
                p.z = p.x + p.y;
            }
        }
        // Random triangles have every order of corners; testing all orders each time is slow.
        let found = if i % 8 == 0 { intersect(&a, &b) } else { intersect_triangle_triangle(&a, &b) };
        assert_eq!(found, intersect_whole(&a, &b), "{a:?} {b:?}");
        if i % 8 == 0 {
            intersection::check(&a, &b);
            penetration::check(&a, &b);
        }
        count[usize::from(found)] += 1;
    }
    assert!(count.iter().all(|c| *c > threshold(5_000)), "one-sided: {count:?}");
}

#[test]
fn random_pairs() {
    let mut random = Random(2);
    let mut count = [0; 2];
    for _ in 0..cases(5_000) {
        let a = random.triangle(Random::unit);
        let b = random.triangle(Random::unit);
        count[usize::from(check(&a, &b))] += 1;
    }
    assert!(count.iter().all(|c| *c > threshold(1_000)), "one-sided: {count:?}");
}

#[test]
fn mixed_magnitudes() {
    let mut random = Random(3);
    for i in 0..cases(2_000) {
        let exponents = [-1074..200, -400..-200, -30..30][i % 3].clone();
        let mut coordinate = |random: &mut Random| {
            let count = (exponents.end - exponents.start) as u64;
            let exponent = exponents.start + random.below(count) as i32;
            if random.below(4) == 0 { 0.0 } else { random.unit() * power_of_two(exponent) }
        };
        check(&random.triangle(&mut coordinate), &random.triangle(&mut coordinate));
    }
}

/// A corner is on the other triangle, or off it by one ulp: only the side of the ulp decides.
#[test]
fn corner_on_face() {
    let mut random = Random(4);
    let mut count = [0; 2];
    for i in 0..cases(1_200) {
        let a = random.whole_triangle(1 << 20);
        let p = point(&a, random.weights());
        let normal = (a[1] - a[0]).cross(a[2] - a[0]);
        // The other corners are on one side, so that p is the only point that can touch.
        let away = |random: &mut Random| {
            let q = random.whole_point(1 << 20);
            p + if q.dot(normal) < 0.0 { -q } else { q }
        };
        let (q, r) = (away(&mut random), away(&mut random));
        for p in neighbours(p, i % 3) {
            count[usize::from(check(&a, &[p, q, r]))] += 1;
        }
    }
    assert!(count.iter().all(|c| *c > threshold(400)), "one-sided: {count:?}");
}

/// Two edges touch at one point, or are off by one ulp.
#[test]
fn edges_that_touch() {
    let mut random = Random(5);
    let mut count = [0; 2];
    for i in 0..cases(1_200) {
        let a = random.whole_triangle(1 << 20);
        let weight = random.below(9) as f64 / 8.0;
        let p = a[0] * weight + a[1] * (1.0 - weight);
        let w = random.whole_point(1 << 10);
        // The triangle b is behind the edge, seen from the third corner of a.
        let b = [p - w, p + w * 4.0, p + (p - a[2]) * 2.0];
        for q in neighbours(b[0], i % 3) {
            count[usize::from(check(&a, &[q, b[1], b[2]]))] += 1;
        }
    }
    assert!(count.iter().all(|c| *c > threshold(400)), "one-sided: {count:?}");
}

/// Triangles are in one plane, or nearly: with corners and edges on edges, overlaps, and one ulp off.
#[test]
fn coplanar() {
    let mut random = Random(6);
    let mut count = [0; 2];
    for i in 0..cases(1_200) {
        let base = random.whole_triangle(1 << 15);
        // Combinations of two directions are exactly in one plane, on a coarse lattice.
        let mut lattice = |size: u64| {
            let (s, t) = (random.whole(size), random.whole(size));
            base[0] + (base[1] - base[0]) * s + (base[2] - base[0]) * t
        };
        let size = [1, 2, 4][i % 3];
        let a: Triangle = std::array::from_fn(|_| lattice(size));
        let b: Triangle = std::array::from_fn(|_| lattice(size));
        for p in neighbours(b[0], i % 3) {
            count[usize::from(check(&a, &[p, b[1], b[2]]))] += 1;
        }
    }
    assert!(count.iter().all(|c| *c > threshold(400)), "one-sided: {count:?}");
}

/// Triangles are segments or points, with collinear overlaps and gaps, crossings, and points on edges and on faces.
#[test]
fn degenerate() {
    let mut random = Random(7);
    let mut count = [0; 2];
    for i in 0..cases(1_200) {
        let (origin, along) = (random.whole_point(1 << 20), random.whole_point(1 << 20));
        let collinear = |random: &mut Random, size| origin + along * random.whole(size);
        let a: Triangle = std::array::from_fn(|_| collinear(&mut random, 3));
        let p = collinear(&mut random, 3);
        let b = match i % 4 {
            0 => [p, collinear(&mut random, 3), collinear(&mut random, 3)],
            1 => [p; 3],
            2 => [p, p, p + random.whole_point(1 << 10)],
            _ => {
                let w = random.whole_point(1 << 10);
                [p - w, p + w * 2.0, p + random.whole_point(1 << 10)]
            }
        };
        for p in neighbours(b[0], i % 3) {
            count[usize::from(check(&a, &[p, b[1], b[2]]))] += 1;
        }
    }
    assert!(count.iter().all(|c| *c > threshold(400)), "one-sided: {count:?}");
}

#[test]
fn identical_and_shared_corners() {
    let mut random = Random(8);
    for _ in 0..cases(300) {
        let (a, b) = (random.triangle(Random::unit), random.triangle(Random::unit));
        assert!(check(&a, &a));
        assert!(check(&a, &[b[0], a[1], b[2]]));
        assert!(check(&a, &[a[2], b[1], a[0]]));
        assert!(check(&a, &[a[0], a[0], b[0]]));
        assert!(check(&a, &[a[1]; 3]));
    }
}

/// A power of two changes no answer, so the fast oracle on whole numbers has all answers.
#[test]
fn powers_of_two() {
    let mut random = Random(9);
    for i in 0..cases(2_400) {
        let size = [1, 2, 32][i % 3];
        let (a, b) = (random.whole_triangle(size), random.whole_triangle(size));
        let expected = intersect_whole(&a, &b);
        let power = POWERS[i % POWERS.len()];
        let (a, b) = (scaled(&a, power_of_two(power)), scaled(&b, power_of_two(power)));
        assert_eq!(intersect(&a, &b), expected, "2^{power}: {a:?} {b:?}");
        intersection::check(&a, &b);
        penetration::check(&a, &b);
    }
}

/// Touching triangles are scaled with rounding: afterwards rounding decides whether they touch.
#[test]
fn other_scales() {
    let mut random = Random(10);
    for i in 0..cases(600) {
        let factor = FACTORS[i % FACTORS.len()];
        let a = scaled(&random.whole_triangle(24), factor);
        let p = point(&a, random.weights());
        let others = random.whole_triangle(24);
        for p in neighbours(p, i % 3) {
            check(&a, &[p, others[1] * factor, others[2] * factor]);
        }
    }
}

#[test]
fn largest_coordinates() {
    let mut random = Random(11);
    for _ in 0..cases(600) {
        let mut coordinate = |random: &mut Random| match random.below(4) {
            0 => limits::LARGEST,
            1 => -limits::LARGEST,
            2 => 0.0,
            _ => f64::from_bits(1),
        };
        check(&random.triangle(&mut coordinate), &random.triangle(&mut coordinate));
    }
}
