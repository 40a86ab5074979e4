//! Compares the volume that two bodies share and the largest ball in both with known values.

use glam::{DMat3, DQuat, DVec3};
use sscc::parts::{BodyPenetration, body_penetration};
use sscc::{CancelToken, Detector, Error, TriMesh};

use crate::common::Random;

/// Returns a box of 12 triangles.
fn cuboid(lower: DVec3, upper: DVec3) -> TriMesh {
    let corner = |k: usize| {
        DVec3::from_array([0, 1, 2].map(|axis| if k >> axis & 1 == 1 { upper[axis] } else { lower[axis] }))
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    TriMesh::new((0..8).map(corner).collect(), faces).unwrap()
}

/// Returns a ball: a subdivided octahedron.
fn ball(center: DVec3, radius: f64, subdivisions: u32) -> TriMesh {
    let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
    let mut faces = Vec::new();
    for (a, b) in [(x, y), (y, -x), (-x, -y), (-y, x)] {
        faces.extend([[a, b, z], [b, a, -z]]);
    }
    for _ in 0..subdivisions {
        let split = |[a, b, c]: [DVec3; 3]| {
            let [d, e, f] = [a + b, b + c, c + a].map(DVec3::normalize);
            [[a, d, f], [d, b, e], [f, e, c], [d, e, f]]
        };
        faces = faces.into_iter().flat_map(split).collect();
    }
    // Merges corners with equal bits.
    let mut positions: Vec<DVec3> = Vec::new();
    let mut number = |p: DVec3| match positions.iter().position(|known| *known == p) {
        Some(known) => known as u32,
        None => {
            positions.push(p);
            positions.len() as u32 - 1
        }
    };
    let numbered = faces.iter().map(|face| face.map(&mut number)).collect();
    TriMesh::new(positions.iter().map(|p| center + *p * radius).collect(), numbered).unwrap()
}

fn find(a: &TriMesh, b: &TriMesh) -> Result<BodyPenetration, Error> {
    let mut detectors = [a, b].map(Detector::new);
    body_penetration(detectors.each_mut(), [a.rest_positions(), b.rest_positions()])
}

fn penetration(a: &TriMesh, b: &TriMesh) -> BodyPenetration {
    let (found, swapped) = (find(a, b).unwrap(), find(b, a).unwrap());
    assert!(
        (found.volume - swapped.volume).abs() <= found.volume_error + swapped.volume_error,
        "{found:?} {swapped:?}"
    );
    found
}

/// Checks that volume and depth are within the stated errors, and that these errors are small.
fn check(a: &TriMesh, b: &TriMesh, volume: f64, depth: f64) {
    let found = penetration(a, b);
    assert!((found.volume - volume).abs() <= found.volume_error, "{volume}: {found:?}");
    assert!(
        found.depth <= depth * (1.0 + 1e-12) && depth <= found.depth + found.depth_error + 1e-8,
        "{depth}: {found:?}"
    );
    let small = if depth == 0.0 { 1e-3 } else { 1.001e-3 * depth + 1e-8 };
    assert!(found.depth_error <= small, "{found:?}");
}

#[test]
fn penetrations_of_boxes_are_exact() {
    let unit = cuboid(DVec3::ZERO, DVec3::ONE);
    let at = |x: f64, y: f64, z: f64| cuboid(DVec3::new(x, y, z), DVec3::new(x + 1.0, y + 1.0, z + 1.0));
    check(&unit, &at(0.75, 0.0, 0.0), 0.25, 0.25);
    check(&unit, &at(0.5, 0.25, -0.125), 0.5 * 0.75 * 0.875, 0.5);
    check(&unit, &at(0.0, 0.0, 0.9), 0.1, 0.1);
    check(&unit, &unit, 1.0, 1.0);
    // Boxes that touch, and separate ones.
    for other in
        [at(1.0, 0.0, 0.0), at(0.0, 0.0, 1.0), at(1.0, 1.0, 1.0), at(2.0, 0.0, 0.0), at(0.0, 0.0, -3.0)]
    {
        check(&unit, &other, 0.0, 0.0);
    }
    // One box inside the other, and two crossed boxes, no vertex of which is in the other.
    check(&unit, &cuboid(DVec3::splat(0.25), DVec3::splat(0.5)), 0.25_f64.powi(3), 0.25);
    let bars = [DVec3::new(4.0, 0.5, 0.5), DVec3::new(0.5, 4.0, 0.5)].map(|half| cuboid(-half, half));
    check(&bars[0], &bars[1], 1.0, 1.0);
    // A hollow body: the outer box with an inner one that faces inward.
    let (outer, inner) = (cuboid(DVec3::ZERO, DVec3::splat(4.0)), cuboid(DVec3::ONE, DVec3::splat(3.0)));
    let positions = [outer.rest_positions(), inner.rest_positions()].concat();
    let turned = inner.faces().iter().map(|[a, b, c]| [a + 8, c + 8, b + 8]);
    let hollow = TriMesh::new(positions, outer.faces().iter().copied().chain(turned).collect()).unwrap();
    check(&hollow, &cuboid(DVec3::splat(1.5), DVec3::splat(2.5)), 0.0, 0.0);
    check(&hollow, &cuboid(DVec3::new(1.5, 1.5, 2.5), DVec3::new(2.5, 2.5, 3.5)), 0.5, 0.5);
    // A mesh that faces inward as a whole.
    let inward = TriMesh::new(
        unit.rest_positions().to_vec(),
        unit.faces().iter().map(|[a, b, c]| [*a, *c, *b]).collect(),
    );
    check(&inward.unwrap(), &at(0.75, 0.0, 0.0), 0.25, 0.25);
}

/// Rotations and translations do not change volumes and depths.
#[test]
fn rotated_bodies_have_the_same_penetration() {
    let mut random = Random::new(7);
    let (a, b) =
        (cuboid(DVec3::ZERO, DVec3::ONE), cuboid(DVec3::new(0.5, 0.25, 0.75), DVec3::new(1.5, 1.25, 1.75)));
    for _ in 0..20 {
        let mut number = || 2.0 * random.uniform() - 1.0;
        let turn = DQuat::from_xyzw(number(), number(), number(), number()).normalize();
        let shift = DVec3::new(number(), number(), number()) * 100.0;
        let moved = |mesh: &TriMesh| {
            TriMesh::new(
                mesh.rest_positions().iter().map(|p| turn * *p + shift).collect(),
                mesh.faces().to_vec(),
            )
            .unwrap()
        };
        let found = penetration(&moved(&a), &moved(&b));
        // Coordinates of about 100 are rounded.
        assert!((found.volume - 0.5 * 0.75 * 0.25).abs() < found.volume_error + 1e-12, "{found:?}");
        assert!(found.volume_error < 1e-10, "{found:?}");
        assert!((found.depth - 0.25).abs() < 3e-4, "{found:?}");
    }
}

/// Two boxes that touch in a face, or are moved along it, so that triangles of both are in one tilted plane.
#[test]
fn faces_in_one_tilted_plane_share_what_they_do() {
    let mut random = Random::new(11);
    for (shift, volume) in [(DVec3::new(0.3, 0.4, 1.0), 0.0), (DVec3::new(0.3, 0.4, 0.0), 0.7 * 0.6)] {
        let (a, b) = (cuboid(DVec3::ZERO, DVec3::ONE), cuboid(shift, shift + DVec3::ONE));
        for _ in 0..200 {
            let mut number = || 2.0 * random.uniform() - 1.0;
            let turn = DQuat::from_xyzw(number(), number(), number(), number()).normalize();
            let moved = |mesh: &TriMesh| {
                let positions = mesh.rest_positions().iter().map(|p| turn * *p).collect();
                TriMesh::new(positions, mesh.faces().to_vec()).unwrap()
            };
            let found = penetration(&moved(&a), &moved(&b));
            // Positions are rounded, too.
            assert!((found.volume - volume).abs() <= found.volume_error + 1e-14, "{turn}: {found:?}");
        }
    }
}

/// Bodies of any size have the same penetration in units of their size.
#[test]
fn sizes_change_nothing() {
    let (a, b) = (cuboid(DVec3::ZERO, DVec3::ONE), cuboid(DVec3::new(0.5, 0.25, 0.75), DVec3::splat(1.75)));
    let plain = penetration(&a, &b);
    for exponent in [-60, -150, -300] {
        let size = 2.0_f64.powi(exponent);
        let scaled = |mesh: &TriMesh| {
            let positions = mesh.rest_positions().iter().map(|p| *p * size).collect();
            TriMesh::new(positions, mesh.faces().to_vec()).unwrap()
        };
        let found = penetration(&scaled(&a), &scaled(&b));
        assert!((found.depth / size - plain.depth).abs() < 1e-9, "{exponent}: {found:?}");
        assert!((found.volume / size / size / size - plain.volume).abs() < 1e-9, "{exponent}: {found:?}");
    }
    // A vertex of no face changes nothing, wherever it is.
    for unused in [&[][..], &[DVec3::X]] {
        let tiny = |mesh: &TriMesh| {
            let positions = mesh.rest_positions().iter().map(|p| *p * 2.0_f64.powi(-1000));
            TriMesh::new(positions.chain(unused.iter().copied()).collect(), mesh.faces().to_vec()).unwrap()
        };
        let found = penetration(&tiny(&a), &tiny(&b));
        assert!((found.depth * 2.0_f64.powi(1000) - plain.depth).abs() < 1e-9, "{found:?}");
        assert!(found.volume == 0.0 && found.volume_error > 0.0, "{found:?}");
    }
}

/// A flat part, closed by two triangulations of one tilted rectangle, has a volume of any sign by rounding.
#[test]
fn flat_parts_do_not_count() {
    let mut random = Random::new(5);
    let body = cuboid(DVec3::ZERO, DVec3::ONE);
    for _ in 0..50 {
        let [x, y, from] = [(); 3].map(|()| random.vector());
        let flat = [from, from + x, from + x + y, from + y].map(|p| p + DVec3::splat(5.0));
        let faces = [[8, 9, 10], [8, 10, 11], [8, 11, 9], [9, 11, 10]];
        let positions = [body.rest_positions(), &flat].concat();
        let mesh = TriMesh::new(positions, [body.faces(), &faces].concat()).unwrap();
        check(&mesh, &cuboid(DVec3::splat(0.5), DVec3::splat(1.5)), 0.125, 0.5);
    }
}

/// A part that faces inward, joined with the rest in one vertex, is no inside.
#[test]
fn parts_that_meet_in_a_vertex_face_one_way() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p * 2.0);
    let other = [DVec3::ZERO, -DVec3::X, -DVec3::Y, -DVec3::Z];
    let outward = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let positions = corners.into_iter().chain(other[1..].iter().copied()).collect();
    let number = |v: u32| if v == 0 { 0 } else { v + 3 };
    // The mirror image of a tetrahedron that faces outward faces inward.
    let inward = outward.map(|face| face.map(number));
    let mesh = TriMesh::new(positions, [outward, inward].concat()).unwrap();
    let around = cuboid(DVec3::splat(-1.5), DVec3::splat(-1e-3));
    assert!(matches!(find(&mesh, &around), Err(Error::OpenMesh(_))));
    // Also where the other mesh shares more with the part that faces outward.
    let [large, small] = [[0.0, 2.0], [-1.0, 0.0]].map(|[a, b]| cuboid(DVec3::splat(a), DVec3::splat(b)));
    let number = |v: u32| if v == 7 { 0 } else { v + 8 };
    let inward = small.faces().iter().map(|[a, b, c]| [*a, *c, *b].map(number));
    let faces = large.faces().iter().copied().chain(inward).collect();
    let positions = [large.rest_positions(), small.rest_positions()].concat();
    let mesh = TriMesh::new(positions, faces).unwrap();
    assert_eq!(find(&mesh, &cuboid(DVec3::splat(-0.5), DVec3::ONE)), Err(Error::OpenMesh("first")));
}

