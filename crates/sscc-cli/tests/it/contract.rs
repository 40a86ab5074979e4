//! The contract with scripts: exit codes, keys of the JSON, results alone on standard output.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::Stdio;

use serde_json::{Value, json};

use crate::common::{command, keys, sorted, sscc, strips};

const MODEL: &str = "strips.model.safetensors";
const CERTIFICATES: &str = "strips.sscc.safetensors";

const CERTIFY: &str = "triangles, vertices, rank, nodes, pairs, seconds, threads, root_radius, global_radius, bytes, \
    rest_collisions, exceptions";
const CHECK: &str = "index, norm, colliding, count, complete, pairs, microseconds, root_certified, proof, opened, box_tests, \
    triangle_tests";
const AUDIT: &str = "samples, local_samples, violations, root_tightness, tightness_median, tightness_min";

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
    // The strips touch at q_0 = 1, where |z| is 1: the displacement metric, and a mode that moves by 1.
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
    // Closer, at rest, past each other, and touching exactly.
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

/// Four motions: no contact; the upper strip passes through the lower one; it stays below; it returns and touches the
/// lower one at t = 1.
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
        // Contact begins at q_0 = 1, and the time is never later.
        let time = [None, Some(2.0 / 3.0), None, Some(1.0)][index];
        for found in times.iter().map(|t| t.as_f64().unwrap()) {
            let true_time = time.unwrap();
            assert!(found <= true_time && found > true_time - 1e-6, "{index}: {found}");
        }
        assert_eq!(times.is_empty(), time.is_none(), "{index}");
    }
    assert_eq!(lines[0]["root_certified"], json!(true));
    let norm = lines[1]["norm"].as_f64().unwrap();
    assert!((norm - 1.5).abs() < 1e-9, "the larger norm of both ends: {norm}");
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
    // --first and --limit list the earliest pairs.
    for (limit, count) in [("--first", 1), ("--limit=3", 3)] {
        let some = run(&["--certificates", CERTIFICATES, limit, "--json"]).json().remove(1);
        assert_eq!((&some["count"], &some["complete"]), (&json!(count), &json!(false)));
        assert_eq!(some["times"].as_array().unwrap().len(), count);
    }
    let text = run(&["--certificates", CERTIFICATES]);
    assert_eq!(text.code, Some(1));
    assert!(text.stdout.contains(" at t = 0.6667\n"), "{}", text.stdout);
    assert!(text.stdout.contains("\n4 steps: 2 free (2 by the root's certificate alone), 2 colliding; "));
    sscc_io::write_npy(&folder.path().join("free.npy"), &[2, 2], &[0.5, 0.0, -0.5, 0.1]).unwrap();
    let args = ["check", MODEL, "--trajectory", "free.npy", "--continuous", "--certificates", CERTIFICATES];
    let free = sscc(folder.path(), &args);
    assert!(free.code == Some(0) && free.stdout.starts_with("free: proven by the root's"), "{free:?}");
    sscc_io::write_npy(&folder.path().join("one.npy"), &[1, 2], &[0.5, 0.0]).unwrap();
    let args = ["check", MODEL, "--trajectory", "one.npy", "--continuous"];
    assert!(sscc(folder.path(), &args).refusal().contains("a motion needs at least two"));
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
    let contradiction = ["certify", MODEL, "-o", "x.sscc.safetensors", "--scheme", "paper", "--reach", "2"];
    assert!(sscc(folder.path(), &contradiction).refusal().contains("leave --reach out"));
    // Radii beyond the paper's global radius.
    let near = certify("near.sscc.safetensors", &["--reach", "1"]);
    let far = certify("far.sscc.safetensors", &["--reach", "3", "--budget", "4096"]);
    let global = |report: &Value| report["global_radius"].as_f64().unwrap();
    assert_eq!(global(&near), global(&paper));
    assert!(2.9 * global(&near) < global(&far) && global(&far) <= 3.0 * global(&near));
    let check = |file: &str, args: &[&str]| {
        sscc(folder.path(), &[&["check", MODEL, "--certificates", file, "--q=0,0"], args].concat())
    };
    for (file, flag) in [
        ("full.sscc.safetensors", "--scheme=full"),
        ("full.sscc.safetensors", "--budget=1000"),
        ("small.sscc.safetensors", "--budget=16"),
        ("near.sscc.safetensors", "--reach=1"),
        ("far.sscc.safetensors", "--reach=3"),
        ("paper.sscc.safetensors", "--scheme=paper"),
    ] {
        assert_eq!(check(file, &[flag]).code, Some(0), "{file} {flag}");
    }
    for (file, flag) in [
        ("full.sscc.safetensors", "--scheme=paper"),
        ("full.sscc.safetensors", "--budget=1"),
        ("paper.sscc.safetensors", "--scheme=full"),
    ] {
        assert!(check(file, &[flag]).refusal().contains("contradicts --scheme or --budget"), "{file} {flag}");
    }
    for (file, cause) in [
        ("far.sscc.safetensors", "its radii reach farther than --reach 2 allows"),
        ("paper.sscc.safetensors", "it has no pair tree"),
    ] {
        let refused = check(file, &["--reach=2"]);
        assert!(refused.refusal().contains(cause), "{refused:?}");
    }
    // Like --budget, --reach requests a pair tree of certificates that are computed at once.
    let at_once = sscc(folder.path(), &["sweep", MODEL, "--reach", "2", "--json"]);
    assert!(at_once.code.is_some_and(|code| code < 2), "{at_once:?}");
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
    // Beyond the radius, the root's local certificate proves the answer; without local certificates, a search does.
    let free = run("--q=0,4");
    assert_eq!(free.code, Some(0));
    let start = "free: proven by the root's certificate alone (|z| = 4.000, root radius ";
    assert!(free.stdout.starts_with(start), "{}", free.stdout);
    let radii = ["certify", "strips.model.safetensors", "-o", "radii.sscc.safetensors", "--local-budget=0"];
    assert_eq!(sscc(folder.path(), &radii).code, Some(0));
    for (certificates, proof) in [(CERTIFICATES, "local"), ("radii.sscc.safetensors", "search")] {
        let run = sscc(folder.path(), &["check", MODEL, "--certificates", certificates, "--q=0,4", "--json"]);
        assert_eq!(run.json()[0]["proof"], proof);
    }
    let args = ["check", MODEL, "--certificates", "radii.sscc.safetensors", "--q=0,4"];
    let free = sscc(folder.path(), &args);
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
fn flags_may_repeat_but_not_contradict_certificates() {
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

/// Certificates with doubled radii, in a file with a valid checksum.
#[test]
fn audit_refutes_radii_that_are_too_large() {
    let folder = strips();
    let path = folder.path().join(CERTIFICATES);
    let mut parts = sscc_io::read_certificates(&path).unwrap().parts().clone();
    let double = |radii: &mut Vec<f64>| radii.iter_mut().for_each(|r| *r *= 2.0);
    double(&mut parts.node_radii);
    double(&mut parts.root_pair_radii);
    parts.global_radius *= 2.0;
    sscc_io::write_certificates(&path, &sscc::Certificates::try_from(parts).unwrap()).unwrap();
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

#[test]
fn info_of_gltf_files_and_split_meshes() {
    let directory = crate::detector::folder();
    let folder = directory.path();
    let info = sscc(folder, &["info", "flag.gltf", "--json"]).json().remove(0);
    assert_eq!(keys(&info), sorted("kind, scenes, default_scene, nodes, meshes, skins, animations"));
    for (part, names) in [
        ("nodes", "node, name, mesh, skin, in_default_scene"),
        ("meshes", "name, primitives, targets, triangles, vertices, default_q"),
        ("animations", "name, seconds, channels"),
    ] {
        assert_eq!(keys(&info[part][0]), sorted(names), "{part}");
    }
    let facet = |corners: &str| format!("facet\nouter loop\n{corners}endloop\nendfacet\n");
    let two = facet("vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n")
        + &facet("vertex 0 1 0\nvertex 1 0 0\nvertex 1 1 0\n");
    fs::write(folder.join("two.stl"), format!("solid\n{two}endsolid\n")).unwrap();
    let info = sscc(folder, &["info", "two.stl", "--json"]).json().remove(0);
    let names =
        "kind, triangles, vertices, used_vertices, boundary_edges, non_manifold_edges, welded, lower, upper";
    assert_eq!(keys(&info), sorted(names));
    assert_eq!(keys(&info["welded"]), sorted("vertices, boundary_edges, non_manifold_edges"));
}

#[test]
fn check_of_a_data_set() {
    let directory = crate::detector::folder();
    let folder = directory.path();
    let run = sscc(folder, &["check", "mesh.obj", "missing.obj", "--json"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(2), "error: missing.obj: not found\n"));
    let [answer, failed] = &run.json()[..] else { panic!("{run:?}") };
    assert_eq!((keys(answer), keys(failed)), (sorted(&format!("{CHECK}, file")), sorted("file, error")));
}

/// Two tetrahedra with a common face, in every format of solids.
#[test]
fn info_of_solids() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let vertices = "0 0 0|1 0 0|0 1 0|0 0 1|1 1 1";
    let numbered = |first: usize| -> String {
        vertices.split('|').enumerate().map(|(n, xyz)| format!("{} {xyz}\n", n + first)).collect()
    };
    let plain = vertices.replace('|', " 0\n");
    fs::write(
        folder.join("a.mesh"),
        format!("MeshVersionFormatted 1\nDimension 3\nVertices 5\n{plain} 0\nTetrahedra 2\n1 2 3 4 7\n2 5 3 4 9\nEnd\n"),
    )
    .unwrap();
    fs::write(
        folder.join("a.msh"),
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n{}$EndNodes\n$Elements\n2\n\
             1 4 2 7 1 1 2 3 4\n2 4 2 9 1 2 5 3 4\n$EndElements\n",
            numbered(1)
        ),
    )
    .unwrap();
    fs::write(folder.join("a.node"), format!("5 3 0 0\n{}", numbered(0))).unwrap();
    fs::write(folder.join("a.ele"), "2 4 1\n0 0 1 2 3 7\n1 1 4 2 3 9\n").unwrap();
    fs::write(
        folder.join("a.veg"),
        format!(
            "*VERTICES\n5 3 0 0\n{}*ELEMENTS\nTET\n2 4 0\n1 1 2 3 4\n2 2 5 3 4\n\
             *MATERIAL steel\nENU, 7850, 2e11, 0.3\n*MATERIAL rubber\nENU, 1000, 1e6, 0.45\n\
             *SET one\n1\n*SET two\n2\n*REGION\none, steel\n*REGION\ntwo, rubber\n",
            numbered(1)
        ),
    )
    .unwrap();
    const KEYS: &str =
        "kind, vertices, tetrahedra, cubes, materials, listed_triangles, lower, upper, boundary";
    for file in ["a.mesh", "a.msh", "a.node", "a.ele", "a.veg"] {
        let run = sscc(folder, &["info", file, "--json"]);
        assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{file}: {run:?}");
        let known = &run.json()[0];
        assert_eq!(keys(known), sorted(KEYS), "{file}");
        assert_eq!(known["kind"], json!("solid"));
        let counts = ["vertices", "tetrahedra", "cubes"].map(|key| known[key].as_u64().unwrap());
        assert_eq!(counts, [5, 2, 0], "{file}");
        assert_eq!((&known["lower"], &known["upper"]), (&json!([0.0, 0.0, 0.0]), &json!([1.0, 1.0, 1.0])));
        let boundary = ["triangles", "boundary_edges"].map(|key| known["boundary"][key].as_u64().unwrap());
        assert_eq!(boundary, [6, 0], "{file}");
        let elements: u64 =
            known["materials"].as_array().unwrap().iter().map(|m| m["elements"].as_u64().unwrap()).sum();
        assert_eq!(elements, 2, "{file}");
        let text = sscc(folder, &["info", file]).stdout;
        assert!(text.starts_with("solid          2 tetrahedra, 0 cubes, 5 vertices\n"), "{text}");
        assert!(text.contains("\nbox            1.000 x 1.000 x 1.000\n"), "{text}");
        assert!(
            text.contains("\nsurface        6 triangles, 5 vertices (5 used), closed, manifold\n"),
            "{text}"
        );
    }
    let text = sscc(folder, &["info", "a.veg"]).stdout;
    assert!(
        text.contains("material       steel: youngs=200000000000,poisson=0.3,density=7850; 1 element\n"),
        "{text}"
    );
    // The reason why `sscc modes` would refuse the solid.
    fs::write(folder.join("flat.node"), "4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 1 1 0\n").unwrap();
    fs::write(folder.join("flat.ele"), "1 4 0\n0 0 1 2 3\n").unwrap();
    let known = sscc(folder, &["info", "flat.node", "--json"]).json().remove(0);
    assert_eq!(known["boundary"], Value::Null);
    assert!(known["refusal"].as_str().unwrap().contains("tetrahedron 0 "), "{known}");
    assert!(sscc(folder, &["info", "flat.ele"]).stdout.contains("\nsurface        refused: tetrahedron 0 "));
}

