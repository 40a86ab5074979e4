//! The scope of certificates: centres, neighbours, welds, exceptions, ignored pairs, dense metrics. Also limits of
//! answers.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};
use sscc_io::write_npy;

use crate::common::{STRIP, keys, sscc, strips};

const MODEL: &str = "strips.model.safetensors";
const CERTIFICATES: &str = "strips.sscc.safetensors";

fn certify(folder: &Path, model: &[&str], args: &[&str], output: &str) -> Value {
    let run = sscc(folder, &[&["certify"], model, args, &["-o", output, "--json"]].concat());
    assert_eq!(run.code, Some(0), "{run:?}");
    run.json().remove(0)
}

/// Writes a mesh of two strips that touch at rest. Returns the arguments of the model.
fn touching(folder: &Path) -> [&'static str; 3] {
    let obj = fs::read_to_string(folder.join("mesh.obj")).unwrap();
    let lowered = obj.replace(" 1\n", " 1e-300\n").replace("1e-300", "0");
    fs::write(folder.join("touching.obj"), lowered).unwrap();
    ["touching.obj", "--modes", "modes.npy"]
}

#[test]
fn first_and_limit() {
    let directory = strips();
    let folder = directory.path();
    write_npy(&folder.join("q.npy"), &[2, 2], &[0.5, 0.0, 1.0, 0.0]).unwrap();
    let check = |args: &[&str]| {
        let given = ["check", MODEL, "--certificates", CERTIFICATES, "--trajectory", "q.npy"];
        sscc(folder, &[&given, args].concat())
    };
    let all = check(&["--json"]).json();
    let count = all[1]["count"].as_u64().unwrap();
    assert!(count > 10);
    for method in ["certified", "bdtree", "traditional", "brute-force"] {
        for (args, limit) in [(&["--first"][..], 1), (&["--limit", "3"], 3), (&["--limit", "1000"], 1000)] {
            let lines = check(&[args, &["--json", "--method", method]].concat()).json();
            assert_eq!(keys(&lines[1]), keys(&all[1]));
            assert_eq!((&lines[0]["complete"], &lines[0]["count"]), (&json!(true), &json!(0)));
            assert_eq!(lines[1]["count"], json!(count.min(limit)), "{method} {args:?}");
            assert_eq!(lines[1]["complete"], json!(limit > count), "{method} {args:?}");
            let listed = all[1]["pairs"].as_array().unwrap();
            assert!(lines[1]["pairs"].as_array().unwrap().iter().all(|pair| listed.contains(pair)));
        }
    }
    assert!(check(&["--first"]).stdout.contains("COLLIDING  at least 1 pair, first "));
    check(&["--first", "--limit", "2"]).refusal();
    check(&["--limit", "0"]).refusal();
}

#[test]
fn exceptions_at_rest() {
    let directory = strips();
    let folder = directory.path();
    let model = touching(folder);
    let with = certify(folder, &model, &["--max-exceptions", "1000"], "with.sscc.safetensors");
    let without = certify(folder, &model, &["--max-exceptions", "0"], "without.sscc.safetensors");
    let ignored = certify(folder, &model, &["--ignore-rest"], "ignored.sscc.safetensors");
    let count = with["rest_collisions"].as_u64().unwrap();
    assert!(count > 20, "{with}");
    assert_eq!([&without["rest_collisions"], &ignored["rest_collisions"]], [&json!(count); 2]);
    assert_eq!(
        [&with["exceptions"], &without["exceptions"], &ignored["exceptions"]],
        [count, 0, 0].map(|n| json!(n)).each_ref()
    );
    assert_eq!(without["root_radius"], json!(0.0));
    assert!(with["root_radius"].as_f64().unwrap() > 0.1, "{with}");

    let check = |certificates: &str, q: &str| {
        let args = [&["check"], &model[..], &["--certificates", certificates, q, "--json"]].concat();
        sscc(folder, &args).json().remove(0)
    };
    for (q, collides) in
        [("--q=0,0", true), ("--q=0,0.01", true), ("--q=-0.01,0", false), ("--q=0.01,0", false)]
    {
        let [a, b] = ["with.sscc.safetensors", "without.sscc.safetensors"].map(|file| check(file, q));
        assert_eq!(a["pairs"], b["pairs"], "{q}");
        assert_eq!((&a["colliding"], &a["root_certified"]), (&json!(collides), &json!(true)), "{q}");
        assert_eq!(b["root_certified"], json!(false), "{q}");
        let c = check("ignored.sscc.safetensors", q);
        assert_eq!((&c["colliding"], &c["root_certified"]), (&json!(false), &json!(true)), "{q}");
    }
    // Too many exceptions: the note names the remedy.
    let args = [&["certify"], &model[..], &["--max-exceptions", "3", "-o", "few.sscc.safetensors"]].concat();
    let few = sscc(folder, &args);
    assert_eq!(few.code, Some(0));
    assert!(
        few.stderr.contains("than may be exceptions (3)") && few.stderr.contains("--ignore-rest"),
        "{few:?}"
    );
    let info = sscc(folder, &["info", "ignored.sscc.safetensors", "--json"]).json().remove(0);
    assert_eq!((&info["ignored"], &info["exceptions"]), (&json!(count), &json!(0)));
}

