//! The imports between the files of a crate.

use std::collections::BTreeMap;

use super::order::{Order, folder};
use super::paths::{CodePath, paths_and_items};
use crate::sources::Crate;

/// Maximum number of re-exports that are followed for one path.
const MOST_RE_EXPORTS: usize = 16;

/// The imports of one crate.
pub struct Imports<'c> {
    krate: &'c Crate,
    /// For each file its paths, and the names of its items.
    files: Vec<(Vec<CodePath>, Vec<String>)>,
    of_module: BTreeMap<&'c [String], usize>,
    all: Vec<Import>,
}

/// An import of one file by another.
struct Import {
    from: usize,
    to: usize,
    line: usize,
    path: String,
}

impl<'c> Imports<'c> {
    pub fn of(krate: &'c Crate) -> Self {
        let files = krate.files.iter().map(paths_and_items).collect();
        let of_module = krate.files.iter().enumerate().map(|(i, file)| (&file.module[..], i)).collect();
        let mut imports = Self { krate, files, of_module, all: Vec::new() };
        for from in 0..krate.files.len() {
            for path in &imports.files[from].0 {
                if let Some(to) = imports.resolve(from, path, 0).filter(|to| *to != from) {
                    let import = Import { from, to, line: path.line, path: path.names.join("::") };
                    imports.all.push(import);
                }
            }
        }
        imports
    }

    /// Returns the file that defines the item of a path; None for a path into another crate.
    fn resolve(&self, from: usize, path: &CodePath, re_exports: usize) -> Option<usize> {
        let (mut module, mut names) = self.start(from, path)?;
        while let Some((name, rest)) = names.split_first() {
            let file = *self.of_module.get(&module[..])?;
            module.push(name.clone());
            let is_module = self.of_module.contains_key(&module[..]);
            if rest.is_empty() || !is_module {
                // A module and an item may have the same name.
                let exported = self.exported(file, name, re_exports);
                if exported.is_some() || !is_module {
                    return exported.or(Some(file));
                }
            }
            names = rest;
        }
        self.of_module.get(&module[..]).copied()
    }

    /// Returns the module in which a path begins, and the names after it; None for a path into another crate.
    fn start<'p>(&self, from: usize, path: &'p CodePath) -> Option<(Vec<String>, &'p [String])> {
        let (mut module, mut inner) = (self.krate.files[from].module.clone(), path.inner);
        let first = path.names.first()?;
        if !["crate", "self", "super"].contains(&first.as_str()) {
            // The first name is a child, or a module that a `use` names.
            let child = [&module[..], std::slice::from_ref(first)].concat();
            if self.of_module.contains_key(&child[..]) {
                return Some((module, &path.names));
            }
            let known = self.files[from].0.iter().find(|known| known.known_as.as_ref() == Some(first))?;
            let is_itself = path.known_as.is_some() && known.names == path.names;
            let (mut module, names) = (!is_itself).then(|| self.start(from, known))??;
            module.extend(names.iter().cloned());
            return self.of_module.contains_key(&module[..]).then(|| (module, &path.names[1..]));
        }
        let mut names = &path.names[..];
        while let Some((name, rest)) = names.split_first() {
            match name.as_str() {
                "crate" => module.clear(),
                "self" => {}
                "super" if inner > 0 => inner -= 1,
                "super" => _ = module.pop(),
                _ => break,
            }
            names = rest;
        }
        Some((module, names))
    }

    /// Returns the file of an item that a file re-exports.
    fn exported(&self, file: usize, name: &str, re_exports: usize) -> Option<usize> {
        if re_exports >= MOST_RE_EXPORTS {
            return None;
        }
        let public = self.files[file].0.iter().filter(|path| path.is_public);
        for path in public {
            if path.known_as.as_deref() == Some(name) {
                return self.resolve(file, path, re_exports + 1);
            }
            if path.names.last().is_some_and(|last| last == "*") {
                let names = path.names[..path.names.len() - 1].to_vec();
                let module = CodePath { names, ..path.clone() };
                // The module itself is not a re-export: following all re-exports for it would take exponential time.
                let found = self.resolve(file, &module, MOST_RE_EXPORTS);
                if let Some(found) =
                    found.filter(|found| self.files[*found].1.iter().any(|item| item == name))
                {
                    return Some(found);
                }
            }
        }
        None
    }

    fn describe(&self, import: &Import) -> String {
        let path = |file: usize| &self.krate.files[file].path;
        format!("{}:{}: imports {} ({})", path(import.from), import.line, import.path, path(import.to))
    }

    /// Returns the imports that do not go down the order.
    pub fn up_the_order(&self, order: &Order) -> Vec<String> {
        let mut violations = Vec::new();
        for import in &self.all {
            let [from, to] = [import.from, import.to].map(|file| &self.krate.files[file].module[..]);
            let common = from.iter().zip(to).take_while(|(a, b)| a == b).count();
            let list = folder(&self.krate.name, &from[..common]);
            let why = match (from.get(common), to.get(common)) {
                (Some(from), Some(to)) => order.reason_against(&list, from, to),
                (Some(_), None) => Some(format!("the file of {list} is above all modules in it")),
                (None, _) => None,
            };
            violations.extend(why.map(|why| format!("{}: {why}", self.describe(import))));
        }
        violations
    }

    /// Returns a circle of files; None if there is none.
    pub fn circle(&self) -> Option<String> {
        let mut is_done = vec![false; self.krate.files.len()];
        let mut way = Vec::new();
        (0..is_done.len()).find_map(|file| self.circle_from(file, &mut way, &mut is_done))
    }

    fn circle_from<'i>(
        &'i self,
        file: usize,
        way: &mut Vec<&'i Import>,
        is_done: &mut [bool],
    ) -> Option<String> {
        if is_done[file] {
            return None;
        }
        if let Some(start) = way.iter().position(|import| import.from == file) {
            let circle = &way[start..];
            let lines: Vec<String> = circle.iter().map(|import| self.describe(import)).collect();
            return Some(format!("circle of {} files:\n    {}", circle.len(), lines.join("\n    ")));
        }
        for import in self.all.iter().filter(|import| import.from == file) {
            way.push(import);
            let circle = self.circle_from(import.to, way, is_done);
            way.pop();
            if circle.is_some() {
                return circle;
            }
        }
        is_done[file] = true;
        None
    }
}
