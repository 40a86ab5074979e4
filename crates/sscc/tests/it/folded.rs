//! Compares triangles that share one, two or three vertices, with `include-folded`, with an oracle in exact arithmetic that has
//! no case distinctions.

use glam::DVec3;
use sscc::parts::{Scope, intersect_shared_edge_pair};
use sscc::{
    Certificates, CertifyOptions, ContactFilter, Detector, Error, Method, Neighbours, Pair, Query, TriMesh,
    intersect_triangle_triangle,
};
use sscc_testing::{cases, threshold};

use crate::common::exact::{Vector, candidates, exact, is_in_hull};
use crate::common::{Random, random_mesh, random_model};

/// Whether two triangles with common vertices have a common point beyond these and the edges between them: some corner of the
/// convex set of common points is beyond the convex hull of the common vertices. `faces`: vertex numbers, or classes.
fn oracle(faces: [[u32; 3]; 2], corners: [[DVec3; 3]; 2]) -> bool {
    let [a, b] = corners.map(|t| t.map(exact));
    let is_common = |face: [u32; 3], v: &u32| face.contains(v);
    if faces[0].iter().all(|v| is_common(faces[1], v)) && faces[1].iter().all(|v| is_common(faces[0], v)) {
        return true;
    }
    let common: Vec<Vector> =
        (0..3).filter(|&i| is_common(faces[1], &faces[0][i])).map(|i| a[i].clone()).collect();
    candidates(&a, &b).iter().any(|x| is_in_hull(x, &a) && is_in_hull(x, &b) && !is_in_hull(x, &common))
}

fn folded() -> ContactFilter {
    ContactFilter::new(Neighbours::IncludeFolded)
}

/// Returns whether the pair is listed for a mesh of two triangles.
fn listed(faces: [[u32; 3]; 2], x: &[DVec3], filter: &ContactFilter) -> bool {
    let mesh = TriMesh::new(x.to_vec(), faces.to_vec()).unwrap();
    !Detector::with_filter(&mesh, filter).unwrap().discrete(x).unwrap().is_empty()
}

/// Returns five vertices of two triangles: on a coarse grid, in a plane, on a line, or folded onto each other up to rounding.
fn vertices(random: &mut Random, kind: usize) -> Vec<DVec3> {
    let size = [1.2, 2.2, 4.2][random.below(3)];
    let grid = |random: &mut Random| (random.vector() * size).round();
    let mut x: Vec<DVec3> = (0..5).map(|_| grid(random)).collect();
    match kind % 8 {
        0 => x.iter_mut().for_each(|x| x.z = 1.0),
        1 => {
            let (start, step) = (x[0], grid(random));
            x.iter_mut().for_each(|x| *x = start + step * x.x);
        }
        // One triangle is a segment or a point.
        2 => x[2] = x[0] + (x[1] - x[0]) * 2.0_f64.powi(random.below(4) as i32 - 2),
        3 => x[3] = x[random.below(3)],
        4 => x[1] = x[0],
        // The triangles are folded about the first edge, to the same side or the other one, exactly or nearly in one plane.
        5 | 6 => {
            x[0] = random.vector() * random.power(-3.0, 3.0);
            (1..3).for_each(|i| x[i] = x[0] + random.vector());
            for i in 3..5 {
                let [s, t] = [random.signed(), random.signed()];
                x[i] = x[0] + (x[1] - x[0]) * s + (x[2] - x[0]) * t;
            }
            if kind % 8 == 6 {
                x.iter_mut().for_each(|x| *x = x.as_vec3().as_dvec3());
                x[3] = x[0] + (x[1] - x[0]) * 0.25 + (x[2] - x[0]) * 0.5;
            }
        }
        _ => {}
    }
    if random.below(3) == 0 {
        // A corner moves by a unit in the last place.
        let i = random.below(5);
        x[i].y = if random.below(2) == 0 { x[i].y.next_up() } else { x[i].y.next_down() };
    }
    let scale = 2.0_f64.powi(if random.below(12) == 0 { [190, -400, -1050][random.below(3)] } else { 0 });
    x.iter().map(|x| *x * scale).collect()
}

