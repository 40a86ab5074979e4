//! The hare and the serpent have the documented properties.

use std::collections::HashMap;
use std::sync::LazyLock;

use glam::DVec3;
use sscc::parts::Scope;
use sscc::{Method, Modes, Query, ReducedModel, TriMesh, intersect_triangle_triangle};
use sscc_modes::shapes;

static HARE: LazyLock<TriMesh> = LazyLock::new(shapes::hare);
static SERPENT: LazyLock<TriMesh> = LazyLock::new(shapes::serpent);

const AROUND: usize = 32;

#[test]
fn shapes_have_the_documented_counts() {
    assert_eq!((HARE.faces().len(), HARE.rest_positions().len()), (14_964, 7_484));
    assert_eq!((SERPENT.faces().len(), SERPENT.rest_positions().len()), (77_184, 38_594));
}

#[test]
fn closed_spheres_oriented_outward() {
    for mesh in [&*HARE, &*SERPENT] {
        let vertices = mesh.rest_positions().len();
        assert_eq!(mesh.used_vertices().len(), vertices);
        let face_of = edges(mesh);
        assert_eq!(face_of.len(), 3 * mesh.faces().len(), "no edge twice in one direction");
        assert!(
            face_of.keys().all(|(a, b)| face_of.contains_key(&(*b, *a))),
            "no edge with one triangle only"
        );
        assert_eq!(vertices + mesh.faces().len() - face_of.len() / 2, 2, "Euler characteristic of a sphere");

        // The faces around each vertex form one ring: going from face to face visits all of them.
        let mut valence = vec![0; vertices];
        for v in mesh.faces().iter().flatten() {
            valence[*v as usize] += 1;
        }
        for [a, b, _] in mesh.faces() {
            let (mut at, mut steps) = (*b, 0);
            loop {
                at = opposite(mesh, face_of[&(*a, at)], *a, at);
                steps += 1;
                if at == *b {
                    break;
                }
            }
            assert_eq!(steps, valence[*a as usize], "vertex {a}");
        }

        let (mut reached, mut open) = (vec![false; vertices], vec![0_u32]);
        let mut neighbours = vec![Vec::new(); vertices];
        face_of.keys().for_each(|(a, b)| neighbours[*a as usize].push(*b));
        while let Some(v) = open.pop() {
            if !std::mem::replace(&mut reached[v as usize], true) {
                open.extend(&neighbours[v as usize]);
            }
        }
        assert!(reached.into_iter().all(|r| r), "one component");

        let volume: f64 = corners(mesh).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
        assert!((0.01..0.2).contains(&volume), "{volume}");
    }
}

#[test]
fn no_self_collision_at_rest() {
    for mesh in [&*HARE, &*SERPENT] {
        let still = Modes::from_matrix(mesh.rest_positions().len(), 1, |_, _| 0.0).unwrap();
        let model = ReducedModel::new(mesh.clone(), still).unwrap();
        let mut query = Query::without_certificates(&model, Scope::of(&model), Method::Traditional).unwrap();
        assert_eq!(query.discrete(&[0.0]).unwrap(), []);
        assert!(query.statistics().box_tests > 100_000, "{:?}", query.statistics());
    }
}

/// Two faces with one common corner meet elsewhere exactly if the opposite edge of one of them meets the other face: the
/// intersection is convex and contains the corner, so it ends on such an edge.
#[test]
fn faces_with_a_common_corner_meet_only_there() {
    for mesh in [&*HARE, &*SERPENT] {
        let mut around = vec![Vec::new(); mesh.rest_positions().len()];
        for face in mesh.faces() {
            face.iter().for_each(|v| around[*v as usize].push(*face));
        }
        let at = |face: [u32; 3]| face.map(|v| mesh.rest_positions()[v as usize]);
        let mut tested = 0;
        for (v, faces) in around.iter().enumerate() {
            for (a, b) in faces.iter().flat_map(|a| faces.iter().map(move |b| (*a, *b))) {
                if a.iter().filter(|v| b.contains(v)).count() == 1 {
                    let edge: Vec<u32> = a.into_iter().filter(|w| *w as usize != v).collect();
                    assert!(
                        !intersect_triangle_triangle(&at([edge[0], edge[1], edge[1]]), &at(b)),
                        "{a:?} {b:?}"
                    );
                    tested += 1;
                }
            }
        }
        assert!(tested > 100_000, "{tested}");
    }
}

