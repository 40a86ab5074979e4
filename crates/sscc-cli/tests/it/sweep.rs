//! `sscc sweep`, and weights by name in `--q`.

use std::fs;

use serde_json::json;

use crate::common::{Run, files, keys, page_data, sorted, sscc, strips};

const MODEL: &str = "strips.model.safetensors";
const CERTIFICATES: &str = "strips.sscc.safetensors";

#[test]
fn each_weight_is_swept_both_ways() {
    let directory = strips();
    let folder = directory.path();
    let swept =
        |more: &[&str]| sscc(folder, &[&["sweep", MODEL, "--certificates", CERTIFICATES][..], more].concat());
    let run = swept(&["--range=-2,3", "--pose", "poses", "--json"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(1), ""), "{run:?}");
    let rows = run.json();
    let usual = sorted("name, from, to, first_free, first_hit, pairs");
    assert!(rows.len() == 4 && rows.iter().all(|row| keys(row) == usual), "{rows:?}");
    let ends: Vec<_> = rows.iter().map(|row| (row["name"].as_str().unwrap(), row["to"].as_f64())).collect();
    assert_eq!(ends, [("0", Some(3.0)), ("0", Some(-2.0)), ("1", Some(3.0)), ("1", Some(-2.0))]);
    // The upper strip touches the lower one.
    let (free, hit) = (rows[0]["first_free"].as_f64().unwrap(), rows[0]["first_hit"].as_f64().unwrap());
    assert!(free < 1.0 && hit >= 1.0 && hit - free <= 5e-9, "{free} {hit}");
    assert!(rows[0]["pairs"].as_array().is_some_and(|pairs| pairs.len() > 10));
    assert!(rows[1..].iter().all(|row| row["first_free"] == row["to"] && row["first_hit"].is_null()));
    assert_eq!(files(&folder.join("poses")), [folder.join("poses/000_0_up.ply")]);
    let colours = fs::read(folder.join("poses/000_0_up.ply")).unwrap();
    assert!(colours.windows(3).any(|rgb| rgb == [220, 30, 30]));

    let table = swept(&["--range=-2,3"]);
    assert!(
        table.stdout.contains("touches at 1 ") && table.stdout.ends_with("at every weight\n"),
        "{table:?}"
    );
    assert_eq!(swept(&["--range=0,0.5"]).code, Some(0));
    // From another start; certificates are computed first.
    let run = sscc(folder, &["sweep", MODEL, "--q=0=2,1=0.5", "--range=-1,2", "--json"]);
    assert_eq!(run.json()[0]["from"], 2.0, "{run:?}");
    assert!(run.json()[0]["first_hit"].as_f64().is_some_and(|hit| (hit - 1.0).abs() < 4e-9), "{run:?}");
    // The start collides.
    let run = swept(&["--q=1,0", "--json"]);
    assert_eq!(run.code, Some(1), "{run:?}");
    assert!(run.json()[0]["first_free"].is_null() && run.json()[0]["first_hit"] == 1.0, "{run:?}");
    let note = run.json()[0]["note"].clone();
    assert!(note.as_str().is_some_and(|note| note.starts_with("the shape collides at the start")), "{note}");
}

