//! `sscc bench`: the keys of its JSON, that all methods agree, its cache, what it refuses.

#![allow(clippy::unwrap_used)]

mod common;

use std::fs;
use std::path::Path;

use common::{Run, command, files, keys, sorted};
use serde_json::{Value, json};

const KEYS: &str = "scenario, model, source, triangles, rank, objects, steps, colliding_steps, root_failed_steps, \
    compared_steps, compared_root_failed_steps, continuous_steps, scene_steps, scene_colliding_steps, scene_body_steps, \
    scene_colliding_body_steps, mismatches, certify_seconds, certify_threads, certify_peak_bytes, parry_query_seconds, \
    simulation_seconds, self_collision_share, discrete_ms, continuous_ms, machine";
const COLUMNS: &str = "traditional, bdtree, normal_cones, normal_cones_approx, paper, full, parry";
const CERTIFIED: &str = "paper, full";

/// Without real models, whatever the environment says; the cache is in the folder.
fn bench(folder: &Path, args: &[&str]) -> Run {
    let args = [&["bench", "--cache", "cache"], args].concat();
    let output = command(folder, &args).env_remove("SSCC_MODELS").output().unwrap();
    Run {
        code: output.status.code(),
        stdout: String::from_utf8(output.stdout).unwrap(),
        stderr: String::from_utf8(output.stderr).unwrap(),
    }
}

/// Asserts that a report has all keys, with values that can be.
fn check(report: &Value, more: &str) {
    let optional = ["discrete_ms_root_failed"];
    let found: Vec<&str> = keys(report).into_iter().filter(|key| !optional.contains(key)).collect();
    assert_eq!(found, sorted(&format!("{KEYS}, {more}")));
    let whole = |key: &str| report[key].as_u64().unwrap_or_else(|| panic!("{key}: {report}"));
    assert_eq!(whole("mismatches"), 0);
    assert!(
        whole("triangles") > 0 && whole("rank") > 0 && whole("objects") > 0 && whole("certify_threads") > 0
    );
    for (some, all) in [
        ("colliding_steps", "steps"),
        ("root_failed_steps", "steps"),
        ("compared_steps", "steps"),
        ("continuous_steps", "compared_steps"),
        ("compared_root_failed_steps", "compared_steps"),
        ("steps", "scene_steps"),
        ("colliding_steps", "root_failed_steps"),
        ("scene_colliding_steps", "scene_steps"),
        ("scene_colliding_body_steps", "scene_body_steps"),
    ] {
        assert!(whole(some) <= whole(all), "{some}: {report}");
    }
    assert_eq!(whole("scene_body_steps"), whole("scene_steps") * whole("objects"));
    let positive = |value: &Value| value.as_f64().is_some_and(|x| x > 0.0);
    assert!(positive(&report["certify_seconds"]) && positive(&report["parry_query_seconds"]), "{report}");
    for key in ["discrete_ms", "continuous_ms", "discrete_ms_root_failed"] {
        let Some(times) = report.get(key) else { continue };
        assert_eq!(keys(times), sorted(COLUMNS), "{key}");
        assert!(times.as_object().unwrap().values().all(positive), "{report}");
    }
    assert_eq!(report.get("discrete_ms_root_failed").is_some(), whole("compared_root_failed_steps") > 0);
    assert!(report["machine"].as_str().is_some_and(|machine| machine.contains(" cores")));
}

#[test]
fn amplitudes_and_the_cache() {
    let folder = tempfile::tempdir().unwrap();
    let cache = folder.path().join("cache");
    let args = ["amplitudes", "--only", "spring", "--samples", "2"];
    let run = || bench(folder.path(), &[&args[..], &["--json"]].concat());
    let first = run();
    assert_eq!((first.code, first.stderr.as_str()), (Some(0), ""));
    let reports = first.json();
    reports.iter().for_each(|report| check(report, "share"));
    let of = |key: &str| -> Vec<Value> { reports.iter().map(|report| report[key].clone()).collect() };
    assert_eq!(of("share"), [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 40.0].map(|share| json!(share)));
    assert_eq!(of("scenario"), vec![json!("amplitudes/spring"); 7]);
    assert_eq!(of("triangles"), vec![json!(16_000); 7]);
    assert_eq!((&reports[0]["colliding_steps"], &reports[6]["colliding_steps"]), (&json!(0), &json!(2)));

    // The same model and certificates again, and what one changed byte brings.
    let made = files(&cache);
    let contents = |paths: &[std::path::PathBuf]| -> Vec<Vec<u8>> {
        paths.iter().map(|path| fs::read(path).unwrap()).collect()
    };
    let before = contents(&made);
    let again = run();
    assert_eq!((again.code, again.stderr.as_str()), (Some(0), ""));
    assert_eq!((files(&cache), contents(&made)), (made.clone(), before.clone()), "nothing is made twice");
    assert_eq!(again.json()[0]["certify_seconds"], reports[0]["certify_seconds"]);
    for (path, bytes) in made.iter().zip(&before) {
        let mut damaged = bytes.clone();
        let middle = damaged.len() / 2;
        damaged[middle] ^= 1 << 7;
        fs::write(path, damaged).unwrap();
    }
    let again = run();
    let notes: Vec<&str> = again.stderr.lines().collect();
    assert!(again.code == Some(0) && notes.len() == 3, "{again:?}");
    assert!(notes.iter().all(|note| note.starts_with("note: made anew: ")), "{notes:?}");
    assert_eq!(files(&cache), made);
    for (path, bytes) in made.iter().zip(&before).filter(|(path, _)| !path.ends_with("json")) {
        let is_time = path.extension().is_some_and(|ending| ending == "json");
        assert!(is_time || fs::read(path).unwrap() == *bytes, "{}", path.display());
    }

    let text = bench(folder.path(), &args);
    assert_eq!(text.code, Some(0));
    for part in
        [" cores", "amplitudes/spring: one body of 16,000 triangles", "parry/full", "traditional/full"]
    {
        assert!(text.stdout.contains(part), "{}", text.stdout);
    }
    assert!(text.stdout.trim_end().ends_with("all exact methods list the same pairs"), "{}", text.stdout);
}

