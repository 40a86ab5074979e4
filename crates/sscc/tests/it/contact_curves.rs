//! Tests of the curves in which meshes intersect themselves or each other.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use glam::{DQuat, DVec3};
use sscc::parts::{
    Aabb, ContactCurves, Intersection, MeshFeature, Surface, contact_curves, contact_curves_between,
};
use sscc::{Error, Pair, intersect_triangle_triangle};
use sscc_testing::cases;

use crate::common::{Random, Soup, random_mesh};

fn corners((positions, faces): &Soup, triangle: usize) -> [DVec3; 3] {
    faces[triangle].map(|i| positions[i as usize])
}

/// Returns all pairs that intersect, of one mesh or of two. For one mesh, only those without a common vertex, unless `all`.
fn pairs(x: &Soup, y: Option<&Soup>, all: bool) -> Vec<Pair> {
    let other = y.unwrap_or(x);
    let boxes: Vec<Aabb> = (0..other.1.len()).map(|t| Aabb::of_points(corners(other, t))).collect();
    let mut pairs = Vec::new();
    for s in 0..x.1.len() {
        let (a, aabb) = (corners(x, s), Aabb::of_points(corners(x, s)));
        for t in if y.is_some() { 0 } else { s + 1 }..other.1.len() {
            let is_adjacent = y.is_none() && x.1[s].iter().any(|i| x.1[t].contains(i));
            if !aabb.is_disjoint(&boxes[t])
                && (all || !is_adjacent)
                && intersect_triangle_triangle(&a, &corners(other, t))
            {
                pairs.push((s as u32, t as u32));
            }
        }
    }
    pairs
}

fn curves_between(x: &Soup, y: &Soup) -> ContactCurves {
    let surface = |soup: &Soup| (soup.1.clone(), soup.0.clone());
    let ((faces_x, positions_x), (faces_y, positions_y)) = (surface(x), surface(y));
    let x_surface = Surface { faces: &faces_x, positions: &positions_x };
    let y_surface = Surface { faces: &faces_y, positions: &positions_y };
    let found = contact_curves_between(x_surface, y_surface, &pairs(x, Some(y), false)).unwrap();
    check(&found);

    // Joined to one mesh, the two meshes have the same curves.
    let count = (positions_x.len() as u32, faces_x.len() as u32);
    let positions = [positions_x, positions_y].concat();
    let faces = [faces_x, faces_y.into_iter().map(|face| face.map(|i| i + count.0)).collect()].concat();
    let pairs: Vec<Pair> = pairs(x, Some(y), false).iter().map(|(s, t)| (*s, t + count.1)).collect();
    let joined = contact_curves(&faces, &positions, &pairs).unwrap();
    let summary = |found: &ContactCurves| {
        let curves = found.curves.iter();
        curves.map(|curve| (curve.is_closed, curve.points.len(), curve.contacts.len())).collect::<Vec<_>>()
    };
    assert_eq!(summary(&found), summary(&joined));
    found
}

/// Asserts properties of the curves of any input: they consist of the segments of their contacts, bit for bit; every segment
/// is on exactly one curve; a curve passes through every point with two segments.
fn check(found: &ContactCurves) {
    let key = |p: DVec3| (p + DVec3::ZERO).to_array().map(f64::to_bits);
    let mut segments_at: BTreeMap<[MeshFeature; 2], usize> = BTreeMap::new();
    let mut on_curves = BTreeMap::new();
    for curve in &found.curves {
        assert_eq!(curve.points.len(), curve.contacts.len() + usize::from(!curve.is_closed));
        for (i, &contact) in curve.contacts.iter().enumerate() {
            let ends = [i, (i + 1) % curve.points.len()].map(|i| curve.points[i]);
            let Intersection::Segment(segment) = &found.contacts[contact as usize].intersection else {
                panic!("a curve of something else");
            };
            let mut positions = ends.map(|end| key(end.position));
            let mut expected = segment.each_ref().map(|end| key(end.position));
            positions.sort_unstable();
            expected.sort_unstable();
            assert_eq!(positions, expected);
            ends.iter().for_each(|end| *segments_at.entry(end.features).or_default() += 1);
            assert!(on_curves.insert(positions, contact).is_none(), "a segment on two curves");
        }
    }
    assert!(found.curves.is_sorted_by_key(|curve| curve.contacts.iter().min()));
    for curve in found.curves.iter().filter(|curve| !curve.is_closed) {
        let ends = [curve.points[0].features, curve.points[curve.points.len() - 1].features];
        assert!(ends.iter().all(|end| segments_at[end] != 2), "a curve that could go on");
    }
    for (i, contact) in found.contacts.iter().enumerate() {
        let number = i as u32;
        match &contact.intersection {
            Intersection::Point(_) => assert!(found.points.contains(&number)),
            Intersection::Polygon(_) => assert!(found.polygons.contains(&number)),
            Intersection::Segment(segment) => {
                let mut positions = segment.each_ref().map(|end| key(end.position));
                positions.sort_unstable();
                assert!(on_curves[&positions] <= number);
            }
        }
        assert!(contact.depth >= 0.0 && (contact.direction.length() - 1.0).abs() < 1e-15);
    }
}

