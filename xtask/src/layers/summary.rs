//! Summarizes the workspace in one line, and all violations in another.

use std::collections::{BTreeMap, BTreeSet};

use super::graph::FileGraph;
use super::order::FILE;
use super::read::Workspace;
use super::rules::Violation;

/// Returns the numbers of crates, files and imports (pairs of a file and a file or crate that it imports), and the
/// longest chain of files that import each other.
pub fn summary(workspace: &Workspace) -> String {
    let files: usize = workspace.crates.iter().map(|krate| krate.modules.files.len()).sum();
    let imports = workspace.crates.iter().map(|krate| {
        let pairs: BTreeSet<_> = krate.imports.iter().map(|import| (import.from, &import.to)).collect();
        pairs.len()
    });
    let imports: usize = imports.sum();
    let chains = workspace.crates.iter().filter_map(|krate| {
        let chain = FileGraph::new(krate.modules.files.len(), &krate.imports).deepest_chain()?;
        Some((krate, chain))
    });
    let deepest = match chains.max_by_key(|(_, chain)| chain.len()) {
        Some((krate, chain)) if !chain.is_empty() => {
            let ends = [chain[0], chain[chain.len() - 1]].map(|file| krate.path(file));
            format!("; deepest chain: {} files, from {} to {}", chain.len(), ends[0], ends[1])
        }
        _ => String::new(),
    };
    format!("{} crates, {files} files, {imports} imports{deepest}", workspace.crates.len())
}

/// Returns the number of violations of each crate.
pub fn count(violations: &[Violation]) -> String {
    let mut counts = BTreeMap::new();
    for violation in violations {
        *counts.entry(violation.krate.as_deref().unwrap_or(FILE)).or_insert(0) += 1;
    }
    let counts: Vec<String> = counts.iter().map(|(krate, count)| format!("{krate} {count}")).collect();
    format!("{} violations of the layers: {}", violations.len(), counts.join(", "))
}
