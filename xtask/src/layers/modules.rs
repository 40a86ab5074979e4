//! The modules of a crate and the names in them. The resolver of paths works on this data.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::rc::Rc;

/// All modules of a crate: those of its library and those of its programs.
#[derive(Default)]
pub struct Modules {
    pub files: Vec<SourceFile>,
    pub modules: Vec<Module>,
    /// The library's name in paths and its first module.
    pub library: Option<(String, usize)>,
    /// Dependencies in the workspace: name in paths, name of the crate.
    pub dependencies: BTreeMap<String, String>,
    /// For each `macro_rules!`, the files that define it.
    pub macros: BTreeMap<String, Vec<usize>>,
    /// The `impl` blocks of types, without those of traits.
    pub impls: Vec<Impl>,
    /// For each type (by file and name) and function of it, the files of the `impl` blocks with that function.
    pub associated: BTreeMap<(usize, String, String), BTreeSet<usize>>,
}

/// An `impl Type { ... }`.
pub struct Impl {
    pub module: usize,
    /// The path of the type.
    pub path: Vec<String>,
    /// The names of its functions and constants.
    pub names: Vec<String>,
}

/// A parsed file of the crate.
pub struct SourceFile {
    /// Relative to the root of the workspace.
    pub path: PathBuf,
    pub module: usize,
    pub syntax: Rc<syn::File>,
}

/// A module, in a file of its own or inline.
pub struct Module {
    /// The names of its parents and its own name, the outermost first; empty for the first module of a library or
    /// program.
    pub path: Vec<String>,
    pub parent: Option<usize>,
    pub file: usize,
    /// File and line of its `mod`.
    pub declared: (usize, usize),
    pub names: BTreeMap<String, Vec<Name>>,
    pub globs: Vec<Glob>,
}

/// One meaning of a name in a module.
pub struct Name {
    pub meaning: Meaning,
    pub visible: Visible,
}

/// The item that a name stands for.
pub enum Meaning {
    Module(usize),
    /// A type or trait: a path can continue after it.
    Type,
    /// A function, constant or macro.
    Value,
    /// An import by a `use` of this path.
    Import(Vec<String>),
}

/// A `use path::*`.
pub struct Glob {
    pub path: Vec<String>,
    pub visible: Visible,
}

#[derive(Clone, Copy, PartialEq)]
pub enum Visible {
    Everywhere,
    /// In this module and its descendants.
    Within(usize),
}

impl Modules {
    /// Whether a module is `ancestor` or a descendant of it.
    pub fn is_within(&self, module: usize, ancestor: usize) -> bool {
        let mut at = Some(module);
        while let Some(module) = at {
            if module == ancestor {
                return true;
            }
            at = self.modules[module].parent;
        }
        false
    }

    /// Returns the first module of the library or program of a module: `crate` in paths.
    pub fn first_module(&self, mut module: usize) -> usize {
        while let Some(parent) = self.modules[module].parent {
            module = parent;
        }
        module
    }
}