/// Two parts with a common edge count as one, whose volume cannot be negative within another mesh.
#[test]
fn parts_that_meet_in_an_edge_face_one_way() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X * 0.5, -DVec3::Y * 0.5];
    let outward = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let inward = outward.map(|[a, b, c]| [a, c, b].map(|v| [0, 4, 5, 3][v as usize]));
    let mesh = TriMesh::new(corners.map(|p| p * 2.0).to_vec(), [outward, inward].concat()).unwrap();
    let around = cuboid(DVec3::new(-1.5, -1.5, -0.5), DVec3::new(-1e-3, -1e-3, 2.5));
    assert!(matches!(find(&mesh, &around), Err(Error::OpenMesh(_))));
}

/// A part whose first corner is on another part is inside or outside of it, as the rest of the part is.
#[test]
fn parts_that_touch_face_one_way() {
    let cube = cuboid(DVec3::ZERO, DVec3::splat(2.0));
    // The first corner is on a face of the cube; the others are below it by 1.
    let with_tetrahedron = |z: f64| {
        let others = [[0.5, 0.5], [1.5, 0.5], [1.0, 1.5]].map(|[x, y]| DVec3::new(x, y, z - 1.0));
        let positions = [cube.rest_positions(), &[DVec3::new(1.0, 1.0, z)], &others].concat();
        let inward = [[8, 10, 9], [8, 11, 10], [8, 9, 11], [9, 10, 11]];
        TriMesh::new(positions, [cube.faces(), &inward].concat()).unwrap()
    };
    let below = cuboid(DVec3::new(0.5, 0.5, -1.0), DVec3::new(1.5, 1.5, 1.0));
    assert_eq!(find(&with_tetrahedron(0.0), &below), Err(Error::OpenMesh("first")));
    let around = cuboid(DVec3::splat(-1.0), DVec3::splat(3.0));
    let found = penetration(&with_tetrahedron(2.0), &around);
    assert!((found.volume - (8.0 - 1.0 / 6.0)).abs() <= found.volume_error + 1e-12, "{found:?}");
    // In any position, where centroids are not exact.
    let mut random = Random::new(50);
    for _ in 0..20 {
        let turn = DMat3::from_quat(DQuat::from_scaled_axis(random.vector() * 3.0));
        let turned = |mesh: &TriMesh| {
            let positions = mesh.rest_positions().iter().map(|p| turn * *p).collect();
            TriMesh::new(positions, mesh.faces().to_vec()).unwrap()
        };
        // A face of the tetrahedron is a part of a face of the cube, except for rounding.
        assert_eq!(find(&turned(&with_tetrahedron(0.0)), &turned(&below)), Err(Error::OpenMesh("first")));
        assert!(find(&turned(&with_tetrahedron(2.0)), &turned(&around)).is_ok());
    }
    // Equal parts have no point that is on one of them alone.
    let positions = [cube.rest_positions(), cube.rest_positions()].concat();
    let again = cube.faces().iter().map(|face| face.map(|v| v + 8));
    let twice = TriMesh::new(positions, cube.faces().iter().copied().chain(again).collect());
    let found = penetration(&twice.unwrap(), &around);
    assert!((found.volume - 16.0).abs() <= found.volume_error + 1e-12, "{found:?}");
}

