//! Pairs that an answer "free" excludes, and the sentence that states them in the command, on the page and in reports.

use std::fmt;

use sscc::{ContactFilter, Neighbours};

use crate::text::counted;

/// The pairs of triangles that a run does not test. It is displayed as their names, such as "151 ignored pairs and pairs with
/// common vertices", or as an empty text if every pair is tested.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LeftOut {
    /// Number of pairs that are ignored one by one.
    ignored: usize,
    /// Names of pairs that the run does not test.
    parts: Vec<&'static str>,
    has_groups: bool,
    neighbours: Option<&'static str>,
}

impl LeftOut {
    /// Returns the pairs that do not count under a filter within one mesh.
    pub fn of(filter: &ContactFilter) -> Self {
        Self {
            ignored: filter.ignored().len(),
            parts: Vec::new(),
            has_groups: filter.groups().is_some(),
            neighbours: match filter.neighbours {
                Neighbours::Exclude => Some("pairs with common vertices"),
                Neighbours::IncludeOneVertex => Some("pairs with a common edge"),
                Neighbours::IncludeFolded => None,
            },
        }
    }

    /// Returns the excluded pairs of a comparison of two meshes: the pairs within either mesh, and those of groups.
    #[must_use]
    pub fn between_meshes(self) -> Self {
        let neighbours = Some("pairs within either mesh");
        Self { neighbours, has_groups: self.has_groups, ..Self::default() }
    }

    /// Adds the pairs between the meshes of several files.
    #[must_use]
    pub fn and_between_files(mut self) -> Self {
        self.parts.push("pairs of different files");
        self
    }

    /// Adds the pairs between the meshes of several nodes.
    #[must_use]
    pub fn and_between_nodes(mut self) -> Self {
        self.parts.push("pairs of different nodes");
        self
    }

    /// Adds the excluded pairs of another mesh of the run.
    #[must_use]
    pub fn and(mut self, other: &Self) -> Self {
        self.ignored += other.ignored;
        self.has_groups |= other.has_groups;
        self.neighbours = self.neighbours.or(other.neighbours);
        let new = other.parts.iter().filter(|part| !self.parts.contains(part)).copied();
        self.parts.extend(new.collect::<Vec<_>>());
        self
    }

    /// Adds a number of pairs that are ignored one by one.
    #[must_use]
    pub fn and_ignored(mut self, pairs: usize) -> Self {
        self.ignored += pairs;
        self
    }

    /// Returns the number of pairs that are ignored one by one.
    pub fn ignored(&self) -> usize {
        self.ignored
    }

    /// Returns ", apart from ..." for the end of a sentence about a free shape; empty if every pair is tested.
    pub fn apart(&self) -> String {
        let names = self.to_string();
        if names.is_empty() { names } else { format!(", apart from {names}") }
    }
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ignored = (self.ignored > 0).then(|| counted(self.ignored as u64, "ignored pair"));
        let parts = self.parts.iter().map(|part| (*part).to_owned());
        let groups = self.has_groups.then(|| "pairs of groups that do not count".to_owned());
        let neighbours = self.neighbours.map(str::to_owned);
        let names: Vec<String> = ignored.into_iter().chain(parts).chain(groups).chain(neighbours).collect();
        match &names[..] {
            [] => Ok(()),
            [one] => f.write_str(one),
            [first @ .., last] => write!(f, "{} and {last}", first.join(", ")),
        }
    }
}

/// The kind of proof of an answer "free".
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FreeProof {
    /// The root's certificate, and tests of this number of exceptions.
    Root {
        /// Pairs that no radius covers, so that every query tests them.
        exceptions: usize,
    },
    /// Tests of all pairs that certificates do not cover.
    Tests,
}

/// Returns the sentence for an answer "free". `place` is inserted before the excluded pairs: " (|z| = ...)", or an empty text.
pub fn free_sentence(proof: FreeProof, place: &str, left_out: &LeftOut) -> String {
    let by = match proof {
        FreeProof::Root { exceptions: 0 } => " by the root's certificate alone".to_owned(),
        FreeProof::Root { exceptions } => {
            format!(" by the root's certificate and tests of {}", counted(exceptions as u64, "exception"))
        }
        FreeProof::Tests => String::new(),
    };
    format!("free: proven{by}{place}{}", left_out.apart())
}

#[cfg(test)]
mod tests {
    use sscc::TriangleGroups;

    use super::*;

    #[test]
    fn free_names_all_that_was_left_out() {
        let root = FreeProof::Root { exceptions: 0 };
        let default = LeftOut::of(&ContactFilter::default());
        assert_eq!(
            free_sentence(root, " (|z| = 1)", &default),
            "free: proven by the root's certificate alone (|z| = 1), apart from pairs with common vertices"
        );
        let ignoring = |count: u32| ContactFilter::default().ignoring((0..count).map(|i| (i, i + 1)));
        assert_eq!(
            free_sentence(FreeProof::Root { exceptions: 3 }, "", &LeftOut::of(&ignoring(1))),
            "free: proven by the root's certificate and tests of 3 exceptions, apart from 1 ignored pair and pairs with \
             common vertices"
        );
        let groups = TriangleGroups::new(&[0, 0, 1]).unwrap().between_only();
        let filter = ContactFilter::new(Neighbours::IncludeOneVertex).ignoring([(0, 2)]).with_groups(groups);
        let all = LeftOut::of(&filter).and_between_nodes();
        assert_eq!(
            all.to_string(),
            "1 ignored pair, pairs of different nodes, pairs of groups that do not count and pairs with a common edge"
        );
        assert_eq!((all.ignored(), default.ignored()), (1, 0));
        let folded = LeftOut::of(&ContactFilter::new(Neighbours::IncludeFolded));
        assert_eq!(free_sentence(FreeProof::Tests, "", &folded), "free: proven");
        let several = LeftOut::of(&ignoring(1000))
            .and_between_files()
            .and(&LeftOut::of(&ignoring(7)).and_between_files());
        assert_eq!(
            several.apart(),
            ", apart from 1,007 ignored pairs, pairs of different files and pairs with common vertices"
        );
        assert_eq!(
            free_sentence(FreeProof::Tests, "", &LeftOut::default().between_meshes()),
            "free: proven, apart from pairs within either mesh"
        );
    }
}
