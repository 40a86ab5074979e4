//! Groups of triangles: answers with groups are compared with all pairs by brute force without groups.

use std::sync::Arc;

use glam::DVec3;
use sscc::parts::{DEFAULT_EPSILON, GroupTable, Scope, check_filter};
use sscc::{
    AuditOptions, Certificates, CertifyOptions, Clearance, ContactFilter, Detector, Error, KineticQuery,
    Method, Modes, Pair, Query, ReducedModel, TriMesh, TriangleGroups, audit, distance_triangle_triangle,
};
use sscc_testing::{cases, threshold};

use crate::common::{
    Random, RandomOptions, Soup, at, random_choices, random_mesh, random_model, winding_strip,
};

/// Returns groups of consecutive triangles, so that some nodes have one group, or of any triangles, with a random table.
fn random_groups(random: &mut Random, triangles: usize) -> TriangleGroups {
    let count = 2 + random.below(4);
    let run = 1 + random.below(triangles);
    let is_run = random.below(3) > 0;
    let of = |t: usize, random: &mut Random| if is_run { t / run % count } else { random.below(count) };
    let of_triangle: Vec<u32> = (0..triangles).map(|t| of(t, random) as u32).collect();
    let groups = TriangleGroups::new(&of_triangle).unwrap();
    let count = GroupTable::from(&groups).count;
    let mut pair = || [random.below(count) as u32, random.below(count) as u32];
    let pairs = [pair(), pair(), pair()];
    match random.below(4) {
        0 => groups.between_only(),
        1 => groups.only(pairs).unwrap(),
        2 => groups.ignoring(pairs[..1].iter().copied()).unwrap(),
        _ => groups.ignoring(pairs).unwrap(),
    }
}

/// Returns a model and options with groups, by number.
fn sample(seed: u64) -> (ReducedModel, RandomOptions, TriangleGroups) {
    let random = &mut Random::new(seed + 40_000_000);
    let model = if seed.is_multiple_of(4) { winding_strip(random, seed) } else { random_model(seed) };
    let groups = random_groups(random, model.mesh().faces().len());
    let choices = random_choices(seed, &model);
    (model, choices, groups)
}

fn with_groups(options: &CertifyOptions, filter: &ContactFilter, groups: &TriangleGroups) -> CertifyOptions {
    options.clone().filter(filter.clone().with_groups(groups.clone()))
}

#[test]
fn all_methods_list_the_pairs_that_count() {
    let (mut compared, mut hits, mut left_out, mut impacts) = (0, 0, 0, 0);
    for seed in 0..cases(160) {
        let (model, RandomOptions { options, filter, .. }, groups) = sample(seed);
        let random = &mut Random::new(seed + 41_000_000);
        let options = with_groups(&options.epsilon(0.5), &filter, &groups);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let scope = certificates.parts().scope.clone();
        let ignored = scope.filter.ignored().to_vec();
        let is_counted =
            |(a, b): Pair| groups.is_pair_counted(a, b) && ignored.binary_search(&(a, b)).is_err();
        // The oracle uses neither groups nor ignored pairs.
        let plain = Scope { filter, exceptions: Vec::new(), ..Scope::clone(&scope) };
        let mut oracle = Query::without_certificates(&model, plain, Method::BruteForce).unwrap();
        let methods =
            [Method::Certified, Method::BdTree, Method::Traditional, Method::NormalCones, Method::BruteForce];
        let query = |method| Query::with_method(&model, &certificates, method).unwrap();
        let mut queries = methods.map(query);
        let mut kinetic = KineticQuery::new(&model, &certificates).unwrap();
        let mut detector = Detector::with_filter(model.mesh(), &scope.filter).unwrap();
        let has_welds = scope.filter.weld;
        let size = match certificates.root_radius() {
            root if root > 0.0 && root.is_finite() => root * random.power(-0.5, 1.0),
            _ => 1.0,
        };
        let mut last: Option<Vec<f64>> = None;
        for _ in 0..4 {
            let z: Vec<f64> = (0..model.rank()).map(|_| random.signed() * size).collect();
            let q = at(&scope, &z);
            let Ok(all) = oracle.discrete(&q) else { continue };
            let all = all.to_vec();
            let expected: Vec<Pair> = all.iter().copied().filter(|pair| is_counted(*pair)).collect();
            for (query, method) in queries.iter_mut().zip(methods) {
                assert_eq!(query.discrete(&q).unwrap(), expected, "model {seed} {method:?}");
            }
            assert_eq!(kinetic.discrete(&q).unwrap(), expected, "model {seed} kinetic");
            compared += 1;
            hits += expected.len();
            left_out += all.len() - expected.len();
            if !has_welds {
                let x = model.positions(&q).unwrap();
                assert_eq!(detector.discrete(&x).unwrap(), expected, "model {seed} detector");
            }
            let safe = queries[0].safe_scale(&q).unwrap();
            if safe >= 1.0 {
                assert!(expected.is_empty(), "model {seed}: safe scale {safe}");
            }
            if let Some(q_t0) = last.replace(q.clone()) {
                let Ok(all) = oracle.continuous(&q_t0, &q) else { continue };
                let expected: Vec<_> = all.iter().copied().filter(|hit| is_counted(hit.pair)).collect();
                for (query, method) in queries.iter_mut().zip(methods) {
                    assert_eq!(query.continuous(&q_t0, &q).unwrap(), expected, "model {seed} {method:?}");
                }
                if !has_welds {
                    let [x_t0, x_t1] = [&q_t0, &q].map(|q| model.positions(q).unwrap());
                    assert_eq!(detector.continuous(&x_t0, &x_t1).unwrap(), expected, "model {seed}");
                }
                impacts += expected.len();
            }
        }
    }
    let counts = (compared, hits, left_out, impacts);
    assert!(
        compared > threshold(300)
            && hits > threshold(1000)
            && left_out > threshold(1000)
            && impacts > threshold(1000),
        "{counts:?}"
    );
}

