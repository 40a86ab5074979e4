//! `cargo xtask lines`: counts the lines of Rust that make up the product.
//!
//! These are the lines of all crates, of the Python package and of these tasks, without comments, blank lines, items for tests
//! (`#[cfg(test)]`, `#[test]`) with their files, `tests/`, `benches/`, `examples/`, and the crates for tests and examples.

use std::path::Path;
use std::process::ExitCode;

use proc_macro2::Span;
use syn::Item;
use syn::spanned::Spanned;

use crate::layers::{Workspace, attributes, is_for_tests};

/// Crates that are not part of the product.
const NOT_COUNTED: [&str; 2] = ["sscc-testing", "sscc-examples"];

/// Prints the lines of each crate, and their sum.
pub fn run(arguments: &[String]) -> ExitCode {
    if !arguments.is_empty() {
        eprintln!("Usage: cargo xtask lines");
        return ExitCode::from(2);
    }
    match count(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..")) {
        Ok(crates) => {
            crates.iter().for_each(|(name, lines)| println!("{lines:>7}  {name}"));
            println!("{:>7}  all", crates.iter().map(|(_, lines)| lines).sum::<usize>());
            ExitCode::SUCCESS
        }
        Err(line) => {
            eprintln!("error: {line}");
            ExitCode::from(2)
        }
    }
}

/// The crates of the product, and their lines.
fn count(root: &Path) -> Result<Vec<(String, usize)>, String> {
    let workspace = Workspace::read(root)?;
    let mut crates = Vec::new();
    for krate in &workspace.crates {
        let name = &krate.manifest.name;
        if NOT_COUNTED.contains(&name.as_str()) {
            continue;
        }
        let mut lines = 0;
        for file in &krate.modules.files {
            let text = std::fs::read_to_string(root.join(&file.path))
                .map_err(|error| format!("{}: {error}", file.path.display()))?;
            lines += count_file(&text, &file.syntax.items);
        }
        crates.push((name.clone(), lines));
    }
    Ok(crates)
}

fn count_file(text: &str, items: &[Item]) -> usize {
    let mut tests = Vec::new();
    add_tests(items, &mut tests);
    let is_in_tests = |line: usize| tests.iter().any(|[first, last]| (*first..=*last).contains(&line));
    let is_code = |text: &str| !text.trim().is_empty() && !text.trim_start().starts_with("//");
    text.lines().enumerate().filter(|(at, text)| is_code(text) && !is_in_tests(at + 1)).count()
}

/// Adds the first and the last line of each item for tests.
fn add_tests(items: &[Item], tests: &mut Vec<[usize; 2]>) {
    for item in items {
        if is_for_tests(attributes(item)) {
            let span: Span = item.span();
            tests.push([span.start().line, span.end().line]);
        } else if let Item::Mod(module) = item
            && let Some((_, items)) = &module.content
        {
            add_tests(items, tests);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_lines_of_the_product_count() {
        let text = "//! A file.\n\nuse a::b;\n\n/// A function.\nfn f() {\n    // Nothing.\n    g();\n}\n\n\
                    mod inner {\n    #[cfg(test)]\n    mod tests {\n        fn t() {}\n    }\n}\n\n\
                    #[cfg(test)]\nmod tests {\n    use super::*;\n    fn t() {}\n}\n";
        // The `use`, three lines of the function, two of the inner module.
        assert_eq!(count_file(text, &syn::parse_file(text).unwrap().items), 6);
    }
}
