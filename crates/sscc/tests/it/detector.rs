//! Compares the detector for given positions with brute force and with queries by modes.

use glam::{DVec3, Vec3Swizzles};
use sscc::parts::{Scope, detector_with_weld_classes};
use sscc::{
    ContactFilter, Detector, Error, Impact, Method, MovingTriangle, Neighbours, Pair, Query, TriMesh,
    impact_triangle_triangle, intersect_triangle_triangle,
};
use sscc_testing::cases;

use crate::common::{Random, after, random_model};

/// Returns loose triangles of a size at a random position, some degenerate, some with common vertices.
fn soup(random: &mut Random, triangles: u32, size: f64) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let vertices = 2 * triangles + 3;
    let x = (0..vertices).map(|_| random.vector() * size).collect();
    let faces = (0..triangles)
        .map(|t| {
            let first = 2 * t;
            if t % 11 == 5 { [first, first, first + 1] } else { [first, first + 1, first + 2] }
        })
        .collect();
    (x, faces)
}

/// Whether two triangles intersect. Disjoint AABBs decide many pairs without exact arithmetic.
fn meet(s: &[DVec3; 3], t: &[DVec3; 3]) -> bool {
    let aabb = |[a, b, c]: &[DVec3; 3]| [a.min(*b).min(*c), a.max(*b).max(*c)];
    let ([s_low, s_high], [t_low, t_high]) = (aabb(s), aabb(t));
    s_low.cmple(t_high).all() && t_low.cmple(s_high).all() && intersect_triangle_triangle(s, t)
}

fn brute_force(x: &[DVec3], faces: &[[u32; 3]]) -> Vec<Pair> {
    let corners: Vec<[DVec3; 3]> = faces.iter().map(|face| face.map(|v| x[v as usize])).collect();
    let mut pairs = Vec::new();
    for a in 0..faces.len() {
        for b in a + 1..faces.len() {
            let is_adjacent = faces[a].iter().any(|v| faces[b].contains(v));
            if !is_adjacent && meet(&corners[a], &corners[b]) {
                pairs.push((a as u32, b as u32));
            }
        }
    }
    pairs
}

/// Moves vertices onto a coarse grid, so that many pairs touch.
fn on_grid(x: &[DVec3], step: f64) -> Vec<DVec3> {
    x.iter().map(|x| (x / step).round() * step).collect()
}

#[test]
fn pairs_are_those_of_brute_force() {
    let random = &mut Random::new(3);
    let mut colliding = 0;
    for case in 0..cases(60) {
        let triangles = [1, 2, 9, 70, 200, 350][case % 6];
        let size = [1.0, 1e-200, 1e40][case % 3];
        let (rest, faces) = soup(random, triangles, size);
        let mesh = TriMesh::new(rest.clone(), faces.clone()).unwrap();
        let mut detector = Detector::new(&mesh);
        for frame in 0..6 {
            let far = if frame == 3 { DVec3::new(1e5, -3.0, 7.0) * size } else { DVec3::ZERO };
            let x: Vec<DVec3> = rest.iter().map(|_| random.vector() * size + far).collect();
            let x = if frame % 2 == 1 { on_grid(&x, 0.25 * size) } else { x };
            let pairs = detector.discrete(&x).unwrap().to_vec();
            assert_eq!(pairs, brute_force(&x, &faces), "case {case} frame {frame}");
            assert!(detector.statistics().complete);
            assert_eq!(detector.count(&x).unwrap(), pairs.len());
            assert_eq!(detector.first(&x).unwrap().is_some(), !pairs.is_empty());
            let some = detector.discrete_at_most(&x, 2).unwrap().to_vec();
            assert_eq!(some.len(), pairs.len().min(2));
            assert!(some.iter().all(|pair| pairs.contains(pair)));
            assert_eq!(detector.statistics().complete, pairs.len() < 2 || some.len() == pairs.len());
            colliding += pairs.len();
        }
    }
    assert!(colliding > 1000, "{colliding}");
}

