//! Tests which paths are imports, and of which file.

use super::tree::Tree;

/// Returns the violations of `low`, which must not import `high`; `high.rs` defines `f`, `T` and `m!`.
fn low(text: &str) -> Vec<String> {
    let high = "pub fn f() {}\npub struct T;\n#[macro_export]\nmacro_rules! m { () => {}; }\n";
    let files = [("lib.rs", "pub mod high;\npub mod low;\n"), ("high.rs", high), ("low.rs", text)];
    Tree::new(r#"a = ["low", "high"]"#, &files).violations()
}

#[test]
fn every_way_to_name_an_item_is_an_import() {
    let ways = [
        ("use crate::high::f;", "crate::high::f"),
        ("use crate::{high::{T as U}};", "crate::high::T"),
        ("pub use super::high::*;", "super::high::*"),
        ("use crate::high;\nfn g() { high::f() }", "high::f"),
        ("use crate::high as h;\nfn g() -> h::T { todo!() }", "h::T"),
        ("fn g() { use crate::high as h; h::f() }", "h::f"),
        ("fn g() { crate::high::f() }", "crate::high::f"),
        ("fn g() { self::super::high::f() }", "self::super::high::f"),
        ("mod inner { fn g() { super::super::high::f() } }", "super::super::high::f"),
        ("struct S { t: Vec<Option<crate::high::T>> }", "crate::high::T"),
        ("impl Iterator for super::high::T {}", "super::high::T"),
        ("fn g() { assert!(1 + 1 == { crate::high::f(); 2 }) }", "crate::high::f"),
        ("fn g() { vec![None, Some::<crate::high::T>(todo!())]; }", "crate::high::T"),
        ("fn g() { x!(use crate::{low, high::{f, T}}) }", "crate::high::f"),
        ("macro_rules! n { ($x:expr) => { $crate::high::f($x.y::<u8>()) }; }", "crate::high::f"),
        ("#[derive(Clone)]\n#[serde(with(crate::high::T))]\nstruct S;", "crate::high::T"),
        ("fn g() { m!() }", "m!"),
        ("fn g() { assert!({ m!(); true }) }", "m!"),
        ("fn g() { crate::m!() }", "crate::m"),
    ];
    for (text, path) in ways {
        let violations = low(text);
        assert!(!violations.is_empty(), "no violation: {text}");
        let lines = text.lines().position(|line| line.contains(path.rsplit("::").next().unwrap_or(path)));
        let line = 1 + lines.unwrap_or(0);
        let rule = "low is below high in layers.toml";
        let found = format!("a/src/low.rs:{line}: imports {path} (a/src/high.rs): {rule}");
        assert_eq!(violations, [found], "{text}");
    }
}

#[test]
fn items_for_tests_and_foreign_names_are_not_imports() {
    let legal = [
        "#[cfg(test)]\nuse crate::high::f;",
        "#[cfg(test)]\nmod tests { use crate::high::*; }",
        "#[cfg(all(test, unix))]\nfn g() { crate::high::f() }",
        "#[test]\nfn g() { crate::high::f() }",
        "struct S;\nimpl S { #[cfg(test)] fn g() { crate::high::f() } }",
        "use crate::high;",
        "//! See [`crate::high::f`].\n/// And `crate::high::T`.\nstruct S;",
        "pub(in crate::low) struct S;",
        "use std::high;\nfn g(x: u8) { high::f(); assert!(x.high::<u8>().f() && <u8 as high::T>::high::f()) }",
        "fn high() {}\nfn g() { assert!(matches!(x, 1..2)); high() }",
    ];
    for text in legal {
        assert_eq!(low(text), [""; 0], "{text}");
    }
}

#[test]
fn re_exports_are_followed_to_the_file_that_defines_the_item() {
    let files = [
        ("lib.rs", "mod high;\nmod low;\npub use high::Shown;\n"),
        ("high/mod.rs", "mod part;\npub use self::part::Thing as Shown;\n"),
        ("high/part.rs", "pub struct Thing;\n"),
        ("low.rs", "\n\nfn f() -> crate::Shown { crate::Shown }\n"),
    ];
    let tree = Tree::new(r#"a = ["low", "high"]"#, &files);
    let line = "a/src/low.rs:3: imports crate::Shown (a/src/high/part.rs): low is below high in layers.toml";
    assert_eq!(tree.violations(), [line]);
    // The same import is legal down the order: lib.rs, which imports both files, is not involved.
    tree.write("layers.toml", "crates = [\"a\"]\n[modules]\na = [\"high\", \"low\"]\n");
    assert_eq!(tree.violations(), [""; 0]);
}

#[test]
fn functions_of_a_type_are_in_the_file_of_their_impl_block() {
    let files = [
        ("lib.rs", "mod high;\nmod low;\n"),
        (
            "high.rs",
            "use crate::low::{Made, T};\nimpl T { pub const N: u8 = 1; pub fn f() {} }\nimpl Made { pub fn g() {} }\n",
        ),
        (
            "low.rs",
            "pub struct T;\nmake!(Made);\nimpl T {\n    fn n() { Self::f(); Self::n() }\n}\nfn m() { Made::g() }\n",
        ),
    ];
    let tree = Tree::new(r#"a = ["low", "high"]"#, &files);
    let line = "a/src/low.rs:4: imports Self::f (a/src/high.rs): low is below high in layers.toml";
    let circle = "a/src/high.rs:1: circle of 2 files:\n    \
        a/src/high.rs:1: imports crate::low::Made (a/src/low.rs)\n    \
        a/src/low.rs:4: imports Self::f (a/src/high.rs)";
    assert_eq!(tree.violations(), [line, circle]);
    // A type that a macro makes is an item of the module's file.
    tree.write("a/src/low.rs", "pub struct T;\nmake!(Made);\n");
    assert_eq!(tree.violations(), [""; 0]);
    tree.write("a/src/low.rs", "pub struct T;\nmake!(Made);\n\nfn m() { super::low::Made::g() }\n");
    let line =
        "a/src/low.rs:4: imports super::low::Made::g (a/src/high.rs): low is below high in layers.toml";
    assert_eq!(tree.violations()[0], line);
}
