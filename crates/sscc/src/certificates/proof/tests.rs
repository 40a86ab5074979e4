use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;

use super::entries::proof_entries;
use super::prover::Prover;
use crate::certificates::test_models::ring;
use crate::{
    CancelToken, Certificates, CertifyOptions, Clearance, Error, Metric, Modes, Progress, ReducedModel,
    TriMesh,
};

/// Each pair of triangles is in one entry, with and without a pair tree.
#[test]
fn each_pair_of_triangles_is_in_one_entry() {
    for budget in [0, 4, 64] {
        let model = ring(300, 3, 1.3);
        let options = CertifyOptions::default().budget(budget).local_budget(0);
        let certificates = Certificates::compute(&model, &options, &()).unwrap();
        let parts = certificates.parts();
        let triangles = |n: u32| parts.hierarchy.triangles(&parts.hierarchy.nodes()[n as usize]);
        let mut found = Vec::new();
        for entry in proof_entries(parts) {
            let (n, m) = entry.nodes;
            assert!(entry.radius >= parts.node_radii[0]);
            for (i, &a) in triangles(n).iter().enumerate() {
                let rest = if n == m { &triangles(n)[i + 1..] } else { triangles(m) };
                found.extend(rest.iter().map(|&b| (a.min(b), a.max(b))));
            }
        }
        found.sort_unstable();
        let count = model.mesh().faces().len() as u32;
        let all: Vec<_> = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b))).collect();
        assert!(found == all, "budget {budget}");
    }
}

#[test]
fn samples_are_ascending_and_spread() {
    let model = ring(300, 3, 1.3);
    let certificates = Certificates::compute(&model, &CertifyOptions::default(), &()).unwrap();
    let prover = Prover::new(&model, &certificates).unwrap();
    let all = prover.entries();
    assert_eq!(prover.sample(all + 1, 1).len(), all);
    let sample = prover.sample(10, 1);
    assert_eq!((sample.len(), &sample), (10, &prover.sample(10, 1)));
    for (i, number) in sample.iter().enumerate() {
        assert!((i * all / 10..(i + 1) * all / 10).contains(number), "{sample:?} of {all}");
    }
    assert_ne!(sample, prover.sample(10, 2));
    assert!(prover.prove(&[all], None, &()).is_err());
    let near = CertifyOptions::default().clearance(Clearance::new(1e-3).unwrap());
    let near = Certificates::compute(&model, &near, &()).unwrap();
    assert!(matches!(Prover::new(&model, &near), Err(Error::ClearanceCertificates)));
}

/// The nearer a radius is to the exact one, the more parts of two triangles need a witness of their own.
#[test]
fn the_search_for_witnesses_ends() {
    // Two triangles at distance 1, and nine modes that map positions linearly: the exact radius is 1.
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    let positions = [corners, corners.map(|p| p + DVec3::Z)].concat();
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let modes = |p: &DVec3| p.to_array().map(|x| axes.map(|axis| axis * x)).concat();
    let modes = Modes::new(9, positions.iter().flat_map(modes).collect()).unwrap();
    let mesh = TriMesh::new(positions, vec![[0, 1, 2], [3, 4, 5]]).unwrap();
    let model = ReducedModel::with_metric(mesh, modes, Metric::identity(9)).unwrap();
    let options = CertifyOptions::default().local_budget(0);
    let certificates = Certificates::compute(&model, &options, &()).unwrap();
    let prove = |certificates: &Certificates, progress: &dyn Progress| {
        let prover = Prover::new(&model, certificates).unwrap();
        let all: Vec<usize> = (0..prover.entries()).collect();
        prover.prove(&all, Some(1), progress)
    };
    assert!(prove(&certificates, &()).is_ok());
    let mut parts = certificates.parts().clone();
    parts.node_radii.iter_mut().for_each(|radius| *radius = 0.99);
    let exact = Certificates::try_from(parts).unwrap();
    assert!(matches!(prove(&exact, &()), Err(Error::Unproven(_))));
}

/// Also within entries, which may have many pairs of triangles.
#[test]
fn proofs_can_be_cancelled_at_any_time() {
    let model = ring(300, 3, 1.3);
    let options = CertifyOptions::default().budget(0).local_budget(0);
    let certificates = Certificates::compute(&model, &options, &()).unwrap();
    let prover = Prover::new(&model, &certificates).unwrap();
    let all: Vec<usize> = (0..prover.entries()).collect();
    let looks_until = |limit: usize| {
        let looks = Arc::new(AtomicUsize::new(0));
        let seen = Arc::clone(&looks);
        let token = CancelToken::when(move || seen.fetch_add(1, Ordering::Relaxed) >= limit);
        (prover.prove(&all, Some(1), &token).err(), looks.load(Ordering::Relaxed))
    };
    let (error, looks) = looks_until(usize::MAX);
    assert!(error.is_none() && looks > 2 * all.len(), "{looks}");
    for limit in [0, 1, looks / 2, looks - 1] {
        // Each further entry looks once.
        let (error, looks) = looks_until(limit);
        assert!(
            error == Some(Error::Cancelled) && looks <= limit + 1 + all.len(),
            "{error:?} {looks} {limit}"
        );
    }
}

#[test]
fn entries_without_a_pair_tree_have_the_radii_around_them() {
    let options = CertifyOptions::default().budget(0).local_budget(0);
    let certificates = Certificates::compute(&ring(60, 2, 0.9), &options, &()).unwrap();
    let mut parts = certificates.parts().clone();
    parts.node_radii.iter_mut().enumerate().for_each(|(n, radius)| *radius = 1.0 + n as f64);
    parts.root_pair_radii.iter_mut().enumerate().for_each(|(i, radius)| *radius = 1e3 + i as f64);
    let nodes = parts.hierarchy.nodes();
    let range = |n: u32| {
        let node = &nodes[n as usize];
        node.first_triangle..node.first_triangle + node.triangle_count
    };
    let contains = |a: u32, n: u32| range(a).start <= range(n).start && range(n).end <= range(a).end;
    let (mut of_root, mut others) = (0, 0);
    for entry in proof_entries(&parts) {
        let (n, m) = entry.nodes;
        let around = (0..nodes.len() as u32).filter(|a| contains(*a, n) && contains(*a, m));
        let around = around.map(|a| parts.node_radii[a as usize]).fold(0.0, f64::max);
        let which = nodes[0].child_pairs().position(|pair| pair == entry.nodes);
        let wanted = which.map_or(around, |which| parts.root_pair_radii[which]);
        assert_eq!(entry.radius, wanted, "{n} {m}");
        *(if which.is_some() { &mut of_root } else { &mut others }) += 1;
    }
    assert!(of_root == parts.root_pair_radii.len() && others > 10, "{of_root} {others}");
}
