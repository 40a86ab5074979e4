//! Faults of the system: a command is killed, may write no large file, has no memory, or its output has no reader. Each file
//! is then the old one or the new one, whole.

#![cfg(target_os = "linux")]

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::sleep;
use std::time::{Duration, Instant};

use glam::DVec3;
use sscc::{Modes, ReducedModel, TriMesh};
use sscc_io::ModelInfo;
use tempfile::TempDir;

use crate::common::{Run, command, files, sscc, strips};

/// Content of each output file before its command runs.
const OLD: &[u8] = b"an old file";

/// Commands that write a file, by the name of the file.
const WRITERS: [(&str, &[&str]); 6] = [
    ("new.sscc.safetensors", &["certify", "sheet.model.safetensors", "-o", "new.sscc.safetensors"]),
    ("new.model.safetensors", &["modes", "mesh.obj", "--kind=polynomial", "-o", "new.model.safetensors"]),
    (
        "pose.ply",
        &["check", "sheet.model.safetensors", "--q=0.1,0,0", "--pose", "pose.ply", "--method=traditional"],
    ),
    (
        "pose.obj",
        &["check", "sheet.model.safetensors", "--q=0.1,0,0", "--pose", "pose.obj", "--method=traditional"],
    ),
    ("page.html", &["check", "mesh.obj", "--report", "page.html"]),
    (
        "picture.png",
        &["certify", "strips.model.safetensors", "-o", "strips.sscc.safetensors", "--picture", "picture.png"],
    ),
];

/// A folder with strips, and with a sheet of 1,152 triangles and three modes.
fn folder() -> TempDir {
    const SIDE: u32 = 25;
    let directory = strips();
    let folder = directory.path();
    let at = |i: u32| DVec3::new(f64::from(i % SIDE), f64::from(i / SIDE), 0.0);
    let corners = (0..SIDE * (SIDE - 1)).filter(|i| i % SIDE != SIDE - 1);
    let faces = corners.flat_map(|i| [[i, i + 1, i + SIDE], [i + 1, i + SIDE + 1, i + SIDE]]).collect();
    let mesh = TriMesh::new((0..SIDE * SIDE).map(at).collect(), faces).unwrap();
    let modes = Modes::from_matrix((SIDE * SIDE) as usize, 3, |row, k| ((row * (k + 3)) % 7) as f64 * 0.01);
    let model = ReducedModel::new(mesh, modes.unwrap()).unwrap();
    sscc_io::write_model(&folder.join("sheet.model.safetensors"), &model, &ModelInfo::default()).unwrap();
    directory
}

/// Kills a command after a delay. With `is_writing`, the delay begins when the command begins to write its file.
fn killed(folder: &Path, args: &[&str], delay: Duration, is_writing: bool) {
    let before = files(folder).len();
    let mut child = command(folder, args).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let start = Instant::now();
    while is_writing
        && files(folder).len() == before
        && child.try_wait().unwrap().is_none()
        && start.elapsed() < Duration::from_secs(60)
    {
        sleep(Duration::from_micros(20));
    }
    sleep(delay);
    let _ = child.kill();
    child.wait().unwrap();
}

/// Removes temporary files, and returns their number. Temporary files of a killed command remain, because other commands
/// cannot detect that it has ended.
fn remove_parts(folder: &Path) -> usize {
    let mut count = 0;
    for path in files(folder) {
        let name = path.file_name().unwrap().to_str().unwrap();
        if name.starts_with(".sscc-") && name.ends_with(".part") {
            fs::remove_file(path).unwrap();
            count += 1;
        }
    }
    count
}

