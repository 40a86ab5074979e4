//! Checks the rules: imports go down the declared order, files form no circle, the order names all modules.

use std::cmp::Ordering;
use std::collections::BTreeSet;

use super::graph::FileGraph;
use super::imports::Import;
use super::order::{FILE, Levels, Order};
use super::read::{CrateSource, Workspace};
use super::resolve::Target;
use super::workspace::Dependency;

/// A violation of a rule, with its place.
pub struct Violation {
    /// The crate with the violation; none if `layers.toml` names an unknown crate.
    pub krate: Option<String>,
    /// One or more lines `file:line: message`.
    pub message: String,
}

/// Returns all violations, crate by crate.
pub fn check(workspace: &Workspace, order: &Order) -> Vec<Violation> {
    let mut violations = check_places_of_crates(workspace, order);
    for krate in &workspace.crates {
        let of_crate = [
            check_dependencies(krate, order),
            check_places_of_modules(krate, order),
            check_imports(krate, order),
            check_circles(krate),
        ];
        let own = |message| Violation { krate: Some(krate.manifest.name.clone()), message };
        violations.extend(of_crate.into_iter().flatten().map(own));
    }
    violations
}

/// Returns the reason why one name must not import another; none if it may. Names without a place are other violations.
fn reason_against(levels: &Levels, from: &str, to: &str) -> Option<String> {
    let (above, below) = (levels.place(from)?.level, levels.place(to)?.level);
    match above.cmp(&below) {
        Ordering::Less => Some(format!("{from} is below {to} in {FILE}")),
        Ordering::Equal => Some(format!("{from} and {to} are on one level in {FILE}")),
        Ordering::Greater => None,
    }
}

fn check_places_of_crates(workspace: &Workspace, order: &Order) -> Vec<Violation> {
    let mut violations = Vec::new();
    let is_crate = |name: &str| workspace.crates.iter().any(|krate| krate.manifest.name == name);
    for krate in workspace.crates.iter().filter(|krate| order.crates.place(&krate.manifest.name).is_none()) {
        let name = &krate.manifest.name;
        let message = format!("{}:1: crate {name} has no place in {FILE}", krate.manifest.manifest);
        violations.push(Violation { krate: Some(name.clone()), message });
    }
    for (name, line) in order.crates.entries().filter(|(name, _)| !is_crate(name)) {
        violations
            .push(Violation { krate: None, message: format!("{FILE}:{line}: there is no crate {name}") });
    }
    for folder in order.folders.keys() {
        let name = folder.split('/').next().unwrap_or(folder);
        if !is_crate(name) {
            let message = format!("{FILE}:1: '{folder}' in [modules]: there is no crate {name}");
            violations.push(Violation { krate: None, message });
        }
    }
    violations
}

fn check_dependencies(krate: &CrateSource, order: &Order) -> Vec<String> {
    let message = |dependency: &Dependency| {
        let why = reason_against(&order.crates, &krate.manifest.name, &dependency.name)?;
        Some(format!(
            "{}:{}: depends on {}: {why}",
            krate.manifest.manifest, dependency.line, dependency.name
        ))
    };
    krate.manifest.dependencies.iter().filter_map(message).collect()
}

/// Returns the modules without a place, and the places without a module.
fn check_places_of_modules(krate: &CrateSource, order: &Order) -> Vec<String> {
    let mut messages = Vec::new();
    let name = &krate.manifest.name;
    let files = krate.modules.files.iter().map(|file| &krate.modules.modules[file.module]);
    let modules: Vec<_> = files.filter(|module| !module.path.is_empty()).collect();
    for module in &modules {
        let (own, parents) = module.path.split_last().expect("the path of a module is not empty");
        let folder = krate.folder(parents);
        let levels = order.folders.get(&folder);
        if levels.map_or(parents.is_empty(), |levels| levels.place(own).is_none()) {
            let (file, line) = module.declared;
            messages.push(format!(
                "{}:{line}: module {own} has no place among '{folder}' in {FILE}",
                krate.path(file)
            ));
        }
    }
    for (folder, levels) in &order.folders {
        let Some(rest) = folder.strip_prefix(name.as_str()) else { continue };
        let parents: Vec<&str> = rest.split('/').skip(1).collect();
        if !rest.is_empty() && !rest.starts_with('/') {
            continue;
        }
        for (own, line) in levels.entries() {
            let path = [parents.as_slice(), &[own]].concat();
            if modules.iter().all(|module| module.path != path) {
                messages.push(format!("{FILE}:{line}: {folder} has no module {own}"));
            }
        }
    }
    messages
}

fn check_imports(krate: &CrateSource, order: &Order) -> Vec<String> {
    let mut messages = Vec::new();
    for import in FileGraph::new(krate.modules.files.len(), &krate.imports).steps() {
        if let Target::File(to) = import.to
            && let Some(why) = reason_against_import(krate, order, import.from, to)
        {
            messages.push(format!("{}: {why}", krate.describe(import)));
        }
    }
    let mut reported = BTreeSet::new();
    for import in &krate.imports {
        if let Target::Crate(to) = &import.to
            && reported.insert((import.from, to))
            && let Some(why) = reason_against(&order.crates, &krate.manifest.name, to)
        {
            messages.push(format!("{}: {why}", krate.describe(import)));
        }
    }
    messages
}

/// Returns the reason why one file must not import another of its crate. The file of a folder, and the first file of a
/// crate, is above all modules in it.
fn reason_against_import(krate: &CrateSource, order: &Order, from: usize, to: usize) -> Option<String> {
    let [from, to] = [from, to].map(|file| &krate.modules.modules[krate.modules.files[file].module].path);
    let common = from.iter().zip(to).take_while(|(a, b)| a == b).count();
    let folder = krate.folder(&from[..common]);
    match (from.get(common), to.get(common)) {
        (Some(from), Some(to)) => reason_against(order.folders.get(&folder)?, from, to),
        (Some(_), None) => {
            let is_declared = order.folders.contains_key(&folder);
            is_declared.then(|| format!("the file of {folder} itself is above all modules in it"))
        }
        (None, _) => None,
    }
}

fn check_circles(krate: &CrateSource) -> Vec<String> {
    let describe = |circle: &Vec<&Import>| {
        let first = circle[0];
        let mut text =
            format!("{}:{}: circle of {} files:", krate.path(first.from), first.line, circle.len());
        circle.iter().for_each(|import| text += &format!("\n    {}", krate.describe(import)));
        text
    };
    FileGraph::new(krate.modules.files.len(), &krate.imports).circles().iter().map(describe).collect()
}