#[test]
fn intervals_are_listed_for_each_weight() {
    let directory = strips();
    let folder = directory.path();
    let swept =
        |more: &[&str]| sscc(folder, &[&["sweep", MODEL, "--certificates", CERTIFICATES][..], more].concat());
    let run = swept(&["--range=-2,3", "--intervals=6", "--json"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(1), ""), "{run:?}");
    let rows = run.json();
    assert!(
        rows.len() == 2 && rows.iter().all(|row| keys(row) == sorted("name, from, to, intervals, samples"))
    );
    assert_eq!((rows[1]["intervals"].as_array().unwrap().len(), rows[1]["name"].as_str()), (0, Some("1")));
    let interval = &rows[0]["intervals"][0];
    assert_eq!(
        keys(interval),
        sorted("from, to, free_until, free_from, exact, pairs, depth, deepest"),
        "{interval}"
    );
    assert!(interval["from"].as_f64().is_some_and(|from| (from - 1.0).abs() < 5e-9), "{interval}");
    // Each sample is an answer of `check`.
    let samples = rows[0]["samples"].as_array().unwrap();
    assert_eq!(samples.len(), 6);
    for sample in samples {
        let q = format!("--q={},0", sample[0]);
        let check = sscc(folder, &["check", MODEL, "--certificates", CERTIFICATES, &q, "--json"]);
        assert_eq!(check.json()[0]["count"], sample[1], "{sample}");
    }
    let table = swept(&["--range=-2,3", "--intervals"]);
    assert!(table.stdout.contains("101 samples of each weight\n"), "{table:?}");
    assert_eq!(swept(&["--range=0,0.5", "--intervals=3"]).code, Some(0));
    for count in ["0", "1", "1048577", "9999999999", "many"] {
        let refused = swept(&[&format!("--intervals={count}")]);
        assert!(refused.code == Some(2) && refused.stderr.contains("--intervals"), "{refused:?}");
    }
    assert_eq!(swept(&["--intervals", "--pose", "poses"]).code, Some(2));
}

/// Two strips that each come half of the way.
#[test]
fn a_report_marks_the_intervals() {
    let directory = strips();
    let folder = directory.path();
    let swept =
        |more: &[&str]| sscc(folder, &[&["sweep", MODEL, "--certificates", CERTIFICATES][..], more].concat());
    let run = swept(&["--range=-2,3", "--intervals=6", "--report", "out.html", "--q=0.5,0.25", "--json"]);
    assert_eq!((run.code, run.stderr.as_str()), (Some(1), ""), "{run:?}");
    let html = fs::read_to_string(folder.join("out.html")).unwrap();
    let scene = &page_data(&html)["scene"];
    let described = &scene["models"][0];
    assert_eq!(described["intervals"], json!(run.json()));
    assert_eq!(
        (&described["ranges"], &described["default_q"]),
        (&json!([[-2.0, 3.0], [-2.0, 3.0]]), &json!([0.5, 0.25]))
    );
    // A curve for each weight that collides.
    let plots = scene["plots"].as_array().unwrap();
    assert_eq!(plots.len(), run.json().iter().filter(|row| row["intervals"] != json!([])).count());
    assert_eq!(plots[0]["series"][0]["x"].as_array().unwrap().len(), 6);
    assert!(swept(&["--report", "out.html"]).refusal().contains("--intervals"));
    assert!(swept(&["--intervals", "--report", "out.txt"]).refusal().contains("must end in .html"));
    let own = swept(&["--intervals", "--report", MODEL]);
    assert!(own.refusal().contains("must end in .html"), "{own:?}");
}

#[test]
fn combinations_collide_where_one_weight_does_not() {
    let directory = strips();
    let folder = directory.path();
    let swept = |range: &str, more: &[&str]| {
        sscc(folder, &[&["sweep", MODEL, range, "--combinations"][..], more].concat())
    };
    let check = |q: &str| {
        let run = sscc(folder, &["check", MODEL, "--certificates", CERTIFICATES, q, "--json"]);
        run.json()[0]["pairs"].as_array().unwrap().clone()
    };
    for range in ["--range=0,0.9", "--range=0,1", "--range=0,2"] {
        let high = &range["--range=0,".len()..];
        let known = [check(&format!("--q={high},0")), check(&format!("--q=0,{high}"))].concat();
        let both = check(&format!("--q={high},{high}"));
        let new = both.iter().filter(|pair| !known.contains(pair)).count();
        let run = swept(range, &["--json"]);
        let rows = run.json();
        assert_eq!((run.code, rows.len()), (Some(i32::from(new > 0)), usize::from(new > 0)), "{run:?}");
        for row in rows {
            assert_eq!(keys(&row), sorted("names, to, count, new, depth"));
            assert_eq!((&row["count"], &row["new"]), (&both.len().into(), &new.into()), "{row}");
            assert_eq!(row["names"], json!(["0", "1"]));
        }
        let table = swept(range, &[]);
        let end = "1 combination of two modes: ";
        assert!(table.stdout.contains(end), "{table:?}");
    }
}