#[test]
fn one_vertex_neighbours() {
    let directory = strips();
    let folder = directory.path();
    // Two triangles with a common vertex; the mode lowers the second through the first.
    fs::write(folder.join("v.obj"), "v 0 0 0\nv 2 -1 -1\nv 2 1 -1\nv 1 0 1\nv 3 0 1\nf 1 2 3\nf 1 4 5\n")
        .unwrap();
    let lowered: Vec<f64> = (0..15).map(|row| if row >= 9 && row % 3 == 2 { -1.0 } else { 0.0 }).collect();
    write_npy(&folder.join("v.npy"), &[15, 1], &lowered).unwrap();
    let model = ["v.obj", "--modes", "v.npy"];
    certify(folder, &model, &[], "exclude.sscc.safetensors");
    let included =
        certify(folder, &model, &["--neighbours", "include-one-vertex"], "include.sscc.safetensors");
    assert!((1.35..1.5).contains(&included["root_radius"].as_f64().unwrap()), "{included}");
    let check = |args: &[&str]| sscc(folder, &[&["check"], &model[..], &["--q=2"], args].concat());
    assert_eq!(check(&["--certificates", "exclude.sscc.safetensors"]).code, Some(0));
    assert_eq!(check(&["--certificates", "include.sscc.safetensors"]).code, Some(1));
    for method in ["certified", "bdtree", "traditional", "brute-force"] {
        assert_eq!(check(&["--method", method]).code, Some(0));
        assert_eq!(check(&["--method", method, "--neighbours=include-one-vertex"]).code, Some(1));
    }
    let refused = check(&["--certificates", "exclude.sscc.safetensors", "--neighbours=include-one-vertex"]);
    assert!(
        refused
            .refusal()
            .contains("neighbours = exclude, but include-one-vertex was requested; certify anew")
    );
    let refused = check(&["--certificates", "include.sscc.safetensors", "--neighbours=exclude"]);
    assert!(refused.refusal().contains("neighbours = include-one-vertex, but exclude was requested"));
    let audit = [&["audit"], &model[..], &["--certificates", "include.sscc.safetensors", "--samples", "100"]]
        .concat();
    assert_eq!(sscc(folder, &audit).code, Some(0));
}

