//! Runs the command as a child process, on small files.

pub mod solids;

use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// The result of a run.
#[derive(Debug)]
pub struct Run {
    pub args: Vec<String>,
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

/// Returns the command, not yet started.
pub fn command(folder: &Path, args: &[impl AsRef<OsStr>]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sscc"));
    command.args(args).current_dir(folder).stdin(Stdio::null());
    command
}

/// Runs the command in a folder.
pub fn sscc(folder: &Path, args: &[impl AsRef<OsStr>]) -> Run {
    Run::of(&mut command(folder, args))
}

impl Run {
    /// Runs a command to its end.
    pub fn of(command: &mut Command) -> Self {
        let output = command.output().unwrap();
        Self {
            args: command.get_args().map(|arg| arg.to_string_lossy().into_owned()).collect(),
            code: output.status.code(),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Returns the JSON objects on standard output, one a line.
    pub fn json(&self) -> Vec<Value> {
        self.stdout.lines().map(|line| serde_json::from_str(line).expect(line)).collect()
    }

    /// Asserts exit code 2, an empty standard output, and one line on standard error that names each file at most once.
    /// Returns that line.
    pub fn refusal(&self) -> &str {
        assert_eq!((self.code, self.stdout.as_str()), (Some(2), ""), "{self:?}");
        let message = self.stderr.strip_suffix('\n').unwrap();
        assert!(message.starts_with("error: ") && !message.contains(['\n', '\r']), "{message}");
        // An argument with an extension is a file. A name that is only an extension is also part of other words.
        let is_file = |value: &&str| Path::new(value).extension().is_some() && !value.starts_with('.');
        let values = self.args.iter().map(|arg| arg.split_once('=').map_or(arg.as_str(), |(_, value)| value));
        for file in values.filter(is_file) {
            assert!(message.matches(file).count() <= 1, "'{file}' more than once: {message}");
        }
        message
    }
}

/// Returns the keys of an object, sorted.
pub fn keys(object: &Value) -> Vec<&str> {
    let mut keys: Vec<&str> = object.as_object().unwrap().keys().map(String::as_str).collect();
    keys.sort_unstable();
    keys
}

/// Returns the words of a text, sorted.
pub fn sorted(words: &str) -> Vec<&str> {
    let mut words: Vec<&str> = words.split([',', ' ']).filter(|w| !w.is_empty()).collect();
    words.sort_unstable();
    words
}

/// Creates a folder with a small model: two parallel strips of triangles, one above the other.
///
/// `mesh.obj`, `modes.npy` (rank 2: mode 0 lowers the upper strip, mode 1 shifts it along), the two as
/// `strips.model.safetensors`, and `strips.sscc.safetensors`. They are 1 apart: the shape collides from
/// q_0 = 1 on.
pub fn strips() -> TempDir {
    let directory = tempfile::tempdir().unwrap();
    let folder = directory.path();
    fs::write(folder.join("mesh.obj"), obj()).unwrap();
    let modes: Vec<f64> = (0..2 * STRIP)
        .flat_map(|v| if v < STRIP { [0.0; 6] } else { [0.0, 1.0, 0.0, 0.0, -1.0, 0.0] })
        .collect();
    sscc_io::write_npy(&folder.join("modes.npy"), &[6 * STRIP, 2], &modes).unwrap();
    let (model, info) =
        sscc_io::load_model(&folder.join("mesh.obj"), Some(&folder.join("modes.npy"))).unwrap();
    sscc_io::write_model(&folder.join("strips.model.safetensors"), &model, &info).unwrap();
    let run = sscc(folder, &["certify", "strips.model.safetensors", "-o", "strips.sscc.safetensors"]);
    assert_eq!(run.code, Some(0), "{run:?}");
    directory
}

/// Vertices of a strip.
pub const STRIP: usize = 12;

fn obj() -> String {
    let vertex = |i: usize, z: f64| format!("v {} {} {z}\n", i / 2, i % 2);
    let face = |first: usize, i: usize| format!("f {} {} {}\n", first + i, first + i + 1, first + i + 2);
    let vertices = [0.0, 1.0].map(|z| (0..STRIP).map(|i| vertex(i, z)).collect::<String>());
    let faces = [1, 1 + STRIP].map(|first| (0..STRIP - 2).map(|i| face(first, i)).collect::<String>());
    vertices.concat() + &faces.concat()
}

/// The data of a report.
pub fn page_data(html: &str) -> Value {
    let (_, data) = html.split_once("id=\"sscc-report\">").unwrap();
    serde_json::from_str(data.split_once("</script>").unwrap().0).unwrap()
}

/// Returns the files of a folder, sorted.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.sort();
    files
}