#[test]
fn weights_have_names() {
    let directory = strips();
    let folder = directory.path();
    fs::create_dir(folder.join("targets")).unwrap();
    let mesh = fs::read_to_string(folder.join("mesh.obj")).unwrap();
    fs::write(folder.join("targets/lower.obj"), mesh.replace(" 1\nv", " -0.5\nv")).unwrap();
    let at = |q: &str, command: &str| -> Run {
        sscc(folder, &[command, "mesh.obj", "--modes", "targets", q, "--json"])
    };
    assert_eq!(at("--q=lower=0.25", "check").code, Some(0));
    let run = at("--q=lower=0.25", "sweep");
    assert_eq!(
        (&run.json()[0]["name"], run.json()[0]["to"].as_f64()),
        (&"lower".into(), Some(1.0)),
        "{run:?}"
    );
    for command in ["check", "sweep"] {
        let refused = at("--q=lwoer=1", command);
        let expected =
            "error: --q: there is no mode 'lwoer': the nearest name is 'lower'; sscc info lists all";
        assert_eq!(refused.refusal(), expected);
    }
    for (range, named) in [("1,0", "the range is empty"), ("0,nan", "must be finite"), ("1", "two numbers")] {
        let args = ["sweep", MODEL, &format!("--range={range}")];
        assert!(sscc(folder, &args).refusal().contains(named));
    }
}

/// Poses in the folder of the targets would be modes of the next run.
#[test]
fn target_meshes_are_not_replaced_or_added() {
    let directory = strips();
    let folder = directory.path();
    fs::create_dir(folder.join("targets")).unwrap();
    let mesh = fs::read_to_string(folder.join("mesh.obj")).unwrap();
    fs::write(folder.join("targets/lower.obj"), mesh.replace(" 1\nv", " -0.5\nv")).unwrap();
    let model = ["mesh.obj", "--modes", "targets"];
    let refused = |command: &str, args: &[&str]| {
        let run = sscc(folder, &[&[command], &model[..], args].concat());
        run.refusal().to_owned()
    };
    let before = (files(&folder.join("targets")), fs::read(folder.join("targets/lower.obj")).unwrap());
    for poses in ["targets", "targets/", "./targets/../targets"] {
        let message = refused("sweep", &["--pose", poses]);
        let cause = "the poses would be target meshes of --modes; choose another folder";
        assert_eq!(message, format!("error: {poses}: {cause}"));
    }
    for (pose, cause) in [
        ("targets/lower.obj", "the output is an input; choose another name"),
        ("targets/new.ply", "the output would be a mesh of the input folder targets; choose another folder"),
    ] {
        for output in ["--pose", "--curves"] {
            assert_eq!(refused("check", &["--q=0.5", output, pose]), format!("error: {pose}: {cause}"));
        }
    }
    assert_eq!(before.0, files(&folder.join("targets")));
    assert_eq!(before.1, fs::read(folder.join("targets/lower.obj")).unwrap());
    // Folders in the folder of the targets are not searched for targets.
    let run = sscc(folder, &[&["sweep"], &model[..], &["--pose", "targets/poses"]].concat());
    assert_eq!((run.code, files(&folder.join("targets/poses")).len()), (Some(1), 1), "{run:?}");
}

