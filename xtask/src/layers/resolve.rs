//! Finds the files that define the items of paths. It follows imports, re-exports and globs.

use std::collections::BTreeSet;

use super::modules::{Meaning, Modules, Visible};

/// The target of a path.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Target {
    /// An item that is defined in this file.
    File(usize),
    /// A type that is defined in this file. The rest of the path may be in an `impl` block of another file.
    Type(usize, String),
    Module(usize),
    /// Another crate of the workspace, or something in it.
    Crate(String),
}

pub type Targets = BTreeSet<Target>;

/// Converts types to their files, for paths that end there.
fn at_end(targets: Targets) -> Targets {
    let file = |target| match target {
        Target::Type(file, _) => Target::File(file),
        other => other,
    };
    targets.into_iter().map(file).collect()
}

impl Modules {
    /// Returns the targets of a path in a module: several if a name has several meanings, none outside of the
    /// workspace. A name that a module lacks counts as an item of its file, because a macro made it.
    pub fn resolve(&self, module: usize, path: &[String]) -> Targets {
        at_end(Resolver::new(self).path(module, path, false).unwrap_or_default())
    }

    /// Returns the types of a path, each by file and name.
    fn resolve_types(&self, module: usize, path: &[String]) -> Vec<(usize, String)> {
        let targets = Resolver::new(self).path(module, path, true);
        let types = targets.into_iter().flatten().filter_map(|target| match target {
            Target::Type(file, name) => Some((file, name)),
            _ => None,
        });
        types.collect()
    }

    /// Finds the files with functions of types, for paths such as `Type::function`.
    pub fn find_associated(&mut self) {
        for block in std::mem::take(&mut self.impls) {
            let file = self.modules[block.module].file;
            for (type_file, name) in self.resolve_types(block.module, &block.path) {
                for function in &block.names {
                    let key = (type_file, name.clone(), function.clone());
                    self.associated.entry(key).or_default().insert(file);
                }
            }
        }
    }

    /// Returns the targets of a name in a module; none if the module does not have the name.
    pub fn resolve_name(&self, module: usize, name: &str) -> Option<Targets> {
        Resolver::new(self).name(module, name, false).map(at_end)
    }

    /// Returns the targets that `use path::*` imports into a module.
    pub fn resolve_glob(&self, module: usize, path: &[String]) -> Targets {
        let mut targets = Targets::new();
        for target in self.resolve(module, path) {
            match target {
                Target::Module(from) => self.add_visible(from, module, &mut BTreeSet::new(), &mut targets),
                other => _ = targets.insert(other),
            }
        }
        targets
    }

    /// Adds the targets in the module `from` that are visible in the module `to`.
    fn add_visible(&self, from: usize, to: usize, seen: &mut BTreeSet<usize>, targets: &mut Targets) {
        if !seen.insert(from) {
            return;
        }
        let is_visible = |visible: Visible| match visible {
            Visible::Everywhere => true,
            Visible::Within(module) => self.is_within(to, module),
        };
        let module = &self.modules[from];
        for (name, _) in
            module.names.iter().filter(|(_, all)| all.iter().any(|name| is_visible(name.visible)))
        {
            targets.extend(self.resolve_name(from, name).unwrap_or_default());
        }
        for glob in module.globs.iter().filter(|glob| is_visible(glob.visible)) {
            for target in self.resolve(from, &glob.path) {
                match target {
                    Target::Module(next) => self.add_visible(next, to, seen, targets),
                    other => _ = targets.insert(other),
                }
            }
        }
    }
}

struct Resolver<'a> {
    modules: &'a Modules,
    /// Imports on the current path of the search. Some lead to themselves, such as `pub use a_macro`.
    open: BTreeSet<(usize, &'a [String], bool)>,
}

impl<'a> Resolver<'a> {
    fn new(modules: &'a Modules) -> Self {
        Self { modules, open: BTreeSet::new() }
    }

    /// Returns the targets of a path; none if the first name is unknown, and so outside of the workspace. With
    /// `goes_on` only modules and types count, because a path cannot continue after a function.
    fn path(&mut self, module: usize, path: &[String], goes_on: bool) -> Option<Targets> {
        let (first, mut rest) = path.split_first()?;
        let mut reached = match first.as_str() {
            "crate" => Targets::from([Target::Module(self.modules.first_module(module))]),
            "self" | "super" => {
                let mut at = if first == "self" { module } else { self.modules.modules[module].parent? };
                while let Some(("super", behind)) =
                    rest.split_first().map(|(name, behind)| (name.as_str(), behind))
                {
                    (at, rest) = (self.modules.modules[at].parent?, behind);
                }
                Targets::from([Target::Module(at)])
            }
            name => self.first_name(module, name, goes_on || !rest.is_empty())?,
        };
        while let Some((name, behind)) = rest.split_first() {
            rest = behind;
            let mut next = Targets::new();
            for target in reached {
                match target {
                    Target::Module(module) => match self.name(module, name, goes_on || !rest.is_empty()) {
                        Some(targets) => next.extend(targets),
                        None if self.modules.modules[module].names.contains_key(name) => {}
                        None => {
                            _ = next.insert(Target::Type(self.modules.modules[module].file, name.clone()))
                        }
                    },
                    Target::Type(file, of) => {
                        let key = (file, of, name.clone());
                        let blocks = self.modules.associated.get(&key).into_iter().flatten();
                        next.extend(blocks.map(|block| Target::File(*block)));
                        next.insert(Target::Type(key.0, key.1));
                    }
                    other => _ = next.insert(other),
                }
            }
            reached = next;
        }
        Some(reached)
    }

    /// Returns the targets of the first name of a path: a name of the module, the library or a dependency.
    fn first_name(&mut self, module: usize, name: &str, goes_on: bool) -> Option<Targets> {
        if let Some(targets) = self.name(module, name, goes_on) {
            return Some(targets);
        }
        match &self.modules.library {
            Some((ident, library)) if ident == name => Some(Targets::from([Target::Module(*library)])),
            _ => {
                self.modules.dependencies.get(name).map(|krate| Targets::from([Target::Crate(krate.clone())]))
            }
        }
    }

    fn name(&mut self, module: usize, name: &str, goes_on: bool) -> Option<Targets> {
        let modules = self.modules;
        let known = &modules.modules[module];
        let mut found: Option<Targets> = None;
        for meaning in known.names.get(name).into_iter().flatten().map(|name| &name.meaning) {
            match meaning {
                Meaning::Module(child) => _ = found.get_or_insert_default().insert(Target::Module(*child)),
                Meaning::Value if goes_on => {}
                Meaning::Type => {
                    _ = found.get_or_insert_default().insert(Target::Type(known.file, name.to_owned()))
                }
                Meaning::Value => _ = found.get_or_insert_default().insert(Target::File(known.file)),
                Meaning::Import(path) => {
                    if self.open.insert((module, path, goes_on)) {
                        let targets = self.path(module, path, goes_on);
                        self.open.remove(&(module, path.as_slice(), goes_on));
                        found.get_or_insert_default().extend(targets.unwrap_or_default());
                    }
                }
            }
        }
        if found.is_some() {
            return found;
        }
        for glob in &known.globs {
            if !self.open.insert((module, &glob.path, goes_on)) {
                continue;
            }
            let from = self.path(module, &glob.path, true).unwrap_or_default();
            for target in from {
                if let Target::Module(from) = target
                    && let Some(targets) = self.name(from, name, goes_on)
                {
                    found.get_or_insert_default().extend(targets);
                }
            }
            self.open.remove(&(module, glob.path.as_slice(), goes_on));
        }
        found
    }
}