#[test]
fn tetrahedra_and_balls() {
    // A tetrahedron and its mirror image in a point share an octahedron of half its volume.
    let corners =
        [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]].map(DVec3::from_array);
    let faces = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let tet = TriMesh::new(corners.to_vec(), faces.clone()).unwrap();
    let mirrored =
        TriMesh::new(corners.map(|p| -p).to_vec(), faces.iter().map(|[a, b, c]| [*a, *c, *b]).collect())
            .unwrap();
    check(&tet, &mirrored, 4.0 / 3.0, 2.0 / 3.0_f64.sqrt());
    // Two balls of many triangles share a lens, within the error of the polyhedra.
    let (a, b) = (ball(DVec3::ZERO, 1.0, 4), ball(DVec3::X * 1.5, 1.0, 4));
    let found = penetration(&a, &b);
    // Two caps of height 1/4.
    let lens = 2.0 * std::f64::consts::PI * 0.25 * 0.25 * (3.0 - 0.25) / 3.0;
    assert!((found.volume / lens - 1.0).abs() < 0.05, "{found:?} {lens}");
    assert!((found.depth - 0.5).abs() < 0.01, "{found:?}");
    let apart = penetration(&a, &ball(DVec3::X * 2.5, 1.0, 2));
    assert_eq!((apart.volume, apart.depth), (0.0, 0.0));
    let whole = penetration(&a, &ball(DVec3::ZERO, 3.0, 2));
    let volume = |mesh: &TriMesh| -> f64 {
        let corners = |f: &[u32; 3]| f.map(|v| mesh.rest_positions()[v as usize]);
        mesh.faces()
            .iter()
            .map(|f| {
                let [a, b, c] = corners(f);
                a.dot(b.cross(c)) / 6.0
            })
            .sum()
    };
    assert!((whole.volume - volume(&a)).abs() <= whole.volume_error + 1e-12, "{whole:?}");
}

