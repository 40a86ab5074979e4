//! What scripts rely on: exit codes, the keys of the JSON, standard output that is the result alone.

#![allow(clippy::unwrap_used)]

mod common;

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::process::Stdio;

use common::{command, keys, sorted, sscc, strips};
use serde_json::{Value, json};

const MODEL: &str = "strips.model.safetensors";
const CERTIFICATES: &str = "strips.sscc.safetensors";

const CERTIFY: &str = "triangles, vertices, rank, nodes, pairs, seconds, threads, root_radius, global_radius, bytes, \
    rest_collisions, exceptions";
const CHECK: &str = "index, norm, colliding, count, complete, pairs, microseconds, root_certified, opened, box_tests, \
    triangle_tests";
const AUDIT: &str = "samples, violations, root_tightness, tightness_median, tightness_min";

#[test]
fn certify() {
    let folder = strips();
    let args = ["certify", MODEL, "-o", "again.sscc.safetensors", "--threads", "2", "--json"];
    let run = sscc(folder.path(), &args);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    let [report] = &run.json()[..] else { panic!("{run:?}") };
    assert_eq!(keys(report), sorted(CERTIFY));
    assert_eq!(
        [
            &report["triangles"],
            &report["vertices"],
            &report["rank"],
            &report["threads"],
            &report["exceptions"]
        ],
        [20, 24, 2, 2, 0].map(|n| json!(n)).each_ref()
    );
    // They meet at q_0 = 1, where |z| is 1: the displacement metric, and a mode that moves by 1.
    let root = report["root_radius"].as_f64().unwrap();
    assert!((0.9..=1.0).contains(&root), "{root}");
    let [first, again] =
        [CERTIFICATES, "again.sscc.safetensors"].map(|f| fs::read(folder.path().join(f)).unwrap());
    assert_eq!(report["bytes"], json!(again.len()));
    assert_eq!(first, again, "the same bytes for any number of threads");
}

#[test]
fn an_infinite_radius_is_null() {
    let folder = strips();
    sscc_io::write_npy(&folder.path().join("still.npy"), &[72, 1], &[0.0; 72]).unwrap();
    let args = ["certify", "mesh.obj", "--modes", "still.npy", "-o", "still.sscc.safetensors", "--json"];
    let report = &sscc(folder.path(), &args).json()[0];
    assert_eq!((&report["root_radius"], &report["global_radius"]), (&Value::Null, &Value::Null));
    let args =
        ["check", "mesh.obj", "--modes", "still.npy", "--certificates", "still.sscc.safetensors", "--q=1e9"];
    assert_eq!(sscc(folder.path(), &args).code, Some(0));
}

#[test]
fn check() {
    let folder = strips();
    let q = [0.5, 0.0, 0.0, 0.0, 1.5, 0.0, 1.0, 3.0];
    sscc_io::write_npy(&folder.path().join("q.npy"), &[4, 2], &q).unwrap();
    let run = |args: &[&str]| {
        sscc(folder.path(), &[&["check", MODEL, "--trajectory", "q.npy", "--json"], args].concat())
    };
    let certified = run(&["--certificates", CERTIFICATES]);
    assert_eq!((certified.code, certified.stderr.as_str()), (Some(1), ""));
    let lines = certified.json();
    assert_eq!(lines.len(), 4);
    for (index, line) in lines.iter().enumerate() {
        assert_eq!(keys(line), sorted(CHECK));
        assert_eq!(line["index"], json!(index));
        assert_eq!(line["complete"], json!(true));
        assert_eq!(line["count"], json!(line["pairs"].as_array().unwrap().len()));
        assert_eq!(line["colliding"], json!(line["count"] != 0));
    }
    // Apart, at rest, through each other, and touching exactly.
    let colliding: Vec<bool> = lines.iter().map(|l| l["colliding"].as_bool().unwrap()).collect();
    assert_eq!(colliding, [false, false, false, true]);
    assert_eq!(lines[0]["root_certified"], json!(true));
    assert!((lines[3]["norm"].as_f64().unwrap() - 10.0_f64.sqrt()).abs() < 1e-9);

    for method in ["certified", "bdtree", "traditional", "brute-force"] {
        for certificates in [&[][..], &["--certificates", CERTIFICATES]] {
            let other = run(&[&["--method", method][..], certificates].concat());
            assert_eq!(other.code, Some(1), "{other:?}");
            let pairs: Vec<Value> = other.json().iter().map(|l| l["pairs"].clone()).collect();
            assert_eq!(pairs, lines.iter().map(|l| l["pairs"].clone()).collect::<Vec<_>>(), "{method}");
        }
    }
}

