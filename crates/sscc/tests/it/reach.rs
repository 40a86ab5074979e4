//! Tests of radii beyond the paper's global radius: they are sound, they end at the reach, and certificates whose budget ends before
//! the global radius do not depend on the reach.

use sscc::parts::{Scope, is_within_reach};
use sscc::{Certificates, CertifyOptions, Error, Method, Metric, MetricKind, Modes, Query, ReducedModel};
use sscc_testing::{cases, threshold};

use crate::common::{Random, at, winding_strip};

fn certify(model: &ReducedModel, options: &CertifyOptions, reach: f64) -> Certificates {
    Certificates::compute(model, &options.clone().reach(reach), &()).unwrap()
}

/// Returns the global radius of the paper.
fn global_radius(model: &ReducedModel, options: &CertifyOptions) -> f64 {
    certify(model, &options.clone().budget(0).epsilon(0.9), 1.0).global_radius()
}

/// Returns the same shape with modes that hardly move one side of it, so that radii of nodes there are beyond the global radius.
fn stiff_on_one_side(model: &ReducedModel) -> ReducedModel {
    let (mesh, modes) = (model.mesh(), model.modes());
    let share = |x: f64| 0.02 + 0.98 * ((1.0 + x) / 2.0).clamp(0.0, 1.0).powi(3);
    let of_vertex =
        |v: usize| modes.of_vertex(v as u32).iter().map(move |u| *u * share(mesh.rest_positions()[v].x));
    let displacements = (0..modes.vertices()).flat_map(of_vertex).collect();
    ReducedModel::new(mesh.clone(), Modes::new(modes.rank(), displacements).unwrap()).unwrap()
}

/// Returns options of several metrics, some about a centre away from rest.
fn options(seed: u64, model: &ReducedModel, random: &mut Random) -> CertifyOptions {
    let (mesh, modes, rank) = (model.mesh(), model.modes(), model.rank());
    let metric = match seed % 4 {
        0 => Metric::displacement(mesh, modes).unwrap(),
        1 => Metric::mass(mesh, modes).unwrap(),
        2 => {
            let scales = Metric::displacement(mesh, modes).unwrap().scales();
            let scales = scales.iter().map(|scale| scale * random.power(-0.5, 0.5)).collect();
            Metric::from_scales(MetricKind::Given, scales).unwrap()
        }
        _ => {
            let scales = Metric::displacement(mesh, modes).unwrap().scales();
            let entry = |i: usize, j: usize| scales[i] * scales[j] * if i == j { 1.0 } else { 0.3 };
            let matrix: Vec<f64> = (0..rank * rank).map(|e| entry(e / rank, e % rank)).collect();
            Metric::from_matrix(MetricKind::Given, rank, &matrix).unwrap()
        }
    };
    let center = seed.is_multiple_of(3).then(|| {
        let scales = metric.scales();
        scales.iter().map(|scale| 0.02 * random.signed() / scale).collect()
    });
    let budget = if seed % 5 == 4 { 2 } else { 1 << 12 };
    CertifyOptions::default().epsilon(0.5).metric(metric).center(center).budget(budget)
}

/// Returns the q in a random direction whose norm is just below a radius; `None` if rounding prevents it.
fn just_inside(scope: &Scope, rank: usize, radius: f64, random: &mut Random) -> Option<(Vec<f64>, f64)> {
    let z: Vec<f64> = (0..rank).map(|_| random.signed()).collect();
    let length = z.iter().map(|z| z * z).sum::<f64>().sqrt();
    [1e-14, 1e-12, 1e-9].into_iter().find_map(|less| {
        let z: Vec<f64> = z.iter().map(|z| z / length * radius * (1.0 - less)).collect();
        let q = at(scope, &z);
        let offset: Vec<f64> = q.iter().zip(&scope.center).map(|(q, center)| q - center).collect();
        let norm = scope.metric.norm(&offset).unwrap();
        (norm < radius).then_some((q, norm))
    })
}

