//! At the documented limits of coordinates the answers are those of the same shapes at a smaller size. The factor is a power of
//! two, which changes no digit.

use glam::{DMat3, DVec3};
use num_traits::ToPrimitive;
use sscc::parts::{
    Aabb, Intersection, Pose, PosedShape, Scope, SweptShape, contact_curves, impact_edge_edge,
    impact_vertex_face, intersect_shared_vertex_pair, intersection_triangle_triangle,
    penetration_triangle_triangle,
};
use sscc::{
    AuditOptions, Certificates, CertifyOptions, ContactFilter, Detector, Impact, KineticQuery, Method, Modes,
    MovingTriangle, Neighbours, Query, ReducedModel, ResolveOptions, TriMesh, audit,
    impact_triangle_triangle, intersect_triangle_triangle, limits,
};
use sscc_testing::{cases, distance, first_contact, threshold};

use crate::common::Random;

/// Returns a random point in the cube from -1 to 1: at a corner of it, on a grid, or anywhere.
fn point(random: &mut Random) -> DVec3 {
    let x = random.vector();
    match random.below(3) {
        0 => x.signum(),
        1 => (x * 4.0).round() / 4.0,
        _ => x,
    }
}

fn triangle(random: &mut Random) -> [DVec3; 3] {
    let mut p = [(); 3].map(|()| point(random));
    match random.below(5) {
        // A sliver, and a triangle near a corner of the cube.
        0 => p[2] = p[0].lerp(p[1], 0.5),
        1 => p = p.map(|x| p[0].signum() - (x - p[0].signum()) * 1e-9),
        _ => {}
    }
    p.map(|x| x.clamp(DVec3::NEG_ONE, DVec3::ONE))
}

fn large(p: DVec3) -> DVec3 {
    p * limits::LARGEST
}

/// Returns a moving triangle with corners at far ends of the cube, whose differences are up to twice as large as coordinates.
fn moving(random: &mut Random) -> MovingTriangle {
    MovingTriangle { t0: triangle(random), t1: triangle(random) }
}

fn large_moving(x: &MovingTriangle) -> MovingTriangle {
    MovingTriangle { t0: x.t0.map(large), t1: x.t1.map(large) }
}

#[test]
fn triangles_meet_as_smaller_ones_do() {
    let random = &mut Random::new(1);
    let (mut met, mut apart) = (0, 0);
    for case in 0..cases(4000) {
        let (a, b) = (triangle(random), triangle(random));
        let (x, y) = (a.map(large), b.map(large));
        let meet = intersect_triangle_triangle(&a, &b);
        assert_eq!(intersect_triangle_triangle(&x, &y), meet, "case {case}");
        let of_vertex =
            |a: [DVec3; 3], b: [DVec3; 3]| intersect_shared_vertex_pair(a[0], [a[1], a[2]], [b[1], b[2]]);
        assert_eq!(of_vertex(x, y), of_vertex(a, b), "case {case}");
        let corners = |intersection: Option<Intersection>, scale: f64| {
            let points = intersection.map(|all| all.points().to_vec()).unwrap_or_default();
            points.iter().map(|p| (p.position * scale, p.features)).collect::<Vec<_>>()
        };
        let expected = corners(intersection_triangle_triangle(&a, &b), limits::LARGEST);
        assert_eq!(corners(intersection_triangle_triangle(&x, &y), 1.0), expected, "case {case}");
        // Depths that underflow at the small size cannot be compared.
        let penetration =
            penetration_triangle_triangle(&a, &b).filter(|p| p.depth > 1e-300 || p.depth == 0.0);
        if let Some(small) = penetration {
            let found = penetration_triangle_triangle(&x, &y).unwrap();
            assert_eq!(found.depth, small.depth * limits::LARGEST, "case {case}");
            assert_eq!(found.direction, small.direction, "case {case}");
        }
        met += usize::from(meet);
        apart += usize::from(!meet);
    }
    assert!(met > threshold(500) && apart > threshold(500), "{met} {apart}");
}

/// Checks that a time is not later than the first contact, and that the distance at this time is within the tolerance, relative
/// to the size.
fn check_time(a: &MovingTriangle, b: &MovingTriangle, found: Option<f64>, size: f64, label: &str) {
    if let Some(t) = found {
        let allowed = size * (Impact::TOLERANCE + 1e-15);
        assert!(distance(a, b, t) <= allowed, "{label}: {t}");
    }
}

