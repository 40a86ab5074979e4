//! `sscc sweep`, and weights by name in `--q`.

use std::fs;

use crate::common::{Run, files, keys, sorted, sscc, strips};

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
