//! The checker confirms the proofs of right certificates, and refuses the proofs of wrong ones. It shares no code with
//! the computation of certificates and proofs.
#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

use sscc::parts::{CertificateParts, Digest, Prover, Scope};
use sscc::{
    Certificates, CertifyOptions, ContactFilter, Metric, MetricKind, Modes, Neighbours, ReducedModel,
    TriMesh, TriangleGroups,
};
use sscc_checker::{Confirmed, Refusal};
use sscc_io::container::certificates_to_bytes;
use sscc_testing::{FlexibleShape, Numbers, Shape};

fn model_of(shape: FlexibleShape) -> ReducedModel {
    let mesh = TriMesh::new(shape.positions, shape.faces).unwrap();
    ReducedModel::new(mesh, Modes::new(shape.rank, shape.displacements).unwrap()).unwrap()
}

fn sheet() -> ReducedModel {
    model_of(FlexibleShape::new(3, Shape::Comb, 3))
}

fn certify(model: &ReducedModel, options: &CertifyOptions) -> Certificates {
    Certificates::compute(model, &options.clone().local_budget(0).reach(4.0), &()).unwrap()
}

/// Returns the model in the type of the checker.
fn checked(model: &ReducedModel) -> sscc_checker::Model {
    let (mesh, modes) = (model.mesh(), model.modes());
    let positions = mesh.rest_positions().iter().map(|p| p.to_array()).collect();
    let rows = (0..positions_len(model)).flat_map(|i| {
        let of_vertex = modes.of_vertex(i);
        (0..3).flat_map(move |axis| of_vertex.iter().map(move |u| u[axis]))
    });
    sscc_checker::Model::new(positions, mesh.faces().to_vec(), rows.collect(), modes.rank()).unwrap()
}

fn positions_len(model: &ReducedModel) -> u32 {
    model.mesh().rest_positions().len() as u32
}

fn prove(model: &ReducedModel, certificates: &Certificates) -> Vec<u8> {
    let prover = Prover::new(model, certificates).unwrap();
    let all: Vec<usize> = (0..prover.entries()).collect();
    [prover.header(all.len()), prover.prove(&all, Some(2), &()).unwrap()].concat()
}

fn check(model: &ReducedModel, certificates: &[u8], proof: &[u8]) -> Result<Confirmed, Refusal> {
    sscc_checker::check(&checked(model), certificates, proof, 2)
}

/// Returns the text of a refusal. `is_proof` states whether the proof must be refused, not its input.
fn refusal(result: Result<Confirmed, Refusal>, is_proof: bool) -> String {
    let refusal = result.unwrap_err();
    assert_eq!(matches!(refusal, Refusal::Proof(_)), is_proof, "{refusal}");
    let line = refusal.to_string();
    assert!(!line.contains('\n'), "{line}");
    line
}

/// Returns a certificate file with a changed tensor and a valid digest.
fn tampered(file: &[u8], tensor: &str, change: impl FnOnce(&mut [u8])) -> Vec<u8> {
    let mut bytes = file.to_vec();
    let header = 8 + u64::from_le_bytes(*bytes.first_chunk().unwrap()) as usize;
    let entries: serde_json::Value = serde_json::from_slice(&bytes[8..header]).unwrap();
    let offset = |i: usize| header + entries[tensor]["data_offsets"][i].as_u64().unwrap() as usize;
    change(&mut bytes[offset(0)..offset(1)]);
    let start = 8 + br#"{"__metadata__":{"blake3":""#.len();
    bytes[start..start + 64].fill(b'0');
    let digest = blake3::hash(&bytes).to_hex();
    bytes[start..start + 64].copy_from_slice(digest.as_bytes());
    bytes
}

