//! Clearance: near pairs and the nearest pair are compared with all pairs of triangles.

use glam::{DVec3, Vec3Swizzles};
use sscc::{
    CancelToken, Certificates, CertifyOptions, Clearance, ContactFilter, Detector, Error, Modes, NearPair,
    Neighbours, Query, ReducedModel, TriMesh, distance_triangle_triangle,
};
use sscc_testing::Numbers;

fn vector(random: &mut Numbers) -> DVec3 {
    DVec3::new(random.signed(), random.signed(), random.signed())
}

/// Returns a wavy sheet of `2 n n` triangles.
fn sheet(n: usize, random: &mut Numbers, height: f64) -> TriMesh {
    let row = n + 1;
    let positions: Vec<DVec3> = (0..row * row)
        .map(|i| {
            let (x, y) = ((i % row) as f64 / n as f64, (i / row) as f64 / n as f64);
            DVec3::new(x, y, height * (9.0 * x).sin()) + vector(random) * (0.1 / n as f64)
        })
        .collect();
    let faces = (0..n * n).flat_map(|i| {
        let a = (i / n * row + i % n) as u32;
        let (b, c, d) = (a + 1, a + row as u32, a + row as u32 + 1);
        [[a, b, d], [a, d, c]]
    });
    TriMesh::new(positions, faces.collect()).unwrap()
}

