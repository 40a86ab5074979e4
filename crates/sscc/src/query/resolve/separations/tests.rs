use super::*;
use crate::certificates::Scope;
use crate::query::query::Query;
use crate::test_models::{Random, strips};
use crate::{ContactFilter, Method, Metric, MetricKind, Modes, Neighbours, ReducedModel, TriMesh};

/// Displacements within the half-spaces of all pairs keep all pairs free; at the most violated half-space the gap is the
/// margin.
#[test]
fn displacements_within_the_half_spaces_are_free() {
    let (mut kept, mut cut, mut collided) = (0, 0, 0);
    for case in 0..300 {
        let random = &mut Random(case as u64 + 1);
        let (model, half) = strips(random, case);
        let rank = model.rank();
        let filter = ContactFilter::new([Neighbours::Exclude, Neighbours::IncludeOneVertex][case % 2]);
        let scope = Scope { filter, ..Scope::of(&model) };
        let mut query = Query::without_certificates(&model, scope.clone(), Method::BruteForce).unwrap();
        let start: Vec<f64> = (0..rank).map(|_| random.signed() * 0.05).collect();
        if query.first(&start).unwrap().is_some() {
            continue;
        }
        let mut separations = Separations::new(rank);
        for a in 0..2 * half {
            for b in a + 1..2 * half {
                let is_added = separations.add(&query.context, &start, (a, b), 1e-6);
                let counts = query.context.detect.filter.simplex_pairs(a, b).next().is_some();
                assert!(is_added == counts && separations.contains((a, b)), "case {case}: {a} {b}");
            }
        }
        for _ in 0..4 {
            let displacement: Vec<f64> = (0..rank).map(|_| random.signed() * 3.0).collect();
            let at = |share: f64| -> Vec<f64> {
                let z: Vec<f64> = displacement.iter().map(|s| s * share).collect();
                start.iter().zip(scope.metric.unscale(&z)).map(|(q, d)| q + d).collect()
            };
            let share = separations.allowed_share(&displacement);
            assert!(query.first(&at(share)).unwrap().is_none(), "case {case}");
            let violated = separations.most_violated(&displacement, 100);
            assert_eq!(violated.is_empty(), share >= 1.0, "case {case}");
            kept += usize::from(violated.is_empty());
            collided += usize::from(query.first(&at(1.0)).unwrap().is_some());
            let Some((normal, offset)) = violated.first() else { continue };
            cut += 1;
            // The most violated half-space comes first, and the origin violates no half-space.
            let depth =
                |(normal, offset): &(Vec<f64>, f64)| (offset - dot(normal, &displacement)) / length(normal);
            assert!(violated.iter().all(|other| depth(other) <= depth(&violated[0]) * (1.0 + 1e-12)));
            assert!(dot(normal, &displacement) < *offset && *offset <= 0.0, "case {case}: {offset}");
        }
        let near = separations.take_near(f64::INFINITY);
        assert!(!near.is_empty() && !separations.contains(near[0]) && separations.take_near(1e9).is_empty());
    }
    assert!(kept > 100 && cut > 100 && collided > 50, "{kept} {cut} {collided}");
}

/// Modes that move none of the six corners of a pair change none of its half-spaces, whatever their weights.
#[test]
fn modes_that_move_other_triangles_change_no_half_space() {
    let (mut added, mut violated) = (0, 0);
    for case in 0..200 {
        let random = &mut Random(case as u64 + 1000);
        let (model, half) = strips(random, case);
        let rank = model.rank();
        // A further triangle far away has a mode of its own before each mode of the strips.
        let rest = model.mesh().rest_positions();
        let first = rest.len() as u32;
        let far = [DVec3::X, DVec3::Y, DVec3::Z].map(|p| p + DVec3::splat(100.0));
        let positions = [rest, &far].concat();
        let faces = [model.mesh().faces(), &[[first, first + 1, first + 2]]].concat();
        let of_strips = (0..first).flat_map(|v| model.modes().of_vertex(v)).flat_map(|u| [DVec3::ZERO, *u]);
        let mut modes: Vec<DVec3> = of_strips.collect();
        modes.extend((0..3 * rank).flat_map(|_| [random.vector(), DVec3::ZERO]));
        let scales: Vec<f64> = (0..rank).map(|_| random.power(-1.0, 1.0)).collect();
        let mut wide =
            |row: &[f64]| row.iter().flat_map(|x| [random.power(-1.0, 1.0), *x]).collect::<Vec<_>>();
        let metric = |scales| Metric::from_scales(MetricKind::Given, scales).unwrap();
        let mesh = TriMesh::new(positions, faces).unwrap();
        let modes = Modes::new(2 * rank, modes).unwrap();
        let with_far = ReducedModel::with_metric(mesh, modes, metric(wide(&scales))).unwrap();
        let (mesh, modes) = (model.mesh().clone(), model.modes().clone());
        let model = ReducedModel::with_metric(mesh, modes, metric(scales)).unwrap();
        let [query, with_far] = [&model, &with_far]
            .map(|model| Query::without_certificates(model, Scope::of(model), Method::BruteForce).unwrap());
        let [mut separations, mut of_all] = [rank, 2 * rank].map(Separations::new);
        let start = vec![0.01; rank];
        let wide_start = wide(&start);
        for (a, b) in (0..2 * half).flat_map(|a| (a + 1..2 * half).map(move |b| (a, b))) {
            let is_added = separations.add(&query.context, &start, (a, b), 1e-6);
            assert_eq!(of_all.add(&with_far.context, &wide_start, (a, b), 1e-6), is_added);
            added += usize::from(is_added);
        }
        let displacement = vec![3.0 * (case as f64).sin(); rank];
        let wide_displacement = wide(&displacement);
        assert_eq!(separations.allowed_share(&displacement), of_all.allowed_share(&wide_displacement));
        let expected = separations.most_violated(&displacement, 100);
        let found = of_all.most_violated(&wide_displacement, 100);
        assert_eq!(found.len(), expected.len(), "case {case}");
        for ((normal, offset), (expected, expected_offset)) in found.iter().zip(&expected) {
            let of_strips: Vec<f64> = expected.iter().flat_map(|rate| [0.0, *rate]).collect();
            assert_eq!((normal, offset), (&of_strips, expected_offset), "case {case}");
        }
        violated += found.len();
        assert_eq!(separations.take_near(1.0), of_all.take_near(1.0), "case {case}");
    }
    assert!(added > 1000 && violated > 1000, "{added} {violated}");
}

/// Only the first corner of one triangle moves.
#[test]
fn half_spaces_of_a_single_entry_are_those_of_its_corner() {
    let p = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
    let modes = (0..6).map(|v| if v == 0 { DVec3::Z } else { DVec3::ZERO }).collect();
    let mesh = TriMesh::new(p, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let model = ReducedModel::with_metric(mesh, Modes::new(1, modes).unwrap(), Metric::identity(1)).unwrap();
    let query = Query::without_certificates(&model, Scope::of(&model), Method::BruteForce).unwrap();
    let mut separations = Separations::new(1);
    assert!(separations.add(&query.context, &[0.0], (0, 1), 0.25));
    assert!((separations.allowed_share(&[3.0]) - 0.25).abs() < 1e-3);
}