#[test]
fn scenes() {
    let folder = tempfile::tempdir().unwrap();
    let run = |steps: &str| bench(folder.path(), &["spring", "--steps", steps, "--json"]).json().remove(0);
    let few = run("3");
    check(&few, "");
    assert_eq!((&few["scenario"], &few["steps"], &few["objects"]), (&json!("spring"), &json!(3), &json!(1)));
    let (steps, colliding) = (few["scene_steps"].as_u64().unwrap(), &few["scene_colliding_steps"]);
    assert!(steps > 100 && colliding.as_u64().unwrap() > 0, "scenes really collide: {few}");
    // Beyond 64, the others answer 20 of them.
    let many = run("65");
    check(&many, "discrete_ms_all_steps");
    assert_eq!((&many["compared_steps"], &many["scene_colliding_steps"]), (&json!(20), colliding));
    assert_eq!(keys(&many["discrete_ms_all_steps"]), sorted(CERTIFIED));
}

#[test]
fn growth() {
    let folder = tempfile::tempdir().unwrap();
    let args = ["growth", "--only", "spring-4k", "--samples", "2"];
    let run = bench(folder.path(), &[&args[..], &["--json"]].concat());
    assert_eq!(run.code, Some(0), "{run:?}");
    let [report] = &run.json()[..] else { panic!("{run:?}") };
    assert_eq!(keys(report), sorted("scenario, mismatches, sizes, exponents, machine"));
    let size = &report["sizes"][0];
    assert_eq!((&size["triangles"], &size["scenario"]), (&json!(4000), &json!("growth/spring-4k")));
    assert!(size.get("continuous_ms").is_none() && size["discrete_ms"]["full"].as_f64() > Some(0.0));
    assert_eq!(keys(&report["exponents"]), sorted("certify_seconds, certify_peak_bytes, discrete_ms"));
    assert_eq!(keys(&report["exponents"]["discrete_ms"]), sorted(COLUMNS));
    assert!(bench(folder.path(), &args).stdout.contains("seconds to certify"));
}

#[test]
fn refusals() {
    let folder = tempfile::tempdir().unwrap();
    let list = bench(folder.path(), &["--list"]);
    assert_eq!(list.code, Some(0));
    for name in
        ["spring", "bunny16", "bunny128", "dragon-nonlinear", "dragon-polynomial", "amplitudes", "growth"]
    {
        assert!(list.stdout.lines().any(|line| line.starts_with(name)), "{name}");
    }
    assert_eq!(files(folder.path()), [] as [&Path; 0], "a list leaves nothing behind");
    for (args, named) in [
        (&["amplitude"][..], "there is no scenario 'amplitude'; did you mean 'amplitudes'?"),
        (&["bunny12"], "did you mean 'bunny1"),
        (
            &["amplitudes", "--only", "horse"],
            "--only horse: there is no such model; there are bunny, dragon, spring",
        ),
        (&["spring", "--models", "nowhere"], "nowhere: no folder of models"),
        (&["amplitudes", "--only", "bunny", "--models", "."], "bunny_14964_closed.obj: not found"),
        (&["spring", "--steps", "0"], "--steps"),
        (&["spring", "--only", "spring"], "--only is for amplitudes and growth"),
        (&["spring", "--samples", "2"], "--samples is for amplitudes and growth"),
        (&["growth", "--steps", "2"], "--steps is for scenes"),
        (&[], "SCENARIO"),
    ] {
        let run = bench(folder.path(), args);
        assert!(run.refusal().contains(named), "{args:?}: {run:?}");
    }
}
