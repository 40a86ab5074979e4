//! The commands of `docs/c.md`, and the answers of the examples in C and C++.

use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::checks::Checks;
use super::packages::{BUILD_PROGRAMS, EIGEN_PACKAGE};

/// Beginning of a command in `docs/c.md` that the command of this build replaces.
const BUILT: &str = "cargo run --release -- ";

/// Runs all checks. Skips the example `eigen_maps` if Eigen is not installed.
pub fn run(checks: &mut Checks) {
    checks.check("commands of docs/c.md", &BUILD_PROGRAMS, commands);
    checks.check("spring.cpp answers as the command", &BUILD_PROGRAMS, spring);
    checks.check("check_mesh.c answers as the command", &BUILD_PROGRAMS, meshes);
    checks.check("the program of docs/c.md", &BUILD_PROGRAMS, program);
    if checks.root.join("target/c/eigen_maps").exists() {
        checks.check("eigen_maps.cpp", &BUILD_PROGRAMS, eigen_maps);
    } else {
        let reason = format!("it was not built: Eigen is not installed (Debian's {EIGEN_PACKAGE})");
        checks.skip("eigen_maps.cpp", &reason);
    }
}

/// Returns the only block of a language in `docs/c.md`.
fn block(checks: &Checks, language: &str) -> Result<String, String> {
    let text = fs::read_to_string(checks.root.join("docs/c.md")).map_err(|e| format!("docs/c.md: {e}"))?;
    let fence = format!("```{language}\n");
    let (_, rest) = text.split_once(&fence).ok_or_else(|| format!("docs/c.md has no block of {language}"))?;
    Ok(rest.split_once("```").ok_or("docs/c.md: a block without an end")?.0.to_owned())
}

fn command(checks: &Checks) -> PathBuf {
    checks.commands.join("sscc")
}

/// Runs the commands as shown, with the command and the libraries of this build.
fn commands(checks: &Checks) -> Result<(), String> {
    // CMake keeps the answers to an earlier configuration.
    let _ = fs::remove_dir_all(checks.root.join("target/c"));
    let block = block(checks, "sh")?;
    let lines: Vec<&str> = block.lines().filter(|line| !line.is_empty()).collect();
    if lines.len() != 4 {
        return Err(format!("docs/c.md has {} commands, 4 were expected", lines.len()));
    }
    for line in lines {
        let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let (program, arguments) = match line.strip_prefix(BUILT) {
            Some(rest) => (command(checks), words(rest)),
            None => {
                let mut all = words(line);
                (PathBuf::from(all.remove(0)), all)
            }
        };
        let program = if program.starts_with("target") { checks.root.join(program) } else { program };
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        checks.succeed(&checks.root, &program, &arguments)?;
    }
    Ok(())
}

/// Checks that the example prints the lines of the command, byte for byte, without the fields that it does not print.
fn spring(checks: &Checks) -> Result<(), String> {
    let demo = checks.root.join("target/demo");
    let found = checks.succeed(&checks.root, &checks.root.join("target/c/spring"), &["target/demo"])?;
    let arguments = ["check", "spring.model.safetensors", "--certificates", "spring.sscc.safetensors"];
    let arguments = [&arguments[..], &["--trajectory", "spring.npy", "--json"]].concat();
    let (_, text) = checks.output(&demo, &command(checks), &arguments)?;
    let wanted: String = text.lines().map(|line| printed_fields(line) + "\n").collect();
    if wanted.lines().count() < 50 || !wanted.contains("\"colliding\":true") {
        return Err(format!("the motion of the demo shows too little:\n{wanted}"));
    }
    if found == wanted { Ok(()) } else { Err(format!("printed:\n{found}wanted:\n{wanted}")) }
}

/// Returns a line of `check --json` with the fields that the example `spring` prints.
fn printed_fields(line: &str) -> String {
    let without = |text: String, field: &str| match text.split_once(&format!("\"{field}\":")) {
        Some((before, rest)) => {
            let after = rest.split_once(',').map_or("", |(_, after)| after);
            format!("{before}{after}")
        }
        None => text,
    };
    let line = without(without(line.to_owned(), "norm"), "microseconds");
    line.split(",\"opened\"").next().unwrap_or_default().to_owned() + "}"
}