/// Returns the radius of the largest ball within half-spaces `n . x <= offset` (unit normals), by trial of each four planes that it may
/// touch.
fn largest_ball(planes: &[(DVec3, f64)]) -> f64 {
    let count = planes.len();
    let mut largest = 0.0_f64;
    for a in 0..count {
        for b in 0..a {
            for c in 0..b {
                for d in 0..c {
                    let [(n_a, h_a), rest @ ..] = [a, b, c, d].map(|k| planes[k]);
                    // n . x + r = h for all four planes; r cancels in their differences.
                    let rows = rest.map(|(n, h)| (n - n_a, h - h_a));
                    let matrix = DMat3::from_cols(rows[0].0, rows[1].0, rows[2].0).transpose();
                    if matrix.determinant().abs() < 1e-9 {
                        continue;
                    }
                    let center = matrix.inverse() * DVec3::new(rows[0].1, rows[1].1, rows[2].1);
                    let radius = h_a - n_a.dot(center);
                    if planes.iter().all(|(n, h)| n.dot(center) + radius <= h + 1e-9) {
                        largest = largest.max(radius);
                    }
                }
            }
        }
    }
    largest
}

#[test]
fn the_largest_ball_is_that_of_all_planes() {
    let mut random = Random::new(48);
    let mut shared = 0;
    for _ in 0..60 {
        let bodies = [0, 1].map(|_| {
            let mut corners: Vec<DVec3> = (0..4).map(|_| random.vector()).collect();
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| corners[k]);
            if (b - a).cross(c - a).dot(d - a) < 0.0 {
                corners.swap(2, 3);
            }
            TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]).unwrap()
        });
        let plane = |mesh: &TriMesh, face: &[u32; 3]| {
            let [a, b, c] = face.map(|v| mesh.rest_positions()[v as usize]);
            let normal = (b - a).cross(c - a).normalize();
            (normal, normal.dot(a))
        };
        let planes: Vec<_> =
            bodies.iter().flat_map(|mesh| mesh.faces().iter().map(|face| plane(mesh, face))).collect();
        let depth = 2.0 * largest_ball(&planes);
        let found = penetration(&bodies[0], &bodies[1]);
        assert!(found.depth <= depth + 1e-8, "{depth}: {found:?}");
        assert!(depth <= found.depth + found.depth_error + 1e-8, "{depth}: {found:?}");
        shared += usize::from(depth > 1e-3);
    }
    assert!(shared > 15, "{shared}");
}