/// Small triangles exchange their positions: the hierarchy is rebuilt once for all later frames of the same kind.
#[test]
fn a_hierarchy_whose_cost_has_grown_is_rebuilt() {
    let random = &mut Random::new(21);
    let count = 2000;
    let shape: Vec<[DVec3; 3]> = (0..count).map(|_| [(); 3].map(|()| random.vector() * 0.05)).collect();
    let mut places: Vec<DVec3> = (0..count).map(|_| random.vector()).collect();
    let at = |places: &[DVec3]| -> Vec<DVec3> {
        shape.iter().zip(places).flat_map(|(corners, place)| corners.map(|x| x + *place)).collect()
    };
    let faces: Vec<[u32; 3]> = (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let mesh = TriMesh::new(at(&places), faces.clone()).unwrap();
    let mut detector = Detector::new(&mesh);
    let mut rebuilds = Vec::new();
    for frame in 0..5 {
        match frame {
            1 => places.iter_mut().for_each(|x| *x = x.yzx() * 1.5),
            2 => (0..count).for_each(|i| places.swap(i, random.below(count))),
            _ => {}
        }
        let x = at(&places);
        assert_eq!(detector.discrete(&x).unwrap(), brute_force(&x, &faces), "frame {frame}");
        let drift: Vec<DVec3> = x.iter().map(|x| *x + DVec3::X * 0.1).collect();
        let swept = detector.continuous(&x, &drift).unwrap().len();
        assert!(swept >= detector.count(&x).unwrap());
        rebuilds.push(detector.statistics().rebuilds);
        assert!(detector.statistics().tree_cost > 1.0);
    }
    assert_eq!(rebuilds, [0, 0, 1, 1, 1]);
}

/// A detector at the positions of a model has the answers of its queries, continuous ones bit for bit.
#[test]
fn answers_are_those_of_queries() {
    let random = &mut Random::new(8);
    let (mut colliding, mut impacts) = (0, 0);
    for case in 0..cases(120) {
        let model = random_model(case as u64);
        let neighbours = [Neighbours::Exclude, Neighbours::IncludeOneVertex][case % 2];
        let ignored = [(0, 2), (1, 3)].into_iter().filter(|_| case % 5 == 0);
        let filter = ContactFilter::new(neighbours).ignoring(ignored);
        let scope = Scope { filter: filter.clone(), ..Scope::of(&model) };
        let mut query = Query::without_certificates(&model, scope, Method::BruteForce).unwrap();
        let mut detector = Detector::with_filter(model.mesh(), &filter).unwrap();
        let mut q: Vec<f64> = vec![0.0; model.rank()];
        for _ in 0..5 {
            let next: Vec<f64> = q.iter().map(|q| q + random.signed()).collect();
            let [x_t0, x_t1] = [&q, &next].map(|q| model.positions(q).unwrap());
            assert_eq!(detector.discrete(&x_t0).unwrap(), query.discrete(&q).unwrap(), "case {case}");
            colliding += detector.count(&x_t0).unwrap();
            let expected = query.continuous(&q, &next).unwrap();
            let found = detector.continuous(&x_t0, &x_t1).unwrap();
            impacts += found.len();
            assert_eq!(found, expected, "case {case}");
            q = next;
        }
    }
    assert!(colliding > 100 && impacts > 200, "{colliding} {impacts}");
}

/// The separating-axis test reads eight pairs: those that an earlier search has left must not matter.
#[test]
fn one_mesh_is_tested_against_meshes_of_other_sizes() {
    let random = &mut Random::new(31);
    let sizes = [1, 2, 5, 9, 40, 300];
    let meshes = sizes.map(|triangles| {
        let (rest, faces) = soup(random, triangles, 1.0);
        TriMesh::new(rest, faces).unwrap()
    });
    let mut detectors = meshes.each_ref().map(Detector::new);
    let corners = |mesh: &TriMesh| -> Vec<[DVec3; 3]> {
        mesh.faces().iter().map(|face| face.map(|v| mesh.rest_positions()[v as usize])).collect()
    };
    let all = meshes.each_ref().map(corners);
    let mut found = 0;
    for case in 0..cases(400) {
        let [i, j] = [(); 2].map(|()| (random.signed().abs() * sizes.len() as f64) as usize);
        if i == j {
            continue;
        }
        let [one, other] = detectors.get_disjoint_mut([i, j]).unwrap();
        let [x, y] = [i, j].map(|i| meshes[i].rest_positions());
        let pairs = one.against(x, other, y).unwrap();
        let mut expected = Vec::new();
        for (a, s) in all[i].iter().enumerate() {
            let met = all[j].iter().enumerate().filter(|(_, t)| meet(s, t));
            expected.extend(met.map(|(b, _)| (a as u32, b as u32)));
        }
        assert_eq!(pairs, expected, "case {case}: {i} {j}");
        found += usize::from(!expected.is_empty());
        let impacts = one.continuous_against([x, x], other, [y, y]).unwrap();
        assert_eq!(impacts.iter().map(|impact| impact.pair).collect::<Vec<_>>(), expected, "case {case}");
    }
    assert!(found > cases(400) / 4, "{found}");
}

#[test]
fn pairs_of_two_meshes_are_those_of_brute_force() {
    let random = &mut Random::new(12);
    let (mut colliding, mut free, mut hits) = (0, 0, 0);
    for case in 0..cases(80) {
        // A bucket has at most 64 triangles.
        let large = if case % 16 == 3 { [150, 300] } else { [70, 130] };
        let sizes = [[1, 1], [5, 200], [200, 5], large][case % 4];
        let meshes = sizes.map(|triangles| {
            let (rest, faces) = soup(random, triangles, 1.0);
            TriMesh::new(rest, faces).unwrap()
        });
        let [mut a, mut b] = meshes.each_ref().map(Detector::new);
        for frame in 0..4 {
            let offset = random.vector() * f64::from(frame);
            let positions = meshes.each_ref().map(|mesh| {
                [0, 1].map(|_| mesh.rest_positions().iter().map(|_| random.vector()).collect::<Vec<_>>())
            });
            let [x, mut y] = positions;
            y.iter_mut().flatten().for_each(|y| *y += offset);
            if case % 3 == 0 {
                y = y.map(|y| on_grid(&y, 0.25));
            }
            let mut expected = Vec::new();
            let corners = |mesh: &TriMesh, x: &[DVec3]| -> Vec<[DVec3; 3]> {
                mesh.faces().iter().map(|face| face.map(|v| x[v as usize])).collect()
            };
            let [s, t] = [corners(&meshes[0], &x[0]), corners(&meshes[1], &y[0])];
            for (i, s) in s.iter().enumerate() {
                let of_i =
                    t.iter().enumerate().filter(|(_, t)| meet(s, t)).map(|(j, _)| (i as u32, j as u32));
                expected.extend(of_i);
            }
            let pairs = a.against(&x[0], &mut b, &y[0]).unwrap().to_vec();
            assert_eq!(pairs, expected, "case {case} frame {frame}");
            let turned: Vec<Pair> = b.against(&y[0], &mut a, &x[0]).unwrap().to_vec();
            let mut turned: Vec<Pair> = turned.into_iter().map(|(j, i)| (i, j)).collect();
            turned.sort_unstable();
            assert_eq!(turned, expected);
            colliding += expected.len();
            free += usize::from(expected.is_empty());
            // Pairs that collide at the start have impacts at time 0.
            let [x0, x1, y0, y1] = [&x[0], &x[1], &y[0], &y[1]].map(|x| &x[..]);
            let impacts = a.continuous_against([x0, x1], &mut b, [y0, y1]).unwrap();
            let at_start: Vec<Pair> = impacts.iter().filter(|i| i.time == 0.0).map(|i| i.pair).collect();
            assert!(expected.iter().all(|pair| at_start.contains(pair)), "case {case}");
            let moving = |mesh: &TriMesh, [t0, t1]: [&[DVec3]; 2]| -> Vec<MovingTriangle> {
                let corners = |x: &[DVec3], face: [u32; 3]| face.map(|v| x[v as usize]);
                mesh.faces()
                    .iter()
                    .map(|f| MovingTriangle { t0: corners(t0, *f), t1: corners(t1, *f) })
                    .collect()
            };
            let [s, t] = [moving(&meshes[0], [x0, x1]), moving(&meshes[1], [y0, y1])];
            let mut all = Vec::new();
            for (i, s) in s.iter().enumerate() {
                for (j, t) in t.iter().enumerate() {
                    let time = impact_triangle_triangle(s, t, Impact::TOLERANCE);
                    all.extend(time.map(|time| ((i as u32, j as u32), time)));
                }
            }
            let found: Vec<(Pair, f64)> = impacts.iter().map(|impact| (impact.pair, impact.time)).collect();
            assert_eq!(found, all, "case {case} frame {frame}");
            hits += impacts.len();
        }
    }
    assert!(colliding > 500 && free > 10 && hits > 2 * colliding, "{colliding} {free} {hits}");
}

#[test]
fn batches_answer_as_single_frames_do() {
    let random = &mut Random::new(4);
    let (rest, faces) = soup(random, 300, 1.0);
    let mut detector = Detector::new(&TriMesh::new(rest.clone(), faces).unwrap());
    let frames: Vec<Vec<DVec3>> = (0..20).map(|_| rest.iter().map(|_| random.vector()).collect()).collect();
    let expected: Vec<Vec<Pair>> = frames.iter().map(|x| detector.discrete(x).unwrap().to_vec()).collect();
    for threads in [Some(1), Some(3), None] {
        let answers = detector.batch(&frames, threads, &()).unwrap();
        assert!(answers.iter().map(|answer| &answer.pairs).eq(&expected));
        let limited = detector.batch_at_most(&frames, 2, threads, &()).unwrap();
        assert_eq!(limited.len(), expected.len());
        for (some, all) in limited.iter().zip(&expected) {
            assert_eq!(some.pairs.len(), all.len().min(2));
            assert!(some.pairs.iter().all(|pair| all.contains(pair)));
            assert!(some.statistics.complete || all.len() >= 2);
        }
    }
    let stopped = after(0);
    assert_eq!(detector.batch(&frames, None, &stopped), Err(Error::Cancelled));
    assert_eq!(detector.clone().cancelled_by(stopped).discrete(&frames[0]), Err(Error::Cancelled));
}

#[test]
fn welded_vertices_are_one_for_adjacency() {
    // Two triangles with a common edge have separate vertices.
    let [a, b, c, d] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE];
    let rest = vec![a, b, c, b, d, c];
    let mesh = TriMesh::new(rest.clone(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    assert_eq!(Detector::new(&mesh).discrete(&rest).unwrap(), [(0, 1)]);
    let welded = ContactFilter::new(Neighbours::Exclude).weld(true);
    assert_eq!(Detector::with_filter(&mesh, &welded).unwrap().discrete(&rest).unwrap(), []);
    let classes = [0, 1, 2, 1, 4, 5];
    let mut detector = detector_with_weld_classes(&mesh, &classes, &ContactFilter::default()).unwrap();
    assert_eq!(detector.discrete(&rest).unwrap(), []);
    let wrong = detector_with_weld_classes(&mesh, &classes[1..], &ContactFilter::default()).unwrap_err();
    let cause = "the number of weld classes is 5: it must be the number of vertices of the mesh";
    assert_eq!(wrong.to_string(), cause);
}

/// Vertices that are welded at rest move apart: then shared-vertex pairs have no common vertex position.
#[test]
fn welded_vertices_can_move_apart() {
    let at = DVec3::new;
    let filter = ContactFilter::new(Neighbours::IncludeOneVertex);
    let faces = vec![[0, 1, 2], [3, 4, 5]];
    let detector = |x: &[DVec3]| {
        let mesh = TriMesh::new(x.to_vec(), faces.clone()).unwrap();
        detector_with_weld_classes(&mesh, &[u32::MAX, 1, 2, u32::MAX, 4, 5], &filter).unwrap()
    };
    let a = [at(0.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(0.0, 1.0, 0.0)];
    // The second triangle crosses the first; the edge opposite to its welded corner does not.
    let b = [at(0.2, 0.25, -1.0), at(0.2, 0.25, 1.0), at(5.0, 5.5, 1.0)];
    let x = [a, b].concat();
    assert_eq!(detector(&x).discrete(&x).unwrap(), [(0, 1)]);
    assert_eq!(detector(&x).continuous(&x, &x).unwrap().len(), 1);
    // These triangles have no common point.
    let a_free = [at(-0.75, -0.375, -1.75), at(-1.875, -0.6875, -3.6875), at(-1.4375, 3.75, 1.75)];
    let b_free = [at(-1.0625, -3.25, 1.75), at(-2.6875, -0.25, -0.625), at(-2.625, 3.0, -0.875)];
    let x = [a_free, b_free].concat();
    assert!(!intersect_triangle_triangle(&a_free, &b_free));
    assert_eq!(detector(&x).discrete(&x).unwrap(), []);
    // Only the welded corner passes through the first triangle.
    let still = [at(0.2, 0.25, 5.0), at(0.3, 0.2, 5.0)];
    let [above, below] = [2.0, -1.0].map(|z| [&a[..], &[at(0.2, 0.25, z)], &still].concat());
    let impacts = detector(&above).continuous(&above, &below).unwrap().to_vec();
    assert_eq!(impacts.iter().map(|impact| impact.pair).collect::<Vec<_>>(), [(0, 1)]);
    assert!((impacts[0].time - 2.0 / 3.0).abs() < 1e-9, "{impacts:?}");
    // The corners are together at the start, and part.
    let [start, end] = [a[0], at(0.6, 0.6, -3.0)].map(|corner| [&a[..], &[corner], &still].concat());
    assert_eq!(detector(&start).discrete(&start).unwrap(), []);
    assert_eq!(detector(&start).discrete(&end).unwrap(), [(0, 1)]);
    for [t0, t1] in [[&start, &end], [&end, &start]] {
        assert_eq!(detector(&start).continuous(t0, t1).unwrap().len(), 1);
    }
    // If the corners stay together, only other common points count.
    let together = [&a[..], &a[..1], &[at(-1.0, 0.0, 0.0), at(0.0, -1.0, 0.0)]].concat();
    assert_eq!(detector(&together).discrete(&together).unwrap(), []);
    assert_eq!(detector(&together).continuous(&together, &together).unwrap(), []);
}

/// The mesh is only a few units in the last place wide, far from the origin.
#[test]
fn tiny_meshes_far_away() {
    let random = &mut Random::new(33);
    let faces: Vec<[u32; 3]> = (0..40).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    for steps in [1.0, 2.0, 5.0, 300.0] {
        let x: Vec<DVec3> = (0..120)
            .map(|_| {
                let unit = random.vector();
                DVec3::new(1e16 + (unit.x * steps).round() * 2.0, unit.y * steps, unit.z * steps)
            })
            .collect();
        let mesh = TriMesh::new(x.clone(), faces.clone()).unwrap();
        assert_eq!(Detector::new(&mesh).discrete(&x).unwrap(), brute_force(&x, &faces), "{steps}");
    }
}

#[test]
fn wrong_positions_are_refused() {
    let (rest, faces) = soup(&mut Random::new(1), 10, 1.0);
    let mut detector = Detector::new(&TriMesh::new(rest.clone(), faces).unwrap());
    let short = &rest[1..];
    let count = Err(Error::PositionCount { found: rest.len() - 1, vertices: rest.len() });
    assert_eq!(detector.discrete(short).map(<[Pair]>::len), count);
    assert_eq!(detector.continuous(&rest, short).map(<[Impact]>::len), count);
    assert_eq!(detector.clone().against(&rest, &mut detector.clone(), short).map(<[Pair]>::len), count);
    for wrong in [f64::NAN, f64::INFINITY, -1e61] {
        let mut x = rest.clone();
        x[7].y = wrong;
        assert!(matches!(detector.discrete(&x), Err(Error::Position { vertex: 7, .. })));
        assert!(!detector.statistics().complete);
        assert!(matches!(detector.continuous(&rest, &x), Err(Error::Position { vertex: 7, .. })));
    }
    assert!(detector.discrete(&rest).is_ok());
}

/// Two corners of each face are one vertex. If these corners have two positions, the faces meet between them, which is not a point
/// of the vertex. If one face has both corners at the vertex, there is no other common point.
#[test]
fn one_vertex_at_two_positions_is_no_edge() {
    let rest = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ZERO, DVec3::X, DVec3::Z];
    let mesh = TriMesh::new(rest.clone(), vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let filter = ContactFilter::new(Neighbours::IncludeOneVertex).weld(true);
    let mut detector = detector_with_weld_classes(&mesh, &[7, 7, 1, 7, 7, 2], &filter).unwrap();
    let mut answers = |x: &[DVec3]| {
        let pairs = detector.discrete(x).unwrap().to_vec();
        let impacts = detector.continuous(x, x).unwrap();
        assert_eq!(impacts.iter().map(|impact| impact.pair).collect::<Vec<_>>(), pairs, "{x:?}");
        pairs
    };
    assert_eq!(answers(&rest), [(0, 1)]);
    let together = [DVec3::ZERO, DVec3::ZERO, DVec3::Y, DVec3::ZERO, DVec3::X, DVec3::NEG_Z];
    assert!(answers(&together).is_empty());
}
