//! `sscc-operators SOURCE EXCLUDED LIST FOLDERS`: puts wrong variants of all code in FOLDERS of SOURCE, the folder `src` of a
//! copy of the core, behind a switch, in place. A variant has another operator, no `-` or `!`, or a constant in place of
//! a function's body. `cargo xtask operators` then compiles all variants at once, and the environment variable `SSCC_VARIANT`
//! selects one.
//!
//! EXCLUDED has the numbers of variants that do not compile. LIST receives a line for each other variant: number, file,
//! line, function and change, with tabs between them.

mod instrument;
mod replacements;
#[cfg(test)]
mod switch;

use std::collections::BTreeSet;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use instrument::Instrument;

/// The module with the switch, which the core receives.
const SWITCH: &str = include_str!("switch.rs");

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [source, excluded, list, folders @ ..] = &words[..] else {
        eprintln!("error: usage: sscc-operators SOURCE EXCLUDED LIST FOLDERS");
        return ExitCode::from(2);
    };
    match run(Path::new(source), Path::new(excluded), Path::new(list), folders) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

fn run(source: &Path, excluded: &Path, list: &Path, folders: &[String]) -> Result<(), Box<dyn Error>> {
    let numbers = fs::read_to_string(excluded)?;
    let excluded: Result<BTreeSet<u32>, _> = numbers.split_whitespace().map(str::parse).collect();
    let mut instrument = Instrument::new(excluded?);
    for folder in folders {
        let mut files = Vec::new();
        collect(&source.join(folder), &mut files)?;
        files.sort();
        for path in files {
            let name = path.strip_prefix(source)?.to_string_lossy().into_owned();
            let mut file =
                syn::parse_file(&fs::read_to_string(&path)?).map_err(|error| format!("{name}: {error}"))?;
            instrument.file(&name, &mut file);
            fs::write(&path, prettyplease::unparse(&file))?;
        }
    }
    fs::write(source.join("switch.rs"), SWITCH)?;
    let root = source.join("lib.rs");
    fs::write(&root, fs::read_to_string(&root)? + "\nmod switch;\n")?;
    Ok(fs::write(list, instrument.lines().concat())?)
}

/// Adds a source file, or the source files below a folder, without those that only tests compile.
fn collect(path: &Path, files: &mut Vec<PathBuf>) -> Result<(), Box<dyn Error>> {
    if path.is_dir() {
        let skipped = test_modules(&path.join("mod.rs"))?;
        for entry in fs::read_dir(path)? {
            let path = entry?.path();
            if path.file_stem().is_none_or(|stem| !skipped.iter().any(|name| stem == name.as_str())) {
                collect(&path, files)?;
            }
        }
    } else if path.extension().is_some_and(|extension| extension == "rs") {
        files.push(path.into());
    }
    Ok(())
}

/// Returns the names of the modules that only tests compile: `tests`, and those that a file, if it exists, declares so.
fn test_modules(file: &Path) -> Result<Vec<String>, Box<dyn Error>> {
    let mut names = vec!["tests".to_owned()];
    if file.exists() {
        let items = syn::parse_file(&fs::read_to_string(file)?)?.items;
        names.extend(items.iter().filter_map(|item| match item {
            syn::Item::Mod(module) if instrument::is_test(&module.attrs) => Some(module.ident.to_string()),
            _ => None,
        }));
    }
    Ok(names)
}