/// Excluding pairs of groups makes no radius smaller, up to the tolerance, and is the same as ignoring each of their
/// triangle pairs.
#[test]
fn pairs_that_do_not_count_do_not_limit_radii() {
    let (mut larger, mut compared) = (0, 0);
    for seed in 0..cases(80) {
        let (model, RandomOptions { options, filter, .. }, groups) = sample(seed);
        let options = options.ignore_rest(None);
        let certify = |options: &CertifyOptions| Certificates::compute(&model, options, &()).unwrap();
        let plain = certify(&options);
        let grouped = certify(&with_groups(&options, &filter, &groups));
        let count = model.mesh().faces().len() as u32;
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
        let one_by_one: Vec<Pair> = pairs.filter(|&(a, b)| !groups.is_pair_counted(a, b)).collect();
        let ignoring = certify(&options.filter(filter.ignoring(one_by_one)));
        assert_eq!(grouped.exceptions(), ignoring.exceptions(), "model {seed}");
        let smallest = (1.0 - DEFAULT_EPSILON) * (1.0 - 1e-9);
        let [a, b, c] = [&plain, &grouped, &ignoring].map(Certificates::root_radius);
        assert!(b >= a * smallest && b >= c * smallest && c >= b * smallest, "model {seed}: {a} {b} {c}");
        larger += usize::from(b > a);
        compared += 1;
    }
    assert!(larger > threshold(10), "{larger} of {compared}");
}

/// Returns two sheets that cross each other everywhere, and a third one that one mode lowers onto them.
fn crossing_sheets() -> (ReducedModel, Vec<u32>) {
    let side = 12;
    let sheet = |up: f64, tilt: f64| {
        (0..=side).flat_map(move |i| {
            (0..=side).map(move |j| {
                let x = DVec3::new(f64::from(i), f64::from(j), 0.0);
                DVec3::new(x.x, x.y, up + tilt * (x.x - 0.5 * f64::from(side)))
            })
        })
    };
    let p: Vec<DVec3> = sheet(0.0, 0.01).chain(sheet(0.0, -0.01)).chain(sheet(5.0, 0.0)).collect();
    let vertices = (side + 1) * (side + 1);
    let faces = (0..3).flat_map(|sheet| {
        (0..side * side).flat_map(move |i| {
            let a = sheet * vertices + i / side * (side + 1) + i % side;
            [[a, a + 1, a + side + 2], [a, a + side + 2, a + side + 1]]
        })
    });
    let lowered = |row: usize, _| {
        if row / 3 >= 2 * vertices as usize && row % 3 == 2 { -1.0 } else { 0.0 }
    };
    let modes = Modes::from_matrix(p.len(), 1, lowered).unwrap();
    let faces: Vec<[u32; 3]> = faces.collect();
    let of_triangle = (0..faces.len() as u32).map(|t| t / (2 * side * side)).collect();
    (ReducedModel::new(TriMesh::new(p, faces).unwrap(), modes).unwrap(), of_triangle)
}

