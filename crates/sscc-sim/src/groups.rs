//! Which pairs of groups of triangles count, by the names of groups in files.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use sscc::TriangleGroups;
use sscc_io::gltf::MeshNode;
use sscc_io::{
    FormatError, GroupsBy, IoError, NamedGroups, Setting, read_base_groups, read_group_numbers, read_groups,
};

use crate::SimError;
use crate::error::{At, Result};

/// Pairs of groups of triangles that do not count, or that alone count. By default all count.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GroupRules {
    /// Pairs `A,B` of names of groups whose triangles do not count (`--ignore-groups`).
    pub ignored: Vec<String>,
    /// Pairs `A,B` of names of groups that alone count (`--only-groups`); not together with `ignored`.
    pub only: Vec<String>,
    /// The groups (`--group-by`): `group`, `object`, `material`, or a file of numbers; none: `group`.
    pub by: Option<PathBuf>,
}

/// The source of groups.
enum Source<'a> {
    /// The file of the mesh.
    Mesh(GroupsBy),
    Numbers(&'a Path),
}

impl GroupRules {
    /// Whether all pairs count.
    pub fn is_empty(&self) -> bool {
        self.ignored.is_empty() && self.only.is_empty()
    }

    /// Returns the groups of a model with modes; none if all pairs count. `mesh_name` is that of a glTF mesh.
    ///
    /// # Errors
    /// When the groups cannot be read, there is none of a name, or they are not as many as the triangles.
    pub fn of_model(
        &self,
        path: &Path,
        mesh_name: Option<&str>,
        triangles: usize,
    ) -> Result<Option<TriangleGroups>> {
        self.of_file(path, "the model", triangles, |by| read_groups(path, mesh_name, by))
    }

    /// As [`GroupRules::of_model`], of a mesh without modes.
    pub(crate) fn of_mesh(
        &self,
        path: &Path,
        mesh_name: Option<&str>,
        triangles: usize,
    ) -> Result<Option<TriangleGroups>> {
        self.of_file(path, "the mesh", triangles, |by| read_base_groups(path, mesh_name, by))
    }

    /// As [`GroupRules::of_model`], of each of these nodes of a glTF file. A group need not be in all of them.
    pub(crate) fn of_nodes(&self, path: &Path, nodes: &[MeshNode]) -> Result<Vec<Option<TriangleGroups>>> {
        let Some(source) = self.source()? else { return Ok(vec![None; nodes.len()]) };
        let in_file = |error: FormatError| IoError::Format { path: path.to_owned(), error };
        let named = |node: &MeshNode| {
            let named = match source {
                Source::Mesh(by) => node.groups(by).map_err(in_file)?,
                Source::Numbers(file) => numbers(file)?,
            };
            self.check_count(path, &named, &format!("node {}", node.node()), node.faces().len())?;
            Ok(named)
        };
        let named = nodes.iter().map(named).collect::<Result<Vec<_>>>()?;
        Ok(self.tables(&named)?.into_iter().map(Some).collect())
    }

    fn of_file(
        &self,
        path: &Path,
        what: &str,
        triangles: usize,
        read: impl Fn(GroupsBy) -> Result<NamedGroups, IoError>,
    ) -> Result<Option<TriangleGroups>> {
        let named = match self.source()? {
            None => return Ok(None),
            Some(Source::Mesh(by)) => read(by)?,
            Some(Source::Numbers(file)) => numbers(file)?,
        };
        self.check_count(path, &named, what, triangles)?;
        Ok(self.tables(&[named])?.pop())
    }

