//! `cargo xtask page`: builds the page from `viewer/`, and compares it with the page that is checked in. With `--test` it
//! also runs the page's tests in a browser.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};

use crate::debian;
use crate::program::{cargo, run_and_forward};
use crate::tally::{SkipLog, Tally};

/// The oldest Node that Vite supports (see `engines` in `viewer/package.json`).
const MIN_NODE: (u32, u32) = (20, 19);

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn checked_in() -> PathBuf {
    root().join("crates/sscc-view/page/index.html")
}

/// Runs the task, and returns its exit code.
pub fn run(arguments: &[String]) -> ExitCode {
    let write = match arguments {
        [] => false,
        [flag] if flag == "--write" => true,
        [flag] if flag == "--test" => {
            let log = SkipLog::new();
            let tally = test(log.path(), false);
            return log.conclude(tally);
        }
        _ => {
            eprintln!(
                "Usage: cargo xtask page [--write | --test]    (--write replaces the page that is checked in)"
            );
            return ExitCode::from(2);
        }
    };
    let result = node()
        .and_then(|()| install())
        .and_then(|()| build())
        .and_then(|built| if write { replace(&built) } else { compare(&built) });
    match result {
        Ok(line) => {
            println!("{line}");
            ExitCode::SUCCESS
        }
        Err(line) => {
            eprintln!("error: {line}");
            ExitCode::FAILURE
        }
    }
}

/// Tests that the sources build the page that is checked in, and runs the page's tests in a browser.
pub fn test(log: &Path, is_command_built: bool) -> Tally {
    println!("== Page");
    if let Err(reason) = node().and_then(|()| install()) {
        return SkipLog::skip(log, "the page and its tests", &reason);
    }
    let broken = |line: String| {
        println!("error: {line}");
        Tally::BROKEN
    };
    let mut tally = Tally { passed: 1, failed: 0 };
    match build().and_then(|built| compare(&built)) {
        Ok(line) => println!("{line}"),
        Err(line) => return broken(line),
    }
    tally += match chromium(SkipLog::is_strict()) {
        Ok(()) => browser_tests(is_command_built).unwrap_or_else(broken),
        Err(reason) => SkipLog::skip(log, "the page's tests in a browser", &reason),
    };
    tally
}

/// Checks that Node is installed and new enough.
pub fn node() -> Result<(), String> {
    let output = Command::new("node").arg("--version").output();
    let output =
        output.map_err(|_| format!("Node {}.{} or newer is not installed", MIN_NODE.0, MIN_NODE.1))?;
    let text = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    let mut numbers = text.trim_start_matches('v').split('.').map_while(|n| n.parse::<u32>().ok());
    let version = (numbers.next().unwrap_or(0), numbers.next().unwrap_or(0));
    if version < MIN_NODE {
        return Err(format!("Node is {text}; {}.{} or newer is needed", MIN_NODE.0, MIN_NODE.1));
    }
    Ok(())
}

/// Runs npm in `viewer/`.
fn npm(arguments: &[&str]) -> Result<(), String> {
    let status =
        Command::new("npm").args(arguments).current_dir(root().join("viewer")).stdin(Stdio::null()).status();
    match status {
        Ok(status) if status.success() => Ok(()),
        Ok(_) => Err(format!("`npm {}` failed in viewer/ (see above)", arguments.join(" "))),
        Err(error) => Err(format!("npm cannot be run: {error}")),
    }
}

/// Checks that a browser and the program that drives it are installed. With `install`, tries to install a browser.
pub fn browser(install: bool) -> Result<(), String> {
    self::install().and_then(|()| chromium(install))
}

/// Installs the packages of the lock file, if they are not installed.
fn install() -> Result<(), String> {
    let viewer = root().join("viewer");
    let lock =
        fs::read(viewer.join("package-lock.json")).map_err(|e| format!("viewer/package-lock.json: {e}"))?;
    let stamp = viewer.join("node_modules/.installed-lock");
    if fs::read(&stamp).ok().as_deref() != Some(lock.as_slice()) {
        // `npm ci` would need every platform's optional packages from the registry.
        npm(&["install", "--no-save", "--no-audit", "--no-fund"])?;
        fs::write(&stamp, &lock).map_err(|e| format!("{}: {e}", stamp.display()))?;
    }
    Ok(())
}