/// Principal components have standard deviations: those of `sscc modes --kind pca`, and of archives with variances.
#[test]
fn principal_components_go_to_three_standard_deviations() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let frame =
        |z: f64| format!("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 {z}\nv 1 0 {z}\nv 0 1 {z}\nf 1 2 3\nf 4 5 6\n");
    fs::create_dir(folder.join("frames")).unwrap();
    for (number, z) in [1.9, 2.0, 2.1, 2.2, 1.8].into_iter().enumerate() {
        fs::write(folder.join(format!("frames/{number}.obj")), frame(z)).unwrap();
    }
    let made = sscc(
        folder,
        &["modes", "frames", "-o", "p.model.safetensors", "--kind", "pca", "--rank=1", "--json"],
    );
    let deviation = made.json()[0]["deviations"][0].as_f64().unwrap();
    let ends = |args: &[&str]| -> Vec<f64> {
        let run = sscc(folder, &[&["sweep"], args, &["--json"]].concat());
        assert_eq!(run.code, Some(0), "{run:?}");
        run.json().iter().map(|row| row["to"].as_f64().unwrap()).collect()
    };
    assert_eq!(ends(&["p.model.safetensors"]), [3.0, -3.0]);
    let info = sscc(folder, &["info", "p.model.safetensors", "--json"]).json().remove(0);
    assert_eq!(info["deviations"], json!([1.0]));
    let info = sscc(folder, &["info", "p.model.safetensors"]).stdout;
    assert!(info.contains("\ndeviations     1.000 (standard deviations of q)\n"), "{info}");
    // The same component of unit length.
    let mean: Vec<f64> = sscc_io::read_model(&folder.join("p.model.safetensors"))
        .unwrap()
        .0
        .positions(&[0.0])
        .unwrap()
        .iter()
        .flat_map(|p| p.to_array())
        .collect();
    let unit = 1.0 / 3.0_f64.sqrt();
    let component: Vec<f64> = (0..18).map(|i| if i > 8 && i % 3 == 2 { unit } else { 0.0 }).collect();
    let array = |name: &'static str, shape: &[usize], values: &[f64]| (name, shape.to_vec(), values.to_vec());
    let arrays = [
        array("mean", &[6, 3], &mean),
        array("components", &[1, 18], &component),
        array("explained_variance", &[1], &[deviation * deviation]),
    ];
    let npz = |names: &[&str]| {
        let named: Vec<sscc_io::NamedArray<'_>> = arrays
            .iter()
            .filter(|(name, ..)| names.contains(name))
            .map(|(name, shape, values)| sscc_io::NamedArray { name, shape: shape.clone(), values })
            .collect();
        sscc_io::write_npz(&folder.join("p.npz"), &named).unwrap();
    };
    fs::write(folder.join("mean.obj"), frame(2.0)).unwrap();
    npz(&["mean", "components", "explained_variance"]);
    let found = ends(&["mean.obj", "--modes", "p.npz"]);
    assert!((found[0] - 3.0 * deviation).abs() < 1e-12 && found[1] == -found[0], "{found:?}");
    npz(&["mean", "components"]);
    let half_diagonal = ends(&["mean.obj", "--modes", "p.npz"])[0];
    assert!((half_diagonal * unit - 6.0_f64.sqrt() / 2.0).abs() < 1e-12, "{half_diagonal}");

    let text =
        |args: &[&str]| sscc(folder, &[&["sweep"], args].concat()).stdout.lines().next().unwrap().to_owned();
    assert_eq!(text(&["p.model.safetensors"]), "each weight from -3 to 3 standard deviations, the unit of q");
    assert_eq!(text(&["p.model.safetensors", "--range=-1,0.5"]), "each weight from -1 to 0.5, in units of q");
    assert!(
        text(&["mean.obj", "--modes", "p.npz"])
            .ends_with("half the diagonal of the AABB, listed in units of q")
    );
}

/// One line states that the start collides, for any number of modes.
#[test]
fn a_start_that_collides_is_reported_in_one_line() {
    let directory = strips();
    let folder = directory.path();
    let run = sscc(folder, &["sweep", MODEL, "--certificates", CERTIFICATES, "--q=1,0", "--range=-2,2"]);
    let lines: Vec<&str> = run.stdout.lines().collect();
    assert_eq!((run.code, run.stderr.as_str(), lines.len()), (Some(1), "", 5), "{run:?}");
    assert_eq!(lines[0], "each weight from -2 to 2, in units of q");
    assert!(lines[2].starts_with("all ") && lines[2].contains("COLLIDING at the start  "), "{run:?}");
    assert!(lines[3].ends_with(" (--q, certificates with --ignore-rest)"), "{run:?}");
    assert!(lines[4].starts_with("4 sweeps: 0 free, 4 not; "), "{run:?}");
}