/// Checks that the example `check_mesh` answers like the command, for a mesh that is free and for one that collides, and that it
/// refuses a face of four corners.
fn meshes(checks: &Checks) -> Result<(), String> {
    let crossing = checks.folder.join("crossing.obj");
    let text = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 1 1 -1\nv 1 1 2\nv 2 1 2\nv 0 1 1\nv 4 1 1\nv 1 2 1\n\
                f 1 2 3\nf 4/1/1 5/2/2 6/3/3\nf 7 8 9\n";
    fs::write(&crossing, text).map_err(|e| e.to_string())?;
    for (mesh, is_free) in [(checks.root.join("target/demo/spring.obj"), true), (crossing, false)] {
        let mesh = mesh.to_string_lossy().into_owned();
        let (code, found) =
            checks.output(&checks.root, &checks.root.join("target/c/check_mesh"), &[&mesh])?;
        let (wanted_code, json) =
            checks.output(&checks.root, &command(checks), &["check", &mesh, "--json"])?;
        let answer: Value = serde_json::from_str(&json).map_err(|e| format!("{e}: {json}"))?;
        let pairs = answer["pairs"].as_array().ok_or("no pairs")?;
        let wanted: String = pairs.iter().map(|pair| format!("{} {}\n", pair[0], pair[1])).collect();
        if (code, &found) != (wanted_code, &wanted) || is_free != (code == 0) {
            return Err(format!(
                "{mesh}: exit code {code}, {found:?}; the command: {wanted_code}, {wanted:?}"
            ));
        }
    }
    let square = checks.folder.join("square.obj");
    fs::write(&square, "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n").map_err(|e| e.to_string())?;
    let check_mesh = checks.root.join("target/c/check_mesh");
    let outcome = checks.succeed(&checks.root, &check_mesh, &[&square.to_string_lossy()]);
    match outcome {
        Err(text) if text.ends_with("square.obj: a face is not a triangle\n") => Ok(()),
        other => Err(format!("a face of four corners was not refused: {other:?}")),
    }
}

/// Checks that matrices in both orders of storage have the same answer.
fn eigen_maps(checks: &Checks) -> Result<(), String> {
    let found = checks.succeed(&checks.root, &checks.root.join("target/c/eigen_maps"), &[])?;
    let wanted = "at rest: 0 pairs\nat q: 0 1\ndetector: 1 pairs\n";
    if found == wanted { Ok(()) } else { Err(format!("printed {found:?}, not {wanted:?}")) }
}

/// Checks that the program that `docs/c.md` shows compiles without a warning, and prints the text that the document states.
fn program(checks: &Checks) -> Result<(), String> {
    let folder = checks.folder.join("shown");
    fs::create_dir_all(&folder).map_err(|e| e.to_string())?;
    fs::write(folder.join("main.cpp"), block(checks, "cpp")?).map_err(|e| e.to_string())?;
    fs::write(folder.join("CMakeLists.txt"), block(checks, "cmake")?).map_err(|e| e.to_string())?;
    let prefix = format!("-DCMAKE_PREFIX_PATH={}", checks.folder.join("prefix").display());
    let options = [&prefix, "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror -pedantic"];
    checks.cmake(&folder.to_string_lossy(), &folder.join("build"), &options)?;
    let found = checks.succeed(Path::new("."), &folder.join("build/program"), &[])?;
    let wanted = block(checks, "text")?;
    if found == wanted { Ok(()) } else { Err(format!("printed {found:?}, not {wanted:?}")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_that_the_example_does_not_print_are_removed() {
        let line =
            "{\"index\":1,\"norm\":0.2,\"count\":0,\"microseconds\":0.5,\"proof\":\"radius\",\"opened\":0}";
        assert_eq!(printed_fields(line), "{\"index\":1,\"count\":0,\"proof\":\"radius\"}");
    }
}
