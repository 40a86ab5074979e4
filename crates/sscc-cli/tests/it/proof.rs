//! Proofs of certificates: written by `certify --proof`, checked by the checker and by `audit --exact`.

use std::fs;
use std::path::Path;

use serde_json::json;
use sscc_checker::{Confirmed, Model, Refusal};

use crate::common::{files, keys, sorted, sscc, strips};

const MODEL: &str = "strips.model.safetensors";
const CERTIFICATES: &str = "strips.sscc.safetensors";
const KEYS: &str = "triangles, vertices, rank, nodes, pairs, seconds, threads, root_radius, global_radius, bytes, \
    rest_collisions, exceptions, proof_entries, proven_entries, proof_bytes, proof_seconds";

fn check(folder: &Path, certificates: &str, proof: &str) -> Result<Confirmed, Refusal> {
    let read = |name: &str| sscc_checker::read(&folder.join(name));
    sscc_checker::check(&Model::read(&folder.join(MODEL), None)?, &read(certificates)?, &read(proof)?, 2)
}

#[test]
fn certify_writes_proofs_that_the_checker_confirms() {
    let directory = strips();
    let folder = directory.path();
    let certify = |proof: &str, more: &[&str]| {
        let args = ["certify", MODEL, "-o", "x.sscc.safetensors", "--json", "--proof", proof];
        let run = sscc(folder, &[&args[..], more].concat());
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{run:?}");
        let [report] = &run.json()[..] else { panic!("{run:?}") };
        assert_eq!(keys(report), sorted(KEYS));
        assert_eq!(report["proof_bytes"], json!(fs::metadata(folder.join(proof)).unwrap().len()));
        let Confirmed { entries, proven, .. } = check(folder, "x.sscc.safetensors", proof).unwrap();
        assert_eq!([&report["proof_entries"], &report["proven_entries"]], [&json!(entries), &json!(proven)]);
        (entries, proven)
    };
    let (entries, proven) = certify("all.proof", &["--threads", "2"]);
    assert_eq!(entries, proven);
    assert_eq!(certify("one.proof", &["--threads", "1"]), (entries, proven));
    let [two, one] = ["all.proof", "one.proof"].map(|name| fs::read(folder.join(name)).unwrap());
    assert_eq!(two, one, "the same bytes for any number of threads");
    assert_eq!(certify("some.proof", &["--proof-sample", "3"]), (entries, 3));
    let text = sscc(folder, &["certify", MODEL, "-o", "x.sscc.safetensors", "--proof", "x.proof"]);
    let line = format!("proof          x.proof: all {entries} entries (");
    assert!(text.stdout.contains(&line), "{}", text.stdout);
}

#[test]
fn proofs_are_refused_before_long_work() {
    let directory = strips();
    let folder = directory.path();
    let before = files(folder);
    let certify = ["certify", MODEL, "-o", "x.sscc.safetensors"];
    for (more, cause) in [
        (&["--proof", "x.txt"][..], "must end in .proof"),
        (&["--proof", "nowhere/x.proof"], "cannot be written"),
        (&["--proof-sample", "3"], "--proof"),
        (&["--proof", "x.proof", "--proof-sample", "0"], "0"),
        (&["--proof", "x.proof", "--clearance", "0.1"], "--clearance"),
    ] {
        let run = sscc(folder, &[&certify[..], more].concat());
        assert_eq!((run.code, run.stdout.as_str()), (Some(2), ""), "{run:?}");
        assert!(run.stderr.contains(cause), "{run:?}");
        assert_eq!(files(folder), before);
    }
}

#[test]
fn audits_are_exact_on_request() {
    let directory = strips();
    let folder = directory.path();
    let exact = |file: &str, more: &[&str]| {
        let args = ["audit", MODEL, "--certificates", file, "--exact", "--samples", "20"];
        sscc(folder, &[&args[..], more].concat())
    };
    let run = exact(CERTIFICATES, &["--json"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{run:?}");
    let [report] = &run.json()[..] else { panic!("{run:?}") };
    assert_eq!(keys(report), sorted("entries, proven, seconds, refused, left_out"));
    assert!(report["refused"].is_null() && report["proven"].as_u64().unwrap() > 0, "{report}");
    assert!(exact(CERTIFICATES, &[]).stdout.contains("entries confirmed in exact arithmetic"));
    // Radii that are too large have no proof.
    let mut parts = sscc_io::read_certificates(&folder.join(CERTIFICATES)).unwrap().parts().clone();
    parts.node_radii.iter_mut().chain(&mut parts.root_pair_radii).for_each(|radius| *radius *= 2.0);
    parts.global_radius *= 2.0;
    let large = sscc::Certificates::try_from(parts).unwrap();
    sscc_io::write_certificates(&folder.join("large.sscc.safetensors"), &large).unwrap();
    let run = exact("large.sscc.safetensors", &[]);
    assert_eq!(run.code, Some(1), "{run:?}");
    assert!(run.stdout.starts_with("NOT CONFIRMED: "), "{run:?}");
    // The proof of the right certificates does not prove those with larger radii.
    sscc(folder, &["certify", MODEL, "-o", "x.sscc.safetensors", "--proof", "x.proof"]);
    let refusal = check(folder, "large.sscc.safetensors", "x.proof").unwrap_err();
    assert!(matches!(refusal, Refusal::Proof(_)), "{refusal}");
}

/// The commands of `docs/command.md`.
#[test]
fn the_guide_proves_certificates() {
    let directory = strips();
    let folder = directory.path();
    fs::rename(folder.join(MODEL), folder.join("spring.model.safetensors")).unwrap();
    let guide = include_str!("../../../../docs/command.md");
    let block = guide.split("## Proofs").nth(1).unwrap().split("```").nth(1).unwrap();
    let lines: Vec<Vec<&str>> = block.lines().skip(1).map(|line| line.split(' ').collect()).collect();
    let [certify, checker] = &lines[..] else { panic!("{lines:?}") };
    assert_eq!(sscc(folder, &certify[1..]).code, Some(0));
    let ["sscc-checker", model, certificates, proof] = checker[..] else { panic!("{checker:?}") };
    let [model, certificates, proof] = [model, certificates, proof].map(|name| folder.join(name));
    let read = |path| sscc_checker::read(path).unwrap();
    let confirmed =
        sscc_checker::check(&Model::read(&model, None).unwrap(), &read(&certificates), &read(&proof), 1);
    assert_eq!(confirmed.map(|confirmed| confirmed.entries - confirmed.proven), Ok(0));
}
