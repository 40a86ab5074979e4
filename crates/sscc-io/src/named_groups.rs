//! Groups of triangles with names, as files have them.

use std::collections::BTreeMap;

use sscc::{Error, TriangleGroups};

use crate::FormatError;
use crate::error::{cut, quoted};

/// The parts of a file that are groups of triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum GroupsBy {
    /// OBJ: lines `g`; several names in a line are one name. glTF: primitives, named `#0`, `#1`, ...
    #[default]
    Group,
    /// OBJ: lines `o`. glTF: the node, which is one group.
    Object,
    /// OBJ: lines `o`. glTF: the mesh, which is one group; an unnamed one is named `#0`, `#1`, ...
    Mesh,
    /// OBJ: lines `usemtl`. glTF: materials, where unnamed ones are named `#0`, `#1`, ...
    Material,
}

/// Groups of triangles with names. Triangles without a group are in the group `default`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct NamedGroups {
    /// The name of each group; no two are equal. Groups of a mesh file have triangles, and are in the order of their
    /// first triangles. Those of [`read_group_numbers`](crate::read_group_numbers) are all numbers up to the largest
    /// one.
    pub names: Vec<String>,
    /// The group of each triangle: an index of `names`.
    pub of_triangle: Vec<u32>,
}

/// The name of the group of triangles that have no group.
pub(crate) const DEFAULT: &str = "default";

/// Returns the name of a group for the name of a part. A name in the form of the numbers of unnamed parts (`#0`) gets one
/// more `#`, so that the two differ.
pub(crate) fn own_name(name: &str) -> String {
    let number = name.trim_start_matches('#');
    let is_number = number.len() < name.len() && !number.is_empty();
    let looks_unnamed = is_number && number.bytes().all(|byte| byte.is_ascii_digit());
    if looks_unnamed { format!("#{name}") } else { name.to_owned() }
}

impl NamedGroups {
    /// Returns the group of this name.
    ///
    /// # Errors
    /// When there is none: the cause, with the names of the first groups.
    pub fn number(&self, name: &str) -> Result<u32, String> {
        match self.names.iter().position(|known| known == name) {
            Some(number) => Ok(number as u32),
            None => {
                let known: Vec<String> = self.names.iter().take(20).map(|name| quoted(name)).collect();
                Err(format!(
                    "no triangle is in a group {}; groups: {}",
                    quoted(name),
                    cut(&known.join(", "), 200)
                ))
            }
        }
    }

    /// Returns the two groups of the text `A,B`. A name may itself contain commas.
    ///
    /// # Errors
    /// As [`NamedGroups::number`], and when there is no comma.
    pub fn pair(&self, text: &str) -> Result<(u32, u32), String> {
        let splits = || text.match_indices(',').map(|(at, _)| (&text[..at], &text[at + 1..]));
        let known = splits().find_map(|(a, b)| Some((self.number(a).ok()?, self.number(b).ok()?)));
        match (known, splits().next()) {
            (Some(pair), _) => Ok(pair),
            (None, Some((a, b))) => Ok((self.number(a)?, self.number(b)?)),
            (None, None) => Err("two groups A,B were expected (A,A: triangles within A)".to_owned()),
        }
    }

    /// Returns the groups for a contact filter. All pairs count.
    ///
    /// # Errors
    /// When there are more groups than the core supports; readers do not return so many groups.
    pub fn to_table(&self) -> Result<TriangleGroups, Error> {
        TriangleGroups::new(&self.of_triangle)
    }
}

/// Collects groups, triangle after triangle.
#[derive(Default)]
pub(crate) struct GroupCollector {
    numbers: BTreeMap<String, u32>,
    groups: NamedGroups,
}

impl GroupCollector {
    /// Puts the next triangles, those before number `end`, into the group of this name. Names of groups without
    /// triangles are not kept.
    pub fn extend_to(&mut self, end: usize, name: &str) -> Result<(), FormatError> {
        if end <= self.groups.of_triangle.len() {
            return Ok(());
        }
        let number = match self.numbers.get(name) {
            Some(number) => *number,
            None => {
                let number = self.groups.names.len();
                if number == TriangleGroups::MAX_GROUPS {
                    let cause =
                        format!("it has more than {number} groups of triangles; group by something else");
                    return Err(FormatError::whole(cause));
                }
                self.numbers.insert(name.to_owned(), number as u32);
                self.groups.names.push(name.to_owned());
                number as u32
            }
        };
        self.groups.of_triangle.resize(end, number);
        Ok(())
    }

    pub fn finish(self) -> NamedGroups {
        self.groups
    }
}

#[cfg(test)]
mod tests {
    use sscc::parts::GroupTable;

    use super::*;

    fn groups(runs: &[(usize, &str)]) -> NamedGroups {
        let mut collector = GroupCollector::default();
        runs.iter().for_each(|(end, name)| collector.extend_to(*end, name).unwrap());
        collector.finish()
    }

    #[test]
    fn groups_are_numbered_by_their_first_triangle() {
        let found = groups(&[(2, "b"), (2, "empty"), (3, "a"), (6, "b")]);
        assert_eq!(
            (&found.names[..], &found.of_triangle[..]),
            (&["b".into(), "a".into()][..], &[0, 0, 1, 0, 0, 0][..])
        );
        assert_eq!(GroupTable::from(&found.to_table().unwrap()).count, 2);
        assert_eq!(found.number("a"), Ok(1));
        assert_eq!(found.number("c").unwrap_err(), "no triangle is in a group 'c'; groups: 'b', 'a'");
    }

    #[test]
    fn names_with_commas_are_found() {
        let found = groups(&[(1, "a"), (2, "a,b"), (3, "b"), (4, "c")]);
        assert_eq!(found.pair("a,b"), Ok((0, 2)));
        assert_eq!(found.pair("c,a,b"), Ok((3, 1)));
        assert_eq!(found.pair("a,b,a,b"), Ok((1, 1)));
        assert!(found.pair("a,x").unwrap_err().contains("in a group 'x'"));
        assert!(found.pair("a").unwrap_err().contains("A,B"));
    }

    #[test]
    fn names_that_look_like_numbers_differ_from_numbers() {
        for (name, expected) in
            [("#0", "##0"), ("##12", "###12"), ("0", "0"), ("#", "#"), ("#x", "#x"), ("#1a", "#1a"), ("", "")]
        {
            assert_eq!(own_name(name), expected, "{name}");
        }
    }

    #[test]
    fn too_many_groups_are_refused() {
        let mut collector = GroupCollector::default();
        for t in 0..TriangleGroups::MAX_GROUPS {
            collector.extend_to(t + 1, &t.to_string()).unwrap();
        }
        let error = collector.extend_to(1 << 20, "one more").unwrap_err();
        assert!(error.to_string().contains("more than 65536 groups"), "{error}");
        collector.extend_to(1 << 17, "7").unwrap();
    }
}