/// Returns the options of certificates for a seed. Seeds differ in the filter, the metric, the centre and the budget.
fn options(seed: u64, model: &ReducedModel) -> CertifyOptions {
    let (rank, triangles) = (model.rank(), model.mesh().faces().len() as u32);
    let mut random = Numbers(seed);
    let neighbours = if seed.is_multiple_of(3) { Neighbours::IncludeOneVertex } else { Neighbours::Exclude };
    let mut filter = ContactFilter::new(neighbours).weld(!seed.is_multiple_of(4));
    if seed % 5 == 1 {
        let of_triangles: Vec<u32> = (0..triangles).map(|t| t * 3 / triangles).collect();
        filter = filter.with_groups(TriangleGroups::new(&of_triangles).unwrap().ignoring([[0, 1]]).unwrap());
    }
    let mut options = CertifyOptions::default().ignore_rest(None);
    if seed % 4 == 1 {
        let mut factor = vec![0.0; rank * rank];
        for i in 0..rank {
            factor[i * rank + i] = 0.5 + random.below(5) as f64;
            (i + 1..rank).for_each(|j| factor[i * rank + j] = 0.3 * random.signed());
        }
        options = options.metric(Metric::from_factor(MetricKind::Given, rank, factor).unwrap());
    }
    if seed % 4 == 2 {
        options = options.center((0..rank).map(|_| 1e-3 * random.signed()).collect::<Vec<_>>());
    }
    if seed % 6 == 5 {
        options = options.budget(0);
    }
    options.filter(filter)
}

#[test]
fn proofs_of_all_kinds_of_certificates_are_confirmed() {
    let (mut entries, mut trees, mut positive) = (0, 0, 0);
    for seed in 0..sscc_testing::cases(48_u8) {
        let seed = u64::from(seed);
        let shape = FlexibleShape::new(seed, Shape::ALL[seed as usize % 7], 1 + seed as usize % 3);
        let model = model_of(if seed % 7 == 3 { shape.scaled(1e-40) } else { shape });
        let certificates = certify(&model, &options(seed, &model));
        let file = certificates_to_bytes(&certificates).unwrap();
        let proof = prove(&model, &certificates);
        let confirmed = check(&model, &file, &proof).unwrap_or_else(|refusal| panic!("{seed}: {refusal}"));
        assert_eq!(confirmed.proven, confirmed.entries, "seed {seed}");
        assert_eq!(confirmed.proven_positive, confirmed.positive, "seed {seed}");
        assert!(confirmed.positive <= confirmed.entries, "seed {seed}");
        assert_eq!(confirmed.root_radius.to_bits(), certificates.root_radius().to_bits(), "seed {seed}");
        entries += confirmed.entries;
        trees += usize::from(certificates.parts().pair_tree.limit() > 0.0);
        positive += usize::from(certificates.root_radius() > 0.0);
    }
    let enough = |found: usize, wanted: usize| assert!(found >= sscc_testing::threshold(wanted), "{found}");
    enough(entries, 2_000);
    enough(trees, 16);
    enough(positive, 16);
}

/// If coordinates are large and the centre is not 0, rounding errors of positions at the centre exceed the tolerance of
/// witnesses of near triangles.
#[test]
fn proofs_about_a_centre_far_from_the_origin_are_confirmed() {
    for (seed, kind) in [(3, Shape::Comb), (3, Shape::Sheet), (3, Shape::SlitDisk)] {
        let mut shape = FlexibleShape::new(seed, kind, 3);
        shape.positions.iter_mut().for_each(|p| *p = *p * 0.1 + 1000.0);
        shape.displacements.iter_mut().for_each(|u| *u *= 0.03);
        let model = model_of(shape);
        let center: Vec<f64> = (0..model.rank()).map(|k| 0.7 + 0.1 * k as f64).collect();
        let certificates = certify(&model, &CertifyOptions::default().ignore_rest(None).center(center));
        assert!(certificates.root_radius() > 0.0, "{kind:?}");
        let file = certificates_to_bytes(&certificates).unwrap();
        let confirmed = check(&model, &file, &prove(&model, &certificates));
        assert!(
            confirmed.as_ref().is_ok_and(|found| found.proven == found.entries),
            "{kind:?}: {confirmed:?}"
        );
    }
}

