//! `sscc simulate`: output files, resumed simulations, refusals.

use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::ops::Range;
use std::path::Path;
use std::process::Stdio;
use std::sync::LazyLock;
use std::thread;
use std::time::Duration;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use sscc_io::npy;
use tempfile::TempDir;

use crate::common::{Run, command, files, keys, sorted};

/// A small soft spring above the ground, shaken until it collides with itself; with sound.
const SCENE: &str = r#"
steps_per_second = 8000
duration = 0.1
gravity = [0, 0, -9.81]
detection = "kinetic"
response = "penalty"
[ground]
[contact]
frequency = 500
[models.spring]
shape = "spring-4k"
size = 0.15
kind = "linear"
rank = 10
material = { youngs = 3e6, density = 1000 }
damping = { mass = 1, stiffness = 1e-5 }
[[bodies]]
model = "spring"
position = [0, 0, 0.2]
rotation = { axis = [1, 0, 0], degrees = 90 }
velocity = [0, 0, -2]
shake = [0.2, 0.5]
[sound]
modes = 30
"#;

/// A second body beside the first one.
const PAIR: &str = "\n[[bodies]]\nmodel = \"spring\"\nposition = [0.4, 0, 0.2]\n";

/// The cache with the model, which all tests share.
static CACHE: LazyLock<TempDir> = LazyLock::new(|| {
    let cache = tempfile::tempdir().unwrap();
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    let run = simulate_with(cache.path(), folder.path(), &["scene.toml", "--steps", "1"]);
    assert_eq!(run.code, Some(0), "{run:?}");
    cache
});

fn prepared(cache: &Path, folder: &Path, args: &[&str]) -> std::process::Command {
    let args = [&["simulate", "--cache", cache.to_str().unwrap()], args].concat();
    let mut command = command(folder, &args);
    command.env_remove("SSCC_MODELS");
    command
}

fn simulate_with(cache: &Path, folder: &Path, args: &[&str]) -> Run {
    Run::of(&mut prepared(cache, folder, args))
}

fn simulate(folder: &Path, args: &[&str]) -> Run {
    simulate_with(CACHE.path(), folder, args)
}

/// Returns the data of a report.
fn data(page: &str) -> Value {
    let (_, rest) = page.split_once("id=\"sscc-report\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

/// Returns the bytes of an array of a report.
fn bytes_of(report: &Value, name: &Value) -> Vec<u8> {
    STANDARD.decode(report["arrays"][name.as_str().unwrap()].as_str().unwrap()).unwrap()
}

fn floats(report: &Value, name: &Value) -> Vec<f32> {
    bytes_of(report, name).as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect()
}

/// Creates a folder with a scene of this text.
fn folder(text: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), text).unwrap();
    folder
}

/// Returns the arrays of an archive: shapes and values.
fn arrays(path: &Path) -> BTreeMap<String, (Vec<usize>, Vec<f64>)> {
    let mut archive = zip::ZipArchive::new(fs::File::open(path).unwrap()).unwrap();
    let mut found = BTreeMap::new();
    for index in 0..archive.len() {
        let mut bytes = Vec::new();
        let mut entry = archive.by_index(index).unwrap();
        entry.read_to_end(&mut bytes).unwrap();
        let array = npy::parse(&bytes).unwrap();
        let name = entry.name().unwrap().strip_suffix(".npy").unwrap().to_owned();
        found.insert(name, (array.shape().to_vec(), array.to_c_order()));
    }
    found
}