    /// Returns the source of groups; none if all pairs count.
    fn source(&self) -> Result<Option<Source<'_>>> {
        if self.is_empty() {
            return match self.by {
                Some(_) => {
                    let cause = "it changes nothing without " + Setting::IgnoreGroups;
                    Err(SimError::refused(Setting::GroupBy, cause + " or " + Setting::OnlyGroups))
                }
                None => Ok(None),
            };
        }
        Ok(Some(match self.by.as_deref().map(|by| (by, by.to_str())) {
            None | Some((_, Some("group"))) => Source::Mesh(GroupsBy::Group),
            Some((_, Some("object"))) => Source::Mesh(GroupsBy::Object),
            Some((_, Some("material"))) => Source::Mesh(GroupsBy::Material),
            Some((file, _)) => Source::Numbers(file),
        }))
    }

    fn check_count(&self, path: &Path, named: &NamedGroups, what: &str, triangles: usize) -> Result<()> {
        let found = named.of_triangle.len();
        if found == triangles {
            return Ok(());
        }
        let place = self.by.as_deref().unwrap_or(path).display();
        let cause = format!("there are groups of {found} triangles, but {what} has {triangles}");
        Err(SimError::refused(place, cause))
    }

    /// Returns a table for each of these groups. Each pair must be one of at least one of them.
    fn tables(&self, all: &[NamedGroups]) -> Result<Vec<TriangleGroups>> {
        let (setting, typed) = match self.only[..] {
            [] => (Setting::IgnoreGroups, &self.ignored),
            _ => (Setting::OnlyGroups, &self.only),
        };
        let mut pairs = vec![Vec::new(); all.len()];
        for text in typed {
            let found: Vec<_> = all.iter().map(|named| named.pair(text)).collect();
            if found.iter().all(Result::is_err) {
                return Err(SimError::refused(setting + " " + text.as_str(), missing(all, text)));
            }
            pairs.iter_mut().zip(found).for_each(|(pairs, found)| pairs.extend(found));
        }
        let table = |(named, pairs): (&NamedGroups, Vec<(u32, u32)>)| {
            let table = named.to_table()?;
            let pairs = pairs.into_iter().map(<[u32; 2]>::from);
            Ok(if self.only.is_empty() { table.ignoring(pairs) } else { table.only(pairs) }?)
        };
        all.iter().zip(pairs).map(table).collect()
    }
}

/// Returns the reason why none of these has the groups of a pair.
fn missing(all: &[NamedGroups], text: &str) -> String {
    let mut known = NamedGroups::default();
    let mut seen = BTreeSet::new();
    let names = all.iter().flat_map(|named| &named.names);
    known.names.extend(names.filter(|name| seen.insert(*name)).cloned());
    match known.pair(text) {
        Err(cause) => cause,
        Ok(_) => "no node has both groups, and collisions between nodes are not searched".into(),
    }
}

fn numbers(file: &Path) -> Result<NamedGroups> {
    read_group_numbers(file)
        .at(|| Setting::GroupBy + " is none of group, object and material, so it must be a file")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(names: &[&str]) -> NamedGroups {
        let mut named = NamedGroups::default();
        named.names = names.iter().map(|name| (*name).to_owned()).collect();
        named.of_triangle = (0..names.len() as u32).collect();
        named
    }

    #[test]
    fn groups_may_be_missing_in_some_meshes() {
        let rules = |ignored: &[&str], only: &[&str]| {
            let owned = |texts: &[&str]| texts.iter().map(|text| (*text).to_owned()).collect();
            GroupRules { ignored: owned(ignored), only: owned(only), by: None }
        };
        let all = [named(&["hair", "face", "hat"]), named(&["face", "hat", "shoe"])];
        let counted = |rules: &GroupRules| -> Vec<[bool; 2]> {
            let tables = rules.tables(&all).unwrap();
            tables.iter().map(|table| [table.is_pair_counted(0, 1), table.is_pair_counted(1, 1)]).collect()
        };
        assert_eq!(counted(&rules(&["hair,face"], &[])), [[false, true], [true, true]]);
        assert_eq!(counted(&rules(&["hat,hat"], &[])), [[true, true], [true, false]]);
        // No pair of the second mesh counts.
        assert_eq!(counted(&rules(&[], &["hair,face"])), [[true, false], [false, false]]);
        let message = |rules: GroupRules| rules.tables(&all).unwrap_err().to_string();
        assert_eq!(
            message(rules(&[], &["hair,coat"])),
            "only_groups hair,coat: no triangle is in a group 'coat'; groups: 'hair', 'face', 'hat', 'shoe'"
        );
        assert_eq!(
            message(rules(&["hat,hat", "hair,shoe"], &[])),
            "ignore_groups hair,shoe: no node has both groups, and collisions between nodes are not searched"
        );
    }

    #[test]
    fn groups_without_rules() {
        let mut rules = GroupRules::default();
        assert!(rules.of_mesh("missing.obj".as_ref(), None, 1).unwrap().is_none());
        rules.by = Some("material".into());
        let message = rules.of_mesh("missing.obj".as_ref(), None, 1).unwrap_err().to_string();
        assert!(message.starts_with("group_by: it changes nothing without"), "{message}");
    }
}
