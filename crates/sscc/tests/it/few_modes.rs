//! Models in which few modes move each vertex, as in skinned meshes with twelve modes for each bone.

use glam::{DMat3, DVec3};
use sscc::parts::{Aabb, Pose, PosedShape, SweptShape};
use sscc::{
    Certificates, CertifyOptions, Detector, KineticQuery, Method, Modes, Pair, Query, ReducedModel,
    ResolveOptions, TriMesh, intersect_triangle_triangle,
};
use sscc_testing::Numbers;

use crate::sweep::check;

const BONES: usize = 12;
const LENGTH: usize = 66;
const AROUND: usize = 12;

/// Returns a tube along x with the modes of the affine maps of each bone: at most two bones move a vertex, one bone the ends.
fn tube() -> ReducedModel {
    let (mut positions, mut modes) = (Vec::new(), Vec::new());
    for i in 0..=LENGTH {
        let along = i as f64 * (BONES - 1) as f64 / LENGTH as f64;
        for j in 0..AROUND {
            let angle = j as f64 * std::f64::consts::TAU / AROUND as f64;
            let p = DVec3::new(along, 0.3 * angle.cos(), 0.3 * angle.sin());
            let mut of_vertex = [DVec3::ZERO; 12 * BONES];
            for (bone, of_bone) in of_vertex.chunks_exact_mut(12).enumerate() {
                let weight = (1.0 - (along - bone as f64).abs()).max(0.0);
                let factors = [p.x - bone as f64, p.y, p.z, 1.0];
                for (k, u) in of_bone.iter_mut().enumerate() {
                    *u = DVec3::AXES[k % 3] * (weight * factors[k / 3]);
                }
            }
            positions.push(p);
            modes.extend(of_vertex);
        }
    }
    let vertex = |i: usize, j: usize| (i * AROUND + j % AROUND) as u32;
    let cells = (0..LENGTH * AROUND).map(|c| (c / AROUND, c % AROUND));
    let faces = cells.flat_map(|(i, j)| {
        let [a, b, c, d] = [vertex(i, j), vertex(i, j + 1), vertex(i + 1, j), vertex(i + 1, j + 1)];
        [[a, b, c], [b, d, c]]
    });
    // At most a quarter of the displacements are nonzero, so that queries list the modes of each vertex.
    let moving = modes.iter().filter(|u| **u != DVec3::ZERO).count();
    assert!(5 * moving < modes.len(), "{moving} of {}", modes.len());
    let mesh = TriMesh::new(positions, faces.collect()).unwrap();
    ReducedModel::new(mesh, Modes::new(12 * BONES, modes).unwrap()).unwrap()
}

/// Returns the q of a chain of bones whose joints rotate by up to an angle.
fn pose(random: &mut Numbers, angle: f64) -> Vec<f64> {
    let (mut turned, mut at) = (DMat3::IDENTITY, DVec3::ZERO);
    let mut q = Vec::new();
    for bone in 0..BONES {
        let axis = DVec3::new(random.signed(), random.signed(), random.signed());
        turned *= DMat3::from_axis_angle(axis.normalize_or(DVec3::Z), angle * random.signed());
        let map = turned - DMat3::IDENTITY;
        q.extend(map.to_cols_array());
        q.extend((at - DVec3::new(bone as f64, 0.0, 0.0)).to_array());
        at += turned * DVec3::X;
    }
    q
}

#[test]
fn answers_are_those_of_brute_force_and_of_the_positions() {
    let (model, random) = (tube(), &mut Numbers(5));
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let methods = [Method::Certified, Method::Traditional, Method::BdTree, Method::NormalCones];
    let mut queries = methods.map(|method| Query::with_method(&model, &certificates, method).unwrap());
    let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
    let mut kinetic = KineticQuery::new(&model, &certificates).unwrap();
    let mut detector = Detector::new(model.mesh());
    let (mut free, mut hits, mut last) = (0, 0, vec![0.0; model.rank()]);
    kinetic.discrete(&last).unwrap();
    for case in 0..40 {
        let q = pose(random, [0.05, 0.5, 2.0, 3.0][case % 4]);
        let expected: Vec<Pair> = oracle.discrete(&q).unwrap().to_vec();
        let vertices = model.mesh().rest_positions().len() as u32;
        let positions: Vec<DVec3> = (0..vertices).map(|v| model.position(v, &q)).collect();
        assert_eq!(detector.discrete(&positions).unwrap(), expected);
        for query in &mut queries {
            assert_eq!(query.discrete(&q).unwrap(), expected, "case {case}");
        }
        assert_eq!(kinetic.discrete(&q).unwrap(), expected, "case {case}");
        if case % 4 < 2 {
            let impacts = oracle.continuous(&last, &q).unwrap().to_vec();
            assert_eq!(queries[0].continuous(&last, &q).unwrap(), impacts, "case {case}");
            assert_eq!(kinetic.continuous(&last, &q).unwrap(), impacts, "case {case}");
        }
        if case % 8 == 7 {
            let all = [q.clone(), last.clone(), q.clone()];
            let answers = queries[0].batch(&all, Some(1), &()).unwrap();
            assert!([0, 2].iter().all(|i| answers[*i].pairs == expected), "case {case}");
        }
        (free, hits) = (free + usize::from(expected.is_empty()), hits + expected.len());
        last = q;
        kinetic.discrete(&last).unwrap();
    }
    assert!(free > 10 && hits > 100, "{free} {hits}");
}