#[test]
fn a_scene_is_simulated_and_written() {
    let folder = folder(SCENE);
    let run = simulate(folder.path(), &["scene.toml", "--json"]);
    assert_eq!(run.code, Some(0), "{run:?}");
    // The shake adds half of 0.2^2 and half of 0.5^2, in joules.
    let note = run
        .stderr
        .strip_prefix("note: body 0 (spring): shake gives 0.1450 J; alone it moves vertices by at most ");
    assert!(note.unwrap().ends_with("% of the longest side)\n"), "{run:?}");
    let [summary] = &run.json()[..] else { panic!("{run:?}") };
    let known = "scene, models, objects, steps, scene_steps, step, simulated_seconds, simulation_seconds, \
        real_time_factor, real_time_factor_processor, colliding_steps, body_steps, colliding_body_steps, last_self_pairs, last_inter_pairs, \
        last_asleep, self_collision_share, energy_first, energy_largest, energy_last, machine";
    assert_eq!(keys(summary), sorted(known));
    let number = |key: &str| summary[key].as_f64().unwrap();
    assert_eq!((number("steps"), number("scene_steps"), number("objects")), (800.0, 800.0, 1.0));
    assert!(number("colliding_steps") > 0.0 && number("colliding_steps") < 800.0, "{summary}");
    assert!(number("energy_largest") < 1.01 * number("energy_first"), "{summary}");
    assert!(number("self_collision_share") > 0.0 && number("self_collision_share") < 1.0);

    let out = folder.path().join("scene");
    let expected = [
        "animation.glb",
        "checkpoint.bin",
        "costs.npz",
        "report.html",
        "sound.wav",
        "sound_float.wav",
        "states.log",
        "summary.json",
        "trajectories.npz",
    ];
    assert_eq!(files(&out), expected.map(|name| out.join(name)));
    let written: Value = serde_json::from_slice(&fs::read(out.join("summary.json")).unwrap()).unwrap();
    assert_eq!(&written, summary);

    let trajectories = arrays(&out.join("trajectories.npz"));
    let shape = |name: &str| trajectories[name].0.clone();
    assert_eq!((shape("q_spring"), shape("positions")), (vec![800, 1, 10], vec![800, 1, 3]));
    assert_eq!((shape("orientations"), shape("time")), (vec![800, 1, 4], vec![800]));
    let pairs = &trajectories["self_pairs"].1;
    assert_eq!(pairs.iter().filter(|count| **count > 0.0).count() as f64, number("colliding_steps"));
    // The body begins at the scene's position, and falls.
    assert_eq!(trajectories["positions"].1[..3], [0.0, 0.0, 0.2]);
    assert!(trajectories["positions"].1[3 * 100 + 2] < 0.2);
    let costs = arrays(&out.join("costs.npz"));
    assert_eq!(costs["self_seconds"].0, [800]);
    assert!(costs["traditional_self_seconds"].1.iter().all(|seconds| *seconds > 0.0));
    // The body is awake in all of the sampled steps.
    assert_eq!(costs["traditional_awake_seconds"].1, costs["traditional_self_seconds"].1);
    let samples = costs["traditional_time"].1.iter().zip(&costs["sampled_self_seconds"].1);
    for (time, seconds) in samples {
        let step = costs["time"].1.iter().position(|t| t == time).unwrap();
        assert_eq!(costs["self_seconds"].1[step], *seconds);
    }

    // The animation contains the model.
    let model = sscc_io::gltf::read(&out.join("animation.glb"), Some("spring")).unwrap();
    assert_eq!((model.mesh.faces().len(), model.modes.rank()), (4000, 10));
    let bytes = fs::read(out.join("sound.wav")).unwrap();
    assert_eq!((&bytes[..4], bytes.len() > 2 * 800), (&b"RIFF"[..], true));
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    let report = data(&page);
    let scene = &report["scene"];
    assert_eq!(scene["models"][0]["triangles"], 4000);
    assert_eq!(scene["models"][0]["frequencies"].as_array().unwrap().len(), 10);
    let titles: Vec<&str> =
        scene["plots"].as_array().unwrap().iter().map(|plot| plot["title"].as_str().unwrap()).collect();
    assert_eq!(titles, ["Energy", "Sound"]);
    // As many frames as the animation has, from the first state to the last.
    let playback = &scene["playback"];
    let times: Vec<f64> =
        playback["times"].as_array().unwrap().iter().map(|time| time.as_f64().unwrap()).collect();
    assert_eq!(times.len(), sscc_io::gltf::key_frames(800, 1.0 / 8000.0, 60.0).len());
    assert_eq!((times[0], times[times.len() - 1]), (0.0, 799.0 / 8000.0));
    assert_eq!(playback["costs"]["series"].as_array().unwrap().len(), 2);
    // The report contains the motion and its collisions.
    let body = &playback["bodies"][0];
    let q = floats(&report, &body["q"]);
    let states = &trajectories["q_spring"].1;
    assert_eq!(q.len(), 10 * times.len());
    assert!(q[q.len() - 10..].iter().zip(&states[7990..]).all(|(shown, q)| *shown == *q as f32));
    assert_eq!(floats(&report, &body["rigid"]).len(), 7 * times.len());
    let pairs: Vec<u64> =
        body["pairs"].as_array().unwrap().iter().map(|count| count.as_u64().unwrap()).collect();
    // `pairs` is the number of pairs in each frame. `pairs_since` is the largest number of pairs in a step between the
    // frame before and this one.
    let frames = sscc_io::gltf::key_frames(800, 1.0 / 8000.0, 60.0);
    let own = |state: usize| trajectories["self_pairs"].1[state] as u64;
    let max = |states: Range<usize>| states.map(own).max().unwrap_or(0);
    assert_eq!(pairs, frames.iter().map(|frame| own(*frame)).collect::<Vec<_>>());
    let since: Vec<u64> =
        playback["pairs_since"].as_array().unwrap().iter().map(|count| count.as_u64().unwrap()).collect();
    let between = frames.windows(2).map(|pair| max(pair[0] + 1..pair[1]));
    assert_eq!(since, [0].into_iter().chain(between).collect::<Vec<_>>());
    assert!(pairs.iter().zip(&since).any(|(own, since)| *own == 0 && *since > 0), "{pairs:?} {since:?}");
    let offsets = bytes_of(&report, &playback["colliding"]["offsets"]);
    assert_eq!(offsets.len(), 4 * (times.len() + 1));
    assert_eq!(&bytes_of(&report, &playback["sound"])[..4], b"RIFF");

    // The text output. A finished simulation is not run again.
    let run = simulate(folder.path(), &["scene.toml"]);
    for part in
        ["spring: 4,000 triangles, 10 modes (embedded spring)", "scene: one body, 800 steps", "written: "]
    {
        assert!(run.stdout.contains(part), "{run:?}");
    }
    assert_eq!(arrays(&out.join("trajectories.npz")), trajectories);
    assert_eq!(fs::metadata(out.join("states.log")).unwrap().len(), 32 + 800 * 8 * (10 + 8 + 11));
}

