//! Draws the layers as text, crate by crate, the lowest last.

use std::collections::{BTreeMap, BTreeSet};

use super::order::{Levels, Order};
use super::read::{CrateSource, Workspace};
use super::resolve::Target;

type Arrows = BTreeMap<String, BTreeSet<String>>;

/// Returns the diagram of the crates, then that of each crate. `names` selects crates; empty selects all.
pub fn diagram(workspace: &Workspace, order: &Order, names: &[String]) -> String {
    let mut parts = Vec::new();
    if names.is_empty() {
        let arrows = workspace.crates.iter().map(|krate| {
            let dependencies = krate.manifest.dependencies.iter().map(|dependency| dependency.name.clone());
            (krate.manifest.name.clone(), dependencies.collect())
        });
        parts.push(format!("crates\n{}", draw(&order.crates, &arrows.collect())));
    }
    let place = |krate: &&CrateSource| order.crates.place(&krate.manifest.name).map(|place| place.level);
    let mut crates: Vec<&CrateSource> = workspace.crates.iter().collect();
    crates.sort_by_key(|krate| std::cmp::Reverse(place(krate)));
    for krate in crates {
        let name = &krate.manifest.name;
        if !names.is_empty() && !names.contains(name) {
            continue;
        }
        let is_own = |folder: &&String| *folder == name || folder.starts_with(&format!("{name}/"));
        for folder in order.folders.keys().filter(is_own) {
            let parents: Vec<&str> = folder.split('/').skip(1).collect();
            let arrows = arrows(krate, &parents);
            parts.push(format!("{folder}\n{}", draw(&order.folders[folder], &arrows)));
        }
    }
    parts.join("\n")
}

/// Returns the imports between the modules of a folder.
fn arrows(krate: &CrateSource, folder: &[&str]) -> Arrows {
    let mut arrows = Arrows::new();
    let entry = |file: usize| {
        let path = &krate.modules.modules[krate.modules.files[file].module].path;
        let is_inside = path.len() > folder.len() && path.iter().zip(folder).all(|(a, b)| a == b);
        is_inside.then(|| path[folder.len()].clone())
    };
    for import in &krate.imports {
        if let Target::File(to) = import.to
            && let (Some(from), Some(to)) = (entry(import.from), entry(to))
            && from != to
        {
            arrows.entry(from).or_default().insert(to);
        }
    }
    arrows
}

/// Returns one line for each name with the names that it imports, both from the highest level down.
fn draw(levels: &Levels, arrows: &Arrows) -> String {
    let from_top: Vec<&String> = levels.rows.iter().rev().flatten().collect();
    let width = from_top.iter().map(|name| name.len()).max().unwrap_or(0);
    let mut text = String::new();
    for name in &from_top {
        let below: Vec<&str> = match arrows.get(*name) {
            Some(below) => from_top.iter().filter(|to| below.contains(**to)).map(|to| to.as_str()).collect(),
            None => Vec::new(),
        };
        let line = match below.as_slice() {
            [] => format!("    {name}"),
            below => format!("    {name:width$}  -> {}", below.join(" ")),
        };
        text += &format!("{line}\n");
    }
    text
}
