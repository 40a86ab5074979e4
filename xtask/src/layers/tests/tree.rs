//! A small workspace on which the tests try the rules.

use std::fs;
use std::path::Path;

use tempfile::TempDir;

use super::super::order::Order;
use super::super::read::Workspace;
use super::super::rules::check;

/// A workspace of one crate, `a`, in a temporary folder.
pub struct Tree(TempDir);

impl Tree {
    /// Creates a workspace with this order of modules and these files.
    pub fn new(order: &str, files: &[(&str, &str)]) -> Self {
        let tree = Self(tempfile::tempdir().unwrap());
        tree.write("Cargo.toml", "[workspace]\nmembers = [\"a\"]\n");
        tree.write("a/Cargo.toml", "[package]\nname = \"a\"\n");
        tree.write("layers.toml", &format!("crates = [\"a\"]\n[modules]\n{order}\n"));
        files.iter().for_each(|(path, text)| tree.write(&format!("a/src/{path}"), text));
        tree
    }

    pub fn write(&self, path: &str, text: &str) {
        let path = self.0.path().join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn read(&self) -> (Workspace, Order) {
        (Workspace::read(self.0.path()).unwrap(), Order::read(self.0.path()).unwrap())
    }

    /// Returns the messages of all violations.
    pub fn violations(&self) -> Vec<String> {
        let (workspace, order) = self.read();
        check(&workspace, &order).into_iter().map(|violation| violation.message).collect()
    }
}