#[test]
fn groups_that_cross_each_other_can_be_excluded() {
    let (model, of_triangle) = crossing_sheets();
    let groups = TriangleGroups::new(&of_triangle).unwrap();
    let certify = |groups: TriangleGroups| {
        let options =
            CertifyOptions::default().filter(ContactFilter::default().with_groups(groups)).max_exceptions(0);
        Certificates::compute(&model, &options, &()).unwrap()
    };
    assert_eq!(certify(groups.clone()).root_radius(), 0.0);
    // The highest point of the two is at 0.06.
    let without = certify(groups.clone().ignoring([[1, 0]]).unwrap());
    assert!((4.4..4.94).contains(&without.root_radius()), "{}", without.root_radius());
    assert_eq!(without.rest_collisions(), 0);
    let only = certify(groups.clone().only([[0, 0]]).unwrap());
    assert_eq!(only.root_radius(), only.global_radius());
    let report = audit(&model, &without, &AuditOptions::default().samples(200), &()).unwrap();
    assert_eq!(report.violations, [""; 0]);
    let mut query = Query::new(&model, &without).unwrap();
    let scale = query.safe_scale(&[10.0]).unwrap();
    assert!((0.49..=0.494).contains(&scale), "{scale}");
    assert!(
        query
            .discrete(&[4.95])
            .unwrap()
            .iter()
            .all(|(a, b)| of_triangle[*a as usize] < 2 && of_triangle[*b as usize] == 2)
    );
    assert!(!query.pairs().is_empty());
}

#[test]
fn other_groups_are_refused() {
    let (model, of_triangle) = crossing_sheets();
    let groups = TriangleGroups::new(&of_triangle).unwrap();
    let filter = |groups: TriangleGroups| ContactFilter::default().with_groups(groups);
    let options = |filter| CertifyOptions::default().filter(filter).max_exceptions(0).budget(0).epsilon(0.9);
    let certify = |filter| Certificates::compute(&model, &options(filter), &());
    let used = filter(groups.clone().between_only());
    let certificates = certify(used.clone()).unwrap();
    check_filter(&certificates, &used).unwrap();
    check_filter(&certificates, &filter(groups.clone().ignoring([[2, 2], [1, 1], [0, 0]]).unwrap())).unwrap();
    let message = |certificates: &Certificates, filter: &ContactFilter| {
        check_filter(certificates, filter).unwrap_err().to_string()
    };
    assert!(message(&certificates, &ContactFilter::default()).contains("which were not requested"));
    let other = filter(groups.clone().ignoring([[0, 1]]).unwrap());
    assert!(message(&certificates, &other).contains("differ from the requested ones"));
    // All pairs of groups count: that is the default.
    let plain = certify(filter(groups.clone())).unwrap();
    assert_eq!(plain.parts().digest, certify(ContactFilter::default()).unwrap().parts().digest);
    assert!(plain.filter().groups().is_none());
    assert!(message(&plain, &used).contains("without groups"));
    // A changed table or group changes the digest.
    let mut moved = of_triangle.clone();
    moved[7] = 1;
    let moved = filter(TriangleGroups::new(&moved).unwrap().between_only());
    for forged in [ContactFilter::default(), other, moved] {
        let mut parts = certificates.parts().clone();
        Arc::make_mut(&mut parts.scope).filter = forged;
        let forged = Certificates::try_from(parts).unwrap();
        assert!(matches!(Query::new(&model, &forged), Err(Error::OtherModel { .. })));
    }
    // Groups of another mesh.
    let short = filter(TriangleGroups::new(&of_triangle[1..]).unwrap().between_only());
    let expected = "groups: there are 863 group numbers for 864 triangles: one for each is needed";
    let refused = [
        certify(short.clone()).err(),
        Query::without_certificates(
            &model,
            Scope { filter: short.clone(), ..Scope::of(&model) },
            Method::BdTree,
        )
        .err(),
        Detector::with_filter(model.mesh(), &short).err(),
        short.clone().ignoring_rest(&model, 0).err(),
    ];
    refused.into_iter().for_each(|error| assert_eq!(error.unwrap().to_string(), expected));
    let mut parts = certificates.parts().clone();
    Arc::make_mut(&mut parts.scope).filter = short;
    let damaged = Certificates::try_from(parts).unwrap_err().to_string();
    assert!(damaged.contains("the number of group numbers is not the number of triangles"), "{damaged}");
    let mut parts = certificates.parts().clone();
    Arc::make_mut(&mut parts.scope).exceptions = vec![(0, 5)];
    let damaged = Certificates::try_from(parts).unwrap_err().to_string();
    assert!(damaged.contains("a pair is an exception, but its groups do not count"), "{damaged}");
    let shared: Arc<TriangleGroups> = Arc::new(groups.between_only());
    assert_eq!(ContactFilter::default().with_groups(shared), used);
}