/// A model with a stiffness has frequencies and an energy metric.
#[test]
fn elasticity() {
    let folder = strips();
    let (strips, info) = sscc_io::read_model(&folder.path().join(MODEL)).unwrap();
    let energy = sscc::Metric::from_weights(sscc::MetricKind::Energy, &[2.0, 8.0]).unwrap();
    let model =
        sscc::ReducedModel::with_metric(strips.mesh().clone(), strips.modes().clone(), energy).unwrap();
    let hz = std::f64::consts::TAU * std::f64::consts::TAU;
    let stiffness = sscc_solid::Stiffness::from_diagonal(&[hz, 9.0 * hz]).unwrap();
    let forces = sscc_solid::Elasticity::Linear(stiffness);
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
    for name in ["demo", "modes", "certify", "check", "load", "fit", "audit", "info", "bench"] {
        let help = sscc(folder.path(), &[name, "--help"]);
        assert_eq!(help.code, Some(0));
        assert!(help.stdout.contains("Example"), "{name}");
    }
    assert_eq!(sscc(folder.path(), &["--version"]).code, Some(0));
    assert_eq!(sscc(folder.path(), &["--help"]).code, Some(0));
    for wrong in [
        &["certify", "x.obj"][..],
        &["check", "x.obj", "--q=1", "--trajectory", "q.npy"],
        &["check", "x.obj", "--q="],
        &["check", "x.obj", "--q=1,x"],
        &["check", "x.obj", "--q=1", "--method", "guess"],
        &["check", "x.obj", "--q=1", "--continuous"],
        &["certify", "x.obj", "-o", "x", "--budget", "0"],
        &["certify", "x.obj", "-o", "x", "--reach", "0.5"],
        &["certify", "x.obj", "-o", "x", "--reach", "inf"],
        &["certify", "x.obj", "-o", "x", "--reach", "nan"],
        &["check", "x.obj", "--reach", "2"],
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

/// Runs a command whose reader closes the pipe after the first line. Returns exit code and standard error.
fn read_one_line(folder: &Path, args: &[&str]) -> (Option<i32>, String) {
    let mut child = command(folder, args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut first = String::new();
    BufReader::with_capacity(64, child.stdout.take().unwrap()).read_line(&mut first).unwrap();
    assert!(first.ends_with('\n'), "{args:?}: {first:?}");
    let mut stderr = String::new();
    child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
    (child.wait().unwrap().code(), stderr)
}

/// `sscc ... | head -1` ends quietly, with the exit code of the answers so far.
#[test]
fn a_closed_pipe_ends_quietly() {
    let directory = strips();
    let folder = directory.path();
    for (name, q) in [("free.npy", 0.1), ("colliding.npy", 1.0)] {
        let rows = [q, 0.0].repeat(20_000);
        sscc_io::write_npy(&folder.join(name), &[20_000, 2], &rows).unwrap();
    }
    for (trajectory, code) in [("free.npy", 0), ("colliding.npy", 1)] {
        for form in [&[][..], &["--json"], &["--continuous"]] {
            let args = ["check", MODEL, "--certificates", CERTIFICATES, "--trajectory", trajectory];
            assert_eq!(
                read_one_line(folder, &[&args, form].concat()),
                (Some(code), String::new()),
                "{trajectory} {form:?}"
            );
        }
    }
}

/// A pipe that is closed before the first line, of standard output or standard error, changes neither the written files
/// nor the exit code.
#[test]
fn closed_pipes_change_neither_files_nor_exit_codes() {
    let directory = strips();
    let folder = directory.path();
    let too_large = {
        let mut parts = sscc_io::read_certificates(&folder.join(CERTIFICATES)).unwrap().parts().clone();
        parts.node_radii.iter_mut().chain(&mut parts.root_pair_radii).for_each(|r| *r *= 2.0);
        parts.global_radius *= 2.0;
        sscc::Certificates::try_from(parts).unwrap()
    };
    sscc_io::write_certificates(&folder.join("too_large.sscc.safetensors"), &too_large).unwrap();
    for (args, code) in [
        (&["info", MODEL][..], 0),
        (&["certify", MODEL, "-o", "new.sscc.safetensors"], 0),
        (&["modes", "mesh.obj", "-o", "new.model.safetensors", "--kind", "polynomial"], 0),
        (&["audit", MODEL, "--certificates", CERTIFICATES, "--samples", "50"], 0),
        (&["audit", MODEL, "--certificates", "too_large.sscc.safetensors", "--samples", "50"], 1),
        // These commands print a note on standard error, that certificates are computed first.
        (&["check", MODEL, "--q=0,0"], 0),
        (&["check", MODEL, "--q=1,0"], 1),
        (&["check", "missing.obj", "--q=1,0"], 2),
        (&["bench", "--list"], 0),
        (&["--help"], 0),
        (&["check"], 2),
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut command = command(folder, args);
        command.stdout(writer.try_clone().unwrap()).stderr(writer);
        assert_eq!(command.status().unwrap().code(), Some(code), "{args:?}");
    }
    assert!(folder.join("new.sscc.safetensors").is_file() && folder.join("new.model.safetensors").is_file());
}
