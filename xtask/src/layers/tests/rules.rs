//! Tests of each rule, with and without a violation.

use super::super::order::Order;
use super::super::rules::check;
use super::super::{diagram, summary};
use super::tree::Tree;

#[test]
fn legal_code_passes() {
    let files = [
        ("lib.rs", "#[macro_use]\nmod base;\nmod middle;\nmod top;\npub use top::{Top, run};\n"),
        ("main.rs", "fn main() { a::run() }\n"),
        ("base.rs", "pub struct Base;\npub fn base() {}\nmacro_rules! or { ($x:expr) => { $x }; }\n"),
        // The file of a folder imports its children, and these import each other by its re-exports.
        (
            "middle/mod.rs",
            "mod left;\nmod right;\npub use left::left;\nuse right::right;\npub fn middle() { right() }\n",
        ),
        ("middle/left.rs", "use crate::base::Base;\npub fn left() -> Base { or!(Base) }\n"),
        (
            "middle/right.rs",
            "pub fn right() { super::left(); }\n#[cfg(test)]\nmod tests { use super::super::middle; }\n",
        ),
        // A name that is a module and a function.
        ("top/mod.rs", "pub mod run;\npub use run::run;\npub use run::Top;\n"),
        (
            "top/run.rs",
            "use crate::middle;\npub struct Top;\npub fn run() { middle::middle(); crate::base::base() }\n",
        ),
    ];
    let order = "a = [\"base\", \"middle\", \"top\"]\n\"a/middle\" = [\"left\", \"right\"]";
    let tree = Tree::new(order, &files);
    assert_eq!(tree.violations(), [""; 0]);
    let (workspace, order) = tree.read();
    let deepest = "deepest chain: 6 files, from a/src/lib.rs to a/src/base.rs";
    assert_eq!(summary::summary(&workspace), format!("1 crates, 8 files, 9 imports; {deepest}"));
    let drawn = "a\n    top     -> middle base\n    middle  -> base\n    base\n\na/middle\n    right  -> left\n    left\n";
    assert_eq!(diagram::diagram(&workspace, &order, &["a".to_owned()]), drawn);
    assert_eq!(diagram::diagram(&workspace, &order, &[]), format!("crates\n    a\n\n{drawn}"));
}

#[test]
fn a_circle_through_a_parent_module_is_found() {
    let files = [
        ("lib.rs", "mod folder;\n"),
        ("folder/mod.rs", "mod child;\nmod other;\npub use child::run;\npub const SIZE: u8 = 1;\n"),
        ("folder/child.rs", "use super::other::other;\npub fn run() { other() }\n"),
        ("folder/other.rs", "pub fn other() { super::SIZE; }\n"),
    ];
    let circle = "a/src/folder/mod.rs:3: circle of 3 files:\n    \
        a/src/folder/mod.rs:3: imports child::run (a/src/folder/child.rs)\n    \
        a/src/folder/child.rs:1: imports super::other::other (a/src/folder/other.rs)\n    \
        a/src/folder/other.rs:1: imports super::SIZE (a/src/folder/mod.rs)";
    assert_eq!(Tree::new(r#"a = ["folder"]"#, &files).violations(), [circle]);
    let without = &files[..3];
    let tree = Tree::new(r#"a = ["folder"]"#, without);
    tree.write("a/src/folder/other.rs", "pub fn other() {}\n");
    assert_eq!(tree.violations(), [""; 0]);
}

#[test]
fn the_first_file_of_a_crate_and_names_on_one_line_are_not_imported() {
    let files = [
        ("lib.rs", "mod left;\nmod right;\npub fn root() {}\n"),
        ("left.rs", "use crate::right::right;\n"),
        ("right.rs", "pub fn right() { crate::root() }\n"),
    ];
    let first = "a/src/left.rs:1: imports crate::right::right (a/src/right.rs): left and right are on one level in \
        layers.toml";
    let second = "a/src/right.rs:1: imports crate::root (a/src/lib.rs): the file of a itself is above all modules in it";
    assert_eq!(Tree::new(r#"a = ["left right"]"#, &files).violations(), [first, second]);
}

#[test]
fn every_module_has_a_place_and_every_place_a_module() {
    let files = [
        ("lib.rs", "mod one;\n\nmod two;\n"),
        ("one.rs", "mod part;\n"),
        ("one/part.rs", ""),
        ("two.rs", ""),
    ];
    let tree = Tree::new("a = [\n    \"one\",\n    \"three\",\n]\n\"a/one\" = [\"other\"]", &files);
    assert_eq!(
        tree.violations(),
        [
            "a/src/one.rs:1: module part has no place among 'a/one' in layers.toml",
            "a/src/lib.rs:3: module two has no place among 'a' in layers.toml",
            "layers.toml:5: a has no module three",
            "layers.toml:7: a/one has no module other",
        ]
    );
    let (workspace, order) = tree.read();
    assert_eq!(summary::count(&check(&workspace, &order)), "4 violations of the layers: a 4");
    tree.write("layers.toml", "crates = [\"b\"]\n[modules]\na = [\"one two\"]\nc = []");
    assert_eq!(
        tree.violations(),
        [
            "a/Cargo.toml:1: crate a has no place in layers.toml",
            "layers.toml:1: there is no crate b",
            "layers.toml:1: 'c' in [modules]: there is no crate c",
        ]
    );
    tree.write("layers.toml", "crates = [\"a a\"]\n");
    assert_eq!(Order::read(tree.path()).err().unwrap(), "layers.toml:1: 'a' is declared twice");
}

#[test]
fn crates_are_in_order_too() {
    let tree = Tree::new("", &[("lib.rs", "fn f() { b_lib::g(); }\ninclude!(\"../../b/src/list.rs\");\n")]);
    tree.write(
        "Cargo.toml",
        "[workspace]\nmembers = [\"a\", \"b\"]\n[workspace.dependencies]\nb-lib = { package = \"b\" }\n",
    );
    tree.write(
        "a/Cargo.toml",
        "[package]\nname = \"a\"\n[dependencies]\nserde = \"1\"\nb-lib.workspace = true\n",
    );
    tree.write("b/Cargo.toml", "[package]\nname = \"b\"\n[dev-dependencies]\na.path = \"../a\"\n");
    tree.write("b/src/lib.rs", "pub fn g() {}\n");
    tree.write("layers.toml", "crates = [\"b\", \"a\"]\n");
    assert_eq!(tree.violations(), [""; 0]);
    tree.write("layers.toml", "crates = [\"a\", \"b\"]\n");
    assert_eq!(
        tree.violations(),
        [
            "a/Cargo.toml:5: depends on b: a is below b in layers.toml",
            "a/src/lib.rs:1: imports b_lib::g: a is below b in layers.toml",
        ]
    );
    tree.write("a/src/lib.rs", "include!(\"../../b/src/list.rs\");\n");
    assert_eq!(
        tree.violations()[1],
        "a/src/lib.rs:1: imports include!(\"../../b/src/list.rs\"): a is below b in layers.toml"
    );
}