/// An inverted part would reduce the volume, so all parts must have the same orientation.
#[test]
fn parts_face_one_way() {
    let inverted =
        |mesh: &TriMesh| -> Vec<[u32; 3]> { mesh.faces().iter().map(|[a, b, c]| [*a, *c, *b]).collect() };
    let (large, small) =
        (cuboid(DVec3::ZERO, DVec3::splat(2.0)), cuboid(DVec3::splat(3.0), DVec3::splat(4.0)));
    let both = |faces: [Vec<[u32; 3]>; 2]| {
        let positions = [large.rest_positions(), small.rest_positions()].concat();
        let [first, second] = faces;
        let second = second.into_iter().map(|face| face.map(|v| v + 8));
        TriMesh::new(positions, first.into_iter().chain(second).collect()).unwrap()
    };
    let half = cuboid(DVec3::new(3.5, 3.0, 3.0), DVec3::new(5.0, 4.0, 4.0));
    let outward = both([large.faces().to_vec(), small.faces().to_vec()]);
    let inward = both([inverted(&large), inverted(&small)]);
    check(&outward, &half, 0.5, 0.5);
    check(&inward, &half, 0.5, 0.5);
    let mixed = both([large.faces().to_vec(), inverted(&small)]);
    assert_eq!(find(&mixed, &half), Err(Error::OpenMesh("first")));
    assert_eq!(find(&half, &mixed), Err(Error::OpenMesh("second")));
}

