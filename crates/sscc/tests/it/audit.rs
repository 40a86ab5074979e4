//! Audits find violations of wrong certificates of all scopes, and none of right ones.

use std::sync::Arc;

use glam::DVec3;
use sscc::parts::{CertificateParts, PairTree};
use sscc::{
    AuditOptions, Certificates, CertifyOptions, ContactFilter, Error, Modes, ReducedModel, TriMesh, audit,
};
use sscc_testing::{cases, threshold};

use crate::common::pair_trees::{START, edited};
use crate::common::{after, random_model, random_options};

/// Blocks of attacks are as large as necessary, so that no number of attacks needs much memory.
#[test]
fn audits_of_any_number_of_samples_can_be_cancelled() {
    // Two triangles one unit apart, and a mode that lowers the second.
    let positions = [DVec3::ZERO, DVec3::Z].map(|p| [p, p + DVec3::X, p + DVec3::Y]).concat();
    let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let lowers = |row, _| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 };
    let model = ReducedModel::new(mesh, Modes::from_matrix(6, 1, lowers).unwrap()).unwrap();
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    assert!(certificates.root_radius() > 0.0);
    for samples in [usize::MAX / 3, usize::MAX - 1, usize::MAX] {
        let asked = AuditOptions::default().samples(samples).threads(1);
        assert_eq!(audit(&model, &certificates, &asked, &after(2000)), Err(Error::Cancelled));
    }
}

/// Where triangles of every node collide at rest, radii of pairs of nodes are claims.
#[test]
fn radii_of_pairs_alone_are_attacked() {
    // Four heaps of 32 equal triangles; a mode moves the first two heaps together.
    let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let heaps = (0..4).flat_map(|heap| (0..32).map(move |_| DVec3::Z * 10.0 * f64::from(heap)));
    let positions: Vec<DVec3> = heaps.flat_map(|at| triangle.map(|p| p + at)).collect();
    let faces = (0..128).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let rise = (0..positions.len()).map(|v| if v < 96 { DVec3::Z } else { DVec3::ZERO }).collect();
    let mesh = TriMesh::new(positions, faces).unwrap();
    let model = ReducedModel::new(mesh, Modes::new(1, rise).unwrap()).unwrap();
    for budget in [0, 64] {
        let options = CertifyOptions::default().max_exceptions(0).local_budget(0).budget(budget);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let parts = certificates.parts();
        assert!(parts.node_radii.iter().all(|radius| *radius == 0.0));
        let asked = AuditOptions::default().samples(200).threads(1);
        let report = audit(&model, &certificates, &asked, &()).unwrap();
        assert!(report.samples > 100 && report.violations.is_empty(), "{report:?}");
        let mut wrong = parts.clone();
        wrong.root_pair_radii.iter_mut().for_each(|radius| *radius *= 3.0);
        let forged = Certificates::try_from(wrong).unwrap();
        assert!(!audit(&model, &forged, &asked, &()).unwrap().violations.is_empty());
    }
}

/// Right certificates of every scope have no violations. If radii are 1.5 times as large, audits find violations of
/// nearly all models whose right radii are tight.
#[test]
fn wrong_radii_of_every_scope_are_found() {
    let (mut honest, mut lies, mut missed) = (0, 0, Vec::new());
    for seed in 0..cases(220) {
        let model = random_model(50_000 + seed);
        let options = random_options(seed, &model).epsilon(0.2);
        let Ok(certificates) = Certificates::compute(&model, &options, &after(151)) else { continue };
        let asked = AuditOptions::default().samples(600).threads(1);
        let report = audit(&model, &certificates, &asked, &()).unwrap();
        assert_eq!(report.violations, Vec::<String>::new(), "model {seed}");
        honest += 1;
        if report.root_tightness.is_none_or(|tightness| tightness < 0.75) {
            continue;
        }
        let mut parts = certificates.parts().clone();
        parts.node_radii.iter_mut().chain(&mut parts.root_pair_radii).for_each(|r| *r *= 1.5);
        let forged = Certificates::try_from(parts).unwrap();
        lies += 1;
        if audit(&model, &forged, &asked, &()).unwrap().violations.is_empty() {
            missed.push(seed);
        }
    }
    assert!(honest > threshold(150) && lies > threshold(30), "{honest} {lies}");
    // Some models collide only at single points of a hyperplane, which samples do not meet.
    assert!(missed.len() * 20 <= lies, "{missed:?} of {lies}");
}