/// A radius is confirmed up to the largest one that its witnesses prove, and not one unit beyond.
#[test]
fn a_radius_one_unit_too_large_is_refused() {
    let model = sheet();
    let certificates = certify(&model, &CertifyOptions::default());
    let file = certificates_to_bytes(&certificates).unwrap();
    let proof = prove(&model, &certificates);
    let parts = certificates.parts();
    let nodes = parts.hierarchy.nodes();
    let leaf = (0..nodes.len()).find(|n| nodes[*n].is_leaf() && parts.node_radii[*n] > 0.0).unwrap();
    let with = |radius: f64| {
        tampered(&file, "node_radii", |bytes| bytes[8 * leaf..][..8].copy_from_slice(&radius.to_le_bytes()))
    };
    let stored = parts.node_radii[leaf];
    assert!(check(&model, &with(stored), &proof).is_ok());
    let mut beyond = 2.0 * stored;
    let refused = loop {
        match check(&model, &with(beyond), &proof) {
            Ok(_) => beyond *= 2.0,
            Err(refusal) => break refusal.to_string(),
        }
    };
    // From here on, the proof is that of this entry alone.
    let number = refused.split(['y', ',']).nth(1).unwrap().trim().parse().unwrap();
    let prover = Prover::new(&model, &certificates).unwrap();
    let proof = [prover.header(1), prover.prove(&[number], None, &()).unwrap()].concat();
    let (mut proven, mut refused) = (stored.to_bits(), beyond.to_bits());
    while refused - proven > 1 {
        let middle = proven + (refused - proven) / 2;
        match check(&model, &with(f64::from_bits(middle)), &proof) {
            Ok(_) => proven = middle,
            Err(_) => refused = middle,
        }
    }
    let line = refusal(check(&model, &with(f64::from_bits(refused)), &proof), true);
    assert!(line.contains("entry ") && line.contains("does not"), "{line}");
}

#[test]
fn dropped_pairs_are_refused() {
    let model = sheet();
    let certificates = certify(&model, &CertifyOptions::default());
    let file = certificates_to_bytes(&certificates).unwrap();
    let proof = prove(&model, &certificates);
    let links: Vec<u32> = certificates.parts().pair_tree.entries().map(|(_, link)| link).collect();
    // A pair of buckets that is not the first of its list: the one before becomes the last.
    let is_last = |link: u32| link >> 31 == 1;
    let dropped = (1..links.len())
        .find(|&i| links[i] & ((1 << 28) - 1) == 0 && is_last(links[i]) && !is_last(links[i - 1]));
    let dropped = dropped.unwrap();
    let without = tampered(&file, "pair_links", |bytes| bytes[4 * dropped - 1] |= 1 << 7);
    let line = refusal(check(&model, &without, &proof), true);
    assert!(line.contains("entry ") && line.contains("nodes"), "{line}");
    // A proof without one of its entries is a sample.
    let prover = Prover::new(&model, &certificates).unwrap();
    let all: Vec<usize> = (1..prover.entries()).collect();
    let sample = [prover.header(all.len()), prover.prove(&all, None, &()).unwrap()].concat();
    let confirmed = check(&model, &file, &sample).unwrap();
    assert_eq!((confirmed.proven, confirmed.entries), (all.len(), all.len() + 1));
    let left_out =
        "pairs with common vertices, 0 exceptions, 0 ignored pairs, no groups, no local certificates";
    assert_eq!(confirmed.left_out, left_out);
    let line = confirmed.to_string();
    assert!(line.starts_with(&format!("confirmed a sample: {} of {} ", all.len(), all.len() + 1)), "{line}");
    assert!(line.ends_with(left_out), "{line}");
    assert_eq!(confirmed.clone().of_sample().as_ref(), Ok(&confirmed));
    assert!(refusal(confirmed.of_all_entries(), true).contains("samples are accepted on request"));
    // Without any entry a proof states nothing, not even as a sample.
    assert!(refusal(check(&model, &file, &prover.header(0)), true).contains("it proves no entry"));
    // Bytes that are missing, and bytes that follow.
    assert!(refusal(check(&model, &file, &proof[..proof.len() - 1]), true).contains("too early"));
    assert!(refusal(check(&model, &file, &[&proof[..], b"x"].concat()), true).contains("after its end"));
    // A triangle that is in two nodes and another one in none.
    let twice = tampered(&file, "order", |bytes| bytes.copy_within(4..8, 0));
    assert!(refusal(check(&model, &twice, &proof), true).contains("listed twice"));
    // A leaf with children, a node with children beyond all nodes, one with a single child, and one with five.
    let nodes = certificates.parts().hierarchy.nodes();
    let leaf = nodes.iter().position(|node| node.is_leaf()).unwrap();
    for (node, [first_child, children]) in
        [(leaf, [u32::MAX, 2]), (0, [u32::MAX, 4]), (0, [1, 1]), (0, [1, 5])]
    {
        let wrong = tampered(&file, "nodes", |bytes| {
            bytes[16 * node + 8..][..4].copy_from_slice(&first_child.to_le_bytes());
            bytes[16 * node + 12..][..4].copy_from_slice(&children.to_le_bytes());
        });
        assert!(refusal(check(&model, &wrong, &proof), true).contains("are not the next"));
    }
}

