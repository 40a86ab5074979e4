//! `sscc resolve`: a free q near a colliding one.

use std::fs;

use serde_json::json;
use sscc_io::write_npy;

use crate::common::{keys, sorted, sscc, strips};
#[cfg(unix)]
use crate::interrupt::interrupted_after_a_line;

const MODEL: &str = "strips.model.safetensors";
const CERTIFICATES: &str = "strips.sscc.safetensors";

#[test]
fn every_q_of_a_trajectory_is_resolved() {
    let directory = strips();
    let folder = directory.path();
    write_npy(&folder.join("q.npy"), &[3, 2], &[0.5, 0.0, 1.0, 0.0, 1.0, 0.25]).unwrap();
    let given = ["resolve", MODEL, "--certificates", CERTIFICATES, "--trajectory", "q.npy"];
    let run = sscc(folder, &[&given[..], &["--json"]].concat());
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""), "{run:?}");
    let lines = run.json();
    assert_eq!(lines.len(), 3);
    for line in &lines {
        assert_eq!(keys(line), sorted("resolved, q, change, safe_scale_change"));
        assert_eq!(line["resolved"], json!(true));
    }
    assert_eq!((&lines[0]["q"], &lines[0]["change"]), (&json!([0.5, 0.0]), &json!(0.0)));
    for (line, shift) in lines[1..].iter().zip([0.0, 0.25]) {
        let q = [0, 1].map(|k| line["q"][k].as_f64().unwrap());
        assert!((q[0] - 1.0).abs() < 1e-3 && (q[1] - shift).abs() < 1e-3, "{line}");
        assert!(line["change"].as_f64().unwrap() <= line["safe_scale_change"].as_f64().unwrap());
        let check = sscc(folder, &["check", MODEL, &format!("--q={},{}", q[0], q[1])]);
        assert_eq!(check.code, Some(0), "{check:?}");
    }
    let text = sscc(folder, &given).stdout;
    let results: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("row ")).collect();
    let results: Vec<&str> = results.iter().map(|line| line[7..].split("  ").next().unwrap()).collect();
    assert_eq!(results, ["free as it is", "resolved", "resolved"], "{text}");
    // From the other side.
    let run = sscc(folder, &["resolve", MODEL, "--q=1,0", "--from=2,0", "--json"]);
    assert!(run.code == Some(0) && run.json()[0]["q"][0].as_f64().unwrap() > 1.0, "{run:?}");
}

#[test]
#[cfg(unix)]
fn rows_before_an_interrupt_are_printed() {
    const ROWS: usize = 50_000;
    let directory = strips();
    let folder = directory.path();
    let rows: Vec<f64> = (0..ROWS).flat_map(|row| [1.0, 1e-5 * row as f64]).collect();
    write_npy(&folder.join("q.npy"), &[ROWS, 2], &rows).unwrap();
    let args = ["resolve", MODEL, "--certificates", CERTIFICATES, "--trajectory", "q.npy", "--json"];
    let run = interrupted_after_a_line(folder, &args);
    assert_eq!((run.code, run.stderr.as_str()), (Some(130), "error: interrupted\n"));
    let lines = run.json();
    assert!((1..ROWS).contains(&lines.len()), "{}", lines.len());
    for line in lines {
        assert_eq!(
            (keys(&line), &line["resolved"]),
            (sorted("resolved, q, change, safe_scale_change"), &json!(true))
        );
    }
}

#[test]
fn with_all_a_colliding_centre_resolves_nothing() {
    let directory = strips();
    let folder = directory.path();
    let resolve = |args: &[&str]| {
        sscc(folder, &[&["resolve", MODEL, "--center=1,0", "--max-exceptions=44"], args].concat())
    };
    // Without --all, exceptions may collide.
    let run = resolve(&["--q=1,0", "--json"]);
    assert_eq!((run.code, &run.json()[0]["q"]), (Some(0), &json!([1.0, 0.0])), "{run:?}");
    let run = resolve(&["--q=1,0", "--all", "--json"]);
    let nothing = json!({"resolved": false, "q": null, "change": null, "safe_scale_change": null});
    assert_eq!((run.code, run.json()), (Some(1), vec![nothing]), "{run:?}");
    assert!(run.stderr.contains("--from"), "{run:?}");
    let run = resolve(&["--q=1,0", "--all"]);
    assert_eq!((run.code, run.stdout.as_str()), (Some(1), "NOT RESOLVED: the centre collides\n"));
    let run = resolve(&["--q=1,0", "--all", "--from=0,0", "--json"]);
    assert!(run.code == Some(0) && run.json()[0]["q"][0].as_f64().unwrap() < 1.0, "{run:?}");
}

#[test]
fn invalid_requests_are_refused() {
    let directory = strips();
    let folder = directory.path();
    fs::write(folder.join("from.txt"), "0 0 0\n").unwrap();
    let refusal = |args: &[&str]| {
        let run = sscc(folder, &[&["resolve", MODEL, "--certificates", CERTIFICATES], args].concat());
        run.refusal().to_owned()
    };
    assert!(refusal(&[]).contains("--q or --trajectory"));
    assert!(refusal(&["--q=1"]).starts_with("error: --q: q has 1"));
    assert!(refusal(&["--q=1,nan"]).contains("--q"));
    assert!(refusal(&["--q=1e300,0"]).contains("--q"));
    assert!(refusal(&["--q=0,0", "--from=1,0"]).starts_with("error: --from: the start collides"));
    assert!(refusal(&["--q=1,0", "--from", "from.txt"]).starts_with("error: --from from.txt: "));
    assert!(refusal(&["--q=1,0", "--from", "missing"]).contains("--from is not a list of numbers"));
    assert!(refusal(&["--q=1,0", "--center=1,0"]).contains("--center"));
}
