//! Rules for the pairs of groups of triangles that count, by the names of groups in files.

use std::path::{Path, PathBuf};

use sscc::TriangleGroups;
use sscc_io::gltf::MeshNode;
use sscc_io::{
    FormatError, GroupsBy, IoError, NamedGroups, Setting, read_base_groups, read_group_numbers, read_groups,
};

use crate::TaskError;
use crate::error::{At, Result};
use crate::named_meshes::{NamedMesh, is_in_one_mesh, names_of_pairs, tables};

/// Pairs of groups of triangles that do not count, or that count exclusively. By default all pairs count.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GroupRules {
    /// Pairs `A,B` of names of groups: pairs of their triangles do not count (`--ignore-groups`).
    pub ignored: Vec<String>,
    /// Pairs `A,B` of names of groups (`--only-groups`): no other pairs count. Not allowed together with `ignored`.
    pub only: Vec<String>,
    /// The groups (`--group-by`): `group`, `object` (or `node`), `mesh`, `material`, or a file of numbers. None means
    /// `group`; for the nodes of a scene and for two meshes, a group may have a name of any of these four kinds.
    pub by: Option<PathBuf>,
}

/// A mesh whose groups are read by their kind.
pub(crate) struct MeshGroups<'a> {
    pub path: &'a Path,
    pub triangles: usize,
    pub read: &'a dyn Fn(GroupsBy) -> Result<NamedGroups, IoError>,
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

    /// Returns the groups of a model with modes; None if all pairs count. `mesh_name` is the name of a glTF mesh.
    ///
    /// # Errors
    /// When the groups cannot be read, a text is not a pair of names of groups, there are not as many group numbers as
    /// triangles, or `by` is given without pairs.
    pub fn of_model(
        &self,
        path: &Path,
        mesh_name: Option<&str>,
        triangles: usize,
    ) -> Result<Option<TriangleGroups>> {
        self.of_file(path, "the model", triangles, |by| read_groups(path, mesh_name, by))
    }

    /// Returns the groups of a mesh without modes, like [`GroupRules::of_model`].
    pub(crate) fn of_mesh(
        &self,
        path: &Path,
        mesh_name: Option<&str>,
        triangles: usize,
    ) -> Result<Option<TriangleGroups>> {
        self.of_file(path, "the mesh", triangles, |by| read_base_groups(path, mesh_name, by))
    }

    /// Returns the groups of each of these nodes of a glTF file, like [`GroupRules::of_model`]. A group need not be in all of
    /// them. If nodes are compared, the groups also hold between them.
    pub(crate) fn of_nodes(
        &self,
        path: &Path,
        nodes: &[MeshNode],
        are_compared: bool,
    ) -> Result<Vec<Option<TriangleGroups>>> {
        let mesh = |node: &MeshNode| {
            let what = format!("node {}", node.node());
            let in_file = |error: FormatError| IoError::Format { path: path.to_owned(), error };
            self.named(path, &what, node.faces().len(), |by| node.groups(by).map_err(in_file))
        };
        let Some(meshes) = nodes.iter().map(mesh).collect::<Result<Option<Vec<_>>>>()? else {
            return Ok(vec![None; nodes.len()]);
        };
        Ok(self.tables(&meshes, are_compared)?.into_iter().map(Some).collect())
    }

    /// Returns the groups of a mesh and of another one, which also hold between them; None if all pairs count.
    pub(crate) fn of_two(&self, meshes: [MeshGroups<'_>; 2]) -> Result<Option<[TriangleGroups; 2]>> {
        let named = |mesh: &MeshGroups<'_>| self.named(mesh.path, "the mesh", mesh.triangles, mesh.read);
        let [Some(a), Some(b)] = [named(&meshes[0])?, named(&meshes[1])?] else { return Ok(None) };
        Ok(self.tables(&[a, b], true)?.try_into().ok())
    }

    /// Returns the names of the triangles of a mesh, for each kind that groups may have; None if all pairs count.
    fn named(
        &self,
        path: &Path,
        what: &str,
        triangles: usize,
        read: impl Fn(GroupsBy) -> Result<NamedGroups, IoError>,
    ) -> Result<Option<NamedMesh>> {
        let kinds = match self.source()? {
            None => return Ok(None),
            Some(Source::Mesh(_)) if self.by.is_none() => {
                let named = ANY_KIND.into_iter().map(|by| Ok(with_own_names(read(by)?)));
                named.chain([read(GroupsBy::Group)]).collect::<Result<_, IoError>>()?
            }
            Some(Source::Mesh(by)) => vec![read(by)?],
            Some(Source::Numbers(file)) => vec![numbers(file)?],
        };
        kinds.iter().try_for_each(|kind| self.check_count(path, kind, what, triangles))?;
        Ok(Some(NamedMesh { kinds }))
    }

    /// Returns the groups of one file. They keep their numbers, which certificates store.
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
        let (setting, typed) = self.typed();
        let pairs = typed.iter().map(|text| match named.pair(text) {
            Ok((a, b)) => Ok([a, b]),
            Err(cause) => Err(TaskError::refused(setting + " " + text.as_str(), cause)),
        });
        let (table, pairs) = (named.to_table()?, pairs.collect::<Result<Vec<_>>>()?);
        Ok(Some(if self.only.is_empty() { table.ignoring(pairs) } else { table.only(pairs) }?))
    }

    /// Returns the source of groups; None if all pairs count.
    fn source(&self) -> Result<Option<Source<'_>>> {
        if self.is_empty() {
            return match self.by {
                Some(_) => {
                    let cause = "it changes nothing without " + Setting::IgnoreGroups;
                    Err(TaskError::refused(Setting::GroupBy, cause + " or " + Setting::OnlyGroups))
                }
                None => Ok(None),
            };
        }
        Ok(Some(match self.by.as_deref().map(|by| (by, by.to_str())) {
            None | Some((_, Some("group"))) => Source::Mesh(GroupsBy::Group),
            Some((_, Some("object" | "node"))) => Source::Mesh(GroupsBy::Object),
            Some((_, Some("mesh"))) => Source::Mesh(GroupsBy::Mesh),
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
        Err(TaskError::refused(place, cause))
    }

    /// Returns the setting of the pairs, and their texts.
    fn typed(&self) -> (Setting, &[String]) {
        match self.only[..] {
            [] => (Setting::IgnoreGroups, &self.ignored),
            _ => (Setting::OnlyGroups, &self.only),
        }
    }

    /// Returns the groups of each mesh. Each given name must be the name of a group of at least one mesh.
    fn tables(&self, meshes: &[NamedMesh], are_compared: bool) -> Result<Vec<TriangleGroups>> {
        let (setting, typed) = self.typed();
        if let (Some(Source::Numbers(file)), true) = (self.source()?, are_compared && meshes.len() > 1) {
            let cause = "its numbers are those of one mesh: between several, groups have names";
            return Err(TaskError::refused(file.display(), cause));
        }
        let pairs = names_of_pairs(meshes, typed)
            .map_err(|(text, cause)| TaskError::refused(setting + " " + text, cause))?;
        let apart = pairs.iter().position(|names| !are_compared && !is_in_one_mesh(meshes, names));
        if let Some(apart) = apart {
            let cause = "no node has both groups, and collisions between nodes are not searched";
            return Err(TaskError::refused(setting + " " + typed[apart].as_str(), cause));
        }
        tables(meshes, &pairs, self.only.is_empty())
    }
}

/// The kinds of names in a scene, except those of primitives.
const ANY_KIND: [GroupsBy; 3] = [GroupsBy::Object, GroupsBy::Mesh, GroupsBy::Material];

/// Returns the groups with empty names for groups that a file does not name: their generated name is `#` with a number,
/// or `default`.
fn with_own_names(mut groups: NamedGroups) -> NamedGroups {
    for name in &mut groups.names {
        let is_number = |rest: &str| rest.bytes().all(|byte| byte.is_ascii_digit());
        if name == "default" || name.strip_prefix('#').is_some_and(is_number) {
            name.clear();
        }
    }
    groups
}

fn numbers(file: &Path) -> Result<NamedGroups> {
    read_group_numbers(file)
        .at(|| Setting::GroupBy + " is none of group, object, node, mesh and material, so it must be a file")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(names: &[&str]) -> NamedMesh {
        let mut named = NamedGroups::default();
        named.names = names.iter().map(|name| (*name).to_owned()).collect();
        named.of_triangle = (0..names.len() as u32).collect();
        NamedMesh { kinds: vec![named] }
    }

    fn rules(ignored: &[&str], only: &[&str]) -> GroupRules {
        let owned = |texts: &[&str]| texts.iter().map(|text| (*text).to_owned()).collect();
        GroupRules { ignored: owned(ignored), only: owned(only), by: None }
    }

    #[test]
    fn groups_may_be_missing_in_some_meshes() {
        let all = [named(&["hair", "face", "hat"]), named(&["face", "hat", "shoe"])];
        let counted = |rules: &GroupRules| -> Vec<[bool; 2]> {
            let tables = rules.tables(&all, false).unwrap();
            tables.iter().map(|table| [table.is_pair_counted(0, 1), table.is_pair_counted(1, 1)]).collect()
        };
        assert_eq!(counted(&rules(&["hair,face"], &[])), [[false, true], [true, true]]);
        assert_eq!(counted(&rules(&["hat,hat"], &[])), [[true, true], [true, false]]);
        // No pair of the second mesh counts.
        assert_eq!(counted(&rules(&[], &["hair,face"])), [[true, false], [false, false]]);
        let message = |rules: GroupRules| rules.tables(&all, false).unwrap_err().to_string();
        assert_eq!(
            message(rules(&[], &["hair,coat"])),
            "only_groups hair,coat: no triangle is in a group 'coat'; groups: 'hair', 'face', 'hat', 'shoe'"
        );
        assert_eq!(
            message(rules(&["hat,hat", "hair,shoe"], &[])),
            "ignore_groups hair,shoe: no node has both groups, and collisions between nodes are not searched"
        );
        assert!(rules(&["hair,shoe"], &[]).tables(&all, true).is_ok());
    }

    /// A triangle is in the groups of all its names: the name of its node, of its material, and others.
    #[test]
    fn triangles_have_several_names() {
        let kind = |names: &[&str], of_triangle: &[u32]| {
            let mut groups = NamedGroups::default();
            groups.names = names.iter().map(|name| (*name).to_owned()).collect();
            groups.of_triangle = of_triangle.to_vec();
            with_own_names(groups)
        };
        let mesh =
            NamedMesh { kinds: vec![kind(&["body"], &[0; 4]), kind(&["skin", "#1", "#x"], &[0, 1, 0, 2])] };
        let table = |rules: GroupRules| rules.tables(std::slice::from_ref(&mesh), true).unwrap().remove(0);
        let counted = |rules: GroupRules| -> Vec<(u32, u32)> {
            let table = table(rules);
            let pairs = (0..4).flat_map(|a| (a..4).map(move |b| (a, b)));
            pairs.filter(|(a, b)| table.is_pair_counted(*a, *b)).collect()
        };
        assert_eq!(counted(rules(&["body,body"], &[])), []);
        assert_eq!(counted(rules(&["body,skin"], &[])), [(1, 1), (1, 3), (3, 3)]);
        assert_eq!(counted(rules(&[], &["skin,#x"])), [(0, 3), (2, 3)]);
        let message = rules(&["body,#1"], &[]).tables(std::slice::from_ref(&mesh), true).unwrap_err();
        assert!(message.to_string().ends_with("groups: 'body', 'skin', '#x'"), "{message}");
    }

    #[test]
    fn without_pairs_all_count_and_a_kind_of_groups_is_refused() {
        let mut rules = GroupRules::default();
        assert!(rules.of_mesh("missing.obj".as_ref(), None, 1).unwrap().is_none());
        rules.by = Some("material".into());
        let message = rules.of_mesh("missing.obj".as_ref(), None, 1).unwrap_err().to_string();
        assert!(message.starts_with("group_by: it changes nothing without"), "{message}");
    }
}