/// Exceptions are removed, added to the ignored pairs, or out of range, or the centre is NaN.
#[test]
fn forged_exceptions_are_refused_or_found() {
    let options = CertifyOptions::default().budget(16).epsilon(0.9).threads(1);
    let mut found = 0;
    for seed in 0..80 {
        let model = random_model(seed);
        let Ok(certificates) = Certificates::compute(&model, &options, &after(151)) else { continue };
        if certificates.exceptions().is_empty() || certificates.root_radius() <= 0.0 {
            continue;
        }
        let good = certificates.parts();
        let digest = |parts: &sscc::parts::CertificateParts| sscc::parts::Digest::of(&model, &parts.scope);
        let mut both = good.clone();
        Arc::make_mut(&mut both.scope).filter =
            ContactFilter::default().ignoring(good.scope.exceptions.clone());
        assert!(matches!(Certificates::try_from(both), Err(Error::Certificates(_))));
        let mut outside = good.clone();
        Arc::make_mut(&mut outside.scope).exceptions = vec![(0, u32::MAX)];
        outside.digest = digest(&outside);
        assert!(Certificates::try_from(outside).unwrap().check_model(&model).is_err());
        let mut dropped = good.clone();
        Arc::make_mut(&mut dropped.scope).exceptions.clear();
        dropped.digest = digest(&dropped);
        let dropped = Certificates::try_from(dropped).unwrap();
        let asked = AuditOptions::default().samples(400);
        found += usize::from(!audit(&model, &dropped, &asked, &()).unwrap().violations.is_empty());
        let mut nowhere = good.clone();
        Arc::make_mut(&mut nowhere.scope).center[0] = f64::NAN;
        assert!(matches!(Certificates::try_from(nowhere), Err(Error::Certificates(_))));
    }
    assert!(found > 1, "{found}");
}

/// Radii of pairs of nodes are three times as large, or trees lack the pair of leaves that collides first; the radii of nodes and
/// of the pairs of the root's children are right.
#[test]
fn wrong_pair_trees_are_found() {
    let (mut lies, mut missed) = ([0; 2], [Vec::new(), Vec::new()]);
    for seed in 0..cases(150) {
        let model = random_model(60_000 + seed);
        let options = random_options(seed, &model).epsilon(0.2);
        let Ok(certificates) = Certificates::compute(&model, &options, &after(151)) else { continue };
        let asked = AuditOptions::default().samples(200).threads(1);
        let tree = &certificates.parts().pair_tree;
        let of_leaves = tree.entries().enumerate().filter(|(_, (_, link))| link & START == 0);
        let Some((first, (least, _))) = of_leaves.min_by(|a, b| a.1.0.total_cmp(&b.1.0)) else { continue };
        // If the radius is not tight, three times the radius may be right.
        let report = audit(&model, &certificates, &asked, &()).unwrap();
        assert_eq!(report.violations, Vec::<String>::new(), "model {seed}");
        if least <= 0.0 || report.root_tightness.is_none_or(|tightness| tightness < 0.75) {
            continue;
        }
        let longer = edited(tree, 3.0 * tree.limit(), &[], |_, radius| 3.0 * radius);
        let shorter = edited(tree, tree.limit(), &[first], |_, radius| radius);
        let is_lie = [true, f64::from(least) < 0.4 * tree.limit()];
        for (kind, pair_tree) in [longer, shorter].into_iter().enumerate().filter(|(kind, _)| is_lie[*kind]) {
            let forged = CertificateParts { pair_tree, ..certificates.parts().clone() };
            let forged = Certificates::try_from(forged).unwrap();
            lies[kind] += 1;
            if audit(&model, &forged, &asked, &()).unwrap().violations.is_empty() {
                missed[kind].push(seed);
            }
        }
    }
    assert!(lies.iter().all(|n| *n > threshold(5)), "{lies:?}");
    for (lies, missed) in lies.iter().zip(&missed) {
        assert!(missed.len() * 20 <= *lies, "{missed:?} of {lies}");
    }
}

/// An empty tree certifies all pairs up to its limit. The radii of the nodes are right.
#[test]
fn an_empty_tree_that_claims_too_much_is_found() {
    let (mut lies, mut found) = (0, 0);
    for seed in 0..cases(40) {
        let model = random_model(61_000 + seed);
        let options = random_options(seed, &model).epsilon(0.5);
        let Ok(certificates) = Certificates::compute(&model, &options, &after(151)) else { continue };
        let parts = certificates.parts();
        if parts.pair_tree.is_empty() {
            continue;
        }
        let starts = vec![u32::MAX; parts.hierarchy.nodes().len()];
        let pair_tree = PairTree::from_parts(2.0 * parts.global_radius, starts, []);
        let forged = Certificates::try_from(CertificateParts { pair_tree, ..parts.clone() }).unwrap();
        let asked = AuditOptions::default().samples(200).threads(1);
        // If radii are not tight, the wrong tree may be right.
        let honest = audit(&model, &certificates, &asked, &()).unwrap();
        assert_eq!(honest.violations, Vec::<String>::new(), "model {seed}");
        if honest.root_tightness.is_none_or(|tightness| tightness < 0.5) {
            continue;
        }
        lies += 1;
        found += usize::from(!audit(&model, &forged, &asked, &()).unwrap().violations.is_empty());
    }
    assert!(lies > threshold(5) && found * 20 >= 19 * lies, "{found} of {lies}");
}
