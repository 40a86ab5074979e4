//! Ctrl-C and SIGTERM: one message and one exit code for all commands, and no partly written file.

#![cfg(unix)]

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::common::{Run, command, files, strips};

/// Waits until a program has installed its signal handlers, by the process status of Linux; elsewhere for a second.
fn wait_for_handlers(child: &Child) {
    /// SIGINT is signal 2, SIGTERM is 15: bits count from 1.
    const BOTH: u64 = 1 << 1 | 1 << 14;
    let status = format!("/proc/{}/status", child.id());
    let is_listening = || {
        let status = fs::read_to_string(&status).ok()?;
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"))?;
        Some(u64::from_str_radix(caught.trim(), 16).unwrap() & BOTH == BOTH)
    };
    for _ in 0..500 {
        match is_listening() {
            Some(true) => return,
            Some(false) => sleep(Duration::from_millis(10)),
            None => return sleep(Duration::from_secs(1)),
        }
    }
}

/// Starts all commands at once, and interrupts each during its work. Returns the exit code and standard error of each.
fn interrupted(folder: &Path, all: &[(&[&str], &str)]) -> Vec<(Option<i32>, String)> {
    let begin = |(args, _): &(&[&str], &str)| {
        let mut command = command(folder, args);
        command.env_remove("SSCC_MODELS").stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
    };
    let mut children: Vec<Child> = all.iter().map(begin).collect();
    children.iter().for_each(wait_for_handlers);
    sleep(Duration::from_millis(700));
    for (child, (_, signal)) in children.iter().zip(all) {
        let sent = Command::new("kill").args([*signal, &child.id().to_string()]).status();
        assert!(sent.unwrap().success());
    }
    let end = |child: &mut Child| {
        let mut stderr = String::new();
        child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
        (child.wait().unwrap().code(), stderr)
    };
    children.iter_mut().map(end).collect()
}

/// Starts a command, and interrupts it when it has printed its first line. Returns all lines that it has printed.
pub fn interrupted_after_a_line(folder: &Path, args: &[&str]) -> Run {
    let mut child = command(folder, args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut reader = BufReader::new(child.stdout.take().unwrap());
    let (mut stdout, mut stderr) = (String::new(), String::new());
    reader.read_line(&mut stdout).unwrap();
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(sent.unwrap().success());
    reader.read_to_string(&mut stdout).unwrap();
    child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
    let args = args.iter().map(|arg| (*arg).to_owned()).collect();
    Run { args, code: child.wait().unwrap().code(), stdout, stderr }
}

/// Writes the spring with polynomial modes, whose certificates take long at a small epsilon.
fn write_spring(folder: &Path) {
    let mesh = sscc_modes::shapes::spring();
    let points = mesh.rest_positions().iter().map(|p| format!("v {} {} {}\n", p.x, p.y, p.z));
    let faces = mesh.faces().iter().map(|f| f.map(|v| v + 1)).map(|[a, b, c]| format!("f {a} {b} {c}\n"));
    fs::write(folder.join("spring.obj"), points.chain(faces).collect::<String>()).unwrap();
    let modes = sscc_modes::polynomial_modes(&mesh).unwrap();
    let model = sscc::ReducedModel::new(mesh, modes).unwrap();
    let path = folder.join("spring.model.safetensors");
    sscc_io::write_model(&path, &model, &sscc_io::ModelInfo::default()).unwrap();
}

#[test]
fn every_command_prints_the_same_message() {
    let directory = strips();
    let folder = directory.path();
    write_spring(folder);
    sscc_io::write_npy(&folder.join("q.npy"), &[200, 24], &vec![0.0; 4800]).unwrap();
    fs::write(folder.join("flag.gltf"), crate::detector::flag()).unwrap();
    let before = files(folder);
    const SPRING: &str = "spring.model.safetensors";
    let all: [(&[&str], &str); 9] = [
        (&["certify", SPRING, "-o", "spring.sscc.safetensors", "--threads", "1", "--epsilon=0.001"], "-INT"),
        (&["certify", SPRING, "-o", "again.sscc.safetensors", "--threads", "1", "--epsilon=0.001"], "-TERM"),
        (&["modes", "spring.obj", "-o", "m.model.safetensors", "--kind=linear", "--rank=200"], "-TERM"),
        (&["demo", "--out", "demo"], "-INT"),
        (&["check", SPRING, "--trajectory", "q.npy", "--method=brute-force"], "-TERM"),
        (&["check", "flag.gltf", "--animation=0", "--fps=9e6", "--curves=c.obj"], "-INT"),
        (
            &[
                "audit",
                "strips.model.safetensors",
                "--certificates",
                "strips.sscc.safetensors",
                "--samples=100000000",
            ],
            "-TERM",
        ),
        (&["view", SPRING, "--no-open", "--epsilon=0.001", "--threads", "1"], "-TERM"),
        (&["bench", "kinetic", "--cache", "cache"], "-INT"),
    ];
    for ((args, _), (code, stderr)) in all.iter().zip(interrupted(folder, &all)) {
        let message = stderr.lines().find(|line| !line.starts_with("note: "));
        assert_eq!((code, message), (Some(130), Some("error: interrupted")), "{args:?}: {stderr}");
    }
    // Output folders are created before the work, to test that they can be.
    let after: Vec<_> = files(folder).into_iter().filter(|path| path.is_file()).collect();
    assert_eq!(after, before);
    assert!(files(&folder.join("demo")).is_empty());
}

/// The message of an interrupted simulation begins in the same way.
#[test]
fn simulations_are_interrupted() {
    let directory = tempfile::tempdir().unwrap();
    let args: &[&str] = &["simulate", "spring", "--cache", "cache", "--out", "out"];
    let other: &[&str] = &["simulate", "spring", "--cache", "other", "--out", "other-out"];
    for (code, stderr) in interrupted(directory.path(), &[(args, "-INT"), (other, "-TERM")]) {
        assert_eq!(code, Some(130), "{stderr}");
        assert!(stderr.starts_with("error: interrupted"), "{stderr}");
    }
}
