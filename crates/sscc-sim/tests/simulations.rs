//! Tests of simulations in one process: concurrent runs, continuation after cancellation, and errors.

#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Barrier, LazyLock, Mutex};
use std::thread;

use sscc::{CancelToken, Progress};
use sscc_sim::{FinishedRun, Outputs, Request, SimError, simulate};
use sscc_tasks::{Stage, TaskError, Watch};
use tempfile::TempDir;

/// A small ring falls on the ground.
const SCENE: &str = r#"
steps_per_second = 8000
duration = 0.05
gravity = [0, 0, -9.81]
[ground]
[models.ring]
file = "ring.obj"
resolution = 12
kind = "linear"
rank = 4
[[bodies]]
model = "ring"
position = [0, 0, 0.5]
velocity = [0, 0, -2]
[sound]
modes = 8
"#;

/// Returns a torus of 24 x 12 vertices.
fn ring() -> String {
    let (around, across) = (24, 12);
    let mut text = String::new();
    for (i, j) in (0..around).flat_map(|i| (0..across).map(move |j| (i, j))) {
        let (u, v) = (TAU * f64::from(i) / f64::from(around), TAU * f64::from(j) / f64::from(across));
        let radius = 1.0 + 0.3 * v.cos();
        let _ = writeln!(text, "v {} {} {}", radius * u.cos(), radius * u.sin(), 0.3 * v.sin());
    }
    let at = |i: i32, j: i32| 1 + (i % around) * across + j % across;
    for (i, j) in (0..around).flat_map(|i| (0..across).map(move |j| (i, j))) {
        let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        let _ = writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}");
    }
    text
}

/// Folder of the scene and its ring, with the models that all tests share.
static SHARED: LazyLock<TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("scene.toml"), SCENE).unwrap();
    fs::write(folder.path().join("ring.obj"), ring()).unwrap();
    let out = tempfile::tempdir().unwrap();
    simulate(&Request { steps: Some(1), ..request_in(folder.path(), out.path()) }, &()).unwrap();
    folder
});

fn request_in(shared: &Path, out: &Path) -> Request {
    Request {
        scene: shared.join("scene.toml"),
        out: Some(out.to_owned()),
        cache: Some(shared.join("cache")),
        threads: Some(1),
        ..Request::default()
    }
}

fn request(out: &Path) -> Request {
    request_in(SHARED.path(), out)
}

/// Cancels after a number of steps, and records stages and notes.
struct Watched {
    token: CancelToken,
    done: Arc<AtomicUsize>,
    stages: Mutex<Vec<Stage>>,
    notes: Mutex<Vec<String>>,
}

impl Watched {
    fn cancelling_at(steps: usize) -> Self {
        let done = Arc::new(AtomicUsize::new(0));
        let steps_done = Arc::clone(&done);
        Self {
            token: CancelToken::when(move || steps_done.load(Ordering::Relaxed) >= steps),
            done,
            stages: Mutex::default(),
            notes: Mutex::default(),
        }
    }
}

impl Progress for Watched {
    fn report(&self, done: usize, total: usize) {
        assert!(done <= total, "{done} of {total}");
        if let Some(Stage::Steps { .. }) = self.stages.lock().unwrap().last() {
            self.done.fetch_max(done, Ordering::Relaxed);
        }
    }

    fn cancel_token(&self) -> Option<&CancelToken> {
        Some(&self.token)
    }
}

impl Watch for Watched {
    fn begin(&self, stage: Stage) {
        self.stages.lock().unwrap().push(stage);
    }

    fn note(&self, note: &str) {
        self.notes.lock().unwrap().push(note.into());
    }
}

/// Returns the files of a run that do not depend on time.
fn written(run: FinishedRun) -> Result<Vec<Vec<u8>>, SimError> {
    let outputs = Outputs::write(&run);
    let is_motion = |name: &str| ["trajectories.npz", "animation.glb", "sound_float.wav"].contains(&name);
    let files = outputs.files();
    let motion = files.iter().filter(|file| is_motion(&file.file_name().unwrap().to_string_lossy()));
    let bytes: Vec<Vec<u8>> = motion.map(|file| fs::read(file).unwrap()).collect();
    assert_eq!(bytes.len(), 3);
    outputs.finish(run).map(|()| bytes)
}