/// The ways between the rows of a trajectory: nothing meets, the upper strip goes through the lower one, stays below
/// it, and comes back to touch it at the very end.
#[test]
fn check_continuous() {
    let folder = strips();
    let q = [0.5, 0.0, 0.0, 0.0, 1.5, 0.0, 1.25, 0.0, 1.0, 0.0];
    sscc_io::write_npy(&folder.path().join("q.npy"), &[5, 2], &q).unwrap();
    let given = ["check", MODEL, "--trajectory", "q.npy", "--continuous"];
    let run = |args: &[&str]| sscc(folder.path(), &[&given[..], args].concat());
    let certified = run(&["--certificates", CERTIFICATES, "--json"]);
    assert_eq!((certified.code, certified.stderr.as_str()), (Some(1), ""));
    let lines = certified.json();
    assert_eq!(lines.len(), 4);
    for (index, line) in lines.iter().enumerate() {
        assert_eq!(keys(line), sorted(&format!("{CHECK}, times")));
        let [pairs, times] = ["pairs", "times"].map(|key| line[key].as_array().unwrap().clone());
        assert_eq!((pairs.len(), &line["count"]), (times.len(), &json!(pairs.len())));
        assert_eq!((&line["index"], &line["complete"]), (&json!(index), &json!(true)));
        assert_eq!(line["colliding"], json!(!pairs.is_empty()));
        // At q_0 = 1, never told too late.
        let time = [None, Some(2.0 / 3.0), None, Some(1.0)][index];
        for found in times.iter().map(|t| t.as_f64().unwrap()) {
            let true_time = time.unwrap();
            assert!(found <= true_time && found > true_time - 1e-6, "{index}: {found}");
        }
        assert_eq!(times.is_empty(), time.is_none(), "{index}");
    }
    assert_eq!(lines[0]["root_certified"], json!(true));
    let norm = lines[1]["norm"].as_f64().unwrap();
    assert!((norm - 1.5).abs() < 1e-9, "the larger one of both ends: {norm}");
    for method in ["certified", "bdtree", "traditional", "brute-force"] {
        for certificates in [&[][..], &["--certificates", CERTIFICATES]] {
            let other = run(&[&["--method", method, "--json"][..], certificates].concat());
            assert_eq!(other.code, Some(1), "{other:?}");
            let answers = |lines: &[Value]| -> Vec<[Value; 2]> {
                lines.iter().map(|l| ["pairs", "times"].map(|key| l[key].clone())).collect()
            };
            assert_eq!(answers(&other.json()), answers(&lines), "{method}");
        }
    }
    // The first to meet, of as many as were asked for.
    for (limit, count) in [("--first", 1), ("--limit=3", 3)] {
        let some = run(&["--certificates", CERTIFICATES, limit, "--json"]).json().remove(1);
        assert_eq!((&some["count"], &some["complete"]), (&json!(count), &json!(false)));
        assert_eq!(some["times"].as_array().unwrap().len(), count);
    }
    let text = run(&["--certificates", CERTIFICATES]);
    assert_eq!(text.code, Some(1));
    assert!(text.stdout.contains(" at t = 0.6667\n"), "{}", text.stdout);
    assert!(text.stdout.contains("\n4 steps: 2 free (1 by the root's certificate alone), 2 colliding; "));
    sscc_io::write_npy(&folder.path().join("free.npy"), &[2, 2], &[0.5, 0.0, -0.5, 0.1]).unwrap();
    let args = ["check", MODEL, "--trajectory", "free.npy", "--continuous", "--certificates", CERTIFICATES];
    let free = sscc(folder.path(), &args);
    assert!(free.code == Some(0) && free.stdout.starts_with("free: proven by the root's"), "{free:?}");
    sscc_io::write_npy(&folder.path().join("one.npy"), &[1, 2], &[0.5, 0.0]).unwrap();
    let args = ["check", MODEL, "--trajectory", "one.npy", "--continuous"];
    assert!(sscc(folder.path(), &args).refusal().contains("it takes two to move"));
}

