//! Tests terms against the same integrals in exact fractions.

use num_rational::BigRational;
use num_traits::{Signed, Zero};
use sscc_testing::cases;

use super::*;
use crate::random::next_uniform;

type Point = [BigRational; 2];

fn exact(x: f64) -> BigRational {
    BigRational::from_float(x).unwrap()
}

/// Returns twice the area of a triangle of the plane, with its sign.
fn area(p: &Point, q: &Point, r: &Point) -> BigRational {
    (&q[0] - &p[0]) * (&r[1] - &p[1]) - (&q[1] - &p[1]) * (&r[0] - &p[0])
}

/// Returns the part of a convex polygon on which a linear function is not negative.
fn clip(polygon: &[Point], side: impl Fn(&Point) -> BigRational) -> Vec<Point> {
    let mut clipped = Vec::new();
    for (k, p) in polygon.iter().enumerate() {
        let q = &polygon[(k + 1) % polygon.len()];
        let (at_p, at_q) = (side(p), side(q));
        if !at_p.is_negative() {
            clipped.push(p.clone());
        }
        if (&at_p * &at_q).is_negative() {
            let t = &at_p / (&at_p - &at_q);
            clipped.push([0, 1].map(|k| &p[k] + (&q[k] - &p[k]) * &t));
        }
    }
    clipped
}

fn integral(polygon: &[Point], value: impl Fn(&Point) -> BigRational) -> BigRational {
    let mut sum = BigRational::zero();
    for k in 2..polygon.len() {
        let [p, q, r] = [0, k - 1, k].map(|k| &polygon[k]);
        sum += area(p, q, r) * (value(p) + value(q) + value(r)) / exact(6.0);
    }
    sum
}

/// Returns the term in exact arithmetic.
fn exact_term(a: &[DVec3; 3], b: &[DVec3; 3]) -> BigRational {
    let flat = |t: &[DVec3; 3]| t.map(|p| [exact(p.x), exact(p.y)]);
    let (flat_a, flat_b) = (flat(a), flat(b));
    let [turn_a, turn_b] = [&flat_a, &flat_b].map(|t| area(&t[0], &t[1], &t[2]));
    if turn_a.is_zero() || turn_b.is_zero() {
        return BigRational::zero();
    }
    let mut polygon = flat_b.to_vec();
    if turn_b.is_negative() {
        polygon.reverse();
    }
    for k in 0..3 {
        polygon = clip(&polygon, |p| area(&flat_a[k], &flat_a[(k + 1) % 3], p) * &turn_a);
    }
    // Heights by barycentric weights.
    let height = |t: &[DVec3; 3], flat: &[Point; 3], turn: &BigRational, p: &Point| {
        (0..3)
            .map(|k| exact(t[k].z) * area(p, &flat[(k + 1) % 3], &flat[(k + 2) % 3]) / turn)
            .sum::<BigRational>()
    };
    let (z_a, z_b) = (|p: &Point| height(a, &flat_a, &turn_a, p), |p: &Point| height(b, &flat_b, &turn_b, p));
    let under = clip(&polygon, |p| z_b(p) - z_a(p));
    let over = clip(&polygon, |p| z_a(p) - z_b(p));
    let over: Vec<Point> = if over.iter().all(|p| z_a(p) == z_b(p)) { Vec::new() } else { over };
    let sum = integral(&under, z_a) + integral(&over, z_b);
    if turn_a.is_negative() == turn_b.is_negative() { sum } else { -sum }
}

/// Returns a triangle of one kind: plain, far from the centre, a needle, steep, flat seen along z, small, or vertical.
fn triangle(random: &mut u64, kind: u32) -> [DVec3; 3] {
    let mut vector = || DVec3::from([(); 3].map(|()| 2.0 * next_uniform(random) - 1.0));
    let [p, q, r] = [vector(), vector(), vector()];
    let w = vector();
    match kind {
        0 => [p, q, r],
        1 => [p, q, r].map(|x| x + w * 1e3),
        2 => [p, q, q + (r - q) * 1e-9],
        3 => [p, q, p + (q - p) * 0.4 + r * 1e-12],
        4 => [p, q, r].map(|x| x * DVec3::new(1.0, 1e-10, 1.0)),
        5 => [p, q, r].map(|x| DVec3::new(x.x, 2.0 * x.x + 1e-14 * x.y, x.z)),
        6 => [p, q, r].map(|x| x * 1e-3),
        _ => [p, DVec3::new(p.x, p.y, q.z), r],
    }
}