#[test]
fn concurrent_simulations_are_independent() {
    let folders = [(); 3].map(|()| tempfile::tempdir().unwrap());
    let alone = written(simulate(&request(folders[0].path()), &()).unwrap()).unwrap();
    let begin = Barrier::new(2);
    let (whole, cancelled) = thread::scope(|scope| {
        let run = |folder: usize, watched: Watched| {
            let (request, begin) = (request(folders[folder].path()), &begin);
            scope.spawn(move || {
                begin.wait();
                simulate(&request, &watched).unwrap()
            })
        };
        let (whole, cancelled) =
            (run(1, Watched::cancelling_at(usize::MAX)), run(2, Watched::cancelling_at(100)));
        (whole.join().unwrap(), cancelled.join().unwrap())
    });
    assert_eq!((whole.history.len(), cancelled.history.len()), (400, 100));
    assert!(cancelled.failure.as_ref().unwrap().is_cancelled());
    assert!(written(whole).unwrap() == alone);
    let refused = written(cancelled).unwrap_err();
    assert!(refused.is_cancelled());
    assert_eq!(refused.to_string(), "interrupted after 100 steps; the same command continues from there");
}

#[test]
fn a_cancelled_simulation_continues_to_the_same_bits() {
    let folders = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let whole = written(simulate(&request(folders[0].path()), &()).unwrap()).unwrap();
    let request = request(folders[1].path());
    for (at, states) in [(70, 70), (300, 300), (usize::MAX, 400)] {
        let watched = Watched::cancelling_at(at);
        let run = simulate(&request, &watched).unwrap();
        assert_eq!((run.history.len(), run.failure.is_some()), (states, at < 400));
        // The first simulation has computed modes and certificates.
        let stages = watched.stages.into_inner().unwrap();
        assert!(!stages.contains(&Stage::Certificates) && !stages.contains(&Stage::Modes), "{stages:?}");
        assert_eq!(stages.last() == Some(&Stage::Comparison), at > 400);
        match written(run) {
            Ok(bytes) => assert!(at > 400 && bytes == whole),
            Err(error) => assert!(error.is_cancelled()),
        }
    }
}

/// Cancels when the measurement of the traditional method begins.
#[derive(Default)]
struct Unmeasured(CancelToken);

impl Progress for Unmeasured {
    fn report(&self, _done: usize, _total: usize) {}

    fn cancel_token(&self) -> Option<&CancelToken> {
        Some(&self.0)
    }
}

impl Watch for Unmeasured {
    fn begin(&self, stage: Stage) {
        if stage == Stage::Comparison {
            self.0.cancel();
        }
    }

    fn note(&self, _note: &str) {}
}

#[test]
fn a_simulation_is_complete_without_the_measurement_after_it() {
    let folder = tempfile::tempdir().unwrap();
    let run = simulate(&request(folder.path()), &Unmeasured::default()).unwrap();
    assert!(run.failure.is_none() && run.traditional.is_empty());
    assert_eq!(run.history.len(), 400);
    let error = written(run).unwrap_err();
    assert!(error.is_cancelled());
    let message = "interrupted: the traditional method was not measured; the simulation is complete, and its files are in ";
    assert_eq!(
        error.to_string(),
        format!("{message}{}; the same command measures again", folder.path().display())
    );
}

#[test]
fn a_damaged_model_is_made_anew_with_a_note() {
    let (folder, out) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    for name in ["scene.toml", "ring.obj"] {
        fs::copy(SHARED.path().join(name), folder.path().join(name)).unwrap();
    }
    let request = Request { steps: Some(1), ..request_in(folder.path(), out.path()) };
    let first = Watched::cancelling_at(usize::MAX);
    simulate(&request, &first).unwrap();
    assert!(first.stages.lock().unwrap().contains(&Stage::Modes) && first.notes.lock().unwrap().is_empty());
    let files = fs::read_dir(folder.path().join("cache")).unwrap().map(|entry| entry.unwrap().path());
    let model =
        files.into_iter().find(|path| path.to_string_lossy().ends_with(".model.safetensors")).unwrap();
    let bytes = fs::read(&model).unwrap();
    fs::write(&model, &bytes[..bytes.len() / 2]).unwrap();
    let second = Watched::cancelling_at(usize::MAX);
    simulate(&request, &second).unwrap();
    let notes = second.notes.into_inner().unwrap();
    let [note] = &notes[..] else { panic!("{notes:?}") };
    assert!(note.starts_with(&format!("made anew: {}: ", model.display())), "{note}");
    assert_eq!(fs::read(&model).unwrap(), bytes);
}