#[test]
fn the_motion_is_the_same_for_any_number_of_threads_and_any_detection() {
    let text = format!("{SCENE}{PAIR}");
    let mut found = Vec::new();
    for (threads, detection) in [("1", "kinetic"), ("2", "kinetic"), ("2", "certified"), ("1", "traditional")]
    {
        let text = text.replace("\"kinetic\"", &format!("\"{detection}\""));
        let folder = folder(&text);
        let run = simulate(folder.path(), &["scene.toml", "--steps", "300", "--threads", threads]);
        assert_eq!(run.code, Some(0), "{run:?}");
        found.push(fs::read(folder.path().join("scene/trajectories.npz")).unwrap());
    }
    assert!(found.windows(2).all(|pair| pair[0] == pair[1]));
}

/// The unit of radii is the amplitude of the modes: if all amplitudes are doubled, the radius is halved.
#[test]
fn radii_are_measured_in_amplitudes() {
    let radius = |amplitudes: &str| {
        let folder = folder(&SCENE.replace("rank = 10", &format!("rank = 10{amplitudes}")));
        let run = simulate(folder.path(), &["scene.toml", "--steps", "1", "--json"]);
        assert_eq!(run.code, Some(0), "{run:?}");
        run.json()[0]["models"][0]["root_radius"].as_f64().unwrap()
    };
    let all = |amplitude: f64| format!("\namplitudes = {:?}", [amplitude; 10]);
    let [energy, one, two] = ["", &all(0.125), &all(0.25)].map(radius);
    assert!((one - 2.0 * two).abs() < 1e-9 * one && (one / energy - 1.0).abs() > 0.1, "{energy} {one} {two}");
}

