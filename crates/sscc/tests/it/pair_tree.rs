//! Tests of the certified pair tree: which pairs it certifies, and which trees are refused.

use glam::DVec3;
use sscc::parts::{CertificateParts, PairTree};
use sscc::{Certificates, CertifyOptions, Error, Method, Modes, Query, ReducedModel, TriMesh};

use crate::common::pair_trees::{LAST, START, edited};

use crate::common::after;

/// Returns two parallel strips, one above the other at height 1, which a mode lowers, so that they touch at q = 1. A second mode
/// moves the upper strip along the lower one.
fn strips() -> ReducedModel {
    let count = 200;
    let position = |i: usize, z: f64| DVec3::new((i / 2) as f64, (i % 2) as f64, z);
    let positions = [0.0, 1.0].map(|z| (0..count).map(|i| position(i, z)).collect::<Vec<_>>()).concat();
    let faces = |first: usize| (0..count - 2).map(move |i| [first + i, first + i + 1, first + i + 2]);
    let faces = faces(0).chain(faces(count)).map(|face| face.map(|v| v as u32)).collect();
    let moves = |row: usize, mode: usize| match (row / 3 >= count, row % 3, mode) {
        (true, 2, 0) => -1.0,
        (true, 0, 1) => 1.0,
        _ => 0.0,
    };
    let modes = Modes::from_matrix(2 * count, 2, moves).unwrap();
    ReducedModel::new(TriMesh::new(positions, faces).unwrap(), modes).unwrap()
}

fn certificates(model: &ReducedModel) -> Certificates {
    let options = CertifyOptions::default().budget(16).threads(1);
    Certificates::compute(model, &options, &()).unwrap()
}

fn with_tree(certificates: &Certificates, pair_tree: PairTree) -> Result<Certificates, Error> {
    Certificates::try_from(CertificateParts { pair_tree, ..certificates.parts().clone() })
}

/// A radius and its link.
type Entry = (f32, u32);

/// Returns the pairs at q, found with certificates.
fn ask(model: &ReducedModel, certificates: &Certificates, q: &[f64]) -> Vec<(u32, u32)> {
    Query::new(model, certificates).unwrap().discrete(q).unwrap().to_vec()
}

/// The AABBs of the strips are separate at rest, so a tree that depended on AABBs would not contain them.
#[test]
fn pairs_that_are_separate_at_rest_are_stored() {
    let model = strips();
    let good = certificates(&model);
    let tree = &good.parts().pair_tree;
    assert!(tree.limit() > 1.2);
    // The root's radius is within the tolerance.
    assert!((0.9..=1.0).contains(&good.root_radius()), "{}", good.root_radius());
    let mut oracle = Query::with_method(&model, &good, Method::BruteForce).unwrap();
    for q in [[1.0, 0.0], [1.0, 0.5], [-1.0, 0.0], [1.1, 0.0]] {
        let expected = oracle.discrete(&q).unwrap();
        assert_eq!(expected.is_empty(), q[0] != 1.0);
        assert_eq!(ask(&model, &good, &q), expected);
        assert!(oracle.statistics().norm < tree.limit());
    }
    // A tree without its pairs certifies that the strips never meet, so the query reads the tree.
    let all: Vec<usize> = (0..tree.len()).collect();
    let empty = with_tree(&good, edited(tree, tree.limit(), &all, |_, radius| radius)).unwrap();
    assert!(empty.parts().pair_tree.is_empty());
    assert!(ask(&model, &empty, &[1.0, 0.0]).is_empty());
}

/// At and beyond the limit a missing pair is not certified.
#[test]
fn absence_means_nothing_at_the_limit() {
    let model = strips();
    let good = certificates(&model);
    let q = [1.0, 0.0];
    let mut oracle = Query::with_method(&model, &good, Method::BruteForce).unwrap();
    let expected = oracle.discrete(&q).unwrap().to_vec();
    let norm = oracle.statistics().norm;
    assert!(!expected.is_empty());
    let nothing_below = |limit: f64| {
        let starts = vec![u32::MAX; good.parts().hierarchy.nodes().len()];
        with_tree(&good, PairTree::from_parts(limit, starts, [])).unwrap()
    };
    for limit in [norm, norm.next_down()] {
        assert_eq!(ask(&model, &nothing_below(limit), &q), expected);
    }
    assert!(ask(&model, &nothing_below(norm.next_up()), &q).is_empty());
}

/// An entry is opened if its radius is reached, equality included.
#[test]
fn pairs_whose_radius_is_reached_are_tested() {
    let model = strips();
    let good = certificates(&model);
    let tree = &good.parts().pair_tree;
    let q = [1.0, 0.0];
    let expected = ask(&model, &good, &q);
    let norm = good.norm(&q).unwrap() as f32;
    assert!(f64::from(norm) <= good.norm(&q).unwrap() && f64::from(norm.next_up()) > good.norm(&q).unwrap());
    let all_at = |radius: f32| edited(tree, tree.limit(), &[], |_, _| radius);
    assert_eq!(ask(&model, &with_tree(&good, all_at(norm)).unwrap(), &q), expected);
    assert!(ask(&model, &with_tree(&good, all_at(norm.next_up())).unwrap(), &q).is_empty());
}