/// Returns a scene without sound of this number of rings in a row in the ground, each with another shake.
fn shaken_rings(name: &str, count: usize, steps_per_second: &str, duration: &str) -> Request {
    let text = SCENE.replace("8000", steps_per_second).replace("0.05", duration);
    let mut text = text.split_once("[[bodies]]").unwrap().0.to_owned();
    for n in 1..=count {
        let _ = writeln!(text, "[[bodies]]\nmodel = \"ring\"\nposition = [{}, 0, 0]\nshake = [{n}]", 3 * n);
    }
    let path = SHARED.path().join(name);
    fs::write(&path, text).unwrap();
    Request { scene: path, ..request(&SHARED.path().join(format!("{name} out"))) }
}

/// Their vibrations would take 200 times 10^9 steps.
#[test]
fn too_many_steps_are_refused_before_the_shakes_are_described() {
    let error = simulate(&shaken_rings("long.toml", 200, "1e9", "1"), &()).err().unwrap().to_string();
    assert_eq!(error, "long: 1000000000 steps need 19288 GB: choose fewer with steps");
}

/// Cancels by a token.
struct CancelledBy(CancelToken);

impl Progress for CancelledBy {
    fn report(&self, _done: usize, _total: usize) {}

    fn cancel_token(&self) -> Option<&CancelToken> {
        Some(&self.0)
    }
}

impl Watch for CancelledBy {
    fn begin(&self, _stage: Stage) {}

    fn note(&self, _note: &str) {}
}

#[test]
fn the_description_of_each_shake_can_be_cancelled() {
    // The rings are in the ground, so that the simulation ends after the description.
    let run = |count: usize, limit: usize| {
        let request = shaken_rings(&format!("rings{count}-{limit}.toml"), count, "8000", "0.05");
        let checks = Arc::new(AtomicUsize::new(0));
        let seen = Arc::clone(&checks);
        let token = CancelToken::when(move || seen.fetch_add(1, Ordering::Relaxed) >= limit);
        let error = simulate(&request, &CancelledBy(token)).err().unwrap();
        (error.is_cancelled(), checks.load(Ordering::Relaxed))
    };
    let (is_cancelled, checks) = run(1, usize::MAX);
    assert!(!is_cancelled);
    assert_eq!(run(20, usize::MAX), (false, checks + 19));
    assert_eq!(run(20, checks + 18), (true, checks + 19));
}

/// Returns the files of a folder with their content; folders have none.
fn contents(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut found: Vec<_> = paths.map(|path| (path.clone(), fs::read(path).unwrap_or_default())).collect();
    found.sort();
    found
}

#[test]
fn inputs_of_a_scene_are_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let (start, _) = SCENE.split_once("[models.ring]").unwrap();
    let scene = |keys: &str| format!("{start}[models.m]\n{keys}\n[[bodies]]\nmodel = \"m\"\n");
    // The scene, its keys, and the input that the simulation would replace or remove. The inputs are not read.
    for (name, keys, input) in [
        ("scene.toml", "file = \"animation.glb\"", "animation.glb"),
        ("scene.toml", "file = \"animation.glb#Body\"", "animation.glb"),
        ("scene.toml", "file = \"x.obj\"\nmodes = \"trajectories.npz\"", "trajectories.npz"),
        ("scene.toml", "file = \"x.obj\"\nmodes = \"x.U\"\nforces = \"states.log\"", "states.log"),
        ("scene.toml", "file = \"x.obj\"\nsolid = \"checkpoint.bin\"\nkind = \"linear\"", "checkpoint.bin"),
        ("scene.toml", "file = \"sound.wav\"\nkind = \"linear\"", "sound.wav"),
        ("summary.json", "shape = \"spring-4k\"\nkind = \"linear\"", "summary.json"),
    ] {
        fs::write(at(input), b"an input").unwrap();
        fs::write(at(name), scene(keys)).unwrap();
        let before = contents(folder.path());
        for restart in [false, true] {
            let request = Request { scene: at(name), restart, ..request(folder.path()) };
            let message = simulate(&request, &()).err().unwrap().to_string();
            let cause = "is an input of the scene: choose another folder with out";
            assert_eq!(message, format!("{}: {cause}", at(input).display()));
            assert!(contents(folder.path()) == before, "{keys}");
        }
        fs::remove_file(at(input)).unwrap();
    }
}

#[test]
fn files_of_others_are_not_replaced() {
    for name in ["report.html", "summary.json", "sound.wav", "checkpoint.bin", "states.log"] {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(name), "a file of the user\n".repeat(30)).unwrap();
        let before = contents(folder.path());
        for restart in [false, true] {
            let request = Request { steps: Some(3), restart, ..request(folder.path()) };
            let message = simulate(&request, &()).err().unwrap().to_string();
            let cause = "exists and is not of a simulation: choose another folder with out, or move it away";
            assert!(message.ends_with(&format!("{name}: {cause}")), "{message}");
            assert!(contents(folder.path()) == before, "{name}");
        }
    }
}

