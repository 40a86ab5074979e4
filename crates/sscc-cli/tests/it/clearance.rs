//! `sscc check --clearance`, and meshes inside others.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::common::{Run, keys, sorted, sscc, strips};
use crate::detector::folder;

const KEYS: &str = "index, norm, colliding, count, complete, pairs, microseconds, root_certified, proof, opened, box_tests, \
                    triangle_tests, clearance, rings, distance, nearest, distances";

fn check(folder: &Path, args: &[&str]) -> Run {
    sscc(folder, &[&["check"], args].concat())
}

fn lines(folder: &Path, args: &[&str], code: i32) -> Vec<Value> {
    let run = check(folder, &[args, &["--json"]].concat());
    assert_eq!((run.code, run.stderr.as_str()), (Some(code), ""), "{run:?}");
    run.json()
}

#[test]
fn near_pairs_of_a_mesh_and_of_its_frames() {
    let folder = folder();
    let folder = folder.path();
    let far = &lines(folder, &["mesh.obj", "--clearance", "0.5"], 0)[0];
    assert_eq!(keys(far), sorted(KEYS));
    assert_eq!(
        (&far["pairs"], &far["distances"], &far["colliding"]),
        (&json!([]), &json!([]), &json!(false))
    );
    assert_eq!((&far["distance"], &far["nearest"], &far["rings"]), (&json!(1.0), &json!([0, 1]), &json!(1)));
    let near = &lines(folder, &["mesh.obj", "--clearance", "1.5"], 1)[0];
    assert_eq!(
        (&near["pairs"], &near["distances"], &near["clearance"]),
        (&json!([[0, 1]]), &json!([1.0]), &json!(1.5))
    );
    // A distance equal to the clearance is kept.
    lines(folder, &["mesh.obj", "--clearance", "1"], 0);

    let all = lines(folder, &["mesh.obj", "--frames", "frames.npy", "--clearance=0.7"], 1);
    let of = |key: &str| all.iter().map(|line| line[key].clone()).collect::<Vec<_>>();
    assert_eq!(of("distance"), [json!(1.0), json!(0.5), json!(0.0), json!(0.5)]);
    assert_eq!(of("colliding"), [json!(false), json!(false), json!(true), json!(false)]);
    let text = check(folder, &["mesh.obj", "--frames", "frames.npy", "--clearance=0.7"]);
    let rows: Vec<&str> = text.stdout.lines().collect();
    assert!(rows[0].ends_with("clear      nearest 0 1 at 1.000"), "{text:?}");
    assert!(rows[1].ends_with("NEAR       1 pair, nearest 0 1 at 0.5000"), "{text:?}");
    assert!(rows[4].starts_with("4 frames: 1 clear, 3 near; median "), "{text:?}");
    assert!(rows[4].contains("; worst: frame 2 (1 pair, nearest 0)"), "{text:?}");
    let text = check(folder, &["mesh.obj", "--clearance=2"]);
    assert!(
        text.stdout.starts_with("NEAR: 1 pair of triangles nearer than 2.000; nearest: 0 1 at 1.000\n"),
        "{text:?}"
    );
    assert!(text.stdout.ends_with("       0        1  distance 1.000\n"), "{text:?}");
    let text = check(folder, &["mesh.obj", "--clearance=0.5"]).stdout;
    let start = "clear: no triangles are nearer than 0.5000; nearest: 0 1 at 1.000, apart from pairs with common vertices\n";
    assert!(text.starts_with(start), "{text}");
}