/// Asserts that all contacts are segments, that all curves are closed, and that each contact is on one curve, once.
fn check_transversal(found: &ContactCurves) {
    assert!(found.points.is_empty() && found.polygons.is_empty());
    assert!(found.curves.iter().all(|curve| curve.is_closed));
    let mut contacts: Vec<u32> =
        found.curves.iter().flat_map(|curve| curve.contacts.iter().copied()).collect();
    contacts.sort_unstable();
    assert!(contacts.into_iter().eq(0..found.contacts.len() as u32));
}

/// Returns an octahedron, subdivided and projected to a sphere.
fn sphere(center: DVec3, radius: f64, levels: usize) -> Soup {
    let mut positions = vec![DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::NEG_Z];
    let mut faces =
        vec![[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
    for _ in 0..levels {
        let mut middles = BTreeMap::new();
        let mut middle = |i: u32, j: u32| {
            *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                positions.push((positions[i as usize] + positions[j as usize]).normalize());
                positions.len() as u32 - 1
            })
        };
        faces = faces
            .into_iter()
            .flat_map(|[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    let turn = DQuat::from_scaled_axis(DVec3::new(0.3, 0.5, 0.7));
    (positions.into_iter().map(|p| center + turn * p * radius).collect(), faces)
}

/// Returns a closed tube of a radius about a closed curve, given for 0 to 1, near the plane of x and y.
fn tube(center: impl Fn(f64) -> DVec3, radius: f64, along: u32, around: u32) -> Soup {
    let mut positions = Vec::new();
    for i in 0..along {
        let s = f64::from(i) / f64::from(along);
        let tangent = (center(s + 1e-4) - center(s - 1e-4)).normalize();
        let side = DVec3::Z.cross(tangent).normalize();
        let up = tangent.cross(side);
        for j in 0..around {
            let (sin, cos) = ((f64::from(j) + 0.3) / f64::from(around) * TAU).sin_cos();
            positions.push(center(s) + (side * cos + up * sin) * radius);
        }
    }
    (positions, grid_faces(along, around))
}

/// Returns the faces of a torus of vertices `i * n + j`.
fn grid_faces(m: u32, n: u32) -> Vec<[u32; 3]> {
    let vertex = |i: u32, j: u32| i % m * n + j % n;
    let quad = |i: u32, j: u32| {
        let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    (0..m).flat_map(|i| (0..n).flat_map(move |j| quad(i, j))).collect()
}

fn circle(center: DVec3, radius: f64) -> impl Fn(f64) -> DVec3 {
    move |s| center + DVec3::new((s * TAU).cos(), (s * TAU).sin(), 0.0) * radius
}

#[test]
fn two_spheres_meet_in_one_closed_curve() {
    for levels in 1..5 {
        let offset = DVec3::new(0.7, 0.31, 0.123);
        let found = curves_between(&sphere(DVec3::ZERO, 1.0, levels), &sphere(offset, 0.9, levels));
        check_transversal(&found);
        assert_eq!(found.curves.len(), 1);
        // Points of the curve are on both spheres, up to the size of the triangles.
        let tolerance = 0.25_f64.powi(levels as i32);
        for p in &found.curves[0].points {
            assert!((p.position.length() - 1.0).abs() < tolerance);
            assert!((p.position.distance(offset) - 0.9).abs() < tolerance);
        }
    }
}

#[test]
fn torus_through_a_sphere_and_a_torus() {
    let torus = tube(circle(DVec3::ZERO, 1.0), 0.2, 48, 16);
    let found = curves_between(&torus, &sphere(DVec3::new(1.01, 0.02, 0.03), 0.4, 3));
    check_transversal(&found);
    assert_eq!(found.curves.len(), 2);
    // Two tubes near one plane, rotated and moved, cross twice.
    let turn = DQuat::from_scaled_axis(DVec3::new(0.02, 0.03, 0.5));
    let (positions, faces) = tube(circle(DVec3::ZERO, 1.0), 0.15, 50, 17);
    let moved = positions.iter().map(|p| turn * *p + DVec3::new(0.9, 0.11, 0.013)).collect();
    let found = curves_between(&torus, &(moved, faces));
    check_transversal(&found);
    assert_eq!(found.curves.len(), 4);
}

/// The tube is along a curve that crosses itself at the origin, where its two strands are a little apart.
#[test]
fn tube_that_intersects_itself() {
    for lift in [0.005, 0.05, 0.1] {
        let center = |s: f64| {
            let (sin, cos) = (s * TAU).sin_cos();
            DVec3::new(cos, sin, 0.0) * (0.6 + 1.2 * cos) + DVec3::Z * (lift * sin)
        };
        let tube = tube(center, 0.12, 120, 14);
        let pairs = pairs(&tube, None, false);
        let found = contact_curves(&tube.1, &tube.0, &pairs).unwrap();
        check(&found);
        check_transversal(&found);
        assert!(pairs.len() > 30 && !found.curves.is_empty() && found.contacts.len() == pairs.len());
    }
}

/// Returns a closed cube of n x n squares on each side, whose coordinates are multiples of 2 / n.
fn cube(n: u32, offset: DVec3) -> Soup {
    let mut vertices: BTreeMap<[u32; 3], u32> = BTreeMap::new();
    let mut positions = Vec::new();
    let mut faces = Vec::new();
    for axis in 0..3 {
        for level in [0, n] {
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let mut vertex = |i: u32, j: u32| {
                    let mut at = [0; 3];
                    (at[axis], at[(axis + 1) % 3], at[(axis + 2) % 3]) = (level, i, j);
                    *vertices.entry(at).or_insert_with(|| {
                        positions
                            .push(DVec3::from_array(at.map(|k| f64::from(k) * 2.0 / f64::from(n))) + offset);
                        positions.len() as u32 - 1
                    })
                };
                let [a, b, c, d] = [vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)];
                faces.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    (positions, faces)
}

/// The edges and vertices of two cubes lie on each other's faces, edges and vertices; they meet in one closed curve.
#[test]
fn cubes_on_one_grid_meet_in_one_closed_curve() {
    for (n, m) in [(1, 1), (2, 2), (4, 4), (2, 4), (4, 2), (1, 4), (3, 5), (3, 2), (6, 4)] {
        let found = curves_between(&cube(n, DVec3::ZERO), &cube(m, DVec3::ONE));
        let lengths: Vec<f64> = found
            .curves
            .iter()
            .map(|curve| {
                let next = curve.points.iter().cycle().skip(1);
                curve.points.iter().zip(next).map(|(p, q)| p.position.distance(q.position)).sum()
            })
            .collect();
        assert!(found.curves.iter().all(|curve| curve.is_closed), "{n} {m}");
        assert!(lengths.len() == 1 && (lengths[0] - 6.0).abs() < 1e-12, "{n} {m}: {lengths:?}");
    }
}

#[test]
fn sheets_that_cross_meet_in_one_open_curve() {
    let sheet = |n: u32, p: &dyn Fn(f64, f64) -> DVec3| -> Soup {
        let positions = (0..=n).flat_map(|i| (0..=n).map(move |j| (i, j)));
        let positions =
            positions.map(|(i, j)| p(f64::from(i) / f64::from(n), f64::from(j) / f64::from(n))).collect();
        let faces = grid_faces(n + 1, n + 1);
        // Removes the quads that wrap around.
        let wraps =
            |i: &usize| i / 2 % (n as usize + 1) == n as usize || i / 2 / (n as usize + 1) == n as usize;
        (positions, (0..faces.len()).filter(|i| !wraps(i)).map(|i| faces[i]).collect())
    };
    let flat = sheet(8, &|s, t| DVec3::new(s, t, 0.0));
    let upright = sheet(7, &|s, t| DVec3::new(0.1 + 0.8 * s, 0.2 + 0.53 * s, t - 0.51));
    let found = curves_between(&flat, &upright);
    assert_eq!(found.curves.len(), 1);
    assert!(!found.curves[0].is_closed);
    let ends = [found.curves[0].points[0].position, found.curves[0].points.last().unwrap().position];
    assert!((ends[0].distance(ends[1]) - 0.8_f64.hypot(0.53)).abs() < 1e-12);
}

/// Meshes of every kind, including degenerate ones, with and without the pairs that share vertices.
#[test]
fn curves_of_degenerate_meshes_are_consistent() {
    let mut random = Random::new(71);
    let mut count = [0; 3];
    for i in 0..cases(1_200) {
        let mesh = random_mesh(&mut random);
        let found = contact_curves(&mesh.1, &mesh.0, &pairs(&mesh, None, i % 2 == 0)).unwrap();
        check(&found);
        count[0] += found.curves.len();
        count[1] += found.points.len();
        count[2] += found.polygons.len();
    }
    assert!(count.iter().all(|c| *c > sscc_testing::threshold(100)), "{count:?}");
}

#[test]
fn invalid_input_is_refused() {
    let positions = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let faces = [[0, 1, 2]];
    assert_eq!(contact_curves(&faces, &positions, &[]).unwrap(), ContactCurves::default());
    let refused = contact_curves(&faces, &positions, &[(0, 1)]);
    assert_eq!(refused, Err(Error::PairIndex { pair: 0, triangle: 1, triangles: 1 }));
    let refused = contact_curves(&[[0, 1, 3]], &positions, &[]);
    assert_eq!(refused, Err(Error::FaceIndex { face: 0, vertex: 3, vertices: 3 }));
    let infinite = [DVec3::ZERO, DVec3::X, DVec3::INFINITY];
    assert!(matches!(contact_curves(&faces, &infinite, &[]), Err(Error::Position { vertex: 2, .. })));
    let x = Surface { faces: &faces, positions: &positions };
    assert!(contact_curves_between(x, Surface { faces: &[], positions: &[] }, &[(0, 0)]).is_err());
}