#[test]
fn a_killed_simulation_resumes_to_the_same_bits() {
    let whole = folder(SCENE);
    assert_eq!(simulate(whole.path(), &["scene.toml", "--steps", "600"]).code, Some(0));
    let long = SCENE.replace("duration = 0.1", "duration = 1e3");
    let expected = {
        let whole = folder(&long);
        assert_eq!(simulate(whole.path(), &["scene.toml", "--steps", "700"]).code, Some(0));
        whole
    };
    let killed = folder(&long);
    assert_eq!(simulate(killed.path(), &["scene.toml", "--steps", "150"]).code, Some(0));
    let log = killed.path().join("scene/states.log");
    let checkpointed = fs::metadata(&log).unwrap().len();
    for times in 1..=2 {
        let mut child =
            prepared(CACHE.path(), killed.path(), &["scene.toml"]).stderr(Stdio::null()).spawn().unwrap();
        // The run is killed when the log has states that are later than the checkpoint. By then the run has removed
        // such states of the run before, and has written its own.
        let length = || fs::metadata(&log).unwrap().len();
        let (before, mut was_cut) = (length(), false);
        while !(was_cut && length() >= checkpointed + 1000) {
            was_cut |= times == 1 || length() != before;
            assert!(child.try_wait().unwrap().is_none(), "{times}");
            thread::sleep(Duration::from_millis(5));
        }
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let run = simulate(killed.path(), &["scene.toml", "--steps", "700"]);
    assert_eq!(run.code, Some(0), "{run:?}");
    for name in ["trajectories.npz", "animation.glb", "sound.wav", "sound_float.wav"] {
        let read = |folder: &TempDir| fs::read(folder.path().join("scene").join(name)).unwrap();
        assert!(read(&killed) == read(&expected), "{name}");
    }
    // Fewer steps give the first part of the motion.
    assert_eq!(simulate(killed.path(), &["scene.toml", "--steps", "600"]).code, Some(0));
    let part = |folder: &TempDir| arrays(&folder.path().join("scene/trajectories.npz"))["q_spring"].clone();
    assert_eq!(part(&killed), part(&whole));
}

#[test]
fn a_diverging_motion_is_reported_and_its_states_are_written() {
    // The shake is so fast that even the shortest parts of a step have no solution.
    let text = SCENE
        .replace("kind = \"linear\"\nrank = 10", "kind = \"nonlinear\"\nrank = 4")
        .replace("shake = [0.2, 0.5]", "shake = [1e20]")
        .replace("response = \"penalty\"", "response = \"ignore\"");
    let folder = folder(&text);
    let run = simulate(folder.path(), &["scene.toml"]);
    assert_eq!(run.code, Some(2), "{run:?}");
    // The first line states the effect of the shake.
    let (note, message) = run.stderr.strip_suffix('\n').unwrap().split_once('\n').unwrap();
    assert!(note.starts_with("note: body 0 (spring): shake gives "), "{note}");
    assert!(message.starts_with("error: step "), "{message}");
    for part in [
        "the motion of body 0 (counted from 0) diverges (energy ",
        " J)",
        "the states until then are in scene",
    ] {
        assert!(message.contains(part) && !message.contains('\n'), "{message}");
    }
    let out = folder.path().join("scene");
    assert!(arrays(&out.join("trajectories.npz"))["time"].0[0] > 0, "{message}");
    assert!(fs::read_to_string(out.join("report.html")).unwrap().contains("[\"stopped early\",\"step "));
}

/// If a step fails, all states before it are written. They are those of a run that ends there.
#[test]
fn the_steps_before_a_failure_are_written() {
    // Coordinates are at most 2^200, about 1.6e60. The body leaves this range after 128 steps.
    let text = SCENE
        .replace("velocity = [0, 0, -2]", "velocity = [0, 0, 1e62]")
        .replace("[sound]\nmodes = 30\n", "");
    let folder = folder(&text);
    let run = simulate(folder.path(), &["scene.toml"]);
    assert_eq!(run.code, Some(2), "{run:?}");
    let message = run.stderr.lines().last().unwrap();
    let failed = message.strip_prefix("error: step ").and_then(|rest| rest.split_once(' ')).unwrap().0;
    let failed: usize = failed.parse().unwrap();
    assert!((100..200).contains(&failed), "{message}");
    let (_, cause) = message.split_once("diverges (energy ").unwrap();
    let (_, largest) = cause.split_once("the largest coordinate of the posed shape is 1.6").unwrap();
    let wanted = "e60: it must be finite and at most 2^200 (about 1.6e60); use more steps";
    assert!(largest.split_once(wanted).is_some_and(|(digits, _)| digits.len() < 20), "{message}");
    // The state at the start of each step, the failed one included.
    let states = arrays(&folder.path().join("scene/trajectories.npz"));
    assert_eq!(states["time"].0, [failed + 1]);
    let steps = failed.to_string();
    let short = simulate(folder.path(), &["scene.toml", "--steps", &steps, "--out", "short"]);
    // This run only fails to write the animation, which is in single precision.
    assert!(short.stderr.lines().last().unwrap().starts_with("error: short/animation.glb: "), "{short:?}");
    let before = arrays(&folder.path().join("short/trajectories.npz"));
    for name in ["time", "positions", "orientations", "q_spring"] {
        let (shape, numbers) = &before[name];
        assert_eq!((shape[0], &states[name].1[..numbers.len()]), (failed, &numbers[..]), "{name}");
    }
    // A later run cannot continue from the failed step.
    let again = simulate(folder.path(), &["scene.toml"]);
    assert_eq!((again.code, again.stderr.lines().last()), (Some(2), Some(message)), "{again:?}");
}

#[test]
fn inputs_and_files_of_others_are_refused() {
    let folder = folder(SCENE);
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    fs::create_dir(folder.path().join("d")).unwrap();
    let (start, _) = SCENE.split_once("[models.spring]").unwrap();
    let model = "[models.m]\nfile = \"animation.glb\"\n[[bodies]]\nmodel = \"m\"\n";
    write("d/scene.toml", &format!("{start}{model}"));
    write("d/animation.glb", "a model");
    write("report.html", "a page");
    let before = files(folder.path());
    let restarts: [&[&str]; 2] = [&[], &["--restart"]];
    for restart in restarts {
        let run = simulate(folder.path(), &[&["d/scene.toml", "--out", "d"], restart].concat());
        let cause = "is an input of the scene: choose another folder with --out";
        assert_eq!(run.refusal(), format!("error: d/animation.glb: {cause}"));
        let run = simulate(folder.path(), &[&["scene.toml", "--out", "."], restart].concat());
        let cause = "exists and is not of a simulation: choose another folder with --out, or move it away";
        assert_eq!(run.refusal(), format!("error: ./report.html: {cause}"));
    }
    let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
    assert_eq!([read("d/animation.glb"), read("report.html")], ["a model", "a page"]);
    assert_eq!((files(folder.path()), files(&folder.path().join("d")).len()), (before, 2));
}

#[test]
fn invalid_scenes_and_requests_are_refused() {
    let folder = folder(SCENE);
    let refused = |from: &str, to: &str| {
        assert_eq!(SCENE.matches(from).count(), 1, "{from}");
        fs::write(folder.path().join("bad.toml"), SCENE.replace(from, to)).unwrap();
        let run = simulate(folder.path(), &["bad.toml"]);
        assert!(!folder.path().join("bad/trajectories.npz").exists());
        run.refusal().to_owned()
    };
    for (from, to, named) in [
        ("gravity", "gravty", "bad.toml: line 4: unknown key 'gravty'; did you mean 'gravity'?"),
        ("density = 1000", "density = -1000", "bad.toml: line 15: density: a positive number"),
        ("= 8000", "= -8000", "bad.toml: line 2: steps_per_second: a positive number"),
        ("= 8000", "= 2000", "bad.toml: line 2: steps_per_second: sound needs from 8000"),
        ("shape = \"spring-4k\"", "file = \"none.obj\"", "none.obj: not found"),
        ("[0, 0, 0.2]", "[0, 0, 0]", "begins in the ground"),
        ("[sound]\nmodes = 30", PAIR, "body 1 (counted from 0) begins in body 0"),
        ("youngs = 3e6", "youngs = 1e15", "longer than half a period of its first mode"),
        (
            "[sound]\nmodes = 30",
            "grid = [16, 16, 16]\nspacing = [1, 1, 1]",
            "bodies: all 4096 need about 8192 MB (limit 8000 MB); use fewer bodies, or models of fewer triangles",
        ),
    ] {
        let to = if to == PAIR { to.replace("0.4, 0", "0.01, 0") } else { to.into() };
        let message = refused(from, &to);
        assert!(message.contains(named), "{message}");
    }
    fs::create_dir(folder.path().join("spring")).unwrap();
    for (args, named) in [
        (&["missing.toml"][..], "missing.toml: not found"),
        (&["buny16"], "buny16: not found; did you mean 'bunny16'?"),
        // A folder with the name of a scene is not the scene.
        (&["spring", "--models", "nowhere"], "nowhere: no folder of models"),
        (&["scene.toml", "--steps", "0"], "--steps"),
        (&["scene.toml", "--models", "nowhere"], "nowhere: no folder of models"),
        (&["scene.toml", "--out", "scene.toml"], "scene.toml: cannot write to this folder"),
        (&[], "SCENE"),
    ] {
        let run = simulate(folder.path(), args);
        assert!(run.refusal().contains(named), "{args:?}: {run:?}");
    }
    // A folder of another scene.
    assert_eq!(simulate(folder.path(), &["scene.toml", "--steps", "3", "--out", "a"]).code, Some(0));
    fs::write(folder.path().join("other.toml"), SCENE.replace("-9.81", "-1.62")).unwrap();
    let run = simulate(folder.path(), &["other.toml", "--steps", "3", "--out", "a"]);
    assert!(run.refusal().contains("states.log: this file belongs to another scene"), "{run:?}");
    // --restart removes all files of the other simulation.
    let (mute, _) = SCENE.split_once("[sound]").unwrap();
    fs::write(folder.path().join("other.toml"), mute).unwrap();
    let sound = folder.path().join("a/sound.wav");
    assert!(sound.exists());
    let run = simulate(folder.path(), &["other.toml", "--steps", "3", "--out", "a", "--restart"]);
    assert_eq!((run.code, sound.exists()), (Some(0), false), "{run:?}");
}