#[test]
fn schemes() {
    let folder = strips();
    let certify = |file: &str, args: &[&str]| {
        let run = sscc(folder.path(), &[&["certify", MODEL, "-o", file, "--json"], args].concat());
        assert_eq!(run.code, Some(0), "{run:?}");
        run.json().remove(0)
    };
    let info = |file: &str| sscc(folder.path(), &["info", file, "--json"]).json().remove(0);
    let full = certify("full.sscc.safetensors", &["--scheme", "full"]);
    let small = certify("small.sscc.safetensors", &["--budget", "1"]);
    let paper = certify("paper.sscc.safetensors", &["--scheme", "paper"]);
    let number = |value: &Value| value.as_u64().unwrap();
    // The pairs of the root's children, and those of the pair tree.
    let of_root = info("paper.sscc.safetensors")["root_pair_radii"].as_array().unwrap().len() as u64;
    assert_eq!(number(&paper["pairs"]), of_root);
    assert!(number(&full["pairs"]) > number(&small["pairs"]) && number(&small["pairs"]) <= of_root + 2);
    assert!(number(&full["bytes"]) > number(&paper["bytes"]));
    for (file, report, scheme) in [
        ("full.sscc.safetensors", &full, "full"),
        ("small.sscc.safetensors", &small, "full"),
        ("paper.sscc.safetensors", &paper, "paper"),
    ] {
        let known = info(file);
        assert_eq!((&known["scheme"], &known["pairs"]), (&json!(scheme), &report["pairs"]), "{file}");
        assert_eq!(known["pair_limit"].as_f64().unwrap() > 0.0, scheme == "full");
        assert_eq!(number(&known["pair_bytes"]), 8 * (number(&report["pairs"]) - of_root));
        assert!(sscc(folder.path(), &["info", file]).stdout.contains(&format!("scheme         {scheme}, ")));
        assert_eq!(known["root_radius"], report["root_radius"]);
    }
    let default = fs::read(folder.path().join(CERTIFICATES)).unwrap();
    assert_eq!(default, fs::read(folder.path().join("full.sscc.safetensors")).unwrap());
    let contradiction = ["certify", MODEL, "-o", "x.sscc.safetensors", "--scheme", "paper", "--budget", "8"];
    assert!(sscc(folder.path(), &contradiction).refusal().contains("leave --budget out"));
    let check = |file: &str, args: &[&str]| {
        sscc(folder.path(), &[&["check", MODEL, "--certificates", file, "--q=0,0"], args].concat())
    };
    for (file, flag) in [
        ("full.sscc.safetensors", "--scheme=full"),
        ("full.sscc.safetensors", "--budget=1000"),
        ("small.sscc.safetensors", "--budget=16"),
        ("paper.sscc.safetensors", "--scheme=paper"),
    ] {
        assert_eq!(check(file, &[flag]).code, Some(0), "{file} {flag}");
    }
    for (file, flag) in [
        ("full.sscc.safetensors", "--scheme=paper"),
        ("full.sscc.safetensors", "--budget=1"),
        ("paper.sscc.safetensors", "--scheme=full"),
    ] {
        assert!(check(file, &[flag]).refusal().contains("against --scheme or --budget"), "{file} {flag}");
    }
}

#[test]
fn check_at_one_q() {
    let folder = strips();
    let run = |q| sscc(folder.path(), &["check", MODEL, "--certificates", CERTIFICATES, q]);
    let free = run("--q=-0.25,0.5");
    assert_eq!(free.code, Some(0));
    assert!(
        free.stdout.starts_with("free: proven by the root's certificate alone (|z| = 0.5590, root radius ")
    );
    let free = run("--q=0,4");
    assert_eq!(free.code, Some(0));
    assert!(free.stdout.starts_with("free: proven (|z| = 4.000, root radius "), "{}", free.stdout);
    let colliding = run("--q=1,0");
    assert_eq!(colliding.code, Some(1));
    assert!(colliding.stdout.starts_with("COLLIDING: "), "{}", colliding.stdout);
}

#[test]
fn certificates_are_computed_where_none_are_given() {
    let folder = strips();
    let run = sscc(folder.path(), &["check", "mesh.obj", "--modes", "modes.npy", "--q=1,0", "--json"]);
    assert_eq!((run.code, run.json().len()), (Some(1), 1));
    assert!(run.stderr.starts_with("note: no --certificates given"));
    let run = sscc(folder.path(), &["check", MODEL, "--q=1,0", "--method", "traditional"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(1), ""));
}

