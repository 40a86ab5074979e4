//! Tests of each kind of violation, and of this workspace.

use std::fs;

use tempfile::TempDir;

use super::*;

/// Creates a workspace of one crate, `a`, with this order of modules and these files.
fn tree(order: &str, files: &[(&str, &str)]) -> TempDir {
    let tree = tempfile::tempdir().unwrap();
    write(&tree, "Cargo.toml", "[workspace]\nmembers = [\"a\"]\n");
    write(&tree, "a/Cargo.toml", "[package]\nname = \"a\"\n");
    write(&tree, "layers.toml", &format!("crates = [\"a\"]\n[modules]\n{order}\n"));
    files.iter().for_each(|(path, text)| write(&tree, &format!("a/src/{path}"), text));
    tree
}

fn write(tree: &TempDir, path: &str, text: &str) {
    let path = tree.path().join(path);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, text).unwrap();
}

fn found(tree: &TempDir) -> Vec<String> {
    violations(tree.path()).unwrap()
}

#[test]
fn this_workspace_keeps_its_layers() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let violations = violations(&root).unwrap();
    assert!(violations.is_empty(), "{}", violations.join("\n"));
}

#[test]
fn legal_code_passes() {
    let files = [
        ("lib.rs", "#[macro_use]\nmod base;\nmod middle;\nmod top;\npub use top::{Top, run};\n"),
        (
            "base.rs",
            "pub struct Base;\npub fn base() {}\nmacro_rules! or {\n    ($x:expr) => {\n        $x\n    };\n}\n",
        ),
        // The file of a folder imports its children, and these import each other by its re-exports.
        (
            "middle/mod.rs",
            "mod left;\nmod right;\npub use left::left;\nuse right::right;\npub fn middle() {\n    right()\n}\n",
        ),
        ("middle/left.rs", "use crate::base::Base;\npub fn left() -> Base {\n    or!(Base)\n}\n"),
        (
            "middle/right.rs",
            "pub fn right() {\n    super::left();\n}\n#[cfg(test)]\nmod tests {\n    use super::super::middle;\n}\n",
        ),
        // A module and a function have the same name.
        ("top/mod.rs", "pub mod run;\npub use run::run;\npub use run::Top;\n"),
        ("top/run.rs", "use crate::middle;\npub struct Top;\npub fn run() {\n    middle::middle();\n}\n"),
    ];
    let order = "a = [\"base\", \"middle\", \"top\"]\n\"a/middle\" = [\"left\", \"right\"]";
    assert_eq!(found(&tree(order, &files)), [""; 0]);
}