/// Returns loose triangles.
fn soup(count: u32, random: &mut Numbers, size: f64) -> TriMesh {
    let positions = (0..count)
        .flat_map(|_| {
            let center = vector(random);
            [(); 3].map(|()| center + vector(random) * size)
        })
        .collect();
    TriMesh::new(positions, (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()).unwrap()
}

fn corners(mesh: &TriMesh, positions: &[DVec3], t: usize) -> [DVec3; 3] {
    mesh.faces()[t].map(|v| positions[v as usize])
}

/// Returns the distance of each two triangles on the surface in rings, by a search from every triangle.
fn rings_between(mesh: &TriMesh) -> Vec<Vec<usize>> {
    let faces = mesh.faces();
    let touches = |a: usize, b: usize| faces[a].iter().any(|v| faces[b].contains(v));
    (0..faces.len())
        .map(|start| {
            let mut rings = vec![usize::MAX; faces.len()];
            rings[start] = 0;
            for ring in 1..=faces.len() {
                let next: Vec<usize> = (0..faces.len())
                    .filter(|t| rings[*t] == usize::MAX)
                    .filter(|t| (0..faces.len()).any(|other| rings[other] == ring - 1 && touches(other, *t)))
                    .collect();
                if next.is_empty() {
                    break;
                }
                next.into_iter().for_each(|t| rings[t] = ring);
            }
            rings
        })
        .collect()
}

/// Returns all pairs more than `rings` rings apart, with their distances.
fn all_pairs(mesh: &TriMesh, positions: &[DVec3], rings: usize) -> Vec<NearPair> {
    let apart = rings_between(mesh);
    let count = mesh.faces().len();
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
    pairs
        .filter(|(a, b)| apart[*a][*b] > rings)
        .map(|(a, b)| {
            let distance =
                distance_triangle_triangle(&corners(mesh, positions, a), &corners(mesh, positions, b));
            NearPair { pair: (a as u32, b as u32), distance }
        })
        .collect()
}

#[test]
fn near_pairs_are_those_of_all_triangles() {
    let random = &mut Numbers(6);
    let mut found = [0; 2];
    for case in 0..12 {
        let mesh = if case % 2 == 0 { sheet(9, random, 0.3) } else { soup(160, random, 0.15) };
        let mut detector = Detector::new(&mesh);
        for (turn, rings) in [(0, 1), (1, 2), (2, 4)] {
            let positions: Vec<DVec3> = mesh
                .rest_positions()
                .iter()
                .map(|x| *x * [1.0, 1e-200, 1e30][turn] + vector(random) * (0.02 * [1.0, 1e-200, 1e30][turn]))
                .collect();
            let size = [1.0, 1e-200, 1e30][turn];
            let all = all_pairs(&mesh, &positions, rings as usize);
            for share in [0.01, 0.1, 0.4, 50.0] {
                let clearance = Clearance::new(share * size).unwrap().beyond_rings(rings);
                let near = detector.within(&positions, &clearance).unwrap().to_vec();
                let expected: Vec<NearPair> =
                    all.iter().copied().filter(|near| near.distance < share * size).collect();
                assert_eq!(near, expected, "case {case}, {share}, {rings}");
                found[usize::from(rings > 1)] += near.len();
            }
        }
    }
    assert!(found[0] > 10_000 && found[1] > 10_000, "{found:?}");
}

/// Two layers have a distance just below a clearance that is small for single precision.
#[test]
fn small_clearances_survive_single_precision() {
    let random = &mut Numbers(8);
    for gap in [1e-5, 1e-7, 1e-9, 1e-12] {
        let layer = soup(150, random, 0.2);
        // Each triangle is level at its own height, so that heights use all digits of single precision.
        let x = layer.rest_positions();
        let flat: Vec<DVec3> = (0..x.len()).map(|v| DVec3::new(x[v].x, x[v].y, x[v / 3 * 3].z)).collect();
        // Each triangle of the second layer is above one of the first layer, by less than the gap.
        let upper: Vec<DVec3> = flat.iter().map(|x| *x + DVec3::Z * (gap * 0.9)).collect();
        let mut detectors = [(); 2].map(|()| Detector::new(&layer));
        let [one, two] = &mut detectors;
        let near = one.within_against(&flat, two, &upper, &Clearance::new(gap).unwrap()).unwrap();
        let own = (0..150).filter(|t| near.iter().any(|near| near.pair == (*t, *t))).count();
        assert_eq!(own, 150, "{gap}");
        assert!(near.iter().all(|near| near.distance < gap));
        let below = Clearance::new(gap * 0.8).unwrap();
        let near = one.within_against(&flat, two, &upper, &below).unwrap();
        assert!(near.iter().all(|near| near.pair.0 != near.pair.1));
    }
}

#[test]
fn near_pairs_of_two_meshes_are_those_of_all_triangles() {
    let random = &mut Numbers(12);
    let mut found = 0;
    for case in 0..10 {
        let meshes = [sheet(7, random, 0.2), soup(90, random, 0.2)];
        let mut detectors = meshes.each_ref().map(Detector::new);
        let shift = vector(random) * 0.4;
        let positions = meshes.each_ref().map(|mesh| {
            mesh.rest_positions()
                .iter()
                .map(|x| *x + if case % 2 == 0 { shift } else { DVec3::ZERO })
                .collect()
        });
        let [x, y]: [Vec<DVec3>; 2] = positions;
        let all: Vec<NearPair> = (0..meshes[0].faces().len())
            .flat_map(|a| (0..meshes[1].faces().len()).map(move |b| (a, b)))
            .map(|(a, b)| {
                let distance =
                    distance_triangle_triangle(&corners(&meshes[0], &x, a), &corners(&meshes[1], &y, b));
                NearPair { pair: (a as u32, b as u32), distance }
            })
            .collect();
        let [one, two] = &mut detectors;
        for share in [0.005, 0.05, 0.3] {
            let near = one.within_against(&x, two, &y, &Clearance::new(share).unwrap()).unwrap();
            let expected: Vec<NearPair> = all.iter().copied().filter(|near| near.distance < share).collect();
            assert_eq!(near, expected, "case {case}, {share}");
            found += near.len();
        }
        let least = all.iter().map(|near| near.distance).fold(f64::INFINITY, f64::min);
        assert_eq!(one.nearest_against(&x, two, &y).unwrap().unwrap().distance, least, "case {case}");
    }
    assert!(found > 1000, "{found}");
}

#[test]
fn the_nearest_pair_is_that_of_all_triangles() {
    let random = &mut Numbers(14);
    let mut touching = 0;
    for case in 0..30 {
        let mesh =
            if case % 3 == 0 { sheet(8, random, 0.2) } else { soup(40, random, [0.02, 0.3][case % 2]) };
        let size = [1.0, 1e-250, 1e40][case % 3];
        let positions: Vec<DVec3> = mesh.rest_positions().iter().map(|x| *x * size).collect();
        let mut detector = Detector::new(&mesh);
        for rings in [1, 3] {
            let all = all_pairs(&mesh, &positions, rings as usize);
            let least = all.iter().map(|near| near.distance).fold(f64::INFINITY, f64::min);
            let found = detector.nearest(&positions, rings).unwrap().unwrap();
            assert_eq!(found.distance, least, "case {case}");
            assert!(all.contains(&found), "case {case}");
            touching += usize::from(least == 0.0);
        }
    }
    assert!((1..40).contains(&touching), "{touching}");
    // In a tetrahedron no pair counts.
    let positions = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let mesh = TriMesh::new(positions.clone(), vec![[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]).unwrap();
    assert_eq!(Detector::new(&mesh).nearest(&positions, 1).unwrap(), None);
}

/// The triangles have an edge along an axis and lie around one point, so that their distances from it, like those of their boxes,
/// differ by rounding alone.
#[test]
fn distances_that_differ_by_rounding_are_told_apart() {
    let random = &mut Numbers(19);
    let mut equal = 0;
    for case in 0..400 {
        let (middle, radius) = (vector(random), random.power(0.0, 2.0));
        let axis = [DVec3::X, DVec3::Y, DVec3::Z][case % 3];
        let mut x = Vec::new();
        for _ in 0..24 {
            let outwards = (vector(random) * (DVec3::ONE - axis)).normalize_or(axis.zxy());
            let nearest = middle + outwards * radius;
            let along = axis * radius * (1.0 + random.signed().abs());
            x.extend([nearest - along, nearest + along, nearest + outwards * radius]);
        }
        let faces: Vec<[u32; 3]> = (0..24).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let around = TriMesh::new(x.clone(), faces).unwrap();
        let alone = TriMesh::new(vec![middle], vec![[0; 3]]).unwrap();
        let distances: Vec<f64> =
            (0..24).map(|t| distance_triangle_triangle(&[middle; 3], &corners(&around, &x, t))).collect();
        let least = distances.iter().copied().fold(f64::INFINITY, f64::min);
        let [mut alone, mut around] = [alone, around].map(|mesh| Detector::new(&mesh));
        let found = alone.nearest_against(&[middle], &mut around, &x).unwrap().unwrap();
        assert_eq!(found.distance, least, "case {case}");
        equal += distances.iter().filter(|distance| **distance <= least * (1.0 + 1e-15)).count() - 1;
    }
    assert!(equal > 1000, "{equal}");
}

#[test]
fn ignored_pairs_groups_and_neighbours_do_not_count() {
    let at = |z: f64| [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + DVec3::Z * z);
    let positions = [at(0.0), at(0.1), at(0.3)].concat();
    let mesh = TriMesh::new(positions.clone(), vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]]).unwrap();
    let filter = ContactFilter::new(Neighbours::Exclude).ignoring([(1, 0)]);
    let mut detector = Detector::with_filter(&mesh, &filter).unwrap();
    let near = detector.within(&positions, &Clearance::new(0.25).unwrap()).unwrap();
    assert_eq!(near.iter().map(|near| near.pair).collect::<Vec<_>>(), [(1, 2)]);
    assert_eq!(detector.nearest(&positions, 1).unwrap().unwrap().pair, (1, 2));
    // Triangles with a common vertex never count, for any contact filter.
    let folded = TriMesh::new(at(0.0).to_vec(), vec![[0, 1, 2], [0, 1, 2]]).unwrap();
    let filter = ContactFilter::new(Neighbours::IncludeFolded);
    let mut detector = Detector::with_filter(&folded, &filter).unwrap();
    assert!(detector.within(&at(0.0), &Clearance::new(1.0).unwrap()).unwrap().is_empty());
}