#[test]
fn centres() {
    let directory = strips();
    let folder = directory.path();
    // The strips touch at q_0 = 1, half a unit from this centre.
    let about = certify(folder, &[MODEL], &["--center=1.5,0.25"], "about.sscc.safetensors");
    let root = about["root_radius"].as_f64().unwrap();
    assert!((0.45..=0.5).contains(&root), "{about}");
    let check = |q: &str, more: &[&str]| {
        let args = ["check", MODEL, "--certificates", "about.sscc.safetensors", q, "--json"];
        sscc(folder, &[&args, more].concat())
    };
    let inside = check("--q=1.5,0.5", &[]).json().remove(0);
    assert_eq!(inside["root_certified"], json!(true));
    assert!((inside["norm"].as_f64().unwrap() - 0.25).abs() < 1e-12, "{inside}");
    let outside = check("--q=1,0.25", &[]).json().remove(0);
    assert_eq!((&outside["root_certified"], &outside["colliding"]), (&json!(false), &json!(true)));
    // The same centre from a file; another one is refused.
    write_npy(&folder.join("c.npy"), &[2], &[1.5, 0.25]).unwrap();
    assert_eq!(check("--q=1.5,0.5", &["--center", "c.npy"]).code, Some(0));
    assert!(check("--q=0,0", &["--center=0,0"]).refusal().contains("certified about another centre"));
    for (center, named) in [
        ("--center=1", "--center: q has 1 entries, the model has 2 modes"),
        ("--center=1,nan", "q[1] is NaN"),
        ("--center=1e300,0", "beyond 2^200"),
        ("--center=none.npy", "none.npy: not found"),
    ] {
        let run = sscc(folder, &["certify", MODEL, center, "-o", "no.sscc.safetensors"]);
        assert!(run.refusal().contains(named), "{run:?}");
    }
    let audit = ["audit", MODEL, "--certificates", "about.sscc.safetensors", "--samples", "200", "--json"];
    let audit = sscc(folder, &audit).json().remove(0);
    assert_eq!((&audit["samples"], &audit["violations"]), (&json!(200), &json!(0)));
    assert!(audit["root_tightness"].as_f64().unwrap() > 0.85, "{audit}");
}

#[test]
fn dense_metrics() {
    let directory = strips();
    let folder = directory.path();
    // M = [4 2; 2 5]: |z| at (1, 0) is 2, at (1, -1) is sqrt(5).
    write_npy(&folder.join("m.npy"), &[2, 2], &[4.0, 2.0, 2.0, 5.0]).unwrap();
    let dense = certify(folder, &[MODEL], &["--metric", "m.npy"], "dense.sscc.safetensors");
    let check = |q: &str, more: &[&str]| {
        let args = ["check", MODEL, "--certificates", "dense.sscc.safetensors", q, "--json"];
        sscc(folder, &[&args, more].concat())
    };
    let norm = |q: &str| check(q, &[]).json()[0]["norm"].as_f64().unwrap();
    assert!((norm("--q=1,0") - 2.0).abs() < 1e-12 && (norm("--q=1,-1") - 5.0_f64.sqrt()).abs() < 1e-12);
    // Nearest contact: q_0 = 1 and the best q_1, -2/5: |z|^2 = 4 - 4/5.
    let root = dense["root_radius"].as_f64().unwrap();
    assert!(root <= 3.2_f64.sqrt() && root > 0.89 * 3.2_f64.sqrt(), "{root}");
    assert_eq!(check("--q=1,-0.4", &[]).code, Some(1));
    assert_eq!(check("--q=0.5,0", &["--metric", "m.npy"]).code, Some(0));
    assert!(check("--q=0.5,0", &["--metric", "identity"]).refusal().contains("another metric (given)"));
    let info = sscc(folder, &["info", "dense.sscc.safetensors", "--json"]).json().remove(0);
    assert_eq!((&info["metric"], &info["metric_form"]), (&json!("given"), &json!("dense")));
    let without = ["check", MODEL, "--metric", "m.npy", "--method", "bdtree", "--q=1,0", "--json"];
    assert!((sscc(folder, &without).json()[0]["norm"].as_f64().unwrap() - 2.0).abs() < 1e-12);
    for (shape, values, named) in [
        (
            &[2, 2][..],
            &[1.0, 2.0, 2.0, 1.0][..],
            "m2.npy: the metric's matrix cannot be used: it is not positive definite",
        ),
        (&[2, 2], &[1.0, 0.5, 0.0, 1.0], "it is not symmetric"),
        (&[2, 2], &[1.0, f64::NAN, f64::NAN, 1.0], "it is not symmetric and finite"),
        (&[2, 2], &[1e-200, 0.0, 0.0, 1.0], "below 2^-200"),
        (&[3, 3], &[1.0; 9], "the metric is 3 x 3, the model has 2 modes"),
        (&[1, 3], &[1.0; 3], "the metric has 3 weights, the model has 2 modes"),
    ] {
        write_npy(&folder.join("m2.npy"), shape, values).unwrap();
        let run = sscc(folder, &["certify", MODEL, "--metric", "m2.npy", "-o", "no.sscc.safetensors"]);
        assert!(run.refusal().contains(named), "{run:?}");
    }
}

