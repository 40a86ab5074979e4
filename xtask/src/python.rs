//! `cargo xtask python`: builds the wheel of the Python package, installs it into a virtual environment and runs the
//! tests there.
//!
//! The environment is `python/.venv`. The task makes it anew when the requirements or the interpreter change.
//! `SSCC_PYTHON` names the interpreter; the default is `python3`. The tests are skipped without an interpreter of
//! version 3.11 or later, or without the packages, which are downloaded once.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use crate::program::{build_from_nothing, cargo, run_and_forward};
use crate::tally::{SkipLog, Tally};

/// The oldest supported version of Python.
const MIN_PYTHON: (u32, u32) = (3, 11);

/// Runs the tests with these arguments for pytest.
pub fn run(arguments: Vec<String>) -> ExitCode {
    let log = SkipLog::new();
    let tally = test(&arguments, log.path(), false);
    log.conclude(tally)
}

/// The reason why there are no results.
enum Failure {
    /// Software that the tests need is missing.
    Missing(String),
    /// The package cannot be built or tested.
    Broken(String),
}

/// Builds and tests the package, and returns the counts. Logs missing software as skipped tests.
pub fn test(arguments: &[String], log: &Path, is_command_built: bool) -> Tally {
    println!("== Python package");
    match build_and_test(arguments, log, is_command_built) {
        Ok(tally) => tally,
        Err(Failure::Missing(why)) => SkipLog::skip(log, "all tests of the Python package", &why),
        Err(Failure::Broken(why)) => {
            println!("error: {why}");
            Tally::BROKEN
        }
    }
}

fn build_and_test(arguments: &[String], log: &Path, is_command_built: bool) -> Result<Tally, Failure> {
    let package = Path::new(env!("CARGO_MANIFEST_DIR")).join("../python");
    let package = package.canonicalize().map_err(|error| Failure::Broken(format!("python/: {error}")))?;
    let python = environment(&package)?;
    let wheels = package.join(".venv/wheels");
    let _ = fs::remove_dir_all(&wheels);
    // The profile and the features of the other tests, so that dependencies are compiled once.
    let mut maturin = Command::new(&python);
    build_from_nothing(&mut maturin);
    maturin.args(["-m", "maturin", "build", "--profile", "dev", "--features", "shared-dependencies"]);
    maturin.arg("--interpreter").arg(&python);
    maturin.arg("--out").arg(&wheels).current_dir(&package);
    succeed(&mut maturin, "the wheel cannot be built")?;
    install(&python, &wheels)?;
    if !is_command_built {
        let mut build = cargo();
        build.args(["build", "--package", "sscc-cli", "--bin", "sscc"]);
        succeed(&mut build, "the command cannot be built")?;
    }
    let command =
        env::current_exe().ok().map(|xtask| xtask.with_file_name(format!("sscc{}", env::consts::EXE_SUFFIX)));

    let pytest = |python: &Path, tests: &[String]| {
        let mut pytest = Command::new(python);
        // -P: Python imports the installed package, not the sources beside the tests.
        pytest.args(["-P", "-m", "pytest"]).args(tests).current_dir(&package).env("SSCC_SKIP_LOG", log);
        if let Some(command) = command.as_ref().filter(|path| path.is_file()) {
            pytest.env("SSCC_COMMAND", command);
        }
        let mut tally = Tally::default();
        let success = run_and_forward(&mut pytest, |line| tally.add_pytest(line))
            .map_err(|error| Failure::Broken(format!("pytest cannot be run: {error}")))?;
        if !success && tally.failed == 0 {
            println!("error: pytest did not run to its end (see above)");
            tally.failed = 1;
        }
        Ok(tally)
    };
    if !arguments.is_empty() {
        return pytest(&python, arguments);
    }
    // One process for each core.
    let mut tally = pytest(&python, &["--numprocesses=auto".to_owned()])?;
    // A separate environment: Blender as a module needs one version of Python and of NumPy.
    tally += match environment(&package.join("blender")) {
        Ok(python) => {
            install(&python, &wheels)?;
            pytest(&python, &["blender/tests".to_owned()])?
        }
        Err(Failure::Missing(why)) => SkipLog::skip(log, "all tests of the Blender add-on", &why),
        Err(broken) => return Err(broken),
    };
    Ok(tally)
}

/// Installs the wheel into an environment.
fn install(python: &Path, wheels: &Path) -> Result<(), Failure> {
    let mut install = pip(python);
    install.args(["install", "--quiet", "--no-deps", "--no-index", "--force-reinstall"]).args(files(wheels));
    succeed(&mut install, "the wheel cannot be installed")
}

/// Returns the interpreter of the virtual environment. Makes the environment if none exists for these requirements.
fn environment(package: &Path) -> Result<PathBuf, Failure> {
    let outside = env::var_os("SSCC_PYTHON").unwrap_or_else(|| "python3".into());
    let shown = outside.to_string_lossy().into_owned();
    let version =
        "import sys, platform; print(*sys.version_info[:2], platform.python_version(), sys.executable)";
    let version_text = Command::new(&outside).args(["-c", version]).output();
    let version_text = version_text.map_err(|error| Failure::Missing(format!("{shown}: {error}")))?;
    let version_text = String::from_utf8_lossy(&version_text.stdout).trim().to_owned();
    let mut numbers = version_text.split(' ').map(|word| word.parse::<u32>().unwrap_or(0));
    if (numbers.next().unwrap_or(0), numbers.next().unwrap_or(0)) < MIN_PYTHON {
        let (major, minor) = MIN_PYTHON;
        return Err(Failure::Missing(format!(
            "{shown} is not Python {major}.{minor} or later; name one in SSCC_PYTHON"
        )));
    }

    let requirements = package.join("requirements-test.txt");
    let wanted = fs::read_to_string(&requirements)
        .map_err(|error| Failure::Broken(format!("{}: {error}", requirements.display())))?;
    let (folder, stamp) = (package.join(".venv"), format!("{version_text}\n{wanted}"));
    let python = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let made_for = folder.join("made-for.txt");
    if fs::read_to_string(&made_for).is_ok_and(|made_for| made_for == stamp) && python.is_file() {
        return Ok(python);
    }
    println!("making {} (packages are downloaded once)", folder.display());
    let missing = |failure| match failure {
        Failure::Broken(why) => Failure::Missing(why),
        missing => missing,
    };
    succeed(
        Command::new(&outside).args(["-m", "venv", "--clear"]).arg(&folder),
        "no virtual environment can be made",
    )
    .map_err(missing)?;
    let mut install = pip(&python);
    install.args(["install", "--quiet", "--requirement"]).arg(&requirements);
    succeed(&mut install, "the packages that the tests need cannot be installed").map_err(missing)?;
    fs::write(&made_for, stamp)
        .map_err(|error| Failure::Broken(format!("{}: {error}", made_for.display())))?;
    Ok(python)
}

fn pip(python: &Path) -> Command {
    let mut pip = Command::new(python);
    pip.args(["-m", "pip", "--disable-pip-version-check", "--no-input"]);
    pip
}

fn files(folder: &Path) -> Vec<PathBuf> {
    fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect()
}

fn succeed(command: &mut Command, failure: &str) -> Result<(), Failure> {
    match run_and_forward(command, |_| {}) {
        Ok(true) => Ok(()),
        Ok(false) => Err(Failure::Broken(format!("{failure} (see above)"))),
        Err(error) => Err(Failure::Broken(format!("{failure}: {error}"))),
    }
}
