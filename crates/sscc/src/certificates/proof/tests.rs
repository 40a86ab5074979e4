use super::entries::proof_entries;
use super::prover::Prover;
use crate::certificates::test_models::ring;
use crate::{Certificates, CertifyOptions, Clearance, Error};

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
