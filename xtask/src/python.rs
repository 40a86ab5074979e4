//! `cargo xtask python`: builds the wheel of the Python package, installs it into a virtual environment and runs the
//! tests there.
//!
//! The environment is `python/.venv`. The task creates it again when the requirements or the interpreter change.
//! `SSCC_PYTHON` names the interpreter; the default is `python3`. The tests are skipped without an interpreter of version
//! 3.11 or later, or without the packages, which are downloaded once.

use std::env;
use std::fs;
use std::path::Path;
use std::process::{Command, ExitCode};

use crate::environment::{Failure, environment, files, pip, succeed};
use crate::program::{build_from_nothing, cargo, run_and_forward};
use crate::tally::{SkipLog, Tally};

/// The file with the requirements of tests, in the folder of a package.
const REQUIREMENTS: &str = "requirements-test.txt";

/// The feature that gives dependencies the same features as in the other tests, so that they are compiled once.
const SHARED: &str = "shared-dependencies";

/// Runs the tests with these arguments for pytest.
pub fn run(arguments: &[String]) -> ExitCode {
    let log = SkipLog::new();
    let tally = test(arguments, log.path(), false);
    log.conclude(tally)
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
    let python = environment(&package.join(".venv"), &package.join(REQUIREMENTS))?;
    let wheels = package.join(".venv/wheels");
    let _ = fs::remove_dir_all(&wheels);
    // The profile is that of the other tests.
    let mut maturin = Command::new(&python);
    build_from_nothing(&mut maturin);
    maturin.args(["-m", "maturin", "build", "--profile", "dev", "--features", SHARED]);
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
    // pytest runs one process for each core.
    let mut tally = pytest(&python, &["--numprocesses=auto".to_owned()])?;
    // A separate environment: Blender as a module needs one version of Python and of NumPy.
    let blender = package.join("blender");
    tally += match environment(&blender.join(".venv"), &blender.join(REQUIREMENTS)) {
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::program::root;

    /// Returns all packages of a build with their features, including packages of macros.
    fn packages(arguments: &[&str]) -> BTreeSet<String> {
        let mut tree = cargo();
        tree.args(["tree", "--locked", "--prefix", "none", "--format", "{p} {f}"]);
        let output = tree.args(arguments).current_dir(root()).output().expect("cargo runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let lines = String::from_utf8_lossy(&output.stdout);
        lines.lines().map(|line| line.trim_end_matches(" (*)").to_owned()).collect()
    }

    /// The test fails if a package that a macro is compiled with had other features: then all code that uses the macro would
    /// be compiled twice.
    #[test]
    fn the_wheel_has_the_features_of_the_other_tests() {
        let of_wheel = packages(&["--package", "sscc-python", "--features", SHARED]);
        let of_tests = packages(&["--workspace"]);
        let others: Vec<&String> =
            of_wheel.difference(&of_tests).filter(|line| !line.starts_with("sscc-python ")).collect();
        assert!(others.is_empty(), "enable their features in `{SHARED}` of python/Cargo.toml: {others:?}");
    }
}
