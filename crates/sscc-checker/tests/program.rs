//! Tests of the program: exit codes, and messages of one line.
#![allow(clippy::expect_used, clippy::panic, clippy::unreachable, clippy::unwrap_used)]

use std::fs;
use std::process::Command;

#[test]
fn invalid_files_are_refused_with_one_line() {
    let folder = std::env::temp_dir().join(format!("sscc-checker-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("a.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    fs::write(folder.join("polygon.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 1\n").unwrap();
    let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (9, 1), }";
    let npy =
        [b"\x93NUMPY\x01\0".as_slice(), &(header.len() as u16).to_le_bytes(), header.as_bytes(), &[0; 72]];
    fs::write(folder.join("u.npy"), npy.concat()).unwrap();
    for (args, cause) in [
        (&["missing.obj", "u.npy", "a.obj", "a.obj"][..], "missing.obj: "),
        (&["two\nlines.obj", "u.npy", "a.obj", "a.obj"], r"two\nlines.obj: "),
        (&["polygon.obj", "u.npy", "a.obj", "a.obj"], "polygon.obj: line 4: "),
        (&["a.obj", "a.obj", "a.obj", "a.obj"], "a.obj: not an .npy file"),
        (&["a.obj", "u.npy", "a.obj", "a.obj"], "certificates: not a file written by sscc"),
        (&["a.obj", "a.obj", "a.obj"], "a.obj: not a file written by sscc"),
        (&["a.obj"], "three or four files are needed"),
        (&[], "three or four files are needed"),
    ] {
        let output = Command::new(env!("CARGO_BIN_EXE_sscc-checker"))
            .args(args)
            .current_dir(&folder)
            .output()
            .unwrap();
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{message}");
        assert!(message.starts_with(&format!("error: {cause}")), "{message}");
        assert_eq!(message.lines().count(), 1, "{message}");
    }
    fs::remove_dir_all(folder).unwrap();
    let help = Command::new(env!("CARGO_BIN_EXE_sscc-checker")).arg("--help").output().unwrap();
    assert_eq!((help.status.code(), help.stderr.len()), (Some(0), 0));
    assert!(help.stdout.starts_with(b"usage: sscc-checker "));
}

#[test]
fn a_closed_pipe_leaves_the_exit_code() {
    for (args, code) in [(&["--help"][..], 0), (&[], 2)] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut command = Command::new(env!("CARGO_BIN_EXE_sscc-checker"));
        command.args(args).stdout(writer.try_clone().unwrap()).stderr(writer);
        assert_eq!(command.status().unwrap().code(), Some(code), "{args:?}");
    }
}

#[test]
#[cfg(target_os = "linux")]
fn an_answer_that_cannot_be_written_is_an_error() {
    for args in [&["--help"][..], &[]] {
        let full = || fs::File::options().write(true).open("/dev/full").unwrap();
        let mut command = Command::new(env!("CARGO_BIN_EXE_sscc-checker"));
        command.args(args).stdout(full()).stderr(full());
        assert_eq!(command.status().unwrap().code(), Some(2), "{args:?}");
    }
}
