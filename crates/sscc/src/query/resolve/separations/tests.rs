use super::*;
use crate::certificates::Scope;
use crate::query::query::Query;
use crate::test_models::{Random, strips};
use crate::{ContactFilter, Method, Neighbours};

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
