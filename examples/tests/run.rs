//! Runs every example on the generated model and on real ones, and checks its output.

#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

use std::env;
use std::env::consts::EXE_SUFFIX;
use std::ffi::OsStr;
use std::path::PathBuf;
use std::process::{Command, Output};

use sscc_io::read_mesh;
use sscc_testing::models;
use tempfile::TempDir;

/// Returns the path of an example. Cargo builds it before all tests, but not with `--test run`.
fn program(example: &str) -> PathBuf {
    let tests = env::current_exe().unwrap(); // PROFILE/deps/run-...
    let profile = tests.parent().unwrap().parent().unwrap();
    let program = profile.join("examples").join(format!("{example}{EXE_SUFFIX}"));
    assert!(
        program.exists(),
        "{}: build it first: cargo build -p sscc-examples --examples",
        program.display()
    );
    program
}

/// Runs an example with its own folder for temporary files.
fn output(example: &str, arguments: &[impl AsRef<OsStr>]) -> (Output, TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(program(example));
    command.args(arguments).current_dir(&folder).env("TMPDIR", folder.path()).env("TMP", folder.path());
    (command.output().unwrap(), folder)
}

/// Runs an example that must succeed. Returns its output and its folder.
fn run(example: &str, arguments: &[impl AsRef<OsStr>]) -> (String, TempDir) {
    let (output, folder) = output(example, arguments);
    let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    assert!(output.status.success() && err.is_empty(), "{example}: {}, {err}{out}", output.status);
    (out, folder)
}

const NONE: &[&str] = &[];

/// Returns the only line that contains `part`.
fn line<'a>(text: &'a str, part: &str) -> &'a str {
    let mut lines = text.lines().filter(|line| line.contains(part));
    match (lines.next(), lines.next()) {
        (Some(line), None) => line,
        _ => panic!("not one line has {part:?}:\n{text}"),
    }
}

#[test]
fn glb_face() {
    let (text, folder) = run("glb_face", NONE);
    assert!(line(&text, "at rest").ends_with(" 0 pairs"));
    // The lips touch at the weights 0.6 / 0.8 and 0.6 / 0.9.
    assert!(line(&text, " close:").contains("first touch found at 0.755:"));
    assert!(line(&text, " bite:").contains("first touch found at 0.67:"));
    assert!(line(&text, " smile:").ends_with("no touch found up to 1"));
    let pose = read_mesh(&folder.path().join("glb_face.ply")).unwrap();
    assert_eq!(pose.faces().len(), 768);
}

#[test]
fn glb_face_on_a_real_file() {
    let Some(folder) = models("glb_face_on_a_real_file") else { return };
    let file = folder.join("morph/RobotExpressive.glb");
    let (text, _) = run("glb_face", &[file.as_os_str(), "Head".as_ref()]);
    assert!(line(&text, "at rest").ends_with(" 394 pairs"));
    assert!(line(&text, "Surprised: proven free up to").contains("first touch found at 0.08:"));
}

#[test]
fn pca_model() {
    let (text, _) = run("pca_model", NONE);
    line(&text, "39 of them intersect themselves: 1.9 %");
    assert!(line(&text, "safe_scale").ends_with(" 0 pairs"));
    assert!(line(&text, "clamp").ends_with(" 0 pairs"));
}

#[test]
fn vegafem() {
    let (text, _) = run("vegafem", NONE);
    line(&text, "768 triangles, 4 modes");
    assert!(!line(&text, "growing").contains(" 0 colliding"));
    settled_frames(&text);
}

#[test]
fn vegafem_on_real_files() {
    let Some(folder) = models("vegafem_on_real_files") else { return };
    let files = ["A.obj", "A.URendering.float"].map(|name| folder.join("vega_A").join(name));
    let (text, _) = run("vegafem", &files);
    line(&text, "834 triangles, 20 modes");
    settled_frames(&text);
}

/// Checks the queries about the settled pose. Certificates with the centre at rest answer no frame by one comparison, those
/// with the settled pose as centre answer all frames.
fn settled_frames(text: &str) {
    line(text, "settled: 300 frames, 0 colliding, 0 answered by one comparison");
    line(text, "settled: 300 frames, 0 colliding, 300 answered by one comparison");
}

#[test]
fn simulation_loop() {
    let (text, _) = run("simulation_loop", NONE);
    line(&text, "first contact in step 316");
    assert!(line(&text, "one comparison").contains(" of 316 steps"));
}

/// The digests are the same on this machine as in the record.
#[test]
fn digests() {
    let (text, _) = run("digests", NONE);
    assert_eq!(text, include_str!("../../docs/records/digests.txt"), "cargo xtask digests");
}

#[test]
fn errors_are_one_line() {
    for (example, arguments) in
        [("glb_face", &["no.glb"][..]), ("pca_model", &["no.npz"]), ("vegafem", &["no.obj", "no.U"])]
    {
        let (output, _) = output(example, arguments);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{error}");
        assert_eq!(error, format!("error: {}: not found\n", arguments[0]));
    }
    let (output, _) = output("vegafem", &["only.obj"]);
    assert_eq!(output.status.code(), Some(1));
}
