//! Compares the common points of two triangles with exact arithmetic. The cases are those of `intersect.rs`, which calls
//! [`check`] for each.

use glam::DVec3;
use sscc::intersect_triangle_triangle;
use sscc::parts::{Aabb, Feature, Intersection, IntersectionPoint, intersection_triangle_triangle};
use sscc_testing::Dyadic;

use crate::common::Random;
use crate::common::exact::{Point, Vector, are_opposite, common_corners, cross, dot, exact, is_zero, minus};

type Triangle = [DVec3; 3];

/// Asserts that the common points of two triangles are those of exact arithmetic.
pub fn check(a: &Triangle, b: &Triangle) {
    let found = intersection_triangle_triangle(a, b);
    assert_eq!(found.is_some(), intersect_triangle_triangle(a, b), "{a:?} {b:?}");
    assert_symmetric(a, b, found.as_ref());
    let Some(found) = found else { return };
    let mut corners: Vec<Point> = found.points().iter().map(|point| check_point(a, b, point)).collect();
    match &found {
        Intersection::Polygon(_) => assert_convex(&corners),
        _ => assert!(corners.len() <= 2),
    }
    corners.sort();
    assert_eq!(corners, common_corners(&a.map(exact), &b.map(exact)), "{a:?} {b:?}");
}

/// Asserts that the points are the same, bit for bit, for other orders of the triangles and of their corners.
fn assert_symmetric(a: &Triangle, b: &Triangle, found: Option<&Intersection>) {
    let sorted = |found: Option<&Intersection>| {
        let mut points: Vec<_> =
            found.map(|x| x.points().iter().map(|p| p.position.to_array()).collect()).unwrap_or_default();
        points.sort_by(|p: &[f64; 3], q| p.partial_cmp(q).unwrap());
        points
    };
    let turned = [a[1], a[0], a[2]];
    for other in [intersection_triangle_triangle(b, a), intersection_triangle_triangle(&turned, b)] {
        assert_eq!(sorted(found), sorted(other.as_ref()), "{a:?} {b:?}");
    }
}

/// Asserts that a point is the only common point of its features, and rounded within the stated bound. Returns the exact point.
fn check_point(a: &Triangle, b: &Triangle, point: &IntersectionPoint) -> Point {
    let triangles = [a, b];
    let hulls = [0, 1].map(|side| feature_corners(triangles[side], point.features[side]));
    let x = common_point(&hulls[0], &hulls[1]);
    for hull in &hulls {
        assert_is_inside(hull, &x);
    }
    let position = point.position;
    let edges = hulls.iter().filter(|hull| hull.len() == 2).map(|hull| (hull[1] - hull[0]).abs());
    let is_vertex = hulls.iter().any(|hull| hull.len() == 1);
    let shortest = edges.min_by(|e, f| e.length_squared().total_cmp(&f.length_squared()));
    let Some(edge) = shortest.filter(|_| !is_vertex) else {
        assert_eq!(Point::from(&exact(position)), x);
        return x;
    };
    let u = Dyadic::new(f64::EPSILON / 2.0);
    for (k, error) in weighted_errors(position, &x).into_iter().enumerate() {
        let [size, edge] = [position[k].abs(), edge[k]].map(Dyadic::new);
        let bound = &u * size + &u * edge * Dyadic::new(3.0) + Dyadic::new(f64::from_bits(1));
        assert!(error <= bound * &x.weight, "{point:?} {a:?} {b:?}");
    }
    for hull in hulls {
        let aabb = Aabb::of_points(hull);
        assert!(!aabb.is_disjoint(&Aabb { lower: position, upper: position }), "{point:?}");
    }
    x
}

/// Returns the errors of rounded coordinates, times the weight of the exact point.
fn weighted_errors(position: DVec3, x: &Point) -> [Dyadic; 3] {
    std::array::from_fn(|k| (Dyadic::new(position[k]) * &x.weight - &x.vector[k]).abs())
}

fn feature_corners(triangle: &Triangle, feature: Feature) -> Vec<DVec3> {
    match feature {
        Feature::Vertex(i) => vec![triangle[usize::from(i)]],
        Feature::Edge(i) => vec![triangle[usize::from(i)], triangle[(usize::from(i) + 1) % 3]],
        Feature::Face => triangle.to_vec(),
    }
}

/// Returns the common point of the affine hulls of two features.
fn common_point(a: &[DVec3], b: &[DVec3]) -> Point {
    let [a, b] = [a, b].map(|hull| hull.iter().map(|p| exact(*p)).collect::<Vec<_>>());
    match (a.as_slice(), b.as_slice()) {
        ([x], _) | (_, [x]) => x.into(),
        ([p, q], [o, r, s]) | ([o, r, s], [p, q]) => {
            let normal = cross(&minus(r, o), &minus(s, o));
            let [d_p, d_q] = [p, q].map(|x| dot(&normal, &minus(x, o)));
            Point::mean(p, q, [-d_q, d_p])
        }
        ([p, q], [r, s]) => {
            // `(r - p) x (s - r) = t (q - p) x (s - r)`.
            let (left, right) = (cross(&minus(r, p), &minus(s, r)), cross(&minus(q, p), &minus(s, r)));
            let k = (0..3).find(|&k| !right[k].is_zero()).expect("edges that cross are not parallel");
            Point::mean(p, q, [&right[k] - &left[k], left[k].clone()])
        }
        _ => panic!("two faces have no corner in common"),
    }
}