#[test]
fn flags_must_not_contradict_certificates() {
    let directory = strips();
    let folder = directory.path();
    let run = |args: &[&str]| {
        sscc(folder, &[&["check", MODEL, "--certificates", CERTIFICATES, "--q=0,0"], args].concat())
    };
    for agrees in
        ["--center=0,0", "--neighbours=exclude", "--weld=off", "--ignore-rest", "--max-exceptions=0"]
    {
        assert_eq!(run(&[agrees]).code, Some(0), "{agrees}");
    }
    for (contradicts, named) in [
        ("--weld", "they were computed without welding"),
        ("--weld=on", "they were computed without welding"),
        ("--center=0,1", "another centre"),
        ("--neighbours=include-one-vertex", "they have neighbours = exclude, but include-one-vertex"),
    ] {
        assert!(run(&[contradicts]).refusal().contains(named), "{contradicts}");
    }
    let model = touching(folder);
    certify(folder, &model, &["--max-exceptions=1000"], "t.sscc.safetensors");
    let run = |flag| {
        let args =
            [&["check"], &model[..], &["--certificates", "t.sscc.safetensors", "--q=0,0", flag]].concat();
        sscc(folder, &args)
    };
    assert!(run("--ignore-rest").refusal().contains("certified without --ignore-rest"));
    assert!(run("--ignore-rest=2").refusal().contains("certified without --ignore-rest of 2 rings"));
    assert!(run("--max-exceptions=1").refusal().contains("more than --max-exceptions allows"));
    assert_eq!(run("--max-exceptions=1000").code, Some(1));
    certify(folder, &model, &["--ignore-rest=1"], "t.sscc.safetensors");
    assert_eq!(run("--ignore-rest=1").code, Some(0));
    let refused = run("--ignore-rest");
    assert!(
        refused.refusal().contains("certified with --ignore-rest of 1 ring, not with --ignore-rest; leave")
    );
    let refused = run("--ignore-rest=2");
    let named =
        "certified with --ignore-rest of 1 ring, not with --ignore-rest of 2 rings; leave the flag out";
    assert!(refused.refusal().contains(named), "{refused:?}");
}