#[test]
fn rings_leave_out_pairs_that_are_near_on_the_surface() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // A strip of five triangles: the first and the last two have no common vertex.
    fs::write(folder.join("strip.obj"), "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 2 0 0\nv 2 1 0\nv 3 0 0\nf 1 2 3\nf 2 4 3\nf 3 4 5\nf 4 6 5\nf 5 6 7\n").unwrap();
    let near = &lines(folder, &["strip.obj", "--clearance=1.5"], 1)[0];
    assert_eq!(near["pairs"], json!([[0, 3], [0, 4], [1, 4]]));
    let beyond = &lines(folder, &["strip.obj", "--clearance=1.5", "--rings=2"], 0)[0];
    assert_eq!(
        (&beyond["pairs"], &beyond["distance"], &beyond["rings"]),
        (&json!([]), &Value::Null, &json!(2))
    );
    let text = check(folder, &["strip.obj", "--clearance=1.5", "--rings=2"]).stdout;
    assert!(
        text.starts_with("clear: no triangles are nearer than 1.500; no pair counts, apart from "),
        "{text}"
    );
    assert!(text.lines().next().unwrap().ends_with("common vertices, and within 2 rings"), "{text}");
}

#[test]
fn near_pairs_of_a_model_and_of_two_meshes() {
    let folder = strips();
    let folder = folder.path();
    let model = "strips.model.safetensors";
    let lines_at = lines(folder, &[model, "--q=0.25,0", "--clearance=0.7", "--rings=100"], 0);
    assert_eq!(keys(&lines_at[0]), sorted(KEYS));
    assert_eq!(lines_at[0]["distance"], json!(0.75));
    let near = &lines(folder, &[model, "--q=0.5,0", "--clearance=0.7", "--rings=100"], 1)[0];
    assert_eq!((&near["distance"], &near["rings"]), (&json!(0.5), &json!(100)));
    assert_eq!(near["distances"].as_array().unwrap().len(), near["count"].as_u64().unwrap() as usize);

    let folder = self::folder();
    let folder = folder.path();
    let near = &lines(folder, &["mesh.obj", "--against=lower.obj", "--clearance=0.1"], 1)[0];
    assert_eq!((&near["distance"], &near["colliding"]), (&json!(0.0), &json!(true)));
    let far = "v 0 0 50\nv 1 0 50\nv 0 1 50\nf 1 2 3\n";
    fs::write(folder.join("far.obj"), far).unwrap();
    let far = &lines(folder, &["mesh.obj", "--against=far.obj", "--clearance=0.1"], 0)[0];
    assert_eq!((&far["distance"], &far["nearest"]), (&json!(49.0), &json!([1, 0])));
}

#[test]
fn unusable_clearances_are_refused() {
    let folder = folder();
    for (value, name) in [("0", "0"), ("-1", "-1"), ("inf", "inf"), ("nan", "NaN")] {
        let run = check(folder.path(), &["mesh.obj", &format!("--clearance={value}")]);
        assert_eq!(run.refusal(), format!("error: --clearance is {name}: it must be positive and finite"));
    }
    for other in
        ["--continuous", "--first", "--depths", "--limit=1", "--neighbours=exclude", "--method=bdtree"]
    {
        let run = check(folder.path(), &["mesh.obj", "--clearance=1", other]);
        assert!(run.refusal().contains("cannot be used with"), "{run:?}");
    }
    assert!(check(folder.path(), &["mesh.obj", "--rings=2"]).refusal().contains("--clearance"));
}

