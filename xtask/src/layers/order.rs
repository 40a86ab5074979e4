//! The order of crates and of modules that `layers.toml` declares, lowest first.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::path::Path;

use toml::{Table, Value};

use crate::sources::{self, Crate};

/// The file that declares the order, at the root of the workspace.
pub const FILE: &str = "layers.toml";

/// Returns the key of the list of a folder of modules: `sscc`, `sscc/query`.
pub fn folder(krate: &str, module: &[String]) -> String {
    std::iter::once(krate).chain(module.iter().map(String::as_str)).collect::<Vec<_>>().join("/")
}

/// The level of each name, 0 the lowest, for the crates (key `crates`), for each crate and for some folders of modules.
pub struct Order(BTreeMap<String, BTreeMap<String, usize>>);

impl Order {
    /// Reads `layers.toml`.
    pub fn read(root: &Path) -> Result<Self, String> {
        let file: Table = sources::text(root, FILE)?.parse().map_err(|error| format!("{FILE}: {error}"))?;
        let modules = file.get("modules").and_then(Value::as_table).cloned().unwrap_or_default();
        let mut order = BTreeMap::new();
        for (list, rows) in file.into_iter().filter(|(key, _)| key != "modules").chain(modules) {
            let rows = rows.as_array().ok_or_else(|| format!("{FILE}: {list}: a list was expected"))?;
            let mut levels = BTreeMap::new();
            for (level, names) in rows.iter().enumerate() {
                let names = names.as_str().ok_or_else(|| format!("{FILE}: {list}: names were expected"))?;
                for name in names.split_whitespace() {
                    if levels.insert(name.to_owned(), level).is_some() {
                        return Err(format!("{FILE}: {list}: '{name}' is declared twice"));
                    }
                }
            }
            order.insert(list, levels);
        }
        Ok(Self(order))
    }

    /// Returns the reason why one name of a list must not import another; None if it may, or if there is no
    /// such list or one of them has no place.
    pub fn reason_against(&self, list: &str, from: &str, to: &str) -> Option<String> {
        let levels = self.0.get(list)?;
        match levels.get(from)?.cmp(levels.get(to)?) {
            Ordering::Less => Some(format!("{from} is below {to} in {FILE}")),
            Ordering::Equal => Some(format!("{from} and {to} are on one level in {FILE}")),
            Ordering::Greater => None,
        }
    }

    /// Returns a violation for each crate without a place, and for each name in the file that is not that of a crate.
    pub fn unknown_crates(&self, crates: &[Crate]) -> Vec<String> {
        let mut violations = Vec::new();
        let levels = self.0.get("crates").cloned().unwrap_or_default();
        let is_crate = |name: &str| crates.iter().any(|krate| krate.name == name);
        let unplaced = crates.iter().filter(|krate| !levels.contains_key(&krate.name));
        violations.extend(unplaced.map(|krate| format!("crate {} has no place in {FILE}", krate.name)));
        let lists = self.0.keys().filter(|list| *list != "crates");
        let named = levels.keys().map(String::as_str).chain(lists.filter_map(|list| list.split('/').next()));
        let unknown = named.filter(|name| !is_crate(name));
        violations.extend(unknown.map(|name| format!("{FILE}: no crate has the name {name}")));
        violations
    }

    /// Returns a violation for each module without a place in the list of its folder, and for each place without a
    /// module.
    pub fn unplaced_modules(&self, krate: &Crate) -> Vec<String> {
        let mut violations = Vec::new();
        if !self.0.contains_key(&krate.name) {
            violations.push(format!("{FILE}: the modules of {} have no list", krate.name));
        }
        let lists = self
            .0
            .iter()
            .filter(|(list, _)| **list == krate.name || list.starts_with(&format!("{}/", krate.name)));
        for (list, levels) in lists {
            let in_list = |module: &[String]| {
                let (name, parent) = module.split_last()?;
                (folder(&krate.name, parent) == *list).then(|| name.clone())
            };
            let modules: Vec<String> = krate.files.iter().filter_map(|file| in_list(&file.module)).collect();
            let unplaced = modules.iter().filter(|name| !levels.contains_key(*name));
            violations.extend(unplaced.map(|name| format!("{FILE}: {list}: module {name} has no place")));
            let unknown = levels.keys().filter(|name| !modules.contains(name));
            violations.extend(unknown.map(|name| format!("{FILE}: {list} has no module {name}")));
        }
        violations
    }
}
