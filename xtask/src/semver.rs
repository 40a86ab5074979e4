//! `cargo xtask semver`: cargo-semver-checks compares the public items of the core with those of the last release, and says
//! whether the version may stay what it is. A revision of git as argument is compared in the place of the last release.
//!
//! `cargo xtask public` keeps a list of these items. It sees an item that goes, but no bound or argument that changes.

use std::process::{Command, ExitCode, Stdio};

use crate::program::{cargo, exit_code, output, root, succeed, usage};
use crate::tally::SkipLog;

/// Compares, where there is a release and the program that compares.
pub fn run(arguments: &[String]) -> ExitCode {
    let tags = || {
        let mut git = Command::new("git");
        git.args(["tag", "--list", "v*", "--sort=-version:refname"]).current_dir(root());
        output(&mut git, "git lists no tags")
    };
    let baseline = match arguments {
        [] => tags().map(|tags| last_release(&tags)),
        [revision] if !revision.starts_with('-') => Ok(Some(revision.clone())),
        _ => {
            return usage(
                "semver [REVISION]    (compares the public items of the core with the last release)",
            );
        }
    };
    match baseline {
        Ok(Some(baseline)) if is_installed() => exit_code(compare(&baseline)),
        Ok(Some(_)) => {
            let log = SkipLog::new();
            let why = "cargo-semver-checks is not installed: cargo install --locked cargo-semver-checks";
            let tally = SkipLog::skip(log.path(), "semver", why);
            log.conclude(tally)
        }
        Ok(None) => {
            println!("semver: nothing to compare with: no release has a tag v* yet");
            ExitCode::SUCCESS
        }
        Err(line) => exit_code(Err(line)),
    }
}

/// The highest version of a list of tags that git has sorted by it. A version of digits alone: one that is a candidate is no release.
fn last_release(tags: &str) -> Option<String> {
    let is_number = |part: &str| part.parse::<u32>().is_ok();
    let is_release =
        |tag: &&str| tag.strip_prefix('v').is_some_and(|version| version.split('.').all(is_number));
    tags.lines().find(is_release).map(str::to_owned)
}

fn is_installed() -> bool {
    let mut program = Command::new("cargo-semver-checks");
    program.args(["semver-checks", "--version"]).stdout(Stdio::null()).stderr(Stdio::null());
    program.status().is_ok_and(|status| status.success())
}

fn compare(baseline: &str) -> Result<(), String> {
    let mut command = cargo();
    // Of the features, `mutants` is for the tests of this project.
    command.args(["semver-checks", "check-release", "--package", "sscc", "--default-features"]);
    command.args(["--baseline-rev", baseline]).current_dir(root());
    succeed(&mut command, &format!("the version must say what changed since {baseline}"))
}

#[cfg(test)]
mod tests {
    use super::last_release;

    #[test]
    fn the_last_release_is_the_highest_version_without_a_suffix() {
        assert_eq!(last_release("v0.10.0-rc.1\nviewer\nv0.9.2\nv0.9.1\n").as_deref(), Some("v0.9.2"));
        assert_eq!(last_release("viewer\n"), None);
        assert_eq!(last_release(""), None);
    }
}