#[test]
fn invalid_clearances_and_cancelled_searches_are_errors() {
    for distance in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(Clearance::new(distance), Err(Error::Option { name: "clearance", .. })));
    }
    let random = &mut Numbers(1);
    let mesh = soup(3000, random, 0.3);
    let positions = mesh.rest_positions().to_vec();
    let token = CancelToken::new();
    let mut detector = Detector::new(&mesh).cancelled_by(token.clone());
    let all = detector.within(&positions, &Clearance::new(1e200).unwrap()).unwrap().len();
    assert_eq!(all, 3000 * 2999 / 2);
    token.cancel();
    assert_eq!(detector.within(&positions, &Clearance::new(0.1).unwrap()), Err(Error::Cancelled));
    assert_eq!(detector.nearest(&positions, 1), Err(Error::Cancelled));
}

/// Returns the corners of a cube about a point, and its triangles, anticlockwise as seen from outside.
fn cube(center: DVec3, edge: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let corner =
        |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2)) - DVec3::splat(0.5);
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    ((0..8).map(|i| center + corner(i) * edge).collect(), faces.collect())
}

/// Returns one mesh of several cubes; those of negative edge length face inward.
fn cubes(all: &[(DVec3, f64)]) -> TriMesh {
    let (mut positions, mut faces) = (Vec::new(), Vec::new());
    for (center, edge) in all {
        let (corners, own) = cube(*center, edge.abs());
        let first = positions.len() as u32;
        let turn = |[a, b, c]: [u32; 3]| if *edge < 0.0 { [a, c, b] } else { [a, b, c] };
        faces.extend(own.into_iter().map(|t| turn(t).map(|v| v + first)));
        positions.extend(corners);
    }
    TriMesh::new(positions, faces).unwrap()
}

