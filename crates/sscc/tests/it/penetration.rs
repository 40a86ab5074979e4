//! Compares penetration depths with exact arithmetic, and with the exact test of translated triangles.

use glam::DVec3;
use sscc::parts::penetration_triangle_triangle;
use sscc::{intersect_triangle_triangle, limits};
use sscc_testing::{Dyadic, cases, threshold};

use crate::common::Random;
use crate::common::exact::{Vector, cross, dot, exact, is_zero, minus};

type Triangle = [DVec3; 3];

/// The stated error, relative to the largest difference of coordinates.
const MAX_ERROR: f64 = 1.0 / (1_u64 << 48) as f64;

/// Returns the exact square of the depth, which is the distance of 0 from the boundary of all differences `x - y`, as
/// numerator and denominator.
fn squared_depth(a: &Triangle, b: &Triangle) -> [Dyadic; 2] {
    let (a, b) = (a.map(exact), b.map(exact));
    let edges = |t: &[Vector; 3]| [0, 1, 2].map(|i| minus(&t[(i + 1) % 3], &t[i]));
    let (e, f) = (edges(&a), edges(&b));
    let mut normals = vec![cross(&e[0], &e[1]), cross(&f[0], &f[1])];
    normals.extend(e.iter().flat_map(|e| f.iter().map(|f| cross(e, f))));
    let differences: Vec<Vector> = a.iter().flat_map(|p| b.iter().map(|q| minus(p, q))).collect();
    let squares = normals.iter().filter(|normal| !is_zero(normal)).map(|normal| {
        let along: Vec<Dyadic> = differences.iter().map(|d| dot(normal, d)).collect();
        let (lower, upper) = (along.iter().min().unwrap(), along.iter().max().unwrap());
        let h = upper.clone().min(-lower);
        [&h * &h, dot(normal, normal)]
    });
    let smallest = squares.min_by(|[n, d], [m, e]| (n * e).cmp(&(m * d)));
    smallest.unwrap_or_else(|| [0.0, 1.0].map(Dyadic::new))
}

/// Returns the square root of a quotient, rounded; the square may be outside the range of f64.
fn root(square: &[Dyadic; 2]) -> f64 {
    if square[0].is_zero() {
        return 0.0;
    }
    let [(n, of_n), (d, of_d)] = square.each_ref().map(Dyadic::mantissa_and_exponent);
    let exponent = of_n - of_d;
    // An even power of two is left out of the root.
    let root = (n / d * 2.0_f64.powi(exponent.rem_euclid(2))).sqrt();
    let half = exponent.div_euclid(2);
    root * 2.0_f64.powi(half / 2) * 2.0_f64.powi(half - half / 2)
}

/// Returns the largest difference of coordinates of a corner of one triangle and a corner of the other.
fn size(a: &Triangle, b: &Triangle) -> f64 {
    a.iter().flat_map(|p| b.iter().map(|q| (*p - *q).abs().max_element())).fold(0.0, f64::max)
}

/// Asserts that the depth is the exact one. Returns it, and its error relative to the size.
pub fn check(a: &Triangle, b: &Triangle) -> Option<(f64, f64)> {
    let found = penetration_triangle_triangle(a, b);
    assert_eq!(found.is_some(), intersect_triangle_triangle(a, b));
    let found = found?;
    assert!((found.direction.length() - 1.0).abs() < 4.0 * f64::EPSILON, "{found:?} {a:?} {b:?}");
    let square = squared_depth(a, b);
    let (expected, size) = (root(&square), size(a, b));
    assert_eq!(found.depth == 0.0, square[0].is_zero(), "{found:?} {expected:e} {a:?} {b:?}");
    let error = (found.depth - expected).abs();
    let allowed = expected * 8.0 * f64::EPSILON + size * MAX_ERROR + f64::from_bits(1);
    assert!(error <= allowed, "{found:?} {expected:e}, error {error:e}, allowed {allowed:e}: {a:?} {b:?}");
    let other = penetration_triangle_triangle(b, a).expect("the same two triangles");
    assert!((other.depth - found.depth).abs() <= allowed);
    Some((found.depth, if size > 0.0 { error / size } else { 0.0 }))
}

/// Asserts that b is separate from a if it is moved along the direction by a little more than the depth, and that it is
/// not separate if it is moved along other directions by a little less.
fn check_translations(a: &Triangle, b: &Triangle, random: &mut Random) {
    let Some(found) = penetration_triangle_triangle(a, b) else { return };
    let scale = a.iter().chain(b).map(|p| p.abs().max_element()).fold(0.0, f64::max);
    if scale > limits::LARGEST / 8.0 {
        return;
    }
    let moved = |v: DVec3| b.map(|p| p + v);
    let beyond = found.direction * (found.depth * (1.0 + 1e-9) + scale * 1e-12 + f64::from_bits(4));
    assert!(!intersect_triangle_triangle(a, &moved(beyond)), "{found:?} {a:?} {b:?}");
    // Skips depths for which the rounding of positions matters, including subnormal ones.
    if found.depth < scale * 1e-8 + 1e-316 {
        return;
    }
    for i in 0..30 {
        let near = found.direction + random.vector() * 0.1;
        let dir = if i % 2 == 0 { near } else { random.vector() }.normalize();
        let within = dir * (found.depth * (1.0 - 1e-6));
        assert!(intersect_triangle_triangle(a, &moved(within)), "{found:?} {dir:?} {a:?} {b:?}");
    }
}

#[test]
fn random_pairs() {
    let mut random = Random::new(61);
    let (mut hits, mut worst) = (0, 0.0_f64);
    for _ in 0..cases(4_000) {
        let [a, b] = [(); 2].map(|()| [(); 3].map(|()| random.vector()));
        if let Some((depth, error)) = check(&a, &b) {
            assert!(depth > 0.0);
            hits += 1;
            worst = worst.max(error);
            check_translations(&a, &b, &mut random);
        }
    }
    assert!(hits > threshold(400), "{hits}");
    assert!(worst < 1e-15, "{worst:e}");
}

/// Corners on a coarse grid have parallel edges, touching and degenerate triangles, and common planes.
#[test]
fn on_a_grid() {
    let mut random = Random::new(62);
    let mut count = [0; 2];
    for i in 0..cases(6_000) {
        let size = [1.0, 1.6, 3.0][i % 3];
        let [a, b] = [(); 2].map(|()| [(); 3].map(|()| (random.vector() * size).round()));
        if let Some((depth, _)) = check(&a, &b) {
            count[usize::from(depth > 0.0)] += 1;
            check_translations(&a, &b, &mut random);
        }
    }
    assert!(count.iter().all(|c| *c > threshold(400)), "one-sided: {count:?}");
}

/// The triangles have slivers and nearly parallel planes and edges, at many scales.
#[test]
fn nearly_parallel() {
    let mut random = Random::new(63);
    let (mut hits, mut worst) = (0, 0.0_f64);
    for i in 0..cases(4_000) {
        let thickness = DVec3::new(1.0, random.power(-20.0, 0.0), random.power(-20.0, 0.0));
        let scale = [1.0, 1e-300, 2.0_f64.powi(-1060), 1e58][i % 4];
        let [a, b] = [(); 2].map(|()| [(); 3].map(|()| random.vector() * thickness * scale));
        if let Some((_, error)) = check(&a, &b) {
            hits += 1;
            // Denormal numbers have fewer digits.
            worst = if i % 4 == 2 { worst } else { worst.max(error) };
            check_translations(&a, &b, &mut random);
        }
    }
    assert!(hits > threshold(400), "{hits}");
    assert!(worst < MAX_ERROR, "{worst:e}");
}
