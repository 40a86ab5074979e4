//! Reads the workspace: its crates, their modules and imports.

use std::path::Path;

use super::imports::{Import, imports};
use super::modules::Modules;
use super::parse;
use super::resolve::Target;
use super::workspace::{self, Crate};

/// All crates of the workspace.
pub struct Workspace {
    pub crates: Vec<CrateSource>,
}

/// A crate with its modules and imports.
pub struct CrateSource {
    pub manifest: Crate,
    pub modules: Modules,
    pub imports: Vec<Import>,
}

impl Workspace {
    /// Reads all crates below the root of a workspace; the error names a file.
    pub fn read(root: &Path) -> Result<Self, String> {
        let manifests = workspace::read(root)?;
        let mut read = Vec::new();
        for manifest in &manifests {
            let mut modules = parse::read(root, manifest)?;
            modules.find_associated();
            let imports = imports(&modules, &manifests);
            read.push((modules, imports));
        }
        let crates = manifests.into_iter().zip(read);
        Ok(Self {
            crates: crates
                .map(|(manifest, (modules, imports))| CrateSource { manifest, modules, imports })
                .collect(),
        })
    }
}

impl CrateSource {
    /// Returns the path of a file, relative to the root of the workspace.
    pub fn path(&self, file: usize) -> String {
        self.modules.files[file].path.display().to_string()
    }

    /// Returns the name of a folder of modules in `layers.toml`, such as `sscc/query`; without modules, the crate's
    /// name.
    pub fn folder(&self, modules: &[String]) -> String {
        let name = std::slice::from_ref(&self.manifest.name);
        [name, modules].concat().join("/")
    }

    /// Returns `file:line: imports path (file)`.
    pub fn describe(&self, import: &Import) -> String {
        let at = format!("{}:{}", self.path(import.from), import.line);
        match import.to {
            Target::File(file) => format!("{at}: imports {} ({})", import.path, self.path(file)),
            _ => format!("{at}: imports {}", import.path),
        }
    }
}
