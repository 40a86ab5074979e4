//! Checks that run programs, and their counts.

use std::env;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use super::packages::skip_reason;
use crate::debian;
use crate::program::cargo;
use crate::tally::{SkipLog, Tally};

/// The counts of checks, and the paths that checks use.
pub struct Checks {
    pub tally: Tally,
    /// The file to which skipped checks add a line.
    log: PathBuf,
    /// The root of the project.
    pub root: PathBuf,
    /// The folder of the command.
    pub commands: PathBuf,
    /// The folder of the libraries.
    pub libraries: PathBuf,
    /// An empty folder for builds.
    pub folder: PathBuf,
}

impl Checks {
    pub fn new(log: &Path, is_built: bool) -> Result<Self, String> {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let root = root.canonicalize().map_err(|e| e.to_string())?;
        let build = || {
            cargo()
                .args(["build", "--package", "sscc-c", "--package", "sscc-cli"])
                .current_dir(&root)
                .status()
        };
        if !is_built && !build().is_ok_and(|status| status.success()) {
            return Err("the library or the command cannot be built".into());
        }
        // Cargo writes both into the folder of this program.
        let commands = env::current_exe().map_err(|e| e.to_string())?;
        let commands = commands.parent().ok_or("no folder of programs")?.to_owned();
        let (libraries, folder) = (commands.join("deps"), commands.join("c"));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        let (tally, log) = (Tally::default(), log.to_owned());
        Ok(Self { tally, log, root, commands, libraries, folder })
    }

    /// Runs and counts a check, and prints its name, its time and, if it failed, the reason. Skips it if a program that it
    /// needs is missing.
    pub fn check(&mut self, name: &str, needed: &[&str], check: impl FnOnce(&Self) -> Result<(), String>) {
        if let Some(reason) = skip_reason(needed, debian::has) {
            return self.skip(name, &reason);
        }
        let start = Instant::now();
        let result = check(self);
        let seconds = start.elapsed().as_secs_f64();
        match result {
            Ok(()) => {
                self.tally.passed += 1;
                println!("{name}: ok, {seconds:.1} s");
            }
            Err(why) => {
                self.tally.failed += 1;
                println!("{name}: FAILED\n{why}");
            }
        }
    }

    /// Counts and logs a skipped check.
    pub fn skip(&mut self, name: &str, reason: &str) {
        self.tally += SkipLog::skip(&self.log, name, reason);
    }

    /// Runs a program in a folder, with the libraries of cargo. Returns its exit code, 0 or 1, and its output.
    pub fn output(&self, folder: &Path, program: &Path, arguments: &[&str]) -> Result<(i32, String), String> {
        let (code, [out, err]) = self.run_program(folder, program, arguments)?;
        if (0..=1).contains(&code) {
            Ok((code, out))
        } else {
            Err(exited(program, arguments, code, [out, err]))
        }
    }

    /// Runs a program like [`Checks::output`]. Returns its exit code, its output and its messages.
    fn run_program(
        &self,
        folder: &Path,
        program: &Path,
        arguments: &[&str],
    ) -> Result<(i32, [String; 2]), String> {
        let mut command = Command::new(program);
        command.args(arguments).current_dir(folder).stdin(Stdio::null());
        command.env("SSCC_PREBUILT_DIR", &self.libraries).env("CARGO_TERM_COLOR", "never");
        let output = command.output().map_err(|e| format!("{}: {e}", program.display()))?;
        let texts = [output.stdout, output.stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
        Ok((output.status.code().unwrap_or(-1), texts))
    }

    /// Runs a program that must succeed, and returns its output.
    pub fn succeed(&self, folder: &Path, program: &Path, arguments: &[&str]) -> Result<String, String> {
        let (code, [out, err]) = self.run_program(folder, program, arguments)?;
        if code == 0 { Ok(out) } else { Err(exited(program, arguments, code, [out, err])) }
    }

    /// Configures and builds a project.
    pub fn cmake(&self, source: &str, build: &Path, options: &[&str]) -> Result<(), String> {
        let build = build.to_string_lossy();
        let cmake = Path::new("cmake");
        self.succeed(&self.root, cmake, &[&["-S", source, "-B", &build], options].concat())?;
        self.succeed(&self.root, cmake, &["--build", &build, "--parallel", "2"]).map(drop)
    }
}

/// Describes a program that failed.
fn exited(program: &Path, arguments: &[&str], code: i32, [out, err]: [String; 2]) -> String {
    format!("{} {}: exit code {code}\n{out}{err}", program.display(), arguments.join(" "))
}
