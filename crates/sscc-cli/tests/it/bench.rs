//! `sscc bench`: keys of the JSON, equality of all methods, cache, refusals.

use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::common::{Run, command, files, keys, sorted};

const KEYS: &str = "scenario, model, source, triangles, rank, objects, steps, colliding_steps, root_failed_steps, \
    compared_steps, compared_root_failed_steps, continuous_steps, scene_steps, scene_colliding_steps, scene_body_steps, \
    scene_colliding_body_steps, mismatches, share, certify_seconds, certify_threads, certify_peak_bytes, parry_query_seconds, \
    simulation_seconds, self_collision_share, discrete_ms, continuous_ms, machine";
const COLUMNS: &str = "traditional, bdtree, normal_cones, normal_cones_approx, paper, full, parry";
const CERTIFIED: &str = "paper, full, kinetic";
const PARTS: &str = "self, inter_object, ground, penalty, dynamics, sound";

/// Runs a bench without real models, whatever `SSCC_MODELS` is. The cache is in the folder.
fn bench(folder: &Path, args: &[&str]) -> Run {
    let args = [&["bench", "--cache", "cache"], args].concat();
    Run::of(command(folder, &args).env_remove("SSCC_MODELS"))
}

/// Asserts that a record has all keys, with plausible values.
fn check(report: &Value, more: &str) {
    let parts = ["free_ms", "free_ms_median", "colliding_ms", "colliding_ms_median"];
    let optional = [&parts[..], &["discrete_ms_root_failed"]].concat();
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
    // Scenes have steps, which kinetic queries follow.
    let is_scene = report["simulation_seconds"].is_number();
    for key in ["discrete_ms", "continuous_ms", "discrete_ms_root_failed"] {
        let Some(times) = report.get(key) else { continue };
        let kinetic = if is_scene && key != "continuous_ms" { ", kinetic" } else { "" };
        assert_eq!(keys(times), sorted(&format!("{COLUMNS}{kinetic}")), "{key}");
        assert!(times.as_object().unwrap().values().all(positive), "{report}");
    }
    // Certified methods ran on all steps, so they have times for each kind of state that occurs.
    let colliding = whole("colliding_steps");
    let counts = [whole("steps") - colliding, whole("steps") - colliding, colliding, colliding];
    for (key, count) in parts.iter().zip(counts) {
        assert_eq!(report.get(key).is_some(), count > 0, "{key}: {report}");
        assert!(count == 0 || positive(&report[key]["full"]), "{key}: {report}");
    }
    assert_eq!(report.get("discrete_ms_root_failed").is_some(), whole("compared_root_failed_steps") > 0);
    assert!(report["machine"].as_str().is_some_and(|machine| machine.contains(" cores")));
}

/// Checks the scenario `kinetic`, with the model in the cache of this folder.
fn check_kinetic(folder: &Path) {
    let run = bench(folder, &["kinetic", "--quick", "--steps", "40", "--json"]);
    assert_eq!(run.code, Some(0), "{run:?}");
    let reports = run.json();
    assert_eq!(reports.len(), 4);
    for report in &reports {
        let known = "scenario, source, note, frequency, share, triangles, rank, step, steps, colliding_steps, \
            compared_steps, mismatches, kinetic_us_colliding, microseconds, machine";
        assert_eq!(keys(report), sorted(known));
        assert_eq!((&report["steps"], &report["mismatches"]), (&json!(40), &json!(0)));
        assert!(report["colliding_steps"].as_u64().unwrap() < 40 && report["step"].as_f64().unwrap() > 0.0);
        let times = &report["microseconds"];
        assert_eq!(keys(times), sorted("kinetic, full, traditional, bdtree, normal_cones, parry"));
        assert!(times.as_object().unwrap().values().all(|time| time.as_f64().unwrap() > 0.0), "{report}");
    }
    let frequency = |i: usize| reports[i]["frequency"].as_f64().unwrap();
    assert!(frequency(0) < 2.0);
    assert_eq!([1, 2, 3].map(frequency), [2.0, 20.0, 200.0]);
    assert!(reports.iter().any(|report| report["colliding_steps"] != json!(0)));
    let run = bench(folder, &["kinetic", "--quick", "--steps", "5"]);
    for part in [
        "kinetic: 4,000 triangles, 20 modes",
        "first mode 20.000 Hz: 5 steps of ",
        "parry  ",
        "note: --quick",
    ] {
        assert!(run.stdout.contains(part), "{}", run.stdout);
    }
}