#[test]
fn flags_may_agree_with_certificates_and_must_not_contradict_them() {
    let folder = strips();
    fs::write(folder.path().join("weights.txt"), "1 1 # both strips move by 1").unwrap();
    let run = |args: &[&str]| {
        sscc(folder.path(), &[&["check", MODEL, "--certificates", CERTIFICATES, "--q=0,0"], args].concat())
    };
    for agrees in ["--epsilon=0.1", "--metric=displacement", "--metric=weights.txt", "--scheme=full"] {
        assert_eq!(run(&[agrees]).code, Some(0), "{agrees}");
    }
    assert!(
        run(&["--epsilon=0.2"])
            .refusal()
            .ends_with("certified with --epsilon 0.1, not 0.2; leave the flag out")
    );
    assert!(run(&["--metric=mass"]).refusal().contains("certified with another metric (displacement)"));
}

#[test]
fn audit() {
    let folder = strips();
    let args = ["audit", MODEL, "--certificates", CERTIFICATES, "--samples", "200", "--seed", "7"];
    let run = sscc(folder.path(), &[&args[..], &["--json"]].concat());
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    let [report] = &run.json()[..] else { panic!("{run:?}") };
    assert_eq!(keys(report), sorted(AUDIT));
    assert_eq!((&report["samples"], &report["violations"]), (&json!(200), &json!(0)));
    assert!(report["root_tightness"].as_f64().unwrap() > 0.85);
    let text = sscc(folder.path(), &args);
    assert!(text.stdout.starts_with("200 attacks, no violation found\n"), "{}", text.stdout);
}

/// Certificates that promise too much, under a good seal.
#[test]
fn audit_finds_lies() {
    let folder = strips();
    let path = folder.path().join(CERTIFICATES);
    let mut parts = sscc_io::read_certificates(&path).unwrap().parts().clone();
    let double = |radii: &mut Vec<f64>| radii.iter_mut().for_each(|r| *r *= 2.0);
    double(&mut parts.node_radii);
    double(&mut parts.root_pair_radii);
    parts.global_radius *= 2.0;
    sscc_io::write_certificates(&path, &sscc::Certificates::from_parts(parts).unwrap()).unwrap();
    let run = sscc(folder.path(), &["audit", MODEL, "--certificates", CERTIFICATES, "--samples", "200"]);
    assert_eq!(run.code, Some(1), "{run:?}");
    assert!(run.stdout.starts_with("VIOLATION: ") && run.stdout.contains("do not use these certificates"));
}

#[test]
fn modes_and_info() {
    let folder = strips();
    let cone = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0.2 0.3 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    fs::write(folder.path().join("cone.obj"), cone).unwrap();
    let args = ["modes", "cone.obj", "-o", "cone.model.safetensors", "--kind", "polynomial", "--json"];
    let run = sscc(folder.path(), &args);
    assert_eq!(run.code, Some(0), "{run:?}");
    assert_eq!(run.json()[0]["triangles"], json!(4));
    for (file, kind) in
        [("cone.obj", "mesh"), ("cone.model.safetensors", "model"), (CERTIFICATES, "certificates")]
    {
        let info = sscc(folder.path(), &["info", file, "--json"]);
        assert_eq!((info.code, &info.json()[0]["kind"]), (Some(0), &json!(kind)), "{info:?}");
        assert_eq!(sscc(folder.path(), &["info", file]).code, Some(0));
    }
    let info = |file| sscc(folder.path(), &["info", file, "--json"]).json().remove(0);
    let (model, certificates) = (info(MODEL), info(CERTIFICATES));
    assert_eq!(model["digest"], certificates["digest"]);
    assert_eq!(certificates["levels"][0]["nodes"], json!(1));
    assert_eq!(certificates["levels"][0]["min"], certificates["root_radius"]);
}