#[test]
fn killed_commands_leave_files_old_or_new() {
    let directory = folder();
    let folder = directory.path();
    let kills = if std::env::var_os("SSCC_LONG").is_some() { 40 } else { 6 };
    let certificates = folder.join("strips.sscc.safetensors");
    let unchanged = fs::read(&certificates).unwrap();
    let (mut old, mut parts) = (0, 0);
    for (name, args) in WRITERS {
        let path = folder.join(name);
        let start = Instant::now();
        let run = sscc(folder, args);
        assert!(matches!(run.code, Some(0 | 1)), "{run:?}");
        let (whole, expected) = (start.elapsed(), fs::read(&path).unwrap());
        for kill in 0..kills {
            fs::write(&path, OLD).unwrap();
            // Half of them while the file is written.
            let is_writing = kill % 2 == 0;
            let delay = if is_writing {
                Duration::from_micros(50 * kill)
            } else {
                whole * kill as u32 / kills as u32
            };
            killed(folder, args, delay, is_writing);
            let found = fs::read(&path).unwrap();
            assert!(found == OLD || found == expected, "{name}, kill {kill}: {} bytes", found.len());
            // The certificates are unchanged, because the command that writes them again gives the same bytes.
            assert!(fs::read(&certificates).unwrap() == unchanged, "{name}, kill {kill}");
            old += usize::from(found == OLD);
            parts += remove_parts(folder);
        }
        // The next run writes the whole file.
        sscc(folder, args);
        assert!(fs::read(&path).unwrap() == expected, "{name}");
    }
    // The page is the largest file, so on a machine of any speed a kill comes sooner or later while it is written.
    let (_, page) = WRITERS[4];
    for _ in 0..200 {
        if parts > 0 {
            break;
        }
        killed(folder, page, Duration::ZERO, true);
        parts += remove_parts(folder);
    }
    // Some were killed before they had written their file, and some while they wrote it.
    assert!(old > 0 && parts > 0, "{old} {parts}");
}

/// A command in a shell with a limit of `ulimit`. Signals of files that are too large are ignored, as is usual for services.
fn limited(folder: &Path, limit: &str, args: &[&str]) -> Run {
    let script = format!("trap '' XFSZ; ulimit {limit}; exec \"$0\" \"$@\"");
    let mut shell = Command::new("bash");
    // Address space of threads is reserved, so their number is that of this test.
    shell.env("RAYON_NUM_THREADS", "2");
    shell
        .args(["-c", &script, env!("CARGO_BIN_EXE_sscc")])
        .args(args)
        .current_dir(folder)
        .stdin(Stdio::null());
    Run::of(&mut shell)
}

#[test]
fn files_that_cannot_grow_stay_old() {
    let directory = folder();
    let folder = directory.path();
    let before = files(folder);
    for (name, args) in WRITERS {
        let path = folder.join(name);
        fs::write(&path, OLD).unwrap();
        // A block of `ulimit -f` has 1,024 bytes.
        let run = limited(folder, "-f 1", args);
        let error = run.stderr.lines().find(|line| line.starts_with("error: ")).unwrap_or_default();
        assert_eq!(run.code, Some(2), "{run:?}");
        assert!(error.contains("cannot be written") && error.contains("large"), "{error}");
        // The picture is written after the certificates, which then are the first to fail.
        assert!(error.contains(name) || name == "picture.png", "{error}");
        assert!(fs::read(&path).unwrap() == OLD, "{name}");
        fs::remove_file(&path).unwrap();
    }
    assert_eq!(files(folder), before);
}