/// The two strips in groups of their own.
#[test]
fn groups_can_be_left_out() {
    let directory = strips();
    let folder = directory.path();
    let obj = fs::read_to_string(folder.join("mesh.obj")).unwrap();
    let (first, second) = (obj.find("f ").unwrap(), obj.find(&format!("f {} ", STRIP + 1)).unwrap());
    let grouped =
        [&obj[..first], "g low\no x\nusemtl red\n", &obj[first..second], "g high\n", &obj[second..]];
    fs::write(folder.join("grouped.obj"), grouped.concat()).unwrap();
    let faces = obj.matches("f ").count();
    let numbers: Vec<f64> = (0..faces).map(|t| f64::from(u8::from(2 * t >= faces))).collect();
    write_npy(&folder.join("numbers.npy"), &[faces], &numbers).unwrap();
    let model = ["grouped.obj", "--modes", "modes.npy"];
    let of_file = ["--group-by", "numbers.npy"];
    let without = |certificates: &[&str]| {
        let run = sscc(folder, &[&["check"], &model[..], &["--q=1,0"], certificates].concat());
        run.code
    };
    assert_eq!(without(&[]), Some(1));
    certify(folder, &model, &["--ignore-groups=low,high"], "g.sscc.safetensors");
    certify(
        folder,
        &[MODEL],
        &[&of_file[..], &["--only-groups=0,0", "--only-groups=1,1"]].concat(),
        "n.sscc.safetensors",
    );
    let bytes = ["g", "n"].map(|name| fs::read(folder.join(format!("{name}.sscc.safetensors"))).unwrap());
    assert_eq!(bytes[0], bytes[1]);
    let info = sscc(folder, &["info", "g.sscc.safetensors"]);
    assert!(info.stdout.contains("groups         2 groups of triangles"), "{info:?}");
    let certificates = ["--certificates", "g.sscc.safetensors"];
    for args in [
        &[][..],
        &["--ignore-groups=high,low"],
        &["--only-groups=low,low", "--only-groups=high,high"],
        &["--ignore-groups=0,1", of_file[0], of_file[1]],
    ] {
        assert_eq!(without(&[&certificates, args].concat()), Some(0), "{args:?}");
    }
    for method in ["bdtree", "traditional", "normal-cones", "brute-force"] {
        assert_eq!(without(&["--ignore-groups=low,high", "--method", method]), Some(0));
        assert_eq!(without(&["--ignore-groups=low,low", "--method", method]), Some(1));
    }
    assert_eq!(without(&["--only-groups=red,red", "--group-by=material"]), Some(1));
    let refusals = [
        (&["--ignore-groups=low,low"][..], "their groups of triangles, or which pairs of them count, differ"),
        (
            &["--ignore-groups=low,middle"],
            "--ignore-groups low,middle: no triangle is in a group 'middle'; groups: 'low', 'high'",
        ),
        (&["--only-groups=low"], "--only-groups low: two groups A,B were expected"),
        (&["--ignore-groups=low,low", "--only-groups=low,low"], "cannot be used with"),
        (&["--group-by=material"], "--group-by: it changes nothing"),
        (&["--ignore-groups=0,1", "--group-by=mass"], "must be a file"),
    ];
    for (args, named) in refusals {
        let run = sscc(folder, &[&["check"], &model[..], &["--q=1,0"], &certificates, args].concat());
        assert!(run.refusal().contains(named), "{args:?}: {run:?}");
    }
    let other = ["check", MODEL, "--certificates", CERTIFICATES, "--q=1,0", "--ignore-groups=0,1"];
    let run = |args: &[&str]| sscc(folder, &[&other[..], args].concat()).refusal().to_owned();
    assert!(run(&of_file).contains("they were computed without groups of triangles"));
    assert!(run(&[]).contains("files of this kind have no groups of triangles"));
    write_npy(&folder.join("short.npy"), &[2], &[0.0, 1.0]).unwrap();
    assert!(run(&["--group-by=short.npy"]).contains("there are groups of 2 triangles, but the model has 20"));
}

#[test]
fn poses_that_cannot_be_written_are_refused() {
    let directory = strips();
    let folder = directory.path();
    for (args, named) in [
        (
            &["--q=0,0", "--pose", "pose.stl"][..],
            "pose.stl: the name of a pose must end in .ply, .obj or .vtu",
        ),
        (&["--q=0,0", "--pose", "none/pose.ply"], "none/pose.ply: cannot be written"),
        (&["--q=0,0", "--pose", "mesh.obj"], "mesh.obj: the output is an input"),
        (&["--trajectory", "modes.npy", "--pose", "pose.ply"], "--trajectory"),
        (&["--q=0,0", "--first", "--pose", "pose.ply"], "--pose"),
    ] {
        let run = sscc(folder, &[&["check", "mesh.obj", "--modes", "modes.npy"], args].concat());
        assert!(run.refusal().contains(named), "{run:?}");
    }
}

/// Returns the line of `certify` about the root's radius, and its note.
fn promise(folder: &Path, model: &[&str], args: &[&str]) -> (String, String) {
    let run = sscc(folder, &[&["certify"], model, args, &["-o", "x.sscc.safetensors"]].concat());
    assert_eq!(run.code, Some(0), "{run:?}");
    let promise = run.stdout.lines().find(|line| line.starts_with("root radius")).unwrap().to_owned();
    (promise, run.stderr)
}

