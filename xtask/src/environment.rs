//! Virtual environments of Python, which are created again when their requirements or the interpreter change.
//!
//! `SSCC_PYTHON` names the interpreter; the default is `python3`.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::program::run_and_forward;

/// The oldest supported version of Python.
const MIN_PYTHON: (u32, u32) = (3, 11);

/// The reason for missing results.
pub enum Failure {
    /// Software that the task needs is missing.
    Missing(String),
    /// The package cannot be built or tested.
    Broken(String),
}

impl Failure {
    pub fn into_line(self) -> String {
        match self {
            Self::Missing(line) | Self::Broken(line) => line,
        }
    }
}

/// Returns the interpreter outside of all environments, and its version as text.
fn interpreter() -> Result<(PathBuf, String), Failure> {
    let outside = env::var_os("SSCC_PYTHON").unwrap_or_else(|| "python3".into());
    let shown = outside.to_string_lossy().into_owned();
    let version =
        "import sys, platform; print(*sys.version_info[:2], platform.python_version(), sys.executable)";
    let text = Command::new(&outside).args(["-c", version]).output();
    let text = text.map_err(|error| Failure::Missing(format!("{shown}: {error}")))?;
    let text = String::from_utf8_lossy(&text.stdout).trim().to_owned();
    let mut numbers = text.split(' ').map(|word| word.parse::<u32>().unwrap_or(0));
    if (numbers.next().unwrap_or(0), numbers.next().unwrap_or(0)) < MIN_PYTHON {
        let (major, minor) = MIN_PYTHON;
        return Err(Failure::Missing(format!(
            "{shown} is not Python {major}.{minor} or later; name one in SSCC_PYTHON"
        )));
    }
    Ok((outside.into(), text))
}

/// Returns the interpreter of the virtual environment in `folder`. Creates the environment if none exists for these requirements.
pub fn environment(folder: &Path, requirements: &Path) -> Result<PathBuf, Failure> {
    let (outside, version) = interpreter()?;
    let wanted = fs::read_to_string(requirements)
        .map_err(|error| Failure::Broken(format!("{}: {error}", requirements.display())))?;
    let stamp = format!("{version}\n{wanted}");
    let (python, made_for) = (python_of(folder), folder.join("made-for.txt"));
    if fs::read_to_string(&made_for).is_ok_and(|made_for| made_for == stamp) && python.is_file() {
        return Ok(python);
    }
    println!("making {} (packages are downloaded once)", folder.display());
    let missing = |failure| match failure {
        Failure::Broken(why) => Failure::Missing(why),
        missing => missing,
    };
    make(&outside, folder).map_err(missing)?;
    let mut install = pip(&python);
    install.args(["install", "--quiet", "--requirement"]).arg(requirements);
    succeed(&mut install, "the packages that the task needs cannot be installed").map_err(missing)?;
    fs::write(&made_for, stamp)
        .map_err(|error| Failure::Broken(format!("{}: {error}", made_for.display())))?;
    Ok(python)
}

/// Creates an environment without packages, and returns its interpreter.
pub fn empty_environment(folder: &Path) -> Result<PathBuf, Failure> {
    make(&interpreter()?.0, folder)?;
    Ok(python_of(folder))
}

fn make(outside: &Path, folder: &Path) -> Result<(), Failure> {
    succeed(
        Command::new(outside).args(["-m", "venv", "--clear"]).arg(folder),
        "no virtual environment can be made",
    )
}

/// Returns the folder of an environment's programs.
pub fn programs(folder: &Path) -> PathBuf {
    folder.join(if cfg!(windows) { "Scripts" } else { "bin" })
}

fn python_of(folder: &Path) -> PathBuf {
    programs(folder).join(if cfg!(windows) { "python.exe" } else { "python" })
}

pub fn pip(python: &Path) -> Command {
    let mut pip = Command::new(python);
    pip.args(["-m", "pip", "--disable-pip-version-check", "--no-input"]);
    pip
}

/// Returns the files in a folder, sorted.
pub fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<_> =
        fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    files.sort();
    files
}

pub fn succeed(command: &mut Command, failure: &str) -> Result<(), Failure> {
    match run_and_forward(command, |_| {}) {
        Ok(true) => Ok(()),
        Ok(false) => Err(Failure::Broken(format!("{failure} (see above)"))),
        Err(error) => Err(Failure::Broken(format!("{failure}: {error}"))),
    }
}