/// Checks types and style, and builds the page. Returns the path of the built file.
fn build() -> Result<PathBuf, String> {
    npm(&["run", "--silent", "check"])?;
    npm(&["run", "--silent", "build"])?;
    Ok(root().join("viewer/dist/index.html"))
}

fn read(path: &Path) -> Result<Vec<u8>, String> {
    fs::read(path).map_err(|e| format!("{}: {e}", path.display()))
}

fn compare(built: &Path) -> Result<String, String> {
    let page = read(built)?;
    if read(&checked_in())? != page {
        return Err(
            "crates/sscc-view/page/index.html differs from the page that viewer/ builds; `cargo xtask page --write` \
                    replaces it"
                .into(),
        );
    }
    Ok(format!("the page equals the one that viewer/ builds: {} bytes", page.len()))
}

fn replace(built: &Path) -> Result<String, String> {
    let page = read(built)?;
    fs::write(checked_in(), &page).map_err(|e| format!("{}: {e}", checked_in().display()))?;
    Ok(format!("written: crates/sscc-view/page/index.html ({} bytes)", page.len()))
}

/// Checks that a Chromium is installed. With `install`, tries to install Debian's package.
fn chromium(install: bool) -> Result<(), String> {
    let places = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"];
    let is_installed =
        || env::var_os("SSCC_CHROMIUM").is_some() || places.iter().any(|place| Path::new(place).exists());
    if is_installed() {
        return Ok(());
    }
    if install && debian::install(&["chromium"]) && is_installed() {
        return Ok(());
    }
    Err("no Chromium found; install it, or name one in SSCC_CHROMIUM".into())
}

/// Runs the tests in `viewer/tests` with the command of this build.
fn browser_tests(is_command_built: bool) -> Result<Tally, String> {
    let build = || cargo().args(["build", "--package", "sscc-cli"]).current_dir(root()).status();
    if !is_command_built && !build().is_ok_and(|status| status.success()) {
        return Err("the command cannot be built for the page's tests".into());
    }
    // The command is in the folder of this program.
    let folder = env::current_exe().map_err(|e| e.to_string())?;
    let command = folder.with_file_name(format!("sscc{}", env::consts::EXE_SUFFIX));
    let mut tests = Command::new("npm");
    tests
        .args(["run", "--silent", "test"])
        .current_dir(root().join("viewer"))
        .env("SSCC_COMMAND", command)
        .stdin(Stdio::null());
    let mut text = String::new();
    let success = run_and_forward(&mut tests, |line| text.extend([line, "\n"]))
        .map_err(|e| format!("npm cannot be run: {e}"))?;
    Ok(tally(success, &text))
}

/// Returns the results of a run whose output is TAP.
pub fn tally(success: bool, text: &str) -> Tally {
    let mut tally = results(text);
    if !success && tally.failed == 0 {
        tally.failed = 1;
    }
    tally
}

/// Adds up the lines `# pass 3` and `# fail 0` of TAP, which `npm test` writes. Skipped and cancelled tests count as failed.
fn results(text: &str) -> Tally {
    let number = |line: &str, what: &str| line.strip_prefix(what)?.trim().parse::<u64>().ok();
    let count = |what: &str| text.lines().filter_map(|line| number(line, what)).sum::<u64>();
    Tally { passed: count("# pass "), failed: count("# fail ") + count("# cancelled ") + count("# skipped ") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_of_the_browser_tests_are_read() {
        let tally = results(
            "TAP version 13\nok 1 - a\n1..1\n# tests 5\n# pass 3\n# fail 1\n# cancelled 1\n# skipped 0\n",
        );
        assert_eq!((tally.passed, tally.failed), (3, 2));
    }
}
