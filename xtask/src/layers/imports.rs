//! Collects the imports of a crate's files, with file, line and imported file or crate.

use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};

use syn::visit::{self, Visit};
use syn::{Attribute, Block, ImplItem, Item, ItemImpl, Macro, Meta, Stmt, TraitItem, Visibility};

use super::items::{self, UseLeaf, is_for_tests, use_leaves};
use super::modules::{Meaning, Modules};
use super::resolve::{Target, Targets};
use super::tokens;
use super::workspace::Crate;

/// A line of a file that names an item of another file or of another crate.
pub struct Import {
    /// The file that imports.
    pub from: usize,
    pub line: usize,
    /// The imported file or crate.
    pub to: Target,
    /// The path as written.
    pub path: String,
}

/// Returns all imports of the files of a crate. `crates`: those of the workspace, whose folders `include!` may reach.
pub fn imports(modules: &Modules, crates: &[Crate]) -> Vec<Import> {
    let mut imports = Vec::new();
    for (file, source) in modules.files.iter().enumerate() {
        let mut visitor = Visitor {
            modules,
            crates,
            file,
            module: source.module,
            aliases: Vec::new(),
            imports: &mut imports,
        };
        visitor.visit_file(&source.syntax);
    }
    imports
}

struct Visitor<'a> {
    modules: &'a Modules,
    crates: &'a [Crate],
    file: usize,
    module: usize,
    /// The paths of `Self` and of names that blocks import, the innermost block last.
    aliases: Vec<BTreeMap<String, Vec<String>>>,
    imports: &'a mut Vec<Import>,
}

impl Visitor<'_> {
    fn add(&mut self, targets: Targets, line: usize, path: &str) {
        for to in targets {
            if !matches!(to, Target::Module(_)) && to != Target::File(self.file) {
                self.imports.push(Import { from: self.file, line, to, path: path.to_owned() });
            }
        }
    }

    /// Adds a path in code. A single name is ignored, since a `use` imports it.
    fn add_path(&mut self, names: &[String], line: usize) {
        if names.len() > 1 {
            let alias = self.aliases.iter().rev().find_map(|aliases| aliases.get(&names[0]));
            let path = alias.map(|alias| [alias.as_slice(), &names[1..]].concat());
            let targets = self.modules.resolve(self.module, path.as_deref().unwrap_or(names));
            self.add(targets, line, &names.join("::"));
        }
    }

    /// Adds a macro that is called by its name alone, if it is a `macro_rules!` of another file and not imported.
    fn add_macro(&mut self, name: &str, line: usize) {
        if self.modules.resolve_name(self.module, name).is_none()
            && let Some(files) = self.modules.macros.get(name)
            && !files.contains(&self.file)
        {
            self.add(files.iter().map(|file| Target::File(*file)).collect(), line, &format!("{name}!"));
        }
    }

    fn add_tokens(&mut self, stream: proc_macro2::TokenStream) {
        for path in tokens::paths(stream) {
            match path.names.as_slice() {
                [name] if path.is_macro => self.add_macro(name, path.line),
                names => self.add_path(names, path.line),
            }
        }
    }

    fn add_leaf(&mut self, leaf: &UseLeaf) {
        let path = leaf.path.join("::");
        match leaf.alias {
            Some(_) => self.add(self.modules.resolve(self.module, &leaf.path), leaf.line, &path),
            None => {
                let targets = self.modules.resolve_glob(self.module, &leaf.path);
                self.add(targets, leaf.line, &format!("{path}::*"));
            }
        }
    }

    /// Adds an `include!` of a file in the folder of another crate.
    fn add_include(&mut self, mac: &Macro) {
        let Ok(text) = mac.parse_body::<syn::LitStr>() else { return };
        let folder = self.modules.files[self.file].path.parent().unwrap_or(Path::new(""));
        let included = normal(&folder.join(text.value()));
        let own = &self.modules.files[self.file].path;
        let holder = self.crates.iter().find(|krate| included.starts_with(&krate.folder));
        if let Some(holder) = holder.filter(|holder| !own.starts_with(&holder.folder)) {
            let to = Targets::from([Target::Crate(holder.name.clone())]);
            self.add(
                to,
                mac.path.segments[0].ident.span().start().line,
                &format!("include!({:?})", text.value()),
            );
        }
    }
}

/// Returns a path without `..`.
fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for component in path.components() {
        match component {
            Component::ParentDir => _ = normal.pop(),
            other => normal.push(other),
        }
    }
    normal
}

impl<'ast> Visit<'ast> for Visitor<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        if is_for_tests(items::attributes(item)) {
            return;
        }
        match item {
            Item::Use(item) => use_leaves(&item.tree).iter().for_each(|leaf| self.add_leaf(leaf)),
            Item::Mod(item) => {
                let Some((_, items)) = &item.content else { return };
                // A name may have several meanings that are modules, of which `#[cfg]` selects one.
                let known = self.modules.modules[self.module].names.get(&items::name(&item.ident));
                let line = item.ident.span().start().line;
                let inner = known.into_iter().flatten().find_map(|name| match name.meaning {
                    Meaning::Module(inner) if self.modules.modules[inner].declared.1 == line => Some(inner),
                    _ => None,
                });
                // Modules within functions are ignored.
                let Some(inner) = inner else { return };
                let outer = std::mem::replace(&mut self.module, inner);
                items.iter().for_each(|item| self.visit_item(item));
                self.module = outer;
            }
            item => visit::visit_item(self, item),
        }
    }

    fn visit_item_impl(&mut self, item: &'ast ItemImpl) {
        let own = items::type_of_impl(item).map(|path| ("Self".to_owned(), path));
        self.aliases.push(own.into_iter().collect());
        visit::visit_item_impl(self, item);
        self.aliases.pop();
    }

    fn visit_impl_item(&mut self, item: &'ast ImplItem) {
        if !is_for_tests(items::attributes_in_impl(item)) {
            visit::visit_impl_item(self, item);
        }
    }

    fn visit_trait_item(&mut self, item: &'ast TraitItem) {
        if !is_for_tests(items::attributes_in_trait(item)) {
            visit::visit_trait_item(self, item);
        }
    }

    fn visit_block(&mut self, block: &'ast Block) {
        let uses = block.stmts.iter().filter_map(|statement| match statement {
            Stmt::Item(Item::Use(item)) => Some(use_leaves(&item.tree)),
            _ => None,
        });
        self.aliases.push(uses.flatten().filter_map(|leaf| Some((leaf.alias?, leaf.path))).collect());
        visit::visit_block(self, block);
        self.aliases.pop();
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() {
            let names: Vec<String> =
                path.segments.iter().map(|segment| items::name(&segment.ident)).collect();
            self.add_path(&names, path.segments[0].ident.span().start().line);
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, mac: &'ast Macro) {
        if let Some(ident) = mac.path.get_ident() {
            self.add_macro(&items::name(ident), ident.span().start().line);
            if ident == "include" {
                self.add_include(mac);
            }
        }
        self.visit_path(&mac.path);
        self.add_tokens(mac.tokens.clone());
    }

    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        match &attribute.meta {
            Meta::List(list) => self.add_tokens(list.tokens.clone()),
            Meta::NameValue(value) => self.visit_expr(&value.value),
            Meta::Path(path) => self.visit_path(path),
        }
    }

    fn visit_visibility(&mut self, _: &'ast Visibility) {}
}