#[test]
fn read_only_files_stay_and_links_are_followed() {
    use std::os::unix::fs::{PermissionsExt, symlink};
    let directory = folder();
    let folder = directory.path();
    fs::create_dir(folder.join("big")).unwrap();
    let before = files(folder).len() + 1;
    for (name, args) in [WRITERS[0], WRITERS[1], WRITERS[2], WRITERS[4]] {
        let path = folder.join(name);
        fs::write(&path, OLD).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o444)).unwrap();
        let run = sscc(folder, args);
        let error = run.stderr.lines().find(|line| line.starts_with("error: ")).unwrap_or_default();
        assert_eq!(run.code, Some(2), "{run:?}");
        let end = "cannot be written: it is read-only: make it writable, or choose another name";
        assert!(error.ends_with(&format!("{name}: {end}")), "{error}");
        assert!(fs::read(&path).unwrap() == OLD, "{name}");
        assert_eq!(files(folder).len(), before, "{name}");
        fs::remove_file(&path).unwrap();

        // The link stays, and the new file is where the old one was, with the permissions of the old one.
        let target = folder.join("big/file");
        fs::write(&target, OLD).unwrap();
        fs::set_permissions(&target, fs::Permissions::from_mode(0o640)).unwrap();
        symlink("big/file", &path).unwrap();
        let run = sscc(folder, args);
        assert!(matches!(run.code, Some(0 | 1)), "{run:?}");
        assert!(fs::symlink_metadata(&path).unwrap().is_symlink(), "{name}");
        assert!(fs::read(&target).unwrap() != OLD, "{name}");
        assert_eq!(fs::metadata(&target).unwrap().permissions().mode() & 0o777, 0o640, "{name}");
        assert_eq!((files(folder).len(), files(&folder.join("big")).len()), (before, 1), "{name}");
        fs::remove_file(&path).unwrap();
    }
}

