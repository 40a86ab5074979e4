//! The graph of imports between the files of a crate: its circles and its longest chain.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::imports::Import;
use super::resolve::Target;

/// For each file, the files that it imports, each with the first such import.
pub struct FileGraph<'a> {
    steps: Vec<BTreeMap<usize, &'a Import>>,
}

impl<'a> FileGraph<'a> {
    pub fn new(files: usize, imports: &'a [Import]) -> Self {
        let mut steps = vec![BTreeMap::new(); files];
        for import in imports {
            if let Target::File(to) = import.to {
                let first = steps[import.from].entry(to).or_insert(import);
                if import.line < first.line {
                    *first = import;
                }
            }
        }
        Self { steps }
    }

    /// Returns one import for each pair of files of which one imports the other.
    pub fn steps(&self) -> impl Iterator<Item = &'a Import> {
        self.steps.iter().flat_map(|steps| steps.values().copied())
    }

    /// Returns short circles without common steps, each as one import for each step; empty if there is no circle.
    pub fn circles(&self) -> Vec<Vec<&'a Import>> {
        let mut circles: Vec<Vec<&Import>> =
            (0..self.steps.len()).filter_map(|file| self.shortest_circle(file)).collect();
        circles.sort_by_key(Vec::len);
        let mut listed = BTreeSet::new();
        circles.retain(|circle| {
            let steps: Vec<_> = circle.iter().map(|import| (import.from, &import.to)).collect();
            let is_new = steps.iter().all(|step| !listed.contains(step));
            listed.extend(steps.into_iter().filter(|_| is_new));
            is_new
        });
        circles
    }

    /// Returns the shortest circle through a file.
    fn shortest_circle(&self, start: usize) -> Option<Vec<&'a Import>> {
        let mut reached_by: BTreeMap<usize, &Import> = BTreeMap::new();
        let mut waiting = VecDeque::from([start]);
        while let Some(file) = waiting.pop_front() {
            for (&next, &import) in &self.steps[file] {
                if reached_by.contains_key(&next) {
                    continue;
                }
                reached_by.insert(next, import);
                if next == start {
                    let mut circle = vec![import];
                    while circle[circle.len() - 1].from != start {
                        circle.push(reached_by[&circle[circle.len() - 1].from]);
                    }
                    circle.reverse();
                    return Some(circle);
                }
                waiting.push_back(next);
            }
        }
        None
    }

    /// Returns the longest chain of files in which each imports the next one; none if files form a circle.
    pub fn deepest_chain(&self) -> Option<Vec<usize>> {
        if (0..self.steps.len()).any(|file| self.shortest_circle(file).is_some()) {
            return None;
        }
        let mut below: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        (0..self.steps.len()).for_each(|file| self.add_chain(file, &mut below));
        below.into_values().rev().max_by_key(Vec::len)
    }

    /// Adds the longest chain that begins with a file.
    fn add_chain(&self, file: usize, below: &mut BTreeMap<usize, Vec<usize>>) {
        if below.contains_key(&file) {
            return;
        }
        self.steps[file].keys().for_each(|next| self.add_chain(*next, below));
        let longest = self.steps[file].keys().map(|next| &below[next]).max_by_key(|chain| chain.len());
        let rest = longest.map(Vec::as_slice).unwrap_or_default();
        let chain = [&[file], rest].concat();
        below.insert(file, chain);
    }
}