#[test]
fn radii_beyond_the_global_radius_are_sound() {
    let (mut colliding, mut proven, mut scopes) = (0, 0, [0; 3]);
    for seed in 0..cases(96_u64) {
        let random = &mut Random::new(seed + 7_000_000);
        let model = winding_strip(random, seed);
        let model = if seed.is_multiple_of(2) { stiff_on_one_side(&model) } else { model };
        let options = options(seed, &model, random);
        let (global, reach) = (global_radius(&model, &options), random.power(0.1, 1.2));
        let certificates = certify(&model, &options, reach);
        let (parts, hierarchy) = (certificates.parts(), &certificates.parts().hierarchy);
        let (scope, tree) = (&parts.scope, &parts.pair_tree);
        let kinds = [
            tree.limit() > global,
            scope.metric.dense_factor().is_some(),
            scope.center.iter().any(|c| *c != 0.0),
        ];
        scopes.iter_mut().zip(kinds).for_each(|(count, is)| *count += u32::from(is));
        let entries = tree.entries().map(|(radius, _)| f64::from(radius));
        let mut radii: Vec<f64> = entries.chain(parts.node_radii.iter().copied()).collect();
        radii.extend(parts.root_pair_radii.iter().copied().chain([tree.limit()]));
        radii.retain(|radius| *radius > global);
        let query = |method| Query::with_method(&model, &certificates, method).unwrap();
        let (mut oracle, mut certified) = (query(Method::BruteForce), query(Method::Certified));
        for case in 0..24 {
            // The norm is just inside a radius, or anywhere between the global radius and the limit.
            let goal = match radii.get(random.below(radii.len().max(1))) {
                Some(radius) if case % 2 == 0 => *radius,
                _ => global + random.uniform() * (tree.limit() - global),
            };
            let Some((q, norm)) = just_inside(scope, model.rank(), goal, random) else { continue };
            let Ok(expected) = oracle.discrete(&q) else { continue };
            assert_eq!(certified.discrete(&q).unwrap(), expected, "model {seed}, case {case}: {q:?}");
            let counted = expected.iter().filter(|pair| scope.exceptions.binary_search(pair).is_err());
            let collisions: Vec<[u32; 2]> = counted.map(|(a, b)| [*a, *b]).collect();
            colliding += usize::from(global < norm && norm < tree.limit() && !collisions.is_empty());
            for (n, node) in hierarchy.nodes().iter().enumerate().filter(|(n, _)| parts.node_radii[*n] > norm)
            {
                let triangles = hierarchy.triangles(node);
                let collides = collisions.iter().any(|pair| pair.iter().all(|t| triangles.contains(t)));
                assert!(!collides, "model {seed}, case {case}: node {n} at {norm}");
                proven += usize::from(norm > global);
            }
        }
    }
    assert!(colliding > threshold(300) && proven > threshold(100), "{colliding} {proven}");
    assert!(scopes.iter().all(|count| *count as usize > threshold(15)), "{scopes:?}");
}

#[test]
fn radii_end_where_the_reach_says() {
    let (mut farther, mut at_the_end) = (0, 0);
    for seed in 0..cases(24_u64) {
        let random = &mut Random::new(seed + 8_000_000);
        let model = winding_strip(random, seed);
        let options = options(seed, &model, random).budget(1 << 12);
        let global = global_radius(&model, &options);
        let without_tree = certify(&model, &options.clone().budget(0), 8.0);
        assert_eq!(without_tree.global_radius(), global);
        for reach in [1.0, 1.5, 8.0] {
            let certificates = certify(&model, &options, reach);
            let (parts, cap) = (certificates.parts(), certificates.global_radius());
            assert!(global <= cap && cap <= reach * global, "model {seed}");
            assert!(parts.pair_tree.limit() <= cap);
            assert!(parts.node_radii.iter().chain(&parts.root_pair_radii).all(|radius| *radius <= cap));
            assert!(is_within_reach(&certificates, &model, reach));
            assert_eq!(is_within_reach(&certificates, &model, 1.0), cap == global);
            farther += usize::from(cap > global);
            // If the budget is not used up, radii end at the reach, rounded down to single precision.
            at_the_end += usize::from(cap > reach * global * (1.0 - 1e-6));
        }
    }
    assert!(farther > threshold(30) && at_the_end > threshold(40), "{farther} {at_the_end}");
}

/// Fails if outer rounds up to the global radius used radii beyond it, or if there were rounds beyond it without budget for them.
#[test]
fn a_budget_that_ends_early_does_not_depend_on_the_reach() {
    let (mut early, mut farther) = (0, 0);
    for seed in 0..cases(32_u64) {
        let random = &mut Random::new(seed + 9_000_000);
        let model = winding_strip(random, seed);
        let options = options(seed, &model, random);
        for budget in [1, 2, 6, 24] {
            let [paper, near, far] =
                [1.0, 1.3, 16.0].map(|reach| certify(&model, &options.clone().budget(budget), reach));
            let limits = [&paper, &near, &far].map(|c| c.parts().pair_tree.limit());
            if limits[0] < paper.global_radius() {
                assert!(paper == near && paper == far, "model {seed}, budget {budget}: {limits:?}");
                early += 1;
            } else {
                assert!(limits[0] <= limits[1] && limits[0] <= limits[2], "model {seed}: {limits:?}");
                farther += usize::from(limits[0] < limits[2]);
            }
        }
    }
    assert!(early > threshold(20) && farther > threshold(20), "{early} {farther}");
}

#[test]
fn a_reach_out_of_range_is_refused() {
    let model = winding_strip(&mut Random::new(1), 1);
    for reach in [0.999, 0.0, -2.0, f64::NAN, f64::INFINITY] {
        let options = CertifyOptions::default().reach(reach);
        let error = Certificates::compute(&model, &options, &()).unwrap_err();
        assert!(matches!(error, Error::Option { name: "reach", .. }), "{error}");
    }
}