#[test]
fn folded_pairs_are_those_of_exact_fractions() {
    let random = &mut Random::new(45);
    let mut counts = [[0; 2]; 4];
    let cases = cases(6_000);
    for case in 0..cases {
        let x = vertices(random, case);
        let shared = [[0, 3, 4], [0, 1, 3], [0, 1, 2], [0, 1, 3]][random.below(4)];
        let (turn, is_flipped) = (random.below(3), random.below(2) == 0);
        let mut faces = [[0, 1, 2], shared];
        faces[1].rotate_left(turn);
        if is_flipped {
            faces[1].swap(0, 1);
        }
        if random.below(12) == 0 {
            faces[random.below(2)][1] = faces[0][random.below(2)];
        }
        let is_shared = faces[1].iter().any(|v| faces[0].contains(v));
        let corners = faces.map(|face| face.map(|v: u32| x[v as usize]));
        let expected = if is_shared {
            oracle(faces, corners)
        } else {
            intersect_triangle_triangle(&corners[0], &corners[1])
        };
        assert_eq!(listed(faces, &x, &folded()), expected, "case {case}: {faces:?} {corners:?}");
        assert_eq!(
            listed([faces[1], faces[0]], &x, &folded()),
            expected,
            "case {case}: {faces:?} {corners:?}"
        );
        // The same triangles with separate, welded vertices. Then vertices at one position are one vertex.
        let (mut split, mut split_x) = (faces, x.clone());
        for corner in split.iter_mut().flatten() {
            if random.below(2) == 0 {
                split_x.push(x[*corner as usize]);
                *corner = split_x.len() as u32 - 1;
            }
        }
        let welded = ContactFilter::new(Neighbours::IncludeFolded).weld(true);
        let first = |v: u32| x.iter().position(|y| *y == x[v as usize]).unwrap() as u32;
        let classes = faces.map(|face| face.map(first));
        let is_shared = classes[1].iter().any(|v| classes[0].contains(v));
        let of_welded = if is_shared {
            oracle(classes, corners)
        } else {
            intersect_triangle_triangle(&corners[0], &corners[1])
        };
        assert_eq!(listed(split, &split_x, &welded), of_welded, "case {case}: {split:?} {split_x:?}");
        let common = faces[0].iter().filter(|v| faces[1].contains(v)).count();
        counts[common][usize::from(expected)] += 1;
        if common < 2 {
            // With one common vertex the answer is that of `include-one-vertex`.
            let one = ContactFilter::new(Neighbours::IncludeOneVertex);
            let is_repeated = faces.iter().any(|f| f[0] == f[1] || f[1] == f[2] || f[2] == f[0]);
            assert!(is_repeated || listed(faces, &x, &one) == expected, "case {case}: {faces:?} {corners:?}");
        }
    }
    let enough = |n: usize| n > cases / 60;
    let both = counts[1..3].iter().flatten().all(|n| enough(*n));
    assert!(both && enough(counts[3][1]), "{counts:?}");
}

#[test]
fn shared_edges_do_not_depend_on_the_order_of_corners() {
    let random = &mut Random::new(46);
    let (mut found, mut free) = (0, 0);
    for case in 0..cases(40_000) {
        let x = vertices(random, case);
        let [u, w, a, b] = [x[0], x[1], x[2], x[3]];
        let answer = intersect_shared_edge_pair([u, w], a, b);
        let others = [
            intersect_shared_edge_pair([w, u], a, b),
            intersect_shared_edge_pair([u, w], b, a),
            intersect_shared_edge_pair([w, u], b, a),
        ];
        assert_eq!(others, [answer; 3], "{u} {w} {a} {b}");
        found += usize::from(answer);
        free += usize::from(!answer);
    }
    assert!(found > threshold(4000) && free > threshold(4000), "{found} {free}");
}