#[test]
fn certificates_of_other_models_are_refused() {
    let model = sheet();
    let certificates = certify(&model, &CertifyOptions::default());
    let file = certificates_to_bytes(&certificates).unwrap();
    let proof = prove(&model, &certificates);
    let mut positions = model.mesh().rest_positions().to_vec();
    positions[0].x = positions[0].x.next_up();
    let mesh = model.mesh().with_rest_positions(positions).unwrap();
    let other = ReducedModel::new(mesh, model.modes().clone()).unwrap();
    assert!(refusal(check(&other, &file, &proof), false).contains("digests differ"));
    let wrong = tampered(&file, "metric_scales", |bytes| bytes[0] ^= 1);
    assert!(refusal(check(&model, &wrong, &proof), false).contains("digests differ"));
    let mut damaged = file.clone();
    *damaged.last_mut().unwrap() ^= 1;
    assert!(refusal(check(&model, &damaged, &proof), false).contains("BLAKE3"));
    // The proof of other certificates of the same model.
    let tree = certify(&model, &CertifyOptions::default().budget(0));
    assert!(refusal(check(&model, &file, &prove(&model, &tree)), false).contains("other certificates"));
    let near = CertifyOptions::default().clearance(sscc::Clearance::new(1e-3).unwrap());
    let near = certificates_to_bytes(&certify(&model, &near)).unwrap();
    assert!(refusal(check(&model, &near, &proof), false).contains("clearance"));
}

#[test]
fn exceptions_must_count_and_collide_at_the_centre() {
    // The ends of the strip overlap at the centre.
    let mut shape = FlexibleShape::new(4, Shape::Sheet, 2);
    let fold = shape.positions.iter().map(|p| p.x).fold(0.0, f64::max);
    shape.positions.iter_mut().filter(|p| p.x > 0.8 * fold).for_each(|p| p.x -= 0.8 * fold);
    let model = model_of(shape);
    let certificates = certify(&model, &CertifyOptions::default().max_exceptions(usize::MAX));
    let file = certificates_to_bytes(&certificates).unwrap();
    let parts = certificates.parts();
    let exceptions = parts.scope.exceptions.clone();
    assert!(!exceptions.is_empty() && certificates.root_radius() > 0.0, "{}", exceptions.len());
    let proof = prove(&model, &certificates);
    check(&model, &file, &proof).unwrap();
    let with = |exceptions: Vec<(u32, u32)>| -> Certificates {
        let scope = Scope { exceptions, ..Scope::clone(&parts.scope) };
        let digest = Digest::of(&model, &scope);
        CertificateParts { scope: scope.into(), digest, ..parts.clone() }.try_into().unwrap()
    };
    let bytes = |certificates: &Certificates| certificates_to_bytes(certificates).unwrap();
    // The head of a proof names model and scope, and is compared before exceptions are tested.
    let proof_of = |certificates: &Certificates| {
        let digest = certificates.parts().digest.0;
        [&proof[..8], &digest, &proof[8 + digest.len()..]].concat()
    };
    let triangles = model.mesh().faces().len() as u32;
    let is_apart = |pair: &(u32, u32)| {
        let [a, b] = [pair.0, pair.1].map(|t| model.mesh().faces()[t as usize]);
        !exceptions.contains(pair) && a.iter().all(|i| !b.contains(i))
    };
    // One additional pair does not collide at the centre, and one shares vertices.
    for (pair, cause) in [((0, triangles / 2), "do not collide at the centre"), ((0, 1), "do not count")] {
        assert!(is_apart(&pair) == (cause == "do not collide at the centre"));
        let mut more = exceptions.clone();
        more.push(pair);
        more.sort_unstable();
        more.dedup();
        let more = with(more);
        assert!(refusal(check(&model, &bytes(&more), &proof), false).contains("other certificates"));
        assert!(refusal(check(&model, &bytes(&more), &proof_of(&more)), true).contains(cause));
    }
    // An exception is missing: no witness can prove its entry.
    let less = with(exceptions[1..].to_vec());
    assert!(refusal(check(&model, &bytes(&less), &proof), false).contains("other certificates"));
    let line = refusal(check(&model, &bytes(&less), &proof_of(&less)), true);
    assert!(line.contains("entry "), "{line}");
    let prover = Prover::new(&model, &less).unwrap();
    let all: Vec<usize> = (0..prover.entries()).collect();
    assert!(prover.prove(&all, None, &()).unwrap_err().to_string().contains("has no proof"));
}