/// Would fail if the error left out the rounding of clips and heights, or if a slope beyond the range of numbers made NaN.
#[test]
fn terms_are_within_their_error() {
    let random = &mut 7;
    let mut found = 0;
    for case in 0..cases(800_u32) {
        let (a, b) = (triangle(random, case % 8), triangle(random, case / 8 % 8));
        // Some triangles have a common edge, as in touching bodies.
        let b = if case % 5 == 0 { [a[0], a[1], b[2]] } else { b };
        found += check(&a, &b);
        // Two triangles in one plane, whose heights differ by rounding alone.
        let at = |s: f64, t: f64| a[0] + (a[1] - a[0]) * s + (a[2] - a[0]) * t;
        let mut share = || 2.0 * next_uniform(random) - 0.5;
        let same_plane = [(); 3].map(|()| at(share(), share()));
        check(&a, &same_plane);
    }
    assert!(found > cases(800) / 8, "{found}");
    let steep = [DVec3::new(0.0, 0.0, -1.0), DVec3::new(1e-310, 1.0, -1.0), DVec3::new(0.0, 1.0, 1.0)];
    let level = [-0.5, 0.0, 0.5]
        .map(|z| [DVec3::new(-1.0, -1.0, z), DVec3::new(3.0, 0.0, z), DVec3::new(-1.0, 3.0, z)]);
    for other in &level {
        check(&steep, other);
        check(other, &steep);
    }
    let almost_vertical = [DVec3::ZERO, DVec3::new(4.0, 4.0, 0.0), DVec3::new(0.0, 1e-308, 1.0)];
    check(&almost_vertical, &level[1]);
    check(&level[1], &almost_vertical);
    for corners in [&steep, &almost_vertical] {
        let plane = Plane::new(corners, 4.0);
        for p in [DVec2::ZERO, DVec2::Y, DVec2::splat(4.0)] {
            assert!(plane.height(p).is_finite(), "{corners:?} {p}");
        }
    }
    // Level triangles in the plane of the centre have no volume below them, and no steep part.
    let flat = level[1];
    check(&flat, &flat.map(|p| p * 0.7 + DVec3::new(0.1, 0.2, 0.3)));
}

/// Checks one term, and returns 1 if it is rounded.
fn check(a: &[DVec3; 3], b: &[DVec3; 3]) -> u32 {
    let found = overlap_integral(a, b);
    assert!(found.value.is_finite() && found.error.is_finite(), "{found:?}: {a:?} {b:?}");
    let off = (exact(found.value) - exact_term(a, b)).abs();
    assert!(off <= exact(found.error), "{found:?}: {a:?} {b:?}");
    u32::from(!off.is_zero())
}

#[test]
fn planes_and_errors_are_those_of_formulas() {
    // The last edge is the longest one.
    let plane = Plane::new(&[[0.0; 3], [1.0, 1.0, 2.0], [4.0, 0.0, 8.0]].map(DVec3::from_array), 8.0);
    assert_eq!((plane.area, plane.width, plane.z), (-2.0, 4.0, (0.0, 8.0)));
    let small = Plane::new(&[[0.0; 3], [0.25, 0.0, 0.0], [0.0, 0.5, 8.0]].map(DVec3::from_array), 8.0);
    let corners = [[-4.0, -4.0, 1.0], [8.0, -4.0, 1.0], [-4.0, 8.0, 1.0]].map(DVec3::from_array);
    let level = Plane::new(&corners, 8.0);
    assert_eq!(small.area, 0.0625);
    // Clips: 8 * width * 8. Heights: the same times the share of the area.
    for (area, units) in [(0.0625, 128.0), (0.03125, 96.0)] {
        assert_eq!(error([&small, &level], 8.0, area), ERROR * (units * small.width));
    }
    // A slope of 2^923 times 8 * 2^100 is beyond the range; then all heights between 2 and 4 are possible.
    let steep = [[0.0, 0.0, 2.0], [2.0_f64.powi(-922), 0.0, 4.0], [0.0, 1.0, 2.0]].map(DVec3::from_array);
    let vague = Plane::new(&steep, 2.0_f64.powi(100));
    assert!(vague.is_vague && !Plane::new(&steep, 1.0).is_vague);
    assert_eq!(error([&vague, &level], 1.0, 3.0), 6.0 + ERROR * 6.0);
    assert_eq!(error([&level, &vague], 1.0, 3.0), 6.0 + ERROR * 6.0);
    assert_eq!(error([&vague, &vague], 1.0, 3.0), 12.0 + ERROR * 8.0);
}