/// Amplitudes, growth, kinetic and a scene, in one test so that they share a cache.
#[test]
fn records_have_all_keys_and_models_come_from_the_cache() {
    let folder = tempfile::tempdir().unwrap();
    let cache = folder.path().join("cache");

    let amplitudes = ["amplitudes", "--only", "spring", "--quick", "--samples", "1"];
    let run = bench(folder.path(), &[&amplitudes[..], &["--json"]].concat());
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    let reports = run.json();
    reports.iter().for_each(|report| check(report, "note"));
    let of = |key: &str| -> Vec<Value> { reports.iter().map(|report| report[key].clone()).collect() };
    assert_eq!(of("share"), [0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 40.0].map(|share| json!(share)));
    assert_eq!(of("scenario"), vec![json!("amplitudes/spring"); 7]);
    assert_eq!((&reports[0]["colliding_steps"], &reports[6]["colliding_steps"]), (&json!(0), &json!(1)));

    // The largest |z| of the three motions is 2, 4 and 8 times the root's radius.
    let mixed = ["mixed", "--only", "spring", "--quick", "--samples", "4", "--json"];
    let run = bench(folder.path(), &mixed);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    let motions = run.json();
    motions.iter().for_each(|report| check(report, "note, times_root"));
    let of = |key: &str| -> Vec<Value> { motions.iter().map(|report| report[key].clone()).collect() };
    assert_eq!(of("times_root"), [2.0, 4.0, 8.0].map(|times| json!(times)));
    let share = |report: &Value| report["share"].as_f64().unwrap();
    assert!((share(&motions[2]) / share(&motions[1]) - 2.0).abs() < 1e-9, "{motions:?}");

    // The picture has a plot of times, and one of the kinds of proof.
    let norms = ["norms", "--only", "spring", "--quick", "--samples", "2", "--json", "--plot", "norms.svg"];
    let run = bench(folder.path(), &norms);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    let norms = run.json();
    assert!(norms.iter().all(|report| report["mismatches"] == json!(0)), "{norms:?}");
    assert_eq!((norms.len(), &norms[0]["times_root"]), (13, &json!(0.5)));
    assert_eq!(norms[0]["proven_shares"], json!({ "radius": 1.0, "local": 0.0, "search": 0.0 }));
    let plot = fs::read_to_string(folder.path().join("norms.svg")).unwrap();
    assert_eq!((plot.matches("<title>").count(), plot.matches(">% of the triangles<").count()), (2, 1));

    // Growth takes the same model from the cache.
    let made = files(&cache);
    assert_eq!(made.len(), 5, "a model, two sets of certificates with their times: {made:?}");
    let model = made.iter().find(|path| path.to_string_lossy().ends_with(".model.safetensors")).unwrap();
    let written = || fs::metadata(model).unwrap().modified().unwrap();
    let before = written();
    let growth = ["growth", "--only", "spring-4k", "--samples", "2", "--json", "--plot", "growth.svg"];
    let run = bench(folder.path(), &growth);
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    // Each line of the plot has one point.
    let plot = fs::read_to_string(folder.path().join("growth.svg")).unwrap();
    assert_eq!((plot.matches("<circle").count(), plot.matches("certified (ms)").count()), (4, 1));
    assert_eq!((files(&cache), written()), (made.clone(), before));
    let [report] = &run.json()[..] else { panic!("{run:?}") };
    assert_eq!(keys(report), sorted("scenario, mismatches, sizes, exponents, machine"));
    let size = &report["sizes"][0];
    assert_eq!(size["certify_seconds"], reports[0]["certify_seconds"]);
    assert_eq!((&size["triangles"], &size["scenario"]), (&json!(4000), &json!("growth/spring-4k")));
    assert!(size.get("continuous_ms").is_none() && size["discrete_ms"]["full"].as_f64() > Some(0.0));
    assert_eq!(keys(&report["exponents"]), sorted("certify_seconds, certify_peak_bytes, discrete_ms"));
    assert_eq!(keys(&report["exponents"]["discrete_ms"]), sorted(COLUMNS));

    // The scenario kinetic also takes the model from the cache.
    check_kinetic(folder.path());
    assert_eq!((files(&cache), written()), (made.clone(), before));

    // A file with a changed byte is made anew.
    let contents: Vec<Vec<u8>> = made.iter().map(|path| fs::read(path).unwrap()).collect();
    for (path, bytes) in made.iter().zip(&contents) {
        let mut damaged = bytes.clone();
        damaged[bytes.len() / 2] ^= 1 << 7;
        fs::write(path, damaged).unwrap();
    }
    let run = bench(folder.path(), &amplitudes);
    let notes: Vec<&str> = run.stderr.lines().collect();
    assert!(run.code == Some(0) && notes.len() == 3, "{run:?}");
    assert!(notes.iter().all(|note| note.starts_with("note: made anew: ")), "{notes:?}");
    assert_eq!(files(&cache), made);
    for (path, bytes) in made.iter().zip(&contents) {
        let is_time = path.extension().is_some_and(|ending| ending == "json");
        assert!(is_time || fs::read(path).unwrap() == *bytes, "{}", path.display());
    }
    for part in
        ["measured on: ", "amplitudes/spring: one body of 4,000 triangles", "parry/full", "traditional/full"]
    {
        assert!(run.stdout.contains(part), "{}", run.stdout);
    }
    assert!(run.stdout.contains("\nall exact methods list the same pairs\n"), "{}", run.stdout);

    // Beyond 64 steps, the slow methods answer 20 of them.
    let page = folder.path().join("spring.html");
    let report = ["--report", page.to_str().unwrap()];
    let run = bench(
        folder.path(),
        &[&["spring-gentle", "--quick", "--steps", "65", "--json"][..], &report].concat(),
    );
    assert_eq!(run.code, Some(0), "{run:?}");
    let page = fs::read_to_string(page).unwrap();
    for part in
        ["Cost over time: spring-gentle", r#"{"name":"traditional","x":["#, r#"{"name":"kinetic","x":["#]
    {
        assert!(page.contains(part), "{part}");
    }
    let scene = &run.json()[0];
    check(scene, "note, discrete_ms_all_steps, simulation_speedup, simulation_ms");
    assert_eq!((&scene["scenario"], &scene["steps"]), (&json!("spring-gentle"), &json!(65)));
    assert_eq!((&scene["compared_steps"], &scene["continuous_steps"]), (&json!(20), &json!(20)));
    assert!(scene["scene_steps"].as_u64().unwrap() > 100);
    // The root certifies a third of the compared steps, although the scene has few such steps.
    let steps = |key: &str| scene[key].as_u64().unwrap();
    let certified = steps("steps") - steps("root_failed_steps");
    let compared = steps("compared_steps") - steps("compared_root_failed_steps");
    assert!(certified > 0 && (certified.min(6)..=7).contains(&compared), "{scene}");
    assert!(steps("colliding_steps") > 0, "{scene}");
    assert!(scene["scene_colliding_steps"].as_u64().unwrap() > 0, "scenes really collide: {scene}");
    assert_eq!(keys(&scene["discrete_ms_all_steps"]), sorted(CERTIFIED));
    assert_eq!(keys(&scene["simulation_ms"]), sorted(PARTS));
    let part = |key: &str| scene["simulation_ms"][key].as_f64().unwrap();
    let all = scene["simulation_seconds"].as_f64().unwrap();
    let sum: f64 = ["self", "inter_object", "ground", "penalty", "dynamics", "sound"].map(part).iter().sum();
    assert!((sum * scene["scene_steps"].as_f64().unwrap() / 1e3 / all - 1.0).abs() < 1e-9);
    assert!((scene["self_collision_share"].as_f64().unwrap() - part("self") / sum).abs() < 1e-9);
    assert!(scene["simulation_speedup"].as_f64().unwrap() > 1.0);

    // The simulation is taken from the cache.
    let run = bench(folder.path(), &["spring-gentle", "--quick", "--steps", "10", "--plot", "costs.svg"]);
    assert_eq!(run.code, Some(0), "{run:?}");
    let svg = fs::read_to_string(folder.path().join("costs.svg")).unwrap();
    assert!(svg.contains("Cost over time: spring-gentle") && svg.matches("<polyline").count() == 3, "{svg}");
    let seconds = format!("simulated in {all:.2} s of processor time, ");
    for part in [&seconds[..], "means are of the whole scene: "] {
        assert!(run.stdout.contains(part), "{part}: {}", run.stdout);
    }

    // The table has the paper's rows beside ours.
    let run = bench(folder.path(), &["table3", "--quick", "--steps", "10"]);
    assert_eq!(run.code, Some(0), "{run:?}");
    for part in [
        "means are of the whole scene: ",
        "Table 3, ours and the paper's (spring",
        "    the paper",
        "<0.01",
        "    not the shape of spring: embedded spring, 4,000 triangles",
    ] {
        assert!(run.stdout.contains(part), "{part}: {}", run.stdout);
    }
}

/// The diagrams of the paper, with a small spring in place of its shapes.
#[test]
fn figures_are_drawn() {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    let figure = |name: &str| {
        let plot = format!("{name}.svg");
        let run = bench(folder, &[name, "--quick", "--json", "--plot", &plot]);
        assert_eq!(run.code, Some(0), "{run:?}");
        (run.json().remove(0), fs::read_to_string(folder.join(plot)).unwrap())
    };
    let rows = |record: &Value| record["rows"].as_array().unwrap().clone();
    let column = |record: &Value, key: &str| -> Vec<f64> {
        rows(record).iter().map(|row| row[key].as_f64().unwrap()).collect()
    };
    let text = bench(folder, &["figure11", "--quick"]).stdout;
    assert!(
        text.contains("note: --quick: a spring of 4,000 triangles") && text.contains("percent"),
        "{text}"
    );
    let (levels, svg) = figure("figure7");
    assert_eq!(keys(&levels), sorted("scenario, source, note, rows"));
    assert_eq!(column(&levels, "level")[..3], [0.0, 1.0, 2.0]);
    let medians = column(&levels, "median");
    assert!(medians.len() > 3 && medians.last() > medians.first(), "{medians:?}");
    assert!(svg.starts_with("<svg") && svg.matches("<polyline").count() == 2);

    let (metrics, svg) = figure("figure9");
    assert_eq!(column(&metrics, "modes"), [5.0, 10.0, 20.0]);
    let [energy, displacement] = ["energy_mm", "displacement_mm"].map(|key| column(&metrics, key));
    assert!(energy.iter().zip(&displacement).all(|(e, d)| *e > 0.0 && *d > 0.0));
    // More modes reduce the proven deformation less under the energy metric, as in the paper.
    assert!(energy[2] / energy[0] > displacement[2] / displacement[0], "{energy:?} {displacement:?}");
    assert_eq!(svg.matches("<polyline").count(), 2);

    for name in ["figure11", "figure14"] {
        let (record, svg) = figure(name);
        assert_eq!(column(&record, "mode"), [0.0, 1.0, 2.0, 3.0]);
        let count = if name == "figure11" { 1 } else { 2 };
        assert_eq!(svg.matches("data:image/png;base64,").count(), count);
        assert_eq!(record["note"], "--quick: a spring of 4,000 triangles replaces the model");
    }
}

#[test]
fn invalid_requests_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let list = bench(folder.path(), &["--list"]);
    assert_eq!(list.code, Some(0));
    for name in [
        "spring",
        "spring-gentle",
        "bunny128",
        "dragon-nonlinear",
        "dragon-polynomial",
        "table2",
        "amplitudes",
        "mixed",
        "growth",
        "kinetic",
    ] {
        assert!(list.stdout.lines().any(|line| line.starts_with(name)), "{name}");
    }
    let lines = bench(folder.path(), &["--list", "--json"]).json();
    assert_eq!(lines.len(), list.stdout.lines().count());
    for (line, text) in lines.iter().zip(list.stdout.lines()) {
        assert_eq!(keys(line), ["about", "name"]);
        let [name, about] = ["name", "about"].map(|key| line[key].as_str().unwrap());
        assert_eq!(text, format!("{name:<20}{about}"));
    }
    assert_eq!(files(folder.path()), [] as [&Path; 0], "--list leaves no file");
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
        (&["spring", "--only", "spring"], "--only is for amplitudes, mixed, norms and growth"),
        (&["kinetic", "--only", "spring"], "--only is for amplitudes, mixed, norms and growth"),
        (&["spring", "--samples", "2"], "--samples is for amplitudes, mixed, norms and growth"),
        (&["growth", "--steps", "2"], "--steps is for scenes and kinetic"),
        (&["amplitudes", "--plot", "a.svg"], "--plot is for figures, scenes, growth and norms"),
        (&["figure7", "--steps", "2"], "--steps is for scenes and kinetic"),
        (&["figure7", "--only", "bunny"], "--only is for amplitudes"),
        (&["figure7", "--plot", "a.png"], "a.png: the name of the output must end in .svg"),
        (&["growth", "--quick"], "--quick is not for growth"),
        (&["spring", "--list"], "cannot be used with"),
        (&["--list", "--steps", "2"], "cannot be used with"),
        (&["--list", "--samples", "2"], "cannot be used with"),
        (&["--list", "--only", "spring"], "cannot be used with"),
        (&["--list", "--quick"], "cannot be used with"),
        (&["--list", "--plot", "a.svg"], "cannot be used with"),
        (&["--list", "--report", "a.html"], "cannot be used with"),
        (&[], "SCENARIO"),
    ] {
        let run = bench(folder.path(), args);
        assert!(run.refusal().contains(named), "{args:?}: {run:?}");
    }
}