/// Checks with certificates of a clearance have the same answers, and other commands refuse these certificates.
#[test]
fn certificates_with_a_clearance_serve_near_pairs_alone() {
    let folder = strips();
    let folder = folder.path();
    let model = "strips.model.safetensors";
    let certify = |output: &str, args: &[&str]| {
        let run = sscc(folder, &[&["certify", model, "-o", output, "--json"], args].concat());
        assert_eq!(run.code, Some(0), "{run:?}");
        run.json().remove(0)
    };
    let report = certify("near.sscc.safetensors", &["--clearance", "0.4", "--rings", "50"]);
    assert_eq!((&report["clearance"], &report["rings"]), (&json!(0.4), &json!(50)));
    assert!(report["root_radius"].as_f64().unwrap() > 0.0, "{report}");
    let plain = certify("plain.sscc.safetensors", &[]);
    assert_eq!((plain.get("clearance"), plain.get("rings")), (None, None));
    let near = ["--rings=50", "--certificates", "near.sscc.safetensors"];
    let mut proofs = Vec::new();
    for (q, clearance, code) in
        [("0,0", "0.4", 0), ("0.5,0", "0.4", 0), ("0.7,0", "0.4", 1), ("0.7,0", "0.2", 0), ("1,0", "0.3", 1)]
    {
        let asked = [model, &format!("--q={q}"), &format!("--clearance={clearance}")];
        let with = &lines(folder, &[&asked[..], &near].concat(), code)[0];
        let without = &lines(folder, &[&asked[..], &["--rings=50"]].concat(), code)[0];
        assert_eq!(keys(with), sorted(KEYS));
        for key in ["pairs", "distances", "colliding", "norm", "clearance", "rings"] {
            assert_eq!(with[key], without[key], "{q} {clearance} {key}");
        }
        // A smallest distance that is not below the clearance is unknown.
        let expected = if code == 1 { without["distance"].clone() } else { Value::Null };
        assert_eq!(with["distance"], expected, "{q} {clearance}");
        proofs.push(with["proof"].clone());
    }
    assert_eq!(proofs[0], json!("radius"));
    assert!(proofs.contains(&json!("search")), "{proofs:?}");
    let text = check(folder, &[&[model, "--q=0,0", "--clearance=0.4"][..], &near].concat()).stdout;
    assert!(
        text.starts_with(
            "clear: no triangles are nearer than 0.4000, by the root's certificate, apart from "
        ),
        "{text}"
    );

    let refused = |args: &[&str]| check(folder, &[&[model, "--q=0,0"], args].concat()).refusal().to_owned();
    let file = "near.sscc.safetensors";
    assert_eq!(
        refused(&["--clearance=0.5", "--rings=50", "--certificates", file]),
        format!("error: {file}: certified with a smaller --clearance (0.4) than 0.5; certify anew")
    );
    assert_eq!(
        refused(&["--clearance=0.4", "--rings=49", "--certificates", file]),
        format!("error: {file}: certified beyond 50 rings, more than --rings 49; certify anew")
    );
    assert_eq!(
        refused(&["--clearance=0.4", "--certificates", "plain.sscc.safetensors"]),
        "error: plain.sscc.safetensors: certified without --clearance; certify anew"
    );
    let cause = "certified with a clearance (0.4), which proves nothing about collisions; add --clearance to ask for near pairs, or certify \
                 anew without";
    assert_eq!(refused(&["--certificates", file]), format!("error: {file}: {cause}"));
    for command in ["sweep", "resolve", "view"] {
        let q: &[&str] = if command == "resolve" { &["--q=0,0"] } else { &[] };
        let run = sscc(folder, &[&[command, model, "--certificates", file], q].concat());
        assert!(run.refusal().contains("proves nothing about collisions"), "{command}: {run:?}");
    }
    for (value, name) in [("0", "0"), ("-1", "-1"), ("inf", "inf"), ("nan", "NaN")] {
        let run =
            sscc(folder, &["certify", model, "-o", "x.sscc.safetensors", &format!("--clearance={value}")]);
        assert_eq!(run.refusal(), format!("error: --clearance is {name}: it must be positive and finite"));
    }
    let audited = sscc(folder, &["audit", model, "--certificates", file, "--samples=300", "--json"]);
    assert_eq!((audited.code, &audited.json()[0]["violations"]), (Some(0), &json!(0)), "{audited:?}");
    let info = sscc(folder, &["info", file]);
    assert!(
        info.stdout.contains("clearance      0.4000, beyond 50 rings; nothing about collisions"),
        "{info:?}"
    );
    let info = &sscc(folder, &["info", file, "--json"]).json()[0];
    assert_eq!((&info["clearance"], &info["rings"]), (&json!(0.4), &json!(50)));
    // If too many pairs are near at the centre, a note names the remedy.
    let close = sscc(
        folder,
        &[
            "certify",
            model,
            "-o",
            "close.sscc.safetensors",
            "--clearance=3",
            "--rings=1",
            "--max-exceptions=0",
        ],
    );
    assert!(close.stderr.contains("leave out more of the surface with --rings 2"), "{close:?}");
}

