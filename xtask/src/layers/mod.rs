//! `cargo xtask layers`: checks that imports go down the order in `layers.toml`, between crates and between the modules
//! of a crate, and that no files form a circle. `--graph` prints the layers as a diagram, `--graph sscc` those of one
//! crate.
//!
//! An import is any path to an item of another file: in a `use`, in code, in the arguments of a macro or an attribute,
//! in the body of a `macro_rules!`. It imports the file that defines the item. The tool follows re-exports to that
//! file, and counts a re-export as an import by the file that contains it. `Type::function` also imports the file of
//! the `impl` block. A glob imports all that it makes visible. `mod x;` is not an import, nor is `use` of a module; a
//! path to an item of the module is.
//!
//! The tool ignores items for tests (`#[cfg(test)]`, `#[test]`) with their files, `tests/`, `benches/`, `examples/` and
//! `build.rs`.
//!
//! The tool does not know types. So it misses methods called on values, functions of a trait called by the type's path,
//! fields, and names that a macro concatenates. It does not read text from `include!`; `include!` from another crate's
//! folder is an import of that crate.

mod diagram;
mod graph;
mod imports;
mod items;
mod modules;
mod order;
mod parse;
mod read;
mod resolve;
mod rules;
mod summary;
mod tokens;
mod toml_file;
mod workspace;

#[cfg(test)]
mod tests;

use std::path::Path;
use std::process::ExitCode;

pub use items::{attributes, is_for_tests};
use order::Order;
pub use read::Workspace;

/// Checks the layers of this workspace, or prints them.
pub fn run(arguments: &[String]) -> ExitCode {
    let graph_of = match arguments {
        [] => None,
        [flag, crates @ ..] if flag == "--graph" => Some(crates),
        _ => {
            eprintln!("Usage: cargo xtask layers [--graph [crates]]");
            return ExitCode::from(2);
        }
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let read = Order::read(&root).and_then(|order| Ok((order, Workspace::read(&root)?)));
    let (order, workspace) = match read {
        Ok(read) => read,
        Err(line) => {
            eprintln!("error: {line}");
            return ExitCode::from(2);
        }
    };
    if let Some(crates) = graph_of {
        print!("{}", diagram::diagram(&workspace, &order, crates));
        return ExitCode::SUCCESS;
    }
    let violations = rules::check(&workspace, &order);
    violations.iter().for_each(|violation| eprintln!("error: {}", violation.message));
    println!("{}", summary::summary(&workspace));
    if violations.is_empty() {
        return ExitCode::SUCCESS;
    }
    eprintln!("{}", summary::count(&violations));
    ExitCode::FAILURE
}