/// Returns all colliding pairs of a mesh; the oracle decides those that share a vertex.
fn brute_force(x: &[DVec3], faces: &[[u32; 3]]) -> Vec<Pair> {
    let corners: Vec<[DVec3; 3]> = faces.iter().map(|face| face.map(|v| x[v as usize])).collect();
    let mut pairs = Vec::new();
    for a in 0..faces.len() {
        for b in a + 1..faces.len() {
            let is_shared = faces[a].iter().any(|v| faces[b].contains(v));
            let is_listed = match is_shared {
                true => oracle([faces[a], faces[b]], [corners[a], corners[b]]),
                false => intersect_triangle_triangle(&corners[a], &corners[b]),
            };
            if is_listed {
                pairs.push((a as u32, b as u32));
            }
        }
    }
    pairs
}

#[test]
fn detectors_list_all_folded_pairs() {
    let random = &mut Random::new(47);
    let (mut shared, mut apart) = (0, 0);
    for case in 0..cases(24) {
        let (rest, mut faces) = random_mesh(random);
        // The oracle is slow.
        faces.truncate(24);
        let mesh = TriMesh::new(rest.clone(), faces.clone()).unwrap();
        let mut detector = Detector::with_filter(&mesh, &folded()).unwrap();
        // The second search masks adjacent triangles.
        for frame in 0..3 {
            let step = random.power(-1.0, 0.5);
            let x: Vec<DVec3> = match frame {
                0 => rest.clone(),
                1 => rest.iter().map(|x| (x / step).round() * step).collect(),
                _ => rest.iter().map(|x| DVec3::new(x.x, x.y, 0.0)).collect(),
            };
            let expected = brute_force(&x, &faces);
            assert_eq!(detector.discrete(&x).unwrap(), expected, "case {case} frame {frame}");
            let answers = detector.batch(&[&x, &x], None, &()).unwrap();
            assert!(answers.iter().all(|answer| answer.pairs == expected), "case {case} frame {frame}");
            assert_eq!(detector.discrete_at_most(&x, 1).unwrap().len(), expected.len().min(1));
            let is_shared = |(a, b): &&Pair| crate::common::are_adjacent(&mesh, *a, *b);
            shared += expected.iter().filter(is_shared).count();
            apart += expected.len() - expected.iter().filter(is_shared).count();
            // Ignored pairs and pairs of groups that do not count are not listed.
            let ignored = expected.first().copied();
            let mut ignoring = Detector::with_filter(&mesh, &folded().ignoring(ignored)).unwrap();
            assert_eq!(ignoring.discrete(&x).unwrap(), &expected[ignored.iter().len()..]);
        }
    }
    assert!(shared > threshold(16) && apart > threshold(1), "{shared} {apart}");
}

/// The mesh is a strip of quads, one of which lies on its neighbour, and a doubled face.
#[test]
fn a_triangle_folded_onto_its_neighbour_is_found() {
    let at = DVec3::new;
    let x = [at(0.0, 0.0, 0.0), at(2.0, 0.0, 0.0), at(0.0, 2.0, 0.0), at(0.5, 0.5, 0.0), at(2.0, 2.0, 0.0)];
    let mesh = TriMesh::new(x.to_vec(), vec![[0, 1, 2], [1, 0, 3], [2, 1, 4], [2, 0, 1]]).unwrap();
    let pairs = |neighbours| {
        let filter = ContactFilter::new(neighbours);
        Detector::with_filter(&mesh, &filter).unwrap().discrete(&x).unwrap().to_vec()
    };
    assert_eq!(pairs(Neighbours::Exclude), []);
    assert_eq!(pairs(Neighbours::IncludeOneVertex), []);
    assert_eq!(pairs(Neighbours::IncludeFolded), [(0, 1), (0, 3), (1, 3)]);
    // A nearly closed hinge is free, as is an open one.
    let mut open = x;
    open[3].z = 1e-300;
    let mut detector = Detector::with_filter(&mesh, &folded()).unwrap();
    assert_eq!(detector.discrete(&open).unwrap(), [(0, 3)]);
}

