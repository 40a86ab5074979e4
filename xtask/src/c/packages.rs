//! The programs that checks need, and their Debian packages.

use std::path::Path;

use crate::debian;

/// Programs that checks need, and their Debian packages.
const PROGRAMS: [(&str, &str); 8] = [
    ("cmake", "cmake"),
    ("make", "make"),
    ("gcc", "gcc"),
    ("g++", "g++"),
    ("clang", "clang"),
    ("clang++", "clang"),
    ("valgrind", "valgrind"),
    ("pkg-config", "pkg-config"),
];

/// Programs that CMake needs to build programs.
pub const BUILD_PROGRAMS: [&str; 4] = ["cmake", "make", "gcc", "g++"];

/// The Debian package of Eigen, for an example and for assertions that are skipped without it.
pub const EIGEN_PACKAGE: &str = "libeigen3-dev";

/// The Debian package of clang's sanitizers. Debian's package of clang only recommends it.
const SANITIZERS_PACKAGE: &str = "libclang-rt-dev";

/// Installs the packages of all missing programs. Checks whose packages cannot be installed are skipped, and then count as
/// failed.
pub fn install_missing() {
    let missing = PROGRAMS.iter().filter(|(program, _)| !debian::has(program));
    let mut packages: Vec<&str> = missing.map(|(_, package)| *package).collect();
    if packages.contains(&"clang") {
        packages.push(SANITIZERS_PACKAGE);
    }
    if !Path::new("/usr/include/eigen3").exists() {
        packages.push(EIGEN_PACKAGE);
    }
    if !packages.is_empty() {
        debian::install(&packages);
    }
}

/// Returns the reason for which a check that needs these programs is skipped; None if the check can run.
pub fn skip_reason(needed: &[&str], has: impl Fn(&str) -> bool) -> Option<String> {
    let is_missing = |program: &&(&str, &str)| needed.contains(&program.0) && !has(program.0);
    let missing = PROGRAMS.iter().find(is_missing);
    missing.map(|(program, package)| format!("{program} is not installed (Debian's {package})"))
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::program::root;

    #[test]
    fn only_checks_whose_program_is_missing_are_skipped() {
        let has = |program: &str| program != "valgrind";
        assert_eq!(skip_reason(&BUILD_PROGRAMS, has), None);
        let needed = [&BUILD_PROGRAMS[..], &["valgrind"]].concat();
        let reason = skip_reason(&needed, has);
        assert_eq!(reason.as_deref(), Some("valgrind is not installed (Debian's valgrind)"));
        assert_eq!(skip_reason(&needed, |_| true), None);
    }

    #[test]
    fn the_workflow_installs_all_packages() {
        let text = fs::read_to_string(root().join(".github/workflows/test.yml")).unwrap();
        let line = text.lines().find(|line| line.contains("sudo apt-get install")).unwrap();
        let words: Vec<&str> = line.split_whitespace().collect();
        for package in PROGRAMS.iter().map(|(_, package)| *package).chain([EIGEN_PACKAGE, SANITIZERS_PACKAGE])
        {
            assert!(words.contains(&package), "{package}");
        }
    }
}