fn inside(one: &TriMesh, two: &TriMesh) -> [(usize, usize); 2] {
    let [mut x, mut y] = [one, two].map(Detector::new);
    assert!(x.against(one.rest_positions(), &mut y, two.rest_positions()).unwrap().is_empty());
    let found = x.enclosed(one.rest_positions(), &mut y, two.rest_positions()).unwrap();
    found.map(|side| (side.inside, side.components))
}

#[test]
fn enclosed_components_are_counted() {
    let (large, small) = (cubes(&[(DVec3::ZERO, 4.0)]), cubes(&[(DVec3::ONE, 1.0)]));
    assert_eq!(inside(&large, &small), [(0, 1), (1, 1)]);
    assert_eq!(inside(&small, &large), [(1, 1), (0, 1)]);
    let beside = cubes(&[(DVec3::splat(9.0), 1.0), (DVec3::ZERO, 2.0), (DVec3::splat(-9.0), 1.0)]);
    assert_eq!(inside(&large, &beside), [(0, 1), (1, 3)]);
    // A body in the cavity of a hollow body is outside of it.
    let hollow = cubes(&[(DVec3::ZERO, 4.0), (DVec3::ZERO, -3.5)]);
    assert_eq!(inside(&hollow, &small), [(0, 2), (0, 1)]);
    // A surface with a hole has no inside, also if other parts of the mesh are closed.
    let open = TriMesh::new(large.rest_positions().to_vec(), large.faces()[1..].to_vec()).unwrap();
    assert_eq!(inside(&open, &small), [(0, 1), (0, 1)]);
    // But it may be inside itself.
    let open = TriMesh::new(small.rest_positions().to_vec(), small.faces()[1..].to_vec()).unwrap();
    assert_eq!(inside(&large, &open), [(0, 1), (1, 1)]);
    assert_eq!(inside(&open, &large), [(1, 1), (0, 1)]);
    // A body has an inside also where an open surface, or another body, shares a vertex with it.
    let beside = cubes(&[(DVec3::splat(-5.0), 1.0)]);
    let positions = [large.rest_positions(), &beside.rest_positions()[..7]].concat();
    let of_beside = beside.faces().iter().map(|face| face.map(|v| if v == 7 { 0 } else { v + 8 }));
    let faces = [large.faces().to_vec(), of_beside.collect()].concat();
    for left_out in 0..2 {
        let joined = TriMesh::new(positions.clone(), faces[left_out..].to_vec()).unwrap();
        assert_eq!(inside(&joined, &small), [(0, 1), (1 - left_out, 1)]);
        let joined = TriMesh::new(positions.clone(), faces[..faces.len() - left_out].to_vec()).unwrap();
        assert_eq!(inside(&joined, &small), [(0, 1), (1, 1)]);
        assert_eq!(inside(&joined, &cubes(&[(DVec3::splat(-5.0), 0.1)])), [(0, 1), (1 - left_out, 1)]);
    }
    // A soup is closed where its corners are welded.
    let corners = large.faces().iter().flatten().map(|v| large.rest_positions()[*v as usize]);
    let soup =
        TriMesh::new(corners.collect(), (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()).unwrap();
    assert_eq!(inside(&soup, &small), [(0, 12), (0, 1)]);
    assert_eq!(inside(&soup.with_split_vertices(), &small), [(0, 1), (1, 1)]);
}

#[test]
fn a_component_whose_welded_vertices_part_is_open() {
    let (large, small) = (cubes(&[(DVec3::ZERO, 4.0)]), cubes(&[(DVec3::ZERO, 1.0)]));
    let corners = large.faces().iter().flatten().map(|v| large.rest_positions()[*v as usize]);
    let soup =
        TriMesh::new(corners.collect(), (0..12).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()).unwrap();
    let soup = soup.with_split_vertices();
    let [mut x, mut y] = [&soup, &small].map(Detector::new);
    let mut torn = soup.rest_positions().to_vec();
    torn[0] *= 2.0;
    for (positions, expected) in [(soup.rest_positions(), 1), (&torn[..], 0), (soup.rest_positions(), 1)] {
        assert_eq!(x.enclosed(positions, &mut y, small.rest_positions()).unwrap()[1].inside, expected);
    }
}

#[test]
fn distances_at_q_are_those_of_the_positions() {
    let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
    let modes = Modes::new(1, (0..6).map(|v| if v < 3 { DVec3::ZERO } else { DVec3::Z }).collect()).unwrap();
    let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let model = ReducedModel::new(mesh.clone(), modes).unwrap();
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let mut query = Query::new(&model, &certificates).unwrap();
    let clearance = Clearance::new(1.5).unwrap();
    for (q, expected) in [(0.0, Some(1.0)), (-0.25, Some(0.75)), (-1.0, Some(0.0)), (1.0, None)] {
        let near = query.within(&[q], &clearance).unwrap();
        assert_eq!(near.first().map(|near| near.distance), expected);
        assert_eq!(query.nearest(&[q], 1).unwrap().unwrap().distance, 1.0 + q);
        assert_eq!(query.discrete(&[q]).unwrap().is_empty(), q > -1.0);
    }
    assert!(query.within(&[f64::NAN], &clearance).is_err());
}

#[test]
fn the_nearest_pair_is_found_in_nodes_of_unequal_depth() {
    // Triangles in a row: leaves have 64 consecutive ones. Number 192 and later ones are nearer by 0.5.
    let row = |from: f64, count: u32| {
        let at = |t: u32| from + f64::from(t) - if t >= 192 { 0.5 } else { 0.0 };
        let corners = |t| [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p * 0.125 + DVec3::X * at(t));
        let faces = (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        TriMesh::new((0..count).flat_map(corners).collect(), faces).unwrap()
    };
    // Node 2 of the hierarchy has children, and node 3 is a leaf.
    let mesh = row(0.0, 384);
    let found = Detector::new(&mesh).nearest(mesh.rest_positions(), 1).unwrap().unwrap();
    assert_eq!(found.pair, (191, 192));
    let nearest = |one: &TriMesh, two: &TriMesh| {
        let [mut x, mut y] = [one, two].map(Detector::new);
        x.nearest_against(one.rest_positions(), &mut y, two.rest_positions()).unwrap().unwrap().pair
    };
    let (first, second, single) = (row(0.0, 190), row(190.25, 190), row(200.0, 1));
    assert_eq!(nearest(&first, &second), (189, 0));
    assert_eq!((nearest(&first, &single), nearest(&single, &first)), ((189, 0), (0, 189)));
}

#[test]
fn rays_along_the_sides_of_boxes_are_counted() {
    // A prism along x with rings of vertices at whole numbers. The third leaf begins at x = 21.
    let ring = |k: u32| [[0.0, 0.0], [2.0, 0.0], [1.0, 2.0]].map(|[y, z]| DVec3::new(f64::from(k), y, z));
    let mut faces = vec![[0, 1, 2], [92, 91, 90]];
    for k in 0..30 {
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            let [a, b, c, d] = [3 * k + i, 3 * k + 3 + i, 3 * k + 3 + j, 3 * k + j];
            faces.extend([[a, b, c], [a, c, d]]);
        }
    }
    let prism = TriMesh::new((0..=30).flat_map(ring).collect(), faces).unwrap();
    let points = (1..30).flat_map(|k| [0.6, 1.4].map(|y| DVec3::new(f64::from(k), y, 0.5)));
    let positions = points.flat_map(|p| [p, p + DVec3::Y * 0.01, p + DVec3::Z * 0.01]).collect();
    let small = TriMesh::new(positions, (0..58).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()).unwrap();
    assert_eq!(inside(&prism, &small)[1], (58, 58));
}