#[test]
fn faces_do_not_fold_and_are_not_slivers() {
    for (mesh, min_cosine, min_height) in [(&*HARE, 0.4, 0.2), (&*SERPENT, 0.9, 0.15)] {
        let normals: Vec<DVec3> = corners(mesh).map(|[a, b, c]| (b - a).cross(c - a).normalize()).collect();
        let face_of = edges(mesh);
        let cosine = face_of
            .iter()
            .map(|((a, b), face)| normals[*face].dot(normals[face_of[&(*b, *a)]]))
            .fold(1.0, f64::min);
        assert!(cosine > min_cosine, "{cosine}");
        for [a, b, c] in corners(mesh) {
            let longest = (b - a).length().max((c - b).length()).max((a - c).length());
            let height = (b - a).cross(c - a).length() / longest;
            assert!(height > min_height * longest, "{a} {b} {c}: {}", height / longest);
        }
    }
}

#[test]
fn the_serpent_nearly_touches_itself_in_many_places() {
    let p = SERPENT.rest_positions();
    let rings: Vec<(DVec3, f64)> = p
        .chunks_exact(AROUND)
        .map(|ring| {
            let centre = ring.iter().sum::<DVec3>() / AROUND as f64;
            (centre, ring.iter().map(|x| x.distance(centre)).fold(0.0, f64::max))
        })
        .collect();
    let mut arc = vec![0.0];
    for pair in rings.windows(2) {
        arc.push(arc[arc.len() - 1] + pair[0].0.distance(pair[1].0));
    }
    // Half a turn of the narrowest coil has length 0.55, so points within 0.5 along the body are on the same coil.
    let gap_of = |i: usize| {
        let others = (0..rings.len()).filter(|j| (arc[i] - arc[*j]).abs() > 0.5);
        others
            .map(|j| rings[i].0.distance(rings[j].0) - rings[i].1 - rings[j].1)
            .fold(f64::INFINITY, f64::min)
            / rings[i].1
    };
    let gaps: Vec<f64> = (0..rings.len()).map(gap_of).collect();
    let smallest = gaps.iter().copied().fold(f64::INFINITY, f64::min);
    assert!((0.1..0.2).contains(&smallest), "{smallest}");
    let close = gaps.iter().filter(|g| **g < 0.5).count();
    assert!(close > 500, "{close} of {} rings", gaps.len());
    let minima = gaps.windows(3).filter(|g| g[1] < 0.3 && g[1] < g[0] && g[1] <= g[2]).count();
    assert!(minima >= 15, "{minima}");
}

/// A hash of all bits detects changes of the shapes and differences between machines.
#[test]
fn shapes_have_the_same_bits_on_every_machine() {
    assert_eq!(hash(&HARE), 0x3287_4db3_26b5_c9d2, "{:#018x}", hash(&HARE));
    assert_eq!(hash(&SERPENT), 0x01c7_4e45_88cc_bda1, "{:#018x}", hash(&SERPENT));
    assert_eq!(*HARE, shapes::hare());
}

fn hash(mesh: &TriMesh) -> u64 {
    let positions = mesh.rest_positions().iter().flat_map(|p| p.to_array()).map(f64::to_bits);
    let faces = mesh.faces().iter().flatten().map(|v| u64::from(*v));
    let mix = |h: u64, x: u64| (h ^ x).wrapping_mul(0x100_0000_01b3);
    positions.chain(faces).fold(0xcbf2_9ce4_8422_2325, mix)
}

fn corners(mesh: &TriMesh) -> impl Iterator<Item = [DVec3; 3]> {
    mesh.faces().iter().map(|f| f.map(|v| mesh.rest_positions()[v as usize]))
}

/// Returns the face to the left of each directed edge.
fn edges(mesh: &TriMesh) -> HashMap<(u32, u32), usize> {
    let sides =
        |(face, [a, b, c]): (usize, &[u32; 3])| [((*a, *b), face), ((*b, *c), face), ((*c, *a), face)];
    mesh.faces().iter().enumerate().flat_map(sides).collect()
}

/// Returns the corner of a face other than a and b.
fn opposite(mesh: &TriMesh, face: usize, a: u32, b: u32) -> u32 {
    mesh.faces()[face].into_iter().find(|v| *v != a && *v != b).expect("three corners")
}
