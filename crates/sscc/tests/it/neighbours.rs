//! Tests of triangles that share a vertex, and of split vertices.

use std::sync::Arc;

use glam::DVec3;
use sscc::parts::{Scope, check_filter, intersect_shared_vertex_pair};
use sscc::{
    Certificates, CertifyOptions, ContactFilter, Error, Method, Modes, Neighbours, Query, ReducedModel,
    TriMesh, intersect_triangle_triangle,
};
use sscc_testing::{cases, threshold};

use crate::common::{Random, at, random_model};

/// Tests the second triangle without a small neighbourhood of v, as two triangles, against the first. For corners with
/// coordinates up to 8 this is exact: common points beyond v reach an opposite edge, at least 1/16 of the way to the
/// farthest corner, or the end of a degenerate triangle.
fn oracle(v: DVec3, x: [DVec3; 2], y: [DVec3; 2]) -> bool {
    let near = |p: DVec3| v + (p - v) * 2.0_f64.powi(-20);
    let ends = y.map(near);
    let first = [v, x[0], x[1]];
    // Both ends of the strip around a segment through v are tested.
    let strip = [[ends[0], ends[1], y[0]], [ends[1], y[0], y[1]]];
    let through = intersect_triangle_triangle(&[v; 3], &[y[0], y[1], y[1]]);
    if through {
        return y.into_iter().any(|p| p != v && intersect_triangle_triangle(&first, &[near(p), p, p]));
    }
    strip.iter().any(|part| intersect_triangle_triangle(&first, part))
}

#[test]
fn common_points_beyond_a_shared_vertex_are_found_exactly() {
    let random = &mut Random::new(11);
    let (mut met, mut flat) = (0, 0);
    let cases = cases(300_000);
    for case in 0..cases {
        let size = [1.2, 2.2, 4.2][case % 3];
        let mut corner = || (random.vector() * size).round();
        let v = corner();
        let (mut x, mut y) = ([corner(), corner()], [corner(), corner()]);
        // Degenerate triangles, and triangles in one plane.
        match case % 8 {
            0 => x[1] = v * 2.0 - x[0],
            1 => y[1] = y[0],
            2 => x[0] = v,
            3 | 4 => [x[0].z, x[1].z, y[0].z, y[1].z] = [v.z; 4],
            _ => {}
        }
        let found = intersect_shared_vertex_pair(v, x, y);
        assert_eq!(found, oracle(v, x, y), "{v} {x:?} {y:?}");
        let others = [
            intersect_shared_vertex_pair(v, y, x),
            intersect_shared_vertex_pair(v, [x[1], x[0]], y),
            intersect_shared_vertex_pair(v, x, [y[1], y[0]]),
        ];
        assert_eq!(others, [found; 3], "{v} {x:?} {y:?}");
        met += usize::from(found);
        flat += usize::from(found && case % 8 < 5);
    }
    assert!(met > cases / 10 && met < cases * 9 / 10 && flat > cases / 20, "{met} {flat}");
}

/// Two triangles have a common corner; one is at rest, the other is lowered through it.
#[test]
fn shared_vertex_pairs_are_found_on_request() {
    let p = vec![
        DVec3::ZERO,
        DVec3::new(2.0, -1.0, -1.0),
        DVec3::new(2.0, 1.0, -1.0),
        DVec3::new(1.0, 0.0, 1.0),
        DVec3::new(3.0, 0.0, 1.0),
    ];
    let mesh = TriMesh::new(p, vec![[0, 1, 2], [0, 3, 4]]).unwrap();
    let lowered = |row: usize, _| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 };
    let model = ReducedModel::new(mesh, Modes::from_matrix(5, 1, lowered).unwrap()).unwrap();
    let certify = |neighbours| {
        let options = CertifyOptions::default().filter(ContactFilter::new(neighbours));
        Certificates::compute(&model, &options, &()).unwrap()
    };
    let (excluding, including) = (certify(Neighbours::Exclude), certify(Neighbours::IncludeOneVertex));
    assert_eq!(excluding.root_radius(), excluding.global_radius());
    // The upper one's far corner is 2.5 above the plane of the lower one, the near one 1.5.
    let root = including.root_radius();
    assert!((1.35..1.5).contains(&root), "{root}");
    for method in [Method::Certified, Method::BdTree, Method::Traditional, Method::BruteForce] {
        let mut without = Query::with_method(&model, &excluding, method).unwrap();
        let mut with = Query::with_method(&model, &including, method).unwrap();
        for (q, collides) in
            [(0.0, false), (1.4, false), (1.6, true), (2.0, true), (2.6, false), (4.0, false)]
        {
            assert!(without.discrete(&[q]).unwrap().is_empty());
            assert_eq!(!with.discrete(&[q]).unwrap().is_empty(), collides, "{method:?} {q}");
        }
    }
    let asked = ContactFilter::new(Neighbours::IncludeOneVertex);
    let error = check_filter(&excluding, &asked).unwrap_err();
    assert!(matches!(error, Error::OtherPairs { .. }), "{error}");
    assert!(
        error.to_string().contains("neighbours = exclude, but include-one-vertex was requested"),
        "{error}"
    );
    check_filter(&including, &asked).unwrap();
    // A changed contact filter changes the digest.
    let mut parts = excluding.parts().clone();
    Arc::make_mut(&mut parts.scope).filter = asked;
    let forged = Certificates::try_from(parts).unwrap();
    assert!(matches!(Query::new(&model, &forged), Err(Error::OtherModel { .. })));
}