/// Returns the violations of `low`, which must not import `high`; `high.rs` defines `f` and `T`.
fn low(text: &str) -> Vec<String> {
    let files = [
        ("lib.rs", "pub mod high;\npub mod low;\n"),
        ("high.rs", "pub fn f() {}\npub struct T;\n"),
        ("low.rs", text),
    ];
    found(&tree(r#"a = ["low", "high"]"#, &files))
}

#[test]
fn every_way_to_name_an_item_is_an_import() {
    let ways = [
        ("use crate::high::f;", "crate::high::f"),
        ("use crate::{\n    high::{T as U},\n};", "crate::high::T"),
        ("pub use super::high::*;", "super::high::*"),
        ("fn g() {\n    crate::high::f()\n}", "crate::high::f"),
        ("mod inner {\n    fn g() {\n        super::super::high::f()\n    }\n}", "super::super::high::f"),
        ("struct S {\n    t: Vec<Option<crate::high::T>>,\n}", "crate::high::T"),
        ("impl Iterator for super::high::T {}", "super::high::T"),
        (
            "macro_rules! n {\n    ($x:expr) => {\n        $crate::high::f($x.y::<u8>())\n    };\n}",
            "crate::high::f",
        ),
    ];
    for (text, path) in ways {
        let line = 1 + text.lines().position(|line| line.contains("high")).unwrap();
        let why = "low is below high in layers.toml";
        assert_eq!(
            low(text),
            [format!("a/src/low.rs:{line}: imports {path} (a/src/high.rs): {why}")],
            "{text}"
        );
    }
    // The import goes through a module that a `use` names.
    assert_eq!(low("use crate::high as h;\nfn g() {\n    h::f()\n}").len(), 2);
}

#[test]
fn items_for_tests_and_foreign_names_are_not_imports() {
    let legal = [
        "#[cfg(test)]\nuse crate::high::f;",
        "#[cfg(test)]\nmod tests {\n    use crate::high::*;\n}",
        "#[cfg(all(test, unix))]\nfn g(\n    x: u8,\n) {\n    crate::high::f()\n}",
        "struct S;\nimpl S {\n    #[cfg(test)]\n    fn g() {\n        crate::high::f()\n    }\n}",
        "//! See [`crate::high::f`].\n/// And `crate::high::T`.\nstruct S; // crate::high::T",
        "pub(in crate::low) struct S;\nfn g() {\n    h(\"crate::high::f\")\n}",
        "use std::high;\nfn g(x: u8) {\n    high::f()\n}",
    ];
    for text in legal {
        assert_eq!(low(text), [""; 0], "{text}");
    }
}

#[test]
fn re_exports_are_followed_to_the_file_that_defines_the_item() {
    for export in ["pub use self::part::Thing as Shown;", "pub use self::part::*;\npub use self::none::*;"] {
        let name = if export.contains("Shown") { "Shown" } else { "Thing" };
        let files = [
            ("lib.rs", &*format!("mod high;\nmod low;\npub use high::{name};\n")),
            ("high/mod.rs", &*format!("mod part;\n{export}\n")),
            ("high/part.rs", "pub struct Thing;\n"),
            ("low.rs", &*format!("\n\nfn f() -> crate::{name} {{\n    todo!()\n}}\n")),
        ];
        let tree = tree(r#"a = ["low", "high"]"#, &files);
        let why = "low is below high in layers.toml";
        let line = format!("a/src/low.rs:3: imports crate::{name} (a/src/high/part.rs): {why}");
        assert_eq!(found(&tree), [line]);
        // If the order is reversed, the same import is legal, although lib.rs imports both files.
        write(&tree, "layers.toml", "crates = [\"a\"]\n[modules]\na = [\"high\", \"low\"]\n");
        assert_eq!(found(&tree), [""; 0]);
    }
}

#[test]
fn circles_and_files_of_folders_are_found() {
    let files = [
        ("lib.rs", "mod folder;\n"),
        ("folder/mod.rs", "mod child;\nmod other;\npub use child::run;\npub const SIZE: u8 = 1;\n"),
        ("folder/child.rs", "use super::other::other;\npub fn run() {\n    other()\n}\n"),
        ("folder/other.rs", "pub fn other() {\n    super::SIZE;\n}\n"),
    ];
    let up = "a/src/folder/other.rs:2: imports super::SIZE (a/src/folder/mod.rs)";
    let circle = format!(
        "circle of 3 files:\n    a/src/folder/child.rs:1: imports super::other::other (a/src/folder/other.rs)\n    \
         {up}\n    a/src/folder/mod.rs:3: imports child::run (a/src/folder/child.rs)"
    );
    let above = format!("{up}: the file of a/folder is above all modules in it");
    assert_eq!(found(&tree(r#"a = ["folder"]"#, &files)), [above, circle]);
}

#[test]
fn crates_and_modules_have_places_and_are_in_order() {
    let files =
        [("lib.rs", "mod one;\nmod two;\n"), ("one.rs", "use crate::two::f;\n"), ("two.rs", "fn f() {}\n")];
    let tree = tree("a = [\"one two\", \"three\"]\nc = []", &files);
    write(&tree, "Cargo.toml", "[workspace]\nmembers = [\"a\", \"b\"]\n");
    write(&tree, "b/Cargo.toml", "[package]\nname = \"b\"\n[dependencies]\na.workspace = true\n");
    write(&tree, "b/src/lib.rs", "");
    assert_eq!(
        found(&tree),
        [
            "crate b has no place in layers.toml",
            "layers.toml: no crate has the name c",
            "layers.toml: a has no module three",
            "a/src/one.rs:1: imports crate::two::f (a/src/two.rs): one and two are on one level in layers.toml",
            "layers.toml: the modules of b have no list",
        ]
    );
    write(&tree, "layers.toml", "crates = [\"b\", \"a\"]\n[modules]\na = [\"two\"]\n");
    assert_eq!(
        found(&tree),
        [
            "layers.toml: a: module one has no place",
            "b/Cargo.toml: the crate depends on a: b is below a in layers.toml",
            "layers.toml: the modules of b have no list",
        ]
    );
    write(&tree, "layers.toml", "crates = [\"a a\"]\n");
    assert_eq!(violations(tree.path()).err().unwrap(), "layers.toml: crates: 'a' is declared twice");
}