/// Groups of several meshes apply between them in every query of two detectors; other groups do not.
#[test]
fn groups_of_several_meshes_hold_between_them() {
    let (mut counted, mut left_out) = (0, 0);
    for seed in 0..cases(80) {
        let random = &mut Random::new(seed + 42_000_000);
        let meshes = [(); 2].map(|()| {
            let (p, faces): Soup = random_mesh(random);
            let p = p.iter().map(|p| *p + random.vector() * 0.1).collect();
            TriMesh::new(p, faces).unwrap()
        });
        let counts = [0, 1].map(|m| meshes[m].faces().len());
        let scene = random_groups(random, counts[0] + counts[1]);
        let of_meshes = scene.of_meshes(&counts).unwrap();
        // Files do not store that groups apply between meshes: the value is the same.
        assert_eq!(scene.of_meshes(&[counts[0] + counts[1]]).unwrap()[0], scene, "seed {seed}");
        let is_counted = |(a, b): Pair| scene.is_pair_counted(a, counts[0] as u32 + b);
        let ends = [0, 1].map(|m| -> Vec<DVec3> {
            meshes[m].rest_positions().iter().map(|p| *p + random.vector() * 0.2).collect()
        });
        let x = [0, 1].map(|m| meshes[m].rest_positions());
        let clearance = Clearance::new(0.2).unwrap();
        let detectors = |groups: [TriangleGroups; 2]| {
            let mut groups = groups.into_iter();
            meshes.each_ref().map(|mesh| {
                let filter = ContactFilter::default().with_groups(groups.next().unwrap());
                Detector::with_filter(mesh, &filter).unwrap()
            })
        };
        let [mut one, mut two] = meshes.each_ref().map(Detector::new);
        let all = one.against(x[0], &mut two, x[1]).unwrap().to_vec();
        let impacts = one.continuous_against([x[0], &ends[0]], &mut two, [x[1], &ends[1]]).unwrap().to_vec();
        let near = one.within_against(x[0], &mut two, x[1], &clearance).unwrap().to_vec();
        let corners = |m: usize, t: usize| meshes[m].faces()[t].map(|v| x[m][v as usize]);
        let every = (0..counts[0]).flat_map(|a| (0..counts[1]).map(move |b| (a as u32, b as u32)));

        let [mut one, mut two] = detectors(of_meshes.clone().try_into().unwrap());
        let kept: Vec<Pair> = all.iter().copied().filter(|pair| is_counted(*pair)).collect();
        assert_eq!(one.against(x[0], &mut two, x[1]).unwrap(), kept, "seed {seed}");
        let some = one.against_at_most(x[0], &mut two, x[1], 1).unwrap();
        assert!(
            some.len() == kept.len().min(1) && some.iter().all(|pair| kept.contains(pair)),
            "seed {seed}"
        );
        let found = one.continuous_against([x[0], &ends[0]], &mut two, [x[1], &ends[1]]).unwrap();
        assert!(found.iter().eq(impacts.iter().filter(|impact| is_counted(impact.pair))), "seed {seed}");
        let found = one.within_against(x[0], &mut two, x[1], &clearance).unwrap();
        assert!(found.iter().eq(near.iter().filter(|near| is_counted(near.pair))), "seed {seed}");
        let distance =
            |(a, b): Pair| distance_triangle_triangle(&corners(0, a as usize), &corners(1, b as usize));
        let distances = every.filter(|pair| is_counted(*pair)).map(distance);
        let nearest = one.nearest_against(x[0], &mut two, x[1]).unwrap();
        assert_eq!(nearest.map(|near| near.distance), distances.reduce(f64::min), "seed {seed}");
        counted += kept.len();
        left_out += all.len() - kept.len();

        // The same groups, for each mesh alone.
        let single = [0, 1].map(|m| {
            let numbers: Vec<u32> = (0..counts[m]).map(|t| (t % 2) as u32).collect();
            TriangleGroups::new(&numbers).unwrap().between_only()
        });
        let [mut one, mut two] = detectors(single);
        assert_eq!(one.against(x[0], &mut two, x[1]).unwrap(), all, "seed {seed}");
        // Groups of several meshes, of two scenes.
        let others = TriangleGroups::new(&vec![0; counts[0] + counts[1]]).unwrap().between_only();
        let others = others.of_meshes(&counts).unwrap();
        let [mut one, _] = detectors(of_meshes.try_into().unwrap());
        let [_, mut two] = detectors(others.try_into().unwrap());
        if GroupTable::from(&scene).count > 1 {
            assert_eq!(one.against(x[0], &mut two, x[1]).unwrap(), all, "seed {seed}");
        }
        // The same groups, created again, count as those of other meshes.
        let [mut one, _] = detectors(scene.of_meshes(&counts).unwrap().try_into().unwrap());
        let [_, mut two] = detectors(scene.of_meshes(&counts).unwrap().try_into().unwrap());
        assert_eq!(one.against(x[0], &mut two, x[1]).unwrap(), all, "seed {seed}");
        let message = scene.of_meshes(&counts[..1]).unwrap_err().to_string();
        assert!(message.contains(&format!("the meshes have {}", counts[0])), "{message}");
        assert!(scene.of_meshes(&[usize::MAX, 2]).is_err());
    }
    assert!(counted > threshold(60) && left_out > threshold(20), "{counted} {left_out}");
}