/// One byte must not make the checker test all pairs of triangles of large nodes.
#[test]
fn lists_of_triangles_are_for_leaves_alone() {
    let model = sheet();
    let certificates = certify(&model, &CertifyOptions::default().budget(0));
    let file = certificates_to_bytes(&certificates).unwrap();
    let prover = Prover::new(&model, &certificates).unwrap();
    let lines = (0..prover.entries()).filter_map(|number| {
        let entry = [&(number as u64).to_le_bytes()[..], &1_u32.to_le_bytes(), b"t"].concat();
        check(&model, &file, &[prover.header(1), entry].concat()).err()
    });
    let lines: Vec<String> = lines.map(|refusal| refusal.to_string()).collect();
    assert!(lines.iter().any(|line| line.contains("116 is no witness of nodes")), "{lines:?}");
    assert!(lines.iter().any(|line| line.contains("too early")), "{lines:?}");
}

/// A changed proof is refused, or still proves the certificates.
#[test]
fn damaged_proofs_never_confirm_more_than_is_true() {
    let model = sheet();
    let certificates = certify(&model, &CertifyOptions::default());
    let file = certificates_to_bytes(&certificates).unwrap();
    let proof = prove(&model, &certificates);
    // The radii of all nodes are too large: no proof may pass, with any content.
    let larger = tampered(&file, "node_radii", |bytes| {
        for radius in bytes.as_chunks_mut::<8>().0 {
            *radius = (f64::from_le_bytes(*radius) * 1e3).to_le_bytes();
        }
    });
    let (mut random, mut refused) = (Numbers(5), 0);
    for _ in 0..sscc_testing::cases(64_u8) {
        let mut damaged = proof.clone();
        damaged[random.below(proof.len())] ^= 1 << random.below(8);
        assert!(check(&model, &larger, &damaged).is_err());
        refused += usize::from(check(&model, &file, &damaged).is_err());
        assert!(check(&model, &file, &proof[..random.below(proof.len())]).is_err());
    }
    assert!(refused >= sscc_testing::threshold(8), "{refused}");
}