#[test]
fn open_meshes_have_no_volume() {
    let unit = cuboid(DVec3::ZERO, DVec3::ONE);
    let open = TriMesh::new(unit.rest_positions().to_vec(), unit.faces()[1..].to_vec()).unwrap();
    assert_eq!(find(&open, &unit), Err(Error::OpenMesh("first")));
    assert_eq!(find(&unit, &open), Err(Error::OpenMesh("second")));
    let token = CancelToken::new();
    token.cancel();
    let mut cancelled = Detector::new(&unit).cancelled_by(token);
    let at = unit.rest_positions();
    let found = body_penetration([&mut cancelled, &mut Detector::new(&unit)], [at, at]);
    assert_eq!(found, Err(Error::Cancelled));
}

/// Returns one mesh of several; those with `true` are turned inside out.
fn merged(parts: &[(&TriMesh, bool)]) -> TriMesh {
    let (mut positions, mut faces): (Vec<DVec3>, Vec<[u32; 3]>) = (Vec::new(), Vec::new());
    for (mesh, is_inverted) in parts {
        let first = positions.len() as u32;
        positions.extend_from_slice(mesh.rest_positions());
        for &[a, b, c] in mesh.faces() {
            let face = if *is_inverted { [a, c, b] } else { [a, b, c] };
            faces.push(face.map(|v| v + first));
        }
    }
    TriMesh::new(positions, faces).unwrap()
}

