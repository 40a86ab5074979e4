//! `cargo xtask extension`: packs the Blender add-on with wheels into an extension: a zip file in `target/extension`, which
//! Blender installs. Without arguments it uses the wheel of `cargo xtask wheel`.
//!
//! Where Blender as a module is installed (`cargo xtask python` installs it), Blender's own tool validates the file.

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use crate::environment::{Failure, environment, files};
use crate::program::{exit_code, output, root, succeed, usage};

/// Finds Blender's tool for extensions beside the module `bpy`, without starting Blender.
const TOOL: &str = "import importlib.util, pathlib; \
    print(*pathlib.Path(importlib.util.find_spec('bpy').origin).parent.glob('*/scripts/addons_core/bl_pkg/cli/blender_ext.py'))";

/// Packs and validates the extension.
pub fn run(arguments: &[String]) -> ExitCode {
    if arguments.iter().any(|argument| argument.starts_with('-')) {
        return usage("extension [WHEEL ...]    (by default the wheel of cargo xtask wheel)");
    }
    exit_code(pack(arguments))
}

fn pack(arguments: &[String]) -> Result<(), String> {
    let wheels: Vec<PathBuf> = match arguments {
        [] => {
            let all = files(&root().join("target/wheel/dist"));
            // Blender has no build for Linux on ARM.
            all.into_iter().filter(|path| !path.to_string_lossy().ends_with("_aarch64.whl")).collect()
        }
        _ => arguments.iter().map(PathBuf::from).collect(),
    };
    let wheels: Vec<_> =
        wheels.iter().filter(|path| path.extension().is_some_and(|end| end == "whl")).collect();
    if wheels.is_empty() {
        return Err("there is no wheel: run cargo xtask wheel first, or name wheels".to_owned());
    }
    let blender = root().join("python/blender");
    let python = environment(&blender.join(".venv"), &blender.join("requirements-test.txt"));
    let python = python.map_err(Failure::into_line)?;
    let mut build = Command::new(&python);
    build
        .arg(blender.join("build_extension.py"))
        .arg("--out")
        .arg(root().join("target/extension"))
        .args(wheels);
    let extension = output(&mut build, "the extension cannot be packed")?;
    print!("{extension}");
    validate(&python, Path::new(extension.trim()))
}

fn validate(python: &Path, extension: &Path) -> Result<(), String> {
    let tool = output(Command::new(python).args(["-c", TOOL]), "Blender as a module is not installed")?;
    let mut validate = Command::new(python);
    validate.arg(tool.trim()).arg("validate").arg(extension);
    succeed(&mut validate, "Blender refuses the extension")
}