/// Models on which rounding matters, because all coordinates, or all modes but the first, have a large common part; and filters that
/// some mutations omit.
#[cfg(feature = "mutants")]
fn models_for_mutations() -> Vec<(ReducedModel, CertifyOptions)> {
    let plain = CertifyOptions::default;
    let far = |kind: Shape| {
        let mut shape = FlexibleShape::new(3, kind, 2);
        shape.positions.iter_mut().for_each(|p| *p += 1e8);
        (model_of(shape), plain())
    };
    // The first mode is small, so that radii are not capped.
    let fast = |kind: Shape| {
        let mut shape = FlexibleShape::new(3, kind, 2);
        for of_vertex in shape.displacements.chunks_exact_mut(shape.rank) {
            of_vertex[0] *= 1e-9;
            of_vertex[1..].iter_mut().for_each(|u| *u += 1e7);
        }
        let metric = Metric::identity(shape.rank);
        (model_of(shape), plain().metric(metric))
    };
    let rule = ContactFilter::new(Neighbours::IncludeOneVertex);
    let of_triangles: Vec<u32> =
        (0..sheet().mesh().faces().len() as u32).map(|t| u32::from(t % 5 == 0)).collect();
    let groups = TriangleGroups::new(&of_triangles).unwrap().ignoring([[0, 1]]).unwrap();
    vec![
        far(Shape::Comb),
        fast(Shape::Comb),
        fast(Shape::Ring),
        (sheet(), plain().filter(rule)),
        (sheet(), plain().filter(ContactFilter::default().with_groups(groups))),
    ]
}

/// Prints the result of the checker for certificates and proofs of the mutation that the environment names.
#[cfg(feature = "mutants")]
#[test]
#[ignore = "for the test below, in a process of its own"]
fn outcome_of_the_mutation_of_this_process() {
    for (number, (model, options)) in models_for_mutations().into_iter().enumerate() {
        let certificates = certify(&model, &options);
        let file = certificates_to_bytes(&certificates).unwrap();
        let prover = Prover::new(&model, &certificates).unwrap();
        let all: Vec<usize> = (0..prover.entries()).collect();
        let outcome = match prover.prove(&all, Some(2), &()) {
            Err(error) => format!("UNPROVEN {error}"),
            Ok(entries) => match check(&model, &file, &[prover.header(all.len()), entries].concat()) {
                Ok(confirmed) => format!("CONFIRMED {}", confirmed.proven),
                Err(refusal) => format!("REFUSED {refusal}"),
            },
        };
        println!("outcome {number} {outcome}");
    }
}

/// Certificates by wrong bounds have no proof, or the checker refuses it:
/// `cargo test -p sscc-io --features mutants --test proofs`.
#[cfg(feature = "mutants")]
#[test]
fn certificates_by_mutated_bounds_are_not_confirmed() {
    let outcomes = |mutation: Option<&str>| -> Vec<String> {
        let mut child = std::process::Command::new(std::env::current_exe().unwrap());
        child.args(["--exact", "outcome_of_the_mutation_of_this_process", "--ignored", "--nocapture"]);
        child.env_remove("SSCC_MUTANT");
        child.envs(mutation.map(|name| ("SSCC_MUTANT", name)));
        let output = String::from_utf8(child.output().unwrap().stdout).unwrap();
        let lines = output.lines().filter_map(|line| Some(line.split_once("outcome ")?.1[2..].to_owned()));
        lines.filter(|line| line.starts_with(|c: char| c.is_ascii_uppercase())).collect()
    };
    let right = outcomes(None);
    assert!(right.len() == 5 && right.iter().all(|line| line.starts_with("CONFIRMED")), "{right:?}");
    let mut missed = Vec::new();
    for (word, names) in [("REFUSED", REFUSED), ("UNPROVEN", UNPROVEN)] {
        for name in names {
            let found = outcomes(Some(name));
            for line in found.iter().filter(|line| !line.starts_with("CONFIRMED")) {
                println!("{name}: {line}");
            }
            if !found.iter().any(|line| line.starts_with(word)) {
                missed.push((*name, found));
            }
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
}

/// Mutations of `crates/sscc/src/mutants/list.rs` whose witnesses the checker refuses.
#[cfg(feature = "mutants")]
const REFUSED: &[&str] = &[
    "DirectionWithoutRestError",
    "DirectionWithoutRateError",
    "NodePairWithoutRestError",
    "NodePairWithoutRateError",
    "AffineWithoutRateError",
    "OneSimplexPairOfTwo",
    "GroupsForgotten",
    "NodeGroupOfFirstPart",
];

/// Mutations that certify radii for which there are no witnesses.
#[cfg(feature = "mutants")]
const UNPROVEN: &[&str] = &["RadiusToNearest", "OpenTrianglesForgotten", "CappedPairFreeToTheEnd"];