/// Asserts that x is in the relative interior of the hull.
fn assert_is_inside(hull: &[DVec3], x: &Point) {
    let hull: Vec<Vector> = hull.iter().map(|p| exact(*p)).collect();
    let offsets: Vec<Vector> = hull.iter().map(|p| x.to(&p.into())).collect();
    match (hull.as_slice(), offsets.as_slice()) {
        (_, [p]) => assert!(is_zero(p)),
        (_, [p, q]) => assert!(are_opposite(p, q)),
        ([p, q, r], [from_p, from_q, from_r]) => {
            let normal = cross(&minus(q, p), &minus(r, p));
            assert!(dot(&normal, from_p).is_zero());
            for (p, q) in [(from_p, from_q), (from_q, from_r), (from_r, from_p)] {
                assert!(dot(&normal, &cross(p, q)).is_positive());
            }
        }
        _ => unreachable!(),
    }
}

/// Asserts that the corners, in this order, form a convex polygon.
fn assert_convex(corners: &[Point]) {
    let turn = |i: usize| {
        let [p, q, r] = [0, 1, 2].map(|k| &corners[(i + k) % corners.len()]);
        cross(&p.to(q), &q.to(r))
    };
    assert!((3..=6).contains(&corners.len()));
    for i in 0..corners.len() {
        assert!(dot(&turn(0), &turn(i)).is_positive(), "{corners:?}");
    }
}

/// Edges are nearly parallel to the face that they cross: t is computed from distances that cancel in naive arithmetic.
#[test]
fn nearly_parallel() {
    let mut random = Random::new(51);
    let mut crossings = 0;
    for i in 0..sscc_testing::cases(1_000) {
        let tilt = 2.0_f64.powi(-(i % 60));
        let offset = random.vector() * 10.0;
        // Some corners are in a plane up to rounding errors, the others are as close to it on both sides.
        let (e, f) = (random.vector(), random.vector());
        let point = |s: f64, t: f64, lift: DVec3| offset + e * s + f * t + lift * tilt;
        let a =
            [point(-3.0, -3.0, DVec3::ZERO), point(5.0, -2.0, DVec3::ZERO), point(-1.0, 6.0, DVec3::ZERO)];
        let mut lift = |sign: f64| random.vector().abs() * sign;
        let (up, down, up_again) = (lift(1.0), lift(-1.0), lift(1.0));
        let b = [point(0.1, 0.2, up), point(1.0, 0.3, down), point(0.4, 1.2, up_again)];
        check(&a, &b);
        let found = intersection_triangle_triangle(&a, &b);
        for point in found.iter().flat_map(Intersection::points) {
            let hulls = [feature_corners(&a, point.features[0]), feature_corners(&b, point.features[1])];
            let x = common_point(&hulls[0], &hulls[1]);
            let bound = Dyadic::new((offset.abs().max_element() + 10.0) * f64::EPSILON) * &x.weight;
            assert!(weighted_errors(point.position, &x).iter().all(|error| *error < bound), "{point:?}");
            crossings += 1;
        }
    }
    assert!(crossings > sscc_testing::threshold(800), "{crossings}");
}

/// Determinants are 1 and 2, and their products have about 140 bits: with 106 bits all digits would be lost.
#[test]
fn determinants_that_cancel() {
    let mut random = Random::new(52);
    let mut lost = 0;
    for _ in 0..sscc_testing::cases(400) {
        // Rows of determinant 1.
        let mut rows = [DVec3::X, DVec3::Y, DVec3::Z];
        for _ in 0..40 {
            let (i, step) = (random.below(3), 1 + random.below(2));
            let next = rows[i] + rows[(i + step) % 3] * (random.signed() * 300.0).round();
            if next.abs().max_element() < 2.0_f64.powi(48) {
                rows[i] = next;
            }
        }
        let [r, s, p] = rows;
        // `q = r + s - 2 p`: the edge from p to q meets the face `0, r, s` at `(r + s) / 3`.
        let (a, b) = ([DVec3::ZERO, r, s], [p, r + s - p * 2.0, p + random.vector().round()]);
        check(&a, &b);
        let crossing = [Feature::Face, Feature::Edge(0)];
        let found = intersection_triangle_triangle(&a, &b).expect("they cross");
        assert!(found.points().iter().any(|point| point.features == crossing));
        let products: f64 = rows.iter().map(|row| row.abs().max_element()).product();
        lost += usize::from(products > 2.0_f64.powi(120));
    }
    assert!(lost > sscc_testing::threshold(200), "{lost}");
}