#[test]
fn every_part_is_closed_and_faces_one_way() {
    let unit = cuboid(DVec3::ZERO, DVec3::ONE);
    let corners = [[0.2, 3.0, 0.2], [0.8, 3.0, 0.2], [0.5, 4.0, 0.5]].map(DVec3::from_array).to_vec();
    let other = cuboid(DVec3::new(0.75, 0.0, 0.0), DVec3::new(1.75, 1.0, 1.0));
    // A closed part beside an open one.
    let single = TriMesh::new(corners.clone(), vec![[0, 1, 2]]).unwrap();
    assert_eq!(find(&merged(&[(&unit, false), (&single, false)]), &other), Err(Error::OpenMesh("first")));
    // A doubled triangle has volume 0 and error 0: it does not face outward in a mesh that faces inward.
    let doubled = TriMesh::new(corners, vec![[0, 1, 2], [0, 2, 1]]).unwrap();
    check(&merged(&[(&unit, true), (&doubled, false)]), &other, 0.25, 0.25);
    // A small part that faces inward, in meshes of any size, and far away.
    for (size, at) in [(1.0, 3.0), (2.0_f64.powi(-40), 3.0), (1.0, 1e5)] {
        let large = cuboid(DVec3::ZERO, DVec3::splat(2.0 * size));
        let small = cuboid(DVec3::splat(at * size), DVec3::splat((at + 1.0) * size));
        let mixed = merged(&[(&large, false), (&small, true)]);
        let found = find(&mixed, &cuboid(DVec3::ZERO, DVec3::splat(size)));
        assert_eq!(found, Err(Error::OpenMesh("first")), "{size} {at}");
    }
    // A pit: two of its twelve triangles are in a face of the cube; the others tell where it is.
    let cube = cuboid(DVec3::ZERO, DVec3::splat(4.0));
    let pit = cuboid(DVec3::ONE, DVec3::new(2.0, 2.0, 4.0));
    let around = cuboid(DVec3::splat(-1.0), DVec3::splat(5.0));
    let found = find(&merged(&[(&cube, false), (&pit, true)]), &around).unwrap();
    assert!((found.volume - 61.0).abs() <= found.volume_error + 1e-12, "{found:?}");
}

#[test]
fn bounds_of_balls_are_those_of_formulas() {
    // The ball in a tetrahedron is off the centre of its box, and distances are much larger than 1.
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p * 16.0).to_vec();
    let tet = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]).unwrap();
    let around = cuboid(DVec3::splat(-16.0), DVec3::splat(32.0));
    check(&tet, &around, 4096.0 / 6.0, 32.0 / (3.0 + 3.0_f64.sqrt()));
    // Bodies that touch: a ball has at most the volume and its error.
    let unit = cuboid(DVec3::ZERO, DVec3::ONE);
    let found = find(&unit, &cuboid(DVec3::X, DVec3::ONE + DVec3::X)).unwrap();
    let largest = (0.75 * (found.volume + found.volume_error) / std::f64::consts::PI).cbrt();
    assert!(found.depth == 0.0 && found.volume_error > 0.0, "{found:?}");
    assert_eq!(found.depth_error, 2.0 * largest);
    // Errors of tiny bodies are rounded up.
    let tiny = |from: f64| {
        let size = 2.0_f64.powi(-1000);
        cuboid(DVec3::splat(from * size), DVec3::splat((from + 1.0) * size))
    };
    let found = find(&tiny(0.0), &tiny(3.0)).unwrap();
    assert_eq!([found.volume_error, found.depth_error], [f64::from_bits(1); 2]);
    // Bodies that are the origin alone.
    let point = cuboid(DVec3::ZERO, DVec3::ZERO);
    assert_eq!(find(&point, &point), Ok(BodyPenetration::default()));
}

/// Triangles of the ball end at x = 0 and y = 0, so nodes do as well; rays count as moved to +x and +y.
#[test]
fn components_below_the_sides_of_nodes_are_inside() {
    let shell = ball(DVec3::ZERO, 1.0, 3);
    let mut outer = Detector::new(&shell);
    for x in [-0.3, 0.0, 0.3] {
        for y in [-0.3, 0.0, 0.3] {
            let lower = DVec3::new(x, y, 0.0);
            let small = cuboid(lower, lower + DVec3::splat(0.05));
            let mut inner = Detector::new(&small);
            let found = outer.enclosed(shell.rest_positions(), &mut inner, small.rest_positions()).unwrap();
            assert_eq!(found.map(|side| side.inside), [0, 1], "{lower}");
        }
    }
}