#[test]
fn moving_triangles_meet_as_smaller_ones_do() {
    let random = &mut Random::new(2);
    let (mut met, mut apart) = (0, 0);
    for case in 0..cases(800) {
        let (a, mut b) = (moving(random), moving(random));
        if case % 2 == 0 {
            // The motions end on a face, or pass it at a small distance.
            let end = a.t1[0].lerp(a.t1[1], 0.25);
            let gap = DVec3::splat([0.0, 1e-9, -1e-13][case / 2 % 3]);
            b.t1[0] = (end + gap).clamp(DVec3::NEG_ONE, DVec3::ONE);
        }
        let label = format!("case {case}");
        let (x, y) = (large_moving(&a), large_moving(&b));
        let small = impact_triangle_triangle(&a, &b, Impact::TOLERANCE);
        let found = impact_triangle_triangle(&x, &y, Impact::TOLERANCE);
        assert_eq!(found.is_some(), small.is_some(), "{label}");
        check_time(&a, &b, found, 2.0, &label);
        if case < 16
            && let Some(contact) = first_contact(&a, &b)
        {
            let upper = contact.upper().to_f64().unwrap();
            assert!(found.is_some_and(|t| t <= upper), "{label}: {found:?}, met at {upper}");
        }
        met += usize::from(found.is_some());
        apart += usize::from(found.is_none());
        let vertex = |x: &MovingTriangle, y| impact_vertex_face([x.t0[0], x.t1[0]], y, Impact::TOLERANCE);
        assert_eq!(vertex(&x, &y).is_some(), vertex(&a, &b).is_some(), "{label}");
        let edge = |x: &MovingTriangle| [[x.t0[0], x.t0[1]], [x.t1[0], x.t1[1]]];
        let edges = |x, y| impact_edge_edge(edge(x), edge(y), Impact::TOLERANCE).is_some();
        assert_eq!(edges(&x, &y), edges(&a, &b), "{label}");
    }
    assert!(met > threshold(100) && apart > threshold(50), "{met} {apart}");
}

/// Corners are at opposite ends of the range, also if one triangle passes through the other.
#[test]
fn corners_may_be_anywhere_in_the_range() {
    let far = limits::LARGEST;
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * far;
    let floor = [at(-1.0, -1.0, -1.0), at(1.0, -1.0, -1.0), at(0.0, 1.0, -1.0)];
    let roof = floor.map(|p| DVec3::new(p.x, p.y, far));
    let still = MovingTriangle { t0: floor, t1: floor };
    let falling = MovingTriangle { t0: roof, t1: floor };
    let rising = MovingTriangle { t0: floor, t1: roof };
    assert_eq!(impact_triangle_triangle(&still, &MovingTriangle { t0: roof, t1: roof }, 1e-9), None);
    for (a, b, time) in [(&still, &falling, 1.0), (&falling, &rising, 0.5), (&still, &rising, 0.0)] {
        let t = impact_triangle_triangle(a, b, Impact::TOLERANCE).unwrap();
        assert!(t <= time && t >= time - 1e-11, "{t} {time}");
    }
}

/// Returns loose triangles on a grid, separate at rest, and two modes: all vertices stay within the cube for q of at most 1.
fn model(scale: f64, random: &mut Random) -> ReducedModel {
    let (mut positions, mut modes) = (Vec::new(), Vec::new());
    for i in 0..64 {
        let center = (DVec3::new(f64::from(i % 4), f64::from(i / 4 % 4), f64::from(i / 16)) - 1.5) * 0.2;
        let shift = random.vector() * 0.3;
        for _ in 0..3 {
            let p = center + random.vector() * 0.07;
            positions.push(p * scale);
            modes.extend([shift * scale, DVec3::new(p.y, -p.z, p.x * p.y) * 0.3 * scale]);
        }
    }
    let modes = Modes::new(2, modes).unwrap();
    let faces = (0..64).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    ReducedModel::new(TriMesh::new(positions, faces).unwrap(), modes).unwrap()
}

fn pairs(impacts: &[Impact]) -> Vec<sscc::Pair> {
    impacts.iter().map(|impact| impact.pair).collect()
}