/// Runs a command that writes to a file system of 4 kB, which an old file fills. It is mounted for this command only.
fn on_full_disk(folder: &Path, name: &str, args: &[&str]) -> (Run, Vec<String>) {
    let script = "mount -t tmpfs -o size=4k none small && printf 'an old file' > small/\"$1\" && shift && \"$@\" 1>&2
        code=$?; for file in small/* small/.[!.]*; do [ -f \"$file\" ] && echo \"$file: $(cat \"$file\")\"; done; exit $code";
    let mut shell = Command::new("unshare");
    shell.args(["-Urm", "bash", "-c", script, "bash", name, env!("CARGO_BIN_EXE_sscc")]);
    let run = Run::of(shell.args(args).current_dir(folder).stdin(Stdio::null()));
    let files = run.stdout.lines().map(str::to_owned).collect();
    (run, files)
}

#[test]
#[ignore = "mounts a file system, which not every system allows its users"]
fn a_full_disk_leaves_files_old() {
    let directory = folder();
    let folder = directory.path();
    fs::create_dir(folder.join("small")).unwrap();
    for (name, args) in &WRITERS[..5] {
        let output = format!("small/{name}");
        let args: Vec<&str> =
            args.iter().map(|arg| if arg == name { output.as_str() } else { arg }).collect();
        let (run, files) = on_full_disk(folder, name, &args);
        let error = run.stderr.lines().find(|line| line.starts_with("error: ")).unwrap_or_default();
        assert_eq!(run.code, Some(2), "{run:?}");
        assert!(error.contains(name) && error.contains("cannot be written"), "{error}");
        assert_eq!(files, [format!("{output}: an old file")], "{run:?}");
    }
}

#[test]
fn files_replaced_while_they_are_read_give_the_answer_of_one_of_them() {
    let directory = folder();
    let folder = directory.path();
    // Two meshes of one size: the second one collides.
    let sheet = |is_colliding: bool| {
        let mut text = String::new();
        for i in 0..2000 {
            let z = if is_colliding && i == 1 { 0.0 } else { f64::from(i) };
            text += &format!("v 0 0 {z}\nv 1 0 {z}\nv 0 1 {z}\n");
        }
        (0..2000).for_each(|i| text += &format!("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3));
        text
    };
    let contents = [sheet(false), sheet(true)];
    let args = ["check", "changing.obj", "--json"];
    // The time of an answer differs from run to run.
    let answer_of = |run: &Run| {
        let mut lines = run.json();
        lines.iter_mut().for_each(|line| drop(line.as_object_mut().unwrap().remove("microseconds")));
        (run.code, lines)
    };
    let answers = contents.each_ref().map(|content| {
        fs::write(folder.join("changing.obj"), content).unwrap();
        answer_of(&sscc(folder, &args))
    });
    assert_eq!(answers.each_ref().map(|answer| answer.0), [Some(0), Some(1)]);
    let runs = if std::env::var_os("SSCC_LONG").is_some() { 200 } else { 20 };
    let is_over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            for content in contents.iter().cycle() {
                if is_over.load(Ordering::Relaxed) {
                    return;
                }
                fs::write(folder.join("next.obj"), content).unwrap();
                fs::rename(folder.join("next.obj"), folder.join("changing.obj")).unwrap();
            }
        });
        let seen = std::panic::catch_unwind(|| (0..runs).map(|_| sscc(folder, &args)).collect::<Vec<Run>>());
        // Also after a panic: the scope waits for its thread.
        is_over.store(true, Ordering::Relaxed);
        for run in &seen.unwrap() {
            assert!(answers.contains(&answer_of(run)), "{run:?}");
        }
    });
}

#[test]
fn without_memory_files_stay_old() {
    let directory = folder();
    let folder = directory.path();
    let (name, args) = WRITERS[0];
    fs::write(folder.join(name), OLD).unwrap();
    let before = files(folder);
    let mut failed = 0;
    // The address space (kilobytes) is too small for the threads of the command at first, and then sufficient. With less, the
    // system does not start the command.
    for kilobytes in [30_000, 36_000, 45_000, 60_000, 80_000, 120_000, 8_000_000] {
        let run = limited(folder, &format!("-v {kilobytes}"), args);
        assert!(!run.stderr.contains("thread pool has not been initialized"), "{kilobytes}: {run:?}");
        match run.code {
            Some(0) => {
                fs::write(folder.join(name), OLD).unwrap();
                continue;
            }
            Some(2) => assert!(run.stderr.starts_with("error: "), "{kilobytes}: {run:?}"),
            // The loader or the allocator of the system ends the program with another exit code or by a signal.
            _ => {}
        }
        failed += 1;
        assert!(fs::read(folder.join(name)).unwrap() == OLD, "{kilobytes}");
        _ = remove_parts(folder);
        assert_eq!(files(folder), before, "{kilobytes}");
    }
    assert!((1..7).contains(&failed), "{failed}");
}

/// No address space has room for the stacks that the environment requests, so the system refuses each thread.
#[test]
fn a_system_that_refuses_threads_is_an_error_of_one_line() {
    let directory = folder();
    let folder = directory.path();
    let before = files(folder);
    for args in [
        &["check", "mesh.obj"][..],
        &["certify", "sheet.model.safetensors", "-o", "new.sscc.safetensors"],
        &["simulate", "spring", "--out", "out"],
    ] {
        let mut command = command(folder, args);
        let run = Run::of(command.env("RUST_MIN_STACK", (1_u64 << 60).to_string()));
        let message = run.refusal();
        assert!(
            message.starts_with("error: the system refuses threads: free memory, or allow "),
            "{message}"
        );
        // The cause is that of the system.
        assert!(!message.contains("already been initialized"), "{message}");
    }
    assert_eq!(files(folder), before);
}

#[test]
fn help_that_cannot_be_written_is_an_error() {
    for args in [&["--help"][..], &["--version"], &["check", "--help"]] {
        let full = fs::File::options().write(true).open("/dev/full").unwrap();
        let run = Run::of(command(Path::new("."), args).stdout(full));
        assert!(run.refusal().starts_with("error: standard output cannot be written: "), "{run:?}");
    }
}

#[test]
fn commands_whose_reader_closes_the_pipe_do_not_panic() {
    let directory = folder();
    let folder = directory.path();
    sscc_io::write_npy(&folder.join("q.npy"), &[3000, 2], &vec![0.25; 6000]).unwrap();
    let certificates = ["--certificates", "strips.sscc.safetensors"];
    let args = [&["check", "strips.model.safetensors", "--trajectory", "q.npy", "--json"][..], &certificates]
        .concat();
    let mut child = command(folder, &args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap());
    let mut first = String::new();
    lines.read_line(&mut first).unwrap();
    drop(lines);
    let mut stderr = String::new();
    child.stderr.take().unwrap().read_to_string(&mut stderr).unwrap();
    assert_eq!((child.wait().unwrap().code(), stderr.as_str()), (Some(0), ""));
    assert!(first.starts_with('{'), "{first}");
}
