//! Models of several buckets: skipped pairs never count, for any contact filter, size and kind of mesh.

use glam::DVec3;
use sscc::parts::Scope;
use sscc::{ContactFilter, Method, Modes, Neighbours, Query, ReducedModel, TriMesh};
use sscc_testing::{cases, threshold};

use crate::common::{Random, Soup, random_mesh};

/// Returns one mesh of several small meshes of all kinds, of about the same size, that cross each other.
fn heap(random: &mut Random) -> Soup {
    let (mut p, mut faces): Soup = (Vec::new(), Vec::new());
    while faces.len() < 150 + 50 * random.below(8) {
        let (points, triangles) = random_mesh(random);
        let size = points.iter().fold(f64::MIN_POSITIVE, |m, p| m.max(p.abs().max_element()));
        let (place, first) = (random.vector() * 2.0, p.len() as u32);
        p.extend(points.iter().map(|p| *p / size + place));
        faces.extend(triangles.iter().map(|face| face.map(|v| v + first)));
    }
    (p, faces)
}

/// Returns a folded fan of more triangles around one vertex than have adjacency masks.
fn fan(random: &mut Random) -> Soup {
    let count = 100 + random.below(100) as u32;
    let mut p = vec![DVec3::ZERO];
    p.extend((0..=count).map(|_| random.vector()));
    (p, (0..count).map(|t| [0, t + 1, t + 2]).collect())
}

/// Gives some corners new vertices at the same position.
fn split(random: &mut Random, (p, faces): &mut Soup) {
    for corner in faces.iter_mut().flatten() {
        if random.below(5) == 0 {
            p.push(p[*corner as usize]);
            *corner = p.len() as u32 - 1;
        }
    }
}

/// Returns a model with modes that are functions of the position, so that equal vertices can be welded.
fn bent(random: &mut Random, (p, faces): Soup, scale: f64, offset: DVec3) -> ReducedModel {
    let rank = 1 + random.below(5);
    let ways: Vec<[DVec3; 2]> = (0..rank).map(|_| [random.vector(), random.vector()]).collect();
    let displacements = p
        .iter()
        .flat_map(|p| ways.iter().map(|[way, along]| *way * (p.dot(*along) * scale)).collect::<Vec<_>>());
    let modes = Modes::new(rank, displacements.collect()).unwrap();
    let p = p.iter().map(|p| *p * scale + offset).collect();
    ReducedModel::new(TriMesh::new(p, faces).unwrap(), modes).unwrap()
}

#[test]
fn large_models_agree_with_brute_force() {
    let (mut compared, mut hits, mut neighbours) = (0, 0, 0);
    for seed in 0..cases(120) {
        let random = &mut Random::new(seed);
        let mut soup = if seed % 6 == 0 { fan(random) } else { heap(random) };
        if seed % 2 == 0 {
            split(random, &mut soup);
        }
        let (scale, offset) = match seed % 8 {
            0 => (random.power(-50.0, 50.0), DVec3::ZERO),
            1 => (1.0, random.vector() * random.power(2.0, 12.0)),
            2 => (1e-55, DVec3::ZERO),
            _ => (1.0, DVec3::ZERO),
        };
        let model = bent(random, soup, scale, offset);
        let of = |filter: &ContactFilter, method| {
            let scope = Scope { filter: filter.clone(), ..Scope::of(&model) };
            Query::without_certificates(&model, scope, method).unwrap()
        };
        let one_vertex = [Neighbours::Exclude, Neighbours::IncludeOneVertex][seed as usize / 2 % 2];
        let mut filter = ContactFilter::new(one_vertex).weld(seed % 4 == 0);
        if seed % 3 == 0 {
            let q = vec![0.0; model.rank()];
            let rest = of(&filter, Method::BruteForce).discrete(&q).unwrap().to_vec();
            filter = filter.ignoring(rest.into_iter().step_by(2));
        }
        let mut oracle = of(&filter, Method::BruteForce);
        let mut fast = [Method::Traditional, Method::BdTree].map(|method| of(&filter, method));
        for size in [0.0, 0.1, 1.0, 10.0] {
            let q: Vec<f64> = (0..model.rank()).map(|_| random.signed() * size).collect();
            let expected = oracle.discrete(&q).unwrap();
            for query in &mut fast {
                assert_eq!(query.discrete(&q).unwrap(), expected, "model {seed}, size {size}");
                assert!(query.statistics().complete);
            }
            compared += 1;
            hits += expected.len();
            neighbours +=
                expected.iter().filter(|(i, j)| crate::common::are_adjacent(model.mesh(), *i, *j)).count();
        }
    }
    assert!(
        compared > threshold(400) && hits > threshold(20_000) && neighbours > threshold(1000),
        "{compared} {hits} {neighbours}"
    );
}

/// A query that stopped at a limit does not change later answers.
#[test]
fn limits_end_queries_at_any_number_of_pairs() {
    let mut seen = 0;
    for seed in 0..cases(120) {
        let random = &mut Random::new(seed);
        let soup = heap(random);
        let model = bent(random, soup, 1.0, DVec3::ZERO);
        let q = vec![2.0; model.rank()];
        for method in [Method::Traditional, Method::BdTree] {
            let mut query = Query::without_certificates(&model, Scope::of(&model), method).unwrap();
            let all = query.discrete(&q).unwrap().to_vec();
            seen += usize::from(all.len() > 10);
            for limit in [1, 2, 7, all.len().saturating_sub(1), all.len(), all.len() + 1] {
                let some = query.clone().discrete_at_most(&q, limit).unwrap().to_vec();
                assert_eq!(some.len(), limit.min(all.len()));
                assert!(some.iter().all(|pair| all.binary_search(pair).is_ok()));
            }
            assert_eq!(query.discrete(&q).unwrap(), all);
        }
    }
    assert!(seen >= threshold(20), "{seen}");
}