/// Two triangles one rounding apart do not collide: the note about the radius of 0 recommends no flag for collisions.
#[test]
fn near_contact_is_not_reported_as_a_collision() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let above = 1.0 + f64::EPSILON;
    let face = |z: f64| format!("v 0 0 {z}\nv 1 0 {z}\nv 0 1 {z}\n");
    fs::write(folder.join("near.obj"), format!("{}{}f 1 2 3\nf 4 5 6\n", face(1.0), face(above))).unwrap();
    let mode: Vec<f64> = (0..18).map(|row| if row >= 9 && row % 3 == 2 { 1.0 } else { 0.0 }).collect();
    write_npy(&folder.join("near.npy"), &[18, 1], &mode).unwrap();
    let model = ["near.obj", "--modes", "near.npy"];
    for args in [&[][..], &["--ignore-rest"], &["--max-exceptions", "0"], &["--scheme", "paper"]] {
        let report = certify(folder, &model, args, "x.sscc.safetensors");
        assert_eq!((&report["root_radius"], &report["rest_collisions"]), (&json!(0.0), &json!(0)));
        let (promise, note) = promise(folder, &model, args);
        assert!(promise.contains("0: two triangles nearly touch at the centre"), "{promise}");
        assert!(
            note.starts_with("note: no other pair collides at the centre, but two of the triangles 0, 1 "),
            "{note}"
        );
        assert!(!note.contains("--ignore-rest") && !note.contains("--max-exceptions"), "{note}");
    }
}

/// The note recommends a flag only if the flag helps.
#[test]
fn recommended_flags_help() {
    let directory = strips();
    let folder = directory.path();
    let touching = touching(folder);
    // Too many pairs collide at rest: both flags help.
    let (line, note) = promise(folder, &touching, &["--max-exceptions", "1"]);
    assert!(
        line.ends_with(
            "0: the shape collides with itself at the centre; the parts that do not are certified"
        )
    );
    assert!(note.contains("than may be exceptions (1)") && note.contains("raise --max-exceptions"), "{note}");
    assert!(note.contains("--ignore-rest"), "{note}");
    let (line, note) = promise(folder, &touching, &["--max-exceptions", "1", "--ignore-rest"]);
    assert!(line.ends_with(": below it the whole shape is free, apart from ignored pairs"), "{line}");
    assert_eq!(note, "");
    // Pairs collide at the centre, and none at rest: --ignore-rest would not help.
    for given in [&[][..], &["--ignore-rest"]] {
        let args = [&["--center=1,0", "--max-exceptions", "1"], given].concat();
        let (line, note) = promise(folder, &[MODEL], &args);
        assert!(line.contains("0: the shape collides with itself at the centre"), "{line}");
        assert!(note.contains("raise --max-exceptions") && !note.contains("--ignore-rest"), "{note}");
    }
}

/// The report of an audit states why the tightness of the root is unknown.
#[test]
fn an_audit_states_why_a_tightness_is_unknown() {
    let directory = strips();
    let folder = directory.path();
    let root = |certify: &[&str], model: &[&str]| {
        let run = sscc(folder, &[&["certify"], model, certify, &["-o", "x.sscc.safetensors"]].concat());
        assert_eq!(run.code, Some(0), "{run:?}");
        let args = [&["audit"], model, &["--certificates", "x.sscc.safetensors", "--samples", "10"]].concat();
        let run = sscc(folder, &args);
        run.stdout.lines().find(|line| line.starts_with("  root ")).unwrap().to_owned()
    };
    let touching = touching(folder);
    assert_eq!(root(&["--max-exceptions", "1"], &touching), "  root     - (the radius is 0)");
    write_npy(&folder.join("still.npy"), &[72, 1], &[0.0; 72]).unwrap();
    assert!(
        root(&[], &["mesh.obj", "--modes", "still.npy"]).starts_with("  root     - (the radius is capped")
    );
}

/// The note about split vertices depends on equal vertices, not on the file's name.
#[test]
fn split_vertices_are_found() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let facet = |x: f64| {
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(a, b)| format!("vertex {} {b} 0\n", a + x));
        format!("facet normal 0 0 1\nouter loop\n{}endloop\nendfacet\n", corners.concat())
    };
    for (name, x, is_split) in [("apart.stl", 2.0, false), ("seam.stl", 1.0, true)] {
        fs::write(folder.join(name), format!("solid\n{}{}endsolid\n", facet(0.0), facet(x))).unwrap();
        let args = ["modes", name, "-o", "x.model.safetensors", "--kind", "polynomial"];
        let run = sscc(folder, &args);
        assert_eq!(run.code, Some(0), "{run:?}");
        assert_eq!(run.stderr.contains("certify the model with --weld"), is_split, "{name}: {}", run.stderr);
    }
}