/// What a model made with its stiffness can do beyond others.
#[test]
fn elasticity() {
    let folder = strips();
    let (strips, info) = sscc_io::read_model(&folder.path().join(MODEL)).unwrap();
    let energy = sscc::Metric::from_weights(sscc::MetricKind::Energy, &[2.0, 8.0]).unwrap();
    let model =
        sscc::ReducedModel::with_metric(strips.mesh().clone(), strips.modes().clone(), energy).unwrap();
    let hz = std::f64::consts::TAU * std::f64::consts::TAU;
    let forces = sscc_io::Elasticity::Linear(vec![hz, 0.0, 0.0, 9.0 * hz]);
    let path = folder.path().join("solid.model.safetensors");
    sscc_io::write_model(&path, &model, &info.with_elasticity(forces)).unwrap();

    let known = sscc(folder.path(), &["info", "solid.model.safetensors", "--json"]).json().remove(0);
    assert_eq!((&known["frequencies_hz"], &known["nonlinear"]), (&json!([1.0, 3.0]), &json!(false)));
    let text = sscc(folder.path(), &["info", "solid.model.safetensors"]).stdout;
    assert!(text.contains("frequencies    1.000, 3.000 Hz (linear forces)\n"), "{text}");
    let unknown = sscc(folder.path(), &["info", MODEL, "--json"]).json().remove(0);
    assert!(unknown.get("frequencies_hz").is_none() && unknown.get("nonlinear").is_none());

    let output = "solid.sscc.safetensors";
    let args = ["certify", "solid.model.safetensors", "-o", output, "--metric", "energy"];
    let run = sscc(folder.path(), &args);
    assert!(run.code == Some(0) && run.stdout.contains("metric         energy\n"), "{run:?}");
    let certified = sscc_io::read_certificates(&folder.path().join(output)).unwrap();
    assert_eq!(certified.metric(), model.metric());
}

#[test]
fn help_and_usage() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["demo", "modes", "certify", "check", "audit", "info", "bench"] {
        let help = sscc(folder.path(), &[name, "--help"]);
        assert_eq!(help.code, Some(0));
        assert!(help.stdout.contains("Example"), "{name}");
    }
    assert_eq!(sscc(folder.path(), &["--version"]).code, Some(0));
    assert_eq!(sscc(folder.path(), &["--help"]).code, Some(0));
    for wrong in [
        &["certify", "x.obj"][..],
        &["check", "x.obj"],
        &["check", "x.obj", "--q=1", "--trajectory", "q.npy"],
        &["check", "x.obj", "--q="],
        &["check", "x.obj", "--q=1,x"],
        &["check", "x.obj", "--q=1", "--method", "guess"],
        &["check", "x.obj", "--q=1", "--continuous"],
        &["certify", "x.obj", "-o", "x", "--budget", "0"],
        &["certify", "x.obj", "-o", "x", "--scheme", "best"],
        &["certify", "x.obj", "-o", "x", "--epsilon", "0"],
        &["certify", "x.obj", "-o", "x", "--epsilon", "nan"],
        &["certify", "x.obj", "-o", "x", "--threads", "0"],
        &["audit", "x.obj", "--certificates", "x", "--samples", "0"],
        &["modes", "x.obj", "-o", "x", "--kind", "linear"],
        &["fly"],
    ] {
        sscc(folder.path(), wrong).refusal();
    }
    assert_eq!(sscc(folder.path(), &[] as &[&str]).code, Some(2));
}

#[test]
fn a_closed_pipe_is_no_panic() {
    let folder = strips();
    sscc_io::write_npy(&folder.path().join("q.npy"), &[20_000, 2], &vec![0.1; 40_000]).unwrap();
    let args = ["check", MODEL, "--certificates", CERTIFICATES, "--trajectory", "q.npy"];
    let mut child =
        command(folder.path(), &args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut first = String::new();
    BufReader::with_capacity(64, child.stdout.take().unwrap()).read_line(&mut first).unwrap();
    assert!(first.contains("free"), "{first}");
    let mut stderr = String::new();
    child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
    assert_eq!((child.wait().unwrap().code(), stderr.as_str()), (Some(2), ""));
}

#[test]
#[cfg(unix)]
fn an_interrupt_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("spring.model.safetensors");
    let mesh = sscc_modes::shapes::spring();
    let modes = sscc_modes::polynomial_modes(&mesh).unwrap();
    let model = sscc::ReducedModel::new(mesh, modes).unwrap();
    sscc_io::write_model(&path, &model, &sscc_io::ModelInfo::default()).unwrap();
    let args = [
        "certify",
        "spring.model.safetensors",
        "-o",
        "spring.sscc.safetensors",
        "--threads",
        "1",
        "--epsilon=0.001",
    ];
    let mut child =
        command(folder.path(), &args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    std::thread::sleep(std::time::Duration::from_millis(700));
    let killed = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(killed.unwrap().success());
    let mut stderr = String::new();
    child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
    assert_eq!((child.wait().unwrap().code(), stderr.as_str()), (Some(130), "error: interrupted\n"));
    assert_eq!(common::files(folder.path()), [path]);
}