#[test]
#[cfg(unix)]
fn read_only_outputs_are_kept_and_links_stay() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let [folder, other] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let at = |name: &str| folder.path().join(name);
    let run = |steps: usize, restart: bool| {
        let request = Request { steps: Some(steps), restart, ..request(folder.path()) };
        simulate(&request, &()).map(|run| written(run).unwrap())
    };
    run(3, false).unwrap();
    let set_mode = |name: &str, mode: u32| {
        fs::set_permissions(at(name), fs::Permissions::from_mode(mode)).unwrap();
    };
    for name in ["animation.glb", "states.log", "checkpoint.bin", "sound_float.wav"] {
        set_mode(name, 0o444);
        let before = contents(folder.path());
        for restart in [false, true] {
            let message = run(5, restart).err().unwrap().to_string();
            assert!(message.contains(&format!("{name}: cannot be written: it is read-only")), "{message}");
            assert!(contents(folder.path()) == before, "{name}");
        }
        set_mode(name, 0o644);
    }
    // An output in another folder, by a link.
    let kept = other.path().join("kept.glb");
    fs::rename(at("animation.glb"), &kept).unwrap();
    symlink(&kept, at("animation.glb")).unwrap();
    for restart in [false, true] {
        run(3, restart).unwrap();
        assert!(fs::symlink_metadata(at("animation.glb")).unwrap().is_symlink());
        assert!(fs::symlink_metadata(&kept).unwrap().is_file());
    }
}

#[test]
fn folders_of_simulations_are_used_again() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let run = |restart: bool| {
        let request = Request { steps: Some(3), restart, ..request(folder.path()) };
        let run = simulate(&request, &())?;
        let steps = run.history.len();
        written(run).map(|_| steps)
    };
    assert_eq!(run(false).unwrap(), 3);
    // With all of its files; without its log and checkpoint; with the log alone, as before the first checkpoint.
    assert_eq!((run(false).unwrap(), run(true).unwrap()), (3, 3));
    for restart in [false, true] {
        for name in ["states.log", "checkpoint.bin"] {
            fs::remove_file(at(name)).unwrap();
        }
        assert_eq!(run(restart).unwrap(), 3);
    }
    fs::remove_file(at("checkpoint.bin")).unwrap();
    assert_eq!(run(false).unwrap(), 3);
    // The log of another build of the program.
    let mut log = fs::read(at("states.log")).unwrap();
    log[0] ^= 1;
    for (path, _) in contents(folder.path()) {
        fs::remove_file(path).unwrap();
    }
    fs::write(at("states.log"), log).unwrap();
    let message = run(false).unwrap_err().to_string();
    assert!(message.contains("states.log: this file belongs to another scene"), "{message}");
    assert_eq!(run(true).unwrap(), 3);
}

#[test]
fn refusals_name_the_file_and_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |request: Request| simulate(&request, &()).err().unwrap();
    let scene = |text: &str| {
        let path = folder.path().join("bad.toml");
        fs::write(&path, text).unwrap();
        Request { scene: path, ..request(&folder.path().join("out")) }
    };
    let message = |text: &str| refused(scene(text)).to_string();
    let unknown = message(&SCENE.replace("gravity", "gravty"));
    assert!(
        unknown.ends_with("bad.toml: line 4: unknown key 'gravty'; did you mean 'gravity'?"),
        "{unknown}"
    );
    let missing = refused(scene(SCENE));
    assert!(
        missing.task().and_then(TaskError::file).is_some()
            && missing.to_string().ends_with("ring.obj: not found"),
        "{missing}"
    );
    let large = message(&"#".repeat((1 << 20) + 1));
    assert!(large.ends_with("bad.toml: file has 1048577 bytes; scenes may have at most 1048576"), "{large}");
    let models = folder.path().join("none");
    let named = refused(Request { models: Some(models.clone()), ..request(folder.path()) }).to_string();
    assert_eq!(named, format!("{}: no folder of models; leave out models", models.display()));
    let file = folder.path().join("bad.toml");
    let error = refused(Request { out: Some(file.clone()), ..request(folder.path()) });
    let start = format!("{}: cannot write to this folder: ", file.display());
    assert!(
        error.task().is_some_and(TaskError::is_system) && error.to_string().starts_with(&start),
        "{error}"
    );
}