/// Radii are rounded down to single precision, and no child has a smaller radius than its parent.
#[test]
fn a_parent_bounded_better_than_its_children_pushes_its_radius_down() {
    for seed in 0..40 {
        let model = crate::common::random_model(seed);
        let options = CertifyOptions::default().budget(16).epsilon(0.9).threads(1);
        let Ok(certificates) = Certificates::compute(&model, &options, &after(301)) else { continue };
        // The conversion refuses other trees.
        assert!(Certificates::try_from(certificates.parts().clone()).is_ok(), "model {seed}");
    }
}

#[test]
fn the_budget_bounds_the_pairs() {
    let model = strips();
    let triangles = model.mesh().faces().len();
    let mut last = (0, 0.0);
    for budget in [0, 8, 64, 4096] {
        let options = CertifyOptions::default().budget(budget).threads(1);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let tree = &certificates.parts().pair_tree;
        assert!(tree.bytes() <= budget * triangles && tree.bytes() == 8 * tree.len());
        assert!(tree.len() >= last.0 && tree.limit() >= last.1, "{budget}");
        assert!(budget > 0 || tree.limit() == 0.0);
        last = (tree.len(), tree.limit());
    }
    assert!(last.0 > 20 && last.1 > 0.0);
}

#[test]
fn damaged_trees_are_refused() {
    let model = strips();
    let good = certificates(&model);
    let tree = &good.parts().pair_tree;
    let (limit, starts) = (tree.limit(), tree.starts().to_vec());
    let entries: Vec<(f32, u32)> = tree.entries().collect();
    let refusal = |tree: PairTree| match with_tree(&good, tree) {
        Err(Error::Certificates(what)) => what,
        other => panic!("{:?}", other.map(|_| "accepted")),
    };
    let with_limit = |limit: f64| refusal(PairTree::from_parts(limit, starts.clone(), entries.clone()));
    for bad in [f64::NAN, -1.0, f64::INFINITY] {
        assert_eq!(with_limit(bad), "pair tree: its limit is negative or not finite");
    }
    assert_eq!(with_limit(0.0), "pair tree: it has pairs, but no limit");
    let of_starts = |change: &dyn Fn(&mut Vec<u32>)| {
        let mut starts = starts.clone();
        change(&mut starts);
        refusal(PairTree::from_parts(limit, starts, entries.clone()))
    };
    assert_eq!(of_starts(&|s| _ = s.pop()), "pair tree: the number of starts is not the number of nodes");
    assert_eq!(of_starts(&|s| s.clear()), "pair tree: the number of starts is not the number of nodes");
    assert_eq!(of_starts(&|s| s[0] = 1), "pair tree: lists of siblings are out of order");
    assert!(of_starts(&|s| s[0] = u32::MAX).starts_with("pair tree: "));
    let leaf = good.parts().hierarchy.nodes().iter().position(|node| node.is_leaf()).unwrap();
    assert!(of_starts(&|s| s[leaf] = 0).starts_with("pair tree: "));
    let with = |change: &dyn Fn(&mut Vec<Entry>)| {
        let mut entries = entries.clone();
        change(&mut entries);
        refusal(PairTree::from_parts(limit, starts.clone(), entries))
    };
    let inner = entries.iter().position(|(_, link)| link & START != 0).unwrap();
    let leaves = entries.iter().position(|(_, link)| link & START == 0).unwrap();
    let child = (entries[inner].1 & START) as usize;
    for bad in [f32::NAN, -1.0] {
        assert_eq!(with(&|e| e[leaves].0 = bad), "pair tree: a radius is negative or not a number");
    }
    for bad in [limit as f32 * 1.001, f32::INFINITY] {
        assert_eq!(with(&|e| e[leaves].0 = bad), "pair tree: a radius is not below the limit");
    }
    assert!(entries[child].0 > 0.0);
    assert_eq!(with(&|e| e[child].0 = 0.0), "pair tree: a pair's radius exceeds that of a child");
    assert_eq!(with(&|e| e[leaves].1 |= 1), "pair tree: a pair of buckets has children");
    assert_eq!(with(&|e| e[inner].1 += 1), "pair tree: lists of siblings are out of order");
    assert_eq!(with(&|e| e[inner].1 &= !START), "pair tree: lists of siblings are out of order");
    assert_eq!(with(&|e| e[child].1 |= 7 << 28), "pair tree: a child is listed twice or does not exist");
    assert_eq!(with(&|e| e.push((0.0, LAST))), "pair tree: some pairs have no parent");
    let last = entries.len() - 1;
    assert_eq!(with(&|e| e[last].1 &= !LAST), "pair tree: a list of siblings does not end");
    assert_eq!(with(&|e| _ = e.pop()), "pair tree: a list of siblings does not end");
}
