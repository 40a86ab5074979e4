//! Writes the demo's files, and lists commands to try on them.

use std::fmt::Write;
use std::path::Path;

use anyhow::Result;
use sscc::{Certificates, TriMesh};
use sscc_io::{ModelInfo, Rows, write_certificates, write_model, write_npy, write_whole};
use sscc_modes::shapes::ElasticShape;

const MESH: &str = "spring.obj";
const MODEL: &str = "spring.model.safetensors";
const CERTIFICATES: &str = "spring.sscc.safetensors";
const ANIMATION: &str = "spring.npy";
const REPORT: &str = "report.html";

/// Writes the five files.
pub fn save(
    folder: &Path,
    spring: ElasticShape,
    certificates: &Certificates,
    animation: &Rows,
    page: &str,
) -> Result<()> {
    let ElasticShape { model, elasticity } = spring;
    write_whole(&folder.join(MESH), to_obj(model.mesh()).as_bytes())?;
    let info = ModelInfo::new("m", "embedded double-helix spring, linear modes").with_elasticity(elasticity);
    write_model(&folder.join(MODEL), &model, &info)?;
    write_certificates(&folder.join(CERTIFICATES), certificates)?;
    write_npy(&folder.join(ANIMATION), &[animation.rows, animation.columns], &animation.data)?;
    write_whole(&folder.join(REPORT), page.as_bytes())?;
    Ok(())
}

/// Returns lines with the folder's files and commands that read them.
pub fn next_commands(folder: &Path) -> Vec<String> {
    let file = |name: &str| shell_word(&folder.join(name).to_string_lossy());
    let (model, certificates) = (file(MODEL), file(CERTIFICATES));
    // The name by which the user called the program, since it need not be on the path.
    let sscc = std::env::args_os().next().unwrap_or_else(|| "sscc".into());
    let sscc = shell_word(&sscc.to_string_lossy());
    vec![
        String::new(),
        format!(
            "Written to {}: {MESH}, {MODEL}, {CERTIFICATES}, {ANIMATION}, {REPORT}. Next:",
            folder.display()
        ),
        format!("  {sscc} view {model} --certificates {certificates}"),
        format!("  {sscc} info {certificates}"),
        format!("  {sscc} check {model} --certificates {certificates} --trajectory {}", file(ANIMATION)),
        format!("  {sscc} audit {model} --certificates {certificates} --samples 1000"),
        format!(
            "  {sscc} modes {} -o {} --kind linear --resolution 30",
            file(MESH),
            file("again.model.safetensors")
        ),
    ]
}

/// Returns an argument as a word of a shell: in quotes if it has characters that shells interpret.
fn shell_word(argument: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "/._-+,:@".contains(c) || cfg!(windows) && c == '\\';
    if !argument.is_empty() && argument.chars().all(is_plain) {
        argument.to_owned()
    } else if cfg!(windows) {
        format!("\"{argument}\"")
    } else {
        format!("'{}'", argument.replace('\'', r"'\''"))
    }
}

/// Returns the mesh as OBJ. Reading the numbers gives the same bits.
fn to_obj(mesh: &TriMesh) -> String {
    let mut text = String::new();
    for p in mesh.rest_positions() {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for [a, b, c] in mesh.faces() {
        let _ = writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1);
    }
    text
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn names_that_shells_interpret_are_in_quotes() {
        let lines = next_commands(Path::new("my demo"));
        let named = "'my demo/spring.model.safetensors' --certificates 'my demo/spring.sscc.safetensors'";
        assert!(lines[2].ends_with(&format!(" view {named}")), "{}", lines[2]);
        assert!(lines[4].ends_with(&format!("{named} --trajectory 'my demo/spring.npy'")), "{}", lines[4]);
        assert!(
            next_commands(Path::new("out/demo-1"))[3].ends_with(" info out/demo-1/spring.sscc.safetensors")
        );
        assert_eq!(["", "it's", "$HOME;", "a*"].map(shell_word), ["''", r"'it'\''s'", "'$HOME;'", "'a*'"]);
    }
}