/// A shape with some corners on new vertices has the same pairs when it is welded.
#[test]
fn welded_shapes_have_the_pairs_of_shapes_without_split_vertices() {
    let (mut compared, mut differed, mut hits) = (0, 0, 0);
    for seed in 0..cases(400) {
        let whole = random_model(seed);
        let random = &mut Random::new(seed + 5_000_000);
        let (mesh, modes) = (whole.mesh(), whole.modes());
        let (mut p, mut u) = (mesh.rest_positions().to_vec(), modes.displacements().to_vec());
        let mut faces = mesh.faces().to_vec();
        for corner in faces.iter_mut().flatten() {
            if random.below(2) == 0 {
                let v = *corner as usize;
                // +0 and -0 are the same number.
                let sign = |x: DVec3| DVec3::select(x.cmpeq(DVec3::ZERO), -x, x);
                p.push(sign(p[v]));
                u.extend(modes.of_vertex(v as u32).iter().map(|x| sign(*x)));
                *corner = p.len() as u32 - 1;
            }
        }
        let split = TriMesh::new(p, faces).unwrap();
        let modes = Modes::new(modes.rank(), u).unwrap();
        let split = ReducedModel::with_metric(split, modes, whole.metric().clone()).unwrap();
        for neighbours in [Neighbours::Exclude, Neighbours::IncludeOneVertex] {
            let scope =
                |weld| Scope { filter: ContactFilter::new(neighbours).weld(weld), ..Scope::of(&whole) };
            let query = |model, weld| Query::without_certificates(model, scope(weld), Method::Traditional);
            // The shape without split vertices may have other equal vertices.
            let (mut a, mut b) = (query(&whole, true).unwrap(), query(&split, true).unwrap());
            let mut unwelded = query(&split, false).unwrap();
            for size in [0.0, 0.3, 3.0] {
                let z: Vec<f64> = (0..whole.rank()).map(|_| random.signed() * size).collect();
                let q = at(&scope(true), &z);
                let Ok(expected) = a.discrete(&q) else { continue };
                assert_eq!(b.discrete(&q).unwrap(), expected, "model {seed}");
                compared += 1;
                hits += usize::from(!expected.is_empty());
                differed += usize::from(unwelded.discrete(&q).unwrap() != expected);
            }
        }
    }
    assert!(
        compared > threshold(2000) && hits > threshold(400) && differed > threshold(1000),
        "{compared} {hits} {differed}"
    );
}

/// Ignored pairs are never listed and limit no radius.
#[test]
fn rest_collisions_can_be_ignored() {
    let mut seen = 0;
    for seed in 0..cases(200) {
        let model = random_model(seed);
        let options = CertifyOptions::default().epsilon(0.9).threads(1);
        let mut plain = Query::without_certificates(&model, Scope::of(&model), Method::BruteForce).unwrap();
        let rest = plain.discrete(&vec![0.0; model.rank()]).unwrap().to_vec();
        if rest.is_empty() || model.rank() < 3 {
            continue;
        }
        seen += 1;
        let options = options.ignore_rest(0);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        assert_eq!((certificates.filter().ignored(), certificates.exceptions()), (&rest[..], &[][..]));
        let filter = ContactFilter::default().ignoring_rest(&model, 0).unwrap();
        assert_eq!(certificates.filter(), &filter);
        assert!(check_filter(&certificates, &ContactFilter::default()).is_err());
        let mut query = Query::new(&model, &certificates).unwrap();
        let random = &mut Random::new(seed);
        for _ in 0..5 {
            let z: Vec<f64> = (0..model.rank()).map(|_| random.signed() * random.power(-2.0, 1.0)).collect();
            let q = certificates.metric().unscaled(&z).unwrap();
            let Ok(all) = plain.discrete(&q) else { continue };
            let mut expected = all.to_vec();
            expected.retain(|pair| !rest.contains(pair));
            assert_eq!(query.discrete(&q).unwrap(), expected, "model {seed}");
        }
    }
    assert!(seen > threshold(20), "{seen}");
}

#[test]
fn ignored_pairs_are_a_sorted_set() {
    let filter = ContactFilter::default().ignoring([(5, 2), (1, 7), (2, 5), (0, 3)]);
    assert_eq!(filter.ignored(), [(0, 3), (1, 7), (2, 5)]);
    assert_eq!(filter.clone().ignoring([]), filter);
}

#[test]
fn values_are_read_by_their_names() {
    for value in [Neighbours::Exclude, Neighbours::IncludeOneVertex, Neighbours::IncludeFolded] {
        assert_eq!(value.to_string().parse(), Ok(value));
    }
    let error = "some".parse::<Neighbours>().unwrap_err().to_string();
    assert_eq!(
        error,
        "'some' is no rule for neighbours: use one of exclude, include-one-vertex, include-folded"
    );
    assert_eq!(format!("{:>8}", Method::BdTree), "  bdtree");
}