/// Distances prove nothing about triangles that always touch.
#[test]
fn certificates_models_and_continuous_queries_refuse_folded_neighbours() {
    let model = random_model(3);
    let refused = |error: Error| {
        let message = error.to_string();
        assert!(matches!(error, Error::FoldedNeighbours { .. }), "{message}");
        assert!(
            message.contains("discrete queries of meshes without modes") && !message.contains('\n'),
            "{message}"
        );
        assert!(message.ends_with("use include-one-vertex"), "{message}");
    };
    let options = CertifyOptions::default().filter(folded());
    refused(Certificates::compute(&model, &options, &()).unwrap_err());
    let scope = || Scope { filter: folded(), ..Scope::of(&model) };
    for method in [Method::BdTree, Method::Traditional, Method::NormalCones, Method::BruteForce] {
        refused(Query::without_certificates(&model, scope(), method).err().unwrap());
    }
    refused(folded().ignoring_rest(&model, 0).unwrap_err());
    let mut forged = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap().parts().clone();
    forged.scope = scope().into();
    forged.digest = sscc::parts::Digest::of(&model, &forged.scope);
    let forged = Certificates::try_from(forged).unwrap();
    refused(Query::new(&model, &forged).err().unwrap());
    let rest = model.mesh().rest_positions();
    let mut detector = Detector::with_filter(model.mesh(), &folded()).unwrap();
    refused(detector.continuous(rest, rest).unwrap_err());
    // Between two meshes every pair counts, and there are no neighbours.
    let mut other = Detector::new(model.mesh());
    assert!(!detector.continuous_against([rest, rest], &mut other, [rest, rest]).unwrap().is_empty());
}

/// Vertex numbers and welds at rest decide which vertices are common. Later positions do not change this.
#[test]
fn adjacency_does_not_change_with_positions() {
    let at = DVec3::new;
    // At rest vertices 0 and 1 are at one position, and welded.
    let rest =
        [at(0.0, 0.0, 0.0), at(0.0, 0.0, 0.0), at(1.0, 1.0, 0.0), at(-1.0, 1.0, 0.0), at(-1.0, -1.0, 0.0)];
    let opened =
        [at(-1.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(0.0, 1.0, 0.0), at(0.0, -1.0, 1.0), at(-2.0, -1.0, 1.0)];
    let answers = |faces: [[u32; 3]; 2], neighbours, x: &[DVec3]| {
        let mesh = TriMesh::new(rest.to_vec(), faces.to_vec()).unwrap();
        let mut detector = Detector::with_filter(&mesh, &ContactFilter::new(neighbours).weld(true)).unwrap();
        let discrete = !detector.discrete(x).unwrap().is_empty();
        let is_swept = neighbours != Neighbours::IncludeFolded;
        let swept = is_swept && !detector.continuous(x, x).unwrap().is_empty();
        [discrete, swept]
    };
    let one = Neighbours::IncludeOneVertex;
    // A hinge has two common numbers. It opens without another common point, or closes; it never counts.
    let hinge = [[0, 1, 2], [1, 0, 3]];
    let mut closed = opened;
    closed[3] = at(0.0, 0.5, 0.0);
    for x in [rest, opened, closed] {
        assert_eq!(answers(hinge, one, &x), [false; 2], "{x:?}");
        assert_eq!(answers(hinge, Neighbours::Exclude, &x), [false; 2], "{x:?}");
    }
    assert_eq!(answers(hinge, Neighbours::IncludeFolded, &opened), [false; 2]);
    assert_eq!(answers(hinge, Neighbours::IncludeFolded, &closed), [true, false]);
    // One common number, of a vertex whose welded partner moves away: the vertex remains common.
    let corner = [[0, 1, 2], [0, 3, 4]];
    assert_eq!(answers(corner, one, &opened), [false; 2]);
    let mut through = opened;
    through[3] = at(1.0, 0.5, 0.0);
    assert_eq!(answers(corner, one, &through), [true; 2]);
}