/// Two triangles whose distance is exactly the clearance are not nearer than it, and the radius is 0.
#[test]
fn triangles_exactly_as_far_apart_as_the_clearance_are_not_reported_as_nearer() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let face = |z: f64| format!("v 0 0 {z}\nv 1 0 {z}\nv 0 1 {z}\n");
    fs::write(folder.join("plates.obj"), format!("{}{}f 1 2 3\nf 4 5 6\n", face(0.0), face(0.5))).unwrap();
    let mode: Vec<f64> = (0..18).map(|row| if row >= 9 && row % 3 == 2 { 1.0 } else { 0.0 }).collect();
    sscc_io::write_npy(&folder.join("plates.npy"), &[18, 1], &mode).unwrap();
    let args = ["plates.obj", "--modes=plates.npy", "--clearance=0.5", "--max-exceptions=0"];
    let run = sscc(folder, &[&["certify"], &args[..], &["-o", "x.sscc.safetensors"]].concat());
    let line = run.stdout.lines().find(|line| line.starts_with("root radius")).unwrap();
    assert!(
        line.ends_with(
            "0: two triangles are so little farther apart than 0.5000 at the centre that no radius above 0 is proven; the \
             parts without both are certified"
        ),
        "{run:?}"
    );
    let start =
        "note: no other pair is nearer than the clearance at the centre, but two of the triangles 0, 1 ";
    assert!(run.stderr.starts_with(start), "{run:?}");
}

/// The commands of `docs/command.md`.
#[test]
fn the_guide_certifies_a_clearance() {
    let folder = strips();
    let folder = folder.path();
    fs::copy(folder.join("strips.model.safetensors"), folder.join("face.model.safetensors")).unwrap();
    sscc_io::write_npy(&folder.join("q.npy"), &[3, 2], &[0.0, 0.0, 0.1, 0.0, 0.9, 0.0]).unwrap();
    let guide = include_str!("../../../../docs/command.md");
    let section = guide.split("### Certificates with a clearance").nth(1).unwrap();
    let block = section.split("```").nth(1).unwrap();
    let run = |line: &str| sscc(folder, &line.split(' ').skip(1).collect::<Vec<_>>());
    let codes: Vec<_> = block.lines().skip(1).map(|line| run(line).code).collect();
    // The strips come as near as 0.1 in the last row.
    assert_eq!(codes, [Some(0), Some(1), Some(0)]);
}

/// A cube from -half to half along each axis, around (at, 0, 0).
fn cube(at: f64, half: f64) -> String {
    let corner = |i: u8| {
        let [x, y, z] = [0, 1, 2].map(|axis| if i >> axis & 1 == 1 { half } else { -half });
        format!("v {} {y} {z}\n", x + at)
    };
    let vertices: String = (0..8).map(corner).collect();
    vertices + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
}

#[test]
fn a_mesh_inside_another_one_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("housing.obj"), cube(0.0, 2.0)).unwrap();
    fs::write(folder.join("part.obj"), cube(0.5, 0.5)).unwrap();
    fs::write(folder.join("beside.obj"), cube(9.0, 0.5)).unwrap();
    let found = &lines(folder, &["housing.obj", "--against=part.obj"], 0)[0];
    assert_eq!((&found["inside"], &found["components"]), (&json!([0, 1]), &json!([1, 1])));
    assert_eq!(lines(folder, &["part.obj", "--against=housing.obj"], 0)[0]["inside"], json!([1, 0]));
    assert_eq!(lines(folder, &["housing.obj", "--against=beside.obj"], 0)[0].get("inside"), None);
    let text = check(folder, &["housing.obj", "--against=part.obj"]).stdout;
    assert!(text.lines().next().unwrap().ends_with("; the second mesh is inside the first one"), "{text}");
    let near = &lines(folder, &["housing.obj", "--against=part.obj", "--clearance=0.5"], 0)[0];
    assert_eq!((&near["inside"], &near["distance"]), (&json!([0, 1]), &json!(1.0)));
}
