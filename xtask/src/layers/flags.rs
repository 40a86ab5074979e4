//! Checks that libraries name no flags of the command. They name settings, and each front end has its own names for these. A
//! program (`main.rs`) is a front end.

use crate::sources::Crate;

/// Crates whose messages belong to the command and to the tasks.
const FRONT_ENDS: [&str; 4] = ["sscc-cli", "sscc-bench", "sscc-soundness", "xtask"];

/// Returns the places where a library names a flag.
pub fn flags(krate: &Crate) -> Vec<String> {
    if FRONT_ENDS.contains(&krate.name.as_str()) {
        return Vec::new();
    }
    let files = krate.files.iter().filter(|file| !file.path.ends_with("src/main.rs"));
    let lines = files.flat_map(|file| file.lines.iter().map(|line| (&file.path, line)));
    let violation = |(path, (number, line)): (&String, &(usize, String))| {
        let flag = flag_in(line)?;
        Some(format!(
            "{path}:{number}: a library names the flag {flag}: libraries name a setting (sscc_io::Setting)"
        ))
    };
    lines.filter_map(violation).collect()
}

/// Returns the first flag in a line of code without its comment. Flags occur only in string literals, as Rust has no operator
/// `--`.
fn flag_in(line: &str) -> Option<&str> {
    let code = line.split(" // ").next()?;
    let is_flag = |at: &usize| {
        !code[..*at].ends_with('-') && code[at + 2..].starts_with(|c: char| c.is_ascii_alphabetic())
    };
    let start = code.match_indices("--").map(|(at, _)| at).find(is_flag)?;
    let is_end = |c: char| !c.is_ascii_alphanumeric() && c != '-';
    code[start..].split(is_end).next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_are_found_only_in_string_literals() {
        assert_eq!(flag_in(r#"    "add --mesh-name=NAME","#), Some("--mesh-name"));
        assert_eq!(flag_in("    continued --q, --"), Some("--q"));
        for line in ["f(x); // --q", r#"    "<!-- a -- b -->""#, "a - -b", r#"    "------BEGIN""#] {
            assert_eq!(flag_in(line), None, "{line}");
        }
    }
}