/// Compares safe scales, sweeps and free configurations with brute force.
#[test]
fn safe_scales_sweeps_and_free_configurations_have_no_collision() {
    let (model, random) = (tube(), &mut Numbers(6));
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let mut query = Query::new(&model, &certificates).unwrap();
    let mut oracle = Query::with_method(&model, &certificates, Method::BruteForce).unwrap();
    let (mut scaled, mut swept, mut resolved) = (0, 0, 0);
    for case in 0..6 {
        let q = pose(random, [0.05, 1.0, 3.0][case % 3]);
        let scale = query.safe_scale(&q).unwrap();
        for share in [0.1, 0.5, 0.9, 1.0] {
            let at: Vec<f64> = q.iter().map(|x| x * scale.min(1.0) * share).collect();
            assert_eq!(oracle.first(&at).unwrap(), None, "case {case}, {share} of {scale}");
        }
        scaled += usize::from(scale < 1.0);
        if oracle.first(&q).unwrap().is_none() {
            let mode = 12 * (case % BONES) + 9 + case % 3;
            let sweep = query.sweep(&q, mode, q[mode] + if case % 2 == 0 { 3.0 } else { -3.0 }).unwrap();
            check(&sweep, &model, &q, &mut oracle, 6);
            swept += usize::from(sweep.first_hit.is_some());
        } else if let Some(found) = query.resolve(&q, &ResolveOptions::default()).unwrap().q {
            assert_eq!(oracle.first(&found).unwrap(), None, "case {case}");
            resolved += 1;
        }
    }
    assert!(scaled > 1 && swept > 0 && resolved > 0, "{scaled} {swept} {resolved}");
}

/// Compares two shapes in the world, at rest and in motion, with all pairs of their triangles.
#[test]
fn pairs_of_posed_shapes_are_those_of_all_triangles() {
    let (model, random) = (tube(), &mut Numbers(7));
    let [mut x, mut y] = [(); 2].map(|()| PosedShape::without_certificates(&model).unwrap());
    let [mut moving, mut resting] = [&x, &y].map(|shape| SweptShape::new(shape).unwrap());
    let (mut pairs, mut impacts) = (Vec::new(), Vec::new());
    let (mut found, mut met) = (0, 0);
    for case in 0..6 {
        let (q, r) = (pose(random, 0.5), pose(random, 1.0));
        let [here, there] = [0.0, 0.4 * f64::from(case)]
            .map(|z| Pose { translation: DVec3::new(0.3, 0.1, z), ..Pose::default() });
        x.place(&q, &here).unwrap();
        y.place(&r, &there).unwrap();
        pairs.clear();
        x.colliding(&mut y, Aabb::default(), &mut pairs).unwrap();
        let faces = model.mesh().faces().len() as u32;
        let corners = [&x, &y].map(|shape| (0..faces).map(|t| shape.corners(t)).collect::<Vec<_>>());
        let mut expected = Vec::new();
        for (i, a) in (0..).zip(&corners[0]) {
            let meets = |b: &[DVec3; 3]| intersect_triangle_triangle(a, b);
            expected.extend((0..).zip(&corners[1]).filter(|(_, b)| meets(b)).map(|(j, _): (u32, _)| (i, j)));
        }
        assert_eq!(pairs, expected, "case {case}");
        // A motion that ends at this pose lists at least these pairs.
        moving.place([&q, &q], [&Pose { translation: DVec3::Z * -9.0, ..here }, &here]).unwrap();
        resting.place([&r, &r], [&there, &there]).unwrap();
        impacts.clear();
        moving.impacts(&mut resting, Aabb::default(), &mut impacts).unwrap();
        for pair in &pairs {
            assert!(
                impacts.binary_search_by_key(pair, |impact| impact.pair).is_ok(),
                "case {case}: {pair:?}"
            );
        }
        (found, met) = (found + pairs.len(), met + impacts.len());
    }
    assert!(found > 20 && met > found, "{found} {met}");
}
