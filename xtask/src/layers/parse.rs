//! Reads the modules of a crate from its files, without items for tests.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::rc::Rc;

use syn::{Item, ItemMacro, ItemMod, Visibility};

use super::items::{attributes, is_for_tests, name, named_item, names_in_impl, type_of_impl, use_leaves};
use super::modules::{Glob, Impl, Meaning, Module, Modules, Name, SourceFile, Visible};
use super::workspace::{Crate, Dependency};

/// Reads all modules of a crate; the error names a file.
pub fn read(root: &Path, krate: &Crate) -> Result<Modules, String> {
    let mut modules = Modules::default();
    let of = |dependency: &Dependency| (dependency.ident.clone(), dependency.name.clone());
    modules.dependencies = krate.dependencies.iter().map(of).collect();
    if let Some(library) = &krate.library {
        let first = modules.read_file(root, &library.root, None)?;
        modules.library = Some((library.ident.clone(), first));
    }
    for program in &krate.programs {
        modules.read_file(root, program, None)?;
    }
    Ok(modules)
}

impl Modules {
    /// Reads a file and all modules below it, and returns its module. `declared`: none for a first file.
    fn read_file(&mut self, root: &Path, path: &Path, declared: Option<Declared>) -> Result<usize, String> {
        let text =
            fs::read_to_string(root.join(path)).map_err(|error| format!("{}: {error}", path.display()))?;
        let syntax = syn::parse_file(&text)
            .map_err(|error| format!("{}:{}: {error}", path.display(), error.span().start().line))?;
        let syntax = Rc::new(syntax);
        let (module, file) = (self.modules.len(), self.files.len());
        self.files.push(SourceFile { path: path.to_owned(), module, syntax: Rc::clone(&syntax) });
        let folder = path.parent().unwrap_or(Path::new(""));
        let is_folders_own = declared.is_none() || path.file_name().is_some_and(|name| name == "mod.rs");
        let children = if is_folders_own { folder.to_owned() } else { path.with_extension("") };
        let declared = declared.unwrap_or(Declared { path: Vec::new(), parent: None, at: (file, 1) });
        self.modules.push(Module {
            path: declared.path,
            parent: declared.parent,
            file,
            declared: declared.at,
            names: BTreeMap::new(),
            globs: Vec::new(),
        });
        self.add_items(root, module, &syntax.items, &children)?;
        Ok(module)
    }

    /// Adds the names of a module and reads its own modules, whose files are in the folder `children`.
    fn add_items(
        &mut self,
        root: &Path,
        module: usize,
        items: &[Item],
        children: &Path,
    ) -> Result<(), String> {
        for item in items.iter().filter(|item| !is_for_tests(attributes(item))) {
            match item {
                Item::Mod(item) => self.add_module(root, module, item, children)?,
                Item::Use(item) => {
                    let visible = self.visible(module, &item.vis);
                    for leaf in use_leaves(&item.tree) {
                        match leaf.alias {
                            Some(alias) => self.add_name(module, alias, Meaning::Import(leaf.path), visible),
                            None => self.modules[module].globs.push(Glob { path: leaf.path, visible }),
                        }
                    }
                }
                Item::Macro(item) => self.add_macro(module, item),
                Item::Impl(item) => {
                    let Some(path) = type_of_impl(item) else { continue };
                    self.impls.push(Impl { module, path, names: names_in_impl(item) });
                }
                item => {
                    let Some(named) = named_item(item) else { continue };
                    let meaning = if named.is_type { Meaning::Type } else { Meaning::Value };
                    let visible = self.visible(module, named.visibility);
                    self.add_name(module, name(named.ident), meaning, visible);
                }
            }
        }
        Ok(())
    }

    fn add_module(
        &mut self,
        root: &Path,
        parent: usize,
        item: &ItemMod,
        children: &Path,
    ) -> Result<(), String> {
        let visible = self.visible(parent, &item.vis);
        let file = self.modules[parent].file;
        let own = name(&item.ident);
        let path = [self.modules[parent].path.as_slice(), std::slice::from_ref(&own)].concat();
        let declared = Declared { path, parent: Some(parent), at: (file, item.ident.span().start().line) };
        let child = match &item.content {
            Some((_, items)) => {
                let module = self.modules.len();
                self.modules.push(Module {
                    path: declared.path,
                    parent: declared.parent,
                    file,
                    declared: declared.at,
                    names: BTreeMap::new(),
                    globs: Vec::new(),
                });
                self.add_name(parent, own.clone(), Meaning::Module(module), visible);
                return self.add_items(root, module, items, &children.join(own));
            }
            None => {
                let folder = self.files[file].path.parent().map(Path::to_owned).unwrap_or_default();
                let places = match path_attribute(item) {
                    Some(path) => vec![folder.join(path)],
                    None => vec![children.join(format!("{own}.rs")), children.join(&own).join("mod.rs")],
                };
                let found = places.iter().find(|place| root.join(place).is_file());
                let (path, line) = (&self.files[file].path, declared.at.1);
                let found =
                    found.ok_or_else(|| format!("{}:{line}: no file for mod {own}", path.display()))?;
                self.read_file(root, found, Some(declared))?
            }
        };
        self.add_name(parent, own, Meaning::Module(child), visible);
        Ok(())
    }

    /// Adds a `macro_rules!` to its module and, if it is exported, to the first module of the crate. Calls by name
    /// alone use `macros`.
    fn add_macro(&mut self, module: usize, item: &ItemMacro) {
        let Some(ident) = &item.ident else { return };
        let at = &self.modules[module];
        self.macros.entry(name(ident)).or_default().push(at.file);
        if item.attrs.iter().any(|attribute| attribute.path().is_ident("macro_export")) && at.parent.is_some()
        {
            let path = [&["crate".to_owned()], at.path.as_slice(), &[name(ident)]].concat();
            let first = self.first_module(module);
            self.add_name(first, name(ident), Meaning::Import(path), Visible::Everywhere);
        }
        self.add_name(module, name(ident), Meaning::Value, Visible::Everywhere);
    }

    fn add_name(&mut self, module: usize, name: String, meaning: Meaning, visible: Visible) {
        self.modules[module].names.entry(name).or_default().push(Name { meaning, visible });
    }

    fn visible(&self, module: usize, visibility: &Visibility) -> Visible {
        match visibility {
            Visibility::Inherited => Visible::Within(module),
            Visibility::Restricted(restricted) if restricted.path.is_ident("self") => Visible::Within(module),
            Visibility::Restricted(restricted) if restricted.path.is_ident("super") => {
                Visible::Within(self.modules[module].parent.unwrap_or(module))
            }
            _ => Visible::Everywhere,
        }
    }
}

/// The declaration of a module.
struct Declared {
    path: Vec<String>,
    parent: Option<usize>,
    at: (usize, usize),
}

/// The file in `#[path = "..."]`.
fn path_attribute(item: &ItemMod) -> Option<String> {
    let attribute = item.attrs.iter().find(|attribute| attribute.path().is_ident("path"))?;
    match &attribute.meta.require_name_value().ok()?.value {
        syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(text), .. }) => Some(text.value()),
        _ => None,
    }
}