/// Compares queries of all kinds on a model at the limit with those on the same model at size 1.
#[test]
fn queries_at_the_limit_have_the_answers_of_a_smaller_model() {
    let (mut colliding, mut impacts) = (0, 0);
    for case in 0..6 {
        let models = [1.0, limits::LARGEST].map(|scale| model(scale, &mut Random::new(case)));
        let options = CertifyOptions::default().filter(ContactFilter::new(Neighbours::IncludeOneVertex));
        let certificates =
            models.each_ref().map(|model| Certificates::compute(model, &options, &()).unwrap());
        for (model, certificates) in models.iter().zip(&certificates) {
            let report = audit(model, certificates, &AuditOptions::default().samples(200), &());
            assert!(report.is_ok());
        }
        let random = &mut Random::new(case + 100);
        let mut q: Vec<[f64; 2]> = (0..12).map(|_| [random.signed(), random.signed()]).collect();
        q.extend((0..20).map(|i| [0.5 + 1e-3 * f64::from(i), 0.3]));
        let mut kinetic = [0, 1].map(|i| KineticQuery::new(&models[i], &certificates[i]).unwrap());
        for method in [Method::Certified, Method::BdTree, Method::Traditional, Method::BruteForce] {
            let mut queries =
                [0, 1].map(|i| Query::with_method(&models[i], &certificates[i], method).unwrap());
            for step in q.windows(2) {
                let [small, found] =
                    queries.each_mut().map(|query| query.discrete(&step[0]).unwrap().to_vec());
                assert_eq!(found, small, "{method:?}");
                colliding += found.len();
                let [small, found] =
                    queries.each_mut().map(|query| query.continuous(&step[0], &step[1]).unwrap().to_vec());
                assert_eq!(pairs(&found), pairs(&small), "{method:?}");
                assert!(found.iter().zip(&small).all(|(x, y)| (x.time - y.time).abs() < 1e-6));
                impacts += found.len();
                if method == Method::Certified {
                    let [small, found] =
                        kinetic.each_mut().map(|query| query.discrete(&step[0]).unwrap().to_vec());
                    assert_eq!(found, small);
                    let [small, found] =
                        kinetic.each_mut().map(|query| pairs(query.continuous(&step[0], &step[1]).unwrap()));
                    assert_eq!(found, small);
                    let [small, found] = queries.each_mut().map(|query| query.safe_scale(&step[0]).unwrap());
                    // The scale at the limit is bounded by the range of coordinates.
                    assert!(found <= 1.01 * small && (found > 0.0) == (small > 0.0), "{found} {small}");
                    let [small, found] =
                        queries.each_mut().map(|query| query.sweep(&step[0], 0, 1.0).unwrap());
                    assert_eq!(found.outcome, small.outcome);
                    assert_eq!(found.first_hit.is_some(), small.first_hit.is_some());
                }
            }
            for query in &mut queries {
                assert_eq!(query.batch(&q, None, &()).unwrap().len(), q.len());
                // Whether there is a free configuration depends on the centre; the call must not panic.
                let _ = query.resolve(&q[0], &ResolveOptions::default());
            }
        }
        let scope = Scope::of(&models[1]);
        assert!(
            Query::without_certificates(&models[1], scope, Method::NormalCones)
                .unwrap()
                .discrete(&q[0])
                .is_ok()
        );
        // Given positions, and the curves in which they intersect.
        let [small, found] = models.each_ref().map(|model| {
            let [x_t0, x_t1] = [q[0], q[1]].map(|q| model.positions(&q).unwrap());
            let mut detector = Detector::new(model.mesh());
            let found = detector.discrete(&x_t0).unwrap().to_vec();
            let curves = contact_curves(model.mesh().faces(), &x_t0, &found).unwrap();
            (found, pairs(detector.continuous(&x_t0, &x_t1).unwrap()), curves.curves.len())
        });
        assert_eq!(found, small);
    }
    assert!(colliding > 300 && impacts > 300, "{colliding} {impacts}");
}

/// The shapes in the world are half as large as the range, and at its ends.
#[test]
fn posed_shapes_at_the_limit_have_the_answers_of_smaller_ones() {
    let mut met = 0;
    for case in 0..8 {
        let [small, found] = [1.0, limits::LARGEST].map(|scale| {
            let model = model(scale / 8.0, &mut Random::new(case));
            let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
            let random = &mut Random::new(case + 50);
            let pose = |random: &mut Random| Pose {
                rotation: DMat3::from_axis_angle(DVec3::Z, 3.0 * random.signed()),
                translation: (random.vector() * 0.02 + DVec3::splat(0.6)) * scale,
            };
            let mut shapes = [(); 2].map(|()| PosedShape::new(&model, &certificates).unwrap());
            let mut swept = shapes.each_ref().map(|shape| SweptShape::new(shape).unwrap());
            for (shape, swept) in shapes.iter_mut().zip(&mut swept) {
                let (q, r) = ([random.signed(), random.signed()], [random.signed(), random.signed()]);
                let (from, to) = (pose(random), pose(random));
                shape.place(&q, &from).unwrap();
                swept.place([&q, &r], [&from, &to]).unwrap();
            }
            let around = Aabb { lower: DVec3::splat(-scale), upper: DVec3::splat(scale) };
            let ([x, y], [v, w]) = (&mut shapes, &mut swept);
            let (mut colliding, mut impacts, mut near) = (Vec::new(), Vec::new(), Vec::new());
            x.colliding(y, around, &mut colliding).unwrap();
            v.impacts(w, around, &mut impacts).unwrap();
            v.near(w, around, 0.01 * scale, usize::MAX, &mut near).unwrap();
            assert!(pairs(&impacts).iter().all(|pair| near.contains(pair)));
            (colliding, pairs(&impacts))
        });
        assert_eq!(found, small, "case {case}");
        met += found.0.len() + found.1.len();
    }
    assert!(met > 20, "{met}");
}
