//! Tests signs of orientation determinants against exact arithmetic.

use super::*;
use sscc_testing::Dyadic;

/// Returns the sign of an exact number.
fn sign(x: &Dyadic) -> i8 {
    i8::from(x.is_positive()) - i8::from(x.is_negative())
}

/// Returns the sign of the 3 x 3 determinant of differences, in exact arithmetic, by its six products.
fn naive_3d(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> i8 {
    let m = [b, c, d].map(|p| [0, 1, 2].map(|k| Dyadic::new(p[k]) - Dyadic::new(a[k])));
    let product = |i: usize, j: usize, k: usize| &m[0][i] * &m[1][j] * &m[2][k];
    let plus = product(0, 1, 2) + product(1, 2, 0) + product(2, 0, 1);
    let minus = product(2, 1, 0) + product(1, 0, 2) + product(0, 2, 1);
    sign(&(plus - minus))
}

/// Returns the sign of the 2 x 2 determinant of differences, in exact arithmetic.
fn naive_2d(a: DVec2, b: DVec2, c: DVec2) -> i8 {
    let m = [b, c].map(|p| [0, 1].map(|k| Dyadic::new(p[k]) - Dyadic::new(a[k])));
    sign(&(&m[0][0] * &m[1][1] - &m[0][1] * &m[1][0]))
}

/// Returns numbers in `-1..1`, the same in every run.
fn random() -> impl FnMut() -> f64 {
    let mut state = 1_u64;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Denormal numbers, those where `robust` fails, those where the filter fails, ordinary ones, the largest.
const SCALES: [f64; 8] = [1e-322, 1e-300, 1e-110, 1e-87, 1e-72, 1e-3, 1.0, crate::limits::LARGEST];

#[test]
fn signs_follow_the_convention() {
    assert_eq!(orient3d(DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z), 1);
    assert_eq!(orient3d(DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::NEG_Z), -1);
    assert_eq!(orient3d(DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(5.0, 7.0, 0.0)), 0);
    assert_eq!(orient2d(DVec2::ZERO, DVec2::X, DVec2::Y), 1);
    assert_eq!(orient2d(DVec2::ZERO, DVec2::Y, DVec2::X), -1);
    assert_eq!(orient2d(DVec2::ZERO, DVec2::X, DVec2::NEG_X), 0);
}

/// Points are nearly on the plane (or line) through the others, closer to it than the filter can decide.
#[test]
fn signs_are_exact() {
    let mut random = random();
    let mut counts = [0; 3];
    for i in 0..4_000 {
        let scale = SCALES[i % SCALES.len()];
        let mut point = || DVec3::new(random(), random(), random()) * scale;
        let (a, b, c) = (point(), point(), point());
        let (s, t) = (random(), random());
        let mut d = a + ((b - a) * s + (c - a) * t) / 4.0;
        if i % 3 == 0 {
            d.x = d.x.next_up();
        }
        let d = d.clamp(DVec3::splat(-scale), DVec3::splat(scale));
        let sign = orient3d(a, b, c, d);
        assert_eq!(sign, naive_3d(a, b, c, d), "{a:?} {b:?} {c:?} {d:?}");
        counts[(sign + 1) as usize] += 1;

        let (a, b) = (a.truncate(), b.truncate());
        let c = a + (b - a) * (s / 4.0);
        assert_eq!(orient2d(a, b, c), naive_2d(a, b, c), "{a:?} {b:?} {c:?}");
    }
    assert!(counts[0] > 500 && counts[2] > 500, "one-sided: {counts:?}");
}

/// In exact arithmetic the first product is the smaller one. Rounded, its difference of coordinates goes up
/// and those of the second go down, to the two sides of half the smallest denormal number.
#[test]
fn underflow_does_not_deceive_the_planar_filter() {
    let power = |exponent: i32| f64::from_bits(((1023 + exponent) as u64) << 52);
    let a = DVec2::new(-(power(-591) + power(-598)), -(power(-591) - power(-598)));
    let b = DVec2::splat(power(-538));
    let c = DVec2::new(power(-537), power(-537).next_down());
    assert!((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0.0);
    assert_eq!(orient2d(a, b, c), -1);
    assert_eq!(naive_2d(a, b, c), -1);
}

/// Very different numbers cancel, and some are zero.
#[test]
fn signs_are_exact_for_mixed_magnitudes() {
    let mut random = random();
    for _ in 0..1_500 {
        let mut coordinate = || {
            let exponent = (random() * 637.0 - 437.0) as i32;
            // Exponents are -1074 to 200. Powers are computed in two steps, as 2^-1074 is no normal number.
            let half = 2.0_f64.powi(exponent / 2);
            if random() < -0.5 { 0.0 } else { random() * half * 2.0_f64.powi(exponent - exponent / 2) }
        };
        let mut point = || DVec3::new(coordinate(), coordinate(), coordinate());
        let (a, b, c, d) = (point(), point(), point(), point());
        assert_eq!(orient3d(a, b, c, d), naive_3d(a, b, c, d), "{a:?} {b:?} {c:?} {d:?}");
        let [a, b, c] = [a, b, c].map(DVec3::truncate);
        assert_eq!(orient2d(a, b, c), naive_2d(a, b, c), "{a:?} {b:?} {c:?}");
    }
}

#[test]
fn error_bounds_contain_all_products() {
    // Differences (3, 5, 11), (-7, 18, -13) and (17, -19, 23).
    let corners = [DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 7.0, 14.0), DVec3::new(-6.0, 20.0, -10.0)];
    let plane = Plane::through(&corners);
    assert_eq!(plane.magnitude, DVec3::new(263.0, 116.0, 89.0));
    let found = plane.estimate(&DVec3::new(18.0, -17.0, 26.0));
    assert_eq!((found.det, found.error), (-1702.0, RELATIVE_3D * 8722.0 + ABSOLUTE_3D));
    // The computed determinant has the wrong sign.
    let (large, little) = ((1_u64 << 53) as f64, 1.0 / 128.0);
    let a = DVec2::new(-(1.0 + little), -(16.0 + little));
    let (b, c) = (DVec2::new(large, large - 12.0), DVec2::new(large - 2.0, large - 15.0));
    assert!((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0.0);
    assert_eq!((orient2d(a, b, c), naive_2d(a, b, c)), (-1, -1));
}
